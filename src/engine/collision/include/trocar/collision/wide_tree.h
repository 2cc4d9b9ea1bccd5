// SPDX-License-Identifier: Apache-2.0
/// \file wide_tree.h  Boxes in a tree, eight to a node: what TriangleTree and CapsuleTree share.
///
/// An item is a rounded triangle: three corners and a radius about them. A triangle has radius zero; a capsule
/// has two equal corners. Boxes and corners are kept as floats that only ever exclude what is surely farther
/// than the best so far; what is left is measured in double by the caller. So an answer depends neither on
/// rounding in the tree nor on the instruction set.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/base/simd_level.h"
#include "trocar/geometry/triangle_mesh.h"

namespace trocar::collision {

inline constexpr int kTreeWidth = 8;  ///< children of a node, and items of a leaf

/// Boxes of up to eight children, by coordinate; a lane without a child is an empty box.
struct alignas(32) WideNode {
  static constexpr std::uint32_t kLeaf = 0x80000000u;  ///< set in child: the rest is the leaf's index

  float low[3][kTreeWidth], high[3][kTreeWidth];  ///< [m]
  std::uint32_t child[kTreeWidth];
  std::uint32_t count;
};

/// Up to eight items, by corner; lanes beyond count repeat the first.
struct alignas(32) WideLeaf {
  std::uint32_t corner[3][kTreeWidth];
  std::uint32_t item[kTreeWidth];  ///< ascending
  float radius[kTreeWidth];        ///< rounded up [m]
  float largest_radius;            ///< [m]
  std::uint32_t count;
  std::uint32_t first_point, point_count;  ///< its different corners, in WideTree::leaf_points
};

/// Position in single precision.
struct alignas(16) WidePoint {
  float x, y, z, unused;
};

/// Tree over items whose corners move. Plain data: searched by wide_search.h, kept by its owners.
struct WideTree {
  std::vector<WideNode> nodes;  ///< root first, parents before children
  std::vector<WideLeaf> leaves;
  std::vector<WidePoint> points;           ///< (nv) at the last update
  std::vector<std::uint32_t> leaf_points;  ///< by leaf
  base::SimdLevel simd = base::FindSimdLevel();

  /// Centre and number of an item while the tree is built.
  struct BuildItem {
    std::array<float, 3> centre;
    std::uint32_t item;
  };
  std::vector<BuildItem> build_items;  ///< kept for its memory
};

/// Builds the tree by halving the items along the longest side of their centres' box, eight to a leaf.
///
/// \param corners  (n) indices into positions
/// \param radii    (n) or empty for zero [m], >= 0
/// \note Allocates only what the tree has never held before: building again after a cut of the topology can be
/// made free of allocation by having built once with as many items.
void BuildWideTree(std::span<const math::Vec3> positions, std::span<const geometry::Triangle> corners,
                   std::span<const double> radii, WideTree& tree);

/// Refits every box to moved positions.
/// \note Real-time safe: no allocation, lock or throw.
void RefitWideTree(std::span<const math::Vec3> positions, WideTree& tree) noexcept;

}  // namespace trocar::collision
