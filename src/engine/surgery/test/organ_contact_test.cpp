// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/organ_contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "trocar/geometry/primitives.h"
#include "trocar/tissue/equilibrium.h"

namespace trocar::surgery {

using math::Vec3;

namespace {

/// A small ball above a large one, each on its own foundation.
class OrganContact : public testing::Test {
 protected:
  void Make(double gap) {
    const auto large = geometry::MakeSphere({0, 0, 0}, 0.03, 3);
    const auto small = geometry::MakeSphere({0, 0, 0.04 + gap}, 0.01, 2);
    tissue::TissueDefinition definition;
    const auto add = [&](const geometry::TriangleMesh& mesh, double shape) {
      const auto first = static_cast<std::uint32_t>(definition.rest.size());
      for (const Vec3& p : mesh.positions) {
        definition.rest.push_back(p);
        definition.mass.push_back(1e-5);
        definition.shape_stiffness.push_back(shape);
      }
      for (const auto& [a, b] : geometry::FindEdges(mesh.triangles)) {
        definition.springs.push_back(
            {first + a, first + b, 30.0, math::Distance(mesh.positions[a], mesh.positions[b])});
      }
      return first;
    };
    const auto first_large = add(large, 5.0), first_small = add(small, 0.02);
    model_ = tissue::MakeTissueModel(definition);
    state_ = tissue::MakeRestState(model_);
    organs_.clear();
    organs_.push_back(MakeOrganSurface(state_.position, first_large, large).value());
    organs_.push_back(MakeOrganSurface(state_.position, first_small, small).value());
    pair_ = MakeOrganPair(organs_, state_.position, 1, 0, {}, settings_);
    solver_.emplace(model_);
  }
  void Tick(const Vec3& gravity, bool has_contact = true) {
    contacts_.Clear();
    if (has_contact) FindOrganContacts(organs_, state_.position, settings_, pair_, contacts_);
    (void)solver_->Solve({tissue::SolverKind::kChebyshevJacobi2015, 500, 1e-6, 0.0},
                         {.gravity = gravity, .contacts = contacts_.springs}, state_);
    if (has_contact) KeepWarmStartForces(state_.position, contacts_, pair_);
    for (OrganSurface& organ : organs_) UpdateOrganSurface(organ, state_.position);
  }
  /// Moves the small ball down.
  void Overlap(double by) {
    for (std::uint32_t i = 0; i < organs_[1].node_count; ++i)
      state_.position[organs_[1].first_node + i].z -= by;
    for (OrganSurface& organ : organs_) UpdateOrganSurface(organ, state_.position);
  }
  double DeepestOverlap() const {
    double deepest = 0;
    for (std::uint32_t i = 0; i < organs_[1].node_count; ++i) {
      const Vec3& p = state_.position[organs_[1].first_node + i];
      const auto near = organs_[0].tree.FindNearest(organs_[0].Nodes(state_.position), p);
      const auto side = collision::FindSide(organs_[0].Nodes(state_.position), organs_[0].triangles,
                                            organs_[0].vertex_triangles, p, near);
      deepest = std::max(deepest, -side.distance);
    }
    return deepest;
  }

