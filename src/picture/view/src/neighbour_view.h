// SPDX-License-Identifier: Apache-2.0
/// \file neighbour_view.h  A patient's own neighbours as scenery: stomach, colon and what else lies round the operated organs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/patient/patient.h"
#include "trocar/render/renderer.h"
#include "trocar/render/surface_refiner.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::view {

/// Material of a neighbour: bowel is seen as it is, the rest lies behind fat or peritoneum.
render::Material LookOf(roles::NeighbourRole role) noexcept;
/// Whether it lies within the peritoneal cavity, so that the wall goes round it.
bool IsInCavity(roles::NeighbourRole role) noexcept;

class NeighbourView {
 public:
  /// \param index  of Patient::neighbours
  NeighbourView(const patient::Neighbour& neighbour, std::int32_t index);

  const geometry::TriangleMesh& Mesh() const { return mesh_; }  ///< at rest
  const std::vector<math::Vec3>& Normals() const { return normals_; }
  render::Material GetMaterial() const { return material_; }

  /// \param ambient_occlusion  (vertices) [-]
  void Add(render::Renderer& renderer, std::span<const double> ambient_occlusion);
  /// The surface with what tools have pressed into it.
  void Update(render::Renderer& renderer, const simulation::Snapshot& snapshot);
  render::SurfaceId Surface() const { return surface_; }
  const std::vector<math::Vec3>& FinePositions() const { return fine_positions_; }

 private:
  void Refine(render::Renderer* renderer);

  geometry::TriangleMesh mesh_;
  std::int32_t index_;
  render::Material material_;
  render::SurfaceRefiner refiner_;
  render::SurfaceId surface_;
  bool is_dented_ = false;  // on the graphics card
  std::vector<math::Vec3> positions_, normals_, fine_positions_, fine_normals_;
};

}  // namespace trocar::view
