// SPDX-License-Identifier: Apache-2.0
/// \file solvers_test.cpp  Every solver against the paper's relaxation in double precision, and the promises
/// that hold for all of them.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "crumpled_sphere.h"
#include "test_systems.h"
#include "trocar/base/state_hash.h"
#include "trocar/tissue/equilibrium.h"
#include "trocar_test/threads.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

/// A square sheet in the x-y plane, held at its border and pulled across at its middle.
struct Sheet {
  TissueModel model;
  TissueState start;
  std::vector<Vec3> external;

  TissueLoad Load() const { return {.gravity = {0, 0, -1}, .external_force = external}; }
};

Sheet MakeSheet(int side, double shape_stiffness, bool is_shuffled = false) {
  const auto mesh = geometry::MakeGrid(side, 1.0);
  const auto n = static_cast<std::uint32_t>(side * side);
  // a permutation without order: multiplication by a number that shares no factor with n
  std::uint32_t factor = 7919;
  while (std::gcd(factor, n) != 1) ++factor;
  const auto place = [&](std::uint32_t i) { return is_shuffled ? i * factor % n : i; };
  TissueDefinition definition;
  definition.rest.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) definition.rest[place(i)] = mesh.positions[i];
  definition.mass.assign(n, 0.001);
  definition.shape_stiffness.assign(n, shape_stiffness);
  for (const auto& [a, b] : geometry::FindEdges(mesh.triangles)) {
    definition.springs.push_back(
        {place(a), place(b), 1.0, math::Distance(mesh.positions[a], mesh.positions[b])});
  }
  const auto edge = static_cast<std::uint32_t>(side);
  for (std::uint32_t i = 0; i < n; ++i) {
    if (i % edge == 0 || i % edge + 1 == edge || i < edge || i + edge >= n)
      definition.fixed.push_back(place(i));
  }
  Sheet sheet{MakeTissueModel(definition), {}, std::vector<Vec3>(n)};
  sheet.start = MakeRestState(sheet.model);
  sheet.external[place(edge / 2 * edge + edge / 2)] = {0.02, 0.01, 0.3};
  return sheet;
}

// Regression: from a state at rest the linear solution has no tolerance, and went on into its own rounding until
// nothing was left of the step.
TEST(NewtonMultigrid, MovesALightSheetOnStiffVirtualSprings) {
  const auto mesh = geometry::MakeGrid(11, 0.005);
  for (const double shape : {0.0, 2e-5, 2e-4, 0.02, 0.05, 1.0}) {
    TissueDefinition definition;
    definition.rest = mesh.positions;
    definition.mass.assign(121, 1e-9);
    definition.shape_stiffness.assign(121, shape);
    for (std::uint32_t i = 0; i < 11; ++i) definition.fixed.push_back(i);
    for (const auto& [a, b] : geometry::FindEdges(mesh.triangles))
      definition.springs.push_back({a, b, 0.002, math::Distance(mesh.positions[a], mesh.positions[b])});
    const TissueModel model = MakeTissueModel(definition);
    TissueState state = MakeRestState(model);
    SolverSettings settings;
    settings.kind = SolverKind::kNewtonMultigrid;
    settings.max_error = 1e-5;
    settings.newton.max_linear_iterations = 1000;
    EquilibriumSolver solver(model);
    const SolveReport report = solver.Solve(settings, {.gravity = {0, -9.81, 0}}, state);
    EXPECT_TRUE(report.converged) << shape << ": " << report.error;
    EXPECT_LT(report.linear_iterations, 200) << shape;
    EXPECT_LT(state.position[115].y, mesh.positions[115].y);
  }
}

double CalcError(const TissueModel& model, const TissueState& state, const TissueState& truth) {
  double worst = 0, largest = 0;
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    worst = std::max(worst, math::Distance(state.position[i], truth.position[i]));
    largest = std::max(largest, math::Distance(truth.position[i], model.rest[i]));
  }
  return worst / largest;
}

