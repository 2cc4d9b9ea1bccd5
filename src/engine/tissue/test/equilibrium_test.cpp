// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/equilibrium.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "crumpled_sphere.h"
#include "test_systems.h"
#include "trocar/base/state_hash.h"
#include "trocar_test/threads.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

class BothSolvers : public testing::TestWithParam<SolverKind> {
 protected:
  SolverSettings Settings(double tolerance, int max_iterations = 100'000) const {
    return {GetParam(), max_iterations, tolerance, 0.0};
  }
};
INSTANTIATE_TEST_SUITE_P(Solver, BothSolvers,
                         testing::Values(SolverKind::kRelaxationPaper, SolverKind::kChebyshevJacobi2015),
                         [](const auto& chosen) { return std::string(SolverName(chosen.param)); });

// Analytic: x = m g / k (domain facts 0b.4).
TEST_P(BothSolvers, HangingSpringSinksByWeightOverStiffness) {
  const double k = 20.0, mass = 0.05;
  const TissueModel model = MakeTissueModel(MakeHangingSpring(k, 0.1, mass));
  TissueState state = MakeRestState(model);
  EquilibriumSolver solver(model);
  const TissueLoad load{.gravity = {0, 0, -9.81}};
  const SolveReport report = solver.Solve(Settings(1e-10), load, state);
  EXPECT_TRUE(report.converged);
  EXPECT_NEAR(state.position[1].z, -0.1 - mass * 9.81 / k, 1e-9);
  // the hook carries the weight
  const std::uint32_t hook = 0;
  EXPECT_NEAR(solver.CalcReaction(load, state, {&hook, 1}).z, -mass * 9.81, 1e-8);
}

// Analytic: a lone node on its virtual spring sinks by m g / k_virtual.
TEST_P(BothSolvers, VirtualSpringBalancesWeight) {
  TissueDefinition definition;
  definition.rest = {{0.1, 0.2, 0.3}};
  definition.mass = {0.02};
  definition.shape_stiffness = {5.0};
  const TissueModel model = MakeTissueModel(definition);
  TissueState state = MakeRestState(model);
  EquilibriumSolver solver(model);
  (void)solver.Solve(Settings(1e-12), {.gravity = {0, 0, -9.81}, .shape_scale = 2.0}, state);
  EXPECT_NEAR(state.position[0].z, 0.3 - 0.02 * 9.81 / 10.0, 1e-12);
}

// Analytic: a stretched triangular lattice answers with the membrane modulus it was made from and Poisson's
// ratio 1/3.
TEST_P(BothSolvers, StretchedPatchHasTheModulusAndPoissonRatioOfAMembrane) {
  const double modulus = 500.0, side = 0.004;
  const int columns = 31, rows = 13;
  const auto mesh = geometry::MakeTriangularLattice(columns, rows, side);
  TissueDefinition definition = MakeMembrane(mesh, modulus, 0.0);
  const TissueModel model = MakeTissueModel(definition);
  TissueState state = MakeRestState(model);
  // both ends held in x only: ends slide freely across, so the strain is uniform; strain 0.1 %
  const double length = (columns - 1) * side, strain = 1e-3;
  std::vector<std::uint32_t> right;
  for (int row = 0; row < rows; ++row) {
    for (const int column : {0, columns - 1}) {
      const auto node = static_cast<std::uint32_t>(row * columns + column);
      const Vec3 rest = model.rest[node];
      state.condition[node] = NodeCondition::kPrescribed;
      state.position[node] = {rest.x * (1 + strain), rest.y * (1 - strain / 3), 0};
      if (column != 0) right.push_back(node);
    }
  }
  EquilibriumSolver solver(model);
  const SolveReport report = solver.Solve(Settings(1e-7), {}, state);
  ASSERT_TRUE(report.converged) << report.residual;
  const double height = (rows - 1) * side * std::sqrt(0.75);
  const double force = -solver.CalcReaction({}, state, right).x;
  EXPECT_NEAR(force / (modulus * height * strain), 1.0, 0.06);  // free edges carry half springs
  const auto top = static_cast<std::size_t>((rows - 1) * columns + columns / 2),
             bottom = static_cast<std::size_t>(columns / 2);
  const double across = ((state.position[top].y - state.position[bottom].y) / height - 1.0) / -strain;
  EXPECT_NEAR(across, 1.0 / 3.0, 0.03);
  EXPECT_NEAR(length, 0.12, 1e-12);
}

