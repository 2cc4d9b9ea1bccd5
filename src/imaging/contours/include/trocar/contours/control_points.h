// SPDX-License-Identifier: Apache-2.0
/// \file control_points.h  The file of control points that a person placed on cross-sectional pictures.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/contours/edge_adaption.h"
#include "trocar/math/vector.h"

namespace trocar::contours {

/// Control points of one structure in one slice, closed polygons in pixels (pixel centres at whole numbers).
struct SliceContours {
  int slice = 0;
  std::vector<std::vector<math::Vec2>> contours;  ///< each >= 3 points
  std::vector<std::vector<math::Vec2>> holes;     ///< cut out of the contours
  std::vector<math::Vec2> open;                   ///< points of a contour that is not closed yet; drafts only

  friend bool operator==(const SliceContours&, const SliceContours&) = default;
};

/// One organ.
struct Structure {
  std::string name;         ///< "liver"
  int triangle_budget = 0;  ///< the mesh has at most this many triangles
  int reference_label = 0;  ///< value in a reference label map, 0 if it has none
  std::array<int, 2> reference_left_out = {
      0, -1};  ///< first and last slice where the reference is known to be wrong
  EdgeAdaptionSettings adaption;
  std::vector<SliceContours> slices;  ///< ascending
};

/// One point of a duct or vessel.
struct TubePoint {
  double slice = 0;
  math::Vec2 pixel;
  double radius_mm = 0;
};

struct TubePoints {
  std::string name;  ///< "cystic_duct"
  std::string kind;  ///< "duct" or "artery"
  std::string from, to;
  bool is_seen = true;  ///< false: placed by landmarks because the pictures do not show it
  std::vector<TubePoint> points;
};

/// A place that was pointed at in one picture.
struct LandmarkPoint {
  std::string name;
  double slice = 0;
  math::Vec2 pixel;
};

/// Everything a person placed, and how the pictures lie in the body.
struct ControlPoints {
  std::string name;
  std::string provenance;
  std::string image_pattern;  ///< "image-{slice:04}.jpeg"; empty for a series that is no stack of pictures
  int first_slice = 0, last_slice = 0;    ///< numbers of the series, first <= last
  int width = 0, height = 0;              ///< [pixels]
  double pixel_mm = 1.0, slice_mm = 1.0;  ///< distance between pixels and between slices
  std::array<std::string, 3> axes;  ///< where column, row and slice number grow to: "left", "anterior", ...
  std::string origin_landmark;      ///< landmark of the built patient whose place in the world is given
  std::array<double, 3> origin_mm = {0, 0, 0};  ///< that place: left, cranial, anterior of the umbilicus
  std::vector<Structure> structures;
  std::vector<TubePoints> tubes;
  std::vector<LandmarkPoint> landmarks;

  const Structure* FindStructure(std::string_view structure_name) const;
  const LandmarkPoint* FindLandmark(std::string_view landmark_name) const;
};

/// Maps (column, row, slice) to directions of the world (left, cranial, anterior): +1, -1 or 0.
/// \return [image axis][world axis]
/// \pre axes were checked by ParseControlPoints
std::array<std::array<double, 3>, 3> AxisDirections(const ControlPoints& points);

/// Required completeness of a file of control points.
enum class Completeness {
  kPatient,  ///< a volume can be made: every structure has contours in two slices, none is open
  kDraft,    ///< work in progress: structures and slices may still be empty, contours open
};

/// \return kJsonSyntax or kJsonField; kControlPointOutside or kContourTooShort with structure, slice and
/// point
base::Result<ControlPoints> ParseControlPoints(std::string_view text, std::string_view source,
                                               Completeness completeness = Completeness::kPatient);
base::Result<ControlPoints> ReadControlPoints(const std::filesystem::path& path,
                                              Completeness completeness = Completeness::kPatient);

/// JSON with one contour a line; ParseControlPoints reads it back unchanged (coordinates to 0.01 pixel).
std::string FormatControlPoints(const ControlPoints& points);
base::Status WriteControlPoints(const std::filesystem::path& path, const ControlPoints& points);

}  // namespace trocar::contours
