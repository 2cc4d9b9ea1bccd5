// SPDX-License-Identifier: Apache-2.0
/// \file rod_contact.h  What a rod lies on and is wound round, and where it crosses itself: contact with friction.
///
/// One contact a segment and obstacle, at the segment's point that is nearest; sorted, and kept from tick to tick. Where a contact
/// presses, its point sticks to the place on the obstacle where it first touched by a spring across the normal, until the spring
/// pulls with the friction's limit; then the place follows (Coulomb's law; the return of plasticity). Within a step of
/// Newton's method the limit is that of the pressure before it, so that friction has a convex potential, too.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/math/vector.h"

namespace trocar::rod {

struct RodModel;
struct RodState;

/// A thing that does not give way: a capsule from `a` to `b` (a ball where they are one), or the half-space below a plane.
struct RodObstacle {
  math::Vec3 a{}, b{};   ///< [m]; of a plane `a` is a point on it
  math::Vec3 outward{};  ///< of a plane its unit normal, out of the solid; zero for a capsule
  double radius = 0;     ///< of a capsule [m]
  double friction = 0;   ///< coefficient against the rod [-], >= 0
  math::Vec3 motion{};   ///< how far it has moved since the tick before [m]
};

/// A place where a rod may press on an obstacle.
struct RodContact {
  std::uint32_t segment = 0, obstacle = 0;
  double at = 0;        ///< place on the segment, 0 to 1 [-]
  math::Vec3 normal{};  ///< from the obstacle to the rod, unit
  double offset = 0;    ///< presses where normal . p is less [m]
  double friction = 0;  ///< [-]
  math::Vec3 anchor{};  ///< where on the obstacle the point sticks [m]
  double pressure = 0;  ///< with which the last solve ended [N], >= 0
  bool operator==(const RodContact&) const = default;
};

/// A place where a rod may press on itself: two segments that are no neighbours.
struct RodCrossing {
  std::uint32_t a = 0, b = 0;  ///< segments, a + kLeastApart <= b
  double at_a = 0, at_b = 0;   ///< places on them, 0 to 1 [-]
  math::Vec3
      normal;  ///< from b to a, unit; of the side on which they first met, also where they were drawn through
  math::Vec3 anchor{};  ///< a's point from b's where they stick [m]
  double pressure = 0;  ///< with which the last solve ended [N], >= 0
  bool operator==(const RodCrossing&) const = default;
};

/// Segments nearer than this on the rod are neighbours, which bending keeps apart.
inline constexpr std::uint32_t kLeastApart = 3;

/// How stiff contacts are. Penalties: a rod under 1 N sinks in by 1 / normal.
struct RodContactSettings {
  double normal = 2e4;       ///< [N/m], > 0
  double across = 5e3;       ///< of what sticks [N/m], >= 0
  double margin = 1e-3;      ///< contacts are kept where the surfaces are nearer than this [m]
  double self_friction = 0;  ///< of the rod against itself [-], >= 0
};

/// Finds the contacts of a tick; those that were there keep what sticks and what presses.
///
/// \param[in,out] contacts  sorted by segment, then obstacle
/// \note Not real-time safe where more contacts come than ever before: allocates.
void FollowContacts(const RodModel& model, const RodState& state, std::span<const RodObstacle> obstacles,
                    const RodContactSettings& settings, std::vector<RodContact>& contacts);

/// Takes the two segments' nearest points for the crossing's. Its side stays, and what sticks is as long as it was.
///
/// \note Real-time safe.
void MoveCrossing(std::span<const math::Vec3> position, RodCrossing& crossing) noexcept;

/// Finds where a rod comes near itself; crossings that were there keep their side, what sticks and what presses.
///
/// \param[in,out] crossings  sorted by a, then b
/// \pre nothing moved farther than settings.margin since the last call: else a crossing could be met from its other side
/// \note Not real-time safe where more crossings come than ever before: allocates.
void FollowCrossings(const RodModel& model, const RodState& state, const RodContactSettings& settings,
                     std::vector<RodCrossing>& crossings);

void VisitState(base::StateArchive& archive, std::vector<RodContact>& contacts);
void VisitState(base::StateArchive& archive, std::vector<RodCrossing>& crossings);

}  // namespace trocar::rod
