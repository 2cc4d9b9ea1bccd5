// SPDX-License-Identifier: Apache-2.0
/// \file volume.h  Filled slices become a volume of signed distances, interpolated between the slices by
/// shape.
/// Source: Raya and Udupa, "Shape-based interpolation of multidimensional objects", IEEE TMI 1990;
/// Felzenszwalb and Huttenlocher, "Distance transforms of sampled functions", Theory of Computing 2012;
/// Fritsch and Carlson, "Monotone piecewise cubic interpolation", SIAM J. Numer. Anal. 1980.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/images/mask.h"
#include "trocar/math/vector.h"

namespace trocar::meshing {

/// Samples on a cubic lattice. Sample (i, j, k) lies at spacing * (first + (i, j, k)), so that two volumes of
/// the same spacing share their points.
struct ScalarVolume {
  double spacing = 1.0;                  ///< [mm]
  std::array<int, 3> first = {0, 0, 0};  ///< lattice index of sample (0, 0, 0)
  std::array<int, 3> size = {0, 0, 0};
  std::vector<float> values;  ///< (size product), first axis fastest; > 0 inside

  std::size_t Index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * size[1] + j) * size[0] + i;
  }
  math::Vec3 Position(int i, int j, int k) const {
    return {spacing * (first[0] + i), spacing * (first[1] + j), spacing * (first[2] + k)};
  }
};

/// Filled area of one slice.
struct FilledSlice {
  double position_mm = 0;  ///< along the stack
  images::Mask mask;
};

/// Exact squared Euclidean distance of every pixel to the nearest pixel that is set [pixels^2].
///
/// \param set  (height * width)
/// \return (height * width); infinity everywhere when none is set
std::vector<double> CalcSquaredDistances(std::span<const std::uint8_t> set, int width, int height);

/// Signed distance to the border of the set pixels [pixels], > 0 inside; the border runs halfway between
/// pixel centres.
std::vector<double> CalcSignedDistances(std::span<const std::uint8_t> set, int width, int height);

/// Adds slices between slices, so that no two are further apart than `step_mm`.
///
/// The area that two neighbours share is inside all the way. Where only one of them is inside, the border moves evenly
/// from the shared part outwards along the lines of nearest distance: a thin lobe whose end lies elsewhere in
/// each slice gets a straight edge, where interpolated distances would leave a tooth at every slice. Parts
/// that touch nothing shared shrink as their signed distances say.
/// Source: the idea of Iwanowski and Serra, "The morphological-affine object deformation", ISMM 2000 (median
/// sets).
std::vector<FilledSlice> InsertSlices(std::span<const FilledSlice> slices, double step_mm);

/// Takes away what is thinner than twice `radius_px` within the slice (a morphological opening by a disc):
/// tips that no triangle of the final mesh could carry. A slice that would vanish stays as it is.
void OpenMask(images::Mask& mask, double radius_px);

/// Volume of signed distances [mm] in the frame (column, row, stack) [mm].
///
/// Between two slices the distances are interpolated by a monotone cubic, so the shape moves over smoothly.
/// Beyond the first and last slice the shape closes as a paraboloid within `ends_mm`.
/// \param slices   ascending positions, at least two
/// \param ends_mm  how far the shape goes on before the first and behind the last slice [mm], > 0; by default
///                 half the distance to the next slice. Slices between which others were inserted say it
///                 themselves: on average an organ ends half way to the next slice that does not show it
/// \return kContourEmpty when a slice or the whole has no pixel inside
base::Result<ScalarVolume> MakeVolume(std::span<const FilledSlice> slices, double pixel_mm, double spacing_mm,
                                      std::optional<std::array<double, 2>> ends_mm = {});

/// Takes `other`, grown by `gap_mm`, away from `volume`.
/// \pre both have the same spacing (TROCAR_ASSERT)
void Subtract(ScalarVolume& volume, const ScalarVolume& other, double gap_mm);

/// Keeps the largest 6-connected part inside; the rest becomes outside. Closes inner cavities too.
void KeepLargestPart(ScalarVolume& volume);

}  // namespace trocar::meshing
