// SPDX-License-Identifier: Apache-2.0
/// \file operation_harness.h  The operation on the built-in patient without contacts and solver: tissue lies where the test
/// puts it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "operation/operation.h"
#include "trocar/files/scene_file.h"
#include "trocar/patient/patient.h"
#include "trocar/simulation/simulation.h"

namespace trocar::simulation {

inline std::shared_ptr<const scene::Scene> OperationScene() {
  static const std::shared_ptr<const scene::Scene> scene = [] {
    auto read = files::ReadScene(std::filesystem::path(TROCAR_SOURCE_DIR) / "scenes/cholecystectomy.json");
    EXPECT_TRUE(read.ok()) << (read.ok() ? "" : read.error().Text());
    return std::make_shared<const scene::Scene>(std::move(*read));
  }();
  return scene;
}

class OperationHarness : public testing::Test {
 protected:
  static constexpr double kTick = 1.0 / 120;
  static constexpr math::Vec3 kGravity{1.3, -2.0, -9.5};

  OperationHarness() {
    model_ = tissue::MakeTissueModel(Tissue().definition);
    state_ = tissue::MakeRestState(model_);
    conservation_.emplace(model_, Tissue().conservation);
    conserved_ = conservation_->MakeState(state_);
    const patient::Patient& patient = OperationScene()->patient;
    gallbladder_ = patient.FindOrgan("gallbladder"), liver_ = patient.FindOrgan("liver");
    for (std::size_t i = 0; i < patient.organs.size(); ++i) {
      auto surface =
          surgery::MakeOrganSurface(state_.position, Tissue().surfaces[i].first_node, patient.organs[i].mesh);
      EXPECT_TRUE(surface.ok());
      organs_.push_back(std::move(*surface));
    }
    std::vector<surgery::TubeSurface> tubes;
    for (const scene::SurfaceInfo& surface : Tissue().surfaces) {
      if (surface.triangles.empty()) tubes.push_back({surface.first_node, surface.node_count, surface.radii});
    }
    tubes_ = std::move(*surgery::MakeTubeSet(state_.position, std::move(tubes)));
  }

  static const std::shared_ptr<const scene::PatientTissue>& SharedTissue() {
    static const auto tissue = std::make_shared<const scene::PatientTissue>(
        std::move(*scene::MakePatientTissue(*OperationScene(), Operation::kSpare)));
    return tissue;
  }
  static const scene::PatientTissue& Tissue() { return *SharedTissue(); }
  std::span<const surgery::OrganSurface> Organs() const { return organs_; }
  std::span<const math::Vec3> Position() const { return state_.position; }
  const scene::SurfaceInfo& Gallbladder() const {
    return Tissue().surfaces[static_cast<std::size_t>(gallbladder_)];
  }

  void MakeOperation(const scene::Scene& scene = *OperationScene()) {
    state_ = tissue::MakeRestState(model_);
    conserved_ = conservation_->MakeState(state_);
    auto made = Operation::Make(scene, SharedTissue());
    ASSERT_TRUE(made.ok()) << made.error().Text();
    operation_ = std::move(*made);
    judge_ = operation_->MakeJudge();
    ASSERT_NE(judge_, nullptr);
    BeginTick();
    input_ = scene::CalcScriptInput(*OperationScene(), 0.0);
    grasps_ = {};
    hands_ = {};
    hands_.input = &input_;
    hands_.joints = input_.hands;
    hands_.gravity = kGravity;
    hands_.seconds = kTick;
    // far from everything
    for (math::Pose& X : hands_.X_proxy) X.translation = {0, 0, 0.3};
    hands_.X_device = hands_.X_proxy;
  }
  OperatedTissue Now() {
    return {model_, Tissue().definition, state_, *conservation_, conserved_, organs_, tubes_, torn_, grasps_};
  }
  void BeginTick() {
    facts_.Clear();
    operation_->BeginTick(facts_);
    is_judged_ = false;
  }
  void Act() {
    if (is_judged_) BeginTick();
    OperatedTissue tissue = Now();
    operation_->Act(hands_, tissue);
    operation_->Heat(hands_, tissue);
    judge_->SeeTools(operation_->Observe(hands_, Now(), hands_.camera));
    operation_->Assist(hands_, tissue);
    (void)operation_->EndCuts();
  }
  /// What follows the solve; the facts stay until the next tick.
  void Judge() {
    if (is_judged_) BeginTick();
    OperatedTissue tissue = Now();
    operation_->Flow(hands_, tissue);
    operation_->MoveLoose(hands_, Now());
    judge_->Update(operation_->Observe(hands_, Now(), hands_.camera));
    hands_.time += kTick;
    is_judged_ = true;
  }
  OperationResult Result() const { return operation_->CalcResult(judge_.get()); }
  /// Number of errors of that name so far.
  std::size_t CountErrors(std::string_view name) const {
    const auto row = scene::FindError(*OperationScene()->operation->procedure, name);
    EXPECT_TRUE(row.has_value()) << name;
    return row ? judge_->Errors().Count(*row) : 0;
  }
  OperationSnapshot Published() const {
    OperationSnapshot snapshot;
    operation_->Size(snapshot);
    operation_->Publish(state_, snapshot);
    Publish(*judge_, snapshot);
    return snapshot;
  }

