// SPDX-License-Identifier: Apache-2.0
/// \file grow_contours.h  A start for an organ's contours: one click into it on CT or MR, and closed contours of few
/// points on every n-th slice, which a person then corrects.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/contours/contour_document.h"
#include "trocar/contours/organ_growth.h"
#include "trocar/contours/slice_store.h"
#include "trocar/images/image_series.h"

namespace trocar::contours {

/// All that growing needs; a value, so that it can be handed to a thread.
struct GrowthRequest {
  ControlPoints points;          ///< as they are now: geometry, and where the other organs lie
  int structure = 0;             ///< index of the organ to grow
  int slice = 0;                 ///< of the click
  math::Vec2 click;              ///< [pixels]
  std::vector<int> slices;       ///< of the series, ascending in equal steps
  images::DisplayWindow window;  ///< that `read` shows the greys through
  bool is_hounsfield = false;    ///< the greys are CT numbers
  SliceReader read;              ///< through that window
  bool uses_prior = true;        ///< off: without what is known of the organ's shape, for comparison
};

/// \param series     the pictures; a copy is kept
/// \param structure  index (TROCAR_ASSERT)
GrowthRequest MakeGrowthRequest(const images::ImageSeries& series, const ControlPoints& points, int structure,
                                int slice, const math::Vec2& click);

/// Whether an organ of that name can grow from a click: liver and gallbladder can.
bool CanGrow(std::string_view organ);

/// Contours of an organ, not yet in a document.
struct GrownOrgan {
  int structure = 0;
  std::string name;  ///< of the structure
  std::vector<SliceContours>
      slices;              ///< ascending: the first and last that show the organ, every n-th between
  std::size_t points = 0;  ///< in all of them
  double volume_ml = 0;    ///< of the region they were drawn around
};

/// Grows the organ and draws contours around it: about 6 mm apart for the liver and 4 mm for the gallbladder, each
/// with as few points as follow the region within 0.8 mm, at most 28.
///
/// Areas that other structures' contours enclose stay theirs. The liver must lie right of the body's midline on CT, the
/// gallbladder within 60 mm of liver contours where there are some.
/// \return kEditRefused where the structure is neither liver nor gallbladder, the pictures are coloured, the click lies
///         outside of them, or nothing like the organ grew, each with what to do; kCancelled; what reading returns
base::Result<GrownOrgan> GrowOrgan(const GrowthRequest& request, std::stop_token stop = {},
                                   const images::Progress& progress = {});

/// Replaces the contours of the structure by the grown ones, as one step that can be undone; open contours stay. Its points
/// are not moved to edges from then on, until somebody sets a reach.
/// \return kEditRefused where the structure has gone or has another name since
base::Status ApplyGrowth(ContourDocument& document, const GrownOrgan& grown);

/// Few points of a closed polyline whose spline follows it.
/// \param tolerance_px  the spline comes this near to each place of the outline, unless `most` points do not reach
/// \return 4 to `most` of its points, in order
/// \pre at least 4 points, most >= 4 (TROCAR_ASSERT)
std::vector<math::Vec2> ChooseFewPoints(const std::vector<math::Vec2>& outline, double tolerance_px,
                                        int most);

}  // namespace trocar::contours