/// Equilibrium by the slow reference, until the residual is at the limit of double precision.
TissueState Relax(const Sheet& sheet) {
  TissueState state = sheet.start;
  EquilibriumSolver solver(sheet.model);
  const SolveReport report =
      solver.Solve({SolverKind::kRelaxationPaper, 400'000, 1e-11, 0.0}, sheet.Load(), state);
  EXPECT_TRUE(report.converged) << report.residual;
  return state;
}

SolverSettings Exact(SolverKind kind) {
  SolverSettings settings{kind, 100'000, 1e-9, 0.0};
  settings.max_error = 1e-5;
  settings.newton.max_steps = 200;
  settings.newton.max_linear_iterations = 300;
  if (kind == SolverKind::kAcceleratedDescent) {
    // what single precision bears
    settings.max_error = 5e-5;
    settings.max_iterations = 4000;
  }
  return settings;
}

std::uint64_t Hash(const TissueState& state) {
  base::StateHash hash;
  for (const Vec3& p : state.position) hash.Add(p.x), hash.Add(p.y), hash.Add(p.z);
  return hash.Value();
}

class EverySolver : public testing::TestWithParam<SolverKind> {};
INSTANTIATE_TEST_SUITE_P(Solver, EverySolver, testing::ValuesIn(kSolverKinds),
                         [](const auto& chosen) { return std::string(SolverName(chosen.param)); });

// Oracle: the reference's equilibrium, on a structured sheet and on the same sheet with its nodes shuffled.
TEST_P(EverySolver, ReachesTheReferencesEquilibrium) {
  for (const bool is_shuffled : {false, true}) {
    const Sheet sheet = MakeSheet(20, 0.05, is_shuffled);
    const TissueState truth = Relax(sheet);
    TissueState state = sheet.start;
    EquilibriumSolver solver(sheet.model);
    EXPECT_EQ(solver.IsStructured(), !is_shuffled);
    SolverSettings settings = Exact(GetParam());
    const SolveReport report = solver.Solve(settings, sheet.Load(), state);
    EXPECT_LT(CalcError(sheet.model, state, truth), 5e-5) << report.iterations;
    EXPECT_TRUE(report.converged) << report.residual << " " << report.error;
  }
}

// Negative control: the test above can tell.
TEST(EverySolverControl, AFewIterationsAreNotEnough) {
  const Sheet sheet = MakeSheet(20, 0.05);
  const TissueState truth = Relax(sheet);
  TissueState state = sheet.start;
  EquilibriumSolver solver(sheet.model);
  (void)solver.Solve({SolverKind::kRelaxationPaper, 50, 0.0, 0.0}, sheet.Load(), state);
  EXPECT_GT(CalcError(sheet.model, state, truth), 1e-2);
}

// A tick that may do little work does no more, and the ticks after it go on.
TEST(NewtonMultigrid, SpendsNoMoreThanATickMayAndArrivesInMoreTicks) {
  const Sheet sheet = MakeSheet(20, 0.05, true);
  const TissueState truth = Relax(sheet);
  TissueState state = sheet.start;
  EquilibriumSolver solver(sheet.model);
  SolverSettings settings = Exact(SolverKind::kNewtonMultigrid);
  SolveReport report = solver.Solve(settings, sheet.Load(), state);
  EXPECT_GT(report.linear_iterations, 7) << "negative control";
  state = sheet.start;
  settings.newton.max_linear_total = 7;
  int ticks = 0;
  do {
    report = solver.Solve(settings, sheet.Load(), state);
    EXPECT_LE(report.linear_iterations, 7);
    EXPECT_EQ(std::isnan(report.error), !report.converged) << "nobody judges a solve that ended at its bound";
  } while (!report.converged && ++ticks < 100);
  EXPECT_GT(ticks, 0);
  EXPECT_TRUE(report.converged) << report.error;
  EXPECT_LT(CalcError(sheet.model, state, truth), 5e-5);
}

TEST_P(EverySolver, GivesTheSameBitsForAnyNumberOfThreads) {
  for (const bool is_shuffled : {false, true}) {
    const Sheet sheet = MakeSheet(70, 0.01, is_shuffled);
    const auto hash = [&](int threads) {
      TissueState state = sheet.start;
      EquilibriumSolver solver(sheet.model, {.threads = test::UseThreads(threads)});
      SolverSettings settings{GetParam(), 60, 0.0, 0.0};
      settings.max_error = 1e-9;
      settings.newton.max_steps = 2;
      settings.newton.max_linear_iterations = 12;
      (void)solver.Solve(settings, sheet.Load(), state);
      return Hash(state);
    };
    const std::uint64_t one = hash(1);
    EXPECT_NE(one, Hash(sheet.start));
    for (const int threads : {2, 3, 4, 8}) EXPECT_EQ(hash(threads), one) << threads;
  }
}

TEST_P(EverySolver, LeavesPrescribedNodesExactlyWhereTheyAre) {
  const Sheet sheet = MakeSheet(12, 0.05);
  TissueState state = sheet.start;
  const std::uint32_t node = 40;
  state.condition[node] = NodeCondition::kPrescribed;
  const Vec3 held = state.position[node] += Vec3{0.1, 0.2, 0.3};
  EquilibriumSolver solver(sheet.model);
  (void)solver.Solve({GetParam(), 51, 1e-9, 0.0}, sheet.Load(), state);
  EXPECT_EQ(state.position[node], held);
  EXPECT_EQ(state.position[3], sheet.model.rest[3]);
  EXPECT_NE(state.position[node + 1], sheet.model.rest[node + 1]);
}

// A NaN anywhere ends the solve, and is there afterwards for the guard to find.
TEST_P(EverySolver, EndsAtWhatIsNotFinite) {
  const Sheet sheet = MakeSheet(12, 0.05);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    TissueState state = sheet.start;
    state.position[50].y = bad;
    EquilibriumSolver solver(sheet.model);
    (void)solver.Solve(Exact(GetParam()), sheet.Load(), state);
    EXPECT_FALSE(math::IsFinite(state.position[50]));
  }
}

TEST_P(EverySolver, CallsTheConstraintsAndTakesTheirForces) {
  Sheet sheet = MakeSheet(20, 0.05, true);
  struct Counter final : ConstraintSet {
    explicit Counter(std::vector<Vec3>& force_in) : force(&force_in) {}
    void Project(TissueState&, std::span<Vec3>) noexcept override {
      ++calls;
      for (Vec3& f : *force) f = {0, 0, 0.01};
    }
    int Interval() const noexcept override { return 5; }
    int calls = 0;
    std::vector<Vec3>* force;
  } counter(sheet.external);
  TissueState state = sheet.start;
  EquilibriumSolver solver(sheet.model);
  SolverSettings settings = Exact(GetParam());
  settings.tolerance = 1e-10, settings.max_error = 1e-7, settings.max_iterations = 40'000;
  (void)solver.Solve(settings, sheet.Load(), state, &counter);
  EXPECT_GT(counter.calls, 0);
  const TissueState truth = Relax(sheet);
  EXPECT_LT(CalcError(sheet.model, state, truth), 1e-4);
}

TEST(SolverNames, AreKnownBothWays) {
  for (const SolverKind kind : kSolverKinds) EXPECT_EQ(FindSolverKind(SolverName(kind)), kind);
  EXPECT_FALSE(FindSolverKind("magic").has_value());
}

TEST(SimdLevels, GiveTheSameBits) {
  for (const bool is_shuffled : {false, true}) {
    const Sheet sheet = MakeSheet(29, 0.05, is_shuffled);
    const auto solve = [&](base::SimdLevel level, SolverKind kind) {
      TissueState state = sheet.start;
      EquilibriumSolver solver(sheet.model, SolverOptions{.simd = level});
      (void)solver.Solve(Exact(kind), sheet.Load(), state);
      return state;
    };
    for (const SolverKind kind : kSolverKinds) {
      const std::uint64_t baseline = Hash(solve(base::SimdLevel::kBaseline, kind));
      for (const base::SimdLevel level : Levels())
        EXPECT_EQ(Hash(solve(level, kind)), baseline)
            << SolverName(kind) << ", " << base::SimdLevelName(level);
    }
  }
}

// A structured mesh run as a stencil and the same mesh taken as any other come to the same place.
TEST(StructuredMesh, IsTheSameAsAnyOther) {
  const Sheet sheet = MakeSheet(37, 0.05);
  const auto solve = [&](bool recognises_grids) {
    TissueState state = sheet.start;
    EquilibriumSolver solver(sheet.model, SolverOptions{.recognises_grids = recognises_grids});
    EXPECT_EQ(solver.IsStructured(), recognises_grids);
    (void)solver.Solve(Exact(SolverKind::kAcceleratedDescent), sheet.Load(), state);
    return state;
  };
  EXPECT_LT(CalcError(sheet.model, solve(true), solve(false)), 3e-5);
}

// Other diagonals, stiffness that differs from spring to spring, and a grid that lies askew in space.
TEST(StructuredMesh, MayHaveAnyDiagonalsStiffnessAndPlace) {
  const int rows = 11, columns = 14;
  TissueDefinition definition;
  const auto node = [&](int row, int column) { return static_cast<std::uint32_t>(row * columns + column); };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      definition.rest.push_back({column + 0.1 * row, 0.8 * row, 0.3 * column + 0.2 * std::sin(row)});
      if (row == 0 || column == 0 || row + 1 == rows || column + 1 == columns)
        definition.fixed.push_back(node(row, column));
    }
  }
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    const double length = math::Distance(definition.rest[a], definition.rest[b]);
    definition.springs.push_back({a, b, 1.0 + 0.1 * (a % 7), 0.95 * length});
  };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if (column + 1 < columns) join(node(row, column), node(row, column + 1));
      if (row + 1 < rows) join(node(row, column), node(row + 1, column));
      if (row + 1 < rows && column + 1 < columns && (row + column) % 2 == 0)
        join(node(row, column), node(row + 1, column + 1));
      if (row + 1 < rows && column > 0) join(node(row, column), node(row + 1, column - 1));
    }
  }
  definition.mass.assign(definition.rest.size(), 0.01);
  definition.shape_stiffness.assign(definition.rest.size(), 0.1);
  Sheet sheet{MakeTissueModel(definition), {}, std::vector<Vec3>(definition.rest.size())};
  sheet.start = MakeRestState(sheet.model);
  sheet.external[node(5, 6)] = {0.1, 0.2, 0.3};
  const TissueState truth = Relax(sheet);
  TissueState state = sheet.start;
  EquilibriumSolver solver(sheet.model, {.threads = test::UseThreads(2)});
  EXPECT_TRUE(solver.IsStructured());
  (void)solver.Solve(Exact(SolverKind::kAcceleratedDescent), sheet.Load(), state);
  EXPECT_LT(CalcError(sheet.model, state, truth), 2e-5);
}

