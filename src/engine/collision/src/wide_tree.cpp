// SPDX-License-Identifier: Apache-2.0
#include "trocar/collision/wide_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trocar/base/assert.h"
#include "wide_kernels.h"

namespace trocar::collision {

using geometry::Triangle;
using math::Vec3;

namespace {

using BuildItem = WideTree::BuildItem;

std::size_t CountLeaves(std::span<const BuildItem> items) {
  return (items.size() + kTreeWidth - 1) / kTreeWidth;
}

/// Halves of full leaves, divided along the longest side of the centres' box; equal centres by index.
std::size_t Halve(std::span<BuildItem> items) {
  std::array<float, 3> low = items[0].centre, high = low;
  for (const BuildItem& item : items) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], item.centre[axis]);
      high[axis] = std::max(high[axis], item.centre[axis]);
    }
  }
  int axis = 0;
  for (int other = 1; other < 3; ++other) {
    if (high[other] - low[other] > high[axis] - low[axis]) axis = other;
  }
  const std::size_t middle = kTreeWidth * ((CountLeaves(items) + 1) / 2);
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(middle), items.end(),
                   [axis](const BuildItem& a, const BuildItem& b) {
                     if (a.centre[axis] != b.centre[axis]) return a.centre[axis] < b.centre[axis];
                     return a.item < b.item;
                   });
  return middle;
}

float RoundUp(double value) {
  const auto rounded = static_cast<float>(value);
  return rounded < value ? std::nextafter(rounded, std::numeric_limits<float>::infinity()) : rounded;
}

void AddLeaf(std::span<BuildItem> items, std::span<const Triangle> corners, std::span<const double> radii,
             WideTree& tree) {
  std::sort(items.begin(), items.end(),
            [](const BuildItem& a, const BuildItem& b) { return a.item < b.item; });
  WideLeaf leaf{};
  leaf.count = static_cast<std::uint32_t>(items.size());
  std::array<std::uint32_t, 3 * kTreeWidth> different;
  std::size_t count = 0;
  for (std::size_t lane = 0; lane < kTreeWidth; ++lane) {
    const std::uint32_t item = items[lane < items.size() ? lane : 0].item;
    leaf.item[lane] = item;
    leaf.radius[lane] = radii.empty() ? 0.0f : RoundUp(radii[item]);
    leaf.largest_radius = std::max(leaf.largest_radius, leaf.radius[lane]);
    for (int corner = 0; corner < 3; ++corner) {
      leaf.corner[corner][lane] = corners[item][corner];
      different[count++] = corners[item][corner];
    }
  }
  std::sort(different.begin(), different.end());
  const auto end = std::unique(different.begin(), different.end());
  leaf.first_point = static_cast<std::uint32_t>(tree.leaf_points.size());
  leaf.point_count = static_cast<std::uint32_t>(end - different.begin());
  tree.leaf_points.insert(tree.leaf_points.end(), different.begin(), end);
  tree.leaves.push_back(leaf);
}

WideNode MakeEmptyNode() {
  WideNode node{};
  for (int axis = 0; axis < 3; ++axis) {
    std::fill(std::begin(node.low[axis]), std::end(node.low[axis]), std::numeric_limits<float>::infinity());
    std::fill(std::begin(node.high[axis]), std::end(node.high[axis]),
              -std::numeric_limits<float>::infinity());
  }
  return node;
}

/// \return index of the new node over `items`
std::uint32_t AddNode(std::span<BuildItem> items, std::span<const Triangle> corners,
                      std::span<const double> radii, WideTree& tree) {
  const auto index = static_cast<std::uint32_t>(tree.nodes.size());
  tree.nodes.push_back(MakeEmptyNode());
  // halve the largest part until there are eight or only leaves
  std::array<std::span<BuildItem>, kTreeWidth> parts;
  std::size_t count = 0;
  parts[count++] = items;
  while (count < kTreeWidth) {
    const auto largest = std::max_element(parts.begin(), parts.begin() + static_cast<std::ptrdiff_t>(count),
                                          [](const auto& a, const auto& b) { return a.size() < b.size(); });
    if (largest->size() <= kTreeWidth) break;
    const std::size_t middle = Halve(*largest);
    parts[count++] = largest->subspan(middle);
    *largest = largest->first(middle);
  }
  for (std::size_t lane = 0; lane < count; ++lane) {
    std::uint32_t child = 0;
    if (parts[lane].size() <= kTreeWidth) {
      child = WideNode::kLeaf | static_cast<std::uint32_t>(tree.leaves.size());
      AddLeaf(parts[lane], corners, radii, tree);
    } else {
      child = AddNode(parts[lane], corners, radii, tree);
    }
    tree.nodes[index].child[lane] = child;
  }
  tree.nodes[index].count = static_cast<std::uint32_t>(count);
  return index;
}

}  // namespace

void BuildWideTree(std::span<const Vec3> positions, std::span<const Triangle> corners,
                   std::span<const double> radii, WideTree& tree) {
  TROCAR_ASSERT(radii.empty() || radii.size() == corners.size());
  tree.nodes.clear();
  tree.leaves.clear();
  tree.leaf_points.clear();
  tree.points.resize(positions.size());
  tree.build_items.resize(corners.size());
  for (std::uint32_t i = 0; i < corners.size(); ++i) {
    const auto& [a, b, c] = corners[i];
    const Vec3 sum = positions[a] + positions[b] + positions[c];
    tree.build_items[i] = {{static_cast<float>(sum.x), static_cast<float>(sum.y), static_cast<float>(sum.z)},
                           i};
  }
  if (corners.empty()) return;
  const std::size_t leaves = CountLeaves(tree.build_items);
  tree.leaves.reserve(leaves);
  tree.nodes.reserve(leaves);
  tree.leaf_points.reserve(3 * corners.size());
  AddNode(tree.build_items, corners, radii, tree);
  RefitWideTree(positions, tree);
}

void RefitWideTree(std::span<const Vec3> positions, WideTree& tree) noexcept {
  TROCAR_ASSERT(positions.size() == tree.points.size());
  if (tree.nodes.empty()) return;
  const WideKernels& kernels = GetWideKernels(tree.simd);
  kernels.convert(&positions[0].x, positions.size(), tree.points.data());
  kernels.refit(tree.nodes.data(), tree.nodes.size(), tree.leaves.data(), tree.leaf_points.data(),
                tree.points.data());
}

}  // namespace trocar::collision
