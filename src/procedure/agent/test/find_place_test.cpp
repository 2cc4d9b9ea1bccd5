// SPDX-License-Identifier: Apache-2.0
// Places of a plan on a made-up patient.
#include "find_place.h"

#include <gtest/gtest.h>

#include "made_up_patient.h"
#include "tool_alignment.h"
#include "trocar/instrument/camera.h"

namespace trocar::agent {

using instrument::kLeft;
using instrument::kRight;
using math::Vec3;

namespace {

struct Places : public testing::Test, protected MadeUpPatient {
  Vec3 Find(const Place& place) { return FindPlace(View(), place, {memory.aim, memory.camera.field}); }
};

TEST_F(Places, FollowTheTissue) {
  EXPECT_EQ(math::Distance(Find(Place::AtNode(4)), known.rest[4]), 0.0);
  seen.positions[4] += Vec3{0, 0, 0.01};
  EXPECT_NEAR(math::Distance(Find(Place::AtNode(4)), known.rest[4]), 0.01, 1e-15);
  EXPECT_LT(math::Distance(Find(Place::MiddleOf({0, 2})), {0.010, 0, 0.004}), 1e-12);
  EXPECT_LT(math::Distance(Find(Place::OnTube(0, 0.5)), {-0.016, 0, 0.004}), 1e-12);
}

TEST_F(Places, LieBeforeOrBeyondAsSeenFromTheHandsTrocar) {
  Place before = Place::AtNode(4);
  before.hand = kLeft;
  before.back = 0.015;
  const Vec3 port = memory.Hand(kLeft).Port();
  EXPECT_NEAR(math::Distance(Find(before), port), math::Distance(known.rest[4], port) - 0.015, 1e-12);
  const Vec3 beyond = Find(Place::Aim(0, 0.5, -0.010)), right = memory.Hand(kRight).Port();
  EXPECT_GT(math::Distance(beyond, right), math::Distance(Find(Place::OnTube(0, 0.5)), right));
}

TEST_F(Places, BetweenJawsGoThereWithTheAimsOffset) {
  memory.aim.beyond = 0.25;
  const Place between = Place::BetweenJaws(0, 0.016, 0.020);
  const Vec3 tip = Find(between), vessel{-0.016, 0, 0.004};
  EXPECT_NEAR(math::Distance(tip, vessel), 0.005, 1e-12);
  memory.aim.offset = {0.001, 0, 0};
  EXPECT_LT(math::Distance(Find(between), tip + Vec3{0.001, 0, 0}), 1e-12);
}

TEST_F(Places, ForTheHookPutTheMiddleOfItsToeThere) {
  const Vec3 tip = Find(Place::AtNode(4).ForHook());
  const double toe = math::Distance(instrument::kHookToe.a, instrument::kHookToe.b);
  EXPECT_NEAR(math::Distance(tip, known.rest[4]), 0.5 * toe, 1e-12);
}

TEST_F(Places, OverTheFieldAreInThePicture) {
  seen.X_world_laparoscope.translation = {0, 0, 0.10};
  memory.camera.field = Place::AtNode(0);
  const Vec3 p = Find(Place::Of(Place::Kind::kOverField));
  EXPECT_TRUE(instrument::IsInView(seen.X_world_laparoscope, scene.laparoscope.field_of_view, p));
  EXPECT_NEAR(math::Distance(p, known.rest[0]), 0.045, 1e-9);
  // a lens that comes near sees less of the way
  seen.X_world_laparoscope.translation = {0, 0, 0.055};
  EXPECT_LT(math::Distance(Find(Place::Of(Place::Kind::kOverField)), known.rest[0]), 0.044);
}

TEST_F(Places, BesideTheHoldAreWallNearTheLeftHand) {
  memory.hands[kLeft] = HandAt({-0.08, 0, 0.15}, {0.030, 0, 0.004});
  const Vec3 p = Find(Place::Of(Place::Kind::kBesideHold));
  EXPECT_NEAR(math::Distance(p, {0.030, 0, 0.004}), 0.015, 0.006);
  EXPECT_GT(p.x, 0.030) << "towards the right hand";
}

}  // namespace
}  // namespace trocar::agent