  OrganContactSettings settings_;
  tissue::TissueModel model_;
  tissue::TissueState state_;
  std::vector<OrganSurface> organs_;
  OrganPair pair_;
  ContactSet contacts_;
  std::optional<tissue::EquilibriumSolver> solver_;
};

TEST_F(OrganContact, AnOrganThatFallsOnAnotherRestsOnIt) {
  Make(0.001);
  const Vec3 down{0, 0, -20};  // would sink 10 mm on its soft foundation
  for (int tick = 0; tick < 200; ++tick) Tick(down);
  EXPECT_LT(DeepestOverlap(), 0.001);
  EXPECT_FALSE(contacts_.springs.empty());
  // the springs on both sides carry the same
  Vec3 sum;
  double total = 0;
  for (const auto& spring : contacts_.springs) {
    const double depth = tissue::CalcContactDepth(spring, state_.position);
    if (!(depth > 0.0)) continue;
    sum += (spring.stiffness * depth) * spring.normal;
    total += spring.stiffness * depth;
  }
  EXPECT_GT(total, 0.01) << "weight that the foundation no longer bears";
  EXPECT_LT(math::Norm(sum), 0.05 * total) << "action and reaction";
}

// At rest nothing moves on: springs that come and go would make both organs tremble.
TEST_F(OrganContact, WhatRestsOnAnotherLiesStill) {
  Make(0.001);
  const Vec3 down{0, 0, -20};
  for (int tick = 0; tick < 300; ++tick) Tick(down);
  const auto before = state_.position;
  Tick(down);
  double farthest = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    farthest = std::max(farthest, math::Distance(before[i], state_.position[i]));
  EXPECT_LT(farthest, 2e-5);
}

// What cannot move is pressed harder in each tick, by a millimetre, and equally from both sides: so soft springs bear any load.
TEST_F(OrganContact, WhatDoesNotGiveWayIsPressedHarderEachTick) {
  Make(0.001);
  Overlap(0.004);
  for (int tick = 1; tick <= 40; ++tick) {
    contacts_.Clear();
    FindOrganContacts(organs_, state_.position, settings_, pair_, contacts_);
    ASSERT_FALSE(contacts_.springs.empty());
    double deepest = 0;
    for (std::size_t i = 0; i < contacts_.springs.size(); i += 2) {
      const double node = tissue::CalcContactDepth(contacts_.springs[i], state_.position);
      const double surface = tissue::CalcContactDepth(contacts_.springs[i + 1], state_.position);
      ASSERT_NEAR(node, surface, 1e-12) << "action and reaction";
      deepest = std::max(deepest, node);
    }
    EXPECT_NEAR(deepest, 0.001 * std::min(tick, 31), 1e-9) << "up to 3 N kept";
    KeepWarmStartForces(state_.position, contacts_, pair_);
  }
  ForgetWarmStartForces(pair_);
  contacts_.Clear();
  FindOrganContacts(organs_, state_.position, settings_, pair_, contacts_);
  for (const auto& spring : contacts_.springs)
    EXPECT_LT(tissue::CalcContactDepth(spring, state_.position), 0.00101)
        << "negative control: without what was kept";
}

TEST_F(OrganContact, WhatHasPartedIsPressedNoMore) {
  Make(0.001);
  Overlap(0.004);
  FindOrganContacts(organs_, state_.position, settings_, pair_, contacts_);
  KeepWarmStartForces(state_.position, contacts_, pair_);
  EXPECT_GT(*std::max_element(pair_.warm_start.begin(), pair_.warm_start.end()), 0.0009);
  Overlap(-0.009);
  contacts_.Clear();
  FindOrganContacts(organs_, state_.position, settings_, pair_, contacts_);
  EXPECT_TRUE(contacts_.springs.empty());
  KeepWarmStartForces(state_.position, contacts_, pair_);
  EXPECT_EQ(*std::max_element(pair_.warm_start.begin(), pair_.warm_start.end()), 0.0);
}

// The large ball's top vertex lies beyond its neighbours, so that triangles lie there face down, under the small ball.
TEST_F(OrganContact, AFoldOfTheSurfaceTurnsNobodyInside) {
  Make(0.002);
  const auto large = organs_[0].Nodes(state_.position);
  const auto top = static_cast<std::size_t>(
      std::max_element(large.begin(), large.end(), [](const Vec3& a, const Vec3& b) { return a.z < b.z; }) -
      large.begin());
  state_.position[organs_[0].first_node + top] += {0.010, 0, -0.001};
  for (OrganSurface& organ : organs_) UpdateOrganSurface(organ, state_.position);
  int fooled = 0;
  for (std::uint32_t i = 0; i < organs_[1].node_count; ++i) {
    const Vec3& p = state_.position[organs_[1].first_node + i];
    const auto near = organs_[0].tree.FindNearest(large, p, {.max_distance = settings_.reach});
    if (!near.Found()) continue;
    fooled +=
        collision::FindSide(large, organs_[0].triangles, organs_[0].vertex_triangles, p, near).distance < 0;
  }
  EXPECT_GT(fooled, 0) << "negative control: the nearest feature says inside";
  FindOrganContacts(organs_, state_.position, settings_, pair_, contacts_);
  ASSERT_FALSE(contacts_.springs.empty());
  for (std::uint32_t i = 0; i < pair_.node_count; ++i) {
    EXPECT_EQ(pair_.is_inside[i], 0) << i;
    if (pair_.spring[i] == kNoSpring) continue;
    EXPECT_GT(contacts_.springs[pair_.spring[i]].normal.z, 0.0) << i;
  }
}

// Vertices that are clear are not searched for, and every contact is found in the tick in which it begins.
TEST_F(OrganContact, SparedSearchesChangeNothing) {
  Make(0.006);
  OrganPair searched = pair_;
  int spared = 0, found = 0;
  for (int tick = 0; tick < 400; ++tick) {
    const double t = 0.03 * tick;
    const Vec3 way{0.0008 * std::sin(2.1 * t), 0.0006 * std::cos(1.7 * t), -0.0005 * std::sin(t)};
    for (std::uint32_t i = 0; i < organs_[1].node_count; ++i)
      state_.position[organs_[1].first_node + i] += way;
    // the large one swells and shrinks below it
    for (std::uint32_t i = 0; i < organs_[0].node_count; ++i)
      state_.position[organs_[0].first_node + i] =
          (1.0 + 0.03 * std::sin(1.3 * t)) * model_.rest[organs_[0].first_node + i];
    for (OrganSurface& organ : organs_) UpdateOrganSurface(organ, state_.position);
    contacts_.Clear();
    FindOrganContacts(organs_, state_.position, settings_, pair_, contacts_);
    ContactSet all;
    std::fill(searched.clear.begin(), searched.clear.end(), ClearVertex{});
    FindOrganContacts(organs_, state_.position, settings_, searched, all);
    ASSERT_EQ(contacts_.springs.size(), all.springs.size()) << tick;
    for (std::size_t i = 0; i < all.springs.size(); ++i) {
      ASSERT_EQ(contacts_.springs[i].nodes[0], all.springs[i].nodes[0]) << tick;
      ASSERT_NEAR(contacts_.springs[i].offset, all.springs[i].offset, 1e-12) << tick;
      ASSERT_NEAR(math::Distance(contacts_.springs[i].normal, all.springs[i].normal), 0.0, 1e-9) << tick;
    }
    ASSERT_EQ(pair_.allowed, searched.allowed) << tick;
    ASSERT_EQ(pair_.is_inside, searched.is_inside) << tick;
    found += !all.springs.empty();
    spared +=
        static_cast<int>(std::count_if(pair_.clear.begin(), pair_.clear.end(), [&](const ClearVertex& clear) {
          return clear.until > organs_[0].travel;
        }));
  }
  EXPECT_GT(found, 100);
  EXPECT_LT(found, 300) << "some of the time they are apart";
  EXPECT_GT(spared, 400 * static_cast<int>(organs_[1].node_count) / 4);
}

TEST_F(OrganContact, ResetForgetsWhatHappened) {
  Make(-0.001);
  const OrganPair made = pair_;
  Overlap(-0.001);
  Overlap(0.003);
  FindOrganContacts(organs_, state_.position, settings_, pair_, contacts_);
  KeepWarmStartForces(state_.position, contacts_, pair_);
  EXPECT_NE(pair_.warm_start, made.warm_start);
  ResetPair(pair_);
  EXPECT_EQ(pair_.warm_start, made.warm_start);
  EXPECT_EQ(pair_.allowed, made.allowed);
  EXPECT_EQ(pair_.is_inside, made.is_inside);
}

// Organs that were pushed through each other come apart gently, not in one blow.
TEST_F(OrganContact, ADeepOverlapComesApartOverSeveralTicks) {
  Make(0.001);
  for (std::uint32_t i = 0; i < organs_[1].node_count; ++i)
    state_.position[organs_[1].first_node + i].z -= 0.008;
  for (OrganSurface& organ : organs_) UpdateOrganSurface(organ, state_.position);
  ASSERT_GT(DeepestOverlap(), 0.006);
  FindOrganContacts(organs_, state_.position, settings_, pair_, contacts_);
  ASSERT_FALSE(contacts_.springs.empty());
  for (const auto& spring : contacts_.springs)
    EXPECT_LT(tissue::CalcContactDepth(spring, state_.position), 0.0011);
}

// Negative control.
TEST_F(OrganContact, WithoutContactItWouldFallIn) {
  Make(0.001);
  for (int tick = 0; tick < 20; ++tick) Tick({0, 0, -20}, false);
  EXPECT_GT(DeepestOverlap(), 0.005);
}

TEST_F(OrganContact, WhatOverlappedWhenImagedIsLeftAlone) {
  Make(-0.002);
  EXPECT_GT(DeepestOverlap(), 0.001);
  for (int tick = 0; tick < 10; ++tick) Tick({});
  for (std::size_t i = 0; i < model_.Size(); ++i) {
    ASSERT_NEAR(math::Distance(state_.position[i], model_.rest[i]), 0.0, 1e-9) << i;
  }
}

/// A duct above a ball that stands fast.
class TubeOnOrgan : public testing::Test {
 protected:
  static constexpr double kRadius = 0.002;

