// SPDX-License-Identifier: Apache-2.0
/// \file kernels.h  The solvers' inner loops in single precision, compiled once for each SimdLevel.
///
/// Nodes are taken in slices of kSliceNodes; what the nodes of a slice read at one step lies together (sliced
/// ELLPACK: Monakov, Lokhmotov, Avetisyan, "Automatically tuning sparse matrix-vector multiplication for GPU
/// architectures", HiPEAC 2010). A node is 16 bytes, so a neighbour is one vector load; sixteen of them are
/// transposed in registers, which is several times faster than the processor's gather.
#pragma once

#include <cstddef>
#include <cstdint>

#include "trocar/base/simd_level.h"

namespace trocar::tissue {

/// Nodes of a slice, whatever the width of a vector, so that the layout and the bits do not depend on it.
inline constexpr std::uint32_t kSliceNodes = 16;

/// A node's vector, padded to 16 bytes.
struct alignas(16) Float4 {
  float x = 0, y = 0, z = 0, w = 0;
};
/// A node's vector in double precision, padded to 32 bytes.
struct alignas(32) Double4 {
  double x = 0, y = 0, z = 0, w = 0;
};

/// Neighbours by slice and step; entry (step, lane) of a slice is at (starts[slice] + step) * kSliceNodes +
/// lane. A padded entry points at its own node.
struct SliceTable {
  const std::uint32_t* starts;  // (slices + 1) in steps
  const std::uint32_t* others;  // (steps * kSliceNodes)
};

/// Floats of a link's stiffness S: a symmetric block as xx, xy, xz, yy, yz, zz; or of one spring, whose block is
/// a I + v v^T, as a, v_x, v_y, v_z. Passes wait for memory: the fewer, the faster.
inline constexpr std::size_t kBlockFloats = 6, kSpringLinkFloats = 4;

/// The stiffness K of a system of springs, in symmetric blocks of 3 x 3. Its off-diagonal blocks are K_ij = -S_ij, its
/// diagonal blocks K_ii = G_i + sum_j S_ij, so that (K x)_i = G_i x_i + sum_j S_ij (x_i - x_j). Closed surfaces under
/// pressure add their follower stiffness, sum_j t_ij x (x_j - x_i).
struct LinkMatrix {
  SliceTable table;
  const float* links;            // (steps, link_floats, kSliceNodes): S
  std::size_t link_floats;       // kBlockFloats or kSpringLinkFloats
  const float* diagonal_excess;  // (slices, 6, kSliceNodes): G, what the diagonal block has beyond sum S
  const float* inverse;   // (slices, 6, kSliceNodes): inverse of the node's own block; zero where it is held
  const float* is_free;   // (slices * kSliceNodes): 1, or 0 where the node is held
  const float* follower;  // (steps, 3, kSliceNodes): t, of kProduct and kFollower alone; or null
};

/// Result that a pass over a LinkMatrix writes.
enum class LinkPass {
  kStart,     ///< out = factor D^-1 b; x is not read
  kProduct,   ///< out = K x
  kFollower,  ///< out = the follower stiffness alone times x
  kResidual,  ///< out = b - K x
  kSmooth     ///< out = x + factor D^-1 (b - K x)
};

/// Values of a node that the balance of forces needs, in the order of BalancePass::nodes.
enum BalanceValue {
  kRestX,      ///< [m]
  kRestY,      ///< [m]
  kRestZ,      ///< [m]
  kOuterX,     ///< force of everything but springs [N]
  kOuterY,     ///< [N]
  kOuterZ,     ///< [N]
  kOuterSize,  ///< largest single one of these forces [N]
  kShape,      ///< k_virtual, scaled [N/m]
  kStrands,    ///< sum of the node's strands, scaled [N/m]
  kFree,       ///< 1, or 0 where the node is held
  kBalanceValues
};

/// Forces, energy and stiffness of a sliced system in double precision.
struct BalancePass {
  SliceTable table;
  const double* stiffness;       // (entries) k [N/m]; 0 where there is no spring
  const double* rest_length;     // (entries) l [m]
  double stiffness_scale;        // on k [-]
  const double* nodes;           // (slices, kBalanceValues, kSliceNodes)
  const Double4* position;       // (padded nodes) [m]
  Float4* residual;              // (padded nodes) out: force on the node [N], 0 where it is held
  bool has_stiffness;            // whether what follows is written
  float* links;                  // (steps, kSpringLinkFloats, kSliceNodes) out: as in LinkMatrix
  const float* diagonal_excess;  // (slices, 6, kSliceNodes)
  float* inverse;  // (slices, 6, kSliceNodes) out: of the node's own block, compression left out
};
/// The follower of a LinkMatrix: what a pressure P adds to the stiffness is P / 6 times the vector from the one to the other
/// of the two corners that lie across an edge.
struct FollowerPass {
  SliceTable table;
  const std::uint32_t* left;  // (entries) node across the link, of the triangle that goes along it
  const std::uint32_t*
      right;  // (entries) of the one that goes back; as left where no closed surface has such an edge
  const double* factor;     // (padded nodes) P / 6 [Pa]
  const Double4* position;  // (padded nodes) [m]
  float* follower;          // (steps, 3, kSliceNodes) out: t [N/m]
};

/// Sums and maxima that a pass found over its slices; the same for every width of a vector.
struct BalanceSums {
  double energy = 0;     ///< springs half, being met from both ends, virtual springs and outer forces [J]
  double residual2 = 0;  ///< largest squared force out of balance on a free node [N^2]
  double force = 0;      ///< largest force of one spring or load on a free node [N]
  double distance2 = 0;  ///< largest squared distance of a node from rest [m^2]
  bool is_finite = true;
};

/// Most slices among which the neighbours of one step are looked up in registers.
inline constexpr std::uint32_t kLookupSlices = 6;

/// Where a step's neighbours lie when they lie in few slices: whole slices are loaded, two at a time, and the
/// neighbours picked from them.
struct SliceLookup {
  std::uint32_t pairs;                  // of slices, or 0 where there are more than kLookupSlices
  std::uint32_t slices[kLookupSlices];  // those beyond what is needed are any
  std::uint8_t places[kSliceNodes];     // kSliceNodes times the place in `slices`, and the lane there
};

/// One step of the nonlinear iteration on a sliced system. Displacements are stored by node, or, where most
/// neighbours are looked up, by slice.
struct SliceStep {
  SliceTable table;
  const float* springs;  // (steps, 5, kSliceNodes): rest offset x, y, z [m], k [N/m], k l [N]
  const float* nodes;    // (slices, 5, kSliceNodes): load x, y, z [N], k_virtual [N/m], step length [m/N]
  const Float4* u;       // (n) displacements [m]
  Float4* previous;      // (n) those of the iteration before; receives the next
  const SliceLookup* lookups;        // (steps), or null: then what follows is not there
  const std::uint8_t* is_scattered;  // (slices) whether a step without lookup reads it: only those are in u
  const float* u_by_slice;           // (slices, 3, kSliceNodes) displacements [m]
  float* previous_by_slice;          // the same, of the iteration before; receives the next
  float omega, damping;              // of Chebyshev's recurrence [-]
  bool is_first;                     // of its cycle: the displacement before is the present one
  bool is_measured;                  // whether to report the residual
};

/// The neighbours that a node's own springs go to; the other four are theirs.
enum GridDirection { kEast, kSouth, kSouthEast, kSouthWest, kGridDirections };

/// Three directions of (3, stride) with a block of margin on either side.
inline constexpr std::size_t ReactionFloats(std::uint32_t stride) {
  return 3 * (std::size_t{3} * stride + 2 * kSliceNodes);
}

/// One step of the nonlinear iteration on a structured mesh: every spring is taken once. A row's numbers of
/// one kind lie side by side, x before y before z, so that the neighbour in the next column is an unaligned
/// load.
struct GridStep {
  std::uint32_t rows, stride;  // columns, rounded up to a multiple of kSliceNodes
  const float* springs;  // (rows, stride / kSliceNodes, kGridDirections, 5, kSliceNodes), or one row where
                         // all are alike: rest offset x, y, z [m], k [N/m], k l [N]
  std::uint32_t spring_row;   // floats from row to row, or 0
  const float* last_springs;  // those of the last row, which has nothing below
  bool has_south_west;
  bool is_aligned;  // rest offsets: x alone to the east, y alone to the south, no z
  const float*
      nodes;  // (rows, stride / kSliceNodes, 5, kSliceNodes): load x, y, z [N], k_virtual [N/m], step [m/N]
  const std::uint32_t*
      node_rows;         // (rows) which row of `nodes` each has: most are alike, and stay in the cache
  const float* u;        // (rows + 1, 3, stride) displacements [m], one block of margin on either side
  float* previous;       // the same, of the iteration before; receives the next
  float omega, damping;  // of Chebyshev's recurrence [-]
  bool is_first;
  bool is_measured;  // whether to report the residual
  float* reaction;   // (2 ReactionFloats): forces of a row's springs to the south, south-east and south-west
                     // on its own nodes, by follower for even and odd rows; zero at first
};

/// Sums and combinations of node vectors, from node `first` to before `last`, both multiples of kSliceNodes.
struct VectorKernels {
  /// a . b in double precision
  double (*dot)(const Float4* a, const Float4* b, std::uint32_t first, std::uint32_t last);
  /// largest squared norm; NaN where one is
  float (*find_largest2)(const Float4* v, std::uint32_t first, std::uint32_t last);
  /// step += alpha p, r -= alpha q
  void (*advance)(float alpha, const Float4* p, const Float4* q, Float4* step, Float4* r, std::uint32_t first,
                  std::uint32_t last);
  /// to += factor v
  void (*add_scaled)(float factor, const Float4* v, Float4* to, std::uint32_t first, std::uint32_t last);
  /// to = a + beta to
  void (*scale_and_add)(float beta, const Float4* a, Float4* to, std::uint32_t first, std::uint32_t last);
};

/// Steps return the largest squared residual of a free node before the step [N^2], NaN where one is, or 0
/// where it is not measured.
struct Kernels {
  void (*multiply)(const LinkMatrix& matrix, LinkPass pass, const Float4* x, const Float4* b, float factor,
                   Float4* out, std::uint32_t first_slice, std::uint32_t last_slice);
  float (*step_slices)(const SliceStep& step, std::uint32_t first_slice, std::uint32_t last_slice);
  bool looks_up;  ///< whether step_slices takes lookups
  float (*step_rows)(const GridStep& step, std::uint32_t first_row, std::uint32_t last_row);
  void (*calc_follower_stiffness)(const FollowerPass& pass, std::uint32_t first_slice,
                                  std::uint32_t last_slice);
  BalanceSums (*balance)(const BalancePass& pass, std::uint32_t first_slice, std::uint32_t last_slice);
  /// Inverses of the nodes' own blocks, diagonal excess + sum of links; 0 where a node is held or nothing holds it.
  /// \pre matrix.link_floats == kBlockFloats
  void (*invert_blocks)(const LinkMatrix& matrix, float* inverse, std::uint32_t first_slice,
                        std::uint32_t last_slice);
  VectorKernels vectors;
};
/// \pre HasSimdLevel(level)
const Kernels& GetKernels(base::SimdLevel level) noexcept;

}  // namespace trocar::tissue
