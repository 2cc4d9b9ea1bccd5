// SPDX-License-Identifier: Apache-2.0
// What is left of a made-up patient's fibres, and what is known of the patient before.
#include "seen_fibres.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "made_up_patient.h"

namespace trocar::agent {

namespace {

using testing::ElementsAre;

struct Tissue : public testing::Test, protected MadeUpPatient {};

TEST_F(Tissue, OfTheBedIsOrderedFromTheNeckOrFromTheFundus) {
  EXPECT_NEAR(known.AlongBed(known.fundus), 0.080, 1e-12);
  EXPECT_EQ(known.BedStrands(1.0).size(), 9u);
  EXPECT_THAT(known.BedStrands(0.25), ElementsAre(0u, 1u, 2u));
  const auto order = known.BedOrder({2, 5}), from_fundus = known.BedOrder({2, 5}, true);
  EXPECT_LT(order[0], order[1]);
  EXPECT_GT(from_fundus[0], from_fundus[1]);
}

TEST_F(Tissue, PeelsOffWhereTheFirstFibreIsLeft) {
  const auto bed = known.BedStrands(1.0);
  EXPECT_THAT(FindPeelStrands(View(), bed), ElementsAre(0u));
  EXPECT_THAT(FindPeelStrands(View(), bed, true), ElementsAre(8u));
  PartBed(5);
  EXPECT_THAT(FindPeelStrands(View(), bed), ElementsAre(5u));
  EXPECT_NEAR(ShareLeft(View(), bed), 4.0 / 9, 1e-12);
  EXPECT_FALSE(HangsFree(View()));
  PartBed(9);
  EXPECT_TRUE(HangsFree(View()));
}

TEST_F(Tissue, CoversTheTubesUntilItIsParted) {
  EXPECT_FALSE(AreTubesBare(View()));
  const auto covering = FindCoveringStrands(View());
  EXPECT_FALSE(covering.empty());
  EXPECT_LT(covering.size(), known.window_strands.size()) << "only next to the gallbladder";
  for (const std::uint32_t strand : covering) seen.operation.strand_is_intact[strand] = 0;
  EXPECT_TRUE(AreTubesBare(View()));
  EXPECT_FALSE(IsTriangleClear(View())) << "fat is left elsewhere";
  PartTriangle();
  EXPECT_TRUE(IsTriangleClear(View()));
}

TEST_F(Tissue, IsGuardedWhereAVesselThatIsWholeEnters) {
  EXPECT_EQ(FindWholeEntries(View()).size(), 2u);
  DivideTube(0);
  const auto entries = FindWholeEntries(View());
  ASSERT_EQ(entries.size(), 1u);
  EXPECT_EQ(entries[0].start.y, 0.010) << "of the artery";
}

TEST_F(Tissue, ClipsAreCountedOnTheVesselThatTheyLieOn) {
  AddClip({-0.012, 0.0003, 0.004});
  AddClip({-0.004, 0, 0.004});
  AddClip({-0.020, 0.0097, 0.004});
  const SurgeonView view = View();
  const auto clips = view.FindClips(view.Lines());
  ASSERT_EQ(clips[0].size(), 2u);
  EXPECT_NEAR(clips[0][0], 0.004, 1e-9);
  EXPECT_NEAR(clips[0][1], 0.012, 1e-9);
  EXPECT_EQ(clips[1].size(), 1u);
  seen.operation.clips[0].is_lost = true;
  EXPECT_EQ(View().FindClips(View().Lines())[0].size(), 1u);
}

TEST_F(Tissue, TubesRunFromTheGallbladderOn) {
  EXPECT_LT(math::Distance(View().TubePoint(0, 0.0), {0, 0, 0.004}), 1e-12);
  EXPECT_LT(math::Distance(View().TubePoint(0, 0.5), {-0.016, 0, 0.004}), 1e-12);
  EXPECT_NEAR(View().TubeDirection(0, 0.5).x, -1.0, 1e-12);
  EXPECT_FALSE(View().IsDivided(0));
  DivideTube(0);
  EXPECT_TRUE(View().IsDivided(0));
  EXPECT_FALSE(View().IsDivided(1));
}

}  // namespace
}  // namespace trocar::agent
