// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/conservation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sac.h"
#include "trocar/base/state_hash.h"
#include "trocar/tissue/conserved_equilibrium.h"
#include "trocar_test/threads.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

// What AreVolumesInReach() has measured is taken once, for the positions that it was asked of, and is what would be
// measured there.
TEST(Conservation, WhatWasMeasuredAheadIsTakenOnceAndForItsPositionsAlone) {
  const Sac sac(3e4);
  Conservation asked(sac.model, sac.settings), plain(sac.model, sac.settings);
  ConservationState asked_state = asked.MakeState(sac.tissue), plain_state = plain.MakeState(sac.tissue);
  const TissueLoad load;
  const auto stretched = [&](double by) {
    TissueState tissue = sac.tissue;
    for (std::uint32_t i = 0; i < sac.organ_nodes; ++i) tissue.position[i].x *= 1.0 + by;
    return tissue;
  };
  const auto keep_and_compare = [&](double by, const char* when) {
    TissueState here = stretched(by), there = here;
    asked.KeepVolumes(here, {}, asked_state);
    plain.KeepVolumes(there, {}, plain_state);
    EXPECT_EQ(here.position, there.position) << when;
    EXPECT_NE(here.position, stretched(by).position) << "something to keep, " << when;
    EXPECT_EQ(asked_state.organs[0].volume, plain_state.organs[0].volume) << when;
    EXPECT_TRUE(std::equal(asked.VolumeGradient().begin(), asked.VolumeGradient().end(),
                           plain.VolumeGradient().begin()))
        << when;
  };
  (void)asked.CalcForce(sac.tissue, load, asked_state);
  (void)plain.CalcForce(sac.tissue, load, plain_state);
  ASSERT_TRUE(asked.AreVolumesInReach(stretched(0.01), asked_state));
  keep_and_compare(0.01, "at the positions asked of");
  keep_and_compare(0.03, "at others, not asked again");
  ASSERT_TRUE(asked.AreVolumesInReach(stretched(0.01), asked_state));
  (void)asked.CalcForce(sac.tissue, load, asked_state);
  (void)plain.CalcForce(sac.tissue, load, plain_state);
  keep_and_compare(0.02, "in the next tick, asked in the last");
}

// Analytic: a thin sphere under pressure, P = 2 E t / (1 - nu) / r * strain, V = V_0 (1 + 3 strain), nu =
// 1/3.
TEST(Conservation, PressureOfAFilledSphereIsThatOfAMembrane) {
  Sac sac(100.0);
  for (auto& intact : sac.tissue.strand_is_intact) intact = 0;
  Conservation conservation(sac.model, sac.settings);
  EquilibriumSolver solver(sac.model);
  ConservationState state = conservation.MakeState(sac.tissue);
  const double strain = 1e-3;
  state.organs[0].target *= 1.0 + 3.0 * strain;
  for (int tick = 0; tick < 60; ++tick) {
    TissueLoad load;
    (void)SolveConserving(solver, {.max_iterations = 300, .tolerance = 1e-9}, kTick, conservation, load,
                          sac.tissue, state);
  }
  const double expected = 2.0 * kMembrane / (1.0 - 1.0 / 3.0) / kRadius * strain;
  EXPECT_NEAR(state.organs[0].pressure / expected, 1.0, 0.03) << state.organs[0].pressure << " Pa";
  // and its compliance is the formula's: dV/dP = 3 V (1 - nu) r / (2 E t)
  EXPECT_NEAR(state.organs[0].compliance / (3.0 * sac.Volume() * strain / expected), 1.0, 0.05);
}

