// SPDX-License-Identifier: Apache-2.0
/// \file line_smoother.h  Line smoother of the multigrid: ducts and vessels, chains of nodes, are solved directly.
///
/// A chain of nodes is stiff along and hardly held across: a thousand to one in the built-in patient. Damped
/// Jacobi and coarse levels made of translations leave its bending for the conjugate gradients, and a
/// preconditioned residual then shows a fortieth of the error. But a chain's matrix is narrow, so that its
/// Cholesky factor costs less than one pass over all nodes (line relaxation: Trottenberg, Oosterlee, Schueller,
/// "Multigrid", 2001, section 5.1).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels.h"
#include "slice_layout.h"

namespace trocar::tissue {

struct LinkLevel;

class LineSmoother {
 public:
  LineSmoother() = default;
  /// Finds the chains: connected nodes with few neighbours whose matrix is narrow.
  /// \param graph  of the finest level
  LineSmoother(const NodeGraph& graph, const SliceLayout& layout) { SetGraph(graph, layout); }
  /// Finds the chains of another graph.
  /// \note Allocates nothing where Reserve() was enough.
  void SetGraph(const NodeGraph& graph, const SliceLayout& layout);
  void Reserve(double share);

  std::span<const std::uint32_t> Nodes() const { return nodes_; }

  /// Factorises the chains' own part of the matrix; with firm links (LinkLevel::Link) where it is not positive definite.
  /// \note Real-time safe.
  void Factorise(const LinkLevel& level) noexcept;

  /// K_chains^-1 (b - K from) on the chains' nodes, for Add(): beside a pass over all nodes that leaves `from` alone.
  ///
  /// \param from  (n) nullptr for zero
  /// \note Real-time safe.
  void Solve(const LinkLevel& level, const Float4* from, const Float4* b) noexcept;
  /// x = (from +) factor times what Solve() found on the chains' nodes; other nodes keep theirs.
  /// \note Real-time safe.
  void Add(const Float4* from, float factor, Float4* x) const noexcept;

 private:
  struct Link {
    std::uint32_t row, column;  // places in nodes_, row > column
    std::uint32_t entry;
  };
  void OrderChain(const NodeGraph& graph, std::uint32_t root, std::uint32_t round);
  bool FactoriseOnce(const LinkLevel& level, bool is_firm) noexcept;
  double& At(std::size_t row, std::size_t column) { return factor_[row_starts_[row] + column - first_[row]]; }

  std::vector<std::uint32_t> nodes_;  // in the order of elimination
  std::vector<Link> links_;           // between them
  // three unknowns a node; rows of the factor from their first column to the diagonal
  std::vector<std::uint32_t> first_;
  std::vector<std::size_t> row_starts_;
  std::vector<double> factor_,
      whole_;                   // workspace of Factorise; the latter for the diagonal before elimination
  std::vector<float> lower_;    // the factor, with the inverses of its diagonal
  std::vector<float> columns_;  // the same below its diagonal, column by column
  std::vector<std::size_t> column_starts_;
  std::vector<float> values_;  // (3 nodes)
  bool is_factorised_ = false;
  // workspace of SetGraph
  std::vector<std::uint8_t> is_candidate_;    // (n)
  std::vector<std::uint32_t> place_, marks_;  // (n)
  std::vector<std::uint32_t> chain_;          // the one that was found last
};

}  // namespace trocar::tissue
