// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/preparation_forecast.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "trocar/base/assert.h"

namespace trocar::assessment {
namespace {

/// Of the built-in patient at the normal level, rounded (docs/measurements.md); the gallbladder free is a guess between its neighbours.
/// Another patient only makes the estimate coarser. [s]
constexpr std::array<double, 5> kTypicalTimes = {0, 219, 261, 330, 359};
/// By the clock, before the pace counts as known [s].
constexpr double kKnownPace = 3;
/// From this part of the foreseen time on [-] the share only approaches kMostShare: the expert may take longer.
constexpr double kLinearShare = 0.9, kMostShare = 0.99;

/// \param part  of the foreseen time that has passed [-], >= 0
double CalcShare(double part) noexcept {
  if (part <= kLinearShare) return part;
  // begins with the same slope as before, and never arrives
  const double beyond = (part - kLinearShare) / (kMostShare - kLinearShare);
  return kLinearShare + (kMostShare - kLinearShare) * beyond / (1 + beyond);
}

}  // namespace

double TypicalTime(Milestone milestone) noexcept {
  return kTypicalTimes[static_cast<std::size_t>(milestone)];
}

PreparationForecast::PreparationForecast(Milestone reached, Milestone target, double seconds,
                                         double clock) noexcept
    : reached_(reached),
      target_(target),
      begin_(seconds),
      begin_clock_(clock),
      end_(seconds + TypicalTime(target) - TypicalTime(reached)) {
  TROCAR_ASSERT(reached < target);
}

void PreparationForecast::See(Milestone reached, double seconds, double clock) noexcept {
  if (reached >= target_) {
    share_ = 1;
    left_ = 0;
    is_late_ = false;
    return;
  }
  if (reached > reached_) {
    // what is left counts from where the expert really is
    reached_ = reached;
    end_ = seconds + TypicalTime(target_) - TypicalTime(reached);
  }
  const double done = seconds - begin_;
  share_ = std::max(share_, CalcShare(done / (end_ - begin_)));
  is_late_ = seconds >= end_;
  const double passed = clock - begin_clock_;
  left_.reset();
  if (!is_late_ && passed >= kKnownPace && done > 0) left_ = (end_ - seconds) * passed / done;
}

}  // namespace trocar::assessment
