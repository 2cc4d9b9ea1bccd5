// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "benchmark.h"
#include "trocar/core/statistics.h"
#include "trocar/geometry/mesh_topology.h"
#include "trocar/geometry/primitives.h"
#include "trocar/session/simulation.h"
#include "trocar/tissue/equilibrium.h"

namespace trocar::cli {
namespace {

using math::Vec3;
using tissue::SolverKind;
using tissue::SolverSettings;
using tissue::TissueModel;
using tissue::TissueState;

// The paper's grids (its Table 1) and springs, pulled at the middle as its experiments do.
constexpr double kSpacing = 0.004;          // [m]
constexpr double kMeshStiffness = 0.002;    // [N/m]
constexpr double kVirtualStiffness = 2e-4;  // second row of the paper's Table 2 [N/m]
constexpr double kWeakStiffness = 2e-5;     // its first row, where plain relaxation takes longest [N/m]
constexpr double kPull = 0.012;             // three spacings, out of the plane [m]
// An answer counts as right when no node lies farther from the true equilibrium than this part of the pull
// [-].
constexpr double kAllowedError = 0.01;
constexpr double kTrueTolerance = 1e-11;  // of the solve that the others are judged by [-]
constexpr double kTimedTolerance = 1e-4;  // what the simulator uses [-]
constexpr int kManyIterations = 100'000;
constexpr int kCountedIterations = 100;  // for the price of one iteration

/// A grid that is held at its border and pulled at its middle.
struct Grid {
  TissueModel model;
  TissueState start;
  std::vector<Vec3> truth;
};

core::Result<Grid> MakeGridCase(const std::string& name, int n, double virtual_stiffness) {
  const geometry::TriangleMesh mesh = geometry::MakeGrid(n, kSpacing);
  tissue::TissueDefinition definition;
  definition.rest = mesh.positions;
  definition.mass.assign(mesh.positions.size(), 0.0);
  definition.shape_stiffness.assign(mesh.positions.size(), virtual_stiffness);
  for (const auto& [a, b] : geometry::FindEdges(mesh.triangles)) {
    definition.springs.push_back(
        {a, b, kMeshStiffness, math::Distance(mesh.positions[a], mesh.positions[b])});
  }
  const auto side = static_cast<std::uint32_t>(n);
  for (std::uint32_t i = 0; i < side; ++i) {
    for (const std::uint32_t node : {i, i * side, i * side + side - 1, (side - 1) * side + i}) {
      definition.fixed.push_back(node);
    }
  }
  std::sort(definition.fixed.begin(), definition.fixed.end());
  definition.fixed.erase(std::unique(definition.fixed.begin(), definition.fixed.end()),
                         definition.fixed.end());

  Grid grid{tissue::MakeTissueModel(definition), {}, {}};
  grid.start = tissue::MakeRestState(grid.model);
  const std::size_t middle = static_cast<std::size_t>(n / 2) * side + side / 2;
  grid.start.condition[middle] = tissue::NodeCondition::kPrescribed;
  grid.start.position[middle].z += kPull;

  // the truth, judged by the plain evaluation of the balance that no solver shares
  TissueState state = grid.start;
  tissue::EquilibriumSolver solver(grid.model, 1);
  (void)solver.Solve({SolverKind::kChebyshevJacobi2015, kManyIterations, kTrueTolerance, 0.0}, {}, state);
  std::vector<Vec3> residual(grid.model.Size());
  tissue::CalcResidual(grid.model, state, {}, residual);
  double largest = 0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (state.condition[i] != tissue::NodeCondition::kPrescribed)
      largest = std::max(largest, math::Norm(residual[i]));
  }
  // a force that the virtual spring answers with a millionth of the pull
  if (!(largest < 1e-6 * virtual_stiffness * kPull))
    return WrongAnswer(name, "the judge's own equilibrium does not balance");
  grid.truth = std::move(state.position);
  return grid;
}

/// Largest distance of any node from the truth, over the pull [-].
double CalcError(const Grid& grid, const std::vector<Vec3>& positions) {
  double error = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    error = std::max(error, math::Distance(positions[i], grid.truth[i]) / kPull);
  }
  return error;
}

/// Time of one solve to the simulator's tolerance [s]; its answer is checked.
core::Result<double> TimeSolve(const std::string& name, const Grid& grid, SolverKind kind, int threads,
                               int repeats, BenchmarkResult& result) {
  const SolverSettings settings{kind, kManyIterations, kTimedTolerance, 0.0};
  tissue::EquilibriumSolver solver(grid.model, threads);
  TissueState state = grid.start;
  tissue::SolveReport report;
  const double seconds = TimeShortest(
      repeats, [&] { state.position = grid.start.position; },
      [&] { report = solver.Solve(settings, {}, state); });
  const double error = CalcError(grid, state.position);
  if (!(error <= kAllowedError)) {
    return WrongAnswer(name,
                       "a node is " + std::to_string(100 * error) + " % of the pull away from equilibrium");
  }
  result.cases.push_back({name, 1e3 * seconds, "ms"});
  result.cases.push_back({name + "_iterations", static_cast<double>(report.iterations), "1"});
  result.cases.push_back({name + "_error", 100 * error, "%"});
  return seconds;
}

