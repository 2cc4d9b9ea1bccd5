// SPDX-License-Identifier: Apache-2.0
/// \file organ_growth.h  A region grown in three dimensions from one click, held back by what is known of the organ's
/// shape.
/// Source: smoothing: Perona and Malik, "Scale-space and edge detection using anisotropic diffusion", PAMI 1990;
/// border: Chan and Vese, "Active contours without edges", IEEE Trans. Image Processing 2001, with local means as
/// Lankton and Tannenbaum, "Localizing region-based active contours", 2008, minimised by the threshold dynamics of
/// Esedoglu and Tsai, "Threshold dynamics for the piecewise constant Mumford-Shah functional", J. Comput. Phys. 2006;
/// distances: Felzenszwalb and Huttenlocher, "Distance transforms of sampled functions", Theory of Computing 2012.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/images/image_stack.h"
#include "trocar/roles/roles.h"

namespace trocar::contours {

/// Grey values on a lattice whose steps may differ.
struct GreyVolume {
  std::array<int, 3> size = {0, 0, 0};              ///< voxels, first axis fastest
  std::array<double, 3> step_mm = {1.0, 1.0, 1.0};  ///< > 0
  std::vector<float> values;                        ///< (size product) grey levels, 0 black to 255 white

  std::size_t Index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * size[1] + j) * size[0] + i;
  }
};

/// Prior knowledge of an organ, before the image is looked at.
struct ShapePrior {
  double click_mm = 4.0;    ///< radius of the click's neighbourhood whose greys are the organ's, > 0
  double opening_mm = 4.0;  ///< bridges thinner than twice this are cut, >= 0
  double closing_mm = 5.0;  ///< vessels narrower than twice this belong to the organ, >= 0
  double band_mm = 4.0;     ///< how far the border may then move to where the greys change, >= 0
  double tip_mm = 0.0;    ///< what sticks out of the result and is thinner than twice this is taken off, >= 0
  double wall_mm = 0.0;   ///< of another grey, laid around, >= 0
  double least_ml = 0.0;  ///< a smaller volume is no such organ
  double most_ml = 1e9;   ///< neither is a larger one
  std::array<double, 3> most_mm = {1e9, 1e9,
                                   1e9};           ///< longest extent along left-right, front-back, head-feet
  std::array<double, 2> hounsfield = {-1e9, 1e9};  ///< of its tissue on CT [HU]
};

/// The prior of an organ.
/// \return nothing for another role than liver or gallbladder
std::optional<ShapePrior> FindShapePrior(roles::OrganRole organ);

struct GrowthSettings {
  ShapePrior prior;
  /// Of the click's neighbourhood, else it is no such organ [grey levels].
  std::array<double, 2> greys = {-1e9, 1e9};
  bool uses_prior = true;  ///< off: whatever hangs together with the click by its grey; for comparison
  std::stop_token stop;
};

/// A region, and the greys that it was grown by.
struct GrownRegion {
  std::vector<std::uint8_t>
      inside;  ///< (size product) 0 or 1, one part connected by faces that holds the click
  double volume_ml = 0;
  double grey = 0;   ///< median around the click, of the smoothed volume [grey levels]
  double reach = 0;  ///< how far a grey may lie from it in the first step [grey levels]
};

/// Grows a region from a voxel.
///
/// The volume is smoothed along its edges; the median and the median deviation of the click's neighbourhood say which
/// greys are the organ's. What hangs together with the click by them is opened, so that bridges to neighbours of the
/// same grey are cut, and closed over vessels. Then the border moves to where the greys are halfway to those beside it.
/// \param seed     voxel of the click, inside the volume (TROCAR_ASSERT)
/// \param blocked  (size product) 1 where another organ is known to lie; empty: nowhere
/// \return kEditRefused, with what to do, where the click lies in air, in bone, on a border or in something too thin,
///         and where what grew is too small, too large or too long for the organ; kCancelled
base::Result<GrownRegion> GrowRegion(const GreyVolume& volume, const std::array<int, 3>& seed,
                                     const GrowthSettings& settings = {},
                                     const std::vector<std::uint8_t>& blocked = {},
                                     const images::Progress& progress = {});

/// Distance of each voxel's centre to the nearest one that is set [mm]; very large where none is.
std::vector<float> CalcDistances(const std::vector<std::uint8_t>& set, const std::array<int, 3>& size,
                                 const std::array<double, 3>& step_mm);

}  // namespace trocar::contours
