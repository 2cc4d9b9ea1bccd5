// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/topology_change.h"

#include <algorithm>
#include <utility>

#include "trocar/base/assert.h"

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
  const math::Vec3 place = definition.rest.front();
  definition.rest.insert(definition.rest.end(), count, place);
  definition.mass.insert(definition.mass.end(), count, 0.0);
  definition.shape_stiffness.insert(definition.shape_stiffness.end(), count, 0.0);
  for (std::uint32_t i = 0; i < count; ++i) definition.fixed.push_back(first + i);
  return first;
}

namespace {

/// Orders springs by their two nodes.
std::pair<std::uint32_t, std::uint32_t> Ends(std::uint32_t a, std::uint32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

void ChangeNodes(const TopologyChange& change, tissue::TissueDefinition& definition) {
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
}

}  // namespace

std::vector<std::uint32_t> ApplyChange(const TopologyChange& change, tissue::TissueDefinition& definition) {
  ChangeNodes(change, definition);
  // the springs that something changes or inherits from, with where they stand
  struct Named {
    std::pair<std::uint32_t, std::uint32_t> ends;
    std::uint32_t change, spring;
  };
  std::vector<Named> named;
  for (std::uint32_t i = 0; i < change.springs.size(); ++i) {
    const SpringChange& spring = change.springs[i];
    named.push_back({Ends(spring.a, spring.b), i, kNone});
    if (spring.inherits[0] != kNone)
      named.push_back({Ends(spring.inherits[0], spring.inherits[1]), kNone, kNone});
  }
  const auto before = [](const Named& one, const Named& other) {
    return one.ends != other.ends ? one.ends < other.ends : one.change < other.change;
  };
  std::sort(named.begin(), named.end(), before);
  const auto find = [&](const std::pair<std::uint32_t, std::uint32_t>& ends) -> Named* {
    const auto at = std::lower_bound(named.begin(), named.end(), Named{ends, 0, 0}, before);
    return at != named.end() && at->ends == ends ? &*at : nullptr;
  };

  std::vector<tissue::Spring> springs;
  std::vector<std::uint32_t> origins;
  springs.reserve(definition.springs.size() + change.springs.size());
  origins.reserve(springs.capacity());
  for (std::uint32_t i = 0; i < definition.springs.size(); ++i) {
    tissue::Spring spring = definition.springs[i];
    if (Named* const name = find(Ends(spring.a, spring.b))) {
      name->spring = i;
      if (name->change != kNone) {
        spring.stiffness = change.springs[name->change].stiffness;
        spring.rest_length = change.springs[name->change].rest_length;
        if (spring.stiffness <= 0.0) continue;
      }
    }
    springs.push_back(spring);
    origins.push_back(i);
  }
  for (const SpringChange& spring : change.springs) {
    if (spring.stiffness <= 0.0 || find(Ends(spring.a, spring.b))->spring != kNone) continue;
    springs.push_back({spring.a, spring.b, spring.stiffness, spring.rest_length, spring.law});
    const Named* const parent =
        spring.inherits[0] == kNone ? nullptr : find(Ends(spring.inherits[0], spring.inherits[1]));
    origins.push_back(parent == nullptr ? kNone : parent->spring);
  }
  definition.springs = std::move(springs);
  return origins;
}

void ApplyChange(const TopologyChange& change, std::span<const std::uint32_t> spring_origins,
                 const tissue::TissueModel& model, tissue::TissueState& state) {
  TROCAR_ASSERT(state.position.size() == model.Size() && spring_origins.size() == model.SpringCount());
  for (const NodeChange& node : change.nodes) {
    if (!node.is_new) continue;
    state.position[node.node] = node.position;
    state.condition[node.node] =
        model.is_fixed[node.node] ? tissue::NodeCondition::kPrescribed : tissue::NodeCondition::kFree;
  }
  const std::vector<double> factor = std::exchange(state.spring_factor, {}),
                            damage = std::exchange(state.spring_damage, {});
  for (const auto origin : spring_origins) {
    state.spring_factor.push_back(origin == kNone ? 1.0 : factor[origin]);
    state.spring_damage.push_back(origin == kNone ? 0.0 : damage[origin]);
  }
  for (const auto strand : change.cut_strands) state.strand_is_intact[strand] = 0;
}

}  // namespace trocar::surgery