  /// \param gap  between the duct's skin and the ball [m]
  void Make(double gap) {
    const auto ball = geometry::MakeSphere({0, 0, 0}, 0.03, 4);
    tissue::TissueDefinition definition;
    for (const Vec3& p : ball.positions) {
      definition.fixed.push_back(static_cast<std::uint32_t>(definition.rest.size()));
      definition.rest.push_back(p);
    }
    tube_ = {static_cast<std::uint32_t>(definition.rest.size()), 5, std::vector<double>(5, kRadius)};
    for (int i = 0; i < 5; ++i) definition.rest.push_back({0.004 * (i - 2), 0, 0.03 + kRadius + gap});
    definition.mass.assign(definition.rest.size(), 1e-4);
    definition.shape_stiffness.assign(definition.rest.size(), 0.1);
    for (std::uint32_t i = 0; i < 4; ++i)
      definition.springs.push_back({tube_.first_node + i, tube_.first_node + i + 1, 50.0, 0.004});
    model_ = tissue::MakeTissueModel(definition);
    state_ = tissue::MakeRestState(model_);
    organs_.clear();
    organs_.push_back(MakeOrganSurface(state_.position, 0, ball).value());
    pair_ = MakeTubePair(organs_, state_.position, tube_, 1, 0, settings_);
    solver_.emplace(model_);
  }
  void Tick(const Vec3& gravity, bool has_contact = true) {
    contacts_.Clear();
    if (has_contact) FindOrganContacts(organs_, state_.position, settings_, pair_, contacts_);
    (void)solver_->Solve({tissue::SolverKind::kChebyshevJacobi2015, 500, 1e-6, 0.0},
                         {.gravity = gravity, .contacts = contacts_.springs}, state_);
    if (has_contact) KeepWarmStartForces(state_.position, contacts_, pair_);
  }
  /// Deepest that the duct's skin lies in the ball; the ball's facets count as the ball.
  double Overlap() const {
    double deepest = 0;
    for (std::uint32_t i = 0; i < tube_.node_count; ++i)
      deepest = std::max(deepest, 0.03 + kRadius - math::Norm(state_.position[tube_.first_node + i]));
    return deepest;
  }

