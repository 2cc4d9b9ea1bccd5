// SPDX-License-Identifier: Apache-2.0
/// \file paper_layouts.h  One step of the relaxation, x_i <- x_i + alpha R_i, in the paper's four memory
/// layouts.
///
/// The paper's data structure: Positions (coordinates, mass and boundary condition of each point), Neighbors
/// and Length Rest, linked by the position of each point in the array; one thread a point. The layouts differ
/// in
///   where the fields of a point lie    behind one another (global), or each field of all points together, so
///                                      that threads side by side read side by side (coalesced)
///   where neighbours are read          by index from global memory, or, on structured meshes, from a tile in
///                                      shared memory with a border that some threads copy in addition; then
///                                      a point says with 0 or 1 to which of its eight neighbours it is
///                                      connected
/// The paper's constants are the same for all springs: without the arrays of stiffness and rest points, so
/// here. Points are updated from the positions before the step (Jacobi), since all move at once. Source:
/// "General algorithms for laparoscopic surgical simulators", sections 3.2.1, 3.2.2 and 3.2.4.
#pragma once

#include "portable.h"

namespace trocar::tissue_cuda {

/// The paper's boundary conditions, as the numbers in Positions.
inline constexpr int kConditionFree = 0, kConditionForce = 1, kConditionPrescribed = 2;

inline constexpr std::uint32_t kPointFields = 5;  // x, y, z, mass, condition
inline constexpr std::uint32_t kRestFields = 4;   // x, y, z, k_virtual
inline constexpr std::uint32_t kForceFields = 3;
inline constexpr std::uint32_t kGridNeighbors = 8;
inline constexpr std::uint32_t kTileSide = 16;                   // of the shared layouts; 256 threads a block
inline constexpr std::uint32_t kTileBorderSide = kTileSide + 2;  // with the neighbours around
inline constexpr std::uint32_t kPaperThreads = 256;              // the paper's fixed block size
inline constexpr std::uint32_t kNoNeighbor = 0xffffffffu;

/// Column and row of neighbour d of a point in a grid, as offsets: the ring from west over north to
/// south-west.
TROCAR_HD int NeighborColumn(std::uint32_t d) {
  constexpr int kColumn[kGridNeighbors] = {-1, -1, 0, 1, 1, 1, 0, -1};
  return kColumn[d];
}
TROCAR_HD int NeighborRow(std::uint32_t d) {
  constexpr int kRow[kGridNeighbors] = {0, -1, -1, -1, 0, 1, 1, 1};
  return kRow[d];
}

template <typename Real, typename Memory>
struct PaperArgs {
  std::uint32_t points = 0;
  std::uint32_t pitch = 0;              ///< distance of two fields where they lie apart, >= points
  std::uint32_t max_neighbors = 0;      ///< entries of a point in the arrays of links
  std::uint32_t columns = 0, rows = 0;  ///< of structured meshes
  Real alpha = 0;                       ///< [m/N]
  Real mesh_stiffness = 0;              ///< of every spring, where link_stiffness is not given [N/m]
  Real stiffness_scale = 1, shape_scale = 1;
  Triple<Real> gravity{};  ///< [m/s^2]

  typename Memory::template Array<Real> positions{};           ///< points before the step
  typename Memory::template Array<Real> next_positions{};      ///< and behind it
  typename Memory::template Array<std::uint32_t> neighbors{};  ///< kNoNeighbor where there are fewer
  typename Memory::template Array<std::uint8_t> connected{};   ///< structured: 0 or 1 for each of eight
  typename Memory::template Array<Real> length_rest{};         ///< [m]
  typename Memory::template Array<Real> link_stiffness{};      ///< [N/m], or none
  typename Memory::template Array<Real> rest_points{};     ///< with k_virtual, or none: no virtual springs
  typename Memory::template Array<Real> external_force{};  ///< [N]; read where the condition says so
  typename Memory::template Array<Key> largest{};          ///< squared residual and force, or none
};

/// Where field `field` of point i lies.
template <bool kCoalesced>
TROCAR_HD std::size_t FieldAt(std::uint32_t i, std::uint32_t field, std::uint32_t fields,
                              std::uint32_t pitch) {
  return kCoalesced ? static_cast<std::size_t>(field) * pitch + i
                    : static_cast<std::size_t>(i) * fields + field;
}

template <bool kCoalesced, typename Array>
TROCAR_HD auto LoadTriple(const Array& array, std::uint32_t i, std::uint32_t fields, std::uint32_t pitch)
    -> Triple<decltype(Load(array, 0))> {
  return {Load(array, FieldAt<kCoalesced>(i, 0, fields, pitch)),
          Load(array, FieldAt<kCoalesced>(i, 1, fields, pitch)),
          Load(array, FieldAt<kCoalesced>(i, 2, fields, pitch))};
}

/// Force of all springs on a point, and the largest of them squared.
template <typename Real>
struct SpringSum {
  Triple<Real> force{0, 0, 0};
  Real largest2 = 0;

