// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/critical_view.h"

#include <gtest/gtest.h>

#include <cmath>

namespace trocar::cholecystectomy {
namespace {

constexpr double kTick = 1.0 / 120;

DissectionFacts MakeWhole() {
  return {0.95, 0.4, 2, {0.012, 0.011}, {0.03, 0.03}, true, -0.4};
}

void Look(CriticalView& view, DissectionFacts facts, double azimuth, double seconds) {
  facts.view_azimuth = azimuth;
  for (int tick = 0; tick < static_cast<int>(std::lround(seconds / kTick)); ++tick) view.Update(facts, kTick);
}

TEST(CriticalView, NeedsAllThreeCriteriaAndBothViews) {
  CriticalView view;
  Look(view, MakeWhole(), -0.4, 1.1);
  EXPECT_EQ(view.Score().Sum(), 6);
  EXPECT_TRUE(view.Score().is_seen_from_front);
  EXPECT_FALSE(view.Score().IsAchieved());
  Look(view, MakeWhole(), 0.4, 0.9);
  EXPECT_FALSE(view.Score().IsAchieved()) << "nine tenths of a second are no second";
  Look(view, MakeWhole(), 0.4, 0.2);
  EXPECT_TRUE(view.Score().IsAchieved());
}

TEST(CriticalView, AViewBetweenFrontAndBackIsNeither) {
  CriticalView view;
  Look(view, MakeWhole(), 0.0, 10);
  EXPECT_FALSE(view.Score().is_seen_from_front || view.Score().is_seen_from_behind);
}

TEST(CriticalView, GradesEachCriterion) {
  struct Case {
    DissectionFacts facts;
    std::array<int, 3> grades;
  };
  const Case cases[] = {{{0.0, 0.0, 5, {}, {}, false, 0}, {0, 0, 0}},
                        {{0.5, 0.2, 2, {0.02, 0.006}, {0.03, 0.03}, false, 0}, {1, 1, 1}},
                        {{0.9, 1.0 / 3, 2, {0.01, 0.01}, {0.03, 0.03}, false, 0}, {2, 2, 2}},
                        {{0.9, 1.0 / 3, 3, {0.02, 0.02, 0.02}, {0.03, 0.03, 0.03}, false, 0}, {2, 2, 0}},
                        {{0.9, 1.0 / 3, 1, {0.02}, {0.03}, false, 0}, {2, 2, 0}},
                        {{NAN, NAN, 2, {NAN, NAN}, {0.03, 0.03}, true, NAN}, {0, 0, 0}}};
  for (const Case& c : cases) {
    CriticalView view;
    view.Update(c.facts, kTick);
    EXPECT_EQ(view.Score().criteria, c.grades);
  }
}

TEST(CriticalView, ForgetsTheViewsWhenACriterionIsLost) {
  CriticalView view;
  Look(view, MakeWhole(), -0.4, 2);
  DissectionFacts lost = MakeWhole();
  lost.structures_entering = 3;
  view.Update(lost, kTick);
  Look(view, MakeWhole(), 0.4, 2);
  EXPECT_FALSE(view.Score().is_seen_from_front);
  EXPECT_FALSE(view.Score().IsAchieved());
}

TEST(CriticalView, CountsOnlyWhatIsInTheMiddleOfThePicture) {
  CriticalView view;
  DissectionFacts hidden = MakeWhole();
  hidden.is_triangle_in_view = false;
  Look(view, hidden, -0.4, 5);
  EXPECT_FALSE(view.Score().is_seen_from_front);
}

// A cystic duct of 11 mm would have to be bared into the hepatic duct otherwise.
TEST(CriticalView, AsksOfAShortDuctOnlyWhatIsExposable) {
  CriticalView view;
  DissectionFacts facts = MakeWhole();
  facts.skeletonised = {0.006, 0.012};
  view.Update(facts, kTick);
  EXPECT_EQ(view.Score().criteria[2], 1);
  facts.exposable = {0.006, 0.03};
  view.Update(facts, kTick);
  EXPECT_EQ(view.Score().criteria[2], 2);
  facts.skeletonised = {0.006, 0.006};
  view.Update(facts, kTick);
  EXPECT_EQ(view.Score().criteria[2], 1) << "the artery is long";
}

TEST(ExplainCriticalView, SaysWhatIsMissingAndNothingWhenAchieved) {
  CriticalView view;
  DissectionFacts facts{0.3, 0.1, 3, {0.01, 0.01, 0.002}, {0.03, 0.03, 0.03}, true, 0};
  view.Update(facts, kTick);
  const auto reasons = ExplainCriticalView(facts, view.Score());
  ASSERT_EQ(reasons.size(), 3u);
  EXPECT_NE(reasons[0].find("70 % of the fat"), std::string::npos);
  EXPECT_NE(reasons[1].find("10 %"), std::string::npos);
  EXPECT_NE(reasons[2].find("3 structures"), std::string::npos);

  facts = MakeWhole();
  facts.skeletonised = {0.012, 0.004};
  view.Update(facts, kTick);
  ASSERT_EQ(ExplainCriticalView(facts, view.Score()).size(), 1u);
  EXPECT_NE(ExplainCriticalView(facts, view.Score())[0].find("4 mm only; 10 mm"), std::string::npos);
  facts.exposable = {0.03, 0.006};
  EXPECT_NE(ExplainCriticalView(facts, view.Score())[0].find("4 mm only; 6 mm"), std::string::npos);

  view.Update(MakeWhole(), kTick);
  EXPECT_EQ(ExplainCriticalView(MakeWhole(), view.Score()).size(), 2u);
  Look(view, MakeWhole(), -0.4, 1.1);
  Look(view, MakeWhole(), 0.4, 1.1);
  EXPECT_TRUE(ExplainCriticalView(MakeWhole(), view.Score()).empty());
}

}  // namespace
}  // namespace trocar::cholecystectomy
