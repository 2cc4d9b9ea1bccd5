// SPDX-License-Identifier: Apache-2.0
/// \file tip_path.h  The way of both tools' tips through a recording, without computing it again.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "trocar/math/vector.h"
#include "trocar/record/recording.h"

namespace trocar::record {

/// Where the hands held the tips, as the inputs say: within tissue, or faster than a tool may move, the tip itself stays behind.
struct TipPath {
  double first_time = 0;                                               ///< of the first point [s]
  double step = 0;                                                     ///< between two points [s]
  std::array<std::vector<math::Vec3>, instrument::kHandCount> points;  ///< world frame [m]

  /// The points between two times, at least one where the path has any. \param hand  scene::Hand
  std::span<const math::Vec3> Between(std::size_t hand, double from, double until) const;
};

/// \param step  between two points [s], at least a tick
TipPath CalcTipPath(const scene::Scene& scene, const Recording& recording, double step = 1.0 / 30);

}  // namespace trocar::record
