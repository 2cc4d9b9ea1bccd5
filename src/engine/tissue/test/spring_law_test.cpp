// SPDX-License-Identifier: Apache-2.0
/// \file spring_law_test.cpp  Springs that stiffen, are cut or tear: closed formulas, and every solver alike.
#include "trocar/tissue/spring_law.h"
#include "trocar_test/threads.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "test_systems.h"
#include "trocar/math/random.h"
#include "trocar/tissue/damage.h"
#include "trocar/tissue/equilibrium.h"
#include "trocar/tissue/model_check.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

constexpr SpringLaw kWall{.stiffening = 12.0, .stiffening_strain = 0.2};

SolverSettings Exact(SolverKind kind) {
  SolverSettings settings{kind, 2'000'000, 1e-10, 0.0};
  settings.max_error = 1e-7;
  settings.newton.max_steps = 1000;
  settings.newton.max_linear_iterations = 300;
  settings.outer.law_error = 1e-9;
  settings.outer.max_count = 60;
  if (kind == SolverKind::kAcceleratedDescent) {
    // what single precision bears
    settings.max_iterations = 200'000;
    settings.tolerance = 1e-6;
    settings.max_error = 1e-5;
    settings.outer.law_error = 1e-4;
  }
  return settings;
}

TEST(SpringLaw, IsHookesLawUpToItsStrainAndStiffensAsThePrintedLawBeyond) {
  const double k = 440.0, l = 0.003;
  EXPECT_EQ(CalcSpringTension(kWall, k, l, 1.1 * l), k * (1.1 * l - l));
  EXPECT_EQ(CalcSpringStiffness(kWall, k, l, 0.5 * l), k) << "a slack spring does not stiffen";
  EXPECT_NEAR(CalcSpringStiffness(kWall, k, l, 1.5 * l) / k, 1.0 + 12.0 * (0.25 - 0.04), 1e-12);
  EXPECT_EQ(CalcSpringStiffness({}, k, l, 3.0 * l), k);
}

TEST(SpringLaw, TensionIsTheSlopeOfTheEnergyAndStiffnessThatOfTheTension) {
  const double k = 3.0, l = 0.7, h = 1e-6;
  for (const double strain : {-0.5, 0.0, 0.1, 0.19999, 0.20001, 0.4, 1.07, 3.0}) {
    const double length = l * (1.0 + strain);
    const auto slope = [&](auto function) {
      return (function(kWall, k, l, length + h) - function(kWall, k, l, length - h)) / (2 * h);
    };
    EXPECT_NEAR(slope(CalcSpringEnergy), CalcSpringTension(kWall, k, l, length), 1e-6) << strain;
    EXPECT_NEAR(slope(CalcSpringTension), CalcSpringStiffness(kWall, k, l, length), 1e-4) << strain;
    const TangentSpring line = CalcTangentSpring(kWall, 0.5, k, l, length);
    EXPECT_NEAR(line.stiffness * (length - line.rest_length), 0.5 * CalcSpringTension(kWall, k, l, length),
                1e-12);
  }
}

// Property: the force is minus the gradient of the energy, with stiffening, weakened and cut springs.
TEST(SpringLaw, ResidualIsMinusTheGradientOfTheEnergy) {
  math::Random random(7);
  TissueDefinition definition = MakeMembrane(geometry::MakeSphere({0, 0, 0}, 0.03, 1), 100.0, 2e4);
  definition.laws.push_back(kWall);
  for (Spring& spring : definition.springs) spring.law = 1;
  const TissueModel model = MakeTissueModel(definition);
  TissueState state = MakeRestState(model);
  for (Vec3& p : state.position) {
    p = 1.4 * p +
        Vec3{random.Uniform(-0.006, 0.006), random.Uniform(-0.006, 0.006), random.Uniform(-0.006, 0.006)};
  }
  state.spring_factor[3] = 0.0;
  state.spring_factor[8] = 0.25;
  std::size_t stiffened = 0;
  for (const Spring& spring : definition.springs) {
    stiffened += IsStiffened(kWall, spring.rest_length,
                             math::Distance(state.position[spring.a], state.position[spring.b]));
  }
  ASSERT_GT(stiffened, definition.springs.size() / 2);
  const TissueLoad load{.gravity = {0, 0, -9.81}, .stiffness_scale = 1.3};
  std::vector<Vec3> residual(model.Size());
  CalcResidual(model, state, load, residual);
  for (std::size_t node = 0; node < model.Size(); node += 2) {
    for (int axis = 0; axis < 3; ++axis) {
      const double h = 1e-7, x = state.position[node][axis];
      state.position[node][axis] = x + h;
      const double above = CalcEnergy(model, state, load);
      state.position[node][axis] = x - h;
      const double below = CalcEnergy(model, state, load);
      state.position[node][axis] = x;
      EXPECT_NEAR(residual[node][axis], -(above - below) / (2 * h), 1e-5) << node;
    }
  }
}

