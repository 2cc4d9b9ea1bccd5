// SPDX-License-Identifier: Apache-2.0
/// \file slice_fits.h  Fitted contours of every slice, computed anew only where something changed.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <tuple>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/contours/contour_fill.h"
#include "trocar/contours/contour_fit.h"
#include "trocar/contours/control_points.h"
#include "trocar/contours/slice_store.h"

namespace trocar::contours {

/// The stages of a slice's closed contours.
struct SliceFit {
  // shared: a slice whose other contour moved keeps this one
  std::vector<std::shared_ptr<const ContourFit>> contours, holes;

  /// Curves only.
  std::vector<std::vector<math::Vec2>> ContourCurves() const;
  std::vector<std::vector<math::Vec2>> HoleCurves() const;
};

/// How much work a fit is worth.
enum class FitEffort {
  kQuick,  ///< while a point is dragged: adaption and a coarser spline, no points inserted between
  kWhole,
};

/// Remembers the fit of each contour by what it was computed from. Thread-safe.
class SliceFits {
 public:
  explicit SliceFits(std::shared_ptr<SliceStore> store);

  /// Fit of the closed contours of a slice. Equal contours, settings and pictures give equal bits, remembered
  /// or not.
  /// \param structure  index, under which the fit is remembered
  /// \return why the picture cannot be had
  base::Result<std::shared_ptr<const SliceFit>> Find(int structure, const SliceContours& contours,
                                                     const EdgeAdaptionSettings& adaption,
                                                     FitEffort effort = FitEffort::kWhole);

  /// How many contours were computed since the beginning.
  std::size_t ComputedCount() const;
  /// Forgets all, as after a change of the pictures.
  void Clear();

 private:
  struct Source {
    std::vector<std::vector<math::Vec2>> contours, holes;
    EdgeAdaptionSettings adaption;
    std::shared_ptr<const SliceFit> fit;
  };
  std::shared_ptr<SliceStore> store_;  // shared with the threads that fit
  mutable std::mutex mutex_;           // guards what follows; never held while fitting
  std::map<std::tuple<int, int, FitEffort>, Source> sources_;  // by structure, slice and effort
  std::size_t computed_ = 0;
};

}  // namespace trocar::contours
