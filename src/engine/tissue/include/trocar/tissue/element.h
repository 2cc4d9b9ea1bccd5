// SPDX-License-Identifier: Apache-2.0
/// \file element.h  Elements: terms of the energy over a few nodes each, every kind behind one interface.
///
/// A kind of element is a plain struct in a file of its own, with free functions for energy, force and stiffness over the
/// positions of its nodes. All that solvers do with it follows from these: the balance, the product with the stiffness, the
/// coarse levels of the multigrid, the bound of the smoother, the estimate of the error, saving and restoring, and what a cut
/// leaves of it. The kinds that exist stand in element_kinds.h. docs/elements.md says how one is added.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include "trocar/math/vector.h"

namespace trocar::base {
class StateArchive;
}

namespace trocar::tissue {

/// Most nodes of one element.
inline constexpr std::size_t kMaxElementNodes = 5;

/// Positions [m] of an element's nodes, or the forces on them [N].
template <std::size_t kCount>
using ElementVectors = std::array<math::Vec3, kCount>;

/// A 3 x 3 matrix, row by row.
using StiffnessBlock = std::array<double, 9>;

/// block += scale a b^T
inline void AddOuterProduct(StiffnessBlock& block, const math::Vec3& a, const math::Vec3& b,
                            double scale) noexcept {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      block[static_cast<std::size_t>(3 * row + column)] += scale * a[row] * b[column];
  }
}
/// block += scale I
inline void AddIdentity(StiffnessBlock& block, double scale) noexcept {
  block[0] += scale, block[4] += scale, block[8] += scale;
}

/// Stiffness of one element, symmetric: the blocks K_ij = d2E / dx_i dx_j of i <= j [N/m].
template <std::size_t kCount>
struct ElementStiffness {
  std::array<StiffnessBlock, kCount*(kCount + 1) / 2> blocks{};

  /// \pre i <= j < kCount
  static constexpr std::size_t Index(std::size_t i, std::size_t j) noexcept {
    return i * kCount - i * (i + 1) / 2 + j;
  }
  StiffnessBlock& At(std::size_t i, std::size_t j) noexcept { return blocks[Index(i, j)]; }
  const StiffnessBlock& At(std::size_t i, std::size_t j) const noexcept { return blocks[Index(i, j)]; }
};

/// Which stiffness of an element is asked for.
enum class StiffnessPart : std::uint8_t {
  kWhole,  ///< the derivative of the force, negative parts included: products of Newton's method
  kFirm,   ///< without what softens it, positive semidefinite: the preconditioner
  /// A bound of the firm stiffness wherever the nodes move to, as though a one-sided element acted: steps of solvers that keep
  /// one matrix while contacts open and close.
  kBound
};

/// Motions of all nodes together that leave the energy of every element of a kind as it is.
enum class ElementInvariance : std::uint8_t {
  kNone,    ///< the element is tied to space
  kShifts,  ///< its forces sum to zero
  kMotions  ///< and so do their torques
};

/// A kind of element.
///
/// - `kName`: of its array in a saved state; a literal that no other kind has.
/// - `kNodes`: nodes of one element, 1 to kMaxElementNodes. `nodes`: their indices.
/// - `kCapacity`: most elements of the kind in one system; memory is set aside for so many.
/// - `kInvariance`: see there.
/// - `kBonds`: pairs of places in `nodes` that belong to one piece. A cut that parts such a pair ends the element.
/// - `CalcElementEnergy`: E(x) [J], once continuously differentiable.
/// - `CalcElementForce`: -dE/dx of each node [N].
/// - `AddElementStiffness`: adds a stiffness; of the elements that do not act, nothing but the bound.
/// - `IsElementUsable`: whether its numbers are finite and in range.
/// - `VisitState`: its fields, for elements that last from tick to tick.
///
/// The functions are real-time safe and pure.
template <typename Kind>
concept ElementKind = std::is_trivially_copyable_v<Kind> && std::default_initializable<Kind> &&
                      (Kind::kNodes >= 1) &&
                      (Kind::kNodes <= kMaxElementNodes) && (Kind::kCapacity >= 1) &&
                      requires(Kind& element, const Kind& constant,
                               const ElementVectors<Kind::kNodes>& position,
                               ElementStiffness<Kind::kNodes>& stiffness, base::StateArchive& archive) {
  { Kind::kName } -> std::convertible_to<std::string_view>;
  { Kind::kInvariance } -> std::convertible_to<ElementInvariance>;
  { Kind::kBonds.size() } -> std::convertible_to<std::size_t>;
  { element.nodes } -> std::same_as<std::array<std::uint32_t, Kind::kNodes>&>;
  { CalcElementEnergy(constant, position) }
  noexcept->std::same_as<double>;
  { CalcElementForce(constant, position) }
  noexcept->std::same_as<ElementVectors<Kind::kNodes>>;
  { AddElementStiffness(constant, position, StiffnessPart::kFirm, stiffness) }
  noexcept;
  { IsElementUsable(constant) }
  noexcept->std::same_as<bool>;
  {VisitState(archive, element)};
};

/// Two places in an element's `nodes`.
using ElementBond = std::array<std::size_t, 2>;

/// Positions of an element's nodes. \param position_at  math::Vec3(std::uint32_t node)
template <typename Kind, typename PositionAt>
ElementVectors<Kind::kNodes> GatherPositions(const Kind& element, const PositionAt& position_at) noexcept {
  ElementVectors<Kind::kNodes> position;
  for (std::size_t i = 0; i < Kind::kNodes; ++i) position[i] = position_at(element.nodes[i]);
  return position;
}

}  // namespace trocar::tissue
