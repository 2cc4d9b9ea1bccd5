// SPDX-License-Identifier: Apache-2.0
/// \file test_systems.h  Small systems whose equilibrium is known.
#pragma once

#include "trocar/base/simd_level.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/mesh_topology.h"
#include "trocar/geometry/primitives.h"
#include "trocar/tissue/material.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::tissue {

/// A membrane on a foundation: springs by van Gelder, virtual springs by Winkler.
inline TissueDefinition MakeMembrane(const geometry::TriangleMesh& mesh, double membrane_modulus,
                                     double foundation_per_depth) {
  TissueDefinition definition;
  definition.rest = mesh.positions;
  const auto areas = geometry::CalcVertexAreas(mesh.positions, mesh.triangles);
  definition.shape_stiffness = CalcFoundationStiffness(areas, foundation_per_depth, 1.0);
  definition.mass.assign(mesh.positions.size(), 1e-4);
  const auto edges = geometry::FindEdges(mesh.triangles);
  const auto stiffness = CalcEdgeStiffness(mesh.positions, mesh.triangles, edges, membrane_modulus);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto [a, b] = edges[i];
    definition.springs.push_back({a, b, stiffness[i], math::Distance(mesh.positions[a], mesh.positions[b])});
  }
  return definition;
}

/// Two nodes, one above the other, joined by a spring along z; the upper one is fixed.
inline TissueDefinition MakeHangingSpring(double stiffness, double length, double mass) {
  TissueDefinition definition;
  definition.rest = {{0, 0, 0}, {0, 0, -length}};
  definition.mass = {0, mass};
  definition.shape_stiffness = {0, 0};
  definition.fixed = {0};
  definition.springs = {{0, 1, stiffness, length}};
  return definition;
}

/// All that this processor has.
inline std::vector<base::SimdLevel> Levels() {
  std::vector<base::SimdLevel> levels;
  for (const base::SimdLevel level :
       {base::SimdLevel::kBaseline, base::SimdLevel::kAvx2, base::SimdLevel::kAvx512}) {
    if (base::HasSimdLevel(level)) levels.push_back(level);
  }
  return levels;
}

}  // namespace trocar::tissue
