// SPDX-License-Identifier: Apache-2.0
#include "heat_memory.h"

#include <algorithm>
#include <cmath>

#include "trocar/math/elementary.h"

namespace trocar::agent {
namespace {

constexpr double kSamePlace = 0.3 * HeatMemory::kReach;  // [m]
constexpr double kForgotten = 0.002;                     // [s]

}  // namespace

void HeatMemory::Add(const math::Vec3& place, double seconds) {
  const auto near = std::find_if(warmths_.begin(), warmths_.end(), [&](const Warmth& warmth) {
    return math::Distance(warmth.place, place) < kSamePlace;
  });
  if (near == warmths_.end()) {
    warmths_.push_back({place, seconds});
  } else {
    near->seconds += seconds;
  }
}

void HeatMemory::Cool(double seconds) {
  const double share = math::Exp(-seconds / kCools);
  for (Warmth& warmth : warmths_) warmth.seconds *= share;
  std::erase_if(warmths_, [](const Warmth& warmth) { return warmth.seconds < kForgotten; });
}

double HeatMemory::At(const math::Vec3& place) const {
  double sum = 0;
  for (const Warmth& warmth : warmths_) {
    if (math::Distance(warmth.place, place) < kReach) sum += warmth.seconds;
  }
  return sum;
}

}  // namespace trocar::agent
