// SPDX-License-Identifier: Apache-2.0
#include "trocar/base/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"

namespace trocar::base {

double CalcPercentile(std::vector<double> values, double fraction) {
  TROCAR_ASSERT(fraction >= 0.0 && fraction <= 1.0);
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double rank = fraction * static_cast<double>(values.size() - 1);
  const auto below = FloorTo<std::size_t>(rank);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (rank - static_cast<double>(below)) * (values[above] - values[below]);
}

}  // namespace trocar::base
