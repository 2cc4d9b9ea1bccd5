// SPDX-License-Identifier: Apache-2.0
/// \file reproduce_collision.cpp  Figures 6 and 7: search and update of the centroid hierarchy over mesh size.
#include <algorithm>
#include <cmath>

#include "trocar/bench/benchmark.h"
#include "trocar/bench/experiment.h"
#include "trocar/collision/brute_force.h"
#include "trocar/collision/centroid_hierarchy.h"
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
using geometry::TriangleMesh;
using math::Vec3;

constexpr int kQueries = 1000;            // of the hierarchy, for one time
constexpr std::size_t kModified = 100;    // about what a grasper moves in one tick
constexpr double kPaperTriangles = 4000;  // "meshes of approximately 4000 triangles"
constexpr const char* kPaperTime = "3 ms for search and update together";

struct NamedMesh {
  std::string name;
  TriangleMesh mesh;
};

/// Balls of every size, a grid of the size of which the paper gives a time, and the built-in organs; by size.
base::Result<std::vector<NamedMesh>> FindMeshes(bool is_quick) {
  std::vector<NamedMesh> meshes;
  for (int subdivisions = 1; subdivisions <= (is_quick ? 3 : 5); ++subdivisions)
    meshes.push_back({"ball", geometry::MakeSphere({0, 0, 0}, 0.1, subdivisions)});
  meshes.push_back({"grid", geometry::MakeGrid(46, 0.004)});
  const auto folder = host::FindDataFolder();
  if (!folder.ok()) return folder.error();
  auto scene = files::ReadScene(*folder / "scenes/demonstration.json");
  if (!scene.ok()) return scene.error();
  for (patient::Organ& organ : scene->patient.organs)
    meshes.push_back({"built-in " + organ.name, std::move(organ.mesh)});
  std::sort(meshes.begin(), meshes.end(), [](const NamedMesh& a, const NamedMesh& b) {
    return a.mesh.triangles.size() < b.mesh.triangles.size();
  });
  return meshes;
}

/// A smooth push of a tenth of the mesh's size.
std::vector<Vec3> Deform(const TriangleMesh& mesh) {
  const geometry::Box box = geometry::CalcBox(mesh.positions);
  const double size = math::Distance(box.min, box.max);
  std::vector<Vec3> positions = mesh.positions;
  for (Vec3& p : positions) {
    const double distance = math::Distance(p, box.max);
    p.z -= 0.1 * size * std::exp(-distance * distance / (0.1 * size * size));
  }
  return positions;
}

/// Tips near the surface: a triangle's centroid and up to a fifth of the size away from it.
std::vector<Vec3> MakeTips(const TriangleMesh& mesh, const std::vector<Vec3>& positions) {
  const geometry::Box box = geometry::CalcBox(positions);
  const double reach = 0.2 * math::Distance(box.min, box.max);
  math::Random random(20240611);
  std::vector<Vec3> tips;
  for (int i = 0; i < kQueries; ++i) {
    const std::size_t triangle = static_cast<std::size_t>(i) * mesh.triangles.size() / kQueries;
    tips.push_back(collision::CalcCentroid(positions, mesh.triangles[triangle]) +
                   reach * Vec3{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)});
  }
  return tips;
}

struct Times {
  double greedy = 0, exact = 0, brute = 0;  // of one search [s]
  double update_all = 0, update_some = 0;   // [s]
  double missed = 0;                        // searches whose greedy answer is not the nearest [%]
};

base::Result<Times> Measure(const NamedMesh& named, const ExperimentOptions& options) {
  const TriangleMesh& mesh = named.mesh;
  auto made = CentroidHierarchy::Make(mesh.positions, mesh.triangles);
  if (!made) return made.error();
  CentroidHierarchy hierarchy = std::move(made).value();
  const std::vector<Vec3> deformed = Deform(mesh), tips = MakeTips(mesh, deformed);
  const int repeats = options.is_quick ? 1 : options.repeats;
  const auto nothing = [] {};
  std::vector<std::uint32_t> modified;
  const std::size_t modified_count = std::min(kModified, mesh.triangles.size());
  for (std::size_t i = 0; i < modified_count; ++i)
    modified.push_back(static_cast<std::uint32_t>(i * mesh.triangles.size() / modified_count));

  Times times;
  times.update_all = TimeShortest(
      repeats, [&] { hierarchy.UpdateAll(mesh.positions); }, [&] { hierarchy.UpdateAll(deformed); });
  times.update_some = TimeShortest(repeats, nothing, [&] { hierarchy.Update(deformed, modified); });
  std::vector<std::uint32_t> greedy(tips.size());
  std::vector<collision::NearestTriangle> exact(tips.size());
  times.greedy = TimeShortest(repeats, nothing,
                              [&] {
                                for (std::size_t i = 0; i < tips.size(); ++i)
                                  greedy[i] = hierarchy.FindGreedy(tips[i]);
                              }) /
                 kQueries;
  times.exact = TimeShortest(repeats, nothing,
                             [&] {
                               for (std::size_t i = 0; i < tips.size(); ++i)
                                 exact[i] = hierarchy.FindNearest(deformed, tips[i]);
                             }) /
                kQueries;
  int missed = 0, checked = 0;
  const host::Stopwatch stopwatch;
  for (std::size_t i = 0; i < tips.size(); i += 10, ++checked) {
    const auto brute = collision::FindNearestBruteForce(deformed, mesh.triangles, tips[i]);
    if (brute.triangle != exact[i].triangle)
      return WrongAnswer("fig6", "the exact search over the " + named.name + " is not exact");
  }
  times.brute = stopwatch.Seconds() / checked;
  for (std::size_t i = 0; i < tips.size(); ++i) missed += greedy[i] != exact[i].triangle;
  times.missed = 100.0 * missed / kQueries;
  return times;
}