// Analytic: evenly loaded membrane on a foundation sinks by load per area over foundation modulus per depth.
TEST_P(BothSolvers, FoundationCarriesAnEvenLoad) {
  const auto mesh = geometry::MakeGrid(12, 0.005);
  TissueDefinition definition = MakeMembrane(mesh, 40.0, 5e4);
  const auto areas = geometry::CalcVertexAreas(mesh.positions, mesh.triangles);
  for (std::size_t i = 0; i < areas.size(); ++i) definition.mass[i] = 20.0 * areas[i];
  const TissueModel model = MakeTissueModel(definition);
  TissueState state = MakeRestState(model);
  EquilibriumSolver solver(model);
  (void)solver.Solve(Settings(1e-9), {.gravity = {0, 0, -9.81}}, state);
  for (const Vec3& p : state.position) EXPECT_NEAR(p.z, -20.0 * 9.81 / 5e4, 1e-7);
}

// Oracle: both solvers reach the same equilibrium of a pressed and pulled sphere.
TEST(Chebyshev, AgreesWithTheReferenceWithinAThousandthOfTheLargestDisplacement) {
  const auto mesh = geometry::MakeSphere({0, 0, 0}, 0.03, 3);
  const TissueModel model = MakeTissueModel(MakeMembrane(mesh, 100.0, 1e6));
  const auto solve = [&](SolverKind kind) {
    TissueState state = MakeRestState(model);
    state.condition[0] = NodeCondition::kPrescribed;
    state.position[0] +=
        0.004 * math::Normalized(model.rest[0]);  // outwards, on a firm foundation: no buckling
    ContactSpring contact{{9, 10, 11}, {1. / 3, 1. / 3, 1. / 3}, {}, 0, 500.0};
    const Vec3 centre = (model.rest[9] + model.rest[10] + model.rest[11]) / 3.0;
    contact.normal = -math::Normalized(centre);
    contact.offset = math::Dot(contact.normal, centre) + 0.001;
    EquilibriumSolver solver(model);
    const auto report =
        solver.Solve({kind, 200'000, 1e-8, 0.0}, {.gravity = {0, 0, -1}, .contacts = {&contact, 1}}, state);
    EXPECT_TRUE(report.converged) << SolverName(kind) << " " << report.residual;
    return state.position;
  };
  const auto reference = solve(SolverKind::kRelaxationPaper);
  const auto fast = solve(SolverKind::kChebyshevJacobi2015);
  double worst = 0, largest = 0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    worst = std::max(worst, math::Distance(reference[i], fast[i]));
    largest = std::max(largest, math::Distance(reference[i], model.rest[i]));
  }
  EXPECT_GT(largest, 0.0035);
  EXPECT_LT(worst, 1e-3 * largest);
}

TEST(Chebyshev, NeedsFarFewerIterationsThanTheRelaxation) {
  const auto mesh = geometry::MakeSphere({0, 0, 0}, 0.03, 3);
  const TissueModel model = MakeTissueModel(MakeMembrane(mesh, 100.0, 2e4));
  const auto iterations = [&](SolverKind kind) {
    TissueState state = MakeRestState(model);
    state.condition[0] = NodeCondition::kPrescribed;
    state.position[0] += Vec3{0, 0.006, 0};
    EquilibriumSolver solver(model);
    return solver.Solve({kind, 200'000, 1e-4, 0.0}, {}, state).iterations;
  };
  EXPECT_LT(10 * iterations(SolverKind::kChebyshevJacobi2015), iterations(SolverKind::kRelaxationPaper));
}

// A crumpled start is far outside the range where the recurrence is provably stable: the safeguard must bring
// it home.
TEST(Chebyshev, ComesBackFromACrumpledStart) {
  CrumpledSphere sphere;
  const TissueModel& model = sphere.model;
  TissueState& state = sphere.state;
  const double before = CalcEnergy(model, state, {});
  EquilibriumSolver solver(model);
  (void)solver.Solve({SolverKind::kChebyshevJacobi2015, 5000, 1e-6, 0.0}, {}, state);
  EXPECT_LT(CalcEnergy(model, state, {}), 1e-3 * before);
}

TEST(Chebyshev, GivesTheSameBitsForAnyNumberOfThreads) {
  const auto mesh = geometry::MakeSphere({0, 0, 0}, 0.03, 4);
  const TissueModel model = MakeTissueModel(MakeMembrane(mesh, 100.0, 2e4));
  const auto hash = [&](int threads) {
    TissueState state = MakeRestState(model);
    state.condition[5] = NodeCondition::kPrescribed;
    state.position[5] += Vec3{0.003, 0.006, 0};
    EquilibriumSolver solver(model, {.threads = test::UseThreads(threads)});
    for (int tick = 0; tick < 5; ++tick) (void)solver.Solve({}, {.gravity = {0, 0, -3}}, state);
    base::StateHash fingerprint;
    for (const Vec3& p : state.position) fingerprint.Add(p.x), fingerprint.Add(p.y), fingerprint.Add(p.z);
    return fingerprint.Value();
  };
  const auto one = hash(1);
  for (const int threads : {2, 3, 4, 8}) EXPECT_EQ(hash(threads), one) << threads;
}

// The paper's own constants: alpha = 0.1, k_mesh = 0.002 (its Table 2), far inside the stability bound.
TEST(Relaxation, AcceptsThePapersConstantsAndItsBound) {
  const auto mesh = geometry::MakeGrid(8, 1.0);
  TissueDefinition definition = MakeMembrane(mesh, 0.0, 0.0);
  for (Spring& spring : definition.springs) spring.stiffness = 0.002;
  definition.shape_stiffness.assign(64, 0.02);
  const TissueModel model = MakeTissueModel(definition);
  EXPECT_GT(CalcLargestAlpha(model, {}), 0.1);
  TissueState state = MakeRestState(model);
  EquilibriumSolver solver(model);
  const auto report =
      solver.Solve({SolverKind::kRelaxationPaper, 100'000, 5e-4, 0.1}, {.gravity = {0, 0, -9.81}}, state);
  EXPECT_TRUE(report.converged);
  for (const Vec3& p : state.position) EXPECT_NEAR(p.z, -1e-4 * 9.81 / 0.02, 1e-4);
}

TEST(Solve, LeavesPrescribedNodesExactlyWhereTheyAre) {
  const auto mesh = geometry::MakeSphere({0, 0, 0}, 0.03, 2);
  TissueDefinition definition = MakeMembrane(mesh, 100.0, 2e4);
  definition.fixed = {1, 2, 3};
  const TissueModel model = MakeTissueModel(definition);
  for (const auto kind : {SolverKind::kRelaxationPaper, SolverKind::kChebyshevJacobi2015}) {
    TissueState state = MakeRestState(model);
    state.condition[7] = NodeCondition::kPrescribed;
    const Vec3 held = state.position[7] += Vec3{0.01, 0, 0};
    EquilibriumSolver solver(model);
    (void)solver.Solve({kind, 51, 1e-9, 0.0}, {.gravity = {0, 0, -9.81}}, state);
    EXPECT_EQ(state.position[7], held);
    for (const int fixed : {1, 2, 3}) EXPECT_EQ(state.position[fixed], model.rest[fixed]);
  }
}

TEST(Solve, ACutStrandHoldsNothing) {
  TissueDefinition definition;
  definition.rest = {{0, 0, 0}, {0, 0, -0.001}};
  definition.mass = {0, 0.01};
  definition.shape_stiffness = {0, 1.0};
  definition.fixed = {0};
  definition.strands = {{0, 1, 99.0}};
  const TissueModel model = MakeTissueModel(definition);
  const auto depth = [&](bool is_intact) {
    TissueState state = MakeRestState(model);
    state.strand_is_intact[0] = is_intact;
    EquilibriumSolver solver(model);
    (void)solver.Solve({SolverKind::kChebyshevJacobi2015, 10'000, 1e-12, 0.0}, {.gravity = {0, 0, -10}},
                       state);
    return -0.001 - state.position[1].z;
  };
  EXPECT_NEAR(depth(true), 0.1 / 100.0, 1e-9);
  EXPECT_NEAR(depth(false), 0.1 / 1.0, 1e-7);
}

}  // namespace
}  // namespace trocar::tissue
