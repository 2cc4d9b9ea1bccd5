// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/volume.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "trocar/core/assert.h"

namespace trocar::anatomy {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMarginMm = 3.0;  // around the shape, so that the border's distances are right

/// Lower envelope of the parabolas f(q) + (p - q)^2, in place (Felzenszwalb and Huttenlocher, algorithm 1).
void TransformLine(std::vector<double>& f, std::vector<double>& result, std::vector<int>& apex, std::vector<double>& from) {
  const int n = static_cast<int>(f.size());
  int k = -1;
  for (int q = 0; q < n; ++q) {
    if (f[q] == kInfinity) continue;
    double cross = -kInfinity;
    while (k >= 0) {
      const int v = apex[k];
      cross = ((f[q] + static_cast<double>(q) * q) - (f[v] + static_cast<double>(v) * v)) / (2.0 * (q - v));
      if (cross > from[k]) break;
      --k;
    }
    if (k < 0) cross = -kInfinity;
    ++k;
    apex[k] = q;
    from[k] = cross;
  }
  if (k < 0) return;
  int i = 0;
  for (int p = 0; p < n; ++p) {
    while (i < k && from[i + 1] < p) ++i;
    result[p] = f[apex[i]] + static_cast<double>(p - apex[i]) * (p - apex[i]);
  }
  f = result;
}

/// Slope at each knot of the monotone cubic through the values (Fritsch and Carlson; three-point start values).
void CalcMonotoneSlopes(std::span<const double> knots, std::span<const double> values, std::span<double> slopes) {
  const std::size_t n = knots.size();
  const auto secant = [&](std::size_t i) { return (values[i + 1] - values[i]) / (knots[i + 1] - knots[i]); };
  slopes[0] = secant(0);
  slopes[n - 1] = secant(n - 2);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = secant(i - 1), after = secant(i);
    if (before * after <= 0.0) {
      slopes[i] = 0.0;
      continue;
    }
    const double h0 = knots[i] - knots[i - 1], h1 = knots[i + 1] - knots[i];
    const double mean = (h1 * before + h0 * after) / (h0 + h1);
    const double limit = 3.0 * std::min(std::fabs(before), std::fabs(after));
    slopes[i] = std::clamp(mean, -limit, limit);
  }
}

double CubicHermite(double t, double h, double a, double b, double slope_a, double slope_b) {
  const double t2 = t * t, t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * a + (t3 - 2 * t2 + t) * h * slope_a + (3 * t2 - 2 * t3) * b + (t3 - t2) * h * slope_b;
}

}  // namespace

std::vector<double> CalcSquaredDistances(std::span<const std::uint8_t> set, int width, int height) {
  TROCAR_ASSERT(set.size() == static_cast<std::size_t>(width) * height);
  std::vector<double> distance(set.size());
  for (std::size_t i = 0; i < set.size(); ++i) distance[i] = set[i] ? 0.0 : kInfinity;
  const auto longest = static_cast<std::size_t>(std::max(width, height));
  std::vector<double> line, result(longest), from(longest + 1);
  std::vector<int> apex(longest);
  for (int x = 0; x < width; ++x) {
    line.resize(height), result.resize(height);
    for (int y = 0; y < height; ++y) line[y] = distance[static_cast<std::size_t>(y) * width + x];
    TransformLine(line, result, apex, from);
    for (int y = 0; y < height; ++y) distance[static_cast<std::size_t>(y) * width + x] = line[y];
  }
  for (int y = 0; y < height; ++y) {
    line.assign(distance.begin() + static_cast<std::ptrdiff_t>(y) * width,
                distance.begin() + static_cast<std::ptrdiff_t>(y + 1) * width);
    result.resize(width);
    TransformLine(line, result, apex, from);
    std::copy(line.begin(), line.end(), distance.begin() + static_cast<std::ptrdiff_t>(y) * width);
  }
  return distance;
}

std::vector<double> CalcSignedDistances(std::span<const std::uint8_t> set, int width, int height) {
  std::vector<std::uint8_t> unset(set.size());
  for (std::size_t i = 0; i < set.size(); ++i) unset[i] = !set[i];
  const auto to_inside = CalcSquaredDistances(set, width, height);
  const auto to_outside = CalcSquaredDistances(unset, width, height);
  std::vector<double> signed_distance(set.size());
  for (std::size_t i = 0; i < set.size(); ++i) {
    signed_distance[i] = set[i] ? std::sqrt(to_outside[i]) - 0.5 : 0.5 - std::sqrt(to_inside[i]);
  }
  return signed_distance;
}

