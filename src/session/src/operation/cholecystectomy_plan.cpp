// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "cholecystectomy_surgeon.h"

namespace trocar::session {
namespace {

constexpr double kMainDistance = 0.009;  // from ducts that must stay, where no fibre is burnt [m]

}  // namespace

void CholecystectomySurgeon::PlanOperation() {
  using Kind = StrandInfo::Kind;
  const std::size_t duct = FindTube("cystic_duct"), artery = FindTube("cystic_artery");
  const Place neck = [this](const Snapshot& seen) { return seen.positions[neck_]; };
  const Vec3 duct_way = math::Normalized(rest_[tube_nodes_[duct].front()] - rest_[tube_nodes_[duct].back()]);

  Add(
      "assistant: retract", [this](const Snapshot&) { assistant_ = AssistantCommand::kRetract; },
      [](const Snapshot& seen) {
        return seen.operation.is_assistant_holding || !seen.operation.has_assistant;
      },
      8.0);
  Wait(1.5);
  Grasp(kLeft, [this](const Snapshot& seen) { return seen.positions[hold_]; });
  Draw(kLeft, 0.006 * duct_way + 0.003 * bed_normal_);
  LookAt(neck, 0.0, 0.075);

  // the triangle, from the gallbladder towards the ducts
  std::vector<std::uint32_t> triangle, bed;
  std::vector<double> triangle_order, bed_order;
  const Vec3 neck_rest = rest_[neck_], axis = rest_[fundus_] - rest_[neck_];
  const auto is_near_main = [&](const Vec3& p) {
    for (std::size_t t = 0; t < tube_nodes_.size(); ++t) {
      const anatomy::Tube& tube = scene_->patient.tubes[t];
      if (tube.name.find("cystic") == 0) continue;
      for (const std::uint32_t node : tube_nodes_[t]) {
        if (math::Distance(rest_[node], p) < kMainDistance) return true;
      }
    }
    return false;
  };
  for (std::uint32_t i = 0; i < strands_.size(); ++i) {
    const Vec3 middle = 0.5 * (rest_[strands_[i].a] + rest_[strands_[i].b]);
    if (strands_[i].kind == Kind::kTriangle || strands_[i].kind == Kind::kPeritoneum) {
      if (is_near_main(middle)) continue;
      triangle.push_back(i);
      // the front first
      triangle_order.push_back(-0.5 * middle.z);
    }
    if (strands_[i].kind == Kind::kBed || strands_[i].kind == Kind::kAdhesion) {
      bed.push_back(i);
      bed_order.push_back(0.5 * math::Dot(middle - neck_rest, axis) / math::Norm(axis));
    }
  }
  Dissect("the hepatocystic triangle", triangle, triangle_order, 0.995, 0.0);
  // the lower third of the bed
  const double third = 0.42 * math::Norm(axis);
  std::vector<std::uint32_t> lower;
  std::vector<double> lower_order;
  for (std::size_t i = 0; i < bed.size(); ++i) {
    if (bed_order[i] / 0.5 > third) continue;
    lower.push_back(bed[i]);
    lower_order.push_back(bed_order[i]);
  }
  Draw(kLeft, 0.006 * bed_normal_);
  Dissect("the lower third of the bed", lower, lower_order, 0.97, 0.028);

  // both views
  const Place triangle_middle = [this, duct](const Snapshot& seen) { return TubePoint(seen, duct, 0.5); };
  Reach(kRight, [this](const Snapshot& seen) {
    const Vec3 field = seen.positions[neck_];
    return field + 0.05 * math::Normalized(HandOf(kRight).Port() - field);
  });
  for (const double turn : {-0.8, 0.8}) {
    LookAt(triangle_middle, turn, 0.060);
    Wait(1.6);
  }
  LookAt(triangle_middle, 0.0, 0.065);

  Exchange(kRight, instrument::ToolKind::kClipApplier);
  for (const double share : {0.66, 0.54, 0.38}) PlaceClip(duct, share);
  for (const double share : {0.80, 0.69, 0.55}) PlaceClip(artery, share);
  Exchange(kRight, instrument::ToolKind::kScissors);
  CutTube(duct, 0.46);
  CutTube(artery, 0.62);

  Exchange(kRight, instrument::ToolKind::kHook);
  LookAt([this](const Snapshot& seen) { return 0.5 * (seen.positions[neck_] + seen.positions[fundus_]); },
         0.0, 0.105);
  // a new hold for each: the old one may have slipped, and what is free can be drawn elsewhere
  const Vec3 aside = math::Normalized(math::Cross(bed_normal_, axis));
  for (const Vec3& way : {Vec3{}, 0.02 * aside, -0.02 * aside}) {
    LetGo(kLeft);
    Grasp(kLeft, [this](const Snapshot& seen) { return seen.positions[hold_]; });
    Draw(kLeft, 0.012 * bed_normal_ + way);
    Dissect("the gallbladder from its bed", bed, bed_order, 1.0, 0.070);
  }
  Add(
      "assistant: release", [this](const Snapshot&) { assistant_ = AssistantCommand::kRelease; },
      [](const Snapshot& seen) { return !seen.operation.is_assistant_holding; }, 4.0);
  Draw(kLeft, 0.03 * bed_normal_);
  Exchange(kRight, instrument::ToolKind::kBag);
  Reach(kRight, [this](const Snapshot& seen) {
    const SurfaceInfo& surface =
        surfaces_[static_cast<std::size_t>(scene_->patient.FindOrgan("gallbladder"))];
    Vec3 centre;
    for (std::uint32_t i = 0; i < surface.node_count; ++i)
      centre += seen.positions[surface.first_node + i] / static_cast<double>(surface.node_count);
    return centre;
  });
  Add(
      "close the bag", [](const Snapshot&) {}, [](const Snapshot& seen) { return seen.operation.is_in_bag; },
      4.0);
  LetGo(kLeft);
  Exchange(kRight, instrument::ToolKind::kHook);
  // Exchange ends with the bag outside
  acts_.pop_back();
  acts_.back().is_done = [](const Snapshot& seen) { return seen.operation.is_completed; };
}

}  // namespace trocar::session
