// SPDX-License-Identifier: Apache-2.0
/// \file trocar_kinematics.h  An instrument that passes through a fixed point of the abdominal wall.
/// Source: remote-centre-of-motion kinematics, tip = p + d a with a = Ry(pan) Rx(tilt) (0, 0, -1).
#pragma once

#include "trocar/math/pose.h"

namespace trocar::instrument {

/// The four degrees of freedom of a shaft in a trocar, and the jaws.
struct TrocarJoints {
  double pan = 0;    ///< about the y axis (towards the patient's left and right) [rad]
  double tilt = 0;   ///< about the panned x axis (cranial and caudal) [rad]
  double spin = 0;   ///< about the shaft [rad]
  double depth = 0;  ///< from the trocar point to the tip along the shaft [m]
  double jaw = 0;    ///< whole opening angle of the jaws [rad]

  friend bool operator==(const TrocarJoints&, const TrocarJoints&) = default;
};

/// Limits of the joints of a tool in its trocar.
struct JointLimits {
  double max_pan = 1.3962634015954636;   ///< 80 deg [rad]
  double max_tilt = 1.3962634015954636;  ///< 80 deg [rad]
  double min_depth = 0.030;              ///< [m]
  double max_depth = 0.280;              ///< [m]
  double max_jaw = 1.0471975511965976;   ///< 60 deg [rad]
};

/// Clamps every joint to its limit; spin is left as it is. NaN becomes the nearest lower limit.
TrocarJoints ClampJoints(const TrocarJoints& joints, const JointLimits& limits) noexcept;

/// Pose of the tool: origin at the tip, z axis back along the shaft towards the trocar, y axis the opening
/// direction of the jaws.
/// \param p_world_port  trocar point [m]
/// \note Real-time safe.
math::Pose CalcToolPose(const math::Vec3& p_world_port, const TrocarJoints& joints) noexcept;

/// Joints that bring the tip to `p_world_tip`, with the given spin and jaw. A tip at the port itself gives
/// depth 0.
TrocarJoints FindJoints(const math::Vec3& p_world_port, const math::Vec3& p_world_tip, double spin,
                        double jaw) noexcept;

/// Moves `from` towards `to` no faster than the limits [m/s], [rad/s] allow in dt [s].
/// \note Guards against device jumps (faults D5); real-time safe.
TrocarJoints LimitSpeed(const TrocarJoints& from, const TrocarJoints& to, double max_tip_speed,
                        double max_turn_rate, double dt) noexcept;

}  // namespace trocar::instrument
