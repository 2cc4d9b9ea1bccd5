// SPDX-License-Identifier: Apache-2.0
/// \file tiled_chebyshev.h  Our own layout: a whole solve in one launch. Blocks stay on the GPU from the
/// first iteration to the last and meet at one grid barrier an iteration; every thread then takes the same
/// decision, so the host is asked nothing.
///
/// TiledResident: a block keeps one tile. Springs lie in shared memory, a node's constants and displacements
/// in
///   registers; an iteration fetches from other blocks only the displacements of the tile's border. The
///   paper's shared-memory layout, for any mesh. For as many tiles as the GPU holds blocks at once.
/// TiledStreaming: blocks walk over all nodes; springs and constants stream from global memory. For any size.
/// Both take the same steps in the same arithmetic: same bits.
#pragma once

#include "tiled_node.h"

namespace trocar::tissue_cuda {

/// Reads, judges and posts what an iteration found; shared by both kernels.
template <typename Real, typename Memory>
struct MaximaExchange {
  using Args = TiledArgs<Real, Memory>;
  using KeyArray = typename Memory::template Array<Key>;

  /// Where set `round` begins: in shared memory two sets take turns, in global memory three.
  static TROCAR_HD std::size_t SharedSet(std::uint32_t round) { return kMaxima * (round % 2); }
  static TROCAR_HD std::size_t GlobalSet(std::uint32_t round) { return kMaxima * (round % kMaximaSets); }

  static TROCAR_HD void Clear(const ThreadIndex& where, const Args& args, const KeyArray& shared) {
    if (where.thread != 0) return;
    for (std::uint32_t i = 0; i < 2 * kMaxima; ++i) Store(shared, i, Key{0});
    if (where.block != 0) return;
    for (std::uint32_t i = 0; i < kMaximaSets * kMaxima; ++i) Store(args.maxima, i, Key{0});
  }

  /// \pre every thread of the warp comes here
  static TROCAR_HD void RaiseShared(const ThreadIndex& where, const KeyArray& shared, std::uint32_t round,
                                    const IterationMaxima<Real>& maxima) {
    const Key residual2 = WarpMax(ToKey(maxima.residual2)), force2 = WarpMax(ToKey(maxima.force2));
    const Key is_cut_short = WarpMax(maxima.is_cut_short ? Key{1} : Key{0});
    if (!SpeaksForWarp(where)) return;
    AtomicMax(shared, SharedSet(round), residual2);
    AtomicMax(shared, SharedSet(round) + 1, force2);
    AtomicMax(shared, SharedSet(round) + 2, is_cut_short);
  }

  /// Behind a block barrier: one thread raises the grid's maxima and clears the sets that come next.
  static TROCAR_HD void RaiseGlobal(const ThreadIndex& where, const Args& args, const KeyArray& shared,
                                    std::uint32_t round) {
    if (where.thread != 0) return;
    for (std::uint32_t i = 0; i < kMaxima; ++i) {
      AtomicMax(args.maxima, GlobalSet(round) + i, Load(shared, SharedSet(round) + i));
      Store(shared, SharedSet(round + 1) + i, Key{0});
      if (where.block == 0) Store(args.maxima, GlobalSet(round + 1) + i, Key{0});
    }
  }

  /// Behind the grid barrier.
  static TROCAR_HD IterationMaxima<Real> Read(const Args& args, std::uint32_t round) {
    return {FromKey<Real>(Load(args.maxima, GlobalSet(round))),
            FromKey<Real>(Load(args.maxima, GlobalSet(round) + 1)),
            Load(args.maxima, GlobalSet(round) + 2) != 0};
  }

