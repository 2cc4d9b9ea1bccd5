// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/contact.h"

#include <gtest/gtest.h>

#include "organ_fixture.h"

namespace trocar::surgery {
namespace {

class Contact : public OrganFixture {
 protected:
  /// Closed tool pointing down (-z) with its tip at `tip`.
  Pose ToolAt(const Vec3& tip) const { return {{}, tip}; }

  /// Finds contacts, solves to equilibrium, updates the surface: one tick.
  ContactReaction Press(const Pose& X_world_tool) {
    contacts_.Clear();
    FindContacts(tool_, X_world_tool, 0.0, 0, organs_, state_.position, settings_, -1, samples_, contacts_);
    (void)solver_->Solve({tissue::SolverKind::kChebyshevJacobi2015, 2000, 1e-6, 0.0},
                         {.contacts = contacts_.springs}, state_);
    UpdateOrganSurface(organs_[0], state_.position);
    return CalcContactReaction(contacts_, 0, state_.position);
  }

  ContactSettings settings_;
  ToolSamples samples_ = MakeToolSamples(tool_, settings_, 1);
  ContactSet contacts_;
};

TEST_F(Contact, NothingIsFeltBeforeTouch) {
  EXPECT_EQ(Press(ToolAt({0, 0, 0.03})).organ, -1);
  EXPECT_EQ(math::Norm(Press(ToolAt({0, 0, 0.03})).force), 0.0);
}

TEST_F(Contact, PressingDownPushesBackUpAndMoreWithDepth) {
  double last = 0;
  for (const double depth : {0.002, 0.004, 0.006}) {
    ContactReaction reaction;
    for (int tick = 0; tick < 20; ++tick) reaction = Press(ToolAt({0, 0, 0.02 - depth}));
    EXPECT_EQ(reaction.organ, 0);
    EXPECT_GT(reaction.force.z, last);
    EXPECT_LT(std::abs(reaction.force.x), 0.2 * reaction.force.z);
    last = reaction.force.z;
  }
}

// The force on the tool is the force that the organ's foundation carries.
TEST_F(Contact, ReactionBalancesTheFoundation) {
  ContactReaction reaction;
  for (int tick = 0; tick < 30; ++tick) reaction = Press(ToolAt({0, 0, 0.016}));
  Vec3 foundation;
  for (std::size_t i = 0; i < model_.Size(); ++i) {
    foundation += model_.shape_stiffness[i] * (model_.rest[i] - state_.position[i]);
  }
  EXPECT_NEAR(math::Distance(foundation, reaction.force), 0.0, 0.02 * math::Norm(reaction.force));
}

// Pushed deep, past the middle of the organ, the tool still presses the wall it came through.
TEST_F(Contact, StaysOnItsSideWhenPushedPastTheMiddle) {
  ContactReaction reaction;
  for (double z = 0.021; z > -0.006; z -= 0.002) {
    for (int tick = 0; tick < 3; ++tick) reaction = Press(ToolAt({0, 0, z}));
  }
  EXPECT_GT(reaction.force.z, 0.0);
}

TEST_F(Contact, LettingGoReturnsToRest) {
  for (int tick = 0; tick < 10; ++tick) (void)Press(ToolAt({0, 0, 0.016}));
  for (int tick = 0; tick < 30; ++tick) (void)Press(ToolAt({0, 0, 0.05}));
  for (std::size_t i = 0; i < model_.Size(); ++i) {
    EXPECT_NEAR(math::Distance(state_.position[i], model_.rest[i]), 0.0, 1e-5);
  }
}

TEST_F(Contact, ASetThatIsFullCountsWhatItDrops) {
  for (int i = 0; i < 100; ++i) {
    FindContacts(tool_, ToolAt({0, 0, 0.016}), 0.0, 0, organs_, state_.position, settings_, -1, samples_,
                 contacts_);
  }
  EXPECT_EQ(contacts_.springs.size(), ContactSet::kCapacity);
  EXPECT_GT(contacts_.dropped, 0u);
}

}  // namespace
}  // namespace trocar::surgery