  /// Adds one spring: `along` points from the point to its neighbour [m].
  TROCAR_HD void Add(Triple<Real> along, Real stiffness, Real rest_length) {
    const Real length = SquareRoot(Dot(along, along));
    if (!(length > Real(0))) return;  // no direction
    const Real secant = stiffness * (length - rest_length) / length;
    force = force + secant * along;
    largest2 = Larger(largest2, secant * secant * length * length);
  }
};

/// Finishes a point after its springs, alike in all four layouts: virtual spring, weight, external force, and the step.
template <typename Real, typename Memory, bool kCoalesced>
TROCAR_HD void FinishPaperPoint(const PaperArgs<Real, Memory>& args, std::uint32_t i, Triple<Real> here,
                                SpringSum<Real> springs) {
  const auto field_at = [&](std::uint32_t field) {
    return FieldAt<kCoalesced>(i, field, kPointFields, args.pitch);
  };
  const Real mass = Load(args.positions, field_at(3));
  const Real condition = Load(args.positions, field_at(4));
  Triple<Real> next = here;
  if (condition != Real(kConditionPrescribed)) {
    const Triple<Real> weight = mass * args.gravity;
    Triple<Real> residual = args.stiffness_scale * springs.force + weight;
    Real largest2 =
        Larger(args.stiffness_scale * args.stiffness_scale * springs.largest2, Dot(weight, weight));
    if (Exists(args.rest_points)) {
      const Triple<Real> rest = LoadTriple<kCoalesced>(args.rest_points, i, kRestFields, args.pitch);
      const Real k =
          args.shape_scale * Load(args.rest_points, FieldAt<kCoalesced>(i, 3, kRestFields, args.pitch));
      const Triple<Real> shape = k * (rest - here);
      residual = residual + shape;
      largest2 = Larger(largest2, Dot(shape, shape));
    }
    if (condition == Real(kConditionForce)) {
      const Triple<Real> external = LoadTriple<kCoalesced>(args.external_force, i, kForceFields, args.pitch);
      residual = residual + external;
      largest2 = Larger(largest2, Dot(external, external));
    }
    next = here + args.alpha * residual;
    if (Exists(args.largest)) {
      AtomicMax(args.largest, 0, ToKey(Dot(residual, residual)));
      AtomicMax(args.largest, 1, ToKey(largest2));
    }
  }
  Store(args.next_positions, field_at(0), next.x);
  Store(args.next_positions, field_at(1), next.y);
  Store(args.next_positions, field_at(2), next.z);
  Store(args.next_positions, field_at(3), mass);
  Store(args.next_positions, field_at(4), condition);
}

/// Neighbours by index from global memory: the paper's global and coalesced layouts.
template <typename Real, typename Memory, bool kCoalesced>
struct PaperGlobal {
  using Args = PaperArgs<Real, Memory>;
  struct Shared {};
  struct Registers {};
  static constexpr int kPhases = 1, kLoopBegin = 1, kLoopEnd = 1;
  static constexpr Barrier kBarrier[kPhases] = {Barrier::kNone};

  template <typename Allocator>
  static TROCAR_HD Shared MakeShared(Allocator&, const Args&) {
    return {};
  }
  static TROCAR_HD bool GoesOn(const Registers&) { return false; }

  template <int kPhase>
  static TROCAR_HD void Run(const ThreadIndex& where, const Args& args, Shared&, Registers&) {
    const std::uint32_t i = where.block * where.threads_per_block + where.thread;
    if (i >= args.points) return;
    const Triple<Real> here = LoadTriple<kCoalesced>(args.positions, i, kPointFields, args.pitch);
    SpringSum<Real> springs;
    for (std::uint32_t d = 0; d < args.max_neighbors; ++d) {
      const std::size_t link = FieldAt<kCoalesced>(i, d, args.max_neighbors, args.pitch);
      const std::uint32_t other = Load(args.neighbors, link);
      if (other == kNoNeighbor) break;  // the rest of the row is empty
      const Triple<Real> there = LoadTriple<kCoalesced>(args.positions, other, kPointFields, args.pitch);
      const Real stiffness =
          Exists(args.link_stiffness) ? Load(args.link_stiffness, link) : args.mesh_stiffness;
      springs.Add(there - here, stiffness, Load(args.length_rest, link));
    }
    FinishPaperPoint<Real, Memory, kCoalesced>(args, i, here, springs);
  }
};

/// Neighbours from a tile in shared memory: the paper's shared, and shared and coalesced, layouts.
template <typename Real, typename Memory, bool kCoalesced>
struct PaperShared {
  using Args = PaperArgs<Real, Memory>;
  struct Shared {
    typename Memory::template Array<Real> tile;  ///< coordinates of the block's points and those around them
  };
  struct Registers {};
  static constexpr int kPhases = 2, kLoopBegin = 2, kLoopEnd = 2;
  static constexpr Barrier kBarrier[kPhases] = {Barrier::kBlock, Barrier::kNone};
  static constexpr std::uint32_t kTilePoints = kTileBorderSide * kTileBorderSide;