class SpringLawSolvers : public testing::TestWithParam<SolverKind> {};
INSTANTIATE_TEST_SUITE_P(Every, SpringLawSolvers, testing::ValuesIn(kSolverKinds),
                         [](const auto& test) { return std::string(SolverName(test.param)); });

// Analytic: the stretch curve. A hanging mass stands where T(L) = m g, found here by bisection.
TEST_P(SpringLawSolvers, AHangingMassFollowsTheStretchCurve) {
  const double k = 50.0, length = 0.01;
  for (const double mass : {0.002, 0.008, 0.014, 0.03, 0.2}) {
    TissueDefinition definition = MakeHangingSpring(k, length, mass);
    definition.laws.push_back(kWall);
    definition.springs[0].law = 1;
    const TissueModel model = MakeTissueModel(definition);
    double low = length, high = 100 * length;
    for (int i = 0; i < 200; ++i) {
      const double middle = 0.5 * (low + high);
      (CalcSpringTension(kWall, k, length, middle) < mass * 9.81 ? low : high) = middle;
    }
    TissueState state = MakeRestState(model);
    EquilibriumSolver solver(model);
    const SolveReport report = solver.Solve(Exact(GetParam()), {.gravity = {0, 0, -9.81}}, state);
    // single precision without virtual springs has no estimate of its error
    const bool can_tell = GetParam() != SolverKind::kAcceleratedDescent;
    EXPECT_EQ(report.converged, can_tell) << report.residual << " law " << report.law_error;
    const double tolerance = GetParam() == SolverKind::kAcceleratedDescent ? 1e-5 : 1e-7;
    EXPECT_NEAR(-state.position[1].z / low, 1.0, tolerance) << "mass " << mass;
    const std::vector<std::uint32_t> top{0};
    EXPECT_NEAR(solver.CalcReaction({.gravity = {0, 0, -9.81}}, state, top).z, -mass * 9.81,
                mass * 9.81 * 1e-4);
  }
}

/// A sheet pulled far out of its plane at its middle; half-way across, springs are cut.
struct Pulled {
  TissueDefinition definition;
  TissueModel model;
  TissueState state;
  std::vector<std::uint32_t> cut;
};

Pulled MakePulled(bool is_shuffled) {
  const int side = 13;
  const auto mesh = geometry::MakeGrid(side, 1.0);
  const auto n = static_cast<std::uint32_t>(side * side);
  const auto place = [&](std::uint32_t i) { return is_shuffled ? i * 45 % n : i; };
  Pulled made;
  made.definition.rest.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) made.definition.rest[place(i)] = mesh.positions[i];
  made.definition.mass.assign(n, 0.001);
  made.definition.shape_stiffness.assign(n, 0.05);
  made.definition.laws.push_back(kWall);
  for (const auto& [a, b] : geometry::FindEdges(mesh.triangles)) {
    made.definition.springs.push_back(
        {place(a), place(b), 1.0, math::Distance(mesh.positions[a], mesh.positions[b]), 1});
    const bool crosses = (a % side == 4 && b % side == 5) && a / side > 3 && a / side < 9;
    if (crosses) made.cut.push_back(static_cast<std::uint32_t>(made.definition.springs.size() - 1));
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const bool is_border = i % side == 0 || i % side == side - 1 || i < side || i + side >= n;
    if (is_border) made.definition.fixed.push_back(place(i));
  }
  made.model = MakeTissueModel(made.definition);
  made.state = MakeRestState(made.model);
  const std::uint32_t middle = place(side / 2 * side + side / 2);
  made.state.condition[middle] = NodeCondition::kPrescribed;
  made.state.position[middle] += Vec3{0.2, 0.1, 1.5};
  return made;
}