  static TROCAR_HD void WriteReport(const ThreadIndex& where, const Args& args,
                                    const ChebyshevControl<Real>& control) {
    if (where.block != 0 || where.thread != 0) return;
    if (Exists(args.control)) Store(args.control, 0, control);
    Store(args.report, 0,
          TiledReport{double(control.residual), double(control.force_scale), control.iterations,
                      control.restarts, control.converged ? 1u : 0u});
  }
};

/// Displacement of a node from the host's position [m].
template <typename Real, typename Memory>
TROCAR_HD Triple<Real> ReadDisplacement(const TiledArgs<Real, Memory>& args,
                                        const typename Memory::template Array<Triple<double>>& positions,
                                        std::uint32_t node, std::uint32_t model) {
  const Triple<double> u = Load(positions, model) - Load(args.mesh.rest, node);
  return {Real(u.x), Real(u.y), Real(u.z)};
}

/// Constants of a node for the solve, without the inverse block.
template <typename Real, typename Memory>
TROCAR_HD NodeConstants<Real> ReadConstants(const TiledArgs<Real, Memory>& args, std::uint32_t node,
                                            std::uint32_t model) {
  NodeConstants<Real> constants;
  Triple<double> force = Load(args.mesh.mass, node) * args.gravity;
  if (Exists(args.external_force)) force = force + Load(args.external_force, model);
  constants.force = {Real(force.x), Real(force.y), Real(force.z)};
  constants.shape_stiffness = args.shape_scale * Load(args.mesh.shape_stiffness, node);
  constants.is_free = Load(args.prescribed, model) == 0;
  constants.is_touched = args.touched > 0 && IsTouched(args, node);
  constants.has_strands = Exists(args.mesh.strand_starts) &&
                          Load(args.mesh.strand_starts, node) < Load(args.mesh.strand_starts, node + 1);
  return constants;
}

template <typename Real, typename Memory>
TROCAR_HD void WritePosition(const TiledArgs<Real, Memory>& args,
                             const typename Memory::template Array<Triple<double>>& positions,
                             std::uint32_t node, std::uint32_t model, Triple<Real> u) {
  const Triple<double> rest = Load(args.mesh.rest, node);
  Store(positions, model, Triple<double>{rest.x + double(u.x), rest.y + double(u.y), rest.z + double(u.z)});
}

template <typename Real>
TROCAR_HD Quad<Real> ToQuad(Triple<Real> u) {
  return {u.x, u.y, u.z, Real(0)};
}

/// Constants in three records of four: block; block, stiffness and flags; force.
template <typename Real, typename Memory>
TROCAR_HD void StoreConstants(const TiledArgs<Real, Memory>& args, std::uint32_t node,
                              const NodeConstants<Real>& constants) {
  const std::size_t all = static_cast<std::size_t>(args.mesh.tiles) * kTileNodes;
  const Symmetric<Real>& m = constants.inverse;
  const int flags =
      (constants.is_free ? 1 : 0) + (constants.is_touched ? 2 : 0) + (constants.has_strands ? 4 : 0);
  Store(args.node_constants, node, Quad<Real>{m.xx, m.xy, m.xz, m.yy});
  Store(args.node_constants, all + node, Quad<Real>{m.yz, m.zz, constants.shape_stiffness, Real(flags)});
  Store(args.node_constants, 2 * all + node,
        Quad<Real>{constants.force.x, constants.force.y, constants.force.z, 0});
}
template <typename Real, typename Memory>
TROCAR_HD NodeConstants<Real> LoadConstants(const TiledArgs<Real, Memory>& args, std::uint32_t node) {
  const std::size_t all = static_cast<std::size_t>(args.mesh.tiles) * kTileNodes;
  const Quad<Real> a = Load(args.node_constants, node), b = Load(args.node_constants, all + node);
  const Quad<Real> c = Load(args.node_constants, 2 * all + node);
  const int flags = static_cast<int>(b.w);
  return {
      {a.x, a.y, a.z, a.w, b.x, b.y}, b.z, First3(c), (flags & 1) != 0, (flags & 2) != 0, (flags & 4) != 0};
}

/// State of one node at the start of a launch.
template <typename Real>
struct NodeStart {
  NodeConstants<Real> constants;
  Triple<Real> here{0, 0, 0}, before{0, 0, 0};
};

/// From the host's positions; when resumed, with the inverse block and the iteration before as they were.
template <typename Real, typename Memory>
TROCAR_HD NodeStart<Real> ReadStart(const TiledArgs<Real, Memory>& args, std::uint32_t node,
                                    std::uint32_t model) {
  NodeStart<Real> start;
  if (model == kNoNode) return start;
  start.constants = ReadConstants(args, node, model);
  start.here = start.before = ReadDisplacement(args, args.positions, node, model);
  if (args.is_resumed) {
    start.constants.inverse = LoadConstants(args, node).inverse;
    start.before = ReadDisplacement(args, args.before_positions, node, model);
  }
  return start;
}

template <typename Real, typename Memory>
TROCAR_HD ChebyshevControl<Real> ReadControl(const TiledArgs<Real, Memory>& args) {
  ChebyshevControl<Real> control;
  if (args.is_resumed) {
    control = Load(args.control, 0);
    control.Resume();
  } else {
    control.Begin(args.settings);
  }
  return control;
}

/// Ends a launch for one node.
template <typename Real, typename Memory>
TROCAR_HD void WriteEnd(const TiledArgs<Real, Memory>& args, std::uint32_t node, std::uint32_t model,
                        const NodeConstants<Real>& constants, Triple<Real> here, Triple<Real> before) {
  if (model == kNoNode) return;
  // a prescribed node stays to the bit as the host gave it
  if (constants.is_free) WritePosition(args, args.positions, node, model, here);
  if (!Exists(args.before_positions)) return;
  WritePosition(args, args.before_positions, node, model, before);
  StoreConstants(args, node, constants);
}

template <typename Real, typename Memory>
struct TiledResident {
  using Args = TiledArgs<Real, Memory>;
  using Exchange = MaximaExchange<Real, Memory>;
  template <typename T>
  using Array = typename Memory::template Array<T>;