// Without virtual springs a small residual hides a large error (issue 4): the estimate must see it.
TEST(Newton, ItsEstimateBoundsTheTrueErrorWhereTheResidualDoesNot) {
  const Sheet sheet = MakeSheet(60, 0.0);
  TissueState truth = sheet.start;
  EquilibriumSolver solver(sheet.model);
  (void)solver.Solve(Exact(SolverKind::kAdaptive), sheet.Load(), truth);
  SolverSettings exact = Exact(SolverKind::kNewtonMultigrid);
  exact.max_error = 1e-9;
  ASSERT_TRUE(solver.Solve(exact, sheet.Load(), truth).converged);
  // a smooth bulge: every spring hardly knows of it, every node is far off
  TissueState state = truth;
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    const Vec3& at = sheet.model.rest[i];
    if (state.condition[i] == NodeCondition::kPrescribed) continue;
    state.position[i].z += 0.5 * std::sin(M_PI * at.x / 59) * std::sin(M_PI * at.y / 59);
  }
  const double error = CalcError(sheet.model, state, truth);
  SolverSettings look = exact;
  look.newton.max_steps = 0;
  const SolveReport report = solver.Solve(look, sheet.Load(), state);
  EXPECT_LT(report.residual, 0.1 * error);
  EXPECT_GT(report.error, 0.5 * error);
}