// Two hands pull a sac: at every tick the volume is exact, in the end the forces balance and the pressure is
// what balances them.
TEST(Conservation, VolumeIsExactAtEveryTickAndTheRestIsEquilibrium) {
  Sac sac(3e4);
  Conservation conservation(sac.model, sac.settings);
  EquilibriumSolver solver(sac.model);
  ConservationState state = conservation.MakeState(sac.tissue);
  const double volume = sac.Volume();
  const auto left = sac.Pole({-1, 0, 0}), right = sac.Pole({1, 0, 0});
  double worst = 0;
  TissueLoad load;
  for (int tick = 0; tick < 240; ++tick) {
    const double pull = std::fmin(tick, 120) / 120.0;
    sac.Hold(left, {{}, {-0.008 * pull, -0.004 * pull, 0}});
    sac.Hold(right, {math::RotationAbout({1, 0, 0}, 0.5 * pull), 0.5 * pull * Vec3{0.002, -0.01, 0.005}});
    load = {.gravity = {0.5, -1.0, 0.2}};
    (void)SolveConserving(solver, {}, kTick, conservation, load, sac.tissue, state);
    worst = std::fmax(worst, std::fabs(sac.Volume() / volume - 1.0));
    EXPECT_DOUBLE_EQ(state.organs[0].volume, sac.Volume());
  }
  EXPECT_LT(worst, 1e-5);
  for (int tick = 0; tick < 60; ++tick) {
    load = {.gravity = {0.5, -1.0, 0.2}};
    (void)SolveConserving(solver, kExact, kTick, conservation, load, sac.tissue, state);
  }
  // balance of what CalcResidual knows with the pressure of the end
  std::vector<Vec3> gradient(sac.organ_nodes), external(sac.model.Size()), residual(sac.model.Size());
  (void)CalcVolumeGradient(std::span(sac.tissue.position).first(sac.organ_nodes),
                           sac.settings.organs[0].triangles, gradient);
  for (std::size_t i = 0; i < gradient.size(); ++i) external[i] = state.organs[0].pressure * gradient[i];
  const auto largest = [&](const TissueLoad& with) {
    CalcResidual(sac.model, sac.tissue, with, residual);
    double most = 0;
    for (std::size_t i = 0; i < sac.model.Size(); ++i) {
      if (sac.tissue.condition[i] != NodeCondition::kPrescribed)
        most = std::fmax(most, math::Norm(residual[i]));
    }
    return most;
  };
  const double balanced = largest({.gravity = {0.5, -1.0, 0.2}, .external_force = external});
  const double without = largest({.gravity = {0.5, -1.0, 0.2}});
  EXPECT_GT(std::fabs(state.organs[0].pressure), 1.0);
  EXPECT_LT(balanced, 1e-3 * without) << "negative control: without the pressure the forces do not balance";

  // negative control: the same hands without the constraint
  Sac plain(3e4);
  plain.Hold(left, {{}, {-0.008, -0.004, 0}});
  plain.Hold(right, {math::RotationAbout({1, 0, 0}, 0.5), 0.5 * Vec3{0.002, -0.01, 0.005}});
  (void)solver.Solve(kExact, {.gravity = {0.5, -1.0, 0.2}}, plain.tissue);
  EXPECT_GT(std::fabs(plain.Volume() / volume - 1.0), 1e-2);
}

TEST(Conservation, PressedSacPushesBackHarderWhenTense) {
  const auto reaction = [](double pressure) {
    Sac sac(3e4);
    Conservation conservation(sac.model, sac.settings);
    EquilibriumSolver solver(sac.model);
    ConservationState state = conservation.MakeState(sac.tissue);
    if (pressure > 0.0) {
      EXPECT_LT(FillToPressure(solver, 0, pressure, {}, conservation, sac.tissue, state), 1e-5);
      EXPECT_GT(state.organs[0].target,
                1.005 * sac.settings.organs.size() * 4.0 / 3 * M_PI * std::pow(kRadius, 3) * 0.97);
    }
    const auto pole = sac.Pole({0, -1, 0}, 0.9);
    const double before = state.organs[0].pressure;
    std::vector<Vec3> start;
    for (const auto node : pole) start.push_back(sac.tissue.position[node]);
    TissueLoad load;
    for (int tick = 0; tick < 120; ++tick) {
      const double depth = 0.003 * std::fmin(1.0, (tick + 1) / 60.0);
      for (std::size_t i = 0; i < pole.size(); ++i) {
        sac.tissue.condition[pole[i]] = NodeCondition::kPrescribed;
        sac.tissue.position[pole[i]] = start[i] + Vec3{0, depth, 0};
      }
      load = {};
      (void)SolveConserving(solver, {}, kTick, conservation, load, sac.tissue, state);
    }
    EXPECT_GT(state.organs[0].pressure, before + 1.0) << "pressing raises the pressure";
    return solver.CalcReaction(load, sac.tissue, pole).y;
  };
  const double slack = reaction(0.0), tense = reaction(1500.0);
  EXPECT_LT(slack, 0.0);
  EXPECT_LT(tense, 1.3 * slack) << "the tense one pushes back harder";
}

