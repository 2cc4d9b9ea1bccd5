// SPDX-License-Identifier: Apache-2.0
#include "tissue_benchmark.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "trocar/geometry/mesh_topology.h"
#include "trocar/geometry/primitives.h"

namespace trocar::bench {
namespace {

using math::Vec3;
using tissue::SolverKind;

constexpr double kNodeLoad = 0.001, kCentreLoad = 0.5;  // [N]
constexpr double kPaperAlpha = 0.1;  // alpha k, generous: the printed constants are 500 times slower
// what the plain evaluation of the balance may leave at the truth, as a part of the load on a node [-]
constexpr double kTrueBalance = 1e-6;

}  // namespace

GridCase MakeGridCase(int n, double virtual_stiffness) {
  const geometry::TriangleMesh mesh = geometry::MakeGrid(n, 1.0);
  const auto side = static_cast<std::uint32_t>(n);
  tissue::TissueDefinition definition;
  definition.rest = mesh.positions;
  definition.mass.assign(mesh.positions.size(), 0.0);
  definition.shape_stiffness.assign(mesh.positions.size(), virtual_stiffness);
  for (const auto& [a, b] : geometry::FindEdges(mesh.triangles)) {
    definition.springs.push_back({a, b, 1.0, math::Distance(mesh.positions[a], mesh.positions[b])});
  }
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const std::uint32_t row = i / side, column = i % side;
    if (row == 0 || column == 0 || row + 1 == side || column + 1 == side) definition.fixed.push_back(i);
  }
  GridCase grid{tissue::MakeTissueModel(definition), {}, {}};
  grid.start = tissue::MakeRestState(grid.model);
  grid.external_force.assign(grid.model.Size(), {0, 0, -kNodeLoad});
  grid.external_force[side / 2 * side + side / 2] = {0, 0, kCentreLoad};
  return grid;
}

void RelaxAsPrinted(const GridCase& grid, int iterations, std::vector<Vec3>& position) noexcept {
  const tissue::TissueModel& model = grid.model;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    for (std::size_t i = 0; i < model.Size(); ++i) {
      if (model.is_fixed[i]) continue;
      const Vec3 here = position[i];
      Vec3 force = grid.external_force[i] + model.shape_stiffness[i] * (model.rest[i] - here);
      for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
        const auto& spring = model.half_springs[h];
        const Vec3 along = position[spring.other] - here;
        const double length = std::sqrt(math::SquaredNorm(along));
        force += (spring.stiffness * (length - spring.rest_length) / length) * along;
      }
      position[i] += kPaperAlpha * force;
    }
  }
}

base::Result<tissue::TissueState> FindTruth(const std::string& name, const GridCase& grid,
                                            const tissue::TissueState& state) {
  tissue::SolverSettings exact;
  exact.kind = SolverKind::kNewtonMultigrid;
  exact.max_error = 1e-9;
  exact.newton.max_steps = 100;
  exact.newton.max_linear_iterations = 300;
  tissue::EquilibriumSolver judge(grid.model);
  tissue::TissueState truth = state;
  (void)judge.Solve(exact, grid.Load(), truth);
  std::vector<Vec3> residual(grid.model.Size());
  tissue::CalcResidual(grid.model, truth, grid.Load(), residual);
  double largest = 0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (truth.condition[i] == tissue::NodeCondition::kPrescribed) continue;
    largest = std::max(largest, math::Norm(residual[i]));
  }
  if (!(largest < kTrueBalance * kNodeLoad))
    return WrongAnswer(name, "the judge's own equilibrium does not balance");
  return truth;
}

double CalcDistance(const tissue::TissueState& a, const tissue::TissueState& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.position.size(); ++i)
    largest = std::max(largest, math::Distance(a.position[i], b.position[i]));
  return largest;
}

base::Result<BenchmarkResult> RunTissueBenchmark(const BenchmarkOptions& options) {
  BenchmarkResult result;
  for (const auto run : {RunIterationCases, RunEquilibriumCases, RunPatientCases}) {
    if (base::Status status = run(options, result); !status) return status.error();
  }
  return result;
}

}  // namespace trocar::bench
