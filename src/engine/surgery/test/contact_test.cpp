// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "organ_fixture.h"

namespace trocar::surgery {

using math::Vec3;

namespace {

class Contact : public OrganFixture {
 protected:
  ContactReaction PressTo(const Vec3& tip, int ticks = 30) {
    ContactReaction reaction;
    for (int tick = 0; tick < ticks; ++tick) reaction = Tick(JointsAt(tip));
    return reaction;
  }
};

TEST_F(Contact, NothingIsFeltBeforeTouch) {
  Place(JointsAt({0, 0, 0.03}));
  const ContactReaction reaction = PressTo({0, 0, 0.025}, 3);
  EXPECT_EQ(reaction.surface, -1);
  EXPECT_EQ(math::Norm(reaction.force), 0.0);
}

TEST_F(Contact, PressingDownPushesBackUpAndMoreWithDepth) {
  Place(JointsAt({0, 0, 0.03}));
  double last = 0;
  for (const double depth : {0.002, 0.004, 0.006}) {
    const ContactReaction reaction = PressTo({0, 0, 0.02 - depth}, 20);
    EXPECT_EQ(reaction.surface, 0);
    EXPECT_GT(reaction.force.z, last);
    EXPECT_LT(std::abs(reaction.force.x), 0.2 * reaction.force.z);
    last = reaction.force.z;
  }
}

// The force on the tool is the force that the organ's foundation carries.
TEST_F(Contact, ReactionBalancesTheFoundation) {
  Place(JointsAt({0, 0, 0.03}));
  const ContactReaction reaction = PressTo({0, 0, 0.016});
  Vec3 foundation;
  for (std::size_t i = 0; i < model_.Size(); ++i) {
    foundation += model_.shape_stiffness[i] * (model_.rest[i] - state_.position[i]);
  }
  EXPECT_NEAR(math::Distance(foundation, reaction.force), 0.0, 0.02 * math::Norm(reaction.force));
}

// A crumpled sac has hundreds of triangles in a tool's way; contact between organs needs its share of the capacity.
TEST_F(Contact, ACrowdOfTrianglesIsStoppedByThoseMetFirst) {
  const auto fine = geometry::MakeSphere({0, 0, 0}, 0.02, 6);
  std::vector<OrganSurface> organs;
  organs.push_back(MakeOrganSurface(fine.positions, 0, fine).value());
  const std::vector<double> motion(2, 0.0);
  const ContactCandidates candidates{organs, nullptr, fine.positions, fine.positions, motion};
  const math::Pose outside = PoseAt(JointsAt({0, 0, 0.0225})), deep = PoseAt(JointsAt({0, 0, 0.002}));
  FindContacts({&tool_, 0, outside, outside, deep, 0.0, 0.0, -1}, candidates, settings_, last_, contacts_);
  std::array<std::uint32_t, 4096> found;
  const auto body = CalcToolBodies(tool_, 0.0, deep)[0];
  EXPECT_GT(organs[0].tree.FindWithin(fine.positions, body, found), 0u);
  EXPECT_GT(contacts_.springs.size(), 64u);
  EXPECT_LE(contacts_.springs.size(), std::size_t{64} * kToolBodyCount);
  for (std::size_t i = 1; i < contacts_.links.size(); ++i)
    EXPECT_LT(contacts_.links[i - 1].key, contacts_.links[i].key) << "the next tick finds them by their keys";
  // what lies under the tip is met first
  for (const auto& spring : contacts_.springs) EXPECT_GT(fine.positions[spring.nodes[0]].z, 0.015);
}

// Pushed deep, past the middle of the organ, the tool still presses the wall it came through.
TEST_F(Contact, StaysOnItsSideWhenPushedPastTheMiddle) {
  Place(JointsAt({0, 0, 0.03}));
  ContactReaction reaction;
  for (double z = 0.021; z > -0.006; z -= 0.002) reaction = PressTo({0, 0, z}, 3);
  EXPECT_GT(reaction.force.z, 0.0);
}

TEST_F(Contact, LettingGoReturnsToRest) {
  Place(JointsAt({0, 0, 0.03}));
  (void)PressTo({0, 0, 0.016}, 10);
  (void)PressTo({0, 0, 0.05});
  for (std::size_t i = 0; i < model_.Size(); ++i) {
    EXPECT_NEAR(math::Distance(state_.position[i], model_.rest[i]), 0.0, 1e-5);
  }
}

// Tissue that lies deep in the tool is pushed out over several ticks, with a bounded force.
TEST_F(Contact, ADeepOverlapIsNotPushedOutInOneBlow) {
  Place(JointsAt({0, 0, 0.03}));
  (void)Tick(JointsAt({0, 0, 0.005}));
  ASSERT_FALSE(contacts_.springs.empty());
  const auto rest = tissue::MakeRestState(model_);
  for (const auto& spring : contacts_.springs)
    EXPECT_LT(tissue::CalcContactDepth(spring, rest.position), 0.0031) << "of 15 mm that the hand went";
  const ContactReaction later = PressTo({0, 0, 0.005});
  EXPECT_LT(overlap_, 1e-3);
  EXPECT_GT(later.force.z, 0.1) << "and gives way in the end";
}

// A fold of tissue that turns its back on the tool is in its way like any other.
TEST_F(Contact, TissueThatTurnsItsBackIsTouched) {
  std::uint32_t top = 0;
  for (std::uint32_t i = 0; i < mesh_.positions.size(); ++i) {
    if (mesh_.positions[i].z > mesh_.positions[top].z) top = i;
  }
  // laid over beyond its ring of neighbours, the vertex on top turns some of its faces over
  state_.position[top] += Vec3{0.012, 0, 0.001};
  before_ = state_.position;
  UpdateOrganSurface(organs_[0], state_.position);
  const auto looks_up = [&](const std::array<std::uint32_t, 3>& t) {
    return math::Cross(state_.position[t[1]] - state_.position[t[0]],
                       state_.position[t[2]] - state_.position[t[0]])
               .z > 0.0;
  };
  const math::Pose X = PoseAt(JointsAt({0.009, 0, 0.0215}));
  FindContacts({&tool_, 0, X, X, X, 0, 0, -1}, GetContactCandidates(), settings_, last_, contacts_);
  int turned = 0;
  for (const auto& spring : contacts_.springs) {
    const bool is_of_top = std::find(spring.nodes.begin(), spring.nodes.end(), top) != spring.nodes.end();
    turned += is_of_top && !looks_up(spring.nodes);
  }
  EXPECT_GT(turned, 0);
}

// The whole shaft touches: 40 mm behind the jaws, where no sphere of a short reach would have been.
TEST_F(Contact, TheShaftPushesSideways) {
  const Vec3 beside{0.03, 0.0, -0.08};  // the tip far below, the shaft beside the organ
  Place(JointsAt(beside));
  ContactReaction reaction;
  for (double x = 0.03; x > 0.012; x -= 0.001) reaction = Tick(JointsAt({x, 0, -0.08}));
  EXPECT_EQ(reaction.surface, 0);
  EXPECT_GT(reaction.force.x, 0.05);
  EXPECT_GT(reaction.force.x, 3 * std::abs(reaction.force.z));
}

TEST_F(Contact, DuctsArePushed) {
  Place(JointsAt({0, 0.06, 0.01}));
  const Vec3 rest = DuctMiddle();
  ContactReaction reaction;
  for (double z = 0.008; z > -0.008; z -= 0.001) reaction = Tick(JointsAt({0, 0.06, z}));
  EXPECT_EQ(reaction.surface, 1) << "organs first, then tubes";
  EXPECT_GT(reaction.force.z, 0.005);
  EXPECT_LT(DuctMiddle().z, rest.z - 0.003);
}

// 2 m/s at 120 Hz: the tip is above the duct in one tick and below it in the next.
TEST_F(Contact, AFastTipDoesNotPassADuctBetweenTwoTicks) {
  const double step = 2.0 / 120;
  for (const double start : {0.0045, 0.006, 0.009, 0.012}) {
    state_ = tissue::MakeRestState(model_);
    before_ = state_.position;
    tubes_.tree.Update(state_.position);
    Place(JointsAt({0.001, 0.06, start}));
    const ContactReaction reaction = Tick(JointsAt({0.001, 0.06, start - step}));
    EXPECT_EQ(reaction.surface, 1) << start;
    EXPECT_GT(reaction.force.z, 0.0) << "pushed from above";
    (void)Tick(JointsAt({0.001, 0.06, start - step}));
    EXPECT_LT(DuctMiddle().z, -0.0005) << "the duct goes with the tool, before it slips aside";
    EXPECT_LT(overlap_, 1e-4);
  }
  // negative control: looking only at where the hand is finds nothing in the same step
  state_ = tissue::MakeRestState(model_);
  before_ = state_.position;
  tubes_.tree.Update(state_.position);
  Place(JointsAt({0.001, 0.06, 0.012 - step}));
  settings_.margin = 0;
  const ContactReaction late = Tick(JointsAt({0.001, 0.06, 0.012 - step}));
  EXPECT_LE(late.force.z, 0.0);
}

// Tissue that shot past the tool in one solve is caught in the next tick, on the side that it came from.
TEST_F(Contact, TissueThatSnappedPastTheToolIsCaught) {
  // the duct was below the shaft, which leans across it, and is above now
  const auto joints = JointsAt({0.0, 0.09, -0.02});
  Place(joints);
  const auto bodies = CalcToolBodies(tool_, 0.0, PoseAt(joints));
  const collision::Segment shaft = bodies[static_cast<int>(ToolBody::kShaft)].axis;
  // where the shaft passes y = 60 mm
  const double t = (0.06 - shaft.start.y) / (shaft.end.y - shaft.start.y);
  const double z = math::Lerp(shaft.start, shaft.end, t).z;
  for (std::uint32_t i = 0; i < kDuctNodes; ++i) {
    before_[first_duct_node_ + i].z = z - 0.012;
    state_.position[first_duct_node_ + i].z = z + 0.012;
  }
  tubes_.tree.Update(state_.position);
  const ToolMotion motion{&tool_, 0, X_proxy_, X_proxy_, PoseAt(joints), 0, 0, -1};
  motion_ = {0, 0};
  FindContacts(motion, GetContactCandidates(), settings_, last_, contacts_);
  EXPECT_TRUE(contacts_.springs.empty()) << "negative control: as if nothing had moved";
  motion_ = {0, 0.024};
  FindContacts(motion, GetContactCandidates(), settings_, last_, contacts_);
  ASSERT_FALSE(contacts_.springs.empty());
  EXPECT_LT(contacts_.springs[0].normal.z, 0.0) << "pushed back down";
  EXPECT_GT(tissue::CalcContactDepth(contacts_.springs[0], state_.position), 0.0);
}

// Where an edge lies nearly along the tool, the nearest place on it leaps from end to end with every solve.
TEST_F(Contact, WhatBearsGoesHalfWayToWhereItIsNearestNow) {
  Place(JointsAt({0, 0, 0.03}));
  (void)PressTo({0, 0, 0.0175});
  const auto joints = JointsAt({0.0006, 0.0003, 0.0175});
  const ToolMotion motion{&tool_, 0, X_proxy_before_, X_proxy_, PoseAt(joints), 0.0, 0.0, -1};
  ContactSet kept, fresh;
  FindContacts(motion, GetContactCandidates(), settings_, contacts_, kept);
  FindContacts(motion, GetContactCandidates(), settings_, ContactSet{}, fresh);
  const auto find = [](const ContactSet& set, std::uint64_t key) {
    const auto at = std::find_if(set.links.begin(), set.links.end(), [key](const ContactLink& link) {
      return link.key == key && !link.is_friction;
    });
    return at == set.links.end() ? nullptr : &set.springs[static_cast<std::size_t>(at - set.links.begin())];
  };
  int bearing = 0, idle = 0;
  for (std::size_t i = 0; i < contacts_.links.size(); ++i) {
    const ContactLink& link = contacts_.links[i];
    const auto* before = &contacts_.springs[i];
    const auto *now = find(kept, link.key), *nearest = find(fresh, link.key);
    if (link.is_friction || now == nullptr || nearest == nullptr || before->weights == nearest->weights)
      continue;
    const double share = link.normal_force > 0.0 ? 0.5 : 0.0;
    (share > 0.0 ? bearing : idle) += 1;
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(now->weights[k], share * before->weights[k] + (1.0 - share) * nearest->weights[k], 1e-12);
    EXPECT_NEAR(math::Norm(now->normal), 1.0, 1e-12);
  }
  EXPECT_GT(bearing, 0);
  EXPECT_GT(idle, 0);
}

TEST_F(Contact, ASetThatIsFullCountsWhatItDrops) {
  Place(JointsAt({0, 0, 0.0215}));
  const ToolMotion motion{&tool_, 0, X_proxy_, X_proxy_, PoseAt(JointsAt({0, 0, 0.016})), 0, 0, -1};
  for (int i = 0; i < 300; ++i) FindContacts(motion, GetContactCandidates(), settings_, last_, contacts_);
  EXPECT_EQ(contacts_.springs.size(), ContactSet::kCapacity);
  EXPECT_GT(contacts_.dropped, 0u);
}

class Friction : public Contact {
 protected:
  /// Presses the top of the organ, then drags the tip along x; the largest ratio of the force along x to that
  /// along z while it slides on.
  struct Drag {
    double tangential, normal;
  };
  Drag DragAlong(double way, int ticks) {
    Place(JointsAt({0, 0, 0.03}));
    ContactReaction reaction = PressTo({0, 0, 0.0185}, 20);
    for (int tick = 1; tick <= ticks; ++tick) reaction = Tick(JointsAt({way * tick / ticks, 0, 0.0185}));
    // forces along and across the contact's own normal
    Vec3 normal, friction;
    for (std::size_t i = 0; i < contacts_.springs.size(); ++i) {
      const double depth = tissue::CalcContactDepth(contacts_.springs[i], state_.position);
      if (!(depth > 0.0)) continue;
      const Vec3 force = (contacts_.springs[i].stiffness * depth) * contacts_.springs[i].normal;
      (contacts_.links[i].is_friction ? friction : normal) += force;
    }
    return {friction.x, math::Norm(normal)};
  }
};

TEST_F(Friction, DraggedTissueIsCarriedAlong) {
  const Drag drag = DragAlong(0.002, 40);
  EXPECT_GT(drag.tangential, 0.02 * drag.normal) << "friction pulls the tissue the way the tool goes";
  EXPECT_LE(drag.tangential, 1.05 * settings_.friction * drag.normal) << "and no harder than Coulomb's limit";
}

TEST_F(Friction, GrowsWithTheCoefficientAndIsNoneWithoutIt) {
  settings_.friction = 0.0;
  EXPECT_EQ(DragAlong(0.002, 40).tangential, 0.0);
  state_ = tissue::MakeRestState(model_);
  UpdateOrganSurface(organs_[0], state_.position);
  settings_.friction = 0.02;
  const double little = DragAlong(0.002, 40).tangential;
  state_ = tissue::MakeRestState(model_);
  UpdateOrganSurface(organs_[0], state_.position);
  settings_.friction = 0.25;
  EXPECT_GT(DragAlong(0.002, 40).tangential, 1.2 * little);
}

// Stick and slip come to rest: held still, a tool does not go on to creep through the tissue.
TEST_F(Friction, AToolThatStaysHoldsItsTissueStill) {
  Place(JointsAt({0, 0, 0.03}));
  (void)PressTo({0, 0, 0.0185}, 120);
  const std::vector<Vec3> settled = state_.position;
  (void)PressTo({0, 0, 0.0185}, 60);
  for (std::size_t i = 0; i < settled.size(); ++i) {
    ASSERT_NEAR(math::Distance(settled[i], state_.position[i]), 0.0, 1e-5) << i;
  }
}

}  // namespace
}  // namespace trocar::surgery
