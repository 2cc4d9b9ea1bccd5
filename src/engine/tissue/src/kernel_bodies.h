// SPDX-License-Identifier: Apache-2.0
/// \file kernel_bodies.h  The inner loops; see kernels.h. Included by kernels_*.cpp only.
#pragma once

#include "kernel_lanes.h"

namespace trocar::tissue {
namespace {

/// to + d x t
inline Vector AddTurn(const float* t, const Vector& d, const Vector& to) {
  const Lanes x = Load(t), y = Load(t + kSliceNodes), z = Load(t + 2 * kSliceNodes);
  return {to.x + (d.y * z - d.z * y), to.y + (d.z * x - d.x * z), to.z + (d.x * y - d.y * x)};
}

/// to + S d. Only the last sum waits for what was added before.
template <std::size_t kLinkFloats>
inline Vector AddLink(const float* link, const Vector& d, const Vector& to) {
  if constexpr (kLinkFloats == kBlockFloats) return MulAddSymmetric(link, d, to);
  const Vector v = {Load(link + kSliceNodes), Load(link + 2 * kSliceNodes), Load(link + 3 * kSliceNodes)};
  const Lanes a = Load(link), along = (v.x * d.x + v.y * d.y) + v.z * d.z;
  return {to.x + (a * d.x + along * v.x), to.y + (a * d.y + along * v.y), to.z + (a * d.z + along * v.z)};
}

template <std::size_t kLinkFloats, LinkPass kPass, bool kHasTurns = false>
void Multiply(const LinkMatrix& m, const Float4* x, const Float4* b, float factor, Float4* out,
              std::uint32_t first_slice, std::uint32_t last_slice) {
  for (std::uint32_t slice = first_slice; slice < last_slice; ++slice) {
    for (std::uint32_t lane = 0; lane < kSliceNodes; lane += TROCAR_LANES) {
      const std::uint32_t i = slice * kSliceNodes + lane;
      const float* const inverse = m.inverse + std::size_t{slice} * 6 * kSliceNodes + lane;
      if constexpr (kPass == LinkPass::kStart) {
        StoreNodes(out + i, All(factor) * MulAddSymmetric(inverse, LoadNodes(b + i), Vector{}));
        continue;
      }
      const Vector here = LoadNodes(x + i);
      Vector force{};
      if constexpr (kPass != LinkPass::kFollower)
        force =
            MulAddSymmetric(m.diagonal_excess + std::size_t{slice} * 6 * kSliceNodes + lane, -here, Vector{});
      for (std::uint32_t step = m.table.starts[slice]; step < m.table.starts[slice + 1]; ++step) {
        const Vector along = GatherNodes(x, m.table.others + std::size_t{step} * kSliceNodes + lane) - here;
        if constexpr (kPass != LinkPass::kFollower)
          force = AddLink<kLinkFloats>(m.links + std::size_t{step} * kLinkFloats * kSliceNodes + lane, along,
                                       force);
        if constexpr (kHasTurns)
          force = AddTurn(m.follower + std::size_t{step} * 3 * kSliceNodes + lane, along, force);
      }
      const Lanes is_free = Load(m.is_free + i);
      if constexpr (kPass == LinkPass::kProduct || kPass == LinkPass::kFollower) {
        StoreNodes(out + i, (All(0.0f) - is_free) * force);
      } else if constexpr (kPass == LinkPass::kResidual) {
        StoreNodes(out + i, is_free * (LoadNodes(b + i) + force));
      } else {
        const Vector residual = LoadNodes(b + i) + force;
        StoreNodes(out + i, MulAddSymmetric(inverse, All(factor) * residual, here));
      }
    }
  }
}

template <std::size_t kLinkFloats>
void Multiply(const LinkMatrix& matrix, LinkPass pass, const Float4* x, const Float4* b, float factor,
              Float4* out, std::uint32_t first, std::uint32_t last) {
  switch (pass) {
    case LinkPass::kStart:
      return Multiply<kLinkFloats, LinkPass::kStart>(matrix, x, b, factor, out, first, last);
    case LinkPass::kProduct:
      return matrix.follower == nullptr
                 ? Multiply<kLinkFloats, LinkPass::kProduct>(matrix, x, b, factor, out, first, last)
                 : Multiply<kLinkFloats, LinkPass::kProduct, true>(matrix, x, b, factor, out, first, last);
    case LinkPass::kFollower:
      return Multiply<kLinkFloats, LinkPass::kFollower, true>(matrix, x, b, factor, out, first, last);
    case LinkPass::kResidual:
      return Multiply<kLinkFloats, LinkPass::kResidual>(matrix, x, b, factor, out, first, last);
    case LinkPass::kSmooth:
      return Multiply<kLinkFloats, LinkPass::kSmooth>(matrix, x, b, factor, out, first, last);
  }
}

void MultiplyLinks(const LinkMatrix& matrix, LinkPass pass, const Float4* x, const Float4* b, float factor,
                   Float4* out, std::uint32_t first_slice, std::uint32_t last_slice) {
  const auto multiply =
      matrix.link_floats == kSpringLinkFloats ? Multiply<kSpringLinkFloats> : Multiply<kBlockFloats>;
  multiply(matrix, pass, x, b, factor, out, first_slice, last_slice);
}

inline Vector LoadRow(const float* from, std::size_t stride) {
  return {Load(from), Load(from + stride), Load(from + 2 * stride)};
}
inline void StoreRow(float* to, std::size_t stride, const Vector& v) {
  Store(to, v.x), Store(to + stride, v.y), Store(to + 2 * stride, v.z);
}
/// Displacements of a step by node, and all that is done to them.
struct ByNode {
  static Vector Load(const SliceStep& s, std::uint32_t node) { return LoadNodes(s.u + node); }
  static Vector LoadPrevious(const SliceStep& s, std::uint32_t node) { return LoadNodes(s.previous + node); }
  static Vector LoadOthers(const SliceStep& s, std::uint32_t step, std::uint32_t lane) {
    return GatherNodes(s.u, s.table.others + std::size_t{step} * kSliceNodes + lane);
  }
  static void Store(const SliceStep& s, std::uint32_t node, const Vector& next) {
    StoreNodes(s.previous + node, next);
  }
};

#if TROCAR_LANES == 16
/// Displacements of a step by slice, and all that is done to them.
struct BySlice {
  static Vector Load(const SliceStep& s, std::uint32_t node) {
    return LoadRow(s.u_by_slice + std::size_t{node} * 3, kSliceNodes);
  }
  static Vector LoadPrevious(const SliceStep& s, std::uint32_t node) {
    return LoadRow(s.previous_by_slice + std::size_t{node} * 3, kSliceNodes);
  }
  static Vector LoadOthers(const SliceStep& s, std::uint32_t step, std::uint32_t lane) {
    const SliceLookup& lookup = s.lookups[step];
    if (lookup.pairs > 0) [[likely]]
      return LookUp(s.u_by_slice, lookup);
    return GatherNodes(s.u, s.table.others + std::size_t{step} * kSliceNodes + lane);
  }
  static void Store(const SliceStep& s, std::uint32_t node, const Vector& next) {
    StoreRow(s.previous_by_slice + std::size_t{node} * 3, kSliceNodes, next);
    if (s.is_scattered[node / kSliceNodes]) StoreNodes(s.previous + node, next);
  }
};
#endif

template <typename Storage>
float StepSlicesOf(const SliceStep& s, std::uint32_t first_slice, std::uint32_t last_slice) {
  LargestResidual largest;
  for (std::uint32_t slice = first_slice; slice < last_slice; ++slice) {
    for (std::uint32_t lane = 0; lane < kSliceNodes; lane += TROCAR_LANES) {
      const std::uint32_t i = slice * kSliceNodes + lane;
      const Vector here = Storage::Load(s, i);
      Vector force = {};
      for (std::uint32_t step = s.table.starts[slice]; step < s.table.starts[slice + 1]; ++step) {
        const Vector there = Storage::LoadOthers(s, step, lane);
        const float* const spring = s.springs + std::size_t{step} * 5 * kSliceNodes + lane;
        const Vector rest = LoadRow(spring, kSliceNodes);
        const Lanes k = Load(spring + 3 * kSliceNodes), k_times_rest = Load(spring + 4 * kSliceNodes);
        const Vector along = rest + (there - here);
        force = MulAdd(CalcSecant(k, k_times_rest, CalcLength(along)), along, force);
      }
      const float* const node = s.nodes + std::size_t{slice} * 5 * kSliceNodes + lane;
      const Lanes shape = Load(node + 3 * kSliceNodes), step_length = Load(node + 4 * kSliceNodes);
      force = MulAdd(-shape, here, force) + LoadRow(node, kSliceNodes);
      const Vector before = s.is_first ? here : Storage::LoadPrevious(s, i);
      Storage::Store(
          s, i, MulAdd(All(s.omega), MulAdd(All(s.damping) * step_length, force, here) - before, before));
      if (s.is_measured) largest.Add(step_length, force);
    }
  }
  return largest.Find();
}

float StepSlices(const SliceStep& s, std::uint32_t first_slice, std::uint32_t last_slice) {
#if TROCAR_LANES == 16
  if (s.lookups != nullptr) return StepSlicesOf<BySlice>(s, first_slice, last_slice);
#endif
  return StepSlicesOf<ByNode>(s, first_slice, last_slice);
}

inline Vector ShiftUp(const Vector& before, const Vector& v) {
  return {ShiftUp(before.x, v.x), ShiftUp(before.y, v.y), ShiftUp(before.z, v.z)};
}

/// Springs of one direction: extent, and length or secant stiffness.
struct GridLinks {
  Vector along;
  Lanes value;

