// SPDX-License-Identifier: Apache-2.0
#include "spring_grid.h"

#include <algorithm>
#include <cmath>

#include "node_vectors.h"
#include "trocar/base/to_integer.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

/// Rows a thread takes at a time; fixed. The row above each chunk is evaluated twice.
constexpr std::uint32_t kChunkRows = 26;
/// Values that differ by less count as alike [-]: rounding of positions that were computed, not chosen.
constexpr double kAlike = 1e-11;

struct Offset {
  std::int64_t row, column;
};
constexpr std::array<Offset, kGridDirections> kOffsets = {Offset{0, 1}, {1, 0}, {1, 1}, {1, -1}};

/// Direction from node a to node b > a; nothing where they are not neighbours.
std::optional<GridDirection> FindDirection(std::uint32_t a, std::uint32_t b, std::uint32_t columns) {
  const std::int64_t rows = std::int64_t{b / columns} - std::int64_t{a / columns};
  const std::int64_t across = std::int64_t{b % columns} - std::int64_t{a % columns};
  for (int direction = 0; direction < kGridDirections; ++direction) {
    if (kOffsets[direction].row == rows && kOffsets[direction].column == across)
      return static_cast<GridDirection>(direction);
  }
  return std::nullopt;
}

bool IsGrid(const TissueModel& model, std::uint32_t columns) {
  const auto n = static_cast<std::uint32_t>(model.Size());
  if (columns < 3 || n % columns != 0 || n / columns < 3) return false;
  for (std::uint32_t i = 0; i < n; ++i) {
    for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
      const std::uint32_t other = model.half_springs[h].other;
      if (other > i && !FindDirection(i, other, columns)) return false;
      if (h > model.spring_starts[i] && model.half_springs[h - 1].other == other) return false;
    }
  }
  return true;
}

}  // namespace

std::optional<GridShape> FindGridShape(const TissueModel& model) {
  if (model.strand_count > 0 || model.Size() < 9) return std::nullopt;
  // the farthest neighbour of the first node that has one below it is a column away, or one more or less
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
      const std::uint32_t other = model.half_springs[h].other;
      if (other <= i + 1) continue;
      for (const std::uint32_t columns : {other - i - 1, other - i, other - i + 1}) {
        if (IsGrid(model, columns))
          return GridShape{static_cast<std::uint32_t>(model.Size()) / columns, columns};
      }
      return std::nullopt;
    }
  }
  return std::nullopt;
}

GridModel MakeGridModel(const TissueModel& model, const GridShape& shape) {
  GridModel grid{shape, model.rest, {}};
  for (GridSprings& springs : grid.springs) {
    springs.rest_offset.assign(grid.Size(), {1, 0, 0});
    springs.stiffness.assign(grid.Size(), 0.0);
    springs.rest_length.assign(grid.Size(), 0.0);
  }
  for (std::uint32_t i = 0; i < grid.Size(); ++i) {
    for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
      const auto& half = model.half_springs[h];
      if (half.other < i) continue;
      GridSprings& springs = grid.springs[*FindDirection(i, half.other, shape.columns)];
      springs.rest_offset[i] = model.rest[half.other] - model.rest[i];
      springs.stiffness[i] = half.stiffness;
      springs.rest_length[i] = half.rest_length;
    }
  }
  return grid;
}

GridPlace FindGridPlace(std::uint32_t at, std::uint32_t count, std::uint32_t other_count) noexcept {
  const double place = static_cast<double>(at) * (other_count - 1) / (count - 1);
  const auto index = std::min(base::TruncateTo<std::uint32_t>(place), other_count - 2);
  return {index, static_cast<float>(place - index)};
}

