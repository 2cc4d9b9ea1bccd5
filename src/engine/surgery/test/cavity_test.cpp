// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/cavity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "trocar/geometry/primitives.h"
#include "trocar/math/random.h"
#include "trocar/tissue/equilibrium.h"

namespace trocar::surgery {

using math::Vec3;

namespace {

constexpr auto kWall = static_cast<std::size_t>(CavityPart::kFrontWall);
constexpr auto kDome = static_cast<std::size_t>(CavityPart::kDiaphragm);
constexpr auto kFloor = static_cast<std::size_t>(CavityPart::kFloor);

/// Points under a dome, half of them of its flanks, where it is no roof.
std::vector<Vec3> MakeFace(const Cavity& dome, math::Random& random) {
  std::vector<Vec3> face;
  for (int i = 0; i < 100; ++i) {
    const double x = random.Uniform(-0.05, 0.05), z = random.Uniform(-0.05, 0.05);
    face.push_back({dome.dome_x + x, dome.dome_top - dome.dome_across * x * x - dome.dome_deep * z * z,
                    dome.dome_z + z});
    face.push_back({dome.dome_x - 0.1, dome.dome_top - random.Uniform(0.05, 0.1), dome.dome_z + z});
  }
  return face;
}

TEST(FitCavity, FindsTheDomeThroughTheDiaphragmaticFace) {
  math::Random random(3);
  Cavity dome;
  dome.dome_top = 0.21, dome.dome_x = -0.03, dome.dome_z = -0.15;
  dome.dome_across = 5.0, dome.dome_deep = 6.0;
  const Cavity cavity = FitCavity({}, MakeFace(dome, random), {});
  ASSERT_TRUE(cavity.has_dome);
  EXPECT_NEAR(cavity.dome_top, dome.dome_top, 1e-9);
  EXPECT_NEAR(cavity.dome_x, dome.dome_x, 1e-9);
  EXPECT_NEAR(cavity.dome_z, dome.dome_z, 1e-9);
  EXPECT_NEAR(cavity.dome_across, 5.0, 1e-6);
  EXPECT_NEAR(cavity.dome_deep, 6.0, 1e-6);
  EXPECT_FALSE(cavity.has_wall);
  EXPECT_FALSE(cavity.has_floor);
  EXPECT_TRUE(std::isinf(cavity.FindClearances({})[kWall].distance));
}

TEST(FitCavity, PutsTheFrontWallThroughTheStandardPorts) {
  const Vec3 ports[] = {{0, 0, 0}, {-0.015, 0.130, -0.005}, {-0.085, 0.080, -0.015}, {-0.140, 0.035, -0.045}};
  const Cavity cavity = FitCavity(ports, {}, {});
  for (const Vec3& port : ports) EXPECT_NEAR(cavity.FindClearances(port)[kWall].distance, 0.0, 0.003);
  EXPECT_NEAR(cavity.FindClearances({0, 0, -0.03})[kWall].distance, 0.03, 0.002);
  EXPECT_LT(cavity.FindClearances({0, 0, 0.01})[kWall].distance, 0.0);
}

TEST(FitCavity, AFaceThatIsNoDomeOrTooFewPointsMakeNone) {
  math::Random random(3);
  std::vector<Vec3> face;
  for (int i = 0; i < 50; ++i) face.push_back({random.Uniform(-1, 1), 0.1, random.Uniform(-1, 1)});
  EXPECT_FALSE(FitCavity({}, face, {}).has_dome) << "flat";
  for (Vec3& p : face) p.y = 3.0 * (p.x * p.x + p.z * p.z);
  EXPECT_FALSE(FitCavity({}, face, {}).has_dome) << "a bowl";
  for (Vec3& p : face) p = {0, 0.1, 0};
  EXPECT_FALSE(FitCavity({}, face, {}).has_dome) << "a point";
  for (Vec3& p : face) p = {random.Uniform(-0.1, 0.1), 0, random.Uniform(-0.1, 0.1)};
  for (Vec3& p : face) p.y = 0.2 - 5.0 * (p.x * p.x + p.z * p.z);
  EXPECT_TRUE(FitCavity({}, face, {}).has_dome);
  face.resize(kLeastDomePoints - 1);
  EXPECT_FALSE(FitCavity({}, face, {}).has_dome) << "too few";
}

// The way inwards is the distance's slope.
TEST(Cavity, TheDirectionInwardsIsTheSlopeOfTheRoom) {
  math::Random random(5);
  Cavity cavity;
  cavity.has_wall = cavity.has_dome = cavity.has_floor = true;
  cavity.dome_top = 0.2, cavity.dome_x = -0.05, cavity.dome_z = -0.1;
  cavity.dome_across = 5, cavity.dome_deep = 6;
  cavity.floor = -0.2;
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 200; ++i) {
    Vec3 p{random.Uniform(-0.1, 0.1), random.Uniform(-0.1, 0.2), random.Uniform(-0.2, 0.0)};
    for (const std::size_t part : {kWall, kDome, kFloor}) {
      // the two domes' distances are right near them
      const auto there = cavity.FindClearances(p)[part];
      Vec3 q = p;
      for (int k = 0; k < 20; ++k)
        q -= cavity.FindClearances(q)[part].distance * cavity.FindClearances(q)[part].inwards;
      const auto clearance = cavity.FindClearances(q)[part];
      EXPECT_NEAR(clearance.distance, 0.0, 1e-9);
      EXPECT_NEAR(math::Norm(clearance.inwards), 1.0, 1e-12);
      const auto further = cavity.FindClearances(q + kStep * clearance.inwards)[part];
      EXPECT_NEAR((further.distance - clearance.distance) / kStep, 1.0, 1e-3) << i;
      EXPECT_GT(there.distance * math::Dot(p - q, clearance.inwards), -1e-12)
          << "inside is where the room is";
    }
  }
}

/// A ball of tissue under a dome, each vertex on a weak foundation.
class BallInCavity : public testing::Test {
 protected:
  /// \param gap  between the ball and the top of the dome [m]
  void Make(double gap) {
    // of curvature 1 / 50 mm at its top
    cavity_.dome_top = 0.05;
    cavity_.dome_across = cavity_.dome_deep = 10;
    cavity_.has_dome = true;
    const auto ball = geometry::MakeSphere({0, 0.03 - gap, 0}, 0.02, 3);
    tissue::TissueDefinition definition;
    for (const Vec3& p : ball.positions) {
      definition.rest.push_back(p);
      definition.mass.push_back(1e-5);
      definition.shape_stiffness.push_back(0.02);
    }
    for (const auto& [a, b] : geometry::FindEdges(ball.triangles))
      definition.springs.push_back({a, b, 30.0, math::Distance(ball.positions[a], ball.positions[b])});
    model_ = tissue::MakeTissueModel(definition);
    state_ = tissue::MakeRestState(model_);
    before_ = state_.position;
    organs_.clear();
    organs_.push_back(MakeOrganSurface(state_.position, 0, ball).value());
    contact_ = MakeCavityContact(cavity_, organs_, state_.position, model_.is_fixed, 0, settings_);
    solver_.emplace(model_);
  }
  void Tick(const Vec3& gravity, bool has_contact = true) {
    contacts_.Clear();
    if (has_contact)
      FindCavityContacts(cavity_, organs_, state_.position, before_, settings_, contact_, contacts_);
    before_ = state_.position;
    (void)solver_->Solve({tissue::SolverKind::kChebyshevJacobi2015, 500, 1e-6, 0.0},
                         {.gravity = gravity, .contacts = contacts_.springs}, state_);
  }
  /// Farthest that a vertex lies outside of the dome.
  double Outside() const {
    double outside = 0;
    for (const Vec3& p : state_.position)
      outside = std::max(outside, -cavity_.FindClearances(p)[kDome].distance);
    return outside;
  }

