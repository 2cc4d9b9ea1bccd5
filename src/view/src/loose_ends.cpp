// SPDX-License-Identifier: Apache-2.0
#include "loose_ends.h"

#include <algorithm>
#include <cstddef>

#include "trocar/math/random.h"

namespace trocar::view {
namespace {

using math::Vec3;

constexpr double kNear = 0.006;                       // m; an end so near to something runs into it
constexpr double kBack = 0.006, kAhead = 0.045;       // m along the tube from its end that are covered
constexpr double kStep = 0.0028;                      // m between lobules along it
constexpr int kAround = 3;                            // lobules at each step
constexpr double kRadius = 0.0044, kSpread = 0.0042;  // m
constexpr double kGrowth = 1.2;                       // of both, over the covered length

bool IsNear(const Vec3& p, std::span<const Vec3> others) {
  return std::any_of(others.begin(), others.end(),
                     [&](const Vec3& other) { return math::SquaredNorm(other - p) < kNear * kNear; });
}

}  // namespace

std::vector<FatLobule> CoverLooseEnds(std::span<const TubeLine> tubes, std::span<const Vec3> organs) {
  std::vector<FatLobule> lobules;
  for (std::size_t i = 0; i < tubes.size(); ++i) {
    const TubeLine& line = tubes[i];
    if (line.size() < 2) continue;
    for (const bool is_first : {true, false}) {
      const Vec3 end = is_first ? line.front() : line.back();
      const Vec3 before = is_first ? line[1] : line[line.size() - 2];
      bool is_loose = !IsNear(end, organs);
      for (std::size_t j = 0; j < tubes.size(); ++j)
        is_loose = is_loose && (j == i || !IsNear(end, tubes[j]));
      if (!is_loose) continue;
      const Vec3 out = math::Normalized(end - before, {1, 0, 0});
      math::Random random(2 * i + (is_first ? 0 : 1));
      for (double along = -kBack; along < kAhead; along += kStep) {
        const double growth = 1.0 + (kGrowth - 1.0) * std::max(0.0, along / kAhead) * 2.0;
        for (int k = 0; k < kAround; ++k) {
          const double spread = growth * kSpread;
          const Vec3 aside{random.Uniform(-spread, spread), random.Uniform(-spread, spread),
                           random.Uniform(-spread, spread)};
          const Vec3 centre = end + along * out + aside;
          lobules.push_back({centre, centre, growth * kRadius * random.Uniform(0.75, 1.25)});
        }
      }
    }
  }
  return lobules;
}

}  // namespace trocar::view
