// SPDX-License-Identifier: Apache-2.0
/// \file kernel_bodies.h  The inner loops; see kernels.h. Included by kernels_*.cpp only.
#pragma once

#include "kernel_lanes.h"

namespace trocar::tissue {
namespace {

template <LinkPass kPass>
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
      Vector force = MulAddSymmetric(m.ground + std::size_t{slice} * 6 * kSliceNodes + lane, -here, Vector{});
      for (std::uint32_t step = m.table.starts[slice]; step < m.table.starts[slice + 1]; ++step) {
        const Vector there = GatherNodes(x, m.table.others + std::size_t{step} * kSliceNodes + lane);
        force = MulAddSymmetric(m.links + std::size_t{step} * 6 * kSliceNodes + lane, there - here, force);
      }
      const Lanes is_free = Load(m.is_free + i);
      if constexpr (kPass == LinkPass::kProduct) {
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

void MultiplyLinks(const LinkMatrix& matrix, LinkPass pass, const Float4* x, const Float4* b, float factor,
                   Float4* out, std::uint32_t first_slice, std::uint32_t last_slice) {
  switch (pass) {
    case LinkPass::kStart:
      return Multiply<LinkPass::kStart>(matrix, x, b, factor, out, first_slice, last_slice);
    case LinkPass::kProduct:
      return Multiply<LinkPass::kProduct>(matrix, x, b, factor, out, first_slice, last_slice);
    case LinkPass::kResidual:
      return Multiply<LinkPass::kResidual>(matrix, x, b, factor, out, first_slice, last_slice);
    case LinkPass::kSmooth:
      return Multiply<LinkPass::kSmooth>(matrix, x, b, factor, out, first_slice, last_slice);
  }
}

float StepSlices(const SliceStep& s, std::uint32_t first_slice, std::uint32_t last_slice) {
  LargestResidual largest;
  for (std::uint32_t slice = first_slice; slice < last_slice; ++slice) {
    for (std::uint32_t lane = 0; lane < kSliceNodes; lane += TROCAR_LANES) {
      const std::uint32_t i = slice * kSliceNodes + lane;
      const Vector here = LoadNodes(s.u + i);
      Vector force = {};
      for (std::uint32_t step = s.table.starts[slice]; step < s.table.starts[slice + 1]; ++step) {
        const Vector there = GatherNodes(s.u, s.table.others + std::size_t{step} * kSliceNodes + lane);
        const float* const spring = s.springs + std::size_t{step} * 5 * kSliceNodes + lane;
        const Vector rest = {Load(spring), Load(spring + kSliceNodes), Load(spring + 2 * kSliceNodes)};
        const Lanes k = Load(spring + 3 * kSliceNodes), k_times_rest = Load(spring + 4 * kSliceNodes);
        const Vector along = rest + (there - here);
        force = MulAdd(CalcSecant(k, k_times_rest, along), along, force);
      }
      const float* const node = s.nodes + std::size_t{slice} * 5 * kSliceNodes + lane;
      const Vector load = {Load(node), Load(node + kSliceNodes), Load(node + 2 * kSliceNodes)};
      const Lanes shape = Load(node + 3 * kSliceNodes), step_length = Load(node + 4 * kSliceNodes);
      force = MulAdd(-shape, here, force) + load;
      const Vector before = s.is_first ? here : LoadNodes(s.previous + i);
      StoreNodes(s.previous + i,
                 MulAdd(All(s.omega), MulAdd(All(s.damping) * step_length, force, here) - before, before));
      if (s.is_measured) largest.Add(step_length, force);
    }
  }
  return largest.Find();
}

inline Vector LoadRow(const float* from, std::size_t stride) {
  return {Load(from), Load(from + stride), Load(from + 2 * stride)};
}
inline void StoreRow(float* to, std::size_t stride, const Vector& v) {
  Store(to, v.x), Store(to + stride, v.y), Store(to + 2 * stride, v.z);
}
inline Vector ShiftUp(const Vector& before, const Vector& v) {
  return {ShiftUp(before.x, v.x), ShiftUp(before.y, v.y), ShiftUp(before.z, v.z)};
}

/// Force of a row's springs whose ends are `extent` farther apart than at rest. On an aligned mesh the rest
/// offsets lie along the columns, along the rows, or in their plane, and the rest of their components is
/// zero.
template <bool kIsAligned>
inline Vector CalcLinkForce(const float* springs, GridDirection direction, Vector along) {
  const float* const spring = springs + direction * 5 * kSliceNodes;
  if (!kIsAligned || direction != kSouth) along.x = along.x + Load(spring);
  if (!kIsAligned || direction != kEast) along.y = along.y + Load(spring + kSliceNodes);
  if (!kIsAligned) along.z = along.z + Load(spring + 2 * kSliceNodes);
  return CalcSecant(Load(spring + 3 * kSliceNodes), Load(spring + 4 * kSliceNodes), along) * along;
}

/// One row: updates its nodes unless it is only the halo of the rows below, and leaves in `reaction` the
/// forces of its springs to the next row, which feels the opposite.
template <bool kHasWest, bool kIsAligned, bool kIsHalo>
void StepRow(const GridStep& s, std::uint32_t row, LargestResidual& largest) {
  const std::size_t stride = s.stride;
  const float* springs = row + 1 == s.rows ? s.last_springs : s.springs + std::size_t{row} * s.spring_row;
  const float* node = s.nodes + std::size_t{s.node_rows[row]} * 5 * stride;
  const float* const u = s.u + 3 * row * stride;
  const float* const below = u + 3 * stride;
  float* const previous = s.previous + 3 * row * stride;
  const std::size_t direction = 3 * stride + 2 * kSliceNodes;
  const float* const above = s.reaction + (row + 1) % 2 * 3 * direction + kSliceNodes;
  float* const reaction = s.reaction + row % 2 * 3 * direction + kSliceNodes;
  const Lanes omega = All(s.omega);
  Vector east_before = {};
  for (std::size_t column = 0; column < stride; column += TROCAR_LANES) {
    const Vector here = LoadRow(u + column, stride);
    const Vector on_south =
        CalcLinkForce<kIsAligned>(springs, kSouth, LoadRow(below + column, stride) - here);
    const Vector on_south_east =
        CalcLinkForce<kIsAligned>(springs, kSouthEast, LoadRow(below + column + 1, stride) - here);
    Vector force = on_south + on_south_east;
    Vector on_south_west;
    if constexpr (kHasWest) {
      on_south_west =
          CalcLinkForce<kIsAligned>(springs, kSouthWest, LoadRow(below + column - 1, stride) - here);
      force = force + on_south_west;
    }
    if constexpr (!kIsHalo) {
      // the springs of the row above, from straight above and from either side
      force = force - LoadRow(above + column, stride);
      force = force - LoadRow(above + direction + column - 1, stride);
      if constexpr (kHasWest) force = force - LoadRow(above + 2 * direction + column + 1, stride);
      const Vector on_east =
          CalcLinkForce<kIsAligned>(springs, kEast, LoadRow(u + column + 1, stride) - here);
      force = (force + on_east) - ShiftUp(east_before, on_east);
      east_before = on_east;
      force = MulAdd(-Load(node + 3 * kSliceNodes), here, force) + LoadRow(node, kSliceNodes);
      const Lanes step_length = Load(node + 4 * kSliceNodes);
      const Vector before = s.is_first ? here : LoadRow(previous + column, stride);
      StoreRow(previous + column, stride,
               MulAdd(omega, MulAdd(All(s.damping) * step_length, force, here) - before, before));
      if (s.is_measured) largest.Add(step_length, force);
    }
    StoreRow(reaction + column, stride, on_south);
    StoreRow(reaction + direction + column, stride, on_south_east);
    if constexpr (kHasWest) StoreRow(reaction + 2 * direction + column, stride, on_south_west);
    const bool is_block_end = (column + TROCAR_LANES) % kSliceNodes == 0;
    springs += TROCAR_LANES + (is_block_end ? (5 * kGridDirections - 1) * kSliceNodes : 0);
    node += TROCAR_LANES + (is_block_end ? 4 * kSliceNodes : 0);
  }
}

template <bool kHasWest, bool kIsAligned>
float StepRowsOf(const GridStep& s, std::uint32_t first_row, std::uint32_t last_row) {
  LargestResidual largest;
  if (first_row == 0) {
    for (std::size_t at = 0; at < 2 * ReactionFloats(s.stride); at += TROCAR_LANES)
      Store(s.reaction + at, Lanes{});
  } else {
    StepRow<kHasWest, kIsAligned, true>(s, first_row - 1, largest);
  }
  for (std::uint32_t row = first_row; row < last_row; ++row)
    StepRow<kHasWest, kIsAligned, false>(s, row, largest);
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