// Two states of a compressed column are stable; the way back from a crumpled start must end in one that is.
TEST(Newton, ComesHomeFromACrumpledStart) {
  CrumpledSphere sphere;
  const TissueModel& model = sphere.model;
  TissueState& state = sphere.state;
  const double before = CalcEnergy(model, state, {});
  EquilibriumSolver solver(model);
  SolverSettings settings = Exact(SolverKind::kNewtonMultigrid);
  const SolveReport report = solver.Solve(settings, {}, state);
  EXPECT_LT(CalcEnergy(model, state, {}), 1e-3 * before);
  EXPECT_TRUE(report.converged) << report.error;
}

// A contact shows in the stiffness only while it presses. Where one lies a three-hundredth of a step ahead, and is a
// hundred thousand times as stiff as the tissue, the whole step and all its halves lead uphill.
TEST(Newton, FindsAContactThatDoesNotPressYet) {
  TissueDefinition definition;
  definition.rest = {{0, 0, 0}, {0.003, 0, 0}, {0, 0.003, 0}};
  definition.mass.assign(3, 0.0);
  definition.shape_stiffness.assign(3, 0.1);
  for (const auto& [a, b] : {std::pair{0u, 1u}, {1u, 2u}, {2u, 0u}})
    definition.springs.push_back({a, b, 100.0, math::Distance(definition.rest[a], definition.rest[b])});
  const TissueModel model = MakeTissueModel(definition);
  constexpr double kAhead = 1e-6, kStiffness = 3e4, kForce = 1e-3;
  const ContactSpring contact{.nodes = {0, 1, 2},
                              .weights = {1. / 3, 1. / 3, 1. / 3},
                              .normal = {0, 0, -1},
                              .offset = -kAhead,
                              .stiffness = kStiffness};
  const std::vector<Vec3> push(3, {0, 0, kForce / 3});
  const TissueLoad load{.contacts = std::span(&contact, 1), .external_force = push};
  EquilibriumSolver solver(model);
  SolverSettings settings{.kind = SolverKind::kNewtonMultigrid, .max_error = 1e-6};
  TissueState state = MakeRestState(model);
  const SolveReport report = solver.Solve(settings, load, state);
  EXPECT_TRUE(report.converged);
  EXPECT_GE(report.restarts, 7) << "the first step was not uphill at all its lengths";
  // forces along z: the push, three virtual springs and the contact
  const double z = (kForce + kStiffness * kAhead) / (3 * 0.1 + kStiffness);
  for (const Vec3& p : state.position) EXPECT_NEAR(p.z, z, 1e-10);

  settings.newton.max_linear_total = 12;  // no time for another step after such a one
  state = MakeRestState(model);
  EXPECT_FALSE(solver.Solve(settings, load, state).converged);
  EXPECT_EQ(state.position[0].z, 0.0);
}

