// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/operation_judge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace trocar::cholecystectomy {
namespace {

using instrument::ToolKind;
using surgery::Fact;
using surgery::FactKind;
using testing::ElementsAre;
using testing::IsEmpty;

// surfaces: liver, gallbladder, then the hepatic duct and the cystic duct
enum Surface { kLiver, kGallbladder, kHepaticDuct, kCysticDuct };

class OperationJudgeTest : public testing::Test {
 protected:
  OperationJudgeTest() {
    // junctions: liver, where the cystic duct joins, gallbladder
    surgery::VesselMap map{surgery::FlowNetwork::Make({{surgery::Fluid::kBile, 0, 1, 0.03, 0.002},
                                                       {surgery::Fluid::kBile, 2, 1, 0.035, 0.001}},
                                                      {{3000, 5e-12}, {0, 0}, {1300, 1e-10}})
                               .value(),
                           {{0, 0.03}, {0, 0.035}},
                           {{0}, {1}},
                           {{0}, {0}},
                           {2}};
    const std::vector<math::Vec3> hepatic = {{0, 0, 0}, {0, 0.03, 0}}, cystic = {{0.035, 0, 0}, {0, 0, 0}};
    const std::vector<double> radii = {0.002, 0.002};
    const std::vector<surgery::VesselTube> tubes = {{0, hepatic, radii}, {2, cystic, radii}};
    vessels_.emplace(std::move(map), tubes, 4, 8);
    tissue_.position = {hepatic[0], hepatic[1], cystic[0], cystic[1]};
    anatomy_.targets.surfaces = {Target::kLiver, Target::kGallbladder, Target::kBloodVessel,
                                 Target::kCysticDuct};
    anatomy_.biliary.roles = {VesselRole::kCommonHepaticDuct, VesselRole::kCysticDuct};
    anatomy_.biliary.hollow_organ = {2};
    anatomy_.main_ducts = {0, 1};
    anatomy_.organ_count = 2;
    anatomy_.has_critical_view = true;
  }

  static Fact MakeFact(FactKind kind, int surface = -1, double amount = 0) {
    Fact fact;
    fact.kind = kind;
    fact.hand = instrument::kRight;
    fact.surface = surface;
    fact.amount = amount;
    fact.position = {0.5, 0, -0.1};
    return fact;
  }

  /// Errors of one tick with these facts.
  std::vector<OperationError> Judge(const std::vector<Fact>& facts) {
    OperationJudge judge(anatomy_, DissectionMonitor{});
    judge.SeeTools({1.0, 1.0 / 120, facts, {}, tissue_, *vessels_, {}, camera_, {}, 0, 0, {}});
    std::vector<OperationError> errors;
    for (const surgery::ErrorEntry& entry : judge.NewErrors())
      errors.push_back(static_cast<OperationError>(entry.error.row));
    return errors;
  }

