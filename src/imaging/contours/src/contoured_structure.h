// SPDX-License-Identifier: Apache-2.0
/// \file contoured_structure.h  The first stage of the chain for one organ: control points become filled
/// slices.
/// Source: "General algorithms for laparoscopic surgical simulators", section 3.1.1.
#pragma once

#include <array>
#include <map>
#include <stop_token>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/contours/build_organs.h"
#include "trocar/contours/control_points.h"
#include "trocar/meshing/volume.h"

namespace trocar::contours {

/// Filled slices of one organ, in order.
struct ContouredStructure {
  OrganReport report;
  std::vector<meshing::FilledSlice> slices;
  std::vector<std::vector<std::vector<math::Vec2>>>
      curves;  ///< of each slice; empty where the slice has holes
  /// How far the organ goes on before the first and behind the last slice [mm].
  std::array<double, 2> ends_mm = {0, 0};
};

/// The contours that a person placed, on the edges of their slices.
///
/// \param[in,out] overlays  gain the stages of every contour
/// \return kContourTooShort for fewer than two slices; kContourEmpty with structure and slice; kCancelled
base::Result<ContouredStructure> FollowContours(const ControlPoints& points, const Structure& structure,
                                                const std::map<int, images::ColorImage>& images,
                                                const std::stop_token& stop,
                                                std::map<int, Overlay>& overlays);

/// Adds the slices between and beyond, from their pictures, where both neighbours have one contour without
/// holes. Elsewhere the shape interpolation of AddSlicesByShape is left to do it.
///
/// \return kUsage when a picture is neither in `images` nor read by options.read_skipped; its errors; kCancelled
base::Status AddSlicesByPictures(const ControlPoints& points, const Structure& structure,
                                 const std::map<int, images::ColorImage>& images, const OrganOptions& options,
                                 const images::Progress& progress, ContouredStructure& contoured);

/// Slices down to a millimetre: between two single contours by matching them, elsewhere by InsertSlices.
std::vector<meshing::FilledSlice> AddSlicesByShape(const ContouredStructure& contoured);

}  // namespace trocar::contours
