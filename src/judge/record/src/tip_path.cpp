// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/tip_path.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "trocar/base/to_integer.h"

namespace trocar::record {

std::span<const math::Vec3> TipPath::Between(std::size_t hand, double from, double until) const {
  const auto& all = points[hand];
  if (all.empty() || step <= 0) return {};
  const auto last = static_cast<double>(all.size() - 1);
  const auto place = [&](double time) {
    return base::TruncateTo<std::size_t>(std::clamp(std::floor((time - first_time) / step + 0.5), 0.0, last));
  };
  const std::size_t begin = place(from), end = std::max(begin, place(until));
  return std::span(all).subspan(begin, end - begin + 1);
}

TipPath CalcTipPath(const scene::Scene& scene, const Recording& recording, double step) {
  const double tick_seconds = recording.description.tick_seconds;
  const auto stride = std::max<std::size_t>(1, base::RoundTo<std::size_t>(step / tick_seconds));
  TipPath path;
  path.step = static_cast<double>(stride) * tick_seconds;
  path.first_time = static_cast<double>(recording.FirstTick() + 1) * tick_seconds;
  for (std::size_t hand = 0; hand < path.points.size(); ++hand) {
    const instrument::JointLimits limits;
    for (std::size_t tick = 0; tick < recording.inputs.size(); tick += stride) {
      const auto joints = instrument::ClampJoints(recording.inputs[tick].hands[hand], limits);
      path.points[hand].push_back(
          instrument::CalcToolPose(scene.instruments[hand].p_world_port, joints).translation);
    }
  }
  return path;
}

}  // namespace trocar::record