TEST(Conservation, APerforatedSacLeaksUntilItsPressureIsGoneAndNoDropIsLost) {
  Sac sac(3e4);
  Conservation conservation(sac.model, sac.settings);
  EquilibriumSolver solver(sac.model);
  ConservationState state = conservation.MakeState(sac.tissue);
  (void)FillToPressure(solver, 0, 800.0, {}, conservation, sac.tissue, state);
  const double full = state.organs[0].target;
  conservation.Perforate(0, 1e-6, state);
  double last = state.organs[0].pressure;
  EXPECT_NEAR(last, 800.0, 1e-9);
  TissueLoad load;
  const auto tick = [&] {
    load = {};
    (void)SolveConserving(solver, {}, kTick, conservation, load, sac.tissue, state);
  };
  for (int i = 0; i < 240; ++i) {
    tick();
    EXPECT_NEAR((state.organs[0].target + state.organs[0].leaked) / full, 1.0, 1e-12);
    EXPECT_GE(state.organs[0].pressure, 0.0);
  }
  EXPECT_LT(state.organs[0].pressure, 8.0);
  const double spilt = state.organs[0].leaked;
  EXPECT_GT(spilt, 0.005 * full);
  // pressed, it spills more; let go, it sucks nothing back
  const auto pole = sac.Pole({0, -1, 0}, 0.8);
  for (int i = 0; i < 120; ++i) {
    sac.Hold(pole, {{}, {0, 0.004 * std::fmin(1.0, i / 60.0), 0}});
    tick();
  }
  EXPECT_GT(state.organs[0].leaked, 1.02 * spilt);
  const double pressed = state.organs[0].leaked;
  for (const auto node : pole) sac.tissue.condition[node] = NodeCondition::kFree;
  for (int i = 0; i < 120; ++i) tick();
  EXPECT_GE(state.organs[0].pressure, 0.0);
  EXPECT_LT(state.organs[0].pressure, 5.0);
  EXPECT_NEAR(state.organs[0].leaked / pressed, 1.0, 0.01);
  EXPECT_GE(state.organs[0].volume, state.organs[0].target * (1 - 1e-6));
}

TEST(Conservation, NoMoreLeaksThanIsInside) {
  Sac sac(3e4);
  Conservation conservation(sac.model, sac.settings);
  ConservationState state = conservation.MakeState(sac.tissue);
  OrganVolume& organ = state.organs[0];
  const double full = organ.target;
  conservation.Perforate(0, 1e-3, state);
  for (int tick = 0; tick < 3; ++tick) {
    organ.pressure = 1e6;
    (void)conservation.CalcForce(sac.tissue, {}, state);
    ASSERT_GT(organ.pressure * organ.compliance, full) << "there is pressure for more";
    conservation.Enforce({}, kTick, sac.tissue, state);
    EXPECT_GE(organ.target, 0.0);
    EXPECT_NEAR(organ.leaked / full, 1.0, 1e-12);
  }
}

