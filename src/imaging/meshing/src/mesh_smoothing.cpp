// SPDX-License-Identifier: Apache-2.0
#include "trocar/meshing/mesh_smoothing.h"

#include <oneapi/tbb/parallel_for.h>

#include <cmath>
#include <vector>

#include "trocar/base/assert.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/mesh_topology.h"

namespace trocar::meshing {

using math::Vec3;

void SmoothMesh(geometry::TriangleMesh& mesh, const SmoothingSettings& settings) {
  const double volume = geometry::CalcVolume(mesh.positions, mesh.triangles);
  TROCAR_ASSERT(volume > 0.0);
  const auto neighbours = geometry::FindVertexNeighbours(mesh.triangles, mesh.positions.size());
  std::vector<Vec3> moved(mesh.positions.size());
  const auto step = [&](double factor) {
    oneapi::tbb::parallel_for(std::size_t{0}, mesh.positions.size(), [&](std::size_t v) {
      const auto row = neighbours.Row(v);
      Vec3 mean;
      for (const auto other : row) mean += mesh.positions[other];
      const Vec3 here = mesh.positions[v];
      moved[v] = row.empty() ? here : here + factor * (mean / static_cast<double>(row.size()) - here);
    });
    std::swap(moved, mesh.positions);
  };
  const double swell = 1.0 / (settings.pass_band - 1.0 / settings.shrink);
  for (int i = 0; i < settings.iterations; ++i) {
    step(settings.shrink);
    step(swell);
  }
  SetVolume(mesh, volume);
}

void SetVolume(geometry::TriangleMesh& mesh, double volume) {
  constexpr double kTolerance = 1e-6;
  constexpr int kMaxRounds = 10;
  std::vector<Vec3> normals(mesh.positions.size());
  for (int round = 0; round < kMaxRounds; ++round) {
    const double missing = volume - geometry::CalcVolume(mesh.positions, mesh.triangles);
    if (std::fabs(missing) <= kTolerance * volume) return;
    geometry::CalcVertexNormals(mesh.positions, mesh.triangles, normals);
    const double offset = missing / geometry::CalcArea(mesh.positions, mesh.triangles);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) mesh.positions[v] += offset * normals[v];
  }
}

}  // namespace trocar::meshing
