// SPDX-License-Identifier: Apache-2.0
#include "trocar/meshing/volume_mesher.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "sliver_removal.h"
#include "trocar/base/to_integer.h"
#include "trocar/meshing/marching_cubes.h"
#include "trocar/meshing/mesh_decimation.h"

namespace trocar::meshing {
namespace {

using geometry::TriangleMesh;

/// Share of the budget that repair may not go below.
constexpr double kFewest = 0.98;
/// Smoothing of each attempt, as a share of what was asked for. Thin necks are cut by too much of it, thin
/// rims by too little.
constexpr double kSmoothingShares[] = {1.0, 0.4, 0.16, 0.07, 1.6, 2.5};
/// A halved lattice needs this share of the rounds for the same effect in millimetres.
constexpr double kRoundsWhenHalved = 0.25;
/// Halving is given up where it changes more of the volume than this, or loses more of it: samples inside
/// that have no coarse sample inside around them.
constexpr double kVolumeChanged = 0.01, kVolumeLost = 2e-4;

double CalcVolume(const TriangleMesh& mesh) {
  return geometry::CalcVolume(mesh.positions, mesh.triangles);
}

/// Least triangles for each one wanted, and most of the volume that may be lost, where clefts are closed by halving
/// once more.
constexpr double kFewestWhenBlunt = 2.0, kVolumeLostWhenBlunt = 0.01;

/// The surface to decimate, with the rounds of smoothing that suit its lattice.
struct FirstSurface {
  TriangleMesh mesh;
  double rounds = 1.0;  // as a share of those asked for
  int halvings = 0;     // of the volume that it comes from
};

/// Share of the samples inside whose nearest sample of the halved volume lies outside with all its
/// neighbours.
double CalcShareLost(const ScalarVolume& volume, const ScalarVolume& half) {
  // what lies within one sample of the inside, by one axis after the other
  std::vector<std::uint8_t> near(half.values.size());
  for (std::size_t v = 0; v < near.size(); ++v) near[v] = half.values[v] > 0;
  const std::array<std::size_t, 3> strides = {1, static_cast<std::size_t>(half.size[0]),
                                              static_cast<std::size_t>(half.size[0]) * half.size[1]};
  for (const std::size_t stride : strides) {
    const std::vector<std::uint8_t> before = near;
    for (std::size_t v = stride; v + stride < near.size(); ++v)
      near[v] = before[v - stride] | before[v] | before[v + stride];
  }
  std::vector<std::size_t> inside(static_cast<std::size_t>(volume.size[2])), lost(inside.size());
  oneapi::tbb::parallel_for(0, volume.size[2], [&](int k) {
    const auto coarse = [&](int axis, int fine) {
      return std::clamp(base::FloorTo<int>((volume.first[axis] + fine) / 2.0) - half.first[axis], 0,
                        half.size[axis] - 1);
    };
    for (int j = 0; j < volume.size[1]; ++j) {
      const float* row = &volume.values[volume.Index(0, j, k)];
      for (int i = 0; i < volume.size[0]; ++i) {
        if (!(row[i] > 0)) continue;
        ++inside[static_cast<std::size_t>(k)];
        if (!near[half.Index(coarse(0, i), coarse(1, j), coarse(2, k))]) ++lost[static_cast<std::size_t>(k)];
      }
    }
  });
  std::size_t all = 0, gone = 0;
  for (std::size_t k = 0; k < inside.size(); ++k) all += inside[k], gone += lost[k];
  return static_cast<double>(gone) / static_cast<double>(all);
}

/// The surface of the volume halved once more than before: clefts close that are too narrow for the triangles, whose
/// walls would cut each other. Nothing where that leaves too few triangles or takes too much away.
std::optional<FirstSurface> MakeBlunterSurface(const ScalarVolume& volume, const FirstSurface& before,
                                               double budget) {
  ScalarVolume halved = volume;
  for (int i = 0; i <= before.halvings; ++i) {
    ScalarVolume next = HalveResolution(halved);
    KeepLargestPart(next);
    if (CalcShareLost(halved, next) > kVolumeLostWhenBlunt) return std::nullopt;
    halved = std::move(next);
  }
  TriangleMesh mesh = MarchCubes(halved);
  if (static_cast<double>(mesh.triangles.size()) < kFewestWhenBlunt * budget) return std::nullopt;
  return FirstSurface{std::move(mesh), kRoundsWhenHalved * before.rounds, before.halvings + 1};
}

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
    if (CalcShareLost(*from, next) > kVolumeLost) break;
    TriangleMesh mesh = MarchCubes(next);
    if (mesh.triangles.empty() || std::fabs(CalcVolume(mesh) / CalcVolume(fine) - 1.0) > kVolumeChanged)
      break;
    if (geometry::InspectMesh(mesh).genus > genus) break;
    coarser = FirstSurface{std::move(mesh), kRoundsWhenHalved * (coarser ? coarser->rounds : 1.0),
                           coarser ? coarser->halvings + 1 : 1};
    halved = std::move(next);
    from = &halved;
  }
  return coarser;
}

