// SPDX-License-Identifier: Apache-2.0
/// \file element_kinds.h  The list of all kinds of elements, and one array for each of them.
///
/// A new kind is one file of its own and one name at the end of this one.
#pragma once

#include <algorithm>
#include <span>
#include <tuple>
#include <vector>

#include "trocar/tissue/element.h"
#include "trocar/tissue/link_elements.h"
#include "trocar/tissue/sliding_constraint.h"
#include "trocar/tissue/surface_contact.h"

namespace trocar::tissue {

template <ElementKind... Kinds>
class ElementArraysOf {
 public:
  /// Most elements of all kinds together, their nodes and their blocks.
  static constexpr std::size_t kElementCapacity = (Kinds::kCapacity + ...);
  static constexpr std::size_t kNodeCapacity = ((Kinds::kCapacity * Kinds::kNodes) + ...);
  static constexpr std::size_t kBlockCapacity =
      ((Kinds::kCapacity * Kinds::kNodes * (Kinds::kNodes + 1) / 2) + ...);
  /// List<Kinds...>, such as ::testing::Types.
  template <template <typename...> class List>
  using Apply = List<Kinds...>;

  template <typename Kind>
  std::vector<Kind>& Of() noexcept {
    return std::get<std::vector<Kind>>(arrays_);
  }
  template <typename Kind>
  const std::vector<Kind>& Of() const noexcept {
    return std::get<std::vector<Kind>>(arrays_);
  }
  /// Calls visit(std::vector<Kind>&) for each kind.
  template <typename Visit>
  void ForEachKind(const Visit& visit) {
    std::apply([&](auto&... arrays) { (visit(arrays), ...); }, arrays_);
  }
  template <typename Visit>
  void ForEachKind(const Visit& visit) const {
    std::apply([&](const auto&... arrays) { (visit(arrays), ...); }, arrays_);
  }
  /// Calls visit(Kind&) for each element, kind after kind.
  template <typename Visit>
  void ForEach(const Visit& visit) {
    ForEachKind([&](auto& array) {
      for (auto& element : array) visit(element);
    });
  }
  template <typename Visit>
  void ForEach(const Visit& visit) const {
    ForEachKind([&](const auto& array) {
      for (const auto& element : array) visit(element);
    });
  }

  bool IsEmpty() const noexcept {
    return std::apply([](const auto&... arrays) { return (arrays.empty() && ...); }, arrays_);
  }
  /// No element; the arrays keep their memory.
  void Clear() noexcept {
    ForEachKind([](auto& array) { array.clear(); });
  }
  /// Memory for as many elements of each kind as its capacity says.
  void Reserve() { (Of<Kinds>().reserve(Kinds::kCapacity), ...); }
  bool FitsCapacity() const noexcept { return ((Of<Kinds>().size() <= Kinds::kCapacity) && ...); }

 private:
  std::tuple<std::vector<Kinds>...> arrays_;
};

/// The elements of a system, one array for each kind. Persistent ones belong to the state of who makes them; a TissueLoad only
/// views them.
class ElementArrays : public ElementArraysOf<SpringElement, StrandElement, AnchorElement, ContactSpring,
                                             SurfaceContact, SlidingConstraint> {};

/// Whether a load has any element.
inline bool HasElements(const TissueLoad& load) noexcept {
  return load.elements != nullptr && !load.elements->IsEmpty();
}

/// Whether every element is usable, within the capacity of its kind, and on nodes of a system of so many.
bool AreUsable(const ElementArrays& elements, std::size_t node_count) noexcept;

/// Saves, restores and hashes elements that last from tick to tick.
/// \param node_count  of the system; restoring refuses elements that are not usable in it
void VisitState(base::StateArchive& archive, ElementArrays& elements, std::size_t node_count);

/// Energy of all elements [J].
double CalcElementEnergy(const ElementArrays& elements, std::span<const math::Vec3> position) noexcept;
/// Adds the force of every element to its nodes. \param[in,out] force  (n) [N]
void AddElementForces(const ElementArrays& elements, std::span<const math::Vec3> position,
                      std::span<math::Vec3> force) noexcept;

/// Force of all elements on one node, and the largest of a single one [N].
struct NodeElementForce {
  math::Vec3 sum;
  double largest = 0;
};
/// \note Looks at every element: for references and single nodes.
NodeElementForce CalcElementForceOn(const ElementArrays& elements, std::span<const math::Vec3> position,
                                    std::uint32_t node) noexcept;

/// Stiffness that bounds what a node feels of the elements while all others stay, whether or not they act now [N/m].
/// \note Looks at every element, as CalcElementForceOn.
double CalcElementBound(const ElementArrays& elements, std::span<const math::Vec3> position,
                        std::uint32_t node) noexcept;

/// Sum of the elements' largest eigenvalues, each bounded by the trace of its stiffness as though it acted [N/m].
double CalcLargestElementStiffness(const ElementArrays& elements,
                                   std::span<const math::Vec3> position) noexcept;

/// Two nodes that a cut has parted, the lower one first.
using PartedNodes = std::array<std::uint32_t, 2>;
/// After a cut: drops the elements of which a bond is parted. Nodes are never renumbered; all others stay as they are.
/// \param parted  ascending
/// \return how many were dropped
std::size_t FollowCut(std::span<const PartedNodes> parted, ElementArrays& elements) noexcept;

}  // namespace trocar::tissue
