// SPDX-License-Identifier: Apache-2.0
#include "film.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace trocar::view {
namespace {

using math::Vec3;

constexpr double kLeastRate = 1e-10;   // m^3/s; slower than a drop in five minutes wets nothing
constexpr double kFullRate = 1e-6;     // m^3/s, of a cystic artery: the film is at its widest
constexpr double kWidth = 0.0035;      // m, of the slowest run
constexpr double kWidthGain = 0.0045;  // m
constexpr double kFullOoze = 5e-10;    // m^3/s, of a fibre of the bed that has just been torn
constexpr double kOozeWidth = 0.0030, kOozeLength = 0.004;  // m
constexpr double kShore = 0.0028;                           // m above a pool's level that is wet
constexpr double kShoreWidth = 1.25;                        // of its radius that it may wet
constexpr std::uint8_t kRawBlood = 96;                      // film of blood on torn tissue, of 255
constexpr double kLength = 0.006, kLengthGain = 0.034;      // m

}  // namespace

Film::Film(const simulation::Snapshot& snapshot) : down_(math::Normalized(snapshot.gravity, {0, 0, -1})) {
  const simulation::OperationSnapshot& operation = snapshot.operation;
  for (std::size_t i = 0; i < std::min(operation.flow.leak_count, operation.flow.leaks.size()); ++i) {
    const surgery::LeakSnapshot& leak = operation.flow.leaks[i];
    if (!(leak.rate > kLeastRate)) continue;
    // a hundredfold rate is seen as about thrice the width
    const double flow = std::clamp(std::pow(leak.rate / kFullRate, 0.3), 0.0, 1.5);
    runs_.push_back({leak.position, kWidth + kWidthGain * flow, kLength + kLengthGain * flow,
                     std::min(1.0, 0.45 + 0.6 * flow), leak.fluid == surgery::Fluid::kBlood});
  }
  for (const surgery::OozeSnapshot& ooze : std::span(operation.flow.oozes).first(operation.flow.ooze_count)) {
    const double flow = std::clamp(std::sqrt(ooze.rate / kFullOoze), 0.0, 1.0);
    runs_.push_back(
        {ooze.position, kOozeWidth * (0.5 + 0.5 * flow), kOozeLength * flow, 0.35 + 0.55 * flow, true});
  }
}

void Film::Wet(const Vec3& p_world, render::SurfaceMark& mark) const {
  for (const Run& run : runs_) {
    const Vec3 from = p_world - run.start;
    const double drop = math::Dot(from, down_);
    // round above the leak, a tongue below it
    const double past = drop < 0.0 ? -drop : std::max(0.0, drop - run.length);
    const double far = (math::SquaredNorm(from - drop * down_) + past * past) / (run.width * run.width);
    if (far >= 1.0) continue;
    const auto wet = static_cast<std::uint8_t>(255.0 * run.strength * (1.0 - far));
    std::uint8_t& film = run.is_blood ? mark.blood : mark.bile;
    film = std::max(film, wet);
  }
  for (const render::Puddle& pool : pools_) {
    const Vec3 from = p_world - pool.centre;
    const double above = math::Dot(from, pool.up);
    if (above >= kShore) continue;
    const double side = math::Norm(from - above * pool.up);
    const double share = std::clamp((kShore - above) / (2.0 * kShore), 0.0, 1.0) *
                         std::clamp(4.0 * (kShoreWidth - side / pool.radius), 0.0, 1.0);
    const double all = pool.blood + pool.bile + pool.rinse;
    const auto wet = [&](double part) {
      return static_cast<std::uint8_t>(255.0 * share * std::min(1.0, 1.5 * part / all));
    };
    mark.blood = std::max(mark.blood, wet(pool.blood));
    mark.bile = std::max(mark.bile, wet(pool.bile));
  }
}

void Film::AddPool(const render::Puddle& puddle) {
  if (puddle.radius > 0.0 && puddle.blood + puddle.bile + puddle.rinse > 0.0) pools_.push_back(puddle);
}

void Film::Wet(const Vec3& p_world, std::size_t row, render::SurfaceMark& mark) const {
  Wet(p_world, mark);
  if (row < raw_.size() && raw_[row] != 0) mark.blood = std::max(mark.blood, kRawBlood);
}

}  // namespace trocar::view
