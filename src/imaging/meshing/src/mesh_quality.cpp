// SPDX-License-Identifier: Apache-2.0
#include "trocar/meshing/mesh_quality.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "trocar/base/assert.h"
#include "trocar/meshing/nearest_surface.h"

namespace trocar::meshing {
namespace {

using geometry::TriangleMesh;
using math::Vec3;

/// The vertices, and points spread evenly over the area: a triangle gets as many as its share, at places of a
/// low-discrepancy sequence (Roberts 2018, R2) folded into it.
std::vector<Vec3> SampleMesh(const TriangleMesh& mesh, std::size_t samples) {
  std::vector<Vec3> points = mesh.positions;
  if (points.size() >= samples) return points;
  const double area = geometry::CalcArea(mesh.positions, mesh.triangles);
  const double density = static_cast<double>(samples - points.size()) / area;
  double owed = 0;
  std::size_t n = 0;
  for (const auto& t : mesh.triangles) {
    owed += density * 0.5 * Norm(geometry::CalcAreaNormal(mesh.positions, t));
    for (; owed >= 1.0; owed -= 1.0, ++n) {
      double u = std::fmod(0.5 + 0.7548776662466927 * static_cast<double>(n), 1.0);
      double v = std::fmod(0.5 + 0.5698402909980532 * static_cast<double>(n), 1.0);
      if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
      points.push_back((1.0 - u - v) * mesh.positions[t[0]] + u * mesh.positions[t[1]] +
                       v * mesh.positions[t[2]]);
    }
  }
  return points;
}

std::vector<double> FindDistances(const std::vector<Vec3>& points, const TriangleMesh& surface) {
  const NearestSurface nearest(surface);
  std::vector<double> distances(points.size());
  oneapi::tbb::parallel_for(std::size_t{0}, points.size(),
                            [&](std::size_t i) { distances[i] = nearest.Find(points[i]).distance; });
  return distances;
}

void Summarise(const std::vector<double>& distances, double& largest, double& mean, std::size_t& count) {
  count = distances.size();
  for (const double d : distances) {
    largest = std::max(largest, d);
    mean += d / static_cast<double>(count);
  }
}

}  // namespace

SurfaceDistance CalcSurfaceDistance(const TriangleMesh& mesh, const TriangleMesh& reference,
                                    std::size_t samples) {
  TROCAR_ASSERT(samples > 0 && !mesh.triangles.empty() && !reference.triangles.empty());
  SurfaceDistance distance;
  Summarise(FindDistances(SampleMesh(mesh, samples), reference), distance.largest_from_mesh,
            distance.mean_from_mesh, distance.mesh_samples);
  std::vector<Vec3> points;
  const std::size_t stride = std::max<std::size_t>(1, reference.positions.size() / samples);
  for (std::size_t v = 0; v < reference.positions.size(); v += stride)
    points.push_back(reference.positions[v]);
  Summarise(FindDistances(points, mesh), distance.largest_from_reference, distance.mean_from_reference,
            distance.reference_samples);
  return distance;
}

MeshQuality InspectQuality(const TriangleMesh& mesh, const TriangleMesh& reference, std::size_t samples) {
  MeshQuality quality;
  quality.surface = geometry::InspectMesh(mesh);
  quality.self_intersections = geometry::CountSelfIntersections(mesh);
  quality.volume_change =
      quality.surface.volume / geometry::CalcVolume(reference.positions, reference.triangles) - 1.0;
  if (samples > 0) quality.distance = CalcSurfaceDistance(mesh, reference, samples);
  return quality;
}

}  // namespace trocar::meshing
