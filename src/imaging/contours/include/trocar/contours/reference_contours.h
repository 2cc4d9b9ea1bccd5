// SPDX-License-Identifier: Apache-2.0
/// \file reference_contours.h  Outlines of a label in the pictures' frame, and how far points lie from them.
/// Source: Lorensen and Cline's marching cubes in two dimensions (marching squares).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/contours/control_points.h"
#include "trocar/images/image_stack.h"

namespace trocar::contours {

/// Step of one voxel along column, row and slice of the series [mm].
///
/// The label map must cover the series: its first slice is first_slice, its corner the picture's corner, its
/// axes the picture's.
/// \return kLabelsMismatch when it does not
base::Result<std::array<double, 3>> FindLabelStep(const images::LabelVolume& labels,
                                                  const ControlPoints& points);

/// A closed outline: contours run clockwise as the picture is seen, holes the other way round.
struct Outline {
  std::vector<math::Vec2> points;  ///< closed polyline [pixels]
  double area_px = 0;              ///< > 0: contour; < 0: hole [pixels^2]
  double length_px = 0;
};

/// Outlines of a label in the slice of the series that lies nearest.
///
/// The labels' steps are rounded by a Gaussian of one voxel before the border is drawn at one half.
/// \param step  from FindLabelStep
/// \return largest first; empty when the label does not occur there or the slice lies outside
std::vector<Outline> TraceLabel(const images::LabelVolume& labels, const ControlPoints& points,
                                const std::array<double, 3>& step, int label, int slice);

/// Distance of a point to the nearest outline [pixels].
/// \pre at least one outline (TROCAR_ASSERT)
double DistanceToOutlines(const math::Vec2& p, std::span<const Outline> outlines);

}  // namespace trocar::contours