GridModel MakeCoarseGrid(const GridModel& fine) {
  const auto [rows, columns] = fine.shape;
  GridModel coarse{{(rows + 1) / 2, (columns + 1) / 2}, {}, {}};
  const auto fine_at = [&](std::uint32_t row, std::uint32_t column) {
    return row * fine.shape.columns + column;
  };
  for (std::uint32_t row = 0; row < coarse.shape.rows; ++row) {
    const GridPlace r = FindGridPlace(row, coarse.shape.rows, fine.shape.rows);
    for (std::uint32_t column = 0; column < coarse.shape.columns; ++column) {
      const GridPlace c = FindGridPlace(column, coarse.shape.columns, fine.shape.columns);
      const auto across = [&](std::uint32_t at_row) {
        const Vec3 left = fine.rest[fine_at(at_row, c.index)],
                   right = fine.rest[fine_at(at_row, c.index + 1)];
        return left + static_cast<double>(c.share) * (right - left);
      };
      const Vec3 above = across(r.index), below = across(r.index + 1);
      coarse.rest.push_back(above + static_cast<double>(r.share) * (below - above));
    }
  }
  for (int direction = 0; direction < kGridDirections; ++direction) {
    const GridSprings& from = fine.springs[direction];
    GridSprings& to = coarse.springs[direction];
    to.rest_offset.assign(coarse.Size(), {1, 0, 0});
    to.stiffness.assign(coarse.Size(), 0.0);
    to.rest_length.assign(coarse.Size(), 0.0);
    for (std::uint32_t row = 0; row < coarse.shape.rows; ++row) {
      for (std::uint32_t column = 0; column < coarse.shape.columns; ++column) {
        const std::int64_t other_row = row + kOffsets[direction].row,
                           other_column = column + kOffsets[direction].column;
        if (other_row >= coarse.shape.rows || other_column < 0 || other_column >= coarse.shape.columns)
          continue;
        const GridPlace r = FindGridPlace(row, coarse.shape.rows, fine.shape.rows);
        const GridPlace c = FindGridPlace(column, coarse.shape.columns, fine.shape.columns);
        const std::uint32_t source = fine_at(r.index, std::max(c.index, direction == kSouthWest ? 1u : 0u));
        const std::uint32_t node = row * coarse.shape.columns + column;
        const Vec3 offset = coarse.rest[static_cast<std::size_t>(other_row) * coarse.shape.columns +
                                        static_cast<std::size_t>(other_column)] -
                            coarse.rest[node];
        if (!(from.stiffness[source] > 0.0) || !(math::SquaredNorm(offset) > 0.0)) continue;
        to.rest_offset[node] = offset;
        to.stiffness[node] = from.stiffness[source];
        const double length = math::Norm(from.rest_offset[source]);
        to.rest_length[node] = math::Norm(offset) * (length > 0.0 ? from.rest_length[source] / length : 1.0);
      }
    }
  }
  return coarse;
}

