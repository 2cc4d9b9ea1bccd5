// SPDX-License-Identifier: Apache-2.0
/// \file tiled_args.h  The data of our own layout: displacements instead of positions, nodes in compact
/// tiles, springs in slices.
///
/// Nodes are renumbered so that 256 of them, a tile, lie together in space; a tile lists the nodes of other
/// tiles that its springs reach, its border. Half-springs stand in slices of 32 nodes, a warp, padded to the
/// longest row (sliced ELLPACK), so that threads side by side read side by side. A spring is kept as its
/// vector at rest and the excess |r|^2 - l^2: with displacements its stretch then loses nothing to
/// cancellation, and single precision holds. What a tick changes (positions, conditions, forces, contacts,
/// intact strands) comes as the host has it, in the model's order and in double precision, and is converted
/// on the GPU.
#pragma once

#include "chebyshev_control.h"

namespace trocar::tissue_cuda {

inline constexpr std::uint32_t kTileNodes = 256;  // also the threads of a block
inline constexpr std::uint32_t kSliceNodes = 32;
inline constexpr std::uint32_t kNoNode = 0xffffffffu;

/// Half-spring as the kernels read it.
template <typename Real>
struct RestLink {
  Quad<Real> vector_stiffness;  ///< r = rest_other - rest_here [m]; k [N/m]
  Real length, excess;          ///< l [m]; |r|^2 - l^2 [m^2]
};
template <typename Real>
struct alignas(2 * sizeof(Real)) LengthExcess {
  Real length, excess;
};

struct HalfStrandEntry {
  std::uint32_t other;   ///< renumbered
  std::uint32_t strand;  ///< index of its intact flag
  double stiffness;      ///< [N/m]
};

/// A contact as uploaded: its depth is measured against displacements.
struct ContactEntry {
  std::uint32_t nodes[3];  ///< renumbered
  double weights[3];
  double normal[3];
  double rest_depth;  ///< depth with all displacements zero [m]
  double stiffness;   ///< [N/m]
};

/// Report of a solve, which comes back beside the positions.
struct TiledReport {
  double residual, force_scale;
  std::uint32_t iterations, restarts, converged;
};

inline constexpr std::uint32_t kMaxima = 3;      // residual2, force2, is cut short
inline constexpr std::uint32_t kMaximaSets = 3;  // one is written, one read, one cleared

/// The model: constant.
template <typename Real, typename Memory>
struct TiledMesh {
  template <typename T>
  using Array = typename Memory::template Array<T>;

  std::uint32_t nodes = 0;  ///< without padding
  std::uint32_t tiles = 0;
  std::uint32_t max_border = 0, max_links = 0;  ///< of any tile: capacity of shared memory
  Array<std::uint32_t> model_index{};           ///< (256 tiles) renumbered -> model; kNoNode pads
  Array<Triple<double>> rest{};                 ///< (256 tiles) [m]
  Array<double> mass{};                         ///< (256 tiles) [kg]
  Array<Real> shape_stiffness{};                ///< (256 tiles) [N/m]
  Array<std::uint32_t> slice_starts{};          ///< (8 tiles + 1) first link of each slice
  Array<Quad<Real>> link_vectors{};             ///< (links) see RestLink
  Array<LengthExcess<Real>> link_rests{};       ///< (links)
  Array<std::uint32_t> link_others{};           ///< (links) renumbered
  Array<std::uint16_t> link_locals{};           ///< (links) place in the tile, or 256 + place in its border
  Array<std::uint32_t> border_starts{};         ///< (tiles + 1)
  Array<std::uint32_t> borders{};               ///< renumbered nodes of other tiles
  Array<std::uint32_t> strand_starts{};         ///< (256 tiles + 1), or none
  Array<HalfStrandEntry> strands{};
};

template <typename Real, typename Memory>
struct TiledArgs {
  template <typename T>
  using Array = typename Memory::template Array<T>;

  TiledMesh<Real, Memory> mesh;
  ChebyshevSettings<Real> settings;
  Real stiffness_scale = 1, shape_scale = 1;
  Triple<double> gravity{};  ///< [m/s^2]

  // per solve, in the model's order
  Array<Triple<double>> positions{};       ///< in and out [m]
  Array<std::uint8_t> prescribed{};        ///< 1 where the position is given
  Array<Triple<double>> external_force{};  ///< [N], or none
  Array<std::uint8_t> intact{};            ///< (strands)
  std::uint32_t touched = 0;
  Array<ContactEntry> contacts{};
  Array<std::uint32_t> touched_nodes{};  ///< (touched) renumbered, ascending
  Array<std::uint32_t> touch_starts{};   ///< (touched + 1)
  Array<std::uint32_t> touch_entries{};  ///< 4 * contact + corner

  // of a solve that the host interrupts, to be resumed in another launch
  bool is_resumed = false;
  Array<ChebyshevControl<Real>> control{};  ///< (1) out; in when resumed
  Array<Triple<double>>
      before_positions{};  ///< out; in when resumed, in the model's order: the iteration before [m]; or none

  // work
  Array<Quad<Real>> displacements{};   ///< (2 * 256 tiles) two buffers [m]
  Array<Quad<Real>> node_constants{};  ///< (3 * 256 tiles) see StoreConstants
  Array<Key> maxima{};                 ///< (3 sets of 3)
  Array<TiledReport> report{};         ///< (1)
};

}  // namespace trocar::tissue_cuda