core::Result<ScalarVolume> MakeVolume(std::span<const FilledSlice> slices, double pixel_mm, double spacing_mm) {
  TROCAR_ASSERT(slices.size() >= 2 && pixel_mm > 0 && spacing_mm > 0);
  // common rectangle of pixels
  int x0 = std::numeric_limits<int>::max(), y0 = x0, x1 = std::numeric_limits<int>::min(), y1 = x1;
  for (const FilledSlice& slice : slices) {
    if (slice.mask.Count() == 0) {
      return core::Error{core::ErrorCode::kContourEmpty,
                         "the slice at " + std::to_string(slice.position_mm) +
                             " mm encloses no pixel; enlarge its contour or remove the slice"};
    }
    x0 = std::min(x0, slice.mask.x0), y0 = std::min(y0, slice.mask.y0);
    x1 = std::max(x1, slice.mask.x0 + slice.mask.width), y1 = std::max(y1, slice.mask.y0 + slice.mask.height);
  }
  const int margin = static_cast<int>(std::ceil((kMarginMm + 2 * spacing_mm) / pixel_mm));
  x0 -= margin, y0 -= margin, x1 += margin, y1 += margin;
  const int width = x1 - x0, height = y1 - y0;

  ScalarVolume volume;
  volume.spacing = spacing_mm;
  const double first_gap = 0.5 * (slices[1].position_mm - slices[0].position_mm);
  const double last_gap = 0.5 * (slices.back().position_mm - slices[slices.size() - 2].position_mm);
  const double low[3] = {(x0 + 1) * pixel_mm, (y0 + 1) * pixel_mm, slices.front().position_mm - first_gap - spacing_mm};
  const double high[3] = {(x1 - 2) * pixel_mm, (y1 - 2) * pixel_mm, slices.back().position_mm + last_gap + spacing_mm};
  for (int axis = 0; axis < 3; ++axis) {
    volume.first[axis] = static_cast<int>(std::ceil(low[axis] / spacing_mm));
    volume.size[axis] = static_cast<int>(std::floor(high[axis] / spacing_mm)) - volume.first[axis] + 1;
  }
  const std::size_t plane = static_cast<std::size_t>(volume.size[0]) * volume.size[1];
  volume.values.resize(plane * volume.size[2]);

  // signed distances of each slice at the lattice's columns and rows [mm]
  std::vector<double> knots;
  std::vector<std::vector<double>> distances;
  std::vector<double> deepest;
  for (const FilledSlice& slice : slices) {
    std::vector<std::uint8_t> set(static_cast<std::size_t>(width) * height, 0);
    for (int y = 0; y < slice.mask.height; ++y) {
      for (int x = 0; x < slice.mask.width; ++x) {
        const int to_x = x + slice.mask.x0 - x0, to_y = y + slice.mask.y0 - y0;
        set[static_cast<std::size_t>(to_y) * width + to_x] = slice.mask.At(x, y);
      }
    }
    const auto fine = CalcSignedDistances(set, width, height);
    std::vector<double> coarse(plane);
    for (int j = 0; j < volume.size[1]; ++j) {
      const double y = (volume.first[1] + j) * spacing_mm / pixel_mm - y0;
      const int iy = static_cast<int>(y);
      for (int i = 0; i < volume.size[0]; ++i) {
        const double x = (volume.first[0] + i) * spacing_mm / pixel_mm - x0;
        const int ix = static_cast<int>(x);
        const double* row = &fine[static_cast<std::size_t>(iy) * width + ix];
        const double top = row[0] + (x - ix) * (row[1] - row[0]);
        const double bottom = row[width] + (x - ix) * (row[width + 1] - row[width]);
        coarse[static_cast<std::size_t>(j) * volume.size[0] + i] = pixel_mm * (top + (y - iy) * (bottom - top));
      }
    }
    knots.push_back(slice.position_mm);
    deepest.push_back(pixel_mm * *std::max_element(fine.begin(), fine.end()));
    distances.push_back(std::move(coarse));
  }

  const std::size_t n = slices.size();
  std::vector<double> values(n), slopes(n);
  for (std::size_t p = 0; p < plane; ++p) {
    for (std::size_t s = 0; s < n; ++s) values[s] = distances[s][p];
    CalcMonotoneSlopes(knots, values, slopes);
    std::size_t segment = 0;
    for (int k = 0; k < volume.size[2]; ++k) {
      const double z = (volume.first[2] + k) * spacing_mm;
      double value;
      if (z < knots.front()) {
        const double part = (knots.front() - z) / first_gap;
        value = values.front() - deepest.front() * part * part;
      } else if (z >= knots.back()) {
        const double part = (z - knots.back()) / last_gap;
        value = values.back() - deepest.back() * part * part;
      } else {
        while (knots[segment + 1] <= z) ++segment;
        const double h = knots[segment + 1] - knots[segment];
        value = CubicHermite((z - knots[segment]) / h, h, values[segment], values[segment + 1], slopes[segment],
                             slopes[segment + 1]);
      }
      volume.values[plane * k + p] = static_cast<float>(value);
    }
  }
  return volume;
}

