// SPDX-License-Identifier: Apache-2.0
/// \file tube_course.h  The uneven course and calibre of a duct or vessel between the nodes of its model. Looks only.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "trocar/math/vector.h"

namespace trocar::view {

/// How uneven a tube is drawn.
enum class TubeLook {
  kEven,   ///< a ring of skin at each node, as of rubber
  kLiving  ///< a smooth line through the nodes, whose course, calibre and wall vary a little
};

/// Skin round one run of nodes. Unevenness sticks to the place at rest: a cut leaves it where it was.
class TubeCourse {
 public:
  static constexpr int kSides = 12;

  /// \param rest   (n) n >= 2, nodes at rest [m]
  /// \param radii  (n) of the model [m]
  /// \param fixed  places at rest where the tube joins something: it is even there [m]
  TubeCourse(std::span<const math::Vec3> rest, std::span<const double> radii,
             std::span<const math::Vec3> fixed, TubeLook look);

  /// Rings from node to node.
  std::size_t Steps() const { return steps_; }
  std::size_t RingCount() const { return radii_.size(); }
  std::size_t SkinSize() const { return radii_.size() * kSides + 2; }
  /// Radius of the wall's middle at each ring [m].
  std::span<const double> Radii() const { return radii_; }

  /// Vertices as geometry::MakeTubeTriangles(RingCount(), kSides) joins them.
  /// \param nodes      (n) where they are now [m]
  /// \param[out] skin  (SkinSize()) [m]
  void CalcSkin(std::span<const math::Vec3> nodes, std::span<math::Vec3> skin);

  /// A vertex lies between two nodes of the run.
  struct Place {
    std::size_t node = 0;  ///< and the next
    double share = 0;      ///< of the way to it, 0 to 1
  };
  Place PlaceOf(std::size_t vertex) const;

 private:
  math::Vec3 CentreOf(std::span<const math::Vec3> nodes, std::size_t ring) const;
  void CalcEvenSkin(std::span<const math::Vec3> nodes, std::span<math::Vec3> skin);

  std::size_t steps_;
  std::vector<double> radii_;      // (rings)
  std::vector<math::Vec3> bends_;  // (rings) from the smooth line [m]
  std::vector<double> swells_;     // (rings * kSides) of the radius [-]
  std::vector<math::Vec3> centres_;
};

}  // namespace trocar::view
