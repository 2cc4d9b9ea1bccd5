// SPDX-License-Identifier: Apache-2.0
/// \file label_alignment.h  Brings a label map onto the grid of the images that it was drawn on, or says that it was drawn on others.
#pragma once

#include "trocar/base/result.h"
#include "trocar/images/image_series.h"
#include "trocar/images/image_stack.h"

namespace trocar::images {

/// The map with one voxel a pixel of the series, slice after slice, whichever way its own axes run: each pixel has the label of the voxel
/// that it lies in. Where the images do not say where they lie in the body (pictures), the map must have their axes and
/// their extent, and is taken as it is.
/// \return kLabelsMismatch with what does not fit: less than kLeastInside of what is labelled lies in the images, or axes or extents differ
base::Result<LabelVolume> AlignLabels(LabelVolume labels, const ImageSeriesInfo& series);

inline constexpr double kLeastInside = 0.9;  ///< of the labelled voxels [-]

}  // namespace trocar::images