double CalcError(const TissueModel& model, const TissueState& state, const TissueState& truth) {
  double worst = 0, largest = 0;
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    worst = std::max(worst, math::Distance(state.position[i], truth.position[i]));
    largest = std::max(largest, math::Distance(truth.position[i], model.rest[i]));
  }
  return worst / largest;
}

double LargestResidual(const TissueModel& model, const TissueState& state, const TissueLoad& load) {
  std::vector<Vec3> residual(model.Size());
  CalcResidual(model, state, load, residual);
  double largest = 0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (state.condition[i] != NodeCondition::kPrescribed)
      largest = std::max(largest, math::Norm(residual[i]));
  }
  return largest;
}

// Every solver balances the forces of the law itself, which CalcResidual evaluates without lines.
TEST_P(SpringLawSolvers, BalancesTheLawOnAStructuredAndOnAnIrregularMesh) {
  for (const bool is_shuffled : {false, true}) {
    const Pulled sheet = MakePulled(is_shuffled);
    const TissueLoad load{.gravity = {0, 0, -1}};
    TissueState state = sheet.state;
    EquilibriumSolver solver(sheet.model);
    EXPECT_EQ(solver.IsStructured(), !is_shuffled);
    const SolveReport report = solver.Solve(Exact(GetParam()), load, state);
    EXPECT_TRUE(report.converged) << report.residual << " law " << report.law_error;
    EXPECT_GT(report.outer_iterations, 1) << "some springs stiffened on the way";
    EXPECT_LT(LargestResidual(sheet.model, state, load),
              GetParam() == SolverKind::kAcceleratedDescent ? 1e-3 : 1e-6);
  }
}

// A spring that is cut while the solver runs counts as if it had never been there.
TEST_P(SpringLawSolvers, ACutSpringIsNoSpring) {
  for (const bool is_shuffled : {false, true}) {
    Pulled sheet = MakePulled(is_shuffled);
    ASSERT_EQ(sheet.cut.size(), 10u);
    const TissueLoad load{.gravity = {0, 0, -1}};
    EquilibriumSolver solver(sheet.model);
    TissueState state = sheet.state;
    (void)solver.Solve(Exact(GetParam()), load, state);
    const TissueState whole = state;
    for (const auto spring : sheet.cut) state.spring_factor[spring] = 0.0;
    (void)solver.Solve(Exact(GetParam()), load, state);

    TissueDefinition without = sheet.definition;
    for (auto at = sheet.cut.rbegin(); at != sheet.cut.rend(); ++at)
      without.springs.erase(without.springs.begin() + *at);
    const TissueModel model = MakeTissueModel(without);
    TissueState expected = MakeRestState(model);
    expected.position = whole.position;
    expected.condition = sheet.state.condition;
    EquilibriumSolver other(model);
    (void)other.Solve(Exact(SolverKind::kNewtonMultigrid), load, expected);
    const double tolerance = GetParam() == SolverKind::kAcceleratedDescent ? 1e-4 : 1e-6;
    EXPECT_LT(CalcError(sheet.model, state, expected), tolerance);
    EXPECT_GT(CalcError(sheet.model, whole, expected), 0.01) << "the cut matters";

    // and a spring that is put back is whole again
    state.spring_factor.assign(state.spring_factor.size(), 1.0);
    (void)solver.Solve(Exact(GetParam()), load, state);
    EXPECT_LT(CalcError(sheet.model, state, whole), tolerance);
  }
}

TEST_P(SpringLawSolvers, GivesTheSameBitsForAnyNumberOfThreads) {
  Pulled sheet = MakePulled(true);
  sheet.state.spring_factor[sheet.cut[0]] = 0.0;
  sheet.state.spring_factor[sheet.cut[1]] = 0.3;
  SolverSettings settings;
  settings.kind = GetParam();
  std::vector<Vec3> first;
  for (const int threads : {1, 2, 3, 4, 8}) {
    TissueState state = sheet.state;
    EquilibriumSolver solver(sheet.model, {.threads = test::UseThreads(threads)});
    for (int tick = 0; tick < 3; ++tick) (void)solver.Solve(settings, {.gravity = {0, 0, -1}}, state);
    if (first.empty()) first = state.position;
    EXPECT_EQ(first, state.position) << threads << " threads";
  }
}