  template <typename Allocator>
  static TROCAR_HD Shared MakeShared(Allocator& allocator, const Args&) {
    return {allocator.template Array<Real>(3 * kTilePoints)};
  }
  static TROCAR_HD bool GoesOn(const Registers&) { return false; }

  /// Where coordinate `axis` of a point of the tile lies; column and row count from the border.
  static TROCAR_HD std::size_t TileAt(int column, int row, std::uint32_t axis) {
    return FieldAt<kCoalesced>(
        static_cast<std::uint32_t>(row) * kTileBorderSide + static_cast<std::uint32_t>(column), axis, 3,
        kTilePoints);
  }

  /// Copies the point that lies `step_column`, `step_row` away, where there is one.
  static TROCAR_HD void Copy(const Args& args, Shared& shared, int column, int row, int tile_column,
                             int tile_row) {
    if (column < 0 || row < 0 || column >= static_cast<int>(args.columns) ||
        row >= static_cast<int>(args.rows))
      return;
    const auto i = static_cast<std::uint32_t>(row) * args.columns + static_cast<std::uint32_t>(column);
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      Store(shared.tile, TileAt(tile_column, tile_row, axis),
            Load(args.positions, FieldAt<kCoalesced>(i, axis, kPointFields, args.pitch)));
    }
  }

  template <int kPhase>
  static TROCAR_HD void Run(const ThreadIndex& where, const Args& args, Shared& shared, Registers&) {
    constexpr int kSide = kTileSide;
    const auto tiles_across = static_cast<int>((args.columns + kTileSide - 1) / kTileSide);
    const int in_column = static_cast<int>(where.thread) % kSide,
              in_row = static_cast<int>(where.thread) / kSide;
    const int column = static_cast<int>(where.block) % tiles_across * kSide + in_column;
    const int row = static_cast<int>(where.block) / tiles_across * kSide + in_row;
    if constexpr (kPhase == 0) {
      // every thread its own point; those at the tile's rim also the border beside them, and its corners
      const int west = in_column == 0 ? -1 : 0, east = in_column == kSide - 1 ? 1 : 0;
      const int north = in_row == 0 ? -1 : 0, south = in_row == kSide - 1 ? 1 : 0;
      for (int step_row = north; step_row <= south; ++step_row) {
        for (int step_column = west; step_column <= east; ++step_column) {
          Copy(args, shared, column + step_column, row + step_row, in_column + 1 + step_column,
               in_row + 1 + step_row);
        }
      }
    } else {
      if (column >= static_cast<int>(args.columns) || row >= static_cast<int>(args.rows)) return;
      const auto i = static_cast<std::uint32_t>(row) * args.columns + static_cast<std::uint32_t>(column);
      const auto tile_point = [&](int step_column, int step_row) {
        const int tile_column = in_column + 1 + step_column, tile_row = in_row + 1 + step_row;
        return Triple<Real>{Load(shared.tile, TileAt(tile_column, tile_row, 0)),
                            Load(shared.tile, TileAt(tile_column, tile_row, 1)),
                            Load(shared.tile, TileAt(tile_column, tile_row, 2))};
      };
      const Triple<Real> here = tile_point(0, 0);
      SpringSum<Real> springs;
      for (std::uint32_t d = 0; d < kGridNeighbors; ++d) {
        const std::size_t link = FieldAt<kCoalesced>(i, d, kGridNeighbors, args.pitch);
        if (Load(args.connected, link) == 0) continue;
        const Real stiffness =
            Exists(args.link_stiffness) ? Load(args.link_stiffness, link) : args.mesh_stiffness;
        springs.Add(tile_point(NeighborColumn(d), NeighborRow(d)) - here, stiffness,
                    Load(args.length_rest, link));
      }
      FinishPaperPoint<Real, Memory, kCoalesced>(args, i, here, springs);
    }
  }
};

}  // namespace trocar::tissue_cuda
