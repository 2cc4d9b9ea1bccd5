// SPDX-License-Identifier: Apache-2.0
#include "banded_distance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "trocar/base/assert.h"

namespace trocar::meshing {
namespace {

constexpr int kChunk = 64;  // a fixed length, so that compilers use the processor's vectors

/// Distance of every pixel to the nearest one of its column whose value is `wanted`, at most `cap`.
void CalcColumnDistances(std::span<const std::uint8_t> set, std::uint8_t wanted, int width, int height,
                         std::int16_t cap, std::vector<std::int16_t>& distance) {
  distance.assign(set.size(), cap);
  const auto sweep = [&](int y, int from) {
    const auto row = static_cast<std::size_t>(y) * width;
    const auto before = static_cast<std::size_t>(from) * width;
    for (int x = 0; x < width; ++x) {
      const auto next = static_cast<std::int16_t>(distance[before + x] + 1);
      const std::int16_t here = set[row + x] == wanted ? std::int16_t{0} : distance[row + x];
      distance[row + x] = std::min(here, next);
    }
  };
  for (int x = 0; x < width; ++x) distance[x] = set[x] == wanted ? std::int16_t{0} : cap;
  for (int y = 1; y < height; ++y) sweep(y, y - 1);
  for (int y = height - 2; y >= 0; --y) sweep(y, y + 1);
}

/// Squared distances of one row's pixels from the column distances, at most cap^2 + band^2.
class RowTransform {
 public:
  RowTransform(int width, int band)
      : width_(width),
        band_(band),
        cap_squared_(static_cast<std::int16_t>((band + 1) * (band + 1))),
        padded_(static_cast<std::size_t>(width + 2 * band + 2 * kChunk), cap_squared_),
        squared_(static_cast<std::size_t>(width + kChunk), 0) {}

  const std::vector<std::int16_t>& Run(const std::int16_t* column_distance) {
    // only what lies within the band of a column that is nearer than the cap can change
    int first = width_, last = -1;
    for (int x = 0; x < width_; ++x) {
      const auto g = column_distance[x];
      padded_[static_cast<std::size_t>(x + band_)] = static_cast<std::int16_t>(g * g);
      if (g <= band_) first = std::min(first, x), last = x;
    }
    std::fill(squared_.begin(), squared_.end(), cap_squared_);
    const int begin = std::max(0, first - band_), end = std::min(width_, last + band_ + 1);
    for (int x = begin; x < end; x += kChunk) {
      std::array<std::int16_t, kChunk> nearest;
      nearest.fill(cap_squared_);
      for (int dx = -band_; dx <= band_; ++dx) {
        const auto step = static_cast<std::int16_t>(dx * dx);
        const std::int16_t* from = &padded_[static_cast<std::size_t>(x + band_ + dx)];
        for (int i = 0; i < kChunk; ++i) {
          const auto squared = static_cast<std::int16_t>(from[i] + step);
          nearest[static_cast<std::size_t>(i)] = std::min(nearest[static_cast<std::size_t>(i)], squared);
        }
      }
      std::copy(nearest.begin(), nearest.end(), squared_.begin() + x);
    }
    return squared_;
  }

 private:
  int width_, band_;
  std::int16_t cap_squared_;
  std::vector<std::int16_t> padded_, squared_;
};

}  // namespace

std::vector<float> CalcBandedDistances(std::span<const std::uint8_t> set, int width, int height, int band) {
  TROCAR_ASSERT(set.size() == static_cast<std::size_t>(width) * height && band >= 1 && band <= kWidestBand);
  std::vector<float> distance(set.size());
  const auto cap = static_cast<std::int16_t>(band + 1);
  std::vector<std::int16_t> to_set, to_unset;
  CalcColumnDistances(set, 1, width, height, cap, to_set);
  CalcColumnDistances(set, 0, width, height, cap, to_unset);
  std::vector<float> roots(static_cast<std::size_t>(cap) * cap + 1);
  for (std::size_t i = 0; i < roots.size(); ++i)
    roots[i] =
        std::min(static_cast<float>(std::sqrt(static_cast<double>(i))), static_cast<float>(cap)) - 0.5f;
  RowTransform outside(width, band), inside(width, band);
  for (int y = 0; y < height; ++y) {
    const auto row = static_cast<std::size_t>(y) * width;
    const auto& squared_to_set = outside.Run(&to_set[row]);
    const auto& squared_to_unset = inside.Run(&to_unset[row]);
    for (int x = 0; x < width; ++x) {
      const auto at = static_cast<std::size_t>(x);
      distance[row + at] = set[row + at] ? roots[static_cast<std::size_t>(squared_to_unset[at])]
                                         : -roots[static_cast<std::size_t>(squared_to_set[at])];
    }
  }
  return distance;
}

}  // namespace trocar::meshing
