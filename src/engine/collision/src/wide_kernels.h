// SPDX-License-Identifier: Apache-2.0
/// \file wide_kernels.h  Loops over a WideTree that exist once for each level of vector instructions.
///
/// Plain pointers only: these functions are compiled with wide instructions, and an inline function of another
/// header that they instantiated could be handed by the linker to a processor that lacks them. Every level
/// does the same operations on eight lanes and fuses none, so that all levels have the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

#include "trocar/collision/wide_tree.h"

namespace trocar::collision {

/// A search for items near a segment (or a point, where both ends are the same).
struct WideSearch {
  float from[3], to[3];  ///< [m]
  /// Items surely farther are left out [m^2]; `visit` may lower it.
  float limit;
  void (*visit)(void* self, std::uint32_t item) noexcept;
  void* self;
};

struct WideKernels {
  /// Positions to single precision.
  void (*convert)(const double* xyz, std::size_t count, WidePoint* points);
  /// Boxes of all nodes, from the last to the first.
  void (*refit)(WideNode* nodes, std::size_t node_count, const WideLeaf* leaves,
                const std::uint32_t* leaf_points, const WidePoint* points);
  void (*search_point)(const WideNode* nodes, const WideLeaf* leaves, const WidePoint* points,
                       WideSearch& search);
  void (*search_segment)(const WideNode* nodes, const WideLeaf* leaves, const WidePoint* points,
                         WideSearch& search);
};

const WideKernels& GetWideKernelsBaseline() noexcept;
const WideKernels& GetWideKernelsAvx2() noexcept;
const WideKernels& GetWideKernelsAvx512() noexcept;

/// \pre base::HasSimdLevel(level) (TROCAR_ASSERT)
const WideKernels& GetWideKernels(base::SimdLevel level) noexcept;

}  // namespace trocar::collision
