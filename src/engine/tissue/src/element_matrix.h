// SPDX-License-Identifier: Apache-2.0
/// \file element_matrix.h  The stiffness of elements, on the finest level of the multigrid and on coarser ones.
///
/// Elements come and go with every tick, and the links of a LinkMatrix have their places in memory: the stiffness of elements is a
/// sum of small dense matrices beside it. A coarser level adds up the rows and columns of the nodes that an aggregate joins, which
/// is the Galerkin product P^T K P. Coarse links are scaled down because a step is steeper than the slope it stands for; elements
/// join parts at single places, where the step is what happens, and are not. An element within one aggregate vanishes.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels.h"
#include "trocar/math/aligned_vector.h"
#include "trocar/tissue/element_kinds.h"

namespace trocar::tissue {

class ElementMatrix {
 public:
  /// Memory for all elements that a system may have.
  void Reserve();
  void Clear() noexcept;
  bool IsEmpty() const noexcept { return elements_.empty(); }

  /// Adds the stiffness of an element that acts. Rows and columns of held nodes are left out: they do not move.
  /// \param is_free  bool(std::uint32_t node)
  template <std::size_t kCount, typename IsFree>
  void Add(const std::array<std::uint32_t, kCount>& nodes, const ElementStiffness<kCount>& stiffness,
           const IsFree& is_free) noexcept {
    std::array<std::size_t, kCount> places{};
    std::uint32_t count = 0;
    double trace = 0;
    for (std::size_t i = 0; i < kCount; ++i) trace += CalcTrace(stiffness.At(i, i));
    if (trace == 0.0) return;  // it does not act
    const auto first_node = static_cast<std::uint32_t>(nodes_.size());
    const auto first_block = static_cast<std::uint32_t>(blocks_.size());
    for (std::size_t i = 0; i < kCount; ++i) {
      if (!is_free(nodes[i])) continue;
      places[count++] = i;
      nodes_.push_back(nodes[i]);
    }
    if (count == 0) return;
    for (std::uint32_t i = 0; i < count; ++i) {
      for (std::uint32_t j = i; j < count; ++j) blocks_.push_back(stiffness.At(places[i], places[j]));
    }
    elements_.push_back({first_node, first_block, count});
  }
  /// Makes `coarse` the sum over aggregates. \param aggregate  (nodes) node of the coarser level, or Aggregation::kNone
  void Coarsen(std::span<const std::uint32_t> aggregate, ElementMatrix& coarse) const noexcept;

  /// out += K x
  void AddProduct(const Float4* x, Float4* out) const noexcept;
  /// Calls visit(i, j, block) for each block K_ij of i <= j of each element, node indices.
  template <typename Visit>
  void ForEachBlock(const Visit& visit) const {
    for (const Element& element : elements_) {
      std::uint32_t at = element.first_block;
      for (std::uint32_t i = 0; i < element.count; ++i) {
        for (std::uint32_t j = i; j < element.count; ++j, ++at)
          visit(nodes_[element.first_node + i], nodes_[element.first_node + j], i == j, blocks_[at]);
      }
    }
  }
  /// Nodes with an element, each as often as it has one.
  std::span<const std::uint32_t> Nodes() const noexcept { return nodes_; }
  /// Calls visit(node, own) with a share of a block-diagonal bound: K <= 2 x the sum of these, as springs have it, and no block
  /// below the node's own.
  ///
  /// With s_i = sqrt(x_i . K_ii x_i), x . K x <= (sum s_i)^2 <= sum_j c_j sum_i s_i^2 / c_i for any c > 0: c_i the root of K_ii's
  /// trace is best for matrices of rank one, such as contacts.
  template <typename Visit>
  void ForEachBound(const Visit& visit) const {
    for (const Element& element : elements_) {
      std::array<double, kMaxElementNodes> root{};
      double sum = 0;
      std::uint32_t at = element.first_block;
      for (std::uint32_t i = 0; i < element.count; at += element.count - i, ++i) {
        root[i] = std::sqrt(math::Max(0.0, CalcTrace(blocks_[at])));
        sum += root[i];
      }
      at = element.first_block;
      for (std::uint32_t i = 0; i < element.count; at += element.count - i, ++i) {
        if (!(root[i] > 0.0)) continue;
        const double factor = math::Max(1.0, 0.5 * sum / root[i]);
        const StiffnessBlock& own = blocks_[at];
        visit(nodes_[element.first_node + i],
              std::array<double, 6>{factor * own[0], factor * own[1], factor * own[2], factor * own[4],
                                    factor * own[5], factor * own[8]});
      }
    }
  }

 private:
  struct Element {
    std::uint32_t first_node, first_block, count;
  };
  static double CalcTrace(const StiffnessBlock& block) noexcept { return block[0] + block[4] + block[8]; }

  std::vector<Element> elements_;
  std::vector<std::uint32_t> nodes_;
  std::vector<StiffnessBlock> blocks_;  // of each element, the upper triangle row by row [N/m]
};

/// Makes `matrix` the stiffness of the elements at some positions.
/// \param position_at  math::Vec3(std::uint32_t node)
/// \param is_free      bool(std::uint32_t node)
template <typename PositionAt, typename IsFree>
void SetElementMatrix(const ElementArrays& elements, const PositionAt& position_at, StiffnessPart part,
                      const IsFree& is_free, ElementMatrix& matrix) noexcept {
  matrix.Clear();
  elements.ForEach([&](const auto& element) {
    ElementStiffness<std::remove_cvref_t<decltype(element)>::kNodes> stiffness;
    AddElementStiffness(element, GatherPositions(element, position_at), part, stiffness);
    matrix.Add(element.nodes, stiffness, is_free);
  });
}

/// The elements of one level of the multigrid. The level's own diagonal holds the bound of their firm stiffness, for the
/// smoothers; products take the difference into account.
class LevelElements {
 public:
  void Reserve();
  /// None, where the level's diagonal knows of none.
  void Clear() noexcept;
  bool IsEmpty() const noexcept { return firm_.IsEmpty(); }

  ElementMatrix& Firm() noexcept { return firm_; }
  const ElementMatrix& Firm() const noexcept { return firm_; }

  /// Adds the bound of Firm() to a level's diagonal excess.
  void AddDiagonal(math::AlignedVector<float>& diagonal_excess) noexcept;
  /// Puts the diagonal back to what it was before AddDiagonal(), and clears.
  void RemoveDiagonal(math::AlignedVector<float>& diagonal_excess) noexcept;
  /// The diagonal without the elements, and with them again.
  void SwapDiagonal(math::AlignedVector<float>& diagonal_excess) noexcept;

  /// out += (matrix - what of it the diagonal has) x: completes a pass over the level.
  void CompleteProduct(const ElementMatrix& matrix, const Float4* x, Float4* out) const noexcept;
  /// Calls visit(node, own) with what the diagonal has of the elements: xx, xy, xz, yy, yz, zz [N/m].
  template <typename Visit>
  void ForEachOwn(const Visit& visit) const {
    for (std::size_t t = 0; t < touched_.size(); ++t) visit(touched_[t], own_[t]);
  }
  /// Nodes with elements, each once.
  std::span<const std::uint32_t> Touched() const noexcept { return touched_; }

 private:
  ElementMatrix firm_;
  std::vector<std::uint32_t> touched_;          // ascending
  std::vector<std::array<double, 6>> own_;      // (touched) what the diagonal has of the elements [N/m]
  std::vector<std::array<float, 6>> replaced_;  // (touched) the diagonal excess without them, or with them
};

}  // namespace trocar::tissue