  struct Shared {
    Array<Quad<Real>> displacements;  ///< (256 + border)
    Array<Quad<Real>> link_vectors;   ///< (links of the tile)
    Array<LengthExcess<Real>> link_rests;
    Array<std::uint16_t> link_locals;
    Array<Key> maxima;  ///< (2 sets of 3)
  };
  struct Registers {
    NodeConstants<Real> constants;
    Triple<Real> here{}, before{}, next{};
    ChebyshevControl<Real> control;
    std::uint32_t model = kNoNode;
    std::uint32_t round = 0;
    std::uint32_t first_link = 0, last_link = 0;  ///< in shared memory
  };
  //                      fill, [border, step, post, decide], write
  static constexpr int kPhases = 6, kLoopBegin = 1, kLoopEnd = 5;
  static constexpr Barrier kBarrier[kPhases] = {Barrier::kGrid, Barrier::kBlock, Barrier::kBlock,
                                                Barrier::kGrid, Barrier::kNone,  Barrier::kNone};

  template <typename Allocator>
  static TROCAR_HD Shared MakeShared(Allocator& allocator, const Args& args) {
    Shared shared;
    shared.displacements = allocator.template Array<Quad<Real>>(kTileNodes + args.mesh.max_border);
    shared.link_vectors = allocator.template Array<Quad<Real>>(args.mesh.max_links);
    shared.link_rests = allocator.template Array<LengthExcess<Real>>(args.mesh.max_links);
    shared.link_locals = allocator.template Array<std::uint16_t>(args.mesh.max_links);
    shared.maxima = allocator.template Array<Key>(2 * kMaxima);
    return shared;
  }

  static TROCAR_HD bool GoesOn(const Registers& registers) { return !registers.control.ended; }

