// SPDX-License-Identifier: Apache-2.0
/// \file rigid_world.h  Things that do not deform: what is transported in the training tasks, and what it lies on.
///
/// Bodies fall, collide, come to rest and are held by jaws. Bullet does the dynamics behind this header; the same
/// calls give the same bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/base/state_archive.h"
#include "trocar/math/pose.h"

namespace trocar::rigid {

/// Convex part of a body, or a ring of them.
struct RigidShape {
  enum class Kind : std::uint8_t {
    kBox,       ///< size: half lengths along x, y, z
    kCylinder,  ///< about z; size.x radius, size.z half height
    kCapsule,   ///< about z; size.x radius, size.z half length between the centres of its ends
    kSphere,    ///< size.x radius
    kRing       ///< torus about z; size.x radius of its circle, size.y radius of its section
  };
  Kind kind = Kind::kBox;
  math::Vec3 size;  ///< [m], > 0 where used
  math::Pose X_body_shape;
};

struct RigidBody {
  std::vector<RigidShape> shapes;  ///< at least one
  math::Pose X_world_body;
  double mass = 0;        ///< [kg]; 0: never moves
  double friction = 0.8;  ///< Coulomb's, with a partner of 1; the product of both counts [-]
};

/// A capsule of a tool: about its own z axis, centred in its pose.
struct ToolCapsule {
  double radius = 0;       ///< [m], > 0
  double half_length = 0;  ///< [m], >= 0
};

/// Parts of a tool, by their place in RigidWorld::AddTool's list.
enum ToolPart : std::uint8_t { kShaftPart, kUpperJawPart, kLowerJawPart, kToolPartCount };

/// Where a tool enters a body that never moves.
struct ToolObstacle {
  std::uint32_t body = 0;
  math::Vec3 point;   ///< of the tool's axis, world frame [m]
  math::Vec3 normal;  ///< unit, into the body
  double depth = 0;   ///< of the tool's surface in the body [m]; negative: they are this far apart
};

/// Where a tool touches a body that Bullet moves or that it leans on.
struct ToolTouch {
  std::uint32_t body = 0;
  math::Vec3 point;   ///< on the body, world frame [m]
  math::Vec3 normal;  ///< unit, out of the body
  math::Vec3 force;   ///< on the tool, in the last part of the last Step [N]
};

class RigidWorld {
 public:
  /// \param gravity  [m/s^2]
  /// \param tick_seconds  of every Step, > 0
  RigidWorld(const math::Vec3& gravity, double tick_seconds);
  ~RigidWorld();
  RigidWorld(RigidWorld&&) noexcept;
  RigidWorld& operator=(RigidWorld&&) noexcept;

  /// \return index of the body; kSceneInvalid where sizes, mass, friction or poses make no body
  base::Result<std::uint32_t> AddBody(const RigidBody& body);
  /// \param parts  shaft, upper jaw, lower jaw
  /// \return index of the tool; kSceneInvalid
  base::Result<std::uint32_t> AddTool(const ToolCapsule (&parts)[kToolPartCount],
                                      const math::Pose (&X_world_parts)[kToolPartCount]);

  /// Where a tool's parts are at the end of the next Step; in between they move there evenly.
  /// \pre finite (TROCAR_ASSERT)
  void MoveTool(std::uint32_t tool, const math::Pose (&X_world_parts)[kToolPartCount]);

  /// From the next Step on [m/s^2]; what lies still wakes when it changes.
  void SetGravity(const math::Vec3& gravity);

  /// One tick.
  /// \note Bounded by the number of bodies; takes memory from pools that grow to the most contacts seen.
  void Step();

  /// The body that lies between both jaws and touches both, or -1. Of several the lowest index.
  std::int32_t FindBodyInJaws(std::uint32_t tool) const;
  /// From the next Step on the tool carries the body with it, with `hold_force` at most: friction times the
  /// jaws' force [N]. A body may be held by two tools.
  void Hold(std::uint32_t tool, std::uint32_t body, double hold_force);
  /// The grip of jaws that hold something grows and falls with their pinch. \param hold_force  as Hold's [N]
  void SetHoldForce(std::uint32_t tool, double hold_force);
  void Release(std::uint32_t tool);
  /// The body that a tool holds, or -1. A body that was pulled away by more than the hold force has slipped.
  std::int32_t HeldBy(std::uint32_t tool) const;

  /// Force of what the tool touches or holds, on the tool, mean over the last Step [N].
  math::Vec3 ForceOn(std::uint32_t tool) const;
  /// Whether any part of the tool touched a body in the last Step.
  bool Touches(std::uint32_t tool, std::uint32_t body) const;

  /// Points at which a tool touches bodies, by body and part of the tool.
  /// \param[out] touches  added to
  /// \note Allocates.
  void FindTouches(std::uint32_t tool, std::vector<ToolTouch>& touches) const;

  /// Bit of each of the first 64 bodies that a body touched at the end of the last Step.
  std::uint64_t TouchedBodies(std::uint32_t body) const;
  /// Finds the bodies without mass that a tool with its parts in these poses enters, or that are nearer than `reach` [m].
  /// Step pushes the bodies with mass. Those without mass have to keep the tool out, and the caller sees to that.
  /// \param[out] obstacles  cleared first; the deepest of each part and body
  void FindObstacles(std::uint32_t tool, const math::Pose (&X_world_parts)[kToolPartCount], double reach,
                     std::vector<ToolObstacle>& obstacles);

  math::Pose PoseOf(std::uint32_t body) const;
  math::Vec3 VelocityOf(std::uint32_t body) const;  ///< [m/s]
  bool IsAtRest(std::uint32_t body) const;
  std::size_t BodyCount() const;
  /// Everything as it was added; tools stay where they are and hold nothing.
  void Reset();
  /// Bodies, holds, and contacts with the impulses that warm-start the next step. Restoring fails for other bodies or tools.
  /// \note Allocates.
  void VisitState(base::StateArchive& archive);

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::rigid
