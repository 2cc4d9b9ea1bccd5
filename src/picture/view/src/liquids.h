// SPDX-License-Identifier: Apache-2.0
/// \file liquids.h  Blood and bile on their way and where they gather.
#pragma once

#include <span>
#include <vector>

#include "pool_surface.h"
#include "trocar/geometry/triangle_mesh.h"
#include "trocar/render/renderer.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::view {

/// Adds what runs and drips out of every leak.
void AddStreams(render::Frame& frame, const simulation::Snapshot& snapshot);

/// Ground under a pool: a small piece of a surface that faces up or down.
struct GroundPiece {
  math::Vec3 p_world;  ///< [m]
  math::Vec3 area;     ///< normal times area [m^2]
};
/// One piece a vertex.
std::vector<GroundPiece> MakeGround(const geometry::TriangleMesh& mesh);

/// The pool. It fills the hollows round the lowest place, of what is drawn but belongs to no patient, and lies on the organs
/// that stand in it.
class Pool {
 public:
  explicit Pool(std::vector<geometry::TriangleMesh> scenery);

  /// Finds how high it stands; its surface is still that of the last call of Shape.
  void AddTo(render::Frame& frame, const simulation::Snapshot& snapshot) const;
  /// The surface of the pool that AddTo has added, made anew when level or ground have changed.
  /// \param organs  where they are now
  void Shape(render::Renderer& renderer, render::Frame& frame, const simulation::Snapshot& snapshot,
             std::vector<GroundShape> organs, std::span<const FatLobule> lobules);

 private:
  std::vector<geometry::TriangleMesh> scenery_;
  std::vector<GroundPiece> ground_;
  PoolSurface shape_;
  std::vector<math::Vec3> shown_;  // positions of the uploaded surface
  render::SurfaceId surface_;
};

}  // namespace trocar::view
