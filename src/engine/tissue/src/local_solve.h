// SPDX-License-Identifier: Apache-2.0
/// \file local_solve.h  Nonlinear elimination: the few nodes that snap through are brought to rest by a solve of their own.
///
/// In a snap-through a dozen nodes of the built-in patient move far, in many short steps, and all others hardly move: the
/// strong nonlinearity is local. After each Newton step of the whole the nodes that went farthest, and
/// those around them, are solved with all others held, which costs little because they are few; the next step of the
/// whole begins where they have come to rest. Source: Cai and Li, "Inexact Newton methods with restricted additive
/// Schwarz based nonlinear elimination for problems with high local nonlinearity", SIAM J. Sci. Comput. 33, 2011.
#pragma once

#include <span>
#include <vector>

#include "linearisation.h"
#include "truncated_conjugate_gradients.h"

namespace trocar::tissue {

/// A small model of its own: nodes that move, and the neighbours that hold them.
class LocalSolve {
 public:
  /// Most nodes that move.
  static constexpr std::uint32_t kMaxFree = 256;

  struct Report {
    int steps = 0;
    double longest = 0;               ///< farthest that a node went [m]
    double smallest_ritz = INFINITY;  ///< see SmallestRitz; of block Jacobi as the preconditioner
  };

  /// \param whole, springs  must outlive this
  LocalSolve(const OrderedModel& whole, const OrderedSprings& springs);
  /// Takes another model with as many nodes.
  void SetModel(const OrderedModel& whole) noexcept { whole_ = &whole; }
  LocalSolve(const LocalSolve&) = delete;  // parts point at each other
  LocalSolve& operator=(const LocalSolve&) = delete;

  /// Gathers the nodes that a step moved farthest, and those around them.
  ///
  /// \param load     of the whole, with what is intact of its strands
  /// \param step     (padded nodes of the whole) [m]
  /// \param longest  of the step [m], > 0
  /// \return false where they are more than the capacity, the step then being no local matter, or none
  /// \note Real-time safe.
  bool Gather(const OrderedLoad& load, std::span<const std::uint8_t> strand_is_intact,
              std::span<const Float4> step, double longest) noexcept;
  /// Nodes of the last Gather() that move, as the whole numbers them.
  std::span<const std::uint32_t> Free() const { return std::span(nodes_).first(free_count_); }
  /// Adds factor times each node's vector to the load [N].
  /// \note Real-time safe.
  void AddForce(std::span<const Float4> force, double factor) noexcept;

  /// Brings the gathered nodes near rest by Newton's method; all others stay.
  ///
  /// \param tolerance    error that may be left [m]
  /// \param edge_length  mean length of a spring [m]
  /// \param position     (padded nodes of the whole) [m]
  /// \note Real-time safe.
  Report Solve(const Kernels& kernels, Workers& workers, double tolerance, double edge_length,
               std::span<Double4> position) noexcept;
  /// Puts the nodes back to where they were before Solve().
  void TakeBack(std::span<Double4> position) const noexcept;

 private:
  /// All nodes, those that hold others too.
  static constexpr std::uint32_t kMaxNodes = 1024;
  static constexpr std::uint32_t kMaxRow = 32;  // links of a node, in the mean
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  bool AddNode(std::uint32_t node) noexcept;
  bool FindNodes(const OrderedLoad& load, std::span<const Float4> step, double longest) noexcept;
  bool SetLinks() noexcept;
  void SetStrands(std::span<const std::uint8_t> strand_is_intact) noexcept;
  void SetLoad(const OrderedLoad& load) noexcept;
  bool IsFree(std::uint32_t local) const { return local < free_count_; }

  const OrderedModel* whole_;
  const OrderedSprings* whole_springs_;
  std::vector<std::uint32_t> nodes_;  // as the whole numbers them: those that move, then those that hold them
  std::vector<std::uint32_t> local_of_;  // (nodes of the whole) place in nodes_, or kNone
  std::uint32_t free_count_ = 0;
  std::vector<std::size_t> whole_entries_;  // (links of model_.graph) place in the whole
  OrderedModel model_;
  OrderedSprings springs_;
  OrderedLoad load_;
  std::span<const std::uint8_t> strand_is_intact_;
  LinkLevel level_;
  Linearisation linearisation_;
  Balance balance_;
  math::AlignedVector<Double4> position_, start_, first_;  // (padded)
  math::AlignedVector<Float4> step_, r_, z_, p_, q_;       // (padded)
};

}  // namespace trocar::tissue
