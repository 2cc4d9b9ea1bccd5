// SPDX-License-Identifier: Apache-2.0
/// \file contact.h  Pushing: where a tool presses an organ, and with what force the organ answers.
///
/// A tool is a row of spheres along its jaws and the first part of its shaft. A sphere that reaches into an
/// organ presses it with one-sided springs: against every triangle around it while its centre is outside,
/// against the nearest one when it is deeper (the paper's second boundary condition, a node under external
/// force, section 3.2.2).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/instrument/tool.h"
#include "trocar/surgery/organ_surface.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::surgery {

using math::Pose;

struct ContactSettings {
  double stiffness = 300.0;  ///< of one spring [N/m]
  double margin =
      0.001;  ///< springs are made this far ahead of touch, so that they can close in the solve [m]
  double shaft_reach = 0.080;   ///< of the shaft that is looked at, from the hinge [m]
  double sample_step = 0.0045;  ///< between spheres along jaws and shaft [m]
};

/// Sphere of a tool, in the tool frame; remembers what it pressed in the tick before.
struct ContactSample {
  enum class Part : std::uint8_t { kUpperJaw, kLowerJaw, kShaft } part = Part::kShaft;
  double along = 0;   ///< from the hinge towards the jaw's tip, or from the hinge up the shaft [m]
  double radius = 0;  ///< [m]
  // per organ: triangle found last and the outward normal while in contact
  std::vector<std::uint32_t> last_triangle;
  std::vector<Vec3> held_normal;
  std::vector<std::uint8_t> is_held;
};

/// The spheres of one tool. Constant but for their memory, which belongs to the state.
struct ToolSamples {
  std::vector<ContactSample> samples;
};
ToolSamples MakeToolSamples(const instrument::Tool& tool, const ContactSettings& settings,
                            std::size_t organ_count);
/// Forgets what was pressed.
void ResetToolSamples(ToolSamples& samples) noexcept;

/// Centre of a sphere in the tool frame at a jaw opening [rad].
Vec3 CalcSampleCentre(const instrument::Tool& tool, const ContactSample& sample, double jaw) noexcept;

/// Contact springs of a tick with whose they are. Fixed room: when full, later contacts of the tick are
/// dropped.
struct ContactSet {
  static constexpr std::size_t kCapacity = 256;
  std::vector<tissue::ContactSpring> springs;  ///< reserved to kCapacity
  std::vector<std::uint8_t> hand;              ///< whose tool
  std::vector<std::uint8_t> organ;
  std::size_t dropped = 0;

  ContactSet();
  void Clear() noexcept;
};

/// Adds the springs of one tool against every organ.
///
/// \param grasped_organ  organ in the tool's jaws, whose tissue lies between them and is left to the grasp;
/// or -1
/// \note Real-time safe.
void FindContacts(const instrument::Tool& tool, const Pose& X_world_tool, double jaw, std::uint8_t hand,
                  std::span<const OrganSurface> organs, std::span<const Vec3> positions,
                  const ContactSettings& settings, std::int32_t grasped_organ, ToolSamples& samples,
                  ContactSet& contacts) noexcept;

/// What one hand's contacts amount to after the solve.
struct ContactReaction {
  Vec3 force;               ///< of the tissue on the tool [N]
  std::int32_t organ = -1;  ///< pressed most, or -1
  double deepest = 0;       ///< largest depth of a spring [m]
};
ContactReaction CalcContactReaction(const ContactSet& contacts, std::uint8_t hand,
                                    std::span<const Vec3> positions) noexcept;

}  // namespace trocar::surgery
