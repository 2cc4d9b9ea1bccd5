// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "collision_tree_benchmark.h"
#include "trocar/bench/benchmark.h"
#include "trocar/collision/brute_force.h"
#include "trocar/files/scene_file.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/primitives.h"
#include "trocar/host/data_folder.h"
#include "trocar/math/random.h"
#include "trocar/patient/patient.h"
#include "trocar/scene/scene.h"

namespace trocar::bench {
namespace {

using collision::CentroidHierarchy;
using collision::NearestTriangle;
using collision::SegmentContact;
using geometry::TriangleMesh;
using math::Vec3;

constexpr std::size_t kQueries = 2000;           // enough that a clock's grain does not matter
constexpr std::size_t kModifiedTriangles = 100;  // about what a grasper moves in one tick

struct Queries {
  std::vector<Vec3> points;                  // within and around the mesh, in no order
  std::vector<Vec3> path;                    // each near the one before, as a tool moves
  std::vector<collision::Segment> segments;  // shafts from far in front to the points
};

Queries MakeQueries(const TriangleMesh& mesh) {
  const geometry::Box box = geometry::CalcBox(mesh.positions);
  const Vec3 centre = 0.5 * (box.min + box.max), half = 0.6 * (box.max - box.min);
  math::Random random(20240611);
  Queries queries;
  for (std::size_t i = 0; i < kQueries; ++i) {
    const Vec3 unit = {random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
    queries.points.push_back(centre + Vec3{unit.x * half.x, unit.y * half.y, unit.z * half.z});
    queries.segments.push_back({centre + Vec3{0, -half.y, 3 * half.z}, queries.points.back()});
    // three turns over the front of the organ
    const double angle = 6 * M_PI * static_cast<double>(i) / kQueries;
    queries.path.push_back(centre + Vec3{half.x * std::cos(angle), half.y * std::sin(angle), 0.8 * half.z});
  }
  return queries;
}

/// The mesh under a smooth push of a tenth of its size, and as it was.
void Deform(const TriangleMesh& mesh, std::vector<Vec3>& positions) {
  const geometry::Box box = geometry::CalcBox(mesh.positions);
  const double size = math::Distance(box.min, box.max);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const double distance = math::Distance(mesh.positions[i], box.max);
    positions[i] =
        mesh.positions[i] + Vec3{0, 0, -0.1 * size * std::exp(-distance * distance / (0.1 * size * size))};
  }
}

bool IsSame(const NearestTriangle& a, const NearestTriangle& b) {
  return a.triangle == b.triangle && a.squared_distance == b.squared_distance && a.point == b.point;
}

/// Times one organ and checks every answer against brute force.
base::Status RunMesh(const std::string& name, const TriangleMesh& mesh, const BenchmarkOptions& options,
                     BenchmarkResult& result) {
  const auto nothing = [] {};
  const double per_query_us = 1e6 / static_cast<double>(kQueries);
  const Queries queries = MakeQueries(mesh);
  base::Result<CentroidHierarchy> made = CentroidHierarchy::Make(mesh.positions, mesh.triangles);
  if (!made) return made.error();
  const double build = TimeShortest(options.repeats, nothing,
                                    [&] { made = CentroidHierarchy::Make(mesh.positions, mesh.triangles); });
  CentroidHierarchy hierarchy = std::move(made).value();

  // bottom-up update after a deformation, of everything and of a few triangles
  std::vector<Vec3> deformed = mesh.positions;
  Deform(mesh, deformed);
  std::vector<std::uint32_t> modified;
  for (std::size_t i = 0; i < kModifiedTriangles; ++i) {
    modified.push_back(static_cast<std::uint32_t>(i * mesh.triangles.size() / kModifiedTriangles));
  }
  const double update_all = TimeShortest(
      options.repeats, [&] { hierarchy.UpdateAll(mesh.positions); }, [&] { hierarchy.UpdateAll(deformed); });
  const double update_some =
      TimeShortest(options.repeats, nothing, [&] { hierarchy.Update(deformed, modified); });

  // the searches, on the deformed organ
  std::vector<NearestTriangle> exact(kQueries), brute(kQueries), along(kQueries), along_brute(kQueries);
  std::vector<SegmentContact> shaft(kQueries), shaft_brute(kQueries);
  std::vector<std::uint32_t> greedy(kQueries);
  const double greedy_time = TimeShortest(options.repeats, nothing, [&] {
    for (std::size_t i = 0; i < kQueries; ++i) greedy[i] = hierarchy.FindGreedy(queries.points[i]);
  });
  const double exact_time = TimeShortest(options.repeats, nothing, [&] {
    for (std::size_t i = 0; i < kQueries; ++i) exact[i] = hierarchy.FindNearest(deformed, queries.points[i]);
  });
  const double brute_time = TimeShortest(1, nothing, [&] {
    for (std::size_t i = 0; i < kQueries; ++i) {
      brute[i] = collision::FindNearestBruteForce(deformed, hierarchy.Triangles(), queries.points[i]);
    }
  });
  const double along_time = TimeShortest(options.repeats, nothing, [&] {
    collision::SearchLimits limits;
    for (std::size_t i = 0; i < kQueries; ++i) {
      along[i] = hierarchy.FindNearest(deformed, queries.path[i], limits);
      limits.first_guess = along[i].triangle;
    }
  });
  const double shaft_time = TimeShortest(options.repeats, nothing, [&] {
    for (std::size_t i = 0; i < kQueries; ++i) {
      shaft[i] = collision::FindNearestToSegment(hierarchy, deformed, queries.segments[i]);
    }
  });
  const double shaft_brute_time = TimeShortest(1, nothing, [&] {
    for (std::size_t i = 0; i < kQueries; ++i) {
      shaft_brute[i] =
          collision::FindNearestToSegmentBruteForce(deformed, hierarchy.Triangles(), queries.segments[i]);
    }
  });

  std::size_t missed = 0;
  for (std::size_t i = 0; i < kQueries; ++i) {
    along_brute[i] = collision::FindNearestBruteForce(deformed, hierarchy.Triangles(), queries.path[i]);
    if (!IsSame(exact[i], brute[i])) return WrongAnswer(name + "_exact", "not the nearest triangle");
    if (!IsSame(along[i], along_brute[i]))
      return WrongAnswer(name + "_exact_along_path", "not the nearest triangle");
    if (!IsSame(shaft[i].nearest, shaft_brute[i].nearest)) {
      return WrongAnswer(name + "_shaft", "not the nearest triangle to the shaft");
    }
    if (greedy[i] >= mesh.triangles.size()) return WrongAnswer(name + "_greedy", "no triangle at all");
    if (greedy[i] != exact[i].triangle) ++missed;
  }

  const auto add = [&](const char* what, double value, const char* unit) {
    result.cases.push_back({name + "_" + what, value, unit});
  };
  add("triangles", static_cast<double>(mesh.triangles.size()), "1");
  add("depth", hierarchy.Depth(), "1");
  add("build", 1e3 * build, "ms");
  add("update_all", 1e6 * update_all, "us");
  add("update_100_triangles", 1e6 * update_some, "us");
  add("greedy", greedy_time * per_query_us, "us");
  add("greedy_missed", 100.0 * static_cast<double>(missed) / kQueries, "%");
  add("exact", exact_time * per_query_us, "us");
  add("exact_along_path", along_time * per_query_us, "us");
  add("brute_force", brute_time * per_query_us, "us");
  add("shaft", shaft_time * per_query_us, "us");
  add("shaft_brute_force", shaft_brute_time * per_query_us, "us");
  result.ratios.push_back({name + "_brute_force_over_exact", brute_time / exact_time});
  result.ratios.push_back({name + "_exact_over_greedy", exact_time / greedy_time});
  result.ratios.push_back({name + "_shaft_brute_force_over_shaft", shaft_brute_time / shaft_time});
  return {};
}

}  // namespace

base::Result<BenchmarkResult> RunCollisionBenchmark(const BenchmarkOptions& options) {
  BenchmarkResult result;
  if (base::Status status = AddTreeBenchmark(options, result); !status) return status.error();
  // the paper's hierarchy, greedy and exact, on a ball with as many triangles as the paper's liver (5132), which needs no file
  if (base::Status status = RunMesh("sphere", geometry::MakeSphere({0, 0, 0}, 0.1, 4), options, result);
      !status) {
    return status.error();
  }
  const base::Result<std::filesystem::path> folder = host::FindDataFolder();
  if (!folder) return folder.error();
  const base::Result<scene::Scene> scene = files::ReadScene(*folder / "scenes/demonstration.json");
  if (!scene) return scene.error();
  for (const patient::Organ& organ : scene->patient.organs) {
    if (base::Status status = RunMesh(organ.name, organ.mesh, options, result); !status)
      return status.error();
  }
  return result;
}

}  // namespace trocar::bench
