// SPDX-License-Identifier: Apache-2.0
/// \file link_hierarchy.h  Algebraic multigrid for systems of springs: an approximate inverse of their
/// stiffness.
///
/// Nodes are joined along their stiffest links into aggregates, aggregates into larger ones, and so on. What
/// an aggregate's nodes share is their translation, so the sum of the links between two aggregates is again a
/// link with a symmetric 3 x 3 stiffness: every level is a LinkMatrix. A step of a coarse function is steeper
/// than the slope it stands for, which makes coarse links too stiff; they are scaled down instead of
/// smoothing the prolongation, which would fill the coarse matrices. On the finest level chains of nodes are
/// solved directly (line_smoother.h). Sources: Notay, "An aggregation-based
/// algebraic multigrid method", ETNA 37, 2010 (pairwise aggregation); Braess, "Towards algebraic multigrid
/// for elliptic problems of second order", Computing 55, 1995 (scaling).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "aggregation.h"
#include "aligned_vector.h"
#include "line_smoother.h"
#include "slice_layout.h"
#include "symmetric3.h"
#include "workers.h"

namespace trocar::tissue {

/// A link between two aggregates and the coarse link that it is part of, in the row of the lower one.
struct CoarsenedLink {
  std::uint32_t entry, coarse_entry;
  std::uint32_t node;  // whose row `entry` is in
};

/// One level's matrix, its transfer to the next, and the vectors of a cycle.
struct LinkLevel {
  SliceLayout layout;
  AlignedVector<float> off_diagonal, diagonal_excess, inverse, is_free;  // as in LinkMatrix
  std::vector<std::uint32_t> aggregate;               // (n) node of the next level, or Aggregation::kNone
  std::vector<std::uint32_t> member_starts, members;  // nodes of each aggregate
  /// Links that the next level gathers, in the order in which they lie in memory; chunk c of its slices gathers those from
  /// coarsened_starts[c] on.
  std::vector<CoarsenedLink> coarsened;
  std::vector<std::uint32_t> coarsened_starts;  // (chunks of the next level + 1)
  /// (entries) of a level that gathers: the link in its other node's row where that is the lower one, or kNoEntry.
  std::vector<std::uint32_t> mirror_entry;
  std::vector<std::uint8_t> near_held;  // (n) held, or next to one that is
  AlignedVector<Float4> x, b, r;        // (padded nodes)

  std::uint32_t Size() const { return layout.node_count; }
  LinkMatrix Matrix() const;
  void SetGraph(const NodeGraph& graph);
  void Reserve(std::size_t nodes, std::size_t steps);
};

/// The level's pass over all nodes, in chunks of fixed size.
///
/// \param follower  as in LinkMatrix, or null
void RunPass(const Kernels& kernels, Workers& workers, const LinkLevel& level, LinkPass pass, const Float4* x,
             const Float4* b, float factor, Float4* out, const float* follower = nullptr) noexcept;

class LinkHierarchy {
 public:
  /// \param graph      of the finest level, in its order
  /// \param stiffness  (graph.others) what joins nodes into aggregates, >= 0
  LinkHierarchy(const NodeGraph& graph, std::span<const double> stiffness);
  /// The same for another graph.
  /// \note Allocates nothing where Reserve() was enough.
  void SetGraph(const NodeGraph& graph, std::span<const double> stiffness);
  /// Capacity for `share` times more nodes and links than there are.
  void Reserve(double share);

  /// Matrix of the finest level: off_diagonal, diagonal_excess and is_free are the caller's to fill.
  LinkLevel& Finest() { return levels_.front(); }
  const LinkLevel& Finest() const { return levels_.front(); }
  std::span<const LinkLevel> Levels() const { return std::span(levels_).first(level_count_); }

  /// Computes all coarser levels. Links may be indefinite where springs are compressed; here they count as
  /// shift. The finest level, its inverse blocks included, is the caller's.
  ///
  /// \param shift  (entries) what is to be added to each finest link's stiffness, in every direction [N/m]
  /// \note Real-time safe.
  void UpdateCoarse(const Kernels& kernels, Workers& workers, std::span<const float> shift) noexcept;
  /// Follows a change of the finest level without the coarser ones.
  /// \note Real-time safe.
  void UpdateLineSmoother(std::span<const float> shift) noexcept {
    line_smoother_.Factorise(levels_.front(), shift);
  }

  /// x = about K^-1 b, a V-cycle with one damped block-Jacobi step on either side: symmetric and, where the
  /// matrix is, positive definite. Held nodes get 0.
  /// \note Real-time safe.
  void Apply(const Kernels& kernels, Workers& workers, const Float4* b, Float4* x) noexcept;

 private:
  /// x = about K^-1 b on the level.
  void Cycle(const Kernels& kernels, Workers& workers, std::size_t at, const Float4* b, Float4* x) noexcept;
  void Smooth(const Kernels& kernels, Workers& workers, std::size_t at, const Float4* from, const Float4* b,
              Float4* x) noexcept;
  void Coarsen(Workers& workers, std::size_t at, std::span<const float> shift) noexcept;
  void GatherDiagonal(std::size_t at, std::uint32_t aggregate, std::span<const float> shift) noexcept;
  void InvertCoarsest() noexcept;
  void SolveCoarsest(const Float4* b, Float4* x) const noexcept;

  LinkLevel& Coarsest() { return levels_[level_count_ - 1]; }
  const LinkLevel& Coarsest() const { return levels_[level_count_ - 1]; }
  void FillTransfer(const NodeGraph& fine, const NodeGraph& coarse, std::size_t at);

  std::vector<LinkLevel> levels_;  // the first level_count_ are in use
  std::size_t level_count_ = 0;
  LineSmoother line_smoother_;
  // workspace of SetGraph
  Aggregation aggregation_;
  LinkGraph fine_;
  std::vector<std::uint32_t> places_, counts_, coarse_entry_;
  std::vector<double> factor_, rows_;  // workspace of the inversion of the coarsest level, dense
  std::vector<float> inverse_;         // of the coarsest level; empty where that is too large
  bool is_inverted_ = false;
};

}  // namespace trocar::tissue