// Half of its strands gone, a sac answers pressure otherwise; ticks without time go on with what was known, but not for ever.
TEST(Conservation, FollowsAChangeWhenThereIsTimeOrAtLastWithout) {
  for (const bool has_time : {true, false}) {
    Sac sac(3e4);
    Conservation conservation(sac.model, sac.settings);
    ConservationState state = conservation.MakeState(sac.tissue);
    const auto tick = [&](bool has_time_now) {
      conservation.PredictRigidMotion(sac.tissue, state);
      (void)conservation.CalcForce(sac.tissue, {}, state);
      conservation.Enforce({}, kTick, sac.tissue, state, has_time_now);
      (void)conservation.CalcForce(sac.tissue, {}, state);
      return state.organs[0].compliance;
    };
    const double whole = tick(true);
    auto& strands = sac.tissue.strand_is_intact;
    std::fill(strands.begin(), strands.begin() + static_cast<std::ptrdiff_t>(strands.size() / 2), 0);
    if (has_time) {
      EXPECT_GT(tick(true), 1.001 * whole);
      continue;
    }
    for (int i = 0; i < Conservation::kMaxTicksWaited; ++i) EXPECT_NEAR(tick(false) / whole, 1.0, 1e-6) << i;
    EXPECT_GT(tick(false), 1.001 * whole);
  }
}

// Mirrored, a sac shrinks under pressure: how its volume answers is of no use then, as after some cuts. A hand
// that holds it takes it along all the same, tick for tick.
TEST(Conservation, AHeldPieceFollowsTheHandWhereItsVolumeDoesNotAnswer) {
  Sac sac(3e4);
  Conservation conservation(sac.model, sac.settings);
  ConservationState state = conservation.MakeState(sac.tissue);
  for (auto& intact : sac.tissue.strand_is_intact) intact = 0;
  for (std::size_t i = 0; i < sac.organ_nodes; ++i)
    sac.tissue.position[i].x = 2 * 0.02 - sac.tissue.position[i].x;
  state.last_position = sac.tissue.position;
  const auto held = sac.Pole({0, -1, 0}, 0.9);
  for (const auto node : held) sac.tissue.condition[node] = NodeCondition::kPrescribed;
  const std::uint32_t other = sac.Pole({0, 1, 0}, 0.9).front();
  const Vec3 start = sac.tissue.position[other], step{1e-4, 2e-4, 0};
  for (int tick = 1; tick <= 5; ++tick) {
    for (const auto node : held) sac.tissue.position[node] += step;
    conservation.PredictRigidMotion(sac.tissue, state);
    (void)conservation.CalcForce(sac.tissue, {}, state);
    ASSERT_LT(state.organs[0].compliance, 0.0);
    conservation.Enforce({}, kTick, sac.tissue, state);
    EXPECT_LT(math::Distance(sac.tissue.position[other], start + tick * step), 1e-9) << tick;
  }
}

/// Largest distance from a rigidly moved rest shape, after the best fit [m].
double ShapeError(const Sac& sac) {
  MotionMoments moments;
  for (std::size_t i = 0; i < sac.organ_nodes; ++i)
    moments.AddPoint(1.0, sac.model.rest[i], sac.tissue.position[i]);
  math::Pose fit = FitRigidMotion(moments, {});
  for (int i = 0; i < 3; ++i) fit = FitRigidMotion(moments, fit.rotation);
  double worst = 0;
  for (std::size_t i = 0; i < sac.organ_nodes; ++i) {
    worst = std::fmax(worst, math::Distance(fit * sac.model.rest[i], sac.tissue.position[i]));
  }
  return worst;
}