  Vector Force() const { return value * along; }
};

/// Extent of a row's springs whose ends are `apart` farther apart than at rest. On an aligned mesh the rest
/// offsets lie along the columns, along the rows, or in their plane, and the rest of their components is
/// zero.
template <bool kIsAligned>
inline Vector CalcExtent(const float* springs, GridDirection direction, Vector apart) {
  const float* const spring = springs + direction * 5 * kSliceNodes;
  if (!kIsAligned || direction != kSouth) apart.x = apart.x + Load(spring);
  if (!kIsAligned || direction != kEast) apart.y = apart.y + Load(spring + kSliceNodes);
  if (!kIsAligned) apart.z = apart.z + Load(spring + 2 * kSliceNodes);
  return apart;
}

inline Lanes CalcSecant(const float* springs, GridDirection direction, Lanes length) {
  const float* const spring = springs + direction * 5 * kSliceNodes;
  return CalcSecant(Load(spring + 3 * kSliceNodes), Load(spring + 4 * kSliceNodes), length);
}

enum class GridRow { kHalo, kPlain, kMeasured };

/// A block's springs to the row below and to the next column: references to variables, because compilers would keep a struct
/// of the links themselves in memory.
struct RowLinks {
  GridLinks &south, &south_east, &south_west, &east;
};

/// One row of a step: where its numbers lie, and what is done with a block of its columns.
template <bool kHasWest, bool kIsAligned, GridRow kRow>
struct RowStep {
  static constexpr bool kIsHalo = kRow == GridRow::kHalo;