// Ticks with the running bounds end where one long solve ends: nothing is lost between outer iterations.
TEST(SpringLawTicks, SettleOnTheLaw) {
  const Pulled sheet = MakePulled(true);
  const TissueLoad load{.gravity = {0, 0, -1}};
  TissueState exact = sheet.state, state = sheet.state;
  EquilibriumSolver solver(sheet.model);
  (void)solver.Solve(Exact(SolverKind::kNewtonMultigrid), load, exact);
  SolveReport report;
  for (int tick = 0; tick < 12; ++tick) report = solver.Solve({}, load, state);
  EXPECT_TRUE(report.converged);
  EXPECT_LT(CalcError(sheet.model, state, exact), 1e-3);
}

// The outer iterations of a tick share what it may do.
TEST(SpringLawTicks, RoundsSpendTogetherNoMoreThanATickMay) {
  const Pulled sheet = MakePulled(true);
  const TissueLoad load{.gravity = {0, 0, -1}};
  SolverSettings settings = Exact(SolverKind::kNewtonMultigrid);
  const auto solve = [&] {
    TissueState state = sheet.state;
    EquilibriumSolver solver(sheet.model);
    return solver.Solve(settings, load, state);
  };
  const SolveReport whole = solve();
  ASSERT_GT(whole.outer_iterations, 2);
  settings.newton.max_linear_total = whole.linear_iterations / 2;
  EXPECT_LE(solve().linear_iterations, settings.newton.max_linear_total);
}

TEST_P(SpringLawSolvers, ANodeThatLosesItsLastSpringStaysFinite) {
  TissueDefinition definition = MakeHangingSpring(50.0, 0.01, 0.002);
  const TissueModel model = MakeTissueModel(definition);
  TissueState state = MakeRestState(model);
  state.spring_factor[0] = 0.0;
  EquilibriumSolver solver(model);
  SolverSettings settings;
  settings.kind = GetParam();
  const SolveReport report = solver.Solve(settings, {.gravity = {0, 0, -9.81}}, state);
  EXPECT_TRUE(report.is_finite);
  EXPECT_TRUE(math::IsFinite(state.position[1]));
  EXPECT_LT(math::Norm(state.position[1]), 0.5);
}

TEST(SpringFactor, OneThatIsNoNumberIsFoundInTheSameTick) {
  const TissueModel model = MakeTissueModel(MakeHangingSpring(50.0, 0.01, 0.002));
  EquilibriumSolver solver(model);
  for (const double bad : {std::nan(""), -0.5, std::numeric_limits<double>::infinity()}) {
    TissueState state = MakeRestState(model);
    state.spring_factor[0] = bad;
    EXPECT_FALSE(solver.Solve({}, {}, state).is_finite) << bad;
  }
  TissueState good = MakeRestState(model);
  EXPECT_TRUE(solver.Solve({}, {}, good).is_finite) << "what was refused is not kept";
}

// --- tearing

/// Three springs in a row, stretched by 10, 38 and 44 %.
TissueState MakeStretched(const TissueModel& model) {
  TissueState state = MakeRestState(model);
  state.position = {{0, 0, 0}, {0, 0, 1.10}, {0, 0, 2.4799}, {0, 0, 3.9199}};
  return state;
}

TissueModel MakeRow(const SpringLaw& law) {
  TissueDefinition definition;
  definition.rest = {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}};
  definition.mass.assign(4, 0.0);
  definition.shape_stiffness.assign(4, 0.0);
  definition.fixed = {0};
  definition.laws.push_back(law);
  for (std::uint32_t i = 0; i < 3; ++i) definition.springs.push_back({i, i + 1, 10.0, 1.0, 1});
  return MakeTissueModel(definition);
}