  JudgedAnatomy anatomy_;
  std::optional<surgery::Vessels> vessels_;
  tissue::TissueState tissue_;
  instrument::Camera camera_{{{}, {0.5, 0, 0}}, 1.3};  // looks down on what MakeFact does
};

TEST_F(OperationJudgeTest, AFactIsAnErrorWhereItIsDoneToTheWrongThing) {
  EXPECT_THAT(Judge({MakeFact(FactKind::kOrganCut, kLiver)}), ElementsAre(OperationError::kStructureTorn));
  EXPECT_THAT(Judge({MakeFact(FactKind::kOrganCut, kGallbladder)}), IsEmpty()) << "not before it is open";
  EXPECT_THAT(Judge({MakeFact(FactKind::kOrganOpened, kGallbladder, 1e-6)}),
              ElementsAre(OperationError::kGallbladderPerforated));
  EXPECT_THAT(Judge({MakeFact(FactKind::kOrganBurnt, kLiver)}), ElementsAre(OperationError::kLiverBurnt));
  EXPECT_THAT(Judge({MakeFact(FactKind::kOrganBurnt, kGallbladder)}),
              ElementsAre(OperationError::kGallbladderPerforated));
  anatomy_.may_cut_organs = true;
  EXPECT_THAT(Judge({MakeFact(FactKind::kOrganCut, kLiver)}), IsEmpty()) << "a sheet is there to be cut";
}

TEST_F(OperationJudgeTest, OnlyTheCysticDuctIsDivided) {
  EXPECT_THAT(Judge({MakeFact(FactKind::kTubeCut, kHepaticDuct, 1)}),
              ElementsAre(OperationError::kWrongStructureCut));
  EXPECT_THAT(Judge({MakeFact(FactKind::kTubeCut, kCysticDuct, 1)}),
              ElementsAre(OperationError::kUnclippedCut));
  EXPECT_THAT(Judge({MakeFact(FactKind::kTubeCut, kCysticDuct, 2)}), IsEmpty()) << "it is divided already";
  EXPECT_THAT(Judge({MakeFact(FactKind::kTubeBurnt, kHepaticDuct)}),
              ElementsAre(OperationError::kWrongStructureBurnt));
  EXPECT_THAT(Judge({MakeFact(FactKind::kTubeTornOff, kCysticDuct)}),
              ElementsAre(OperationError::kUnclippedCut));
  EXPECT_THAT(Judge({MakeFact(FactKind::kTubeTornOff, kCysticDuct, 1)}), IsEmpty())
      << "only the gallbladder's side came off";
}

TEST_F(OperationJudgeTest, AClipIsJudgedByPlaceTimeAndFit) {
  Fact clip = MakeFact(FactKind::kClipClosed, kCysticDuct);
  EXPECT_THAT(Judge({clip}), ElementsAre(OperationError::kClipBeforeCriticalView));
  anatomy_.has_critical_view = false;
  EXPECT_THAT(Judge({clip}), IsEmpty());
  clip.is_crossed = clip.is_partial = true;
  EXPECT_THAT(Judge({clip}), ElementsAre(OperationError::kClipCrossed, OperationError::kClipPartial));
  EXPECT_THAT(Judge({MakeFact(FactKind::kClipClosed, kHepaticDuct)}),
              ElementsAre(OperationError::kWrongStructureClipped));
  EXPECT_THAT(Judge({MakeFact(FactKind::kClipLost)}), ElementsAre(OperationError::kClipDropped));
  EXPECT_THAT(Judge({MakeFact(FactKind::kClipSlipped, kCysticDuct)}),
              ElementsAre(OperationError::kClipSlipped));
}

TEST_F(OperationJudgeTest, CurrentIsJudgedByViewTouchAndDistance) {
  EXPECT_THAT(Judge({MakeFact(FactKind::kCurrentOn)}), IsEmpty());
  EXPECT_THAT(Judge({MakeFact(FactKind::kCurrentOn, -1, 0.2)}), IsEmpty()) << "no eye would note it";
  EXPECT_THAT(Judge({MakeFact(FactKind::kCurrentOn, -1, 0.3)}),
              ElementsAre(OperationError::kEnergyWithoutContact));
  Fact near = MakeFact(FactKind::kCurrentOn);
  near.position = {0.004, 0, 0};
  EXPECT_THAT(Judge({near}), ElementsAre(OperationError::kEnergyOutOfView, OperationError::kEnergyNearDuct));
  near.amount = 0.1;
  EXPECT_THAT(Judge({near}), ElementsAre(OperationError::kEnergyOutOfView)) << "it touches nothing";
}

TEST_F(OperationJudgeTest, FactsSinceTheToolsAreJudgedOnceAtTheEndOfTheTick) {
  OperationJudge judge(anatomy_, DissectionMonitor{});
  std::vector<Fact> facts = {MakeFact(FactKind::kClipLost)};
  const auto now = [&] {
    return surgery::OperationObservation{1.0, 1.0 / 120, facts, {}, tissue_, *vessels_,
                                         {},  camera_,   {},    0,  0,       {}};
  };
  judge.SeeTools(now());
  facts.push_back(MakeFact(FactKind::kClipSlipped, kCysticDuct));
  judge.Update(now());
  ASSERT_EQ(judge.NewErrors().size(), 2u);
  EXPECT_EQ(judge.NewErrors()[1].error, OperationError::kClipSlipped);
  facts.clear();
  judge.SeeTools(now());
  judge.Update(now());
  EXPECT_THAT(judge.NewErrors(), IsEmpty());
}

// issue 47: what is spread in the triangle is its dissection, from the first fibres on
TEST_F(OperationJudgeTest, FactsOfTheTickSpeakForPhases) {
  anatomy_.targets.strands = {Target::kCysticPedicle, Target::kCysticPlate};
  DissectedAnatomy dissected;
  dissected.bed = {{1, 0.9}};
  tissue_.strand_is_intact = {1, 1};
  OperationJudge judge(anatomy_, DissectionMonitor(std::move(dissected), tissue_.position));
  const auto phase_after = [&](FactKind kind, ToolKind tool, std::int32_t strand) {
    Fact fact = MakeFact(kind);
    fact.tool = tool;
    fact.strand = strand;
    const std::vector<Fact> facts = {fact};
    // a continuous act has to last
    for (int tick = 0; tick < (kind == FactKind::kCurrentInto ? 360 : 2); ++tick)
      judge.Update({1.0, 1.0 / 120, facts, {}, tissue_, *vessels_, {}, camera_, {}, 0, 0, {}});
    return judge.CurrentPhase();
  };
  EXPECT_EQ(judge.CurrentPhase(), Phase::kPreparation);
  EXPECT_EQ(phase_after(FactKind::kStrandSpread, ToolKind::kDissector, 0), Phase::kCalotTriangleDissection);
  EXPECT_EQ(phase_after(FactKind::kCurrentInto, ToolKind::kHook, 1), Phase::kGallbladderDissection)
      << "beyond the middle of the bed";
}

}  // namespace
}  // namespace trocar::cholecystectomy
