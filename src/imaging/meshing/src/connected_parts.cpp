// SPDX-License-Identifier: Apache-2.0
#include "connected_parts.h"

#include <algorithm>
#include <functional>
#include <numeric>

namespace trocar::meshing {

void ConnectedParts::Join(std::size_t rows, std::size_t rows_of_a_layer) {
  parent_.resize(runs_.size());
  std::iota(parent_.begin(), parent_.end(), 0u);
  for (std::size_t row = 0; row < rows; ++row) {
    if (row % rows_of_a_layer != 0) JoinRows(row - 1, row);
    if (row >= rows_of_a_layer) JoinRows(row - rows_of_a_layer, row);
  }
}

void ConnectedParts::JoinRows(std::size_t one, std::size_t other) {
  std::uint32_t a = starts_[one], b = starts_[other];
  while (a < starts_[one + 1] && b < starts_[other + 1]) {
    if (runs_[a].begin < runs_[b].end && runs_[b].begin < runs_[a].end) {
      const std::uint32_t root_a = FindRoot(a), root_b = FindRoot(b);
      parent_[std::max(root_a, root_b)] = std::min(root_a, root_b);
    }
    runs_[a].end < runs_[b].end ? ++a : ++b;
  }
}

std::uint32_t ConnectedParts::FindRoot(std::uint32_t run) {
  while (parent_[run] != run) run = parent_[run] = parent_[parent_[run]];
  return run;
}

std::vector<std::size_t> ConnectedParts::SizesByRoot() {
  std::vector<std::size_t> sizes(runs_.size(), 0);
  for (std::uint32_t r = 0; r < runs_.size(); ++r)
    sizes[FindRoot(r)] += static_cast<std::size_t>(runs_[r].end - runs_[r].begin);
  return sizes;
}

std::vector<std::size_t> ConnectedParts::CountSamples() {
  std::vector<std::size_t> sizes = SizesByRoot();
  std::erase(sizes, std::size_t{0});
  std::sort(sizes.begin(), sizes.end(), std::greater<>());
  return sizes;
}

std::vector<Run> ConnectedParts::FindLesser() {
  const std::vector<std::size_t> sizes = SizesByRoot();
  const auto largest =
      static_cast<std::uint32_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  std::vector<Run> lesser;
  for (std::uint32_t r = 0; r < runs_.size(); ++r) {
    if (FindRoot(r) != largest) lesser.push_back(runs_[r]);
  }
  return lesser;
}

}  // namespace trocar::meshing
