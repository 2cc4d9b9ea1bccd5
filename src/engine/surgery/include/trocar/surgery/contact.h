// SPDX-License-Identifier: Apache-2.0
/// \file contact.h  Pushing: where a tool presses an organ or a duct, and with what force it answers.
///
/// A tool is three capsules: two jaws and the whole shaft. It is present twice: the device's pose, where the
/// hand is, and the proxy's (tool_proxy.h), which stays outside of the tissue. Contacts are found on the
/// proxy's way to the device, in time, so that neither a fast tip nor a thin duct is passed over, and each knows
/// from which side the tool came. Each is a one-sided spring of the solver (the paper's second boundary
/// condition, a node under external force, section 3.2.2): it pushes the tissue out of the device's tool, and
/// what it is pressed is the force. Friction is a second spring along the surface, which sticks up to Coulomb's
/// limit and slips beyond it. See docs/contact.md.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/collision/sweep.h"
#include "trocar/instrument/tool.h"
#include "trocar/surgery/organ_surface.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::surgery {

struct ContactSettings {
  double stiffness = 300.0;  ///< of one spring, along the normal and along the surface [N/m]
  double margin =
      0.001;  ///< springs are made this far ahead of touch, so that they can close in the solve [m]
  /// Coulomb's coefficient of smooth steel on wet tissue [-]. Source: domain facts, section 3.3.
  double friction = 0.25;
};

/// Parts of a tool, in the order of CalcToolBodies.
enum class ToolBody : std::uint8_t { kUpperJaw, kLowerJaw, kShaft };
inline constexpr int kToolBodyCount = 3;

/// Capsules of both jaws and of the whole shaft in the world.
std::array<collision::Capsule, kToolBodyCount> CalcToolBodies(const instrument::Tool& tool, double jaw,
                                                              const math::Pose& X_world_tool) noexcept;

/// Whether the tool opens and closes. A hook, a tube or a bag is one rod before its shaft: its kUpperJaw.
bool HasJaws(const instrument::Tool& tool) noexcept;
/// Whether one of the bodies of CalcToolBodies is part of the tool: its lower jaw only where it opens and closes.
bool HasBody(const instrument::Tool& tool, ToolBody body) noexcept;

/// Blades, and the legs of a clip, slip around ducts and vessels and close on them: these jaws neither push a tube nor
/// are stopped by one. Their shaft is.
bool ClosesAroundTubes(const instrument::Tool& tool) noexcept;

/// Whether a jaw that pushes tissue along `normal` pushes it towards the other jaw: tissue between the jaws, which
/// does not push the tool away.
/// \note Real-time safe.
bool IsPinch(const instrument::Tool& tool, ToolBody body, const math::Pose& X_world_tool,
             const math::Vec3& normal) noexcept;

/// Tissue that a tool may touch. Surfaces are counted as organs first, then tubes.
struct ContactCandidates {
  std::span<const OrganSurface> organs;
  const TubeSet* tubes = nullptr;                ///< or nullptr for none
  std::span<const math::Vec3> positions;         ///< (n) of the whole system, now [m]
  std::span<const math::Vec3> positions_before;  ///< (n) before the last solve [m]
  std::span<const double> surface_motion;  ///< (organs + 1) farthest that a node went in it; last: tubes [m]
};

/// One contact beside its spring; remembered for a tick.
struct ContactLink {
  std::uint64_t key = 0;     ///< hand, body, surface and triangle or piece
  std::uint8_t hand = 0;     ///< whose tool
  std::uint8_t surface = 0;  ///< organ, or organs + tube
  bool is_friction = false;  ///< the spring runs along the surface; its normal contact stands before it
  bool is_pinch = false;     ///< of a jaw's inner side
  math::Vec3 p_device;       ///< point of the device's axis that presses [m]
  double held_back = 0;      ///< how much farther the device's surface is than the spring pushes [m]
  math::Vec3 p_tool_stuck;   ///< point of the tool that sticks to the tissue, tool frame [m]
  double normal_force = 0;   ///< after the solve [N]
};

/// Contact springs of a tick with what they belong to. Fixed capacity: when full, later contacts of the tick are
/// dropped and counted.
struct ContactSet {
  static constexpr std::size_t kCapacity = 960;
  std::vector<tissue::ContactSpring> springs;  ///< reserved to kCapacity
  std::vector<ContactLink> links;              ///< (springs)
  std::size_t dropped = 0;

  ContactSet();
  void Clear() noexcept;
};

void VisitState(base::StateArchive& archive, ContactSet& contacts);

/// One tool's way in a tick.
struct ToolMotion {
  const instrument::Tool* tool = nullptr;
  std::uint8_t hand = 0;
  math::Pose X_world_proxy_before, X_world_proxy;  ///< before the last solve, and now: outside of the tissue
  math::Pose X_world_device;                       ///< where the hand is
  double jaw_before = 0, jaw = 0;                  ///< at the proxy's poses, and now [rad]
  /// Surface in the tool's jaws, whose tissue lies between them and is left to the grasp; or -1.
  std::int32_t grasped_surface = -1;
};

/// Adds the springs of one tool against every organ and tube.
///
/// \param last  contacts of the tick before, after CalcReactions: what sticks where
/// \note Real-time safe.
void FindContacts(const ToolMotion& motion, const ContactCandidates& candidates,
                  const ContactSettings& settings, const ContactSet& last, ContactSet& contacts) noexcept;

/// Reaction of one hand's contacts after the solve.
struct ContactReaction {
  math::Vec3 force;           ///< of the tissue on the tool [N]
  std::int32_t surface = -1;  ///< pressed most, or -1
  double deepest = 0;         ///< largest depth of a spring [m]
};

/// Also keeps each contact's normal force, which limits the next tick's friction.
/// \note Real-time safe.
ContactReaction CalcContactReaction(std::uint8_t hand, std::span<const math::Vec3> positions,
                                    ContactSet& contacts) noexcept;

}  // namespace trocar::surgery
