// SPDX-License-Identifier: Apache-2.0
// Clips that slip off the stump of a divided vessel, and those that must not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "operation/operated_anatomy.h"
#include "operation_harness.h"
#include "trocar/cholecystectomy/vessel_judgement.h"
#include "trocar/scene/patient_vessels.h"

namespace trocar::simulation {

using math::Vec3;

namespace {

using surgery::Fluid;

class ClipSlipTest : public OperationHarness {
 protected:
  void SetUp() override {
    state_ = tissue::MakeRestState(model_);
    conserved_ = conservation_->MakeState(state_);
    const auto& patient = OperationScene()->patient;
    auto made = scene::MakePatientVessels(patient);
    ASSERT_TRUE(made.ok()) << made.error().Text();
    anatomy_ = std::move(made->anatomy);
    vessels_.emplace(MakeVessels(std::move(made->map), patient, Tissue(), Operation::kSpare.tubes));
    vessels_->ReserveFor(change_);
  }

  std::uint32_t FindTube(const char* name) const {
    const auto& tubes = OperationScene()->patient.tubes;
    return static_cast<std::uint32_t>(
        std::find_if(tubes.begin(), tubes.end(), [name](const auto& tube) { return tube.name == name; }) -
        tubes.begin());
  }
  double LengthOf(std::uint32_t tube) const { return vessels_->Map().arcs[tube].back(); }

  /// Edge of the graph around an arc.
  surgery::Vessels::Caught At(std::uint32_t tube, double arc) const {
    const auto& graph = vessels_->Tubes().Graph();
    for (const geometry::Edge& edge : graph.edges) {
      if (vessels_->TubeOf(edge[0]) != tube) continue;
      const double a = vessels_->ArcOf(edge[0]), b = vessels_->ArcOf(edge[1]);
      if (arc < a || arc > b) continue;
      return {edge[0], edge[1], (arc - a) / (b - a), 0.5, graph.radii[edge[0]]};
    }
    ADD_FAILURE() << "no edge at " << arc;
    return {};
  }
  Vec3 PointAt(const surgery::Vessels::Caught& at) const {
    return math::Lerp(state_.position[vessels_->Tubes().Node(at.a)],
                      state_.position[vessels_->Tubes().Node(at.b)], at.t);
  }

  /// \param closure  share of the vessel between the legs, 0 to 1
  surgery::ClipResult Clip(std::uint32_t tube, double share, double closure = 1.0) {
    const instrument::Tool& applier = *instrument::FindTool("clip_applier");
    surgery::Vessels::Caught caught = At(tube, share * LengthOf(tube));
    const double half = 0.5 * M_PI * caught.radius / applier.jaw_length;
    if (closure < 1.0) caught.jaw_at = 1.0 + half * (1.0 - 2.0 * closure);
    const Vec3 along =
        math::AnyPerpendicular(math::Normalized(state_.position[vessels_->Tubes().Node(caught.b)] -
                                                state_.position[vessels_->Tubes().Node(caught.a)]));
    // tool frame: +z back along the shaft, jaws from the hinge to the tip at the origin
    const math::Pose X{math::RotationBetween({0, 0, -1}, along),
                       PointAt(caught) + (1.0 - std::min(1.0, caught.jaw_at)) * applier.jaw_length * along};
    return vessels_->Clip(applier, X, caught, state_.position);
  }

  void Cut(std::uint32_t tube, double share) {
    const surgery::Vessels::Caught at = At(tube, share * LengthOf(tube));
    const Vec3 p = PointAt(at);
    const Vec3 axis = math::Normalized(state_.position[vessels_->Tubes().Node(at.b)] -
                                       state_.position[vessels_->Tubes().Node(at.a)]);
    const Vec3 edge = math::AnyPerpendicular(axis), way = math::Cross(axis, edge);
    const auto blade = [&](double s) {
      return geometry::BladeEdge{p - 0.0012 * edge + s * way, p + 0.0012 * edge + s * way};
    };
    std::array<surgery::TubePlace, surgery::CuttableTubes::kMostCuts> places;
    ASSERT_EQ(
        vessels_->Cut({blade(-0.0012), blade(0.0012)}, Tissue().definition, state_.position, change_, places),
        1u);
    for (const surgery::NodeChange& node : change_.nodes) {
      if (node.is_new) state_.position[node.node] = node.position;
    }
    change_.Clear();
  }

  struct After {
    std::size_t slipped = 0;
    double blood = 0, bile = 0;  // that still run [m^3/s]
  };
  After Wait(double seconds, std::span<const surgery::ClipPull> pulls = {}) {
    After after;
    std::array<surgery::SlippedClip, 4> slipped;
    for (double t = 0; t < seconds; t += kTick) {
      vessels_->Flow(kTick, gallbladder_, conserved_, ledger_);
      after.slipped += vessels_->Slip(kTick, pulls, state_.position, slipped);
    }
    vessels_->Flow(kTick, gallbladder_, conserved_, ledger_);
    after.blood = vessels_->Report().rate[static_cast<std::size_t>(Fluid::kBlood)];
    after.bile = vessels_->Report().rate[static_cast<std::size_t>(Fluid::kBile)];
    return after;
  }

