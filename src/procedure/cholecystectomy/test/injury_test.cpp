// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/injury.h"

#include <gtest/gtest.h>

#include <string>

namespace trocar::cholecystectomy {
namespace {

using surgery::FlowNetwork;
using surgery::Fluid;
using surgery::VesselActs;

// junctions: 0 liver, 1 where the cystic duct joins, 2 bowel, 3 gallbladder (bile), 4 aorta, 5 where the cystic
// artery leaves, 6 right liver, 7 gallbladder (blood), 8 a piece of the right lobe
enum Vessel : std::uint32_t {
  kHepatic,
  kBile,
  kCystic,
  kRightArtery,
  kDistalArtery,
  kCysticArtery,
  kAberrant
};

FlowNetwork MakeNetwork() {
  return FlowNetwork::Make({{Fluid::kBile, 0, 1, 0.030, 0.0020},
                            {Fluid::kBile, 1, 2, 0.075, 0.0020},
                            {Fluid::kBile, 3, 1, 0.035, 0.0010},
                            {Fluid::kBlood, 4, 5, 0.020, 0.0015},
                            {Fluid::kBlood, 5, 6, 0.020, 0.0015},
                            {Fluid::kBlood, 5, 7, 0.0208, 0.00095},
                            {Fluid::kBile, 8, 1, 0.030, 0.0010}},
                           {{3000, 5e-12},
                            {0, 0},
                            {1300, 1e-10},
                            {1500, 1e-8},
                            {12e3, 1.25e-10},
                            {0, 0},
                            {500, 1e-10},
                            {500, 1e-12},
                            {3000, 1e-12}})
      .value();
}

scene::VesselAnatomy MakeAnatomy() {
  scene::VesselAnatomy anatomy;
  anatomy.roles = {VesselRole::kCommonHepaticDuct,  VesselRole::kCommonBileDuct,
                   VesselRole::kCysticDuct,         VesselRole::kRightHepaticArtery,
                   VesselRole::kRightHepaticArtery, VesselRole::kCysticArtery,
                   VesselRole::kAberrantRightDuct};
  anatomy.below_source = {0, 0.030, 0, 0, 0, 0, 0};
  anatomy.is_upstream_from = std::vector<bool>(7, true);
  anatomy.liver = 0, anatomy.bowel = 2, anatomy.aorta = 4, anatomy.right_liver = 6;
  anatomy.hollow_organ = {3, 7};
  return anatomy;
}

InjuryReport Judge(const VesselActs& acts) {
  FlowNetwork network = MakeNetwork();
  return JudgeInjuries(MakeAnatomy(), acts, network);
}

/// Two clips on the patient's side, one on the gallbladder's, cut between: duct and artery.
VesselActs MakeGoodActs() {
  VesselActs acts;
  for (const double position : {0.026, 0.022, 0.014}) acts.clips.push_back({kCystic, position, 1});
  acts.openings.push_back({kCystic, 0.018, true, 0, {}});
  for (const double position : {0.005, 0.008, 0.014}) acts.clips.push_back({kCysticArtery, position, 1});
  acts.openings.push_back({kCysticArtery, 0.011, true, 0, {}});
  return acts;
}

TEST(JudgeInjuries, FindsNoneBeforeAnythingAndAfterAGoodOperation) {
  const InjuryReport before = Judge({});
  EXPECT_EQ(before.strasberg, Strasberg::kNone);
  EXPECT_EQ(before.structures_entering, 2);
  EXPECT_FALSE(before.drains_no_bile);
  const InjuryReport after = Judge(MakeGoodActs());
  EXPECT_EQ(StrasbergName(after.strasberg), "none");
  EXPECT_EQ(after.structures_entering, 0);
  EXPECT_EQ(after.bile_rate, 0);
  EXPECT_EQ(after.blood_rate, 0);
  EXPECT_FALSE(after.drains_no_bile);
  EXPECT_FALSE(after.is_right_liver_without_blood);
  EXPECT_TRUE(after.wrong_vessels.empty());
  EXPECT_FALSE(after.IsCritical());
}

TEST(JudgeInjuries, AStumpWithoutTightClipsLeaks) {
  VesselActs acts = MakeGoodActs();
  acts.clips[0].closure = acts.clips[1].closure = 0.7;
  const InjuryReport report = Judge(acts);
  EXPECT_EQ(StrasbergName(report.strasberg), "A");
  EXPECT_GT(report.bile_rate, 0);
  EXPECT_FALSE(report.IsCritical());
}

TEST(JudgeInjuries, AnUnclippedArteryBleeds) {
  VesselActs acts = MakeGoodActs();
  std::erase_if(acts.clips, [](const auto& clip) { return clip.vessel == kCysticArtery; });
  EXPECT_GT(Judge(acts).blood_rate, 0.5e-6);
}

TEST(JudgeInjuries, NamesDivisionsOfTheMainDuctByTheirPlace) {
  struct Case {
    std::uint32_t vessel;
    double position;
    const char* name;
  };
  for (const Case& c :
       {Case{kBile, 0.02, "E1"}, {kHepatic, 0.025, "E1"}, {kHepatic, 0.010, "E2"}, {kHepatic, 0.001, "E3"}}) {
    VesselActs clipped, cut;
    clipped.clips.push_back({c.vessel, c.position, 1});
    cut.openings.push_back({c.vessel, c.position, true, 0, {}});
    for (const VesselActs* acts : {&clipped, &cut}) {
      const InjuryReport report = Judge(*acts);
      EXPECT_EQ(StrasbergName(report.strasberg), c.name) << c.vessel << " " << c.position;
      EXPECT_TRUE(report.drains_no_bile);
      EXPECT_TRUE(report.IsCritical());
      ASSERT_EQ(report.wrong_vessels.size(), 1u);
      EXPECT_EQ(report.wrong_vessels[0], c.vessel);
    }
  }
}

TEST(JudgeInjuries, MeasuresFromTheConfluenceWhicheverWayTheVesselRuns) {
  FlowNetwork network = MakeNetwork();
  scene::VesselAnatomy anatomy = MakeAnatomy();
  anatomy.is_upstream_from[kHepatic] = false;
  VesselActs acts;
  acts.clips.push_back({kHepatic, 0.025, 1});  // now 5 mm below the confluence
  EXPECT_EQ(JudgeInjuries(anatomy, acts, network).strasberg, Strasberg::kE2);
}

TEST(JudgeInjuries, TellsAHoleFromADivision) {
  VesselActs acts;
  acts.openings.push_back({kBile, 0.02, false, 1e-6, {}});
  const InjuryReport report = Judge(acts);
  EXPECT_EQ(StrasbergName(report.strasberg), "D");
  EXPECT_FALSE(report.drains_no_bile);
  EXPECT_GT(report.bile_rate, 0);
}

TEST(JudgeInjuries, KnowsTheAberrantDuct) {
  VesselActs acts;
  acts.clips.push_back({kAberrant, 0.01, 1});
  EXPECT_EQ(StrasbergName(Judge(acts).strasberg), "B");
  acts.clips.clear();
  acts.openings.push_back({kAberrant, 0.01, true, 0, {}});
  EXPECT_EQ(StrasbergName(Judge(acts).strasberg), "C");
  acts.openings.push_back({kBile, 0.01, true, 0, {}});
  EXPECT_EQ(StrasbergName(Judge(acts).strasberg), "E5");
}

TEST(JudgeInjuries, SeesARightLobeWithoutBlood) {
  VesselActs acts;
  acts.clips.push_back({kDistalArtery, 0.01, 1});
  const InjuryReport report = Judge(acts);
  EXPECT_TRUE(report.is_right_liver_without_blood);
  EXPECT_TRUE(report.IsCritical());
  EXPECT_EQ(report.strasberg, Strasberg::kNone);
}

TEST(JudgeInjuries, CountsWhatStillEntersTheGallbladder) {
  VesselActs acts = MakeGoodActs();
  acts.openings.pop_back();
  EXPECT_EQ(Judge(acts).structures_entering, 1);
}

}  // namespace
}  // namespace trocar::cholecystectomy
