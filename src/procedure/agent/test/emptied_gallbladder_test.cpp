// SPDX-License-Identifier: Apache-2.0
// A gallbladder that the hook has opened, and that a tool squeezes empty against the liver. decision 0034
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "trocar/agent/hand_motion.h"
#include "trocar/collision/queries.h"
#include "trocar/files/scene_file.h"
#include "trocar/geometry/mesh_topology.h"
#include "trocar/simulation/simulation.h"

namespace trocar::agent {

using files::ReadScene;
using instrument::kHandCount;
using instrument::kLeft;
using instrument::kRight;
using math::Vec3;
using scene::CalcScriptInput;
using scene::Input;
using scene::Scene;
using scene::SurfaceInfo;
using simulation::OrganSnapshot;
using simulation::Simulation;
using simulation::Snapshot;
using surgery::FactKind;
using surgery::FactName;

namespace {

class EmptiedGallbladder : public testing::Test {
 protected:
  void SetUp() override {
    auto read = ReadScene(std::filesystem::path(TROCAR_SOURCE_DIR) / "scenes/cholecystectomy.json");
    ASSERT_TRUE(read.ok()) << read.error().Text();
    scene_ = std::make_shared<const Scene>(std::move(*read));
    auto made = Simulation::Make(scene_);
    ASSERT_TRUE(made.ok()) << made.error().Text();
    simulation_.emplace(std::move(*made));
    input_ = CalcScriptInput(*scene_, 0.0);
    HandSkill skill;
    skill.tremor = 0;
    for (int hand = 0; hand < kHandCount; ++hand)
      hands_.emplace_back(scene_->instruments[hand].p_world_port, input_.hands[hand], skill, hand + 1);
    liver_ = static_cast<std::size_t>(scene_->patient.FindOrgan("liver"));
    gallbladder_ = static_cast<std::size_t>(scene_->patient.FindOrgan("gallbladder"));
    rest_ = Seen().positions;
    for (const auto& landmark : scene_->patient.landmarks) {
      if (landmark.name == "gallbladder_body") body_ = FindNode(landmark.position);
    }
    outwards_ = CalcNormal(body_);
    depth_at_rest_ = CalcDepths();
  }

  const Snapshot& Seen() const { return simulation_->GetSnapshot(); }
  const SurfaceInfo& Surface(std::size_t organ) const { return simulation_->Surfaces()[organ]; }
  std::span<const Vec3> Nodes(std::size_t organ) const {
    return std::span(Seen().positions).subspan(Surface(organ).first_node, Surface(organ).node_count);
  }
  std::uint32_t FindNode(const Vec3& p) const {
    const auto nodes = Nodes(gallbladder_);
    const auto nearest = std::min_element(nodes.begin(), nodes.end(), [&](const Vec3& a, const Vec3& b) {
      return math::SquaredDistance(a, p) < math::SquaredDistance(b, p);
    });
    return Surface(gallbladder_).first_node + static_cast<std::uint32_t>(nearest - nodes.begin());
  }
  Vec3 CalcNormal(std::uint32_t node) const {
    const auto nodes = Nodes(gallbladder_);
    Vec3 sum;
    for (const auto& t : Surface(gallbladder_).triangles) {
      if (std::find(t.begin(), t.end(), node - Surface(gallbladder_).first_node) == t.end()) continue;
      sum += math::Cross(nodes[t[1]] - nodes[t[0]], nodes[t[2]] - nodes[t[0]]);
    }
    return math::Normalized(sum);
  }
  /// How deep each vertex of the gallbladder lies in the liver [m]; 0 outside.
  std::vector<double> CalcDepths() const {
    const auto liver = Nodes(liver_);
    const auto& triangles = Surface(liver_).triangles;
    std::vector<double> depths;
    for (const Vec3& p : Nodes(gallbladder_)) {
      double nearest2 = 1;
      if (collision::IsInside(liver, triangles, p)) {
        for (const Vec3& q : liver) nearest2 = std::min(nearest2, math::SquaredDistance(p, q));
      }
      depths.push_back(nearest2 < 1 ? std::sqrt(nearest2) : 0.0);
    }
    return depths;
  }
  double DeepestInLiver() const {
    const auto now = CalcDepths();
    double deepest = 0;
    for (std::size_t i = 0; i < now.size(); ++i) deepest = std::max(deepest, now[i] - depth_at_rest_[i]);
    return deepest;
  }
  void Run(double seconds) {
    for (int tick = 0; tick < static_cast<int>(seconds / scene_->tick_seconds); ++tick) {
      before_ = Seen().positions;
      const std::uint64_t events = Seen().event_count;
      for (std::size_t hand = 0; hand < hands_.size(); ++hand)
        input_.hands[hand] = hands_[hand].Step(scene_->tick_seconds);
      simulation_->Step(input_);
      for (std::uint64_t e = events; e < Seen().event_count; ++e) {
        const FactKind kind = Seen().events[e % Seen().events.size()].kind;
        ASSERT_TRUE(kind != FactKind::kStateRestored && kind != FactKind::kOrganFrozen)
            << FactName(kind) << " at " << Seen().time << " s";
      }
      most_contacts_ = std::max(most_contacts_, Seen().contacts);
      if (Seen().tick % 40 == 0) deepest_ = std::max(deepest_, DeepestInLiver());
    }
  }
  double FastestNode() const {
    double fastest = 0;
    for (std::size_t i = 0; i < before_.size(); ++i)
      fastest = std::max(fastest, math::Distance(before_[i], Seen().positions[i]));
    return fastest;
  }
  void MoveTo(int hand, const Vec3& tip, double seconds, double hurry = 1) {
    hands_[static_cast<std::size_t>(hand)].MoveTo(tip, hurry);
    Run(seconds);
  }