SpringGrid::SpringGrid(const GridModel& model)
    : shape_(model.shape), stride_((model.shape.columns + kSliceNodes - 1) / kSliceNodes * kSliceNodes) {
  const auto [rows, columns] = shape_;
  sum_stiffness_.assign(model.Size(), 0.0);
  unscaled_.assign(model.Size() * kGridDirections * 2, 0.0);
  is_alike_ = true;
  for (int direction = 0; direction < kGridDirections; ++direction) {
    const GridSprings& springs = model.springs[direction];
    for (std::uint32_t node = 0; node < model.Size(); ++node) {
      const double k = springs.stiffness[node];
      unscaled_[(std::size_t{node} * kGridDirections + direction) * 2] = k;
      unscaled_[(std::size_t{node} * kGridDirections + direction) * 2 + 1] = k * springs.rest_length[node];
      if (k > 0.0) {
        const Vec3& offset = springs.rest_offset[node];
        is_aligned_ = is_aligned_ && offset.z == 0.0 && (direction != kEast || offset.y == 0.0) &&
                      (direction != kSouth || offset.x == 0.0);
        has_south_west_ = has_south_west_ || direction == kSouthWest;
        sum_stiffness_[node] += k;
        sum_stiffness_[node + static_cast<std::size_t>(kOffsets[direction].row * columns +
                                                       kOffsets[direction].column)] += k;
      }
      const std::uint32_t first = node % columns;
      if (node / columns + 1 == rows) continue;  // the last row has its own
      const double length = math::Norm(springs.rest_offset[first]);
      is_alike_ = is_alike_ &&
                  math::Distance(springs.rest_offset[node], springs.rest_offset[first]) <= kAlike * length &&
                  std::fabs(k - springs.stiffness[first]) <= kAlike * springs.stiffness[first] &&
                  std::fabs(springs.rest_length[node] - springs.rest_length[first]) <= kAlike * length;
    }
  }
  const std::size_t row_floats = std::size_t{stride_} * kGridDirections * 5;
  springs_.assign((is_alike_ ? 1 : rows) * row_floats, 0.0f);
  last_springs_.assign(row_floats, 0.0f);
  // padding has no stiffness, but a length
  for (auto* values : {&springs_, &last_springs_}) {
    for (std::size_t i = 0; i < values->size(); ++i) {
      if (i / kSliceNodes % 5 < 2) (*values)[i] = 1.0f;
    }
  }
  const auto set = [&](math::AlignedVector<float>& to, std::uint32_t place, std::uint32_t node) {
    for (int direction = 0; direction < kGridDirections; ++direction) {
      float* const values = to.data() + At(place, kGridDirections * 5) + direction * 5 * kSliceNodes;
      for (int axis = 0; axis < 3; ++axis) {
        values[axis * kSliceNodes] = static_cast<float>(model.springs[direction].rest_offset[node][axis]);
      }
    }
  };
  for (std::uint32_t node = 0; node < (is_alike_ ? columns : model.Size()); ++node) set(springs_, node, node);
  for (std::uint32_t column = 0; column < columns; ++column)
    set(last_springs_, column, (rows - 1) * columns + column);
  nodes_.assign(std::size_t{rows} * stride_ * 5, 0.0f);
  node_rows_.assign(rows, 0);
  u_.assign(std::size_t{rows + 1} * stride_ * 3 + 2 * kMargin, 0.0f);
  previous_ = u_;
  const std::uint32_t chunks = (rows + kChunkRows - 1) / kChunkRows;
  reaction_.assign(std::size_t{chunks} * 2 * ReactionFloats(stride_), 0.0f);
}

void SpringGrid::SetLoad(const GridLoad& load, double scale) noexcept {
  const auto [rows, columns] = shape_;
  const auto set = [&](math::AlignedVector<float>& to, std::uint32_t place, std::uint32_t node) {
    for (int direction = 0; direction < kGridDirections; ++direction) {
      float* const values = to.data() + At(place, kGridDirections * 5) + direction * 5 * kSliceNodes;
      for (int value = 0; value < 2; ++value) {
        values[(3 + value) * kSliceNodes] = static_cast<float>(
            scale * unscaled_[(std::size_t{node} * kGridDirections + direction) * 2 + value]);
      }
    }
  };
  for (std::uint32_t node = 0; node < (is_alike_ ? columns : rows * columns); ++node)
    set(springs_, node, node);
  for (std::uint32_t column = 0; column < columns; ++column)
    set(last_springs_, column, (rows - 1) * columns + column);
  lowest_ = 1.0;
  smallest_shape_ = INFINITY;
  for (std::uint32_t node = 0; node < load.force.size(); ++node) {
    float* const values = nodes_.data() + At(node, 5);
    for (int axis = 0; axis < 3; ++axis)
      values[axis * kSliceNodes] = static_cast<float>(load.force[node][axis]);
    values[3 * kSliceNodes] = static_cast<float>(load.shape[node]);
    const double bound = 2.0 * scale * sum_stiffness_[node] + load.shape[node];
    const bool is_free = load.is_free[node] != 0 && bound > 0.0;
    values[4 * kSliceNodes] = is_free ? static_cast<float>(1.0 / bound) : 0.0f;
    if (!is_free) continue;
    lowest_ = std::min(lowest_, load.shape[node] / bound);
    smallest_shape_ = std::min(smallest_shape_, load.shape[node]);
  }
  const std::size_t row_floats = std::size_t{stride_} * 5;
  for (std::uint32_t row = 1; row < rows; ++row) {
    const float* const here = nodes_.data() + row * row_floats;
    const bool is_alike =
        std::equal(here, here + row_floats, nodes_.data() + node_rows_[row - 1] * row_floats);
    node_rows_[row] = is_alike ? node_rows_[row - 1] : row;
  }
}

