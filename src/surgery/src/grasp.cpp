// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/grasp.h"

#include <algorithm>
#include <cmath>

#include "trocar/geometry/distance.h"

namespace trocar::surgery {
namespace {

using tissue::NodeCondition;

struct Candidate {
  std::uint32_t node;
  double distance2;
};

/// The nearest candidates, nearest first; equal distances by index, so that the choice repeats.
struct Candidates {
  std::array<Candidate, Grasp::kCapacity> list{};
  std::size_t count = 0;

  void Offer(std::uint32_t node, double distance2) noexcept {
    std::size_t at = count;
    if (count == list.size()) {
      if (distance2 >= list.back().distance2) return;
      at = list.size() - 1;
    } else {
      ++count;
    }
    while (at > 0 && list[at - 1].distance2 > distance2) {
      list[at] = list[at - 1];
      --at;
    }
    list[at] = {node, distance2};
  }
};

bool CanTake(const tissue::TissueState& state, std::uint32_t node) noexcept {
  return state.condition[node] != NodeCondition::kPrescribed;
}

/// Free nodes of one organ near the line between the jaws, from the hinge to the tip.
Candidates FindBetweenJaws(const OrganSurface& organ, const Vec3& hinge, const Vec3& tip, double reach,
                           const tissue::TissueState& state) noexcept {
  Candidates found;
  for (std::uint32_t local = 0; local < organ.node_count; ++local) {
    const std::uint32_t node = organ.first_node + local;
    const Vec3& p = state.position[node];
    const double t = geometry::FindNearestOnSegment(p, hinge, tip);
    const double distance2 = math::SquaredDistance(p, math::Lerp(hinge, tip, t));
    if (distance2 <= reach * reach && CanTake(state, node)) found.Offer(node, distance2);
  }
  if (found.count > 0) return found;
  // triangles may be larger than the reach: then the corners of the one that lies between the jaws
  const auto nodes = organ.Nodes(state.position);
  const auto nearest =
      organ.hierarchy.FindNearest(nodes, math::Lerp(hinge, tip, 0.75), {.max_distance = reach});
  if (nearest.Found()) {
    for (const auto local : organ.triangles[nearest.triangle]) {
      const std::uint32_t node = organ.first_node + local;
      if (CanTake(state, node)) found.Offer(node, math::SquaredDistance(state.position[node], nearest.point));
    }
  }
  return found;
}

}  // namespace

void ReleaseGrasp(const tissue::TissueModel& model, Grasp& grasp, tissue::TissueState& state) noexcept {
  for (const auto node : grasp.Nodes()) {
    state.condition[node] = model.is_fixed[node] ? NodeCondition::kPrescribed : NodeCondition::kFree;
  }
  grasp.count = 0;
  grasp.organ = -1;
  grasp.ticks_over_limit = 0;
}

GraspChange UpdateGrasp(const instrument::Tool& tool, const Pose& X_world_tool, double jaw,
                        std::span<const OrganSurface> organs, const tissue::TissueModel& model,
                        const GraspSettings& settings, Grasp& grasp, tissue::TissueState& state) noexcept {
  GraspChange change = GraspChange::kNone;
  if (grasp.are_jaws_closed && jaw > settings.open_fraction * tool.max_jaw) {
    grasp.are_jaws_closed = false;
    if (grasp.IsHolding()) {
      ReleaseGrasp(model, grasp, state);
      change = GraspChange::kReleased;
    }
  } else if (!grasp.are_jaws_closed && jaw < settings.close_fraction * tool.max_jaw) {
    grasp.are_jaws_closed = true;
    const Vec3 hinge = X_world_tool * instrument::JawHinge(tool), tip = X_world_tool.translation;
    Candidates best;
    for (std::size_t index = 0; index < organs.size(); ++index) {
      const Candidates found = FindBetweenJaws(organs[index], hinge, tip, settings.reach, state);
      if (found.count == 0 || (best.count > 0 && best.list[0].distance2 <= found.list[0].distance2)) continue;
      best = found;
      grasp.organ = static_cast<std::int32_t>(index);
    }
    const Pose X_tool_world = math::Inverse(X_world_tool);
    grasp.count = best.count;
    grasp.jaw_at_closing = jaw;
    for (std::size_t i = 0; i < best.count; ++i) {
      grasp.nodes[i] = best.list[i].node;
      grasp.p_tool_node[i] = X_tool_world * state.position[best.list[i].node];
      state.condition[best.list[i].node] = NodeCondition::kPrescribed;
    }
    change = grasp.IsHolding() ? GraspChange::kGrasped : GraspChange::kMissed;
  }

  // held tissue follows the jaws, also while they close the rest of their way
  const double squeeze = grasp.jaw_at_closing > 0.0 ? std::clamp(jaw / grasp.jaw_at_closing, 0.0, 1.0) : 1.0;
  for (std::size_t i = 0; i < grasp.count; ++i) {
    const Vec3& p = grasp.p_tool_node[i];
    state.position[grasp.nodes[i]] = X_world_tool * Vec3{p.x, squeeze * p.y, p.z};
  }
  return change;
}

GraspChange UpdateSlip(double pull, const GraspSettings& settings, const tissue::TissueModel& model,
                       Grasp& grasp, tissue::TissueState& state) noexcept {
  if (!grasp.IsHolding()) return GraspChange::kNone;
  grasp.ticks_over_limit = pull > settings.HoldLimit() ? grasp.ticks_over_limit + 1 : 0;
  if (grasp.ticks_over_limit < settings.slip_ticks) return GraspChange::kNone;
  ReleaseGrasp(model, grasp, state);
  return GraspChange::kSlipped;
}

}  // namespace trocar::surgery
