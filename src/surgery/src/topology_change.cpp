// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/topology_change.h"

#include <algorithm>
#include <utility>

#include "trocar/core/assert.h"

namespace trocar::surgery {

using geometry::kNone;

void TopologyChange::Reserve(std::size_t node_count, std::size_t spring_count, std::size_t strand_count) {
  nodes.reserve(node_count);
  springs.reserve(spring_count);
  cut_strands.reserve(strand_count);
}

void TopologyChange::Clear() noexcept {
  nodes.clear();
  springs.clear();
  cut_strands.clear();
}

std::uint32_t AddSpareNodes(std::size_t count, tissue::TissueDefinition& definition) {
  TROCAR_ASSERT(!definition.rest.empty());
  const auto first = static_cast<std::uint32_t>(definition.rest.size());
  // somewhere finite: nothing is joined to them
  const Vec3 place = definition.rest.front();
  definition.rest.insert(definition.rest.end(), count, place);
  definition.mass.insert(definition.mass.end(), count, 0.0);
  definition.shape_stiffness.insert(definition.shape_stiffness.end(), count, 0.0);
  for (std::uint32_t i = 0; i < count; ++i) definition.fixed.push_back(first + i);
  return first;
}

void ApplyChange(const TopologyChange& change, tissue::TissueDefinition& definition) {
  std::vector<std::uint8_t> is_fixed(definition.rest.size(), 0);
  for (const auto node : definition.fixed) is_fixed[node] = 1;
  for (const NodeChange& node : change.nodes) {
    TROCAR_ASSERT(node.node < definition.rest.size());
    definition.mass[node.node] = node.mass;
    definition.shape_stiffness[node.node] = node.shape_stiffness;
    if (!node.is_new) continue;
    definition.rest[node.node] = node.rest;
    // sources come before what is made of them
    is_fixed[node.node] = std::all_of(node.from.begin(), node.from.end(),
                                      [&](std::uint32_t from) { return from == kNone || is_fixed[from]; });
  }
  std::erase_if(definition.fixed, [&](std::uint32_t node) { return !is_fixed[node]; });

  std::vector<SpringChange> changes = change.springs;
  const auto ends = [](const auto& spring) { return std::minmax(spring.a, spring.b); };
  const auto before = [&](const auto& one, const auto& other) {
    const std::pair<std::uint32_t, std::uint32_t> a = ends(one), b = ends(other);
    return a < b;
  };
  std::sort(changes.begin(), changes.end(), before);
  std::vector<std::uint8_t> is_done(changes.size(), 0);
  std::erase_if(definition.springs, [&](tissue::Spring& spring) {
    const auto at = std::lower_bound(changes.begin(), changes.end(), spring, before);
    if (at == changes.end() || ends(*at) != ends(spring)) return false;
    is_done[static_cast<std::size_t>(at - changes.begin())] = 1;
    spring.stiffness = at->stiffness;
    spring.rest_length = at->rest_length;
    return at->stiffness <= 0.0;
  });
  for (std::size_t i = 0; i < changes.size(); ++i) {
    if (!is_done[i] && changes[i].stiffness > 0.0)
      definition.springs.push_back({changes[i].a, changes[i].b, changes[i].stiffness, changes[i].rest_length});
  }
}

void ApplyChange(const TopologyChange& change, const tissue::TissueModel& model, tissue::TissueState& state) {
  TROCAR_ASSERT(state.position.size() == model.Size());
  for (const NodeChange& node : change.nodes) {
    if (!node.is_new) continue;
    state.position[node.node] = node.position;
    state.condition[node.node] =
        model.is_fixed[node.node] ? tissue::NodeCondition::kPrescribed : tissue::NodeCondition::kFree;
  }
  for (const auto strand : change.cut_strands) state.strand_is_intact[strand] = 0;
}

}  // namespace trocar::surgery
