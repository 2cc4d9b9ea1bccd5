// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/element_kinds.h"

#include "trocar/base/state_archive.h"

namespace trocar::tissue {

using math::Vec3;

bool AreUsable(const ElementArrays& elements, std::size_t node_count) noexcept {
  bool are_usable = elements.FitsCapacity();
  elements.ForEach([&](const auto& element) {
    are_usable = are_usable && IsElementUsable(element) &&
                 std::all_of(element.nodes.begin(), element.nodes.end(),
                             [&](std::uint32_t node) { return node < node_count; });
  });
  return are_usable;
}

void VisitState(base::StateArchive& archive, ElementArrays& elements, std::size_t node_count) {
  elements.ForEachKind([&](auto& array) {
    archive.Field(std::remove_reference_t<decltype(array)>::value_type::kName, array);
  });
  if (archive.IsRestoring() && archive.ok() && !AreUsable(elements, node_count))
    archive.Fail("has elements of which no system can be made");
}

double CalcElementEnergy(const ElementArrays& elements, std::span<const Vec3> position) noexcept {
  double energy = 0;
  elements.ForEach([&](const auto& element) {
    energy += CalcElementEnergy(element,
                                GatherPositions(element, [&](std::uint32_t node) { return position[node]; }));
  });
  return energy;
}

void AddElementForces(const ElementArrays& elements, std::span<const Vec3> position,
                      std::span<Vec3> force) noexcept {
  elements.ForEach([&](const auto& element) {
    const auto forces = CalcElementForce(
        element, GatherPositions(element, [&](std::uint32_t node) { return position[node]; }));
    for (std::size_t i = 0; i < forces.size(); ++i) force[element.nodes[i]] += forces[i];
  });
}

NodeElementForce CalcElementForceOn(const ElementArrays& elements, std::span<const Vec3> position,
                                    std::uint32_t node) noexcept {
  NodeElementForce found;
  elements.ForEach([&](const auto& element) {
    if (std::find(element.nodes.begin(), element.nodes.end(), node) == element.nodes.end()) return;
    const auto forces = CalcElementForce(
        element, GatherPositions(element, [&](std::uint32_t other) { return position[other]; }));
    for (std::size_t i = 0; i < forces.size(); ++i) {
      if (element.nodes[i] != node) continue;
      found.sum += forces[i];
      found.largest = math::Max(found.largest, math::Norm(forces[i]));
    }
  });
  return found;
}

double CalcElementBound(const ElementArrays& elements, std::span<const Vec3> position,
                        std::uint32_t node) noexcept {
  double bound = 0;
  elements.ForEach([&](const auto& element) {
    constexpr std::size_t kNodes = std::remove_cvref_t<decltype(element)>::kNodes;
    if (std::find(element.nodes.begin(), element.nodes.end(), node) == element.nodes.end()) return;
    ElementStiffness<kNodes> stiffness;
    AddElementStiffness(element,
                        GatherPositions(element, [&](std::uint32_t other) { return position[other]; }),
                        StiffnessPart::kBound, stiffness);
    for (std::size_t i = 0; i < kNodes; ++i) {
      const StiffnessBlock& own = stiffness.At(i, i);
      if (element.nodes[i] == node) bound += own[0] + own[4] + own[8];
    }
  });
  return bound;
}

double CalcLargestElementStiffness(const ElementArrays& elements, std::span<const Vec3> position) noexcept {
  double sum = 0;
  elements.ForEach([&](const auto& element) {
    constexpr std::size_t kNodes = std::remove_cvref_t<decltype(element)>::kNodes;
    ElementStiffness<kNodes> stiffness;
    AddElementStiffness(element, GatherPositions(element, [&](std::uint32_t node) { return position[node]; }),
                        StiffnessPart::kBound, stiffness);
    for (std::size_t i = 0; i < kNodes; ++i) {
      const StiffnessBlock& own = stiffness.At(i, i);
      sum += own[0] + own[4] + own[8];
    }
  });
  return sum;
}

std::size_t FollowCut(std::span<const PartedNodes> parted, ElementArrays& elements) noexcept {
  std::size_t dropped = 0;
  elements.ForEachKind([&](auto& array) {
    using Kind = typename std::remove_reference_t<decltype(array)>::value_type;
    dropped += std::erase_if(array, [&](const Kind& element) {
      return std::any_of(Kind::kBonds.begin(), Kind::kBonds.end(), [&](const ElementBond& bond) {
        const auto [low, high] = std::minmax(element.nodes[bond[0]], element.nodes[bond[1]]);
        return std::binary_search(parted.begin(), parted.end(), PartedNodes{low, high});
      });
    });
  });
  return dropped;
}

}  // namespace trocar::tissue
