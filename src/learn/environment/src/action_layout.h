// SPDX-License-Identifier: Apache-2.0
/// \file action_layout.h  Meaning of an action's numbers in a scene, and their effect on the hands.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/environment/settings.h"
#include "trocar/scene/scene.h"

namespace trocar::environment {

/// Greatest rates, which an action of 1 asks for. Those of the joints move a tip 0.12 m deep about as fast as a tip may move.
inline constexpr double kMaxTurn = 1.0;       // of pan and tilt [rad/s]
inline constexpr double kMaxSpin = 3.0;       // [rad/s]
inline constexpr double kMaxTipSpeed = 0.12;  // [m/s]
inline constexpr double kMaxJaw = 2.5;        // [rad/s]

/// Motion of hands and camera that an action asks for.
struct Motion {
  std::array<std::array<double, 5>, instrument::kHandCount>
      rates{};                     ///< pan, tilt, spin, depth, jaw; or x, y, z, spin, jaw
  std::array<double, 4> camera{};  ///< pan, tilt, spin, depth
};

/// Constant for one task.
class ActionLayout {
 public:
  ActionLayout(const scene::Scene& scene, const EnvironmentSettings& settings);

  std::span<const Field> Fields() const { return fields_; }
  std::size_t Size() const { return size_; }
  /// \return kActionInvalid
  base::Status Check(std::span<const double> action) const;
  /// Reads an action.
  /// \param[in,out] input  pedals, tools and the assistant's command are set
  Motion Read(std::span<const double> action, scene::Input& input) const;
  /// The action that takes hands and camera from one input to another: what Read and Move undo, cut to -1 to 1. Not of
  /// discrete actions (TROCAR_ASSERT).
  /// \param ports        p_world_port of each hand
  /// \param seconds      between the two [s], > 0
  /// \param[out] action  (Size())
  void Write(std::span<const math::Vec3, instrument::kHandCount> ports, const scene::Input& before,
             const scene::Input& after, double seconds, std::span<double> action) const;
  /// Moves what is held for the time `dt` [s].
  void Move(const scene::Scene& scene, const Motion& motion, double dt, scene::Input& input) const;

 private:
  /// Choices of a hand besides moving.
  enum class Pedal : std::uint8_t { kCut, kCoagulate, kRinse, kAspirate, kNextTool };

  void Add(std::string name, std::string unit, std::size_t choices = 0);
  Motion ReadDiscrete(std::span<const double> action, scene::Input& input) const;

  ActionKind kind_;
  bool clips_ = false;  // what lies out of range
  bool moves_camera_ = false, has_assistant_ = false;
  std::array<std::vector<Pedal>, instrument::kHandCount> pedals_;  // of each hand
  std::array<std::size_t, instrument::kHandCount> tools_{};        // in its tray
  std::vector<Field> fields_;
  std::size_t size_ = 0;
};

}  // namespace trocar::environment
