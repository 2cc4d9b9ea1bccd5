// SPDX-License-Identifier: Apache-2.0
/// \file scene_object.h  Things of a training task: what is transported, and what it lies on or hangs from.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/rigid/rigid_world.h"

namespace trocar::scene {

/// Looks only.
enum class ObjectColour : std::uint8_t {
  kRed,
  kYellow,
  kGreen,
  kBlue,
  kWhite,
  kGrey,
  kBlack,
  kSteel,
  kCount
};
/// "red", "yellow", "green", "blue", "white", "grey", "black", "steel".
std::string_view ColourName(ObjectColour colour) noexcept;
std::optional<ObjectColour> FindColour(std::string_view name) noexcept;

/// Where a person would take a thing.
struct ObjectGrip {
  math::Vec3 point;            ///< body frame [m]
  math::Vec3 across{1, 0, 0};  ///< direction in which the jaws open, body frame, unit
  double opening = 0.63;       ///< of the jaws that come to it, 36 deg [rad]
};

struct SceneObject {
  std::string name;
  rigid::RigidBody body;  ///< mass 0: it never moves
  ObjectColour colour = ObjectColour::kRed;
  std::vector<ObjectGrip> grips;  ///< where scripted surgeons take it, the left hand's first

  bool Moves() const { return body.mass > 0; }
};

/// Objects that a scene may have: every one has a bit in ObjectSnapshot::touches.
inline constexpr std::size_t kMaxObjects = 64;

/// One thing after a tick.
struct ObjectSnapshot {
  math::Pose X_world_object;
  math::Vec3 velocity;       ///< [m/s]
  std::uint8_t held_by = 0;  ///< bit of each hand
  std::uint8_t touched_by =
      0;  ///< bit of each hand whose tool touches it, from outside or with the jaws that hold it
  bool is_at_rest = true;
  std::uint64_t touches = 0;  ///< bit of each other object that it touches
};

}  // namespace trocar::scene