  std::size_t stride, direction;  // floats from axis to axis, and from one direction's reactions to the next
  const float *springs, *node;    // of the present block
  const float *u, *below, *before_from;
  float* previous;
  const float* above;  // reactions of the row above
  float* reaction;
  Lanes omega, damping;
  Vector east_before = {};

  RowStep(const GridStep& s, std::uint32_t row)
      : stride(s.stride),
        direction(3 * stride + 2 * kSliceNodes),
        springs(row + 1 == s.rows ? s.last_springs : s.springs + std::size_t{row} * s.spring_row),
        node(s.nodes + std::size_t{s.node_rows[row]} * 5 * stride),
        u(s.u + 3 * row * stride),
        below(u + 3 * stride),
        before_from(s.is_first ? u : s.previous + 3 * row * stride),
        previous(s.previous + 3 * row * stride),
        above(s.reaction + (row + 1) % 2 * 3 * direction + kSliceNodes),
        reaction(s.reaction + row % 2 * 3 * direction + kSliceNodes),
        omega(All(s.omega)),
        damping(All(s.damping)) {}

  [[gnu::always_inline]] Lanes CalcSpringLength(GridDirection where, const float* there, std::size_t column,
                                                const Vector& here, GridLinks& links) const {
    links.along = CalcExtent<kIsAligned>(springs, where, LoadRow(there + column, stride) - here);
    return CalcLength(links.along);
  }

