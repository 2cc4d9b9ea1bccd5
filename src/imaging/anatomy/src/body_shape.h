// SPDX-License-Identifier: Apache-2.0
/// \file body_shape.h  Shape of the body in a label map: its midline, the height of the navel, its front.
#pragma once

#include <map>
#include <optional>
#include <utility>

#include "label_neighbours.h"

namespace trocar::anatomy {

/// Front of what lies behind the abdominal wall, seen from the front: greatest z over cells of x and y. World frame [m].
class FrontMap {
 public:
  static constexpr double kCell = 0.005;  ///< [m]

  void Add(const math::Vec3& p);
  /// Greatest z within `radius` of a place; nothing where nothing lies there.
  std::optional<double> FindHeight(double x, double y, double radius) const;

 private:
  std::map<std::pair<int, int>, double> heights_;
};

/// World frame of the assembled patient [m].
struct BodyShape {
  std::optional<double> midline;    ///< x
  bool is_midline_of_spine = true;  ///< false: between aorta and vena cava
  std::optional<double> navel;      ///< y, between the third and fourth lumbar vertebrae
  FrontMap organs;                  ///< of everything labelled
  FrontMap skin;                    ///< empty where the map has none
};

/// From a sample of the voxels, about 3 mm apart.
/// \param shift  of the map's frame [m]: world = 0.001 map + shift
BodyShape MeasureBody(const images::LabelVolume& volume, const NeighbourLabels& labels,
                      const VoxelFrame& frame, const math::Vec3& shift);

}  // namespace trocar::anatomy
