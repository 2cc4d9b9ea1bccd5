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
    tray.back().jaw_length = 0.012;  // so that nothing else lies between them
    MakeOperation(scene_);
    input_.controls[kRight].tool = static_cast<std::uint8_t>(tray.size() - 1);
    instrument::TrocarJoints wanted;
    for (int i = 0; i < 80; ++i)
      (void)operation_->MoveTool(kRight, input_.controls[kRight], false, kTick, wanted);
    hands_.joints[kRight].depth = 0.2;
  }
  const instrument::Tool& Stapler() const { return scene_.instruments[kRight].tray.back(); }

  /// Distance of the nearest duct or vessel but one from the line of the closed jaws [m].
  double FindOtherTube(const Vec3& hinge, const Vec3& tip, std::int32_t but) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < Tissue().surfaces.size(); ++i) {
      const scene::SurfaceInfo& tube = Tissue().surfaces[i];
      if (tube.radii.empty() || static_cast<std::int32_t>(i) == but) continue;
      for (std::uint32_t k = 0; k < tube.node_count; ++k) {
        const Vec3& p = state_.position[tube.first_node + k];
        const double at = math::Dot(p - hinge, tip - hinge) / math::SquaredDistance(hinge, tip);
        least = std::min(least, math::Distance(p, math::Lerp(hinge, tip, std::clamp(at, 0.0, 1.0))));
      }
    }
    return least;
  }
  /// Puts the jaws across a line, as far as can be from the ducts and vessels that are not meant.
  /// \param inside  from the line to the tip of the jaws [m]
  /// \param best  how far they were elsewhere: only a better place is taken [m]
  void PutAcross(const Vec3& p, const Vec3& axis, double inside, std::int32_t meant, double& best) {
    const Vec3 side = math::AnyPerpendicular(axis);
    for (int i = 0; i < 24; ++i) {
      const Vec3 along = math::Rotate(math::RotationAbout(axis, i * M_PI / 12), side);
      const Vec3 tip = p + inside * along;
      const double free = FindOtherTube(tip - Stapler().jaw_length * along, tip, meant);
      if (free <= best) continue;
      best = free;
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
  /// Over the cystic duct, where the others are farthest.
  void PutAcrossDuct(double inside) {
    const auto tube = scene::FindSurface(Tissue().surfaces, roles::TubeRole::kCysticDuct);
    const scene::SurfaceInfo& duct = Tissue().surfaces[static_cast<std::size_t>(tube)];
    double best = 0;
    for (std::uint32_t k = duct.first_node + 2; k + 3 < duct.first_node + duct.node_count; ++k)
      PutAcross(math::Lerp(state_.position[k], state_.position[k + 1], 0.5),
                math::Normalized(state_.position[k + 1] - state_.position[k]), inside, tube, best);
    ASSERT_GT(best, Stapler().jaw_thickness) << "the knife is as wide as the jaws are thick";
  }

  scene::Scene scene_;
};

TEST_F(StaplerTest, ADuctIsDividedAndBothEndsHoldPressure) {
  PutAcrossDuct(0.006);
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
  double best = 0;
  PutAcross(fundus + 0.006 * axis, axis, 0.010, -1, best);
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