/// Frees the sac, takes it at one pole, carries it 0.2 m and turns it by a right angle. Without `follows` the
/// strands' cutting is hidden from the frames.
double CarryAway(bool follows, std::uint64_t* hash = nullptr, int threads = 1) {
  Sac sac(3e4);
  Conservation conservation(sac.model, sac.settings);
  EquilibriumSolver solver(sac.model, {.threads = test::UseThreads(threads)});
  ConservationState state = conservation.MakeState(sac.tissue);
  for (auto& intact : sac.tissue.strand_is_intact) intact = 0;
  if (!follows) state.intact_links = sac.model.SpringCount();
  const auto pole = sac.Pole({0, -1, 0}, 0.9);
  const Vec3 centre{0.02, 0.05, -0.1};
  TissueLoad load;
  Vec3 last;
  for (int tick = 0; tick < 480; ++tick) {
    const double way = std::fmin(1.0, tick / 240.0);
    const math::Quaternion turn = math::RotationAbout(math::Normalized(Vec3{1, 1, 0}), 0.5 * M_PI * way);
    const math::Pose X{turn, centre - math::Rotate(turn, centre) + way * Vec3{0.12, -0.16, 0}};
    sac.Hold(pole, X);
    load = {.gravity = {}};
    (void)SolveConserving(solver, {}, kTick, conservation, load, sac.tissue, state);
    const double drift = math::Distance(last, sac.tissue.position[0]);
    last = sac.tissue.position[0];
    if (tick < 479) continue;
    EXPECT_LT(drift, 1e-7) << "still drifts";
    if (follows) {
      EXPECT_EQ(state.regions.count, 1u);
      EXPECT_LT(math::Distance(state.X_world_rest[0] * centre, X * centre), 5e-4);
    }
  }
  if (hash != nullptr) {
    base::StateHash fingerprint;
    for (const Vec3& p : sac.tissue.position)
      fingerprint.Add(p.x), fingerprint.Add(p.y), fingerprint.Add(p.z);
    *hash = fingerprint.Value();
  }
  return ShapeError(sac);
}

TEST(Conservation, AFreedOrganIsCarriedAwayUndeformed) {
  EXPECT_LT(CarryAway(true), 1e-5);
  EXPECT_GT(CarryAway(false), 5e-3) << "negative control: a fixed frame holds it back";
}

// Imaged organs lie on others; what hangs on the jaws alone weighs on them whole.
TEST(Conservation, AFreedOrganHangsOnTheJawsByItsWholeWeight) {
  Sac sac(3e4);
  sac.settings.imaging_gravity = {0, 0, -9.81};
  Conservation conservation(sac.model, sac.settings);
  EquilibriumSolver solver(sac.model);
  ConservationState state = conservation.MakeState(sac.tissue);
  for (auto& intact : sac.tissue.strand_is_intact) intact = 0;
  const auto pole = sac.Pole({0, 0, 1}, 0.8);
  sac.Hold(pole, {});
  TissueLoad load;
  for (int tick = 0; tick < 600; ++tick) {
    load = {};
    (void)SolveConserving(solver, {.max_iterations = 200}, kTick, conservation, load, sac.tissue, state);
  }
  double weight = 0;
  for (std::size_t i = 0; i < sac.organ_nodes; ++i) weight += 9.81 * sac.model.mass[i];
  EXPECT_NEAR(solver.CalcReaction(load, sac.tissue, pole).z / -weight, 1.0, 0.01);
}

// How a volume answers is known as the organ lay at rest. One that hangs by a single strand may be turned so that the
// same pressure hardly changes its volume: what is missing then asks for any push.
TEST(Conservation, NoVolumeIsKeptByThrowingNodes) {
  constexpr double kFarthest = 8 * 0.002 + 1e-9;  // eight projections of a tick
  const Vec3 centre{0.02, 0.05, -0.1};
  double worst = 0, hardest = 0;
  for (double angle = 0.1; angle < 3.1; angle += 0.05) {
    Sac sac(0.0);
    Conservation conservation(sac.model, sac.settings);
    ConservationState state = conservation.MakeState(sac.tissue);
    for (std::size_t i = 1; i < sac.tissue.strand_is_intact.size(); ++i) sac.tissue.strand_is_intact[i] = 0;
    const math::Quaternion turn = math::RotationAbout({0, 0, 1}, angle);
    for (std::size_t i = 0; i < sac.organ_nodes; ++i)
      sac.tissue.position[i] = centre + math::Rotate(turn, sac.model.rest[i] - centre);
    state.organs[0].target *= 1.05;
    const std::vector<Vec3> before = sac.tissue.position;
    TissueLoad load;
    load.external_force = conservation.CalcForce(sac.tissue, load, state);
    conservation.Enforce(load, kTick, sac.tissue, state);
    for (std::size_t i = 0; i < before.size(); ++i)
      worst = std::fmax(worst, math::Distance(before[i], sac.tissue.position[i]));
    hardest = std::fmax(hardest, std::fabs(sac.Volume() / state.organs[0].target - 1.0));
  }
  EXPECT_LT(worst, kFarthest);
  EXPECT_GT(hardest, 1e-3) << "nothing was asked for that one tick does not give";
}