/// The solver that runs, and where asked the reference, on one grid.
core::Status RunGrid(const std::string& name, const Grid& grid, bool has_reference,
                     const BenchmarkOptions& options, BenchmarkResult& result) {
  const core::Result<double> chebyshev = TimeSolve(
      name + "_chebyshev", grid, SolverKind::kChebyshevJacobi2015, options.threads, options.repeats, result);
  if (!chebyshev) return chebyshev.error();
  if (!has_reference) return {};
  const core::Result<double> relaxation =
      TimeSolve(name + "_relaxation", grid, SolverKind::kRelaxationPaper, 1, 0, result);
  if (!relaxation) return relaxation.error();
  result.ratios.push_back({name + "_relaxation_over_chebyshev", *relaxation / *chebyshev});
  return {};
}

/// Time of one iteration of one node [s], and the same bits as with one thread.
core::Result<double> TimeIteration(const std::string& name, const Grid& grid, int threads, int repeats) {
  const SolverSettings settings{SolverKind::kChebyshevJacobi2015, kCountedIterations, 0.0, 0.0};
  const auto run = [&](int count, TissueState& state) {
    tissue::EquilibriumSolver solver(grid.model, count);
    return TimeShortest(
        repeats, [&] { state.position = grid.start.position; },
        [&] { (void)solver.Solve(settings, {}, state); });
  };
  TissueState alone = grid.start, together = grid.start;
  const double seconds = run(threads, together);
  if (threads > 1) {
    (void)run(1, alone);
    if (alone.position != together.position) return WrongAnswer(name, "other bits than with one thread");
  }
  return seconds / (kCountedIterations * static_cast<double>(grid.model.Size()));
}

/// The whole tick on the built-in patient, both instruments moved by the scene's script.
core::Status RunPatient(const BenchmarkOptions& options, BenchmarkResult& result) {
  const core::Result<std::filesystem::path> folder = session::FindDataFolder();
  if (!folder) return folder.error();
  core::Result<session::Scene> read = session::ReadScene(*folder / "scenes/demonstration.json");
  if (!read) return read.error();
  const auto scene = std::make_shared<const session::Scene>(std::move(read).value());
  core::Result<session::Simulation> made = session::Simulation::Make(scene, options.threads);
  if (!made) return made.error();
  const int ticks = static_cast<int>(scene->script.Duration() / scene->tick_seconds) + 1;
  std::uint64_t first_hash = 0;
  std::vector<double> quickest_ms;
  for (int repeat = 0; repeat <= options.repeats; ++repeat) {
    made->Reset();
    std::vector<double> tick_ms;
    for (int tick = 0; tick < ticks; ++tick) {
      const session::Input input = session::CalcScriptInput(*scene, tick * scene->tick_seconds);
      const core::Stopwatch stopwatch;
      made->Step(input);
      tick_ms.push_back(1e3 * stopwatch.Seconds());
    }
    // the answer: every run of the script ends in the same state
    if (repeat == 0) first_hash = made->Hash();
    if (made->Hash() != first_hash)
      return WrongAnswer("patient_tick", "two runs of the script end in different states");
    if (!std::isfinite(made->GetSnapshot().residual))
      return WrongAnswer("patient_tick", "the residual is not finite");
    if (repeat == 0) continue;
    if (quickest_ms.empty() ||
        core::CalcPercentile(tick_ms, 0.99) < core::CalcPercentile(quickest_ms, 0.99)) {
      quickest_ms = tick_ms;
    }
  }
  std::size_t triangles = 0;
  for (const anatomy::Organ& organ : scene->patient.organs) triangles += organ.mesh.triangles.size();
  result.cases.push_back({"patient_triangles", static_cast<double>(triangles), "1"});
  result.cases.push_back({"patient_ticks", static_cast<double>(ticks), "1"});
  result.cases.push_back({"patient_tick_median", core::CalcPercentile(quickest_ms, 0.5), "ms"});
  result.cases.push_back({"patient_tick_p99", core::CalcPercentile(quickest_ms, 0.99), "ms"});
  result.cases.push_back({"patient_tick_largest", core::CalcPercentile(quickest_ms, 1.0), "ms"});
  return {};
}

}  // namespace

core::Result<BenchmarkResult> RunTissueBenchmark(const BenchmarkOptions& options) {
  BenchmarkResult result;
  // the paper's four grids with the solver that runs; the reference where it ends within seconds
  for (const int n : {16, 112, 176, 208}) {
    const std::string name = "grid_" + std::to_string(n);
    const core::Result<Grid> grid = MakeGridCase(name, n, kVirtualStiffness);
    if (!grid) return grid.error();
    if (core::Status status = RunGrid(name, *grid, n <= 112, options, result); !status) return status.error();
    if (n < 208) continue;
    const core::Result<double> alone = TimeIteration(name + "_iteration", *grid, 1, options.repeats);
    if (!alone) return alone.error();
    result.cases.push_back({name + "_node_iteration", 1e9 * *alone, "ns"});
    if (options.threads == 1) continue;
    const core::Result<double> together =
        TimeIteration(name + "_iteration", *grid, options.threads, options.repeats);
    if (!together) return together.error();
    result.ratios.push_back(
        {name + "_one_thread_over_" + std::to_string(options.threads), *alone / *together});
  }
  const core::Result<Grid> weak = MakeGridCase("grid_112_weak", 112, kWeakStiffness);
  if (!weak) return weak.error();
  if (core::Status status = RunGrid("grid_112_weak", *weak, true, options, result); !status)
    return status.error();
  if (core::Status status = RunPatient(options, result); !status) return status.error();
  return result;
}

}  // namespace trocar::cli
