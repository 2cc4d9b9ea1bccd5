// SPDX-License-Identifier: Apache-2.0
#include "slice_layout.h"

#include <algorithm>
#include <numeric>

namespace trocar::tissue {
namespace {

/// Nodes within which a node may change its place for the sake of its degree.
constexpr std::uint32_t kSortRun = 8 * kSliceNodes;

}  // namespace

std::vector<std::uint32_t> CalcNodeOrder(const NodeGraph& graph) {
  const std::uint32_t n = graph.Size();
  const auto degree = [&](std::uint32_t i) { return graph.starts[i + 1] - graph.starts[i]; };
  std::vector<std::uint32_t> roots(n);
  std::iota(roots.begin(), roots.end(), 0u);
  std::stable_sort(roots.begin(), roots.end(), [&](auto a, auto b) { return degree(a) < degree(b); });
  std::vector<std::uint8_t> is_placed(n, 0);
  std::vector<std::uint32_t> order;
  order.reserve(n);
  for (const std::uint32_t root : roots) {
    if (is_placed[root]) continue;
    is_placed[root] = 1;
    order.push_back(root);
    for (std::size_t at = order.size() - 1; at < order.size(); ++at) {
      const std::size_t first = order.size();
      for (auto h = graph.starts[order[at]]; h < graph.starts[order[at] + 1]; ++h) {
        const std::uint32_t other = graph.others[h];
        if (is_placed[other]) continue;
        is_placed[other] = 1;
        order.push_back(other);
      }
      std::stable_sort(order.begin() + static_cast<std::ptrdiff_t>(first), order.end(),
                       [&](auto a, auto b) { return degree(a) < degree(b); });
    }
  }
  for (std::uint32_t first = 0; first < n; first += kSortRun) {
    std::stable_sort(order.begin() + first, order.begin() + std::min(n, first + kSortRun),
                     [&](auto a, auto b) { return degree(a) > degree(b); });
  }
  return order;
}

SliceLayout MakeSliceLayout(const NodeGraph& graph) {
  SliceLayout layout;
  const std::uint32_t n = layout.node_count = graph.Size();
  layout.starts.push_back(0);
  for (std::uint32_t first = 0; first < n; first += kSliceNodes) {
    std::uint32_t longest = 0;
    for (std::uint32_t i = first; i < std::min(n, first + kSliceNodes); ++i) {
      longest = std::max(longest, graph.starts[i + 1] - graph.starts[i]);
    }
    for (std::uint32_t step = 0; step < longest; ++step) {
      for (std::uint32_t i = first; i < first + kSliceNodes; ++i) {
        const bool is_padding = i >= n || graph.starts[i] + step >= graph.starts[i + 1];
        layout.others.push_back(is_padding ? i : graph.others[graph.starts[i] + step]);
      }
    }
    layout.starts.push_back(layout.starts.back() + longest);
  }
  return layout;
}

}  // namespace trocar::tissue
