// SPDX-License-Identifier: Apache-2.0
#include "edge_strip.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "even_places.h"
#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"

namespace trocar::contours {

using math::Vec2;

namespace {

constexpr std::size_t kFewest = 8;
constexpr std::size_t kNormalReach = 2;  // points to either side over which the normal is taken
constexpr float kForbidden = std::numeric_limits<float>::max() / 4;

/// One lap of dynamic programming. `total` holds the cost of every column at row 0 and is replaced by that of
/// the row after the last, which is row 0 again; from[row] leads from row + 1 back to row.
void RunLap(std::span<const float> cost, std::size_t rows, int columns, float bend_cost, int max_jump,
            std::vector<float>& total, std::vector<std::int8_t>& from) {
  std::vector<float> next(columns);
  std::vector<float> jump_cost(max_jump + 1);
  for (int d = 0; d <= max_jump; ++d) jump_cost[d] = bend_cost * static_cast<float>(d * d);
  from.resize(rows * columns);
  for (std::size_t row = 0; row < rows; ++row) {
    const float* here = &cost[((row + 1) % rows) * columns];
    std::int8_t* back = &from[row * columns];
    for (int k = 0; k < columns; ++k) next[k] = total[k], back[k] = 0;
    for (int d = 1; d <= max_jump; ++d) {
      for (int k = d; k < columns; ++k) {
        const float candidate = total[k - d] + jump_cost[d];
        const bool is_better = candidate < next[k];
        next[k] = is_better ? candidate : next[k];
        back[k] = is_better ? static_cast<std::int8_t>(-d) : back[k];
      }
      for (int k = 0; k + d < columns; ++k) {
        const float candidate = total[k + d] + jump_cost[d];
        const bool is_better = candidate < next[k];
        next[k] = is_better ? candidate : next[k];
        back[k] = is_better ? static_cast<std::int8_t>(d) : back[k];
      }
    }
    for (int k = 0; k < columns; ++k) total[k] = next[k] + here[k];
  }
}

int Trace(const std::vector<std::int8_t>& from, std::size_t rows, int columns, int column,
          std::vector<int>& path) {
  path.resize(rows);
  for (std::size_t row = rows; row-- > 0;) {
    column += from[row * columns + column];
    path[row] = column;
  }
  return column;
}

}  // namespace

ClosedCurve ResampleClosed(std::span<const Vec2> polyline, double step_px, std::size_t most) {
  const std::size_t m = polyline.size();
  TROCAR_ASSERT(m >= 3 && step_px > 0 && most >= kFewest);
  std::vector<Vec2> at;
  for (const auto& [side, part] : FindEvenPlaces(polyline, step_px, kFewest, most))
    at.push_back(polyline[side] + part * (polyline[(side + 1) % m] - polyline[side]));
  return MakeClosedCurve(std::move(at));
}

ClosedCurve MakeClosedCurve(std::vector<Vec2> at) {
  const std::size_t count = at.size();
  TROCAR_ASSERT(count >= 3);
  double area = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 &p = at[i], &q = at[(i + 1) % count];
    area += p.x * q.y - q.x * p.y;
  }
  const double outwards = area < 0 ? -1.0 : 1.0;
  ClosedCurve curve;
  curve.normal.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    const Vec2 along = at[(k + kNormalReach) % count] - at[(k + count - kNormalReach) % count];
    const double norm = Norm(along);
    curve.normal.push_back(norm > 0 ? (outwards / norm) * Vec2{along.y, -along.x} : Vec2{});
  }
  curve.at = std::move(at);
  return curve;
}

double CalcHalfWidth(const ClosedCurve& curve) {
  const std::size_t n = curve.at.size();
  double twice_area = 0.0, length = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 &p = curve.at[i], &q = curve.at[(i + 1) % n];
    twice_area += p.x * q.y - q.x * p.y;
    length += Norm(q - p);
  }
  return length > 0 ? std::fabs(twice_area) / length : 0.0;
}

EdgeStrip SampleStrip(const EdgeField& field, const ClosedCurve& curve, double reach_px, double step_px) {
  EdgeStrip strip;
  strip.rows = curve.at.size();
  strip.step_px = step_px;
  strip.reach = base::FloorTo<int>(reach_px / step_px + 1e-9);
  strip.colours.reserve(strip.rows * strip.Columns());
  for (std::size_t row = 0; row < strip.rows; ++row) {
    for (int k = -strip.reach; k <= strip.reach; ++k) {
      strip.colours.push_back(field.Sample(curve.at[row] + (k * step_px) * curve.normal[row]));
    }
  }
  return strip;
}

std::vector<int> FindClosedPath(std::span<const float> cost, std::size_t rows, int columns, double bend_cost,
                                int max_jump) {
  TROCAR_ASSERT(rows >= 1 && columns >= 1 && cost.size() == rows * columns && max_jump >= 1);
  const auto bend = static_cast<float>(bend_cost);
  std::vector<std::int8_t> from;
  std::vector<int> path;
  // two laps from anywhere: the second has forgotten where the first began
  std::vector<float> total(columns, 0.0f);
  RunLap(cost, rows, columns, bend, max_jump, total, from);
  RunLap(cost, rows, columns, bend, max_jump, total, from);
  const auto end = static_cast<int>(std::min_element(total.begin(), total.end()) - total.begin());
  const int start = Trace(from, rows, columns, end, path);
  if (start == end) return path;
  // a lap that must end where it begins
  total.assign(columns, kForbidden);
  total[start] = 0.0f;
  RunLap(cost, rows, columns, bend, max_jump, total, from);
  Trace(from, rows, columns, start, path);
  return path;
}

}  // namespace trocar::contours