void SpringGrid::SetDisplacement(std::uint32_t node, const Vec3& u) noexcept {
  const std::size_t at = DisplacementAt(node);
  for (int axis = 0; axis < 3; ++axis) {
    u_[at + axis * stride_] = previous_[at + axis * stride_] = static_cast<float>(u[axis]);
  }
}

Vec3 SpringGrid::GetDisplacement(std::uint32_t node) const noexcept {
  const float* const u = u_.data() + DisplacementAt(node);
  return {static_cast<double>(u[0]), static_cast<double>(u[stride_]),
          static_cast<double>(u[2 * std::size_t{stride_}])};
}

void SpringGrid::Interpolate(const SpringGrid& coarse) noexcept {
  for (std::uint32_t node = 0; node < shape_.rows * shape_.columns; ++node) {
    if (nodes_[At(node, 5) + 4 * kSliceNodes] == 0.0f) continue;
    const GridPlace r = FindGridPlace(node / shape_.columns, shape_.rows, coarse.shape_.rows);
    const GridPlace c = FindGridPlace(node % shape_.columns, shape_.columns, coarse.shape_.columns);
    const std::uint32_t corner = r.index * coarse.shape_.columns + c.index;
    const std::size_t places[4] = {coarse.DisplacementAt(corner), coarse.DisplacementAt(corner + 1),
                                   coarse.DisplacementAt(corner + coarse.shape_.columns),
                                   coarse.DisplacementAt(corner + coarse.shape_.columns + 1)};
    const std::size_t to = DisplacementAt(node);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto u = [&](int i) { return coarse.u_[places[i] + axis * coarse.stride_]; };
      const float above = u(0) + c.share * (u(1) - u(0)), below = u(2) + c.share * (u(3) - u(2));
      u_[to + axis * stride_] = above + r.share * (below - above);
    }
  }
}

double SpringGrid::Step(const Kernels& kernels, Workers& workers, float omega, float damping, bool is_first,
                        bool is_measured) noexcept {
  const std::uint32_t chunk_rows = std::max(kChunkRows, shape_.rows / Workers::kMaxChunks + 1);
  const std::uint32_t chunks = (shape_.rows + chunk_rows - 1) / chunk_rows;
  std::array<float, Workers::kMaxChunks> largest2;
  GridStep step;
  step.rows = shape_.rows, step.stride = stride_;
  step.springs = springs_.data(), step.last_springs = last_springs_.data();
  step.spring_row = is_alike_ ? 0 : stride_ * kGridDirections * 5;
  step.has_south_west = has_south_west_, step.is_aligned = is_aligned_;
  step.nodes = nodes_.data(), step.node_rows = node_rows_.data();
  step.u = u_.data() + kMargin, step.previous = previous_.data() + kMargin;
  step.omega = omega, step.damping = damping, step.is_first = is_first, step.is_measured = is_measured;
  workers.Run(chunks, [&](std::uint32_t chunk) {
    GridStep own = step;
    own.reaction = reaction_.data() + std::size_t{chunk} * 2 * ReactionFloats(stride_);
    largest2[chunk] =
        kernels.step_rows(own, chunk * chunk_rows, std::min(shape_.rows, (chunk + 1) * chunk_rows));
  });
  std::swap(u_, previous_);
  float largest = 0;
  for (std::uint32_t chunk = 0; chunk < chunks; ++chunk) largest = LargerOrNan(largest, largest2[chunk]);
  return std::sqrt(static_cast<double>(largest));
}

double SpringGrid::Iterate(const Kernels& kernels, Workers& workers, std::span<const float> omegas,
                           float damping, bool is_first, bool is_measured) noexcept {
  double residual = 0;
  for (std::size_t k = 0; k < omegas.size(); ++k) {
    residual =
        Step(kernels, workers, omegas[k], damping, is_first && k == 0, is_measured && k + 1 == omegas.size());
  }
  return residual;
}

double SpringGrid::LargestDisplacement() const noexcept {
  double largest2 = 0;
  for (std::uint32_t node = 0; node < shape_.rows * shape_.columns; ++node) {
    largest2 = std::max(largest2, math::SquaredNorm(GetDisplacement(node)));
  }
  return std::sqrt(largest2);
}

}  // namespace trocar::tissue
