// SPDX-License-Identifier: Apache-2.0
/// \file pool_surface.h  The surface of a liquid that lies on uneven ground: level where it is deep, drawn up at its shore.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "fat_body.h"
#include "trocar/geometry/triangle_mesh.h"
#include "trocar/render/renderer.h"

namespace trocar::view {

/// A surface that liquid may lie on; outlives the call that takes it.
struct GroundShape {
  std::span<const math::Vec3> positions;          ///< world frame [m]
  std::span<const geometry::Triangle> triangles;  ///< over positions
};

/// Keeps its memory, so that a frame does not allocate once it has seen the largest pool.
class PoolSurface {
 public:
  /// The level meets the ground: how thick the liquid is at each point of a lattice, and the mesh over it.
  ///
  /// \param puddle  its centre, up and radius count
  /// \param lowest  place of the ground under its middle [m]
  /// \param ground  where none is known it is a bowl that ends at the puddle's radius
  /// \param lobules  of fat, world frame: where they stand in the liquid it has a shore, too
  void Make(const render::Puddle& puddle, const math::Vec3& lowest, std::span<const GroundShape> ground,
            std::span<const FatLobule> lobules = {});

  const geometry::TriangleMesh& Mesh() const { return mesh_; }
  /// (vertices) place on the level, for ripples [m]
  const std::vector<math::Vec3>& Rest() const { return rest_; }
  /// (vertices) share of colour and opacity: 0 at the shore, nearly 1 where it is deep [-]
  const std::vector<double>& Shares() const { return shares_; }
  /// (vertices) of the liquid; below 0 on the shore above its level [m]
  const std::vector<double>& Depths() const { return depths_; }

 private:
  void MeetGround(const GroundShape& shape);
  void MeetLobule(const FatLobule& lobule);
  void FindThickness(const render::Puddle& puddle, double deepest);
  void AddBanks();
  void AddVertices();
  void AddTriangles();
  std::size_t At(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(column);
  }

  math::Vec3 corner_, right_, ahead_, up_;  // of the lattice, on the level
  int side_ = 0;                            // points
  std::vector<math::Vec3> lattice_;   // (vertices of a ground) column, row [-], height above the level [m]
  std::vector<double> heights_;       // (points) of the ground above the level [m]
  std::vector<double> overhangs_;     // (points) lowest of what stands or hangs well above it [m]
  std::vector<double> clearances_;    // (points) from lobules, on the level; below 0 in one [m]
  std::vector<double> thickness_;     // (points) of the liquid [m]
  std::vector<std::int32_t> vertex_;  // of a point, -1 none
  geometry::TriangleMesh mesh_;
  std::vector<math::Vec3> rest_;
  std::vector<double> shares_, depths_;
};

/// Share of what lies below that a liquid hides, 0 to 1 [-]. \param depth  thickness of the liquid [m]
double CalcPoolShare(double depth) noexcept;

}  // namespace trocar::view
