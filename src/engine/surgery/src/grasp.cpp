// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/grasp.h"

#include <algorithm>
#include <cmath>

#include "trocar/geometry/distance.h"
#include "trocar/math/state_fields.h"

namespace trocar::surgery {

using math::Pose;
using math::Vec3;

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
  // triangles may be larger than the reach: then the corners of the one that is nearest to the jaws
  const auto nodes = organ.Nodes(state.position);
  const auto nearest = organ.tree.FindNearestToSegment(nodes, {hinge, tip}, {.max_distance = reach}).nearest;
  if (nearest.Found()) {
    for (const auto local : organ.triangles[nearest.triangle]) {
      const std::uint32_t node = organ.first_node + local;
      if (CanTake(state, node)) found.Offer(node, math::SquaredDistance(state.position[node], nearest.point));
    }
  }
  return found;
}

/// Free nodes of one tube near that line, judged by its surface.
Candidates FindTubeBetweenJaws(const TubeSurface& tube, const Vec3& hinge, const Vec3& tip, double reach,
                               const tissue::TissueState& state) noexcept {
  Candidates found;
  for (std::uint32_t local = 0; local < tube.node_count; ++local) {
    const std::uint32_t node = tube.first_node + local;
    const Vec3& p = state.position[node];
    const double t = geometry::FindNearestOnSegment(p, hinge, tip);
    const double distance = std::max(0.0, math::Distance(p, math::Lerp(hinge, tip, t)) - tube.radii[local]);
    if (distance <= reach && CanTake(state, node)) found.Offer(node, distance * distance);
  }
  return found;
}

/// Pinch that damages a bite: more for one that fills more of the jaws [N].
double CalcDamagePinch(const instrument::Tool& tool, std::span<const OrganSurface> organs,
                       const TubeSet* tubes, const Grasp& grasp, std::span<const Vec3> rest) noexcept {
  const double jaw_area = tool.jaw_length * tool.jaw_width;
  double area = 0, small = OrganSurface{}.damage_pinch_small, full = OrganSurface{}.damage_pinch_full;
  const auto surface = static_cast<std::size_t>(grasp.surface);
  if (surface < organs.size()) {
    const OrganSurface& organ = organs[surface];
    for (const auto node : grasp.Nodes()) area += organ.vertex_areas[node - organ.first_node];
    small = organ.damage_pinch_small, full = organ.damage_pinch_full;
  } else {
    // a tube lies in the jaws with its shadow
    const TubeSurface& tube = tubes->tubes[surface - organs.size()];
    const std::uint32_t last = tube.first_node + tube.node_count - 1;
    for (const auto node : grasp.Nodes()) {
      const std::uint32_t next = node < last ? node + 1 : node - 1;
      area += 2.0 * tube.radii[node - tube.first_node] * math::Distance(rest[node], rest[next]);
    }
  }
  return small + (full - small) * std::min(1.0, area / jaw_area);
}

double CalcPinch(const GraspSettings& settings, double jaw, double jaw_at_closing) noexcept {
  const double squeeze = jaw_at_closing > 0.0 ? std::clamp(1.0 - jaw / jaw_at_closing, 0.0, 1.0) : 1.0;
  return settings.least_pinch + (settings.most_pinch - settings.least_pinch) * squeeze;
}

}  // namespace

void ReleaseGrasp(const tissue::TissueModel& model, Grasp& grasp, tissue::TissueState& state) noexcept {
  for (const auto node : grasp.Nodes()) {
    state.condition[node] = model.is_fixed[node] ? NodeCondition::kPrescribed : NodeCondition::kFree;
  }
  grasp.count = 0;
  grasp.surface = -1;
  grasp.pinch = 0;
  grasp.is_damaged = false;
  grasp.ticks_over_limit = 0;
}

