// SPDX-License-Identifier: Apache-2.0
#include "trocar/haptics/coupling.h"

#include <algorithm>
#include <limits>

#include "trocar/base/assert.h"

namespace trocar::haptics {
namespace {

/// For a device of which nothing is known: half of what the softest device of the domain facts bears [N/m].
constexpr double kCautiousStiffness = 200;

}  // namespace

math::Vec3 ToWorld(const DeviceMap& map, const math::Vec3& p_device) noexcept {
  return map.X_world_device * (map.motion_scale * p_device);
}

math::Vec3 ToDevice(const DeviceMap& map, const math::Vec3& p_world) noexcept {
  return (1.0 / map.motion_scale) * (math::Inverse(map.X_world_device) * p_world);
}

DeviceForce ToDeviceForce(const DeviceMap& map, const math::Vec3& force_world) noexcept {
  return {map.force_scale * math::Rotate(math::Inverse(map.X_world_device.rotation), force_world)};
}

double CalcStiffnessCap(const device::ForceLimits& limits, double tick) noexcept {
  TROCAR_ASSERT(tick > 0.0);
  double cap = std::numeric_limits<double>::infinity();
  if (limits.damping > 0.0) cap = std::min(cap, 2.0 * limits.damping / tick);
  // infinite, and so no bound, without the encoders' step
  if (limits.friction > 0.0) cap = std::min(cap, 2.0 * limits.friction / limits.position_step);
  if (limits.max_stiffness > 0.0) cap = std::min(cap, limits.max_stiffness);
  return cap < std::numeric_limits<double>::infinity() ? cap : kCautiousStiffness;
}

double CalcCouplingStiffness(const DeviceMap& map, double stiffness_cap) noexcept {
  TROCAR_ASSERT(map.motion_scale > 0.0 && map.force_scale > 0.0);
  return stiffness_cap / (map.motion_scale * map.force_scale);
}

}  // namespace trocar::haptics