  template <int kPhase>
  static TROCAR_HD void Run(const ThreadIndex& where, const Args& args, Shared& shared,
                            Registers& registers) {
    const std::uint32_t node = where.block * kTileNodes + where.thread;
    const std::size_t all = static_cast<std::size_t>(args.mesh.tiles) * kTileNodes;
    ChebyshevControl<Real>& control = registers.control;
    const auto for_each_link = [&](const auto& visit) {
      for (std::uint32_t link = registers.first_link; link < registers.last_link; link += kSliceNodes) {
        const LengthExcess<Real> rest = Load(shared.link_rests, link);
        const RestLink<Real> rest_link{Load(shared.link_vectors, link), rest.length, rest.excess};
        visit(rest_link, First3(Load(shared.displacements, Load(shared.link_locals, link))));
      }
    };
    if constexpr (kPhase == 0) {
      Exchange::Clear(where, args, shared.maxima);
      const std::uint32_t first = Load(args.mesh.slice_starts, where.block * (kTileNodes / kSliceNodes));
      const std::uint32_t last = Load(args.mesh.slice_starts, (where.block + 1) * (kTileNodes / kSliceNodes));
      for (std::uint32_t link = first + where.thread; link < last; link += kTileNodes) {
        Store(shared.link_vectors, link - first, Load(args.mesh.link_vectors, link));
        Store(shared.link_rests, link - first, Load(args.mesh.link_rests, link));
        Store(shared.link_locals, link - first, Load(args.mesh.link_locals, link));
      }
      const std::uint32_t slice = node / kSliceNodes;
      registers.first_link = Load(args.mesh.slice_starts, slice) - first + node % kSliceNodes;
      registers.last_link = Load(args.mesh.slice_starts, slice + 1) - first;
      registers.model = Load(args.mesh.model_index, node);
      control = ReadControl(args);
      const NodeStart<Real> start = ReadStart(args, node, registers.model);
      registers.constants = start.constants;
      registers.here = start.here;
      registers.before = start.before;
      Store(args.displacements, control.Parity() * all + node, ToQuad(registers.here));
    } else if constexpr (kPhase == 1) {
      Store(shared.displacements, where.thread, ToQuad(registers.here));
      const std::uint32_t first = Load(args.mesh.border_starts, where.block),
                          last = Load(args.mesh.border_starts, where.block + 1);
      for (std::uint32_t at = first + where.thread; at < last; at += kTileNodes) {
        const std::uint32_t other = Load(args.mesh.borders, at);
        Store(shared.displacements, kTileNodes + (at - first),
              Load(args.displacements, control.Parity() * all + other));
      }
    } else if constexpr (kPhase == 2) {
      if (control.needs_blocks) {
        registers.constants.inverse = CalcInverseBlock(args, registers.constants, control.transverse_share,
                                                       node, registers.here, for_each_link);
      }
      IterationMaxima<Real> maxima;
      registers.next =
          CalcNextDisplacement(args, registers.constants, control, node, registers.here,
                               control.IsFirst() ? registers.here : registers.before, for_each_link, maxima);
      Store(args.displacements, (1 - control.Parity()) * all + node, ToQuad(registers.next));
      Exchange::RaiseShared(where, shared.maxima, registers.round, maxima);
    } else if constexpr (kPhase == 3) {
      Exchange::RaiseGlobal(where, args, shared.maxima, registers.round);
    } else if constexpr (kPhase == 4) {
      control.Decide(args.settings, Exchange::Read(args, registers.round));
      ++registers.round;
      if (!control.converged) {
        registers.before = registers.here;
        registers.here = registers.next;
      }
    } else {
      WriteEnd(args, node, registers.model, registers.constants, registers.here, registers.before);
      Exchange::WriteReport(where, args, control);
    }
  }
};

template <typename Real, typename Memory>
struct TiledStreaming {
  using Args = TiledArgs<Real, Memory>;
  using Exchange = MaximaExchange<Real, Memory>;