GraspChange UpdateGrasp(const instrument::Tool& tool, const Pose& X_world_tool, const Pose& X_world_device,
                        double jaw, std::span<const OrganSurface> organs, const TubeSet* tubes,
                        const tissue::TissueModel& model, const GraspSettings& settings, Grasp& grasp,
                        tissue::TissueState& state) noexcept {
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
    const auto consider = [&](const Candidates& found, std::size_t surface) {
      if (found.count == 0 || (best.count > 0 && best.list[0].distance2 <= found.list[0].distance2)) return;
      best = found;
      grasp.surface = static_cast<std::int32_t>(surface);
    };
    for (std::size_t index = 0; index < organs.size(); ++index) {
      consider(FindBetweenJaws(organs[index], hinge, tip, settings.reach, state), index);
    }
    for (std::size_t tube = 0; tubes != nullptr && tube < tubes->tubes.size(); ++tube) {
      consider(FindTubeBetweenJaws(tubes->tubes[tube], hinge, tip, settings.reach, state),
               organs.size() + tube);
    }
    const Pose X_device_world = math::Inverse(X_world_device);
    grasp.count = best.count;
    grasp.jaw_at_closing = jaw;
    for (std::size_t i = 0; i < best.count; ++i) {
      grasp.nodes[i] = best.list[i].node;
      grasp.p_tool_node[i] = X_device_world * state.position[best.list[i].node];
      state.condition[best.list[i].node] = NodeCondition::kPrescribed;
    }
    if (grasp.IsHolding()) grasp.damage_pinch = CalcDamagePinch(tool, organs, tubes, grasp, model.rest);
    change = grasp.IsHolding() ? GraspChange::kGrasped : GraspChange::kMissed;
  }
  if (!grasp.IsHolding()) return change;

  // held tissue follows the jaws, also while they close the rest of their way
  const double squeeze = grasp.jaw_at_closing > 0.0 ? std::clamp(jaw / grasp.jaw_at_closing, 0.0, 1.0) : 1.0;
  for (std::size_t i = 0; i < grasp.count; ++i) {
    const Vec3& p = grasp.p_tool_node[i];
    state.position[grasp.nodes[i]] = X_world_device * Vec3{p.x, squeeze * p.y, p.z};
  }
  grasp.pinch = CalcPinch(settings, jaw, grasp.jaw_at_closing);
  if (change == GraspChange::kNone && !grasp.is_damaged && grasp.pinch > grasp.damage_pinch) {
    grasp.is_damaged = true;
    change = GraspChange::kDamaged;
  }
  return change;
}

GraspChange UpdateSlip(double pull, const GraspSettings& settings, const tissue::TissueModel& model,
                       Grasp& grasp, tissue::TissueState& state) noexcept {
  if (!grasp.IsHolding()) return GraspChange::kNone;
  grasp.ticks_over_limit = pull > settings.friction * grasp.pinch ? grasp.ticks_over_limit + 1 : 0;
  if (grasp.ticks_over_limit < settings.slip_ticks) return GraspChange::kNone;
  ReleaseGrasp(model, grasp, state);
  return GraspChange::kSlipped;
}

void VisitState(base::StateArchive& archive, Grasp& grasp) {
  archive.Field("are_jaws_closed", grasp.are_jaws_closed);
  archive.Field("surface", grasp.surface);
  archive.Field("count", grasp.count);
  archive.Field("nodes", grasp.nodes);
  archive.Field("p_tool_node", grasp.p_tool_node);
  archive.Field("jaw_at_closing", grasp.jaw_at_closing);
  archive.Field("pinch", grasp.pinch);
  archive.Field("damage_pinch", grasp.damage_pinch);
  archive.Field("is_damaged", grasp.is_damaged);
  archive.Field("ticks_over_limit", grasp.ticks_over_limit);
  if (archive.IsRestoring() && grasp.count > Grasp::kCapacity) {
    grasp.count = 0;
    archive.Fail("holds more nodes than its capacity");
  }
}

}  // namespace trocar::surgery
