// SPDX-License-Identifier: Apache-2.0
/// \file organ_shape.h  An organ's surface from the nodes of a snapshot to the vertices that are drawn, through cuts.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "film.h"
#include "row_memory.h"
#include "trocar/render/renderer.h"
#include "trocar/render/surface_refiner.h"
#include "trocar/simulation/simulation.h"

namespace trocar::view {

class OrganShape {
 public:
  /// \param index  of the surface in Simulation::Surfaces()
  OrganShape(const scene::SurfaceInfo& info, std::uint32_t index, render::Material material);

  /// Connectivity after a cut, over rows of the snapshot. Where it has changed the surface is uploaded anew at the next
  /// Upload.
  void SetTriangles(std::span<const geometry::Triangle> triangles, std::span<const math::Vec3> positions,
                    RowMemory& memory);
  /// Moves the vertices to a snapshot's nodes.
  void Update(const simulation::Snapshot& snapshot, const Film& film);

  /// First upload.
  /// \param ambient_occlusion  (vertices before they are refined) [-]
  void Add(render::Renderer& renderer, std::span<const double> ambient_occlusion, RowMemory& memory);
  void Upload(render::Renderer& renderer, const RowMemory& memory);

  render::SurfaceId Surface() const { return surface_; }
  render::Material GetMaterial() const { return material_; }
  /// Before it is refined.
  std::span<const geometry::Triangle> Triangles() const { return triangles_; }
  const std::vector<math::Vec3>& Positions() const { return positions_; }
  const std::vector<math::Vec3>& Normals() const { return normals_; }

 private:
  void Resize();
  void LearnAreas(const RowMemory& memory);
  void AddSurface(render::Renderer& renderer, const RowMemory& memory);

  std::int32_t surface_index_;
  render::Material material_;
  render::SurfaceId surface_;
  bool is_changed_ = false;                        // connectivity, since the last upload
  bool has_marks_ = false;                         // on the graphics card
  std::vector<geometry::Triangle> row_triangles_;  // of the last SetTriangles
  std::vector<std::uint32_t> rows_;                // vertex -> row of the snapshot
  std::vector<geometry::Triangle> triangles_;      // over vertices
  std::vector<math::Vec3> positions_, normals_;
  std::vector<double> rest_areas_;  // (vertices) of the triangles round each; empty until it is known [m^2]
  std::vector<double> areas_;       // now
  std::optional<render::SurfaceRefiner> refiner_;
  std::vector<math::Vec3> fine_positions_, fine_normals_;
  std::vector<render::SurfaceMark> marks_;  // fine; empty: none to show
  std::vector<render::SurfaceMark> shown_;  // of the uploaded surface
};

/// Marks of the drawn vertices from those of the coarse ones, each edge's middle between its ends.
void RefineMarks(std::span<const geometry::Edge> edges, std::size_t coarse,
                 std::vector<render::SurfaceMark>& marks);

/// How white tissue is that is stretched over so many times its area at rest: 0 to 255.
std::uint8_t CalcPallor(double stretch) noexcept;

/// Marks that heat has left on a node.
render::SurfaceMark HeatMark(const simulation::OperationSnapshot& operation, std::size_t row);

}  // namespace trocar::view
