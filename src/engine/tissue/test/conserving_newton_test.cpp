// SPDX-License-Identifier: Apache-2.0
/// \file conserving_newton_test.cpp  Ticks of Newton's method that keep a sac's volume.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sac.h"
#include "trocar/tissue/conserved_equilibrium.h"
#include "trocar_test/threads.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

// A sac that hangs wrinkled answers a pressure by more volume than at rest: a solver that went the whole way
// at each pressure would swing for ever. Wrinkles have several equilibria close to each other, hence a
// hundredth.
TEST(Conservation, NewtonSettlesOnTheSamePressureAsTheChebyshevIteration) {
  const auto hang = [](const SolverSettings& settings) {
    Sac sac(3e4);
    sac.settings.imaging_gravity = {0, 0, -9.81};
    Conservation conservation(sac.model, sac.settings);
    EquilibriumSolver solver(sac.model);
    ConservationState state = conservation.MakeState(sac.tissue);
    for (auto& intact : sac.tissue.strand_is_intact) intact = 0;
    sac.Hold(sac.Pole({0, 0, 1}, 0.8), {});
    SolveReport report;
    for (int tick = 0; tick < 60; ++tick) {
      TissueLoad load;
      report = SolveConserving(solver, settings, kTick, conservation, load, sac.tissue, state);
    }
    EXPECT_TRUE(report.converged);
    return state.organs[0].pressure;
  };
  const double chebyshev =
      hang({.kind = SolverKind::kChebyshevJacobi2015, .max_iterations = 500, .tolerance = 1e-6});
  SolverSettings newton = kExact;
  newton.kind = SolverKind::kNewtonMultigrid;
  newton.max_error = 1e-6;
  EXPECT_GT(chebyshev, 100.0);
  EXPECT_NEAR(hang(newton) / chebyshev, 1.0, 1e-2);
}

// A tense sac: as it is pulled aside its pressure turns with its wall, and Newton's method that knows it is soon there.
TEST(Conservation, NewtonKnowsHowPressureTurns) {
  struct Pulled {
    int steps = 0;
    double pressure = 0;
    Vec3 position;  // of a node that nothing holds
  };
  const auto pull = [](bool follows_snap_through) {
    Sac sac(1e3);
    Conservation conservation(sac.model, sac.settings);
    EquilibriumSolver solver(sac.model);
    ConservationState state = conservation.MakeState(sac.tissue);
    state.organs[0].target *= 1.2;
    SolverSettings settings = kExact;
    settings.kind = SolverKind::kNewtonMultigrid;
    settings.newton.follows_snap_through = follows_snap_through;
    Pulled pulled;
    for (int tick = 1; tick <= 20; ++tick) {
      sac.Hold(sac.Pole({0, 0, 1}), {{}, std::max(0, tick - 10) * Vec3{3e-4, 0, 1e-4}});
      TissueLoad load;
      const SolveReport report =
          SolveConserving(solver, settings, kTick, conservation, load, sac.tissue, state);
      if (tick > 10) pulled.steps += report.iterations;
    }
    pulled.pressure = state.organs[0].pressure;
    pulled.position = sac.tissue.position[sac.Pole({1, 0, 0})[0]];
    return pulled;
  };
  const Pulled with = pull(true), without = pull(false);
  EXPECT_GT(with.pressure, 500.0);
  EXPECT_LT(with.steps, 0.6 * without.steps) << with.steps << " instead of " << without.steps;
  EXPECT_LT(math::Distance(with.position, without.position), 1e-8);
}

// The judge of a tick that was cut short: it finds what exact ticks come to, at the tick's volume, and leaves the tick alone.
TEST(Conservation, TheJudgeOfATickKeepsTheVolumeAndFindsWhatExactTicksComeTo) {
  SolverSettings newton = kExact;
  newton.kind = SolverKind::kNewtonMultigrid;
  Sac sac(3e4);
  Conservation conservation(sac.model, sac.settings);
  EquilibriumSolver solver(sac.model), judge(sac.model);
  ConservationState state = conservation.MakeState(sac.tissue);
  const double volume = sac.Volume();
  TissueLoad load;
  const auto tick = [&](const SolverSettings& settings) {
    sac.Hold(sac.Pole({-1, 0, 0}), {{}, {-0.002, -0.001, 0}});
    sac.Hold(sac.Pole({1, 0, 0}), {math::RotationAbout({1, 0, 0}, 0.1), 0.1 * Vec3{0.002, -0.01, 0.005}});
    load = {.gravity = {0.5, -1.0, 0.2}};
    (void)SolveConserving(solver, settings, kTick, conservation, load, sac.tissue, state);
  };
  const auto distance = [&](const std::vector<Vec3>& a) {
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      most = std::fmax(most, math::Distance(a[i], sac.tissue.position[i]));
    return most;
  };
  SolverSettings short_tick = newton;
  short_tick.newton.max_steps = 2;
  for (int i = 0; i < 3; ++i) tick(short_tick);

  const Sac before = sac;
  const std::vector<Vec3> force(load.external_force.begin(), load.external_force.end());
  Sac judged = sac, at_pressure = sac;
  const SolveReport report =
      FindConservedEquilibrium(judge, newton, conservation, load, judged.tissue, state);
  EXPECT_LT(report.error, 1e-8);
  (void)judge.Solve(newton, load, at_pressure.tissue);
  EXPECT_EQ(distance(before.tissue.position), 0.0);
  for (std::size_t i = 0; i < force.size(); ++i)
    ASSERT_EQ(math::Distance(force[i], load.external_force[i]), 0.0);
  EXPECT_NEAR(judged.Volume() / volume, 1.0, 1e-7);
  EXPECT_GT(std::fabs(at_pressure.Volume() / volume - 1.0), 1e-4)
      << "negative control: at the tick's pressure";
  const double left = distance(judged.tissue.position);
  EXPECT_GT(left, 1e-5) << "the tick was not cut short";
  for (int i = 0; i < 40; ++i) tick(newton);
  EXPECT_LT(distance(judged.tissue.position), 1e-3 * left);
}