  struct Shared {
    typename Memory::template Array<Key> maxima;  ///< (2 sets of 3)
  };
  struct Registers {
    ChebyshevControl<Real> control;
    std::uint32_t round = 0;
  };
  //                      fill, [step, post, decide], write
  static constexpr int kPhases = 5, kLoopBegin = 1, kLoopEnd = 4;
  static constexpr Barrier kBarrier[kPhases] = {Barrier::kGrid, Barrier::kBlock, Barrier::kGrid,
                                                Barrier::kNone, Barrier::kNone};

  template <typename Allocator>
  static TROCAR_HD Shared MakeShared(Allocator& allocator, const Args&) {
    return {allocator.template Array<Key>(2 * kMaxima)};
  }

  static TROCAR_HD bool GoesOn(const Registers& registers) { return !registers.control.ended; }

  template <int kPhase>
  static TROCAR_HD void Run(const ThreadIndex& where, const Args& args, Shared& shared,
                            Registers& registers) {
    const std::uint32_t all = args.mesh.tiles * kTileNodes, stride = where.blocks * kTileNodes;
    const std::uint32_t first_node = where.block * kTileNodes + where.thread;
    ChebyshevControl<Real>& control = registers.control;
    if constexpr (kPhase == 0) {
      Exchange::Clear(where, args, shared.maxima);
      control = ReadControl(args);
      for (std::uint32_t node = first_node; node < all; node += stride) {
        const NodeStart<Real> start = ReadStart(args, node, Load(args.mesh.model_index, node));
        StoreConstants(args, node, start.constants);
        Store(args.displacements, std::size_t(control.Parity()) * all + node, ToQuad(start.here));
        Store(args.displacements, std::size_t(1 - control.Parity()) * all + node, ToQuad(start.before));
      }
    } else if constexpr (kPhase == 1) {
      IterationMaxima<Real> maxima;
      for (std::uint32_t node = first_node; node < all; node += stride) {
        const std::uint32_t slice = node / kSliceNodes;
        const std::uint32_t begin = Load(args.mesh.slice_starts, slice) + node % kSliceNodes;
        const std::uint32_t end = Load(args.mesh.slice_starts, slice + 1);
        const auto for_each_link = [&](const auto& visit) {
          for (std::uint32_t link = begin; link < end; link += kSliceNodes) {
            const LengthExcess<Real> rest = Load(args.mesh.link_rests, link);
            const RestLink<Real> rest_link{Load(args.mesh.link_vectors, link), rest.length, rest.excess};
            visit(rest_link, LoadDisplacement(args, control.Parity(), Load(args.mesh.link_others, link)));
          }
        };
        const Triple<Real> here = LoadDisplacement(args, control.Parity(), node);
        NodeConstants<Real> constants = LoadConstants(args, node);
        if (control.needs_blocks) {
          constants.inverse =
              CalcInverseBlock(args, constants, control.transverse_share, node, here, for_each_link);
          StoreConstants(args, node, constants);
        }
        const Triple<Real> before =
            control.IsFirst() ? here : LoadDisplacement(args, 1 - control.Parity(), node);
        const Triple<Real> next =
            CalcNextDisplacement(args, constants, control, node, here, before, for_each_link, maxima);
        Store(args.displacements, std::size_t(1 - control.Parity()) * all + node, ToQuad(next));
      }
      Exchange::RaiseShared(where, shared.maxima, registers.round, maxima);
    } else if constexpr (kPhase == 2) {
      Exchange::RaiseGlobal(where, args, shared.maxima, registers.round);
    } else if constexpr (kPhase == 3) {
      control.Decide(args.settings, Exchange::Read(args, registers.round));
      ++registers.round;
    } else {
      for (std::uint32_t node = first_node; node < all; node += stride) {
        WriteEnd(args, node, Load(args.mesh.model_index, node), LoadConstants(args, node),
                 LoadDisplacement(args, control.Parity(), node),
                 LoadDisplacement(args, 1 - control.Parity(), node));
      }
      Exchange::WriteReport(where, args, control);
    }
  }
};

}  // namespace trocar::tissue_cuda