  scene::VesselAnatomy anatomy_;
  std::optional<surgery::Vessels> vessels_;
  surgery::TopologyChange change_;
  surgery::FluidLedger ledger_;
};

TEST_F(ClipSlipTest, GoodClipsStayForTheWholeOperation) {
  for (const char* name : {"cystic_artery", "cystic_duct"}) {
    const std::uint32_t tube = FindTube(name);
    for (const double share : {0.3, 0.4, 0.8})
      EXPECT_EQ(Clip(tube, share).kind, surgery::ClipResult::Kind::kClosed);
    Cut(tube, 0.6);
  }
  const After after = Wait(600.0);
  EXPECT_EQ(after.slipped, 0u);
  EXPECT_LT(after.blood, 0.02e-6) << "the far side is fed by the gallbladder's wall alone";
  EXPECT_EQ(vessels_->Acts().clips.size(), 6u);
}

// A hole beyond the clips that stay opens nothing that still flows, as where a stump is coagulated.
TEST_F(ClipSlipTest, AHoleCountsAsUnclippedOnlyWhereNoClipHoldsTheSideThatStays) {
  const auto counts = [this](std::uint32_t tube, double share) {
    const auto at = cholecystectomy::JudgePlace(anatomy_, *vessels_, {tube, share * LengthOf(tube)});
    return at.may_be_divided && at.staying_clips == 0;
  };
  for (const char* name : {"cystic_artery", "cystic_duct"}) {
    const std::uint32_t tube = FindTube(name);
    EXPECT_TRUE(counts(tube, 0.2) && counts(tube, 0.7)) << name << " without clips";
    EXPECT_EQ(Clip(tube, 0.4).kind, surgery::ClipResult::Kind::kClosed);
    EXPECT_NE(counts(tube, 0.2), counts(tube, 0.7)) << name << ": on one side of the clip it still flows";
  }
  EXPECT_FALSE(counts(FindTube("cystic_artery"), 0.7)) << "the gallbladder's side";
}

TEST_F(ClipSlipTest, APartialClipSlipsOffAnArteryThatThenBleeds) {
  const std::uint32_t artery = FindTube("cystic_artery");
  EXPECT_EQ(Clip(artery, 0.4, 0.7).kind, surgery::ClipResult::Kind::kPartial);
  Wait(5.0);
  EXPECT_NEAR(vessels_->Acts().clips[0].closure, 0.7, 1e-9)
      << "a vessel that is whole has no end to slip off";
  Cut(artery, 0.6);
  const double before = vessels_->Acts().clips[0].position;
  const After soon = Wait(1.0);
  EXPECT_EQ(soon.slipped, 0u);
  EXPECT_GT(vessels_->Acts().clips[0].position, before) << "it slides towards the cut";
  const After after = Wait(60.0);
  EXPECT_EQ(after.slipped, 1u);
  EXPECT_GT(after.blood, 1e-6);
  EXPECT_GT(after.blood, soon.blood);
  EXPECT_EQ(vessels_->Acts().clips[0].closure, 0.0);
  std::array<surgery::ClipSnapshot, 4> clips;
  ASSERT_EQ(vessels_->PublishClips(state_.position, clips), 1u);
  EXPECT_TRUE(clips[0].is_lost);
  EXPECT_FALSE(clips[0].IsGood());
}

TEST_F(ClipSlipTest, CrossedClipsSlipOffTogether) {
  const std::uint32_t artery = FindTube("cystic_artery");
  EXPECT_FALSE(Clip(artery, 0.40).is_crossed);
  EXPECT_TRUE(Clip(artery, 0.43).is_crossed);
  Cut(artery, 0.6);
  EXPECT_LT(Wait(kTick).blood, 0.1e-6) << "still closed";
  const After after = Wait(60.0);
  EXPECT_EQ(after.slipped, 2u);
  EXPECT_GT(after.blood, 1e-6);
}

TEST_F(ClipSlipTest, AGoodClipHoldsBackAWeakOne) {
  const std::uint32_t artery = FindTube("cystic_artery");
  Clip(artery, 0.3, 0.7);
  Clip(artery, 0.45);
  Cut(artery, 0.6);
  const After after = Wait(120.0);
  EXPECT_EQ(after.slipped, 0u);
  EXPECT_LT(after.blood, 0.02e-6);
  EXPECT_LT(vessels_->Acts().clips[0].position, vessels_->Acts().clips[1].position) << "it does not pass";
}

TEST_F(ClipSlipTest, APullOfFiveNewtonTakesOffWhatFourLeave) {
  const std::uint32_t duct = FindTube("cystic_duct");
  Clip(duct, 0.4);
  Cut(duct, 0.6);
  const surgery::Vessels::Caught at = At(duct, 0.57 * LengthOf(duct));  // between clip and cut
  const std::array<std::uint32_t, 2> held{vessels_->Tubes().Node(at.a), vessels_->Tubes().Node(at.b)};
  const Vec3 off = math::Normalized(state_.position[held[1]] - state_.position[held[0]]);
  for (const double pull : {4.0, -8.0}) {
    const surgery::ClipPull hand{held, pull * off};
    EXPECT_EQ(Wait(30.0, {&hand, 1}).slipped, 0u) << pull;
  }
  const surgery::ClipPull aside{held, 8.0 * math::AnyPerpendicular(off)};
  EXPECT_EQ(Wait(30.0, {&aside, 1}).slipped, 0u) << "not along the vessel";
  std::size_t slipped = 0;
  for (int i = 0; i < 60 && slipped == 0; ++i) {
    const surgery::ClipPull hand{held, 8.0 * off};
    slipped = Wait(1.0, {&hand, 1}).slipped;
  }
  EXPECT_EQ(slipped, 1u);
}

TEST_F(ClipSlipTest, IsTheSameAgain) {
  const auto run = [&] {
    SetUp();
    Clip(FindTube("cystic_artery"), 0.4, 0.7);
    Cut(FindTube("cystic_artery"), 0.6);
    ledger_ = {};
    Wait(10.0);
    base::StateHash hash;
    base::AddStateTo(hash, *vessels_);
    return hash.Value();
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace trocar::simulation
