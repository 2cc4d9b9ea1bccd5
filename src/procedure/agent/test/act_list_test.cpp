// SPDX-License-Identifier: Apache-2.0
// Verbs as lists of acts.
#include "act_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "made_up_patient.h"

namespace trocar::agent {

using instrument::kLeft;
using instrument::kRight;
using instrument::ToolKind;

namespace {

using testing::ElementsAre;
using Kind = SurgeonAct::Kind;

struct Verbs : public testing::Test, protected MadeUpPatient {
  std::vector<Kind> Kinds() const {
    std::vector<Kind> kinds;
    for (const SurgeonAct& act : plan.acts) kinds.push_back(act.kind);
    return kinds;
  }
};

TEST_F(Verbs, AGraspOpensGoesBeforeGoesPastAndCloses) {
  plan.Grasp(kLeft, Place::AtNode(4), 0.07);
  EXPECT_THAT(Kinds(), ElementsAre(Kind::kJaw, Kind::kReach, Kind::kReach, Kind::kJaw, Kind::kWait));
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(plan.acts[i].hand, kLeft);
  EXPECT_GT(plan.acts[0].amount, 0.5);
  EXPECT_GT(plan.acts[1].place.back, 0.0);
  EXPECT_LT(plan.acts[2].place.back, 0.0);
  EXPECT_EQ(plan.acts[3].amount, 0.07);
}

TEST_F(Verbs, WhatIsLetGoIsEasedFirstAndLeftOpen) {
  plan.LetGo(kLeft);
  EXPECT_THAT(Kinds(), ElementsAre(Kind::kEase, Kind::kJaw, Kind::kReach, Kind::kJaw));
  EXPECT_GT(plan.acts.back().amount, 0.0);
}

TEST_F(Verbs, AnExchangeNamesTheToolByItsPlaceInTheTray) {
  plan.Exchange(kRight, ToolKind::kClipApplier);
  EXPECT_THAT(Kinds(), ElementsAre(Kind::kReach, Kind::kExchange, Kind::kJaw));
  EXPECT_EQ(plan.acts[0].place.kind, Place::Kind::kOverField);
  EXPECT_EQ(plan.acts[1].tool, 2);
  EXPECT_EQ(plan.acts[2].amount, 0.0) << "what comes in comes in closed";
  plan.acts.clear();
  plan.Exchange(kRight, ToolKind::kClipApplier, false);
  EXPECT_THAT(Kinds(), ElementsAre(Kind::kExchange, Kind::kJaw));
}

TEST_F(Verbs, PedalsArePressedForAsLongAsIsAsked) {
  plan.Burn(kRight, Place::AtNode(1), 2.0);
  plan.Rinse(Place::AtNode(1), 3.0, 4.0);
  EXPECT_THAT(Kinds(), ElementsAre(Kind::kReach, Kind::kBurn, Kind::kReach, Kind::kRinse, Kind::kReach,
                                   Kind::kAspirate));
  EXPECT_EQ(plan.acts[1].seconds, 2.0);
  EXPECT_EQ(plan.acts[3].seconds, 3.0);
  EXPECT_EQ(plan.acts[5].seconds, 4.0);
  for (const SurgeonAct& act : plan.acts) EXPECT_GT(act.time_limit, act.seconds);
}

TEST_F(Verbs, DecisionsAreToldFromMotions) {
  plan.HoldOn(Place::AtNode(1));
  plan.Take(ToolKind::kHook);
  plan.Wait(1.0);
  EXPECT_TRUE(plan.acts[0].IsDecision());
  EXPECT_EQ(plan.acts[0].count, kHoldTries);
  EXPECT_TRUE(plan.acts[1].IsDecision());
  EXPECT_FALSE(plan.acts[2].IsDecision());
}

}  // namespace
}  // namespace trocar::agent
