// SPDX-License-Identifier: Apache-2.0
/// \file label_measures.h  Where the voxels of a label lie in the body.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/images/image_stack.h"
#include "trocar/math/vector.h"

namespace trocar::anatomy {

/// How a map's axes lie. Vectors are (left, cranial, anterior), their zero is the centre of the first voxel.
struct VoxelFrame {
  std::array<double, 3> step_mm{};  ///< distance of voxels along each axis
  std::array<math::Vec3, 3> axes;   ///< unit vectors

  math::Vec3 PlaceOf(double i, double j, double k) const {
    return i * step_mm[0] * axes[0] + j * step_mm[1] * axes[1] + k * step_mm[2] * axes[2];
  }
  double VoxelMm3() const { return step_mm[0] * step_mm[1] * step_mm[2]; }
};

/// \param is_mirrored  left and right are taken the other way round
/// \return kLabelsMismatch for voxels that are not 0.01 to 20 mm, or axes that are not at right angles
base::Result<VoxelFrame> MakeVoxelFrame(const images::LabelVolume& labels, bool is_mirrored);

/// A side of the map at which a label ends because the map does.
struct CutSide {
  std::string side;  ///< "cranial"
  double area_mm2 = 0;
};

struct LabelMeasures {
  double volume_ml = 0;  ///< 0: the label does not occur, and nothing below means anything
  math::Vec3 centre;     ///< [mm]
  math::Vec3 min, max;   ///< of the voxels' centres [mm]
  /// Of the voxels' distribution along left. A liver's long thin lobe lies to the left: about 0.6 to 0.8.
  double skewness_left = 0;
  std::vector<CutSide> cuts;
};

LabelMeasures MeasureLabel(const images::LabelVolume& labels, int label, const VoxelFrame& frame);

}  // namespace trocar::anatomy
