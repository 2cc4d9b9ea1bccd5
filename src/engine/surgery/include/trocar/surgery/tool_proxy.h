// SPDX-License-Identifier: Apache-2.0
/// \file tool_proxy.h  The tool that is seen and that touches: it follows the hand but does not enter tissue.
///
/// The device's tool may lie in the tissue, as far as the contact springs give way. The proxy is the tool in the
/// same trocar, nearest to the device's, that lies outside of what its contacts press. It turns about the trocar
/// and slides in it; spin and jaws are the device's.
/// Source: Zilles and Salisbury, "A constraint-based god-object method for haptic display", IROS 1995; here with
/// the joints of a trocar in place of a point, solved by projected Gauss-Seidel.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/instrument/trocar_kinematics.h"
#include "trocar/surgery/contact.h"

namespace trocar::surgery {

/// Where an instrument passes the abdominal wall, and where the hand wants it.
struct ToolDrive {
  math::Vec3 p_world_port;          ///< [m]
  instrument::TrocarJoints device;  ///< after limits
};

/// The tool's axis at `point` must stay on this side: normal . (x - point) <= clearance.
struct ProxyLimit {
  math::Vec3 point;      ///< of the device's axis [m]
  math::Vec3 normal;     ///< unit, into what is touched
  double clearance = 0;  ///< [m]; negative: the device lies this deep
};

/// Planes that keep a proxy out. Fixed capacity: when full, the rest is dropped.
struct ProxyLimits {
  static constexpr std::size_t kCapacity = ContactSet::kCapacity + 32;
  std::vector<ProxyLimit> limits;  ///< reserved to kCapacity

  ProxyLimits() { limits.reserve(kCapacity); }
  void Add(const ProxyLimit& limit) noexcept {
    if (limits.size() < kCapacity) limits.push_back(limit);
  }
};

/// Adds the limits that one hand's contacts set after the solve; tissue between the jaws sets none.
/// \note Real-time safe.
void AddContactLimits(std::uint8_t hand, const ContactSet& contacts, std::span<const math::Vec3> positions,
                      ProxyLimits& limits) noexcept;

/// Joints of the proxy: nearest to the device's within the limits.
///
/// \param last_offset  pan, tilt and depth of the proxy less the device's in the tick before: what is no longer
/// needed of it fades over some ticks, so that the tool does not jump
/// \return spin and jaw as the device's
/// \note Real-time safe.
instrument::TrocarJoints FindProxy(const ToolDrive& drive, const instrument::TrocarJoints& last_offset,
                                   std::span<const ProxyLimit> limits) noexcept;

/// Looks whether the proxy overlaps organs or tubes after all, and adds a limit for each body and surface where
/// it does; tissue between the jaws does not count.
///
/// \param candidates       trees and positions of now
/// \param grasped_surface  left out for the jaws, or -1
/// \return greatest overlap of a body's surface with the tissue [m], 0 for none
/// \note Real-time safe.
double AddOverlapLimits(const instrument::Tool& tool, const math::Pose& X_world_proxy,
                        const math::Pose& X_world_device, double jaw, const ContactCandidates& candidates,
                        std::int32_t grasped_surface, ProxyLimits& limits) noexcept;

}  // namespace trocar::surgery
