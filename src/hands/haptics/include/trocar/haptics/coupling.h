// SPDX-License-Identifier: Apache-2.0
/// \file coupling.h  Between a device and the world: where it is, how large its motion and forces are there, and
/// how stiff the spring between the hand and the tool may be.
/// Source: Colgate, Stanley, Brown, "Issues in the haptic display of tool use", IROS 1995 (virtual coupling);
/// Abbott, Okamura, "Effects of position quantization and sampling rate on virtual-wall passivity", IEEE T-RO 2005.
#pragma once

#include "trocar/haptics/force_gate.h"
#include "trocar/math/pose.h"

namespace trocar::haptics {

/// How a device stands in the world.
struct DeviceMap {
  math::Pose X_world_device;
  double motion_scale = 1;  ///< metres of the tool for a metre of the device [-], > 0
  double force_scale = 1;   ///< newtons in the hand for a newton at the tool [-], > 0
};

/// Point of the world that a point of the device stands for [m].
math::Vec3 ToWorld(const DeviceMap& map, const math::Vec3& p_device) noexcept;
/// The inverse [m].
math::Vec3 ToDevice(const DeviceMap& map, const math::Vec3& p_world) noexcept;
/// Force in the hand for a force at the tool [N].
DeviceForce ToDeviceForce(const DeviceMap& map, const math::Vec3& force_world) noexcept;

/// Stiffest spring that a device renders without gaining energy, K <= min(2 b / T, 2 f_c / Delta), and no more than
/// its maker allows; what is not known does not count [N/m].
///
/// \param tick  T [s], > 0
/// \return 200 N/m where nothing is known
/// \note The coupling is a spring without damping of its own: B = 0 in b > K T / 2 + |B|.
double CalcStiffnessCap(const device::ForceLimits& limits, double tick) noexcept;

/// The spring between hand and tool in the world, so that it is `stiffness_cap` in the hand [N/m].
double CalcCouplingStiffness(const DeviceMap& map, double stiffness_cap) noexcept;

}  // namespace trocar::haptics