  /// Extents and lengths of the block's springs.
  [[gnu::always_inline]] void Measure(std::size_t column, const RowLinks& links) const {
    Vector here = LoadRow(u + column, stride);
    KeepInRegister(here);
    Lanes south = CalcSpringLength(kSouth, below, column, here, links.south);
    Lanes south_east = CalcSpringLength(kSouthEast, below + 1, column, here, links.south_east);
    if constexpr (kHasWest)
      links.south_west.value = CalcSpringLength(kSouthWest, below - 1, column, here, links.south_west);
    // all roots before the first quotient: the divider loses time when it goes from one to the other
    if constexpr (kIsHalo) {
      BeginTogether(south, south_east);
    } else {
      Lanes east = CalcSpringLength(kEast, u + 1, column, here, links.east);
      BeginTogether(south, south_east, east);
      links.east.value = east;
    }
    links.south.value = south, links.south_east.value = south_east;
  }

  /// Lengths to secant stiffness.
  [[gnu::always_inline]] void Divide(const RowLinks& links) const {
    links.south.value = CalcSecant(springs, kSouth, links.south.value);
    links.south_east.value = CalcSecant(springs, kSouthEast, links.south_east.value);
    if constexpr (kHasWest) links.south_west.value = CalcSecant(springs, kSouthWest, links.south_west.value);
    if constexpr (!kIsHalo) links.east.value = CalcSecant(springs, kEast, links.east.value);
  }

  /// Adds up the forces, leaves those on the row below, and moves the nodes.
  [[gnu::always_inline]] void Finish(std::size_t column, const RowLinks& links, LargestResidual& largest) {
    const Vector on_south = links.south.Force(), on_south_east = links.south_east.Force();
    Vector force = on_south + on_south_east;
    Vector on_south_west;
    if constexpr (kHasWest) {
      on_south_west = links.south_west.Force();
      force = force + on_south_west;
    }
    if constexpr (!kIsHalo) MoveNodes(column, links.east.Force(), force, largest);
    StoreRow(reaction + column, stride, on_south);
    StoreRow(reaction + direction + column, stride, on_south_east);
    if constexpr (kHasWest) StoreRow(reaction + 2 * direction + column, stride, on_south_west);
    node += TROCAR_LANES + ((column + TROCAR_LANES) % kSliceNodes == 0 ? 4 * kSliceNodes : 0);
  }

