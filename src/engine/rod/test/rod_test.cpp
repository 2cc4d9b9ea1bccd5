// SPDX-License-Identifier: Apache-2.0
#include "trocar/rod/rod.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace trocar::rod {
namespace {

using math::Vec3;

constexpr double kGravity = 9.81;
/// A steel wire of 0.2 mm, and silk of 3-0.
const RodMaterial kWire = MakeRoundMaterial(2e-4, 200e9, 0.3, 7800.0);
const RodMaterial kSilk = MakeRoundMaterial(2.4e-4, 4e9, 0.4, 1350.0);

std::vector<Vec3> MakeLine(std::size_t nodes, double length) {
  std::vector<Vec3> line;
  for (std::size_t i = 0; i < nodes; ++i)
    line.push_back({length * static_cast<double>(i) / static_cast<double>(nodes - 1), 0, 0});
  return line;
}

/// A rod with its solver; what it is held by is set by each test.
struct Rod {
  Rod(std::vector<Vec3> nodes, const RodMaterial& material)
      : model(MakeRodModel({nodes, material}).value()), state(MakeRodState(model, nodes)), solver(model) {}
  void Hold(std::size_t node) { state.is_held[node] = 1; }
  void HoldAngle(std::size_t segment) { state.is_angle_held[segment] = 1; }
  RodReport Solve(const RodLoad& load, int max_steps = 400) {
    return solver.Solve({.max_steps = max_steps}, load, state);
  }

