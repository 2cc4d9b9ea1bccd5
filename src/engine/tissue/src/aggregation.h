// SPDX-License-Identifier: Apache-2.0
/// \file aggregation.h  Joins the nodes of a graph into aggregates along their stiffest links.
/// Source: Notay, "An aggregation-based algebraic multigrid method", ETNA 37, 2010 (pairwise aggregation).
#pragma once

#include <cstdint>
#include <vector>

#include "slice_layout.h"

namespace trocar::tissue {

/// A graph and how stiff its links are.
struct LinkGraph {
  NodeGraph graph;
  std::vector<double> stiffness;  // (graph.others) >= 0

  void Reserve(std::size_t nodes, std::size_t links);
};

class Aggregation {
 public:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  /// Joins each node with the unjoined neighbour that it is most stiffly linked to, again and again.
  ///
  /// \param pairings  >= 1; an aggregate has at most 2^pairings nodes
  /// \note Allocates nothing where Reserve() was enough.
  void Join(const LinkGraph& fine, int pairings);
  /// (n) each node's aggregate, numbered in order of first appearance; kNone for a node without links, which no coarser
  /// level can help.
  const std::vector<std::uint32_t>& Aggregate() const { return aggregate_; }
  /// Graph of the aggregates, with the sums of their links; rows in ascending order.
  LinkGraph& Coarse() { return coarse_; }

  /// Nodes of each aggregate, in ascending order: those of a are members[starts[a]] to members[starts[a + 1]].
  static void ListMembers(const std::vector<std::uint32_t>& aggregate, std::uint32_t count,
                          std::vector<std::uint32_t>& starts, std::vector<std::uint32_t>& members);

  void Reserve(std::size_t nodes, std::size_t links);

 private:
  std::uint32_t JoinPairs(const LinkGraph& from, bool keeps_single);
  void MakeQuotient(const LinkGraph& from, std::uint32_t count, LinkGraph& to);

  std::vector<std::uint32_t> aggregate_, pairs_;  // (n)
  LinkGraph coarse_, halfway_;
  std::vector<std::uint32_t> starts_, members_;  // of the pairs
  std::vector<std::uint32_t> places_;            // (pairs) of the link in the present row
};

}  // namespace trocar::tissue
