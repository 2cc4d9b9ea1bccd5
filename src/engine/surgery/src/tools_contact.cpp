// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/tools_contact.h"

#include <algorithm>
#include <cmath>

namespace trocar::surgery {

using math::Vec3;

ToolsContact FindToolsContact(const std::array<ToolMotion, 2>& motions,
                              std::array<ProxyLimits, 2>& limits) noexcept {
  ToolsContact contact;
  std::array<std::array<collision::Capsule, kToolBodyCount>, 2> proxy, device;
  for (int hand = 0; hand < 2; ++hand) {
    const ToolMotion& motion = motions[hand];
    proxy[hand] = CalcToolBodies(*motion.tool, motion.jaw_before, motion.X_world_proxy);
    device[hand] = CalcToolBodies(*motion.tool, motion.jaw, motion.X_world_device);
  }
  // the deepest pair presses: shafts are stiff, and a second pair of the same two tools would press twice
  double deepest = 0;
  for (int left = 0; left < kToolBodyCount; ++left) {
    for (int right = 0; right < kToolBodyCount; ++right) {
      const double reach = device[0][left].radius + device[1][right].radius;
      const auto sweep = collision::SweepToSegment({proxy[0][left].axis, device[0][left].axis},
                                                   {proxy[1][right].axis, device[1][right].axis}, reach);
      if (!sweep.is_hit) continue;
      const Vec3 normal = math::Normalized(sweep.points.on_b - sweep.points.on_a, Vec3{});
      const collision::Segment &a = device[0][left].axis, &b = device[1][right].axis;
      const Vec3 on_a = math::Lerp(a.start, a.end, sweep.points.parameter_a);
      const Vec3 on_b = math::Lerp(b.start, b.end, sweep.points.parameter_b);
      const double depth = reach - math::Dot(normal, on_b - on_a);
      if (!(depth > 0.0) || !(math::SquaredNorm(normal) > 0.0)) continue;
      contact.is_touching = true;
      limits[0].Add({on_a, normal, -0.5 * depth});
      limits[1].Add({on_b, -normal, -0.5 * depth});
      if (depth > deepest) {
        deepest = depth;
        contact.force = {(-kToolsStiffness * depth) * normal, (kToolsStiffness * depth) * normal};
      }
    }
  }
  return contact;
}

}  // namespace trocar::surgery
