// SPDX-License-Identifier: Apache-2.0
/// \file local_model.h  The tissue around a tool at the haptic rate: a tool on a spring in the hand, and the segment it
/// presses, moved towards equilibrium by a few sweeps in every tick.
/// Source: "General algorithms for laparoscopic surgical simulators", section 3.4; the tool is the proxy of a virtual
/// coupling (see coupling.h).
#pragma once

#include <cstdint>
#include <memory>

#include "trocar/tissue/local_patch.h"

namespace trocar::haptics {

struct LocalModelSettings {
  double coupling_stiffness = 200;  ///< between hand and tool, in the world [N/m], > 0
  int sweeps = 4;                   ///< of Gauss-Seidel in a tick, >= 1
  int first_sweeps = 12;            ///< in the tick in which a segment comes, >= 1
  double blend_time = 1.0 / 120;    ///< in which the step between two segments fades out [s], > 0
  double tick = 0.001;              ///< [s], > 0
};

/// Result of a tick: force on the hand, its Jacobian, and the position of the tool.
struct LocalAnswer {
  math::Vec3 force;                ///< on the hand, before the scales of the device [N], world frame
  tissue::Matrix3Rows jacobian{};  ///< dF / d(hand) [N/m]; without the sweeps' lag
  math::Vec3 p_world_tool;         ///< of the tool, which gives way to the tissue where the hand does not [m]
  bool is_in_contact = false;      ///< the force is not zero
};

/// One tool's local model. Energy of tissue, contacts and coupling falls with every sweep, and the hand's spring is the
/// only way in: against a hand that moves slowly it can only take work.
class LocalModel {
 public:
  explicit LocalModel(const LocalModelSettings& settings);
  ~LocalModel();
  LocalModel(LocalModel&&) noexcept;
  LocalModel& operator=(LocalModel&&) noexcept;

  /// A new segment, in force from the next Step on; the force stays continuous.
  /// \param patch  is copied
  /// \note Real-time safe: no allocation, lock or throw.
  void Take(const tissue::LocalPatch& patch) noexcept;

  /// One tick.
  ///
  /// \param X_world_hand  where the hand holds the tool: translation of the hand, direction of the shaft there
  /// \return not finite numbers only for poses or segments that are not finite, or for tissue without any stiffness
  /// \note Real-time safe: no allocation, lock or throw.
  LocalAnswer Step(const math::Pose& X_world_hand) noexcept;

  /// Forgets the segment: no force, tool in the hand.
  void Clear() noexcept;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::haptics