  /// \param force  of the springs to the row below
  [[gnu::always_inline]] void MoveNodes(std::size_t column, const Vector& on_east, Vector force,
                                        LargestResidual& largest) {
    const Vector here = LoadRow(u + column, stride);
    // the springs of the row above, from straight above and from either side
    force = force - LoadRow(above + column, stride);
    force = force - LoadRow(above + direction + column - 1, stride);
    if constexpr (kHasWest) force = force - LoadRow(above + 2 * direction + column + 1, stride);
    force = (force + on_east) - ShiftUp(east_before, on_east);
    east_before = on_east;
    force = MulAdd(-Load(node + 3 * kSliceNodes), here, force) + LoadRow(node, kSliceNodes);
    const Lanes step_length = Load(node + 4 * kSliceNodes);
    Lanes step = damping * step_length;
    Vector before = LoadRow(before_from + column, stride);
    KeepInRegister(step), KeepInRegister(before);
    StoreRow(previous + column, stride, MulAdd(omega, MulAdd(step, force, here) - before, before));
    if constexpr (kRow == GridRow::kMeasured) largest.Add(step_length, force);
  }

  /// The springs of the block that begins at `column`.
  [[gnu::always_inline]] void GoOn(std::size_t column) {
    springs += TROCAR_LANES + (column % kSliceNodes == 0 ? (5 * kGridDirections - 1) * kSliceNodes : 0);
  }
};

/// One row: updates its nodes unless it is only the halo of the rows below, and leaves the forces of its springs to the next
/// row, which feels the opposite. Lengths are taken a block ahead, so that the divider works while the forces of the block
/// before are added up, where the compiler keeps that order.
template <bool kHasWest, bool kIsAligned, GridRow kRow>
void StepRow(const GridStep& s, std::uint32_t row, LargestResidual& largest) {
  RowStep<kHasWest, kIsAligned, kRow> step(s, row);
  const std::size_t stride = s.stride;
  GridLinks south, south_east, south_west, east;
  const RowLinks links{south, south_east, south_west, east};
  if constexpr (!kKeepsOrder) {
    for (std::size_t column = 0; column < stride; column += TROCAR_LANES) {
      if (column > 0) step.GoOn(column);
      step.Measure(column, links);
      step.Divide(links);
      step.Finish(column, links, largest);
    }
    return;
  }
  step.Measure(0, links);
  step.Divide(links);
  for (std::size_t column = TROCAR_LANES; column < stride; column += TROCAR_LANES) {
    step.GoOn(column);
    GridLinks next_south, next_south_east, next_south_west, next_east;
    step.Measure(column, {next_south, next_south_east, next_south_west, next_east});
    step.Finish(column - TROCAR_LANES, links, largest);
    south = next_south, south_east = next_south_east;
    if constexpr (kHasWest) south_west = next_south_west;
    if constexpr (!RowStep<kHasWest, kIsAligned, kRow>::kIsHalo) east = next_east;
    step.Divide(links);
  }
  step.Finish(stride - TROCAR_LANES, links, largest);
}

template <bool kHasWest, bool kIsAligned>
float StepRowsOf(const GridStep& s, std::uint32_t first_row, std::uint32_t last_row) {
  LargestResidual largest;
  if (first_row == 0) {
    for (std::size_t at = 0; at < 2 * ReactionFloats(s.stride); at += TROCAR_LANES)
      Store(s.reaction + at, Lanes{});
  } else {
    StepRow<kHasWest, kIsAligned, GridRow::kHalo>(s, first_row - 1, largest);
  }
  for (std::uint32_t row = first_row; row < last_row; ++row) {
    s.is_measured ? StepRow<kHasWest, kIsAligned, GridRow::kMeasured>(s, row, largest)
                  : StepRow<kHasWest, kIsAligned, GridRow::kPlain>(s, row, largest);
  }
  return largest.Find();
}

float StepRows(const GridStep& s, std::uint32_t first_row, std::uint32_t last_row) {
  if (s.has_south_west) {
    return s.is_aligned ? StepRowsOf<true, true>(s, first_row, last_row)
                        : StepRowsOf<true, false>(s, first_row, last_row);
  }
  return s.is_aligned ? StepRowsOf<false, true>(s, first_row, last_row)
                      : StepRowsOf<false, false>(s, first_row, last_row);
}

}  // namespace
}  // namespace trocar::tissue