  /// Exchanges the tool, as the hand's movement does.
  void SelectTool(int hand, instrument::ToolKind kind) {
    const auto& tray = OperationScene()->instruments[static_cast<std::size_t>(hand)].tray;
    const auto found = std::find_if(tray.begin(), tray.end(),
                                    [kind](const instrument::Tool& tool) { return tool.kind == kind; });
    ASSERT_NE(found, tray.end());
    input_.controls[hand].tool = static_cast<std::uint8_t>(found - tray.begin());
    if (is_judged_) BeginTick();
    instrument::TrocarJoints wanted;
    for (int i = 0; i < 80; ++i)
      (void)operation_->MoveTool(hand, input_.controls[hand], grasps_[hand].IsHolding(), kTick, wanted);
  }

  /// Everything is divided, the bag closes around the gallbladder and leaves.
  void TakeGallbladderOut() {
    std::fill(state_.strand_is_intact.begin(), state_.strand_is_intact.end(), std::uint8_t{0});
    Judge();
    SelectTool(instrument::kRight, instrument::ToolKind::kBag);
    math::Vec3 centre;
    for (std::uint32_t i = 0; i < Gallbladder().node_count; ++i)
      centre += state_.position[Gallbladder().first_node + i] / static_cast<double>(Gallbladder().node_count);
    hands_.X_proxy[instrument::kRight] = hands_.X_device[instrument::kRight] = {{}, centre};
    Act();
    Judge();
    SelectTool(instrument::kRight, instrument::ToolKind::kHook);
    Judge();
  }

  bool IsEdge(const tissue::Spring& spring) const {
    const surgery::OrganSurface& wall = organs_[static_cast<std::size_t>(gallbladder_)];
    return std::any_of(wall.triangles.begin(), wall.triangles.end(), [&](const geometry::Triangle& t) {
      const auto has = [&](std::uint32_t node) {
        return std::find(t.begin(), t.end(), node - wall.first_node) != t.end();
      };
      return has(spring.a) && has(spring.b);
    });
  }
  /// A spring of the gallbladder's wall that is far from the liver.
  std::uint32_t FreeWallSpring() const {
    const auto& springs = Tissue().definition.springs;
    std::uint32_t best = 0;
    double farthest = -1;
    for (std::uint32_t i = 0; i < Tissue().spring_organs.size(); ++i) {
      if (Tissue().spring_organs[i] != gallbladder_ || !IsEdge(springs[i])) continue;
      const math::Vec3 middle = 0.5 * (state_.position[springs[i].a] + state_.position[springs[i].b]);
      const surgery::OrganSurface& liver = organs_[static_cast<std::size_t>(liver_)];
      const double distance = liver.tree.FindNearest(liver.Nodes(state_.position), middle).squared_distance;
      if (distance > farthest) farthest = distance, best = i;
    }
    return best;
  }

  tissue::TissueModel model_;
  tissue::TissueState state_;
  std::optional<tissue::Conservation> conservation_;
  tissue::ConservationState conserved_;
  std::vector<surgery::OrganSurface> organs_;
  surgery::TubeSet tubes_;
  int gallbladder_ = -1, liver_ = -1;
  std::vector<std::uint32_t> torn_;
  std::unique_ptr<Operation> operation_;
  surgery::FactList facts_;  // of the tick
  bool is_judged_ = false;   // the tick is over
  std::unique_ptr<scene::ProcedureJudge> judge_;
  scene::Input input_;
  HandsNow hands_;
  std::array<surgery::Grasp, instrument::kHandCount> grasps_;
};

}  // namespace trocar::simulation
