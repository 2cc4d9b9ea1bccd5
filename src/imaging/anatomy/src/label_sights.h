// SPDX-License-Identifier: Apache-2.0
/// \file label_sights.h  Measures of each label that need no knowledge of its meaning: size, place, shape, contact with others.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include "label_measures.h"
#include "trocar/images/image_stack.h"

namespace trocar::anatomy {

/// Measured on a lattice of about 3 mm, except the volume, which is the voxels'.
struct LabelSight {
  double volume_ml = 0;
  math::Vec3 centre, min, max;  ///< left, cranial, anterior [mm]
  double elongation =
      1;  ///< longest by shortest axis of the distribution of its voxels, as standard deviations
  double largest_part = 1;           ///< share of it that hangs together
  bool is_at_border = false;         ///< of the map, which may cut it
  std::optional<double> density_hu;  ///< median of its voxels in the CT, where that is there
  std::map<int, double> beside;      ///< share of its surface that lies within 6 mm of each other label

  double ContactWith(int label) const {
    const auto found = beside.find(label);
    return found == beside.end() ? 0.0 : found->second;
  }
};

struct LabelSights {
  std::map<int, LabelSight> labels;
  math::Vec3 min, max;  ///< of all [mm]

  const LabelSight* Find(int label) const {
    const auto found = labels.find(label);
    return found == labels.end() ? nullptr : &found->second;
  }
};

/// More different labels than any segmentation has: an image, perhaps.
inline constexpr std::size_t kMostLabels = 1024;

/// \return nothing where there is no label, or more than kMostLabels
LabelSights LookAtLabels(const images::LabelVolume& volume, const VoxelFrame& frame);

/// "label 5: 1402 mL, right, high, in front; label 2: ...": the largest, each with its place in the box of all.
std::string ListSights(const LabelSights& sights);

}  // namespace trocar::anatomy
