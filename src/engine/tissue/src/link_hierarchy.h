// SPDX-License-Identifier: Apache-2.0
/// \file link_hierarchy.h  Algebraic multigrid for systems of springs: an approximate inverse of their
/// stiffness.
///
/// The nodes of an aggregate (hierarchy_topology.h) share only their translation, so the sum of the links between two
/// aggregates is again a link with a symmetric 3 x 3 stiffness: every level is a LinkMatrix. A step of a coarse function is
/// steeper than the slope it stands for, which makes coarse links too stiff; they are scaled down instead of smoothing the
/// prolongation, which would fill the coarse matrices. On the finest level chains of nodes are solved directly
/// (line_smoother.h). Source: Braess, "Towards algebraic multigrid for elliptic problems of second order", Computing 55,
/// 1995 (scaling).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "element_matrix.h"
#include "hierarchy_topology.h"
#include "line_smoother.h"
#include "slice_layout.h"
#include "trocar/math/aligned_vector.h"
#include "trocar/math/symmetric3.h"
#include "workers.h"

namespace trocar::tissue {

/// One level's matrix and the vectors of a cycle.
struct LinkLevel {
  const SliceLayout* layout = nullptr;
  math::AlignedVector<float> links, diagonal_excess, inverse, is_free;  // as in LinkMatrix
  std::size_t link_floats = kBlockFloats;
  std::vector<std::uint8_t> near_held;  // (n) held, or next to one that is
  math::AlignedVector<Float4> x, b, r;  // (padded nodes)
  LevelElements elements;

  std::uint32_t Size() const { return layout->node_count; }
  LinkMatrix Matrix() const;
  /// S of an entry as a block. \param is_firm  leaves out the negative stiffness of a compressed spring across its axis
  std::array<float, 6> Link(std::size_t entry, bool is_firm = false) const noexcept {
    const float* const from =
        links.data() + entry / kSliceNodes * link_floats * kSliceNodes + entry % kSliceNodes;
    const auto at = [from](std::size_t value) { return from[value * kSliceNodes]; };
    if (link_floats == kBlockFloats) return {at(0), at(1), at(2), at(3), at(4), at(5)};
    const float a = is_firm ? std::max(at(0), 0.0f) : at(0);
    return {a + at(1) * at(1), at(1) * at(2), at(1) * at(3),
            a + at(2) * at(2), at(2) * at(3), a + at(3) * at(3)};
  }
  /// \param of  must outlive this
  void SetLayout(const SliceLayout& of);
  void Reserve(const LevelCapacity& capacity);
};

/// The level's pass over all nodes, in chunks of fixed size.
///
/// \param follower  as in LinkMatrix, or null
void RunPass(const Kernels& kernels, Workers& workers, const LinkLevel& level, LinkPass pass, const Float4* x,
             const Float4* b, float factor, Float4* out, const float* follower = nullptr) noexcept;

class LinkHierarchy {
 public:
  /// \param topology, graph  its levels, and the links of the finest, in its order; must outlive this
  /// \param spare_share      capacity for so many times more nodes and links
  LinkHierarchy(const HierarchyTopology& topology, const NodeGraph& graph, double spare_share = 0);
  /// Goes on with other levels.
  /// \note Allocates nothing where the spare share was enough.
  void SetTopology(const HierarchyTopology& topology, const NodeGraph& graph);

  /// Matrix of the finest level, of springs: links, diagonal_excess and is_free are the caller's to fill.
  LinkLevel& Finest() { return levels_.front(); }
  const LinkLevel& Finest() const { return levels_.front(); }
  std::span<const LinkLevel> Levels() const { return std::span(levels_).first(topology_->level_count); }

  /// Computes all coarser levels, without what softens compressed springs across: such links may be indefinite. The finest
  /// level, its inverse blocks included, is the caller's.
  /// \note Real-time safe.
  void UpdateCoarse(const Kernels& kernels, Workers& workers) noexcept;
  /// True where other elements act on the finest level than the coarser ones have.
  bool HasNewElements() const noexcept {
    return !std::ranges::equal(levels_.front().elements.Firm().Nodes(), coarsened_nodes_);
  }
  /// Follows a change of the finest level without the coarser ones.
  /// \note Real-time safe.
  void UpdateLineSmoother() noexcept { line_smoother_.Factorise(levels_.front()); }

  /// x = about K^-1 b, a V-cycle with one damped block-Jacobi step on either side: symmetric and, where the
  /// matrix is, positive definite. Held nodes get 0.
  /// \note Real-time safe.
  void Apply(const Kernels& kernels, Workers& workers, const Float4* b, Float4* x) noexcept;

 private:
  /// x = about K^-1 b on the level.
  void Cycle(const Kernels& kernels, Workers& workers, std::size_t at, const Float4* b, Float4* x) noexcept;
  void Smooth(const Kernels& kernels, Workers& workers, std::size_t at, const Float4* from, const Float4* b,
              Float4* x) noexcept;
  /// b less what the elements do that a pass over the level leaves out.
  const Float4* LessElements(const LinkLevel& level, const Float4* from, const Float4* b) noexcept;
  void Coarsen(Workers& workers, std::size_t at) noexcept;
  void GatherDiagonal(std::size_t at, std::uint32_t aggregate) noexcept;
  void InvertCoarsest() noexcept;
  void SolveCoarsest(const Float4* b, Float4* x) const noexcept;

  LinkLevel& Coarsest() { return levels_[topology_->level_count - 1]; }
  const LinkLevel& Coarsest() const { return levels_[topology_->level_count - 1]; }

  const HierarchyTopology* topology_ = nullptr;
  std::vector<LinkLevel> levels_;  // as many as the topology's are in use
  LineSmoother line_smoother_;
  math::AlignedVector<Float4> less_elements_;   // (padded nodes of the finest level)
  std::vector<std::uint32_t> coarsened_nodes_;  // of the elements that the coarser levels have
  std::vector<double> factor_, rows_;           // workspace of the inversion of the coarsest level, dense
  std::vector<float> inverse_;                  // of the coarsest level; empty where that is too large
  bool is_inverted_ = false;
};

}  // namespace trocar::tissue
