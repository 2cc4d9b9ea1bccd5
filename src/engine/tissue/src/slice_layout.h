// SPDX-License-Identifier: Apache-2.0
/// \file slice_layout.h  Order of the nodes in memory, and their neighbours in slices.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels.h"

namespace trocar::tissue {

/// Neighbours of each node: those of node i are others[starts[i]] to others[starts[i + 1]].
struct NodeGraph {
  std::vector<std::uint32_t> starts{0};  // (n + 1)
  std::vector<std::uint32_t> others;

  std::uint32_t Size() const { return static_cast<std::uint32_t>(starts.size()) - 1; }
  /// No nodes; the vectors keep their memory.
  void Clear() noexcept {
    starts.assign(1, 0);
    others.clear();
  }
};

/// Memory of FindNodeOrder.
struct NodeOrderWorkspace {
  std::vector<std::uint32_t> roots, places;
  std::vector<std::uint8_t> is_placed;
};

/// Order that puts neighbours close together in memory: breadth first from a node of low degree (Cuthill and
/// McKee, "Reducing the bandwidth of sparse symmetric matrices", ACM 1969), then by degree within short runs,
/// so that the rows of a slice are alike in length.
/// \param[out] order  (n) old index of each new place
/// \note Allocates nothing where the vectors have the capacity.
void FindNodeOrder(const NodeGraph& graph, NodeOrderWorkspace& workspace, std::vector<std::uint32_t>& order);

/// A graph's neighbours in slices of kSliceNodes.
struct SliceLayout {
  std::uint32_t node_count = 0;
  std::vector<std::uint32_t> starts{0};  // (slices + 1) in steps
  std::vector<std::uint32_t> others;     // (steps * kSliceNodes); padding points at its own node

  std::uint32_t Slices() const { return static_cast<std::uint32_t>(starts.size()) - 1; }
  std::size_t PaddedNodes() const { return std::size_t{Slices()} * kSliceNodes; }
  std::size_t Steps() const { return starts.back(); }
  /// Place of the h-th neighbour of node i.
  std::size_t Entry(std::uint32_t i, std::uint32_t h) const {
    return (std::size_t{starts[i / kSliceNodes]} + h) * kSliceNodes + i % kSliceNodes;
  }
  /// Places of the slice of node i.
  std::uint32_t RowSteps(std::uint32_t i) const {
    return starts[i / kSliceNodes + 1] - starts[i / kSliceNodes];
  }
  SliceTable Table() const { return {starts.data(), others.data()}; }
};
/// \note Allocates nothing where the vectors of `layout` have the capacity.
void SetSliceLayout(const NodeGraph& graph, SliceLayout& layout);

}  // namespace trocar::tissue