std::string PaperCell(double triangles) {
  return std::fabs(triangles / kPaperTriangles - 1.0) < 0.1 ? kPaperTime : kNotReadable;
}

/// Runs every mesh and hands each result to `take`.
template <typename Take>
base::Status ForEachMesh(const ExperimentOptions& options, const Take& take) {
  const auto meshes = FindMeshes(options.is_quick);
  if (!meshes) return meshes.error();
  double done = 0;
  for (const NamedMesh& named : *meshes) {
    const auto times = Measure(named, options);
    if (!times) return times.error();
    take(named, static_cast<double>(named.mesh.triangles.size()), *times);
    options.progress(++done / static_cast<double>(meshes->size()));
  }
  return {};
}

PlotSettings LogPlot(const char* title, const char* y_label) {
  PlotSettings settings{title, "triangles", y_label};
  settings.is_log_x = settings.is_log_y = true;
  return settings;
}

constexpr const char* kMeshes =
    "Balls of 80 to 20,480 triangles, a grid of 4,050, and the built-in gallbladder and liver, each under a "
    "smooth push "
    "of a tenth of its size. ";

}  // namespace

ExperimentResult ReproduceFigure6(const ExperimentOptions& options, ExperimentStore&) {
  Experiment experiment{
      "fig6",
      "Figure 6: collision search over mesh size",
      std::string(kMeshes) +
          "A thousand tips around each; time of one search in the paper's hierarchy: its own greedy descent, "
          "the exact "
          "branch and bound over the same tree, and brute force over all triangles. Exact answers are "
          "checked against "
          "brute force.",
      {},
      {"The curve stands only in the paper's picture. Its text names one time, on an Intel Core2 Duo.",
       "The greedy descent never turns back: what it finds is often not the nearest triangle (column "
       "missed)."},
      {}};
  ExperimentTable table{
      "Time of one search",
      {"mesh", "triangles", "paper", "greedy [us]", "exact [us]", "brute force [us]", "missed [%]"},
      {}};
  std::vector<PlotLine> lines = {{"greedy (paper)", {}}, {"exact", {}}, {"brute force", {}}};
  const base::Status status =
      ForEachMesh(options, [&](const NamedMesh& named, double triangles, const Times& times) {
        table.rows.push_back({named.name,
                              {triangles, 9},
                              PaperCell(triangles),
                              {1e6 * times.greedy},
                              {1e6 * times.exact},
                              {1e6 * times.brute},
                              {times.missed, 3}});
        lines[0].points.push_back({triangles, 1e6 * times.greedy});
        lines[1].points.push_back({triangles, 1e6 * times.exact});
        lines[2].points.push_back({triangles, 1e6 * times.brute});
      });
  if (!status) return status.error();
  experiment.tables = {table};
  experiment.plots = {{LogPlot("Time of one search", "time [us]"), lines}};
  return experiment;
}

ExperimentResult ReproduceFigure7(const ExperimentOptions& options, ExperimentStore&) {
  Experiment experiment{
      "fig7",
      "Figure 7: update of the hierarchy over mesh size",
      std::string(kMeshes) +
          "Time to recompute every centroid and every node bottom-up, the same for a list of 100 modified "
          "triangles, and "
          "for one tick: update everything, then search.",
      {},
      {"The curve stands only in the paper's picture. Its text names one time, on an Intel Core2 Duo."},
      {}};
  ExperimentTable table{"Time of one update",
                        {"mesh", "triangles", "paper", "update all [us]", "update 100 [us]",
                         "update all and greedy search [us]", "update all and exact search [us]"},
                        {}};
  std::vector<PlotLine> lines = {
      {"update all", {}}, {"update 100 triangles", {}}, {"all + exact search", {}}};
  const base::Status status =
      ForEachMesh(options, [&](const NamedMesh& named, double triangles, const Times& times) {
        const double both = times.update_all + times.exact;
        table.rows.push_back({named.name,
                              {triangles, 9},
                              PaperCell(triangles),
                              {1e6 * times.update_all},
                              {1e6 * times.update_some},
                              {1e6 * (times.update_all + times.greedy)},
                              {1e6 * both}});
        lines[0].points.push_back({triangles, 1e6 * times.update_all});
        lines[1].points.push_back({triangles, 1e6 * times.update_some});
        lines[2].points.push_back({triangles, 1e6 * both});
      });
  if (!status) return status.error();
  experiment.tables = {table};
  experiment.plots = {{LogPlot("Time of one update", "time [us]"), lines}};
  return experiment;
}

}  // namespace trocar::bench