TEST(Newton, BalancesContactsAndStrands) {
  const auto mesh = geometry::MakeSphere({0, 0, 0}, 0.03, 3);
  TissueDefinition definition = MakeMembrane(mesh, 100.0, 2e5);
  definition.strands = {{3, 40, 30.0}, {5, 60, 20.0}};
  const TissueModel model = MakeTissueModel(definition);
  ContactSpring contact{{9, 10, 11}, {0.2, 0.3, 0.5}, {}, 0, 100.0};
  const Vec3 centre = (model.rest[9] + model.rest[10] + model.rest[11]) / 3.0;
  contact.normal = -math::Normalized(centre);
  contact.offset = math::Dot(contact.normal, centre) + 0.0005;  // too shallow to buckle
  const TissueLoad load{
      .gravity = {1, 2, -3}, .stiffness_scale = 1.5, .shape_scale = 0.7, .contacts = {&contact, 1}};
  const auto solve = [&](SolverSettings settings) {
    TissueState state = MakeRestState(model);
    state.strand_is_intact[1] = 0;
    EquilibriumSolver solver(model);
    EXPECT_TRUE(solver.Solve(settings, load, state).converged) << SolverName(settings.kind);
    return state;
  };
  const TissueState truth = solve({SolverKind::kRelaxationPaper, 400'000, 1e-10, 0.0});
  EXPECT_LT(CalcError(model, solve(Exact(SolverKind::kNewtonMultigrid)), truth), 1e-4);
  EXPECT_LT(CalcError(model, solve({SolverKind::kGaussSeidelBrown2001, 100'000, 1e-9, 0.0}), truth), 1e-4);
}

// A tool that moves one node of a large sheet wakes its surroundings only.
TEST(GaussSeidel, VisitsOnlyTheSurroundingsOfWhatMoved) {
  const Sheet sheet = MakeSheet(60, 0.5);
  TissueState state = sheet.start;
  EquilibriumSolver solver(sheet.model);
  const std::uint32_t node = 30 * 60 + 30;
  state.condition[node] = NodeCondition::kPrescribed;
  state.position[node].x += 0.2;
  (void)solver.Solve({SolverKind::kGaussSeidelBrown2001, 100, 1e-3, 0.0}, {}, state);
  EXPECT_NE(state.position[node + 1], sheet.model.rest[node + 1]);
  int moved = 0;
  for (std::size_t i = 0; i < state.position.size(); ++i) moved += state.position[i] != sheet.model.rest[i];
  EXPECT_LT(moved, 700) << "of 3600";
}

}  // namespace
}  // namespace trocar::tissue
