// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/volume_mesher.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "trocar/anatomy/marching_cubes.h"
#include "trocar/anatomy/mesh_decimation.h"

namespace trocar::anatomy {
namespace {

using geometry::TriangleMesh;

/// Triangles of the first surface for each one wanted: fewer show the lattice, more only take time.
constexpr double kTrianglesForEach = 12.0;
/// Share of the budget that repair may not go below.
constexpr double kFewest = 0.98;
/// How much more smoothing each further attempt gets [-].
constexpr double kMoreSmoothing[] = {1.0, 1.6, 2.5};
/// A halved lattice needs this share of the rounds for the same effect in millimetres.
constexpr double kRoundsWhenHalved = 0.25;
/// Volume that halving may change before it is given up: thin parts were lost.
constexpr double kVolumeLost = 0.01;

double CalcVolume(const TriangleMesh& mesh) {
  return geometry::CalcVolume(mesh.positions, mesh.triangles);
}

/// The surface to decimate, with the rounds of smoothing that suit its lattice.
struct FirstSurface {
  TriangleMesh mesh;
  double rounds = 1.0;  // as a share of those asked for
};

/// Halves the volume while its surface stays fine enough for the budget and keeps its parts.
std::optional<FirstSurface> MakeCoarserSurface(const ScalarVolume& volume, const TriangleMesh& fine,
                                               double wanted) {
  std::optional<FirstSurface> coarser;
  ScalarVolume halved;
  const ScalarVolume* from = &volume;
  const int genus = geometry::InspectMesh(fine).genus;
  for (double triangles = static_cast<double>(fine.triangles.size()) / 4; triangles >= wanted;
       triangles /= 4) {
    ScalarVolume next = HalveResolution(*from);
    KeepLargestPart(next);
    TriangleMesh mesh = MarchCubes(next);
    if (mesh.triangles.empty() || std::fabs(CalcVolume(mesh) / CalcVolume(fine) - 1.0) > kVolumeLost) break;
    if (geometry::InspectMesh(mesh).genus > genus) break;
    coarser = FirstSurface{std::move(mesh), kRoundsWhenHalved * (coarser ? coarser->rounds : 1.0)};
    halved = std::move(next);
    from = &halved;
  }
  return coarser;
}

}  // namespace

ScalarVolume HalveResolution(const ScalarVolume& volume) {
  const auto outside = static_cast<float>(-0.5 * volume.spacing);
  ScalarVolume half;
  half.spacing = 2.0 * volume.spacing;
  for (int axis = 0; axis < 3; ++axis) {
    // every coarse sample that a fine one reaches
    half.first[axis] = static_cast<int>(std::floor(volume.first[axis] / 2.0));
    const int last = static_cast<int>(std::floor((volume.first[axis] + volume.size[axis]) / 2.0));
    half.size[axis] = last - half.first[axis] + 1;
  }
  half.values.assign(static_cast<std::size_t>(half.size[0]) * half.size[1] * half.size[2], outside);
  constexpr float kWeights[3] = {0.25f, 0.5f, 0.25f};
  oneapi::tbb::parallel_for(0, half.size[2], [&](int k) {
    // nine rows of the fine volume blend into one, then every second sample of that
    std::vector<float> row(static_cast<std::size_t>(volume.size[0]) + 4);
    for (int j = 0; j < half.size[1]; ++j) {
      std::fill(row.begin(), row.end(), 0.0f);
      const auto add = [&](float weight, const float* from) {
        for (int i = 0; i < volume.size[0]; ++i) row[static_cast<std::size_t>(i) + 2] += weight * from[i];
      };
      float empty = 0;
      for (int dk = -1; dk <= 1; ++dk) {
        for (int dj = -1; dj <= 1; ++dj) {
          const int fine_k = 2 * (half.first[2] + k) + dk - volume.first[2];
          const int fine_j = 2 * (half.first[1] + j) + dj - volume.first[1];
          const float weight = kWeights[dk + 1] * kWeights[dj + 1];
          if (fine_k < 0 || fine_j < 0 || fine_k >= volume.size[2] || fine_j >= volume.size[1])
            empty += weight;
          else
            add(weight, &volume.values[volume.Index(0, fine_j, fine_k)]);
        }
      }
      for (int i = 0; i < volume.size[0]; ++i) row[static_cast<std::size_t>(i) + 2] += empty * outside;
      row[0] = row[1] = row[row.size() - 2] = row[row.size() - 1] = outside;
      for (int i = 0; i < half.size[0]; ++i) {
        // padded index of the fine sample in the middle
        const int at = 2 * (half.first[0] + i) - volume.first[0] + 2;
        half.values[half.Index(i, j, k)] = kWeights[0] * row[static_cast<std::size_t>(at) - 1] +
                                           kWeights[1] * row[static_cast<std::size_t>(at)] +
                                           kWeights[2] * row[static_cast<std::size_t>(at) + 1];
      }
    }
  });
  return half;
}

core::Result<MeshedVolume> MeshVolume(ScalarVolume volume, const MeshingSettings& settings) {
  KeepLargestPart(volume);
  const TriangleMesh fine = MarchCubes(volume);
  if (fine.triangles.empty()) {
    return core::Error{core::ErrorCode::kContourEmpty,
                       "the volume encloses nothing; check its contours or labels"};
  }
  const double enclosed = CalcVolume(fine);
  const auto coarser = MakeCoarserSurface(volume, fine, kTrianglesForEach * settings.triangle_budget);
  const TriangleMesh& surface = coarser ? coarser->mesh : fine;

  std::optional<MeshedVolume> best;
  for (const double more : kMoreSmoothing) {
    TriangleMesh smooth = surface;
    SmoothingSettings smoothing = settings.smoothing;
    smoothing.iterations =
        static_cast<int>(std::lround(more * (coarser ? coarser->rounds : 1.0) * smoothing.iterations));
    SmoothMesh(smooth, smoothing);
    SetVolume(smooth, enclosed);
    auto decimated = DecimateMesh(smooth, {.triangle_budget = settings.triangle_budget});
    if (!decimated.ok()) return decimated.error();
    MeshedVolume made{std::move(*decimated), {}, {}};
    RepairSettings repair;
    repair.min_angle_deg = settings.min_angle_deg;
    repair.fewest_triangles = static_cast<std::size_t>(std::ceil(kFewest * settings.triangle_budget));
    made.repair = RepairMesh(made.mesh, repair);
    if (!best || made.repair.self_intersections < best->repair.self_intersections) best = std::move(made);
    if (best->repair.self_intersections == 0) break;
  }
  best->quality = InspectQuality(best->mesh, fine, settings.distance_samples);
  return std::move(*best);
}

}  // namespace trocar::anatomy
