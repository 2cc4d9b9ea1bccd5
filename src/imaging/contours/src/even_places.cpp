// SPDX-License-Identifier: Apache-2.0
#include "even_places.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"

namespace trocar::contours {

std::vector<PolylinePlace> FindEvenPlaces(std::span<const math::Vec2> polyline, double step,
                                          std::size_t fewest, std::size_t most) {
  const std::size_t n = polyline.size();
  TROCAR_ASSERT(n >= 3 && step > 0 && fewest <= most);
  const auto side_length = [&](std::size_t side) { return Norm(polyline[(side + 1) % n] - polyline[side]); };
  double length = 0;
  for (std::size_t side = 0; side < n; ++side) length += side_length(side);
  const auto count = base::TruncateTo<std::size_t>(
      std::clamp(std::ceil(length / step), static_cast<double>(fewest), static_cast<double>(most)));
  std::vector<PolylinePlace> places;
  places.reserve(count);
  double passed = 0, now = side_length(0);
  std::size_t side = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double wanted = length * static_cast<double>(k) / static_cast<double>(count);
    while (passed + now < wanted && side + 1 < n) {
      passed += now;
      now = side_length(++side);
    }
    places.push_back({side, now > 0 ? std::min(1.0, (wanted - passed) / now) : 0.0});
  }
  return places;
}

}  // namespace trocar::contours
