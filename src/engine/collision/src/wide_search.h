// SPDX-License-Identifier: Apache-2.0
/// \file wide_search.h  A search through a WideTree whose visits are a callable.
#pragma once

#include <cmath>
#include <limits>

#include "trocar/collision/queries.h"
#include "trocar/collision/wide_tree.h"
#include "wide_kernels.h"

namespace trocar::collision {

/// A squared distance as a limit of a WideSearch, not smaller.
inline float LimitOf(double squared_distance) noexcept {
  constexpr double kLargest = 1e36;  // beyond, squares of floats may overflow
  if (!(squared_distance < kLargest)) return std::numeric_limits<float>::infinity();
  const auto limit = static_cast<float>(squared_distance);
  return limit < squared_distance ? std::nextafter(limit, std::numeric_limits<float>::infinity()) : limit;
}

/// Shows `visit` every item that may lie within the squared distance `limit` of the segment [m^2].
///
/// \param visit  (item) -> the limit from then on [m^2]
template <typename Visit>
void SearchWideTree(const WideTree& tree, const Segment& segment, double limit, Visit&& visit) noexcept {
  if (tree.nodes.empty() || limit < 0.0) return;
  struct Context {
    Visit& visit;
    WideSearch search;
  } context{visit, {}};
  const math::Vec3 &from = segment.start, &to = segment.end;
  context.search = {{static_cast<float>(from.x), static_cast<float>(from.y), static_cast<float>(from.z)},
                    {static_cast<float>(to.x), static_cast<float>(to.y), static_cast<float>(to.z)},
                    LimitOf(limit),
                    [](void* self, std::uint32_t item) noexcept {
                      Context& c = *static_cast<Context*>(self);
                      c.search.limit = LimitOf(c.visit(item));
                    },
                    &context};
  const WideKernels& kernels = GetWideKernels(tree.simd);
  const auto search = from == to ? kernels.search_point : kernels.search_segment;
  search(tree.nodes.data(), tree.leaves.data(), tree.points.data(), context.search);
}

}  // namespace trocar::collision