  Cavity cavity_;
  CavityContactSettings settings_;
  CavityContact contact_;
  tissue::TissueModel model_;
  tissue::TissueState state_;
  std::vector<OrganSurface> organs_;
  ContactSet contacts_;
  std::optional<tissue::EquilibriumSolver> solver_;
  std::vector<Vec3> before_;
};

TEST_F(BallInCavity, RestsUnderTheDomeWhenItIsPushedUp) {
  Make(0.002);
  const Vec3 up{0, 20, 0};  // would rise 10 mm on its foundation
  for (int tick = 0; tick < 100; ++tick) Tick(up);
  EXPECT_LT(Outside(), 0.001);
  // the dome bears what the foundation does not
  double borne = 0;
  for (const auto& spring : contacts_.springs) {
    const double depth = tissue::CalcContactDepth(spring, state_.position);
    if (depth > 0.0) borne += spring.stiffness * depth * -spring.normal.y;
  }
  double risen = 0;
  for (std::size_t i = 0; i < model_.Size(); ++i) risen += 0.02 * (state_.position[i].y - model_.rest[i].y);
  const double weight = 20.0 * 1e-5 * static_cast<double>(model_.Size());
  EXPECT_NEAR(borne + risen, weight, 0.02 * weight);
  EXPECT_GT(borne, 0.2 * weight);
}

// Negative control.
TEST_F(BallInCavity, WithoutTheDomeItWouldPassIt) {
  Make(0.002);
  for (int tick = 0; tick < 100; ++tick) Tick({0, 20, 0}, false);
  EXPECT_GT(Outside(), 0.005);
}

TEST_F(BallInCavity, WhatLayBeyondTheWallWhenImagedIsLeftAlone) {
  Make(-0.003);
  EXPECT_GT(Outside(), 0.002);
  for (int tick = 0; tick < 10; ++tick) {
    Tick({});
    EXPECT_TRUE(contacts_.springs.empty());
  }
  for (std::size_t i = 0; i < model_.Size(); ++i)
    ASSERT_NEAR(math::Distance(state_.position[i], model_.rest[i]), 0.0, 1e-9) << i;
  for (int tick = 0; tick < 100; ++tick) Tick({0, 20, 0});
  EXPECT_LT(Outside(), 0.004) << "but it goes no further";
}

TEST_F(BallInCavity, VerticesThatAnatomyHoldsMakeNoContact) {
  Make(0.0);
  contact_.is_held.assign(contact_.is_held.size(), 1);
  for (Vec3& p : before_) p.y -= 0.02;
  FindCavityContacts(cavity_, organs_, state_.position, before_, settings_, contact_, contacts_);
  EXPECT_TRUE(contacts_.springs.empty());
}

TEST_F(BallInCavity, VerticesThatACutMadeKeepTheirPlace) {
  Make(-0.003);
  const std::size_t before = contact_.allowed.size();
  contact_.allowed.resize(before / 2), contact_.is_held.resize(before / 2);
  UpdateTopology(cavity_, organs_, state_.position, settings_, contact_);
  EXPECT_EQ(contact_.allowed.size(), before);
  EXPECT_EQ(contact_.is_held.size(), before);
  for (int tick = 0; tick < 5; ++tick) {
    Tick({});
    EXPECT_TRUE(contacts_.springs.empty());
  }
}

TEST_F(BallInCavity, WhatFindsNoRoomIsCounted) {
  Make(-0.003);
  const std::size_t before = 950;
  contacts_.springs.resize(before), contacts_.links.resize(before);
  for (Vec3& p : before_) p.y -= 0.02;
  FindCavityContacts(cavity_, organs_, state_.position, before_, settings_, contact_, contacts_);
  EXPECT_EQ(contacts_.springs.size(), ContactSet::kCapacity);
  EXPECT_GT(contacts_.dropped, 0u);
}

}  // namespace
}  // namespace trocar::surgery
