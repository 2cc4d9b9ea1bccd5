// SPDX-License-Identifier: Apache-2.0
/// \file label_volume.h  One label of a label map becomes a volume of distances.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/images/image_stack.h"
#include "trocar/meshing/volume.h"

namespace trocar::meshing {

struct LabelVolumeSettings {
  double spacing_mm = 1.0;   ///< of the volume's lattice, > 0
  double thinnest_mm = 5.0;  ///< what is thinner within a slice is cut off: no triangle could carry it
  double blur_mm = 2.0;      ///< width of the blur, about 1.4 times its standard deviation: label maps have
                             ///< tunnels and threads of a voxel or two that no organ has
};

/// Makes voxels of `label` that do not hang together (6-connected) with its largest part 0.
/// \return voxels of each part that there was, the largest first; empty where the label does not occur
std::vector<std::size_t> KeepLargestPart(images::LabelVolume& labels, int label);

/// Slices of one label along the third axis that are not empty, with square pixels of `pixel_mm`.
/// \param voxel_mm  distance of voxels along each axis [mm], > 0
std::vector<FilledSlice> FillLabelSlices(const images::LabelVolume& labels, int label,
                                         const std::array<double, 3>& voxel_mm, double pixel_mm);

/// Volume of distances from slices, smoothed, its surface moved so that it encloses `enclosed_mm3`.
/// \return kContourEmpty for fewer than two slices
base::Result<ScalarVolume> MakeLabelVolume(std::vector<FilledSlice> slices, double pixel_mm,
                                           double enclosed_mm3, const LabelVolumeSettings& settings = {});

/// Spacing of a lattice whose surface has about 18 triangles for each one wanted: finer shows no more [mm].
///
/// The area is that of the exposed sides of the filled pixels, which a surface of all directions has one and
/// a half times.
/// \param triangle_budget  > 0
/// \pre at least two slices (TROCAR_ASSERT)
double SuggestSpacing(std::span<const FilledSlice> slices, double pixel_mm, int triangle_budget);

}  // namespace trocar::meshing
