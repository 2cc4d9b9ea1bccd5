// SPDX-License-Identifier: Apache-2.0
// A linear stapler closes what it divides; what reaches out of its jaws leaks.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "operation_harness.h"

namespace trocar::simulation {

using instrument::kRight;
using math::Vec3;
using surgery::FactKind;

namespace {

class StaplerTest : public OperationHarness {
 protected:
  void SetUp() override {
    scene_ = *OperationScene();
    auto& tray = scene_.instruments[kRight].tray;
    tray.push_back(*instrument::FindTool("linear_stapler"));
    tray.back().jaw_length = 0.020;  // so that nothing else lies between them
    MakeOperation(scene_);
    input_.controls[kRight].tool = static_cast<std::uint8_t>(tray.size() - 1);
    instrument::TrocarJoints wanted;
    for (int i = 0; i < 80; ++i)
      (void)operation_->MoveTool(kRight, input_.controls[kRight], false, kTick, wanted);
    hands_.joints[kRight].depth = 0.2;
  }
  const instrument::Tool& Stapler() const { return scene_.instruments[kRight].tray.back(); }

  /// Puts the jaws across a line, where nothing else of the ducts and vessels is near.
  /// \param inside  from the line to the tip of the jaws [m]
  void PutAcross(const Vec3& p, const Vec3& axis, double inside) {
    const Vec3 side = math::AnyPerpendicular(axis);
    double best = -1;
    for (int i = 0; i < 24; ++i) {
      const Vec3 along = math::Rotate(math::RotationAbout(axis, i * M_PI / 12), side);
      const Vec3 tip = p + inside * along, middle = tip - 0.5 * Stapler().jaw_length * along;
      double nearest = std::numeric_limits<double>::infinity();
      for (const Vec3& node : state_.position) {
        if (math::Distance(node, p) > 0.008) nearest = std::min(nearest, math::Distance(node, middle));
      }
      if (nearest <= best) continue;
      best = nearest;
      const math::Quaternion turn = math::RotationBetween({0, 0, -1}, along);
      const math::Quaternion spin = math::RotationBetween(math::Rotate(turn, {1, 0, 0}), axis);
      hands_.X_proxy[kRight] = hands_.X_device[kRight] = {spin * turn, tip};
    }
  }
  /// Opens the jaws, closes them, and presses the pedal.
  std::vector<surgery::Fact> Fire() {
    hands_.joints[kRight].jaw = Stapler().max_jaw;
    Act();
    Judge();
    hands_.joints[kRight].jaw = 0;
    Act();
    Judge();
    EXPECT_TRUE(std::none_of(facts_.All().begin(), facts_.All().end(), [](const surgery::Fact& fact) {
      return fact.kind == FactKind::kTubeCut || fact.kind == FactKind::kOrganCut;
    })) << "closed jaws alone divide nothing";
    input_.controls[kRight].cut = true;
    Act();
    for (const surgery::NodeChange& node : operation_->Change().nodes) {
      if (node.is_new) state_.position[node.node] = node.position;
    }
    std::vector<surgery::Fact> facts(facts_.All().begin(), facts_.All().end());
    Judge();
    input_.controls[kRight].cut = false;
    return facts;
  }
  static std::size_t Count(const std::vector<surgery::Fact>& facts, FactKind kind) {
    return static_cast<std::size_t>(
        std::count_if(facts.begin(), facts.end(), [kind](const auto& fact) { return fact.kind == kind; }));
  }
  /// Bile that runs out in a second [m^3].
  double CalcBile() {
    const auto bile = [this] {
      return Result().fluids.fluids[static_cast<std::size_t>(surgery::Fluid::kBile)].left;
    };
    const double before = bile();
    for (int i = 0; i < 120; ++i) {
      Act();
      Judge();
    }
    return bile() - before;
  }
  /// Over the middle of the cystic duct.
  void PutAcrossDuct(double inside) {
    const auto tube = scene::FindSurface(Tissue().surfaces, roles::TubeRole::kCysticDuct);
    const scene::SurfaceInfo& duct = Tissue().surfaces[static_cast<std::size_t>(tube)];
    const std::uint32_t middle = duct.first_node + duct.node_count / 2;
    PutAcross(math::Lerp(state_.position[middle], state_.position[middle + 1], 0.5),
              math::Normalized(state_.position[middle + 1] - state_.position[middle]), inside);
  }

  scene::Scene scene_;
};

TEST_F(StaplerTest, ADuctIsDividedAndBothEndsHoldPressure) {
  PutAcrossDuct(0.010);
  const auto facts = Fire();
  EXPECT_EQ(Count(facts, FactKind::kClipClosed), 4u) << "two rows on each side";
  ASSERT_EQ(Count(facts, FactKind::kTubeCut), 1u);
  EXPECT_TRUE(std::none_of(facts.begin(), facts.end(), [](const auto& fact) { return fact.is_partial; }));
  EXPECT_EQ(CalcBile(), 0.0);
  EXPECT_EQ(Published().clips_left[kRight], 0) << "one load";
  EXPECT_TRUE(Fire().empty() || Count(Fire(), FactKind::kTubeCut) == 0u) << "it is empty";
}

TEST_F(StaplerTest, ADuctThatReachesOutOfTheJawsLeaks) {
  PutAcrossDuct(0.0018);
  const auto facts = Fire();
  ASSERT_EQ(Count(facts, FactKind::kTubeCut), 1u);
  EXPECT_EQ(Count(facts, FactKind::kClipClosed), 4u);
  EXPECT_TRUE(std::any_of(facts.begin(), facts.end(), [](const auto& fact) { return fact.is_partial; }));
  EXPECT_GT(CalcBile(), 0.0);
}

TEST_F(StaplerTest, AHollowOrganIsDividedAndStaysTight) {
  const patient::Patient& patient = OperationScene()->patient;
  const Vec3 fundus = patient.LandmarkOf(roles::LandmarkRole::kFundus)->position;
  const Vec3 neck = patient.LandmarkOf(roles::LandmarkRole::kInfundibulum)->position;
  const Vec3 axis = math::Normalized(neck - fundus);
  PutAcross(fundus + 0.006 * axis, axis, 0.010);
  const auto facts = Fire();
  const auto is_cut = [this](const surgery::Fact& fact) {
    return fact.kind == FactKind::kOrganCut && fact.surface == gallbladder_;
  };
  ASSERT_TRUE(std::any_of(facts.begin(), facts.end(), is_cut));
  EXPECT_EQ(Count(facts, FactKind::kOrganOpened), 0u);
  EXPECT_EQ(conserved_.organs[static_cast<std::size_t>(gallbladder_)].opening_area, 0.0);
}

}  // namespace
}  // namespace trocar::simulation
