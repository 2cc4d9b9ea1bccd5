// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/hand_acts.h"

#include <gtest/gtest.h>

namespace trocar::cholecystectomy {
namespace {

using instrument::ToolKind;
using surgery::FactKind;

const TargetTable kTargets{{Target::kLiver, Target::kGallbladder, Target::kCysticDuct},
                           {Target::kCysticPlate}};

surgery::Fact MakeFact(FactKind kind, ToolKind tool, std::int32_t surface, std::int32_t strand = -1) {
  surgery::Fact fact;
  fact.kind = kind;
  fact.tool = tool;
  fact.surface = surface;
  fact.strand = strand;
  return fact;
}

TEST(TripletOf, NamesInstrumentVerbAndTarget) {
  const auto name = [](const surgery::Fact& fact) {
    const auto triplet = TripletOf(fact, kTargets);
    return triplet ? NameOf(*triplet) : std::string();
  };
  EXPECT_EQ(name(MakeFact(FactKind::kTubeCut, ToolKind::kScissors, 2)), "scissors,cut,cystic_duct");
  EXPECT_EQ(name(MakeFact(FactKind::kOrganCut, ToolKind::kHook, 1)), "hook,cut,gallbladder");
  EXPECT_EQ(name(MakeFact(FactKind::kStrandCut, ToolKind::kScissors, -1, 0)), "scissors,cut,cystic_plate");
  EXPECT_EQ(name(MakeFact(FactKind::kStrandSpread, ToolKind::kDissector, -1, 0)),
            "bipolar,dissect,cystic_plate");
  EXPECT_EQ(name(MakeFact(FactKind::kCurrentInto, ToolKind::kHook, -1, 0)), "hook,dissect,cystic_plate");
  // a fibre that heat parts is dissected, whichever pedal is down; a wall is coagulated with the blue one
  surgery::Fact current = MakeFact(FactKind::kCurrentInto, ToolKind::kHook, 0);
  EXPECT_EQ(name(current), "hook,dissect,liver");
  current.is_coagulating = true;
  EXPECT_EQ(name(current), "hook,coagulate,liver");
  current.strand = 0;
  EXPECT_EQ(name(current), "hook,dissect,cystic_plate");
  current.tool = ToolKind::kDissector;
  EXPECT_EQ(name(current), "bipolar,coagulate,cystic_plate");
  EXPECT_EQ(name(MakeFact(FactKind::kClipClosed, ToolKind::kClipApplier, 2)), "clipper,clip,cystic_duct");
  EXPECT_EQ(name(MakeFact(FactKind::kRinse, ToolKind::kSuctionIrrigator, -1)),
            "irrigator,irrigate,abdominal_wall_cavity");
  EXPECT_EQ(name(MakeFact(FactKind::kAspirate, ToolKind::kSuctionIrrigator, -1)), "irrigator,aspirate,fluid");
  EXPECT_EQ(name(MakeFact(FactKind::kBagOpen, ToolKind::kBag, -1)), "specimen_bag,pack,gallbladder");
  for (const FactKind kind :
       {FactKind::kGrasp, FactKind::kClipLost, FactKind::kCurrentOn, FactKind::kTubeBurnt})
    EXPECT_EQ(name(MakeFact(kind, ToolKind::kHook, 1)), "") << surgery::FactName(kind);
}

TEST(TargetTable, WhatItDoesNotKnowIsNoTarget) {
  EXPECT_EQ(kTargets.OfSurface(-1), Target::kNullTarget);
  EXPECT_EQ(kTargets.OfSurface(3), Target::kNullTarget);
  EXPECT_EQ(kTargets.Of(MakeFact(FactKind::kStrandCut, ToolKind::kScissors, 1, 7)), Target::kGallbladder);
}

TEST(TripletOfHold, GraspsRetractsAndPacks) {
  const auto name = [](Target held, double pull, bool is_bag_open) {
    return NameOf(TripletOfHold(ToolKind::kGrasper, held, pull, is_bag_open));
  };
  EXPECT_EQ(name(Target::kGallbladder, 0.2, false), "grasper,grasp,gallbladder");
  EXPECT_EQ(name(Target::kGallbladder, 0.4, false), "grasper,retract,gallbladder");
  EXPECT_EQ(name(Target::kGallbladder, 0.4, true), "grasper,pack,gallbladder");
  EXPECT_EQ(name(Target::kLiver, 0.4, true), "grasper,retract,liver");
}

// every strand that dissection divides has a target; the hepatocystic triangle's is the cystic pedicle
TEST(TargetOf, NamesWhatHoldsTheGallbladder) {
  EXPECT_EQ(TargetOf(roles::StrandRole::kTriangle), Target::kCysticPedicle);
  EXPECT_EQ(TargetOf(roles::StrandRole::kEnd), Target::kCysticPedicle);
  EXPECT_EQ(TargetOf(roles::StrandRole::kPeritoneum), Target::kPeritoneum);
  EXPECT_EQ(TargetOf(roles::StrandRole::kBed), Target::kCysticPlate);
  EXPECT_EQ(TargetOf(roles::StrandRole::kAdhesion), Target::kAdhesion);
}

TEST(HandActs, KeepsEachActOnceForEachHand) {
  HandActs acts;
  const Triplet cut{InstrumentKind::kScissors, Verb::kCut, Target::kCysticDuct};
  acts.Add(cut, 0, kMoment);
  acts.Add(cut, 0, kMoment);
  acts.Add(cut, 1, kMoment);
  EXPECT_EQ(acts.Acts().size(), 2u);
  for (int hand = 2; hand < 100; ++hand) acts.Add(cut, hand, kMoment);
  EXPECT_EQ(acts.Acts().size(), HandActs::kCapacity);
}

}  // namespace
}  // namespace trocar::cholecystectomy
