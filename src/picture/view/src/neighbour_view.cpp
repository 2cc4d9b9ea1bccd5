// SPDX-License-Identifier: Apache-2.0
#include "neighbour_view.h"

#include <algorithm>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/patient/patient.h"

namespace trocar::view {

using render::Material;
using roles::NeighbourRole;

Material LookOf(NeighbourRole role) noexcept {
  switch (role) {
    case NeighbourRole::kPancreas:
    case NeighbourRole::kRightKidney:
      return Material::kFat;
    case NeighbourRole::kVenaCava:
    case NeighbourRole::kAorta:
    case NeighbourRole::kPortalVein:
    case NeighbourRole::kRibs:
    case NeighbourRole::kSpine:
      return Material::kPeritoneum;
    default:
      return Material::kBowel;
  }
}

bool IsInCavity(NeighbourRole role) noexcept {
  return LookOf(role) == Material::kBowel;
}

NeighbourView::NeighbourView(const patient::Neighbour& neighbour, std::int32_t index)
    : mesh_(neighbour.mesh),
      index_(index),
      material_(LookOf(neighbour.role)),
      refiner_(mesh_.triangles, mesh_.positions.size()),
      positions_(mesh_.positions),
      normals_(positions_.size()),
      fine_positions_(refiner_.VertexCount()),
      fine_normals_(refiner_.VertexCount()) {
  Refine(nullptr);
}

void NeighbourView::Refine(render::Renderer* renderer) {
  geometry::CalcVertexNormals(positions_, mesh_.triangles, normals_);
  refiner_.Refine(positions_, normals_, fine_positions_, fine_normals_);
  if (renderer != nullptr) renderer->UpdateSurface(surface_, fine_positions_, fine_normals_);
}

void NeighbourView::Add(render::Renderer& renderer, std::span<const double> ambient_occlusion) {
  std::vector<double> fine(ambient_occlusion.begin(), ambient_occlusion.end());
  for (const auto& edge : refiner_.Edges())
    fine.push_back(0.5 * (ambient_occlusion[edge[0]] + ambient_occlusion[edge[1]]));
  surface_ = renderer.AddSurface(refiner_.Triangles(), fine_positions_, material_, fine, mesh_.triangles);
}

void NeighbourView::Update(render::Renderer& renderer, const simulation::Snapshot& snapshot) {
  const bool is_dented = std::any_of(snapshot.dents.begin(), snapshot.dents.end(),
                                     [&](const surgery::Dent& dent) { return dent.neighbour == index_; });
  if (!is_dented && !is_dented_) return;
  is_dented_ = is_dented;
  positions_ = mesh_.positions;
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    for (const surgery::Dent& dent : snapshot.dents) {
      if (dent.neighbour == index_) positions_[v] += dent.ShiftOf(mesh_.positions[v]);
    }
  }
  Refine(&renderer);
}

}  // namespace trocar::view
