// SPDX-License-Identifier: Apache-2.0
#include "slice_layout.h"

#include <algorithm>

namespace trocar::tissue {
namespace {

/// Nodes within which a node may change its place for the sake of its degree.
constexpr std::uint32_t kSortRun = 8 * kSliceNodes;

/// Stable, in place: the runs are short, and std::stable_sort allocates.
template <typename Comes>
void SortRun(std::span<std::uint32_t> nodes, const Comes& comes_before) {
  for (std::size_t at = 1; at < nodes.size(); ++at) {
    const std::uint32_t node = nodes[at];
    std::size_t to = at;
    for (; to > 0 && comes_before(node, nodes[to - 1]); --to) nodes[to] = nodes[to - 1];
    nodes[to] = node;
  }
}

/// All nodes by their degree, those of one degree in their order.
void SortByDegree(const NodeGraph& graph, std::vector<std::uint32_t>& places,
                  std::vector<std::uint32_t>& sorted) {
  const std::uint32_t n = graph.Size();
  std::uint32_t most = 0;
  for (std::uint32_t i = 0; i < n; ++i) most = std::max(most, graph.starts[i + 1] - graph.starts[i]);
  places.assign(most + 2, 0);
  for (std::uint32_t i = 0; i < n; ++i) ++places[graph.starts[i + 1] - graph.starts[i] + 1];
  for (std::uint32_t degree = 0; degree <= most; ++degree) places[degree + 1] += places[degree];
  sorted.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) sorted[places[graph.starts[i + 1] - graph.starts[i]]++] = i;
}

}  // namespace

void FindNodeOrder(const NodeGraph& graph, NodeOrderWorkspace& workspace, std::vector<std::uint32_t>& order) {
  const std::uint32_t n = graph.Size();
  const auto degree = [&](std::uint32_t i) { return graph.starts[i + 1] - graph.starts[i]; };
  SortByDegree(graph, workspace.places, workspace.roots);
  workspace.is_placed.assign(n, 0);
  order.clear();
  order.reserve(n);
  for (const std::uint32_t root : workspace.roots) {
    if (workspace.is_placed[root]) continue;
    workspace.is_placed[root] = 1;
    order.push_back(root);
    for (std::size_t at = order.size() - 1; at < order.size(); ++at) {
      const std::size_t first = order.size();
      for (auto h = graph.starts[order[at]]; h < graph.starts[order[at] + 1]; ++h) {
        const std::uint32_t other = graph.others[h];
        if (workspace.is_placed[other]) continue;
        workspace.is_placed[other] = 1;
        order.push_back(other);
      }
      SortRun(std::span(order).subspan(first), [&](auto a, auto b) { return degree(a) < degree(b); });
    }
  }
  for (std::uint32_t first = 0; first < n; first += kSortRun) {
    SortRun(std::span(order).subspan(first, std::min(n - first, kSortRun)),
            [&](auto a, auto b) { return degree(a) > degree(b); });
  }
}

void SetSliceLayout(const NodeGraph& graph, SliceLayout& layout) {
  const std::uint32_t n = layout.node_count = graph.Size();
  layout.starts.assign(1, 0);
  layout.others.clear();
  for (std::uint32_t first = 0; first < n; first += kSliceNodes) {
    std::uint32_t longest = 0;
    for (std::uint32_t i = first; i < std::min(n, first + kSliceNodes); ++i) {
      longest = std::max(longest, graph.starts[i + 1] - graph.starts[i]);
    }
    const std::size_t begin = layout.others.size();
    layout.others.resize(begin + std::size_t{longest} * kSliceNodes);
    for (std::uint32_t lane = 0; lane < kSliceNodes; ++lane) {
      const std::uint32_t i = first + lane, from = i < n ? graph.starts[i] : 0,
                          count = i < n ? graph.starts[i + 1] - from : 0;
      for (std::uint32_t step = 0; step < longest; ++step) {
        layout.others[begin + std::size_t{step} * kSliceNodes + lane] =
            step < count ? graph.others[from + step] : i;
      }
    }
    layout.starts.push_back(layout.starts.back() + longest);
  }
}

}  // namespace trocar::tissue
