// SPDX-License-Identifier: Apache-2.0
#include "paper_arrays.h"

#include <algorithm>
#include <cstdlib>
#include <string>

#include "kernels/paper_layouts.h"

namespace trocar::tissue_cuda {

using math::Vec3;
using tissue::NodeCondition;
using tissue::TissueModel;

namespace {

constexpr std::uint32_t kPitchStep = 32;  // a warp: every field begins where one can begin to read

/// Which of the eight neighbours of node a the node b is in a grid, or none.
std::optional<std::uint32_t> FindDirection(GridShape grid, std::uint32_t a, std::uint32_t b) {
  const int columns = static_cast<int>(b % grid.columns) - static_cast<int>(a % grid.columns);
  const int rows = static_cast<int>(b / grid.columns) - static_cast<int>(a / grid.columns);
  for (std::uint32_t d = 0; d < kGridNeighbors; ++d) {
    if (NeighborColumn(d) == columns && NeighborRow(d) == rows) return d;
  }
  return std::nullopt;
}

bool IsGrid(const TissueModel& model, GridShape grid) {
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
      if (!FindDirection(grid, i, model.half_springs[h].other)) return false;
      // one spring a direction: the arrays have the capacity for no more
      if (h > model.spring_starts[i] && model.half_springs[h].other == model.half_springs[h - 1].other)
        return false;
    }
  }
  return true;
}

/// The field of point i in a flat array, in either order.
template <typename Real>
std::size_t Place(const PaperArrays<Real>& arrays, std::uint32_t i, std::uint32_t field,
                  std::uint32_t fields) {
  return IsCoalesced(arrays.layout) ? FieldAt<true>(i, field, fields, arrays.pitch)
                                    : FieldAt<false>(i, field, fields, arrays.pitch);
}

template <typename Real>
std::size_t CountElements(const PaperArrays<Real>& arrays, std::uint32_t fields) {
  return static_cast<std::size_t>(IsCoalesced(arrays.layout) ? arrays.pitch : arrays.points) * fields;
}

template <typename Real>
void FillLinks(const TissueModel& model, PaperArrays<Real>& arrays) {
  const bool is_shared = IsShared(arrays.layout);
  const std::size_t links = CountElements(arrays, arrays.max_neighbors);
  if (is_shared) {
    arrays.connected.assign(links, 0);
  } else {
    arrays.neighbors.assign(links, kNoNeighbor);
  }
  arrays.length_rest.assign(links, Real(0));
  const double first_stiffness = model.half_springs.empty() ? 0.0 : model.half_springs.front().stiffness;
  const bool is_uniform = std::all_of(model.half_springs.begin(), model.half_springs.end(),
                                      [&](const auto& half) { return half.stiffness == first_stiffness; });
  arrays.mesh_stiffness = static_cast<Real>(first_stiffness);
  if (!is_uniform) arrays.link_stiffness.assign(links, Real(0));
  for (std::uint32_t i = 0; i < arrays.points; ++i) {
    for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
      const auto& half = model.half_springs[h];
      const std::uint32_t d =
          is_shared ? FindDirection(arrays.grid, i, half.other).value_or(0) : h - model.spring_starts[i];
      const std::size_t place = Place(arrays, i, d, arrays.max_neighbors);
      if (is_shared) {
        arrays.connected[place] = 1;
      } else {
        arrays.neighbors[place] = half.other;
      }
      arrays.length_rest[place] = static_cast<Real>(half.rest_length);
      if (!is_uniform) arrays.link_stiffness[place] = static_cast<Real>(half.stiffness);
    }
  }
}

}  // namespace

std::optional<GridShape> FindGridShape(const TissueModel& model) {
  const auto n = static_cast<std::uint32_t>(model.Size());
  if (n == 0) return std::nullopt;
  std::uint32_t farthest = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
      const std::uint32_t other = model.half_springs[h].other;
      farthest = std::max(farthest, other > i ? other - i : i - other);
    }
  }
  if (farthest <= 1) return GridShape{n, 1};  // a chain, or loose points
  // the farthest neighbour lies in the next row: one column back, straight, or one on
  for (const std::uint32_t columns : {farthest + 1, farthest, farthest - 1}) {
    if (columns == 0 || n % columns != 0) continue;
    const GridShape grid{columns, n / columns};
    if (IsGrid(model, grid)) return grid;
  }
  return std::nullopt;
}

bool IsCoalesced(Layout layout) noexcept {
  return layout == Layout::kPaperCoalesced || layout == Layout::kPaperSharedCoalesced;
}

bool IsShared(Layout layout) noexcept {
  return layout == Layout::kPaperShared || layout == Layout::kPaperSharedCoalesced;
}

