// SPDX-License-Identifier: Apache-2.0
/// \file tube_shape.h  The skin of a duct or vessel from its centre-line nodes, through clips and cuts.
#pragma once

#include <span>
#include <vector>

#include "film.h"
#include "row_memory.h"
#include "trocar/render/renderer.h"
#include "trocar/simulation/simulation.h"
#include "tube_course.h"

namespace trocar::view {

/// A run of centre-line nodes between two ends.
struct TubeChain {
  std::vector<std::uint32_t> rows;  ///< of the snapshot, at least 2
  std::vector<double> radii;        ///< (rows) [m]
  bool is_open_first = false;       ///< cut: the lumen shows
  bool is_open_last = false;

  friend bool operator==(const TubeChain&, const TubeChain&) = default;
};

/// Runs of one surface's pieces, in the order of their lowest rows. A branching ends a run.
/// \param info  of the tube: its first and last node are the ends that it has had from the beginning
std::vector<TubeChain> FindChains(std::span<const surgery::TubePiece> pieces, std::uint32_t surface,
                                  const scene::SurfaceInfo& info);

class TubeShape {
 public:
  /// \param start  rows of the first snapshot: the tube's nodes at rest [m]
  TubeShape(const scene::SurfaceInfo& info, std::uint32_t index, render::Material material,
            std::span<const math::Vec3> start, TubeLook look);

  /// Pieces after a cut. Where they have changed the surface is uploaded anew at the next Upload.
  void SetPieces(std::span<const surgery::TubePiece> pieces, RowMemory& memory,
                 std::span<const math::Vec3> positions);
  /// Moves the skin to a snapshot's nodes; clips press it flat.
  void Update(const simulation::Snapshot& snapshot, const Film& film);

  void Add(render::Renderer& renderer, std::span<const double> ambient_occlusion, RowMemory& memory);
  void Upload(render::Renderer& renderer, const RowMemory& memory);

  /// Adds what dissection leaves on the wall of a living tube: rags of peritoneum and threads. A piece keeps its own through a
  /// cut.
  void AddRemnants(render::Frame& frame) const;

  render::SurfaceId Surface() const { return surface_; }
  /// The dark of the open ends; names nothing without one.
  render::SurfaceId Lumens() const { return lumens_; }
  render::Material GetMaterial() const { return material_; }
  std::span<const geometry::Triangle> Triangles() const { return triangles_; }
  const std::vector<math::Vec3>& Positions() const { return positions_; }
  const std::vector<math::Vec3>& Normals() const { return normals_; }

 private:
  void Resize(std::span<const math::Vec3> rest_of_rows);
  void AddSurface(render::Renderer& renderer, const RowMemory& memory);
  void UpdateLumens();
  void AddRemnant(render::Frame& frame, std::size_t offset, const TubeCourse& course, std::size_t node,
                  std::uint32_t seed) const;

  scene::SurfaceInfo info_;
  std::uint32_t index_;
  render::Material material_;
  TubeLook look_;
  std::vector<math::Vec3> own_rest_;  // (node_count) at the start
  render::SurfaceId surface_, lumens_;
  bool is_changed_ = false, has_marks_ = false;
  std::vector<TubeChain> chains_;
  std::vector<TubeCourse> courses_;  // (chains)
  std::vector<geometry::Triangle> triangles_, lumen_triangles_;
  std::vector<math::Vec3> positions_, normals_, lumen_positions_, lumen_normals_;
  std::vector<math::Vec3> nodes_;  // of one chain
  std::vector<render::SurfaceMark> marks_;
};

}  // namespace trocar::view