void Subtract(ScalarVolume& volume, const ScalarVolume& other, double gap_mm) {
  TROCAR_ASSERT(volume.spacing == other.spacing);
  for (int k = 0; k < other.size[2]; ++k) {
    const int to_k = other.first[2] + k - volume.first[2];
    if (to_k < 0 || to_k >= volume.size[2]) continue;
    for (int j = 0; j < other.size[1]; ++j) {
      const int to_j = other.first[1] + j - volume.first[1];
      if (to_j < 0 || to_j >= volume.size[1]) continue;
      for (int i = 0; i < other.size[0]; ++i) {
        const int to_i = other.first[0] + i - volume.first[0];
        if (to_i < 0 || to_i >= volume.size[0]) continue;
        float& value = volume.values[volume.Index(to_i, to_j, to_k)];
        value = std::min(value, static_cast<float>(-other.values[other.Index(i, j, k)] - gap_mm));
      }
    }
  }
}

void KeepLargestPart(ScalarVolume& volume) {
  const int nx = volume.size[0], ny = volume.size[1], nz = volume.size[2];
  std::vector<std::uint32_t> part(volume.values.size(), 0);
  std::vector<std::size_t> stack;
  // parts of one side, numbered from 1; returns the size of each
  const auto number_parts = [&](bool inside) {
    std::fill(part.begin(), part.end(), 0u);
    std::vector<std::size_t> sizes = {0};
    for (std::size_t seed = 0; seed < part.size(); ++seed) {
      if (part[seed] != 0 || (volume.values[seed] > 0) != inside) continue;
      const auto number = static_cast<std::uint32_t>(sizes.size());
      sizes.push_back(0);
      stack.assign(1, seed);
      part[seed] = number;
      while (!stack.empty()) {
        const std::size_t here = stack.back();
        stack.pop_back();
        ++sizes[number];
        const int i = static_cast<int>(here % nx), j = static_cast<int>(here / nx % ny);
        const int k = static_cast<int>(here / (static_cast<std::size_t>(nx) * ny));
        const auto visit = [&](bool exists, std::size_t to) {
          if (!exists || part[to] != 0 || (volume.values[to] > 0) != inside) return;
          part[to] = number;
          stack.push_back(to);
        };
        const std::size_t row = nx, layer = static_cast<std::size_t>(nx) * ny;
        visit(i > 0, here - 1), visit(i + 1 < nx, here + 1);
        visit(j > 0, here - row), visit(j + 1 < ny, here + row);
        visit(k > 0, here - layer), visit(k + 1 < nz, here + layer);
      }
    }
    return sizes;
  };
  const auto keep = static_cast<float>(0.5 * volume.spacing);
  for (const bool inside : {true, false}) {
    const auto sizes = number_parts(inside);
    const auto largest = static_cast<std::uint32_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
    for (std::size_t v = 0; v < part.size(); ++v) {
      if (part[v] != 0 && part[v] != largest) volume.values[v] = inside ? -keep : keep;
    }
  }
}

}  // namespace trocar::anatomy