template <typename Real>
base::Result<PaperArrays<Real>> MakePaperArrays(const TissueModel& model, Layout layout) {
  const auto refuse = [&](const std::string& why) {
    return base::Error{base::ErrorCode::kGpuLayout,
                       "the layout \"" + std::string(LayoutName(layout)) + "\" " + why};
  };
  if (model.Size() == 0) return refuse("needs at least one node");
  if (model.strand_count > 0) {
    return refuse("has no place for strands, which the paper does not have; use the layout \"tiled\"");
  }
  PaperArrays<Real> arrays;
  arrays.layout = layout;
  arrays.points = static_cast<std::uint32_t>(model.Size());
  arrays.pitch = (arrays.points + kPitchStep - 1) / kPitchStep * kPitchStep;
  if (IsShared(layout)) {
    const std::optional<GridShape> grid = FindGridShape(model);
    if (!grid) {
      return refuse(
          "needs a structured mesh, in which neighbours in space are neighbours in the array; use "
          "\"coalesced\"");
    }
    arrays.grid = *grid;
    arrays.max_neighbors = kGridNeighbors;
  } else {
    for (std::uint32_t i = 0; i < arrays.points; ++i) {
      arrays.max_neighbors =
          std::max(arrays.max_neighbors, model.spring_starts[i + 1] - model.spring_starts[i]);
    }
  }
  FillLinks(model, arrays);
  const bool has_shape = std::any_of(model.shape_stiffness.begin(), model.shape_stiffness.end(),
                                     [](double stiffness) { return stiffness > 0.0; });
  if (!has_shape) return arrays;
  arrays.rest_points.assign(CountElements(arrays, kRestFields), Real(0));
  for (std::uint32_t i = 0; i < arrays.points; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      arrays.rest_points[Place(arrays, i, static_cast<std::uint32_t>(axis), kRestFields)] =
          static_cast<Real>(model.rest[i][axis]);
    }
    arrays.rest_points[Place(arrays, i, 3, kRestFields)] = static_cast<Real>(model.shape_stiffness[i]);
  }
  return arrays;
}

template <typename Real>
void FillPoints(const PaperArrays<Real>& arrays, const TissueModel& model, const tissue::TissueState& state,
                const tissue::TissueLoad& load, std::vector<Real>& positions,
                std::vector<Real>& external_force) {
  positions.assign(CountElements(arrays, kPointFields), Real(0));
  external_force.clear();
  if (!load.external_force.empty()) external_force.assign(CountElements(arrays, kForceFields), Real(0));
  for (std::uint32_t i = 0; i < arrays.points; ++i) {
    int condition = kConditionFree;
    if (!external_force.empty() && math::SquaredNorm(load.external_force[i]) > 0.0) {
      condition = kConditionForce;
      for (int axis = 0; axis < 3; ++axis) {
        external_force[Place(arrays, i, static_cast<std::uint32_t>(axis), kForceFields)] =
            static_cast<Real>(load.external_force[i][axis]);
      }
    }
    if (state.condition[i] == NodeCondition::kPrescribed) condition = kConditionPrescribed;
    for (int axis = 0; axis < 3; ++axis) {
      positions[Place(arrays, i, static_cast<std::uint32_t>(axis), kPointFields)] =
          static_cast<Real>(state.position[i][axis]);
    }
    positions[Place(arrays, i, 3, kPointFields)] = static_cast<Real>(model.mass[i]);
    positions[Place(arrays, i, 4, kPointFields)] = static_cast<Real>(condition);
  }
}

template <typename Real>
void ReadPoints(const PaperArrays<Real>& arrays, const std::vector<Real>& positions,
                tissue::TissueState& state) {
  for (std::uint32_t i = 0; i < arrays.points; ++i) {
    if (state.condition[i] == NodeCondition::kPrescribed) continue;
    state.position[i] = {positions[Place(arrays, i, 0, kPointFields)],
                         positions[Place(arrays, i, 1, kPointFields)],
                         positions[Place(arrays, i, 2, kPointFields)]};
  }
}

template <typename Real>
std::uint32_t CountPaperBlocks(const PaperArrays<Real>& arrays) noexcept {
  const auto divide_up = [](std::uint32_t a, std::uint32_t b) { return (a + b - 1) / b; };
  if (!IsShared(arrays.layout)) return divide_up(arrays.points, kPaperThreads);
  return divide_up(arrays.grid.columns, kTileSide) * divide_up(arrays.grid.rows, kTileSide);
}

#define TROCAR_INSTANTIATE(Real)                                                                      \
  template base::Result<PaperArrays<Real>> MakePaperArrays(const TissueModel&, Layout);               \
  template void FillPoints(const PaperArrays<Real>&, const TissueModel&, const tissue::TissueState&,  \
                           const tissue::TissueLoad&, std::vector<Real>&, std::vector<Real>&);        \
  template void ReadPoints(const PaperArrays<Real>&, const std::vector<Real>&, tissue::TissueState&); \
  template std::uint32_t CountPaperBlocks(const PaperArrays<Real>&) noexcept;
TROCAR_INSTANTIATE(float)
TROCAR_INSTANTIATE(double)
#undef TROCAR_INSTANTIATE

}  // namespace trocar::tissue_cuda
