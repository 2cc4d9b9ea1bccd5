// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/slice_fits.h"

#include <algorithm>
#include <utility>

namespace trocar::contours {

using math::Vec2;

namespace {

/// Of the quick spline; its crossings are sought over all pairs of steps [pixels].
constexpr double kQuickStep = 2.0;

std::vector<std::vector<Vec2>> CurvesOf(const std::vector<std::shared_ptr<const ContourFit>>& fits) {
  std::vector<std::vector<Vec2>> curves;
  for (const auto& fit : fits) curves.push_back(fit->spline);
  return curves;
}

}  // namespace

std::vector<std::vector<Vec2>> SliceFit::ContourCurves() const {
  return CurvesOf(contours);
}
std::vector<std::vector<Vec2>> SliceFit::HoleCurves() const {
  return CurvesOf(holes);
}

SliceFits::SliceFits(std::shared_ptr<SliceStore> store) : store_(std::move(store)) {}

base::Result<std::shared_ptr<const SliceFit>> SliceFits::Find(int structure, const SliceContours& contours,
                                                              const EdgeAdaptionSettings& adaption,
                                                              FitEffort effort) {
  const std::tuple key(structure, contours.slice, effort);
  Source known;
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = sources_.find(key);
        found != sources_.end() && found->second.adaption == adaption) {
      known = found->second;
    }
  }
  if (known.fit != nullptr && known.contours == contours.contours && known.holes == contours.holes) {
    return known.fit;
  }

  auto fit = std::make_shared<SliceFit>();
  std::shared_ptr<const EdgeField> field;
  std::size_t computed = 0;
  const auto follow = [&](const std::vector<std::vector<Vec2>>& polygons,
                          const std::vector<std::vector<Vec2>>& known_polygons, const auto& known_fits,
                          auto& fits) -> base::Status {
    for (const auto& polygon : polygons) {
      const auto same = std::find(known_polygons.begin(), known_polygons.end(), polygon);
      if (known.fit != nullptr && same != known_polygons.end()) {
        fits.push_back(known_fits[static_cast<std::size_t>(same - known_polygons.begin())]);
        continue;
      }
      if (field == nullptr) {
        auto made = store_->Field(contours.slice, adaption.blur_px);
        if (!made.ok()) return made.error();
        field = std::move(*made);
      }
      ContourFitSettings settings;
      settings.adaption = adaption;
      if (effort == FitEffort::kQuick) {
        settings.is_inserting = false;
        settings.spline.step_px = kQuickStep;
      }
      fits.push_back(std::make_shared<const ContourFit>(FitContourToEdges(*field, polygon, settings)));
      ++computed;
    }
    return {};
  };
  static const SliceFit none;
  const SliceFit& old = known.fit != nullptr ? *known.fit : none;
  if (auto status = follow(contours.contours, known.contours, old.contours, fit->contours); !status.ok()) {
    return status.error();
  }
  if (auto status = follow(contours.holes, known.holes, old.holes, fit->holes); !status.ok()) {
    return status.error();
  }
  const std::lock_guard lock(mutex_);
  computed_ += computed;
  sources_[key] = {contours.contours, contours.holes, adaption, fit};
  return std::shared_ptr<const SliceFit>(std::move(fit));
}

std::size_t SliceFits::ComputedCount() const {
  const std::lock_guard lock(mutex_);
  return computed_;
}

void SliceFits::Clear() {
  const std::lock_guard lock(mutex_);
  sources_.clear();
}

}  // namespace trocar::contours
