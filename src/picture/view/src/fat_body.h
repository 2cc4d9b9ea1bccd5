// SPDX-License-Identifier: Apache-2.0
/// \file fat_body.h  Fat as a surgeon sees it: lobules under one membrane, the smooth union of balls.
/// Source of the polygons: S. F. Frisken Gibson, "Constrained elastic surface nets", MICCAI 1998, without its relaxation.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::view {

struct FatLobule {
  math::Vec3 centre;  ///< [m]
  math::Vec3 rest;    ///< where it lay at the start: the pattern sticks to it [m]
  double radius = 0;  ///< [m]
};

/// Keeps its memory, so that a frame does not allocate once it has seen the largest body.
class FatBody {
 public:
  /// Surface round all lobules: near one of them a sphere, a soft groove between two.
  /// \param lobules  none gives no surface
  void Make(std::span<const FatLobule> lobules);

  const geometry::TriangleMesh& Mesh() const { return mesh_; }
  /// (vertices) place in the pattern [m]
  const std::vector<math::Vec3>& Rest() const { return rest_; }
  /// (vertices) how open it lies: darker in the grooves [-]
  const std::vector<double>& AmbientOcclusion() const { return occlusion_; }

 private:
  void Fill(std::span<const FatLobule> lobules);
  void AddVertices(std::span<const FatLobule> lobules);
  void AddTriangles();
  std::size_t At(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(size_[0]) +
           static_cast<std::size_t>(x);
  }

  math::Vec3 corner_;
  double cell_ = 0;  // edge of a cell [m]
  std::array<int, 3> size_{};
  std::vector<float> field_, best_, second_;  // of the grid's points
  std::vector<std::uint16_t> owner_;          // lobule whose share is best
  std::vector<std::int32_t> vertex_;          // of the grid's cells, -1 none
  geometry::TriangleMesh mesh_;
  std::vector<math::Vec3> rest_;
  std::vector<double> occlusion_;
};

}  // namespace trocar::view
