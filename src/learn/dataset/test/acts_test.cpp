// SPDX-License-Identifier: Apache-2.0
#include "acts.h"

#include <gtest/gtest.h>

namespace trocar::dataset {
namespace {

using instrument::kRight;
using instrument::ToolKind;
using surgery::FactKind;

class ActWatchTest : public testing::Test {
 protected:
  ActWatchTest() {
    scene_.patient.organs.resize(2);
    surfaces_.resize(2);
    for (scene::SurfaceInfo& organ : surfaces_) organ.triangles.resize(1);
    surfaces_[0].look = "liver";
    surfaces_[0].organ = roles::OrganRole::kLiver;
    surfaces_[1].look = "gallbladder";
    surfaces_[1].organ = roles::OrganRole::kGallbladder;
    strands_.resize(2);
    strands_[1].kind = roles::StrandRole::kTriangle;
    now_.facts.resize(8);
  }
  void Hold(ToolKind kind) {
    scene_.instruments[kRight].tray.resize(1);
    scene_.instruments[kRight].tray[0].kind = kind;
  }
  void Add(FactKind kind, std::int32_t surface, std::int32_t strand = -1, bool is_coagulating = false) {
    surgery::Fact& fact = now_.facts.at(now_.fact_count++);
    fact = {};
    fact.kind = kind;
    fact.hand = kRight;
    fact.tool = scene_.instruments[kRight].tray[0].kind;
    fact.surface = surface;
    fact.strand = strand;
    fact.is_coagulating = is_coagulating;
  }
  /// The right hand's act after another tick.
  std::string Look() {
    if (!watch_) watch_.emplace(scene_, surfaces_, strands_);
    watch_->Look(now_);
    now_.fact_count = 0;
    now_.time += 1.0 / 120;
    for (const Act& act : watch_->Acts()) {
      if (act.hand == kRight) return NameOf(act.triplet);
    }
    return "";
  }

  scene::Scene scene_;
  std::vector<scene::SurfaceInfo> surfaces_;
  std::vector<scene::StrandInfo> strands_;
  simulation::Snapshot now_;
  std::optional<ActWatch> watch_;
};

TEST_F(ActWatchTest, CurrentIsNamedByWhatMostOfItGoesInto) {
  Hold(ToolKind::kHook);
  EXPECT_EQ(Look(), "hook,null_verb,null_target");
  Add(FactKind::kCurrentInto, 1);
  Add(FactKind::kCurrentInto, -1, 0);
  Add(FactKind::kCurrentInto, -1, 0);
  EXPECT_EQ(Look(), "hook,dissect,cystic_plate");
  Add(FactKind::kCurrentInto, 0, -1, true);
  EXPECT_EQ(Look(), "hook,coagulate,liver");
  EXPECT_EQ(Look(), "hook,null_verb,null_target");
}

TEST_F(ActWatchTest, ACutIsSeenForAMoment) {
  Hold(ToolKind::kScissors);
  Add(FactKind::kStrandCut, -1, 1);
  EXPECT_EQ(Look(), "scissors,cut,cystic_pedicle");
  now_.time += 0.5;
  EXPECT_EQ(Look(), "scissors,cut,cystic_pedicle");
  now_.time += 0.6;
  EXPECT_EQ(Look(), "scissors,null_verb,null_target");
}

// issue 47: it was labelled as nothing, and its fat as omentum
TEST_F(ActWatchTest, SpreadingTheTriangleDissectsThePedicle) {
  Hold(ToolKind::kDissector);
  EXPECT_EQ(Look(), "bipolar,null_verb,null_target");
  Add(FactKind::kStrandSpread, -1, 1);
  EXPECT_EQ(Look(), "bipolar,dissect,cystic_pedicle");
  now_.time += 1.1;
  EXPECT_EQ(Look(), "bipolar,null_verb,null_target");
}

TEST_F(ActWatchTest, AnIrrigatorDoesWhatItsFactsSay) {
  Hold(ToolKind::kSuctionIrrigator);
  Add(FactKind::kRinse, -1);
  EXPECT_EQ(Look(), "irrigator,irrigate,abdominal_wall_cavity");
  now_.instruments[kRight].organ = 0;
  Add(FactKind::kRinse, -1);
  EXPECT_EQ(Look(), "irrigator,irrigate,liver");
  Add(FactKind::kAspirate, -1);
  EXPECT_EQ(Look(), "irrigator,aspirate,fluid");
  EXPECT_EQ(Look(), "irrigator,null_verb,null_target");
}

TEST_F(ActWatchTest, JawsGraspRetractAndPack) {
  Hold(ToolKind::kGrasper);
  now_.instruments[kRight].is_grasping = true;
  now_.instruments[kRight].organ = 1;
  EXPECT_EQ(Look(), "grasper,grasp,gallbladder");
  now_.instruments[kRight].force = {0, 0, 1};
  EXPECT_EQ(Look(), "grasper,retract,gallbladder");
  Add(FactKind::kBagOpen, -1);
  now_.facts[0].hand = instrument::kLeft;
  EXPECT_EQ(Look(), "grasper,pack,gallbladder");
}

TEST_F(ActWatchTest, ABagIsNoInstrument) {
  Hold(ToolKind::kBag);
  EXPECT_EQ(Look(), "");
}

}  // namespace
}  // namespace trocar::dataset
