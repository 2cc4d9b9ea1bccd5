// SPDX-License-Identifier: Apache-2.0
/// \file reference_judge.h  Compares a built structure with reference labels. It judges; nothing is ever
/// placed by it.
/// Source: Dice, "Measures of the amount of ecologic association between species", Ecology
/// 1945.
#pragma once

#include <array>

#include "trocar/base/result.h"
#include "trocar/contours/control_points.h"
#include "trocar/geometry/triangle_mesh.h"
#include "trocar/images/image_stack.h"

namespace trocar::contours {

/// A structure against its reference, over the slices that count.
struct Judgement {
  double volume_ml = 0;
  double reference_ml = 0;
  double ratio = 0;  ///< volume / reference volume [-]
  double dice = 0;   ///< 2 |A and B| / (|A| + |B|) [-]
};

/// Fills the mesh into the reference's voxels and counts.
///
/// The label map must cover the series: its first slice is first_slice, its corner the picture's corner, its
/// axes the picture's.
/// \param mesh  closed, in the frame of the pictures: column, row, slice times their
/// distances [mm]
/// \param left_out  first and last slice that do not count; none when the last comes before
/// the first
/// \return kLabelsMismatch when the label map does not cover the series or holds no such label
base::Result<Judgement> Judge(const images::LabelVolume& reference, const ControlPoints& points, int label,
                              const geometry::TriangleMesh& mesh, std::array<int, 2> left_out);

}  // namespace trocar::contours