/// A mesh with what is still wrong with it.
struct Attempt {
  MeshedVolume made;
  std::size_t slivers = 0;

  bool IsGood() const { return made.repair.self_intersections == 0 && slivers == 0; }
  bool operator<(const Attempt& other) const {
    return std::pair(made.repair.self_intersections, slivers) <
           std::pair(other.made.repair.self_intersections, other.slivers);
  }
};

/// Smooths, decimates and repairs.
/// \param share  of the smoothing that was asked for
base::Result<Attempt> MeshSurface(const FirstSurface& surface, double enclosed, double share,
                                  const MeshingSettings& settings) {
  TriangleMesh smooth = surface.mesh;
  SmoothingSettings smoothing = settings.smoothing;
  smoothing.iterations = base::RoundTo<int>(share * surface.rounds * smoothing.iterations);
  SmoothMesh(smooth, smoothing);
  SetVolume(smooth, enclosed);
  auto decimated = DecimateMesh(smooth, {.triangle_budget = settings.triangle_budget});
  if (!decimated.ok()) return decimated.error();
  Attempt attempt{{std::move(*decimated), {}, {}}};
  RepairSettings repair;
  repair.min_angle_deg = settings.min_angle_deg;
  repair.fewest_triangles = base::CeilTo<std::size_t>(kFewest * settings.triangle_budget);
  attempt.made.repair = RepairMesh(attempt.made.mesh, repair);
  attempt.slivers = RemoveSlivers(attempt.made.mesh, {.least_angle_deg = settings.sliver_angle_deg,
                                                      .fewest_triangles = repair.fewest_triangles});
  return attempt;
}

}  // namespace

ScalarVolume HalveResolution(const ScalarVolume& volume) {
  const auto outside = static_cast<float>(-0.5 * volume.spacing);
  ScalarVolume half;
  half.spacing = 2.0 * volume.spacing;
  for (int axis = 0; axis < 3; ++axis) {
    // every coarse sample that a fine one reaches
    half.first[axis] = base::FloorTo<int>(volume.first[axis] / 2.0);
    const int last = base::FloorTo<int>((volume.first[axis] + volume.size[axis]) / 2.0);
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

base::Result<MeshedVolume> MeshVolume(ScalarVolume volume, const MeshingSettings& settings) {
  KeepLargestPart(volume);
  const TriangleMesh fine = MarchCubes(volume);
  if (fine.triangles.empty()) {
    return base::Error{base::ErrorCode::kContourEmpty,
                       "the volume encloses nothing; check its contours or labels"};
  }
  const double enclosed = CalcVolume(fine);
  auto coarser = MakeCoarserSurface(volume, fine, settings.oversampling * settings.triangle_budget);
  std::optional<FirstSurface> surface = coarser ? std::move(*coarser) : FirstSurface{fine};
  std::optional<Attempt> best;
  for (int bluntness = 0; bluntness < 2 && surface && !(best && best->IsGood()); ++bluntness) {
    for (const double share : kSmoothingShares) {
      auto attempt = MeshSurface(*surface, enclosed, share, settings);
      if (!attempt.ok()) {
        // a blunter surface is a second choice: what there is already stands
        if (bluntness > 0) break;
        return attempt.error();
      }
      if (!best || *attempt < *best) best = std::move(*attempt);
      if (best->IsGood()) break;
    }
    if (!best->IsGood()) surface = MakeBlunterSurface(volume, *surface, settings.triangle_budget);
  }
  best->made.quality = InspectQuality(best->made.mesh, fine, settings.distance_samples);
  return std::move(best->made);
}

}  // namespace trocar::meshing
