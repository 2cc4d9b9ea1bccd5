// SPDX-License-Identifier: Apache-2.0
#include "collision_tree_benchmark.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "embree_comparison.h"
#include "trocar/collision/brute_force.h"
#include "trocar/collision/triangle_tree.h"
#include "trocar/math/random.h"

namespace trocar::bench {
namespace {

using collision::NearestTriangle;
using collision::Segment;
using collision::TriangleTree;
using geometry::TriangleMesh;
using math::Vec3;

constexpr std::size_t kChecked = 1000;      // queries against brute force, each on another shape
constexpr std::size_t kRoundsARepeat = 60;  // deformations that are timed
constexpr double kShaftRadius = 0.0025;     // [m]
/// Embree works in single precision: what its answer may differ by [m].
constexpr double kSinglePrecision = 1e-6;

/// A dented, bent body the size of a liver, closed but for its poles, of 2 * around * along triangles.
TriangleMesh MakeBody(std::uint32_t around, std::uint32_t along) {
  TriangleMesh mesh;
  for (std::uint32_t j = 0; j <= along; ++j) {
    const double v = M_PI * (0.02 + 0.96 * j / along);
    for (std::uint32_t i = 0; i < around; ++i) {
      const double u = 2 * M_PI * i / around;
      const double r = 0.07 * (1 + 0.15 * std::sin(3 * u) * std::sin(2 * v));
      const double x = 1.5 * r * std::cos(u) * std::sin(v);
      mesh.positions.push_back({x, r * std::sin(u) * std::sin(v), 0.7 * r * std::cos(v) + 2.0 * x * x});
    }
  }
  for (std::uint32_t j = 0; j < along; ++j) {
    for (std::uint32_t i = 0; i < around; ++i) {
      const std::uint32_t a = j * around + i, b = j * around + (i + 1) % around, c = a + around,
                          d = b + around;
      mesh.triangles.push_back({a, d, b});
      mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

/// The body as a wave runs through it: every vertex moves in every round.
void Deform(const TriangleMesh& mesh, std::size_t round, std::vector<Vec3>& positions) {
  const double phase = 0.37 * static_cast<double>(round);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3& p = mesh.positions[i];
    positions[i] = p + Vec3{0.001 * std::sin(60 * p.z + phase), 0.002 * std::cos(50 * p.x + phase),
                            0.004 * std::sin(40 * p.y + phase)};
  }
}

Vec3 RandomPoint(math::Random& random) {
  return {random.Uniform(-0.13, 0.13), random.Uniform(-0.09, 0.09), random.Uniform(-0.06, 0.09)};
}

/// A shaft from a trocar in front of the body to a point at its surface or in it.
Segment RandomShaft(math::Random& random) {
  const Vec3 port{random.Uniform(-0.1, 0.1), random.Uniform(-0.1, 0.1), 0.2};
  return {RandomPoint(random), port};
}

struct Exactness {
  std::size_t asked = 0, exact = 0, greedy_found = 0, greedy_asked = 0;

  void Count(const NearestTriangle& found, const NearestTriangle& oracle) {
    ++asked;
    exact += found.triangle == oracle.triangle && found.squared_distance == oracle.squared_distance &&
             found.point == oracle.point;
  }
};

/// Every answer against brute force, each on another shape; with the paper's greedy search beside it.
base::Status CheckAnswers(const TriangleMesh& mesh, Exactness& exactness) {
  auto tree = TriangleTree::Make(mesh.positions, mesh.triangles);
  if (!tree) return tree.error();
  auto hierarchy = collision::CentroidHierarchy::Make(mesh.positions, mesh.triangles);
  if (!hierarchy) return hierarchy.error();
  std::vector<Vec3> positions = mesh.positions;
  math::Random random(11);
  for (std::size_t i = 0; i < kChecked; ++i) {
    Deform(mesh, i, positions);
    tree->Update(positions);
    hierarchy->UpdateAll(positions);
    const Vec3 p = RandomPoint(random);
    const NearestTriangle oracle = collision::FindNearestBruteForce(positions, mesh.triangles, p);
    exactness.Count(tree->FindNearest(positions, p), oracle);
    ++exactness.greedy_asked;
    exactness.greedy_found += hierarchy->FindGreedy(p) == oracle.triangle;
    if (i % 4 != 0) continue;
    const Segment shaft = RandomShaft(random);
    exactness.Count(tree->FindNearestToSegment(positions, shaft).nearest,
                    collision::FindNearestToSegmentBruteForce(positions, mesh.triangles, shaft).nearest);
  }
  return {};
}

double Median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Update and one query, ours and Embree's in turn on the same shapes; medians.
base::Status TimeUpdateAndQuery(const std::string& name, const TriangleMesh& mesh,
                                const BenchmarkOptions& options, BenchmarkResult& result) {
  auto tree = TriangleTree::Make(mesh.positions, mesh.triangles);
  if (!tree) return tree.error();
  std::string why_not;
  const std::unique_ptr<EmbreeMesh> embree = EmbreeMesh::Make(mesh, why_not);
  std::vector<Vec3> positions = mesh.positions;
  std::vector<double> ours, theirs;
  math::Random random(12);
  const std::size_t rounds = kRoundsARepeat * static_cast<std::size_t>(std::max(1, options.repeats));
  for (std::size_t round = 0; round < rounds; ++round) {
    Deform(mesh, round, positions);
    const Vec3 p = RandomPoint(random);
    const host::Stopwatch stopwatch;
    tree->Update(positions);
    const NearestTriangle nearest = tree->FindNearest(positions, p);
    ours.push_back(stopwatch.Seconds());
    if (!embree) continue;
    embree->SetPositions(positions);
    const host::Stopwatch embree_stopwatch;
    embree->Refit();
    const double distance = embree->FindDistance(p);
    theirs.push_back(embree_stopwatch.Seconds());
    if (!(std::fabs(distance - std::sqrt(nearest.squared_distance)) < kSinglePrecision)) {
      return WrongAnswer(name, "Embree finds another distance");
    }
  }
  const double our_median = Median(ours);
  result.cases.push_back({name, 1e3 * our_median, "ms"});
  if (embree) {
    const double their_median = Median(theirs);
    result.cases.push_back({name + "_embree", 1e3 * their_median, "ms"});
    result.ratios.push_back({name + "/vs_embree", our_median / their_median});
  } else {
    result.notes.push_back(name + ": " + why_not);
  }
  return {};
}

base::Status TimeShafts(const BenchmarkOptions& options, BenchmarkResult& result) {
  const TriangleMesh mesh = MakeBody(57, 45);  // 5,130: the paper's liver
  auto tree = TriangleTree::Make(mesh.positions, mesh.triangles);
  if (!tree) return tree.error();
  math::Random random(13);
  std::vector<Segment> shafts(2000);
  for (Segment& shaft : shafts) shaft = RandomShaft(random);
  double sum = 0;
  const double seconds = TimeShortest(
      options.repeats, [] {},
      [&] {
        for (const Segment& shaft : shafts) {
          sum += tree->FindNearestToCapsule(mesh.positions, {shaft, kShaftRadius}).distance;
        }
      });
  if (!std::isfinite(sum)) return WrongAnswer("shaft_query_5130", "a shaft has no nearest triangle");
  result.cases.push_back({"shaft_query_5130", 1e6 * seconds / static_cast<double>(shafts.size()), "us"});
  return {};
}

}  // namespace

base::Status AddTreeBenchmark(const BenchmarkOptions& options, BenchmarkResult& result) {
  const TriangleMesh body = MakeBody(50, 40), fine_body = MakeBody(180, 120);  // 4,000 and 43,200
  for (const auto& [name, mesh] :
       {std::pair{"update_and_query_4000", &body}, std::pair{"update_and_query_43200", &fine_body}}) {
    if (base::Status timed = TimeUpdateAndQuery(name, *mesh, options, result); !timed.ok()) return timed;
  }
  if (base::Status timed = TimeShafts(options, result); !timed.ok()) return timed;

  auto tree = TriangleTree::Make(body.positions, body.triangles);
  if (!tree) return tree.error();
  base::Status built;
  const double build = TimeShortest(
      5 * options.repeats, [] {}, [&] { built = tree->Rebuild(body.positions, body.triangles); });
  if (!built.ok()) return built;
  result.cases.push_back({"build_4000", 1e3 * build, "ms"});

  Exactness exactness;
  if (base::Status checked = CheckAnswers(body, exactness); !checked.ok()) return checked;
  result.cases.push_back(
      {"exact_fraction", static_cast<double>(exactness.exact) / static_cast<double>(exactness.asked), "1"});
  result.cases.push_back(
      {"paper_greedy_recall",
       static_cast<double>(exactness.greedy_found) / static_cast<double>(exactness.greedy_asked), "1"});
  if (exactness.exact != exactness.asked) return WrongAnswer("exact_fraction", "not the nearest triangle");
  return {};
}

}  // namespace trocar::bench