  std::shared_ptr<const Scene> scene_;
  std::optional<Simulation> simulation_;
  Input input_;
  std::vector<HandMotion> hands_;
  std::vector<Vec3> rest_, before_;
  std::vector<double> depth_at_rest_;
  std::size_t liver_ = 0, gallbladder_ = 0;
  std::uint32_t body_ = 0;
  Vec3 outwards_;
  std::size_t most_contacts_ = 0;
  double deepest_ = 0;
};

TEST_F(EmptiedGallbladder, IsSqueezedAgainstTheLiverAndDoesNotGoThroughIt) {
  MoveTo(kRight, rest_[body_] + 0.01 * outwards_, 0.9);
  MoveTo(kRight, rest_[body_] - 0.003 * outwards_, 0.4);
  input_.controls[kRight].coagulate = true;
  Run(1.6);
  input_.controls[kRight].coagulate = false;
  ASSERT_GT(Seen().organs[gallbladder_].leaked, 0.0) << "the hook has opened it";
  MoveTo(kRight, rest_[body_] + 0.06 * outwards_, 0.6);
  MoveTo(kLeft, rest_[body_] + 0.012 * outwards_, 0.7);
  // three centimetres deep, through the bag and into the liver, then aside
  MoveTo(kLeft, rest_[body_] - 0.03 * outwards_, 3.0, 0.5);
  MoveTo(kLeft, hands_[kLeft].Tip() + Vec3{0, 0, 0.012}, 0.5, 0.4);
  const OrganSnapshot& bag = Seen().organs[gallbladder_];
  EXPECT_GT(bag.leaked, 1e-6) << "bile was pressed out [m^3]";
  EXPECT_LT(deepest_, 0.005) << "the liver stops it";
  EXPECT_EQ(Seen().dropped_contacts, 0u);
  EXPECT_LT(most_contacts_, 800u);

  // drawn back, the tool leaves a slack bag that lies still
  MoveTo(kLeft, rest_[body_] + 0.06 * outwards_, 1.6);
  EXPECT_LT(FastestNode(), 2e-5);
  EXPECT_LT(DeepestInLiver(), 0.001);
  EXPECT_EQ(bag.pressure, 0.0) << "a hole lets no pressure stand";
  EXPECT_LE(Seen().iterations, 2) << "and costs no more than a full one at rest";
}

}  // namespace
}  // namespace trocar::agent