// A hand that goes on draws the tissue on: a tick that may do little is nearer the equilibrium if it begins where the
// last one leads.
TEST(Conservation, ATickThatMayDoLittleFollowsAHandThatGoesOn) {
  const auto pull = [](bool extrapolates) {
    Sac sac(3e4);
    Conservation conservation(sac.model, sac.settings);
    EquilibriumSolver solver(sac.model), judge(sac.model);
    ConservationState state = conservation.MakeState(sac.tissue);
    SolverSettings newton = kExact, little = kExact;
    newton.kind = little.kind = SolverKind::kNewtonMultigrid;
    little.newton.max_linear_total = 4;
    TissueLoad load;
    for (int tick = 1; tick <= 30; ++tick) {
      sac.Hold(sac.Pole({-1, 0, 0}), {{}, tick * Vec3{-2e-4, 1e-4, 0}});
      load = {.gravity = {0.5, -1.0, 0.2}};
      if (!extrapolates) std::fill(state.last_motion.begin(), state.last_motion.end(), Vec3{});
      (void)SolveConserving(solver, little, kTick, conservation, load, sac.tissue, state);
    }
    Sac judged = sac;
    (void)FindConservedEquilibrium(judge, newton, conservation, load, judged.tissue, state);
    double most = 0;
    for (std::size_t i = 0; i < sac.organ_nodes; ++i)
      most = std::fmax(most, math::Distance(judged.tissue.position[i], sac.tissue.position[i]));
    return most;
  };
  const double with = pull(true), without = pull(false);
  EXPECT_GT(without, 1e-5) << "the ticks were not cut short";
  EXPECT_LT(with, 0.2 * without);
}

// Where the hand turns back, the extrapolated initial guess lies uphill.
TEST(Conservation, AnExtrapolationUphillIsNotTaken) {
  const auto tick = [](const Vec3& extrapolation) {
    Sac sac(3e4);
    Conservation conservation(sac.model, sac.settings);
    EquilibriumSolver solver(sac.model);
    ConservationState state = conservation.MakeState(sac.tissue);
    SolverSettings little = kExact;
    little.kind = SolverKind::kNewtonMultigrid;
    little.newton.max_linear_total = 4;
    sac.Hold(sac.Pole({-1, 0, 0}), {{}, {-0.002, 0.001, 0}});
    TissueLoad load;
    std::fill(state.last_motion.begin(), state.last_motion.end(), extrapolation);
    (void)SolveConserving(solver, little, kTick, conservation, load, sac.tissue, state);
    return sac.tissue.position[sac.Pole({0, 0, 1})[0]];
  };
  const Vec3 alone = tick({});
  EXPECT_EQ(math::Distance(tick({0.003, 0, 0}), alone), 0.0);
  EXPECT_GT(math::Distance(tick({-1e-4, 0, 0}), alone), 1e-6) << "negative control: downhill";
}

// A sac that is dented folds, and a fold snaps at few nodes at a time.
TEST(Conservation, LocalSolvesSaveStepsInASnapThrough) {
  struct Dented {
    int steps = 0, local_solves = 0;
    double error = 0;             // largest of all ticks, of the largest displacement
    std::vector<Vec3> positions;  // at the end
  };
  const auto dent = [](bool follows_snap_through, int threads = 1) {
    Sac sac(1e3);
    Conservation conservation(sac.model, sac.settings);
    EquilibriumSolver solver(sac.model, {.threads = test::UseThreads(threads)}), judge(sac.model);
    ConservationState state = conservation.MakeState(sac.tissue);
    SolverSettings settings, exact = kExact;
    settings.kind = exact.kind = SolverKind::kNewtonMultigrid;
    settings.newton.follows_snap_through = follows_snap_through;
    exact.newton.follows_snap_through = false;
    Dented dented;
    TissueLoad load;
    for (int tick = 1; tick <= 40; ++tick) {
      sac.Hold(sac.Pole({0, 0, 1}, 0.985), {{}, tick * Vec3{0, 0, -2e-4}});
      load = {};
      const SolveReport report =
          SolveConserving(solver, settings, kTick, conservation, load, sac.tissue, state);
      EXPECT_TRUE(report.converged);
      dented.steps += report.iterations;
      dented.local_solves += report.local_solves;
      Sac judged = sac;
      (void)FindConservedEquilibrium(judge, exact, conservation, load, judged.tissue, state);
      double error = 0, scale = 0;
      for (std::size_t i = 0; i < sac.organ_nodes; ++i) {
        error = std::fmax(error, math::Distance(judged.tissue.position[i], sac.tissue.position[i]));
        scale = std::fmax(scale, math::Distance(judged.tissue.position[i], sac.model.rest[i]));
      }
      dented.error = std::fmax(dented.error, error / scale);
    }
    dented.positions = sac.tissue.position;
    return dented;
  };
  const Dented with = dent(true), without = dent(false);
  EXPECT_EQ(without.local_solves, 0);
  EXPECT_GT(with.local_solves, 10);
  EXPECT_LT(with.steps, 0.85 * without.steps) << without.steps << " steps without";
  EXPECT_LT(with.error, 1e-3);
  EXPECT_TRUE(std::ranges::equal(dent(true, 3).positions, with.positions)) << "the threads show";
}

}  // namespace
}  // namespace trocar::tissue
