// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "operation/tools/tool_use.h"

namespace trocar::simulation {

using math::Vec3;

namespace {

constexpr double kMouth = 0.030;  // what lies within of its tip is in it [m]
constexpr double kBagGrip = 1e4;  // nothing slips out of a closed bag [N]

/// The bag closes around the organ: it holds nodes all over it.
void HoldOrgan(ToolUse& use, const scene::SurfaceInfo& surface) noexcept {
  surgery::Grasp& held = use.tissue.grasps[static_cast<std::size_t>(use.hand)];
  held = {};
  held.surface = use.anatomy.organ;
  held.pinch = held.damage_pinch = kBagGrip;
  const auto capacity = static_cast<std::uint32_t>(surgery::Grasp::kCapacity);
  const std::uint32_t step = std::max(1U, surface.node_count / capacity);
  const math::Pose X_tool_world = math::Inverse(use.X_device);
  for (std::uint32_t i = 0; i < surface.node_count && held.count < surgery::Grasp::kCapacity; i += step) {
    const std::uint32_t node = surface.first_node + i;
    held.nodes[held.count] = node;
    held.p_tool_node[held.count++] = X_tool_world * use.tissue.state.position[node];
    use.tissue.state.condition[node] = tissue::NodeCondition::kPrescribed;
  }
}

}  // namespace

void UseBag(ToolUse& use, surgery::Grasp* assistant) noexcept {
  OperatedParts& parts = use.parts;
  const std::int32_t organ = use.anatomy.organ;
  use.facts.Add(use.MakeFact(surgery::FactKind::kBagOpen));
  if (!parts.retrieval.is_in_bag) AddRetrieved(use, parts.stones.CatchInBag(use.X_device));
  if (parts.retrieval.is_in_bag || organ < 0 || !parts.retrieval.is_organ_free) return;
  const scene::SurfaceInfo& surface = use.made.surfaces[static_cast<std::size_t>(organ)];
  Vec3 centre;
  for (std::uint32_t i = 0; i < surface.node_count; ++i)
    centre += use.tissue.state.position[surface.first_node + i] / static_cast<double>(surface.node_count);
  if (math::Distance(centre, use.X_device.translation) > kMouth) return;
  for (surgery::Grasp& grasp : use.tissue.grasps) {
    if (grasp.surface == organ) surgery::ReleaseGrasp(use.tissue.model, grasp, use.tissue.state);
  }
  if (assistant != nullptr) surgery::ReleaseGrasp(use.tissue.model, *assistant, use.tissue.state);
  HoldOrgan(use, surface);
  AddRetrieved(use, parts.stones.BagWith(organ));
  parts.retrieval.is_in_bag = true;
  parts.retrieval.bag_hand = use.hand;
}

}  // namespace trocar::simulation