// Nothing in the model would carry it, so a piece that no hand holds lies where it was let go.
TEST(Conservation, AFreedOrganThatNobodyHoldsStays) {
  Sac sac(3e4);
  sac.settings.imaging_gravity = {0, 0, -9.81};
  Conservation conservation(sac.model, sac.settings);
  EquilibriumSolver solver(sac.model);
  ConservationState state = conservation.MakeState(sac.tissue);
  for (auto& intact : sac.tissue.strand_is_intact) intact = 0;
  for (int tick = 0; tick < 100; ++tick) {
    TissueLoad load;
    (void)SolveConserving(solver, {}, kTick, conservation, load, sac.tissue, state);
  }
  EXPECT_EQ(state.regions.count, 1u);
  for (std::size_t i = 0; i < sac.organ_nodes; ++i) {
    EXPECT_LT(math::Distance(sac.tissue.position[i], sac.model.rest[i]), 1e-9);
  }
}

TEST(Conservation, GivesTheSameBitsForAnyNumberOfThreads) {
  std::uint64_t one = 0, other = 0;
  (void)CarryAway(true, &one, 1);
  for (const int threads : {2, 4}) {
    (void)CarryAway(true, &other, threads);
    EXPECT_EQ(other, one) << threads;
  }
}

// The energy of springs and frame together falls with every round: why the alternation converges.
TEST(Conservation, EachRoundLowersTheEnergyOfSpringsAndFrame) {
  Sac sac(3e4);
  Conservation conservation(sac.model, {{}, {}, {}});
  EquilibriumSolver solver(sac.model);
  for (auto& intact : sac.tissue.strand_is_intact) intact = 0;
  ConservationState state = conservation.MakeState(sac.tissue);
  ASSERT_EQ(state.regions.count, 1u);
  sac.Hold(sac.Pole({0, -1, 0}, 0.9), {math::RotationAbout({0, 0, 1}, 0.4), {0.01, 0, 0.03}});
  const auto energy = [&] {
    // springs as the model knows them, shape about the frame
    TissueLoad springs_only{.shape_scale = 0.0};
    double sum = CalcEnergy(sac.model, sac.tissue, springs_only);
    for (std::size_t i = 0; i < sac.organ_nodes; ++i) {
      sum += 0.5 * sac.model.shape_stiffness[i] *
             math::SquaredDistance(state.X_world_rest[0] * sac.model.rest[i], sac.tissue.position[i]);
    }
    return sum;
  };
  double before = energy();
  int rounds = 0;
  for (; rounds < 400; ++rounds) {
    TissueLoad load;
    (void)SolveConserving(solver, {.max_iterations = 2000, .tolerance = 1e-9}, kTick, conservation, load,
                          sac.tissue, state);
    const double after = energy();
    ASSERT_LE(after, before * (1 + 1e-9) + 1e-12) << rounds;
    before = after;
  }
  EXPECT_LT(ShapeError(sac), 1e-6) << "nothing but a rigid motion is left";
}

TEST(Conservation, LeavesANanToTheStateGuard) {
  Sac sac(3e4);
  Conservation conservation(sac.model, sac.settings);
  ConservationState state = conservation.MakeState(sac.tissue);
  const double pressure = state.organs[0].pressure;
  sac.tissue.position[3].x = std::nan("");
  conservation.Enforce({}, kTick, sac.tissue, state);
  EXPECT_EQ(state.organs[0].pressure, pressure);
  EXPECT_TRUE(math::IsFinite(sac.tissue.position[4]));
}

}  // namespace
}  // namespace trocar::tissue