  RodModel model;
  RodState state;
  RodSolver solver;
};

Rod MakeCantilever(std::size_t nodes, double length) {
  Rod rod(MakeLine(nodes, length), kWire);
  rod.Hold(0), rod.Hold(1), rod.HoldAngle(0);
  return rod;
}

TEST(Rod, ACantileverBendsByItsTipsForceAsABeam) {
  const double length = 0.1;
  const std::size_t nodes = 101;
  Rod rod = MakeCantilever(nodes, length);
  std::vector<Vec3> force(nodes);
  force.back() = {0, 1e-4, 0};
  const RodReport report = rod.Solve({.force = force});
  EXPECT_TRUE(report.converged);
  EXPECT_TRUE(report.is_stable);
  // P l^3 / 3 E I over the length that bends: from the middle of the clamp
  const double free_length = length - 0.5 * rod.model.length[0];
  const double expected = 1e-4 * free_length * free_length * free_length / (3.0 * kWire.bending);
  EXPECT_NEAR(rod.state.position.back().y, expected, 0.01 * expected);
  EXPECT_NEAR(rod.state.position.back().z, 0.0, 1e-12);
  // the clamp carries the force
  Vec3 clamp = rod.solver.Reaction(0) + rod.solver.Reaction(1);
  EXPECT_NEAR(clamp.y, -1e-4, 1e-9);
  EXPECT_EQ(rod.solver.Reaction(nodes - 1), Vec3{}) << "nothing holds the tip";
}

TEST(Rod, GrowsLongerUnderItsLoadByItsStiffnessAndTensionCarriesIt) {
  Rod rod(MakeLine(51, 0.2), kSilk);
  rod.Hold(0);
  std::vector<Vec3> force(51);
  force.back() = {5.0, 0, 0};  // five newtons
  const RodReport report = rod.Solve({.force = force});
  EXPECT_TRUE(report.converged);
  EXPECT_NEAR(report.length_error, 5.0 / kSilk.stretching, 1e-6);
  for (std::size_t s = 0; s < 50; ++s) EXPECT_NEAR(rod.state.tension[s], 5.0, 1e-3);
  EXPECT_NEAR(rod.solver.Reaction(0).x, -5.0, 1e-3);
}

TEST(Rod, HangsFromBothEndsAndItsEndsCarryItsWeight) {
  Rod rod(MakeLine(81, 0.2), kSilk);
  rod.Hold(0), rod.Hold(80);
  RodReport report;
  for (int tick = 1; tick <= 80; ++tick) {  // the hand brings the ends together
    rod.state.position.back().x = 0.2 - 0.001 * tick;
    report = rod.Solve({.gravity = {0, 0, -kGravity}}, 20);
  }
  EXPECT_TRUE(report.converged) << report.residual << " " << report.length_error;
  const double weight = 0.2 * kSilk.mass_per_length * kGravity;
  const double of_ends = 0.5 * rod.model.length[0] * kSilk.mass_per_length * kGravity;
  EXPECT_NEAR(rod.solver.Reaction(0).z, 0.5 * weight, of_ends);
  EXPECT_NEAR(rod.solver.Reaction(0).z + rod.solver.Reaction(80).z, weight, 1e-4 * weight);
  EXPECT_LT(rod.state.position[40].z, -0.03);
}

TEST(Rod, ComesBackFromAnEndThatWasThrownThroughIt) {
  Rod rod(MakeLine(41, 0.1), kSilk);
  rod.Hold(0), rod.Hold(1), rod.Hold(40);
  rod.state.position.back() = {0.02, 0,
                               0};  // straight back along itself: every bend of the last joint is as good
  RodReport report;
  for (int tick = 0; tick < 300 && !report.converged; ++tick) {
    report = rod.Solve({.gravity = {0, 0, -kGravity}}, 8);
    ASSERT_TRUE(report.is_finite);
  }
  EXPECT_TRUE(report.converged);
  EXPECT_LT(report.length_error, 1e-3);
}

TEST(Rod, TwistIsSharedByAStraightRodAndItsMomentIsGJOverItsLength) {
  Rod rod(MakeLine(41, 0.08), kWire);
  for (const std::size_t node : {0, 1, 39, 40}) rod.Hold(node);
  rod.HoldAngle(0), rod.HoldAngle(39);
  rod.state.angle[39] = 1.0;
  const RodReport report = rod.Solve({});
  EXPECT_TRUE(report.converged);
  for (std::size_t s = 0; s < 40; ++s) EXPECT_NEAR(rod.state.angle[s], static_cast<double>(s) / 39.0, 1e-6);
  EXPECT_NEAR(rod.solver.TwistReaction(39), kWire.twisting / (39 * 0.002), 1e-6 * kWire.twisting / 0.078);
}

// A frame that is carried round a cone turns by the solid angle; the twist that a held end shows must not depend on the way.
TEST(Rod, TwistComesBackWhenTheEndGoesRoundAndBack) {
  Rod rod(MakeLine(31, 0.06), kWire);
  for (const std::size_t node : {0, 1, 29, 30}) rod.Hold(node);
  rod.HoldAngle(0), rod.HoldAngle(29);
  constexpr int kSteps = 200;
  for (const int sense : {1, -1}) {
    for (int step = 1; step <= kSteps; ++step) {
      const double u = sense * 2.0 * M_PI * step / kSteps;
      const Vec3 tip = {0.05 + 0.004 * std::cos(u) - 0.004, 0.008 * std::sin(u), 0.006 * std::sin(2 * u)};
      rod.state.position[30] = tip;
      rod.state.position[29] =
          tip - 0.002 * math::Normalized({1, 0.3 * std::sin(u), 0.2 - 0.2 * std::cos(u)});
      ASSERT_LT(rod.Solve({}).length_error, 1e-3);
    }
  }
  EXPECT_NEAR(rod.solver.TwistReaction(29), 0.0, 1e-6 * kWire.twisting / 0.06);
}

TEST(Rod, AFreeThreadFallsAsFastAsTheDragAllows) {
  Rod rod(MakeLine(21, 0.05), kSilk);
  const double drag = 1e-3;
  const RodReport report = rod.Solve({.gravity = {0, 0, -kGravity}, .drag = drag});
  EXPECT_TRUE(report.converged);
  const double weight = 0.0025 * kSilk.mass_per_length * kGravity;  // of a node within
  EXPECT_NEAR(rod.state.position[10].z, -weight / drag, 0.1 * weight / drag);
  Rod again(MakeLine(21, 0.05), kSilk);
  (void)again.Solve({.gravity = {0, 0, -kGravity}, .drag = 2 * drag});
  EXPECT_GT(again.state.position[10].z, 0.7 * rod.state.position[10].z);
}

TEST(Rod, ARigidMotionOfWhatHoldsItTurnsAllOfItAlike) {
  const auto solve = [](bool is_turned) {
    Rod rod(MakeLine(31, 0.06), kSilk);
    for (const std::size_t node : {0, 1, 30}) rod.Hold(node);
    rod.HoldAngle(0);
    Vec3 tip = {0.03, 0.01, 0.02};
    const auto turn = [&](const Vec3& p) { return is_turned ? Vec3{-p.y, p.x, p.z} : p; };
    for (Vec3& p : rod.state.position) p = turn(p);
    for (auto* vectors : {&rod.state.direction, &rod.state.reference}) {
      for (Vec3& v : *vectors) v = turn(v);
    }
    rod.state.position.back() = turn(tip);
    EXPECT_TRUE(rod.Solve({.gravity = {0, 0, -kGravity}}, 2000).converged);
    return rod.state.position;
  };
  const std::vector<Vec3> plain = solve(false), turned = solve(true);
  for (std::size_t i = 0; i < plain.size(); ++i)
    EXPECT_LT(math::Distance({-plain[i].y, plain[i].x, plain[i].z}, turned[i]), 1e-7) << i;
}

TEST(Rod, GoesOnFromASavedStateBitByBit) {
  Rod rod = MakeCantilever(31, 0.06);
  (void)rod.Solve({.gravity = {0, 0, -kGravity}}, 2);
  std::vector<std::byte> bytes;
  base::StateArchive save = base::StateArchive::ForSave(bytes);
  VisitState(save, rod.state);
  Rod other = MakeCantilever(31, 0.06);
  base::StateArchive restore = base::StateArchive::ForRestore(bytes);
  VisitState(restore, other.state);

  (void)rod.Solve({.gravity = {0, 0, -kGravity}}, 3);
  (void)other.Solve({.gravity = {0, 0, -kGravity}}, 3);
  EXPECT_EQ(rod.state.position, other.state.position);
}

TEST(Rod, WorkIsBoundedAndWhatIsLeftGoesOnInTheNextSolve) {
  Rod rod = MakeCantilever(61, 0.1);
  std::vector<Vec3> force(61);
  force.back() = {-0.001, 0.002, 0};
  int solves = 0;
  for (; solves < 300; ++solves) {
    const RodReport report = rod.Solve({.force = force}, 2);
    ASSERT_LE(report.steps, 2);
    if (report.converged) break;
  }
  EXPECT_LT(solves, 300);
  Rod whole = MakeCantilever(61, 0.1);
  EXPECT_TRUE(whole.Solve({.force = force}, 2000).converged);
  EXPECT_LT(math::Distance(whole.state.position.back(), rod.state.position.back()), 1e-6);
}

TEST(Rod, NothingIsChangedByWhatIsNotFinite) {
  Rod rod = MakeCantilever(11, 0.02);
  const std::vector<Vec3> before = rod.state.position;
  std::vector<Vec3> force(11);
  force[5].x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(rod.Solve({.force = force}).is_finite);
  EXPECT_EQ(rod.state.position, before);
}

TEST(RodModel, RefusesWhatIsNoRod) {
  const auto refuse = [](std::vector<Vec3> nodes, const RodMaterial& material) {
    const auto made = MakeRodModel({std::move(nodes), material});
    EXPECT_FALSE(made.ok());
    if (made.ok()) return std::string();
    EXPECT_EQ(made.error().code, base::ErrorCode::kSceneInvalid);
    return made.error().message;
  };
  EXPECT_EQ(refuse(MakeLine(2, 0.1), kSilk), "a rod has 2 nodes; give it three at least");
  EXPECT_EQ(refuse({{0, 0, 0}, {0, 0, 0}, {1, 0, 0}}, kSilk),
            "a rod has no length between its nodes 0 and 1; give each node a place of its own");
  for (double RodMaterial::*field : {&RodMaterial::radius, &RodMaterial::bending, &RodMaterial::twisting,
                                     &RodMaterial::stretching, &RodMaterial::mass_per_length}) {
    for (const double wrong :
         {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      RodMaterial material = kSilk;
      material.*field = wrong;
      EXPECT_NE(refuse(MakeLine(5, 0.1), material), "");
    }
  }
}

}  // namespace
}  // namespace trocar::rod
