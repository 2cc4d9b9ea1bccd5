// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/picture_detail.h"

#include <algorithm>
#include <array>

namespace trocar::presenter {
namespace {

using render::Quality;

constexpr std::array<PictureDetail::Step, 6> kSteps = {{{Quality::kHigh, 1},
                                                        {Quality::kLow, 1},
                                                        {Quality::kLow, 0.8},
                                                        {Quality::kLow, 0.65},
                                                        {Quality::kLow, 0.5},
                                                        {Quality::kLow, 0.4}}};
constexpr double kMost = 1.0 / 30;       // [s] that a picture may take
constexpr std::size_t kJudged = 5;       // pictures whose median counts
constexpr std::size_t kCalm = 150;       // pictures before a finer step is tried for the first time
constexpr std::size_t kMostCalm = 9000;  // and at most
constexpr double kHighCosts = 2;         // times of the lowest quality, at most: llvmpipe takes 1.1 to 1.3
constexpr double kFixedShare = 0.2;      // of a picture's time, at least, that its size does not change

double CalcArea(const PictureDetail::Step& step) {
  return step.resolution * step.resolution;
}

/// By how much longer a picture takes there, if its pixels alone take time.
double CalcGrowth(const PictureDetail::Step& from, const PictureDetail::Step& to) {
  return CalcArea(to) / CalcArea(from) *
         (from.quality == to.quality     ? 1
          : to.quality == Quality::kHigh ? kHighCosts
                                         : 1 / kHighCosts);
}

}  // namespace

PictureDetail::PictureDetail(bool is_drawn_by_processor)
    : finest_(is_drawn_by_processor ? 1 : 0), step_(finest_), calm_wanted_(kCalm) {}

const PictureDetail::Step& PictureDetail::Now() const {
  return kSteps[step_];
}

/// What a picture would take at the next finer step: part of its time does not depend on its size, and how much is known
/// once it has come up a step. [s]
double PictureDetail::CalcFiner(double median) const {
  const Step &now = kSteps[step_], &finer = kSteps[step_ - 1];
  const double growth = CalcGrowth(now, finer);
  if (now.quality != finer.quality) return median * growth;
  const double careful = median * (kFixedShare + (1 - kFixedShare) * growth);
  if (!coarser_) return careful;
  const double slope = std::max(0.0, median - *coarser_) / (CalcArea(now) - CalcArea(kSteps[step_ + 1]));
  return std::min(careful, median + slope * (CalcArea(finer) - CalcArea(now)));
}

void PictureDetail::Go(std::size_t step) {
  step_ = step;
  recent_.clear();
  calm_ = 0;
}

void PictureDetail::AddPicture(double seconds) {
  ++calm_;
  if (recent_.size() == kJudged) recent_.erase(recent_.begin());
  recent_.push_back(seconds);
  if (recent_.size() < kJudged) return;
  std::array<double, kJudged> sorted{};
  std::copy(recent_.begin(), recent_.end(), sorted.begin());
  std::sort(sorted.begin(), sorted.end());
  const double median = sorted[kJudged / 2];
  if (median > kMost && step_ + 1 < kSteps.size()) {
    calm_wanted_ = is_tried_ ? std::min(2 * calm_wanted_, kMostCalm) : calm_wanted_;
    is_tried_ = false;
    // no finer than would do if only pixels took time
    std::size_t next = step_ + 1;
    while (next + 1 < kSteps.size() && median * CalcGrowth(kSteps[step_], kSteps[next]) > kMost) ++next;
    Go(next);
    coarser_.reset();
    return;
  }
  if (calm_ < calm_wanted_) return;
  is_tried_ = false;  // it has stood as long as it was waited for
  if (step_ > finest_ && CalcFiner(median) < kMost) {
    Go(step_ - 1);
    coarser_ = median;
    is_tried_ = true;
  }
}

}  // namespace trocar::presenter