  OrganContactSettings settings_;
  TubeSurface tube_;
  tissue::TissueModel model_;
  tissue::TissueState state_;
  std::vector<OrganSurface> organs_;
  OrganPair pair_;
  ContactSet contacts_;
  std::optional<tissue::EquilibriumSolver> solver_;
};

TEST_F(TubeOnOrgan, ADuctThatIsPressedOnAnOrganLiesOnIt) {
  Make(0.001);
  for (int tick = 0; tick < 100; ++tick) Tick({0, 0, -20});  // would sink 20 mm on its foundation
  EXPECT_LT(Overlap(), 0.0005);
  EXPECT_NEAR(state_.position[tube_.first_node + 2].z, 0.03 + kRadius, 0.0005);
  for (const ContactLink& link : contacts_.links) EXPECT_LE(link.surface, 1);
}

// Negative control.
TEST_F(TubeOnOrgan, WithoutContactItWouldGoThrough) {
  Make(0.001);
  for (int tick = 0; tick < 20; ++tick) Tick({0, 0, -20}, false);
  EXPECT_GT(Overlap(), 0.005);
}

TEST_F(TubeOnOrgan, ADuctThatRunsInsideOfAnOrganStaysWhereItIs) {
  Make(-0.006);
  for (int tick = 0; tick < 10; ++tick) Tick({});
  for (std::size_t i = 0; i < model_.Size(); ++i)
    ASSERT_NEAR(math::Distance(state_.position[i], model_.rest[i]), 0.0, 1e-9) << i;
  for (int tick = 0; tick < 100; ++tick) Tick({0, 0, -20});
  EXPECT_LT(Overlap(), 0.0065) << "but it goes no deeper";
}

TEST_F(OrganContact, BoundVerticesAreLeftToTheirStrands) {
  Make(-0.002);
  FindOrganContacts(organs_, state_.position, settings_, pair_, contacts_);
  EXPECT_GT(contacts_.springs.size(), 0u);
  std::fill(pair_.is_bound.begin(), pair_.is_bound.end(), std::uint8_t{1});
  contacts_.Clear();
  FindOrganContacts(organs_, state_.position, settings_, pair_, contacts_);
  EXPECT_EQ(contacts_.springs.size(), 0u);
}

}  // namespace
}  // namespace trocar::surgery