TEST(TearSprings, TearsBeyondTheFailureStrainAndNothingElse) {
  std::vector<std::uint32_t> torn(4, 99);
  const TissueModel gallbladder = MakeRow({.failure_strain = 0.43}),
                    liver = MakeRow({.failure_strain = 0.38});
  TissueState state = MakeStretched(gallbladder);
  EXPECT_EQ(TearSprings(gallbladder, 0.01, state, torn), 1u);
  EXPECT_EQ(torn[0], 2u);
  EXPECT_EQ(state.spring_factor, (std::vector<double>{1, 1, 0}));
  EXPECT_EQ(TearSprings(gallbladder, 0.01, state, torn), 0u) << "once";
  // 0.37990 holds, 0.38010 does not
  state = MakeStretched(liver);
  EXPECT_EQ(TearSprings(liver, 0.01, state, torn), 1u);
  state.position[2].z += 0.0002;
  EXPECT_EQ(TearSprings(liver, 0.01, state, torn), 1u);
  EXPECT_EQ(torn[0], 1u);
  const TissueModel hooke = MakeRow({});
  state = MakeStretched(hooke);
  EXPECT_EQ(TearSprings(hooke, 0.01, state, torn), 0u);
  EXPECT_FALSE(HasTearingSprings(hooke));
  EXPECT_TRUE(HasTearingSprings(liver));
}

// Analytic: under a constant part p of the tension at failure a spring holds for 1 / (rate p^m) seconds.
TEST(TearSprings, DamageGathersWithLoadAndTime) {
  const SpringLaw law{.failure_strain = 0.5, .damage_rate = 0.25, .damage_exponent = 2.0};
  const TissueModel model = MakeRow(law);
  TissueState state = MakeRestState(model);
  state.position = {{0, 0, 0}, {0, 0, 1.4}, {0, 0, 2.6}, {0, 0, 3.5}};  // 0.8 and 0.4 of failure; slack
  std::vector<std::uint32_t> torn(4);
  const double dt = 1.0 / 128;
  int ticks = 0;
  while (ticks < 10'000 && TearSprings(model, dt, state, torn) == 0) ++ticks;
  EXPECT_EQ(torn[0], 0u);
  EXPECT_NEAR((ticks + 1) * dt, 1.0 / (0.25 * 0.64), 2 * dt);
  EXPECT_NEAR(state.spring_damage[1] / state.spring_damage[0], 0.25, 1e-9);
  EXPECT_EQ(state.spring_damage[2], 0.0);
  EXPECT_EQ(state.spring_factor[2], 1.0);
}

// A rip runs on: what one spring carried, its neighbours carry next.
TEST(TearSprings, ARipRunsThroughASheetThatIsPulledApart) {
  Pulled sheet = MakePulled(true);
  sheet.definition.laws[1].failure_strain = 0.43;
  const TissueModel model = MakeTissueModel(sheet.definition);
  EquilibriumSolver solver(model);
  TissueState state = sheet.state;
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    if (state.condition[i] == NodeCondition::kPrescribed && !model.is_fixed[i]) state.position[i].z += 2.0;
  }
  std::vector<std::uint32_t> torn(64);
  std::size_t total = 0;
  for (int tick = 0; tick < 60; ++tick) {
    const SolveReport report = solver.Solve({}, {}, state);
    ASSERT_TRUE(report.is_finite);
    total += TearSprings(model, 0.01, state, torn);
  }
  EXPECT_GE(total, 3u) << "of " << model.SpringCount();
  EXPECT_LT(total, model.SpringCount() / 2);
  EXPECT_EQ(TearSprings(model, 0.01, state, torn), 0u) << "the rip came to rest";
}

TEST(CheckTissue, RefusesLawsThatMakeNoSense) {
  const auto check = [](auto change) {
    TissueDefinition definition = MakeHangingSpring(50.0, 0.01, 0.002);
    definition.laws.push_back({});
    definition.springs[0].law = 1;
    change(definition);
    return CheckTissue(definition).ok();
  };
  EXPECT_TRUE(check([](TissueDefinition&) {}));
  EXPECT_FALSE(check([](TissueDefinition& d) { d.springs[0].law = 2; }));
  EXPECT_FALSE(check([](TissueDefinition& d) { d.laws[1].stiffening = -1; }));
  EXPECT_FALSE(check([](TissueDefinition& d) { d.laws[1].stiffening = std::nan(""); }));
  EXPECT_FALSE(check([](TissueDefinition& d) { d.laws[1].failure_strain = 0; }));
  EXPECT_FALSE(check([](TissueDefinition& d) { d.laws[1].damage_exponent = 0.5; }));
}

}  // namespace
}  // namespace trocar::tissue
