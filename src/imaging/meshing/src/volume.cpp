// SPDX-License-Identifier: Apache-2.0
#include "trocar/meshing/volume.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "banded_distance.h"
#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"

namespace trocar::meshing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMarginMm = 3.0;  // around the shape, so that the border's distances are right
/// Distances are exact up to the largest of these, and do not grow beyond: a length, and so many times the
/// lattice's spacing and the widest distance between slices.
constexpr double kBandMm = 6.0, kBandSpacings = 3.0, kBandGaps = 2.0;

/// Lower envelope of the parabolas f(q) + (p - q)^2 (Felzenszwalb and Huttenlocher, algorithm 1).
///
/// \param[out] apex  whole numbers q of the parabolas on the envelope, in order
/// \param[out] from  where each begins
/// \return index of the last one; -1 when every f is infinite
int FindLowerEnvelope(const std::vector<double>& f, std::vector<int>& apex, std::vector<double>& from) {
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
  return k;
}

/// Squared distance to the nearest parabola's apex, in place.
void TransformLine(std::vector<double>& f, std::vector<double>& result, std::vector<int>& apex,
                   std::vector<double>& from) {
  const int n = static_cast<int>(f.size());
  const int k = FindLowerEnvelope(f, apex, from);
  if (k < 0) return;
  int i = 0;
  for (int p = 0; p < n; ++p) {
    while (i < k && from[i + 1] < p) ++i;
    result[p] = f[apex[i]] + static_cast<double>(p - apex[i]) * (p - apex[i]);
  }
  f = result;
}

/// One plane between slices a and a + 1 by the monotone cubic through all slices (Fritsch and Carlson;
/// three-point start values).
class PlaneBetween {
 public:
  PlaneBetween(const std::vector<double>& knots, std::size_t a, double z) {
    const auto gap = [&](std::size_t i) { return static_cast<float>(knots[i + 1] - knots[i]); };
    has_before_ = a > 0, has_after_ = a + 2 < knots.size();
    before_ = has_before_ ? gap(a - 1) : 1.0f;
    here_ = gap(a);
    after_ = has_after_ ? gap(a + 1) : 1.0f;
    const auto t = static_cast<float>((z - knots[a]) / (knots[a + 1] - knots[a]));
    const float t2 = t * t, t3 = t2 * t;
    from_a_ = 2 * t3 - 3 * t2 + 1, from_b_ = 3 * t2 - 2 * t3;
    slope_from_a_ = (t3 - 2 * t2 + t) * here_, slope_from_b_ = (t3 - t2) * here_;
  }

  /// Value from those of the four slices around; the outer ones do not count where there is none.
  float At(float v0, float v1, float v2, float v3) const {
    const float middle = (v2 - v1) / here_;
    const float slope_a = has_before_ ? Slope((v1 - v0) / before_, middle, before_, here_) : middle;
    const float slope_b = has_after_ ? Slope(middle, (v3 - v2) / after_, here_, after_) : middle;
    return from_a_ * v1 + slope_from_a_ * slope_a + from_b_ * v2 + slope_from_b_ * slope_b;
  }

 private:
  static float Slope(float before, float after, float h0, float h1) {
    const float mean = (h1 * before + h0 * after) / (h0 + h1);
    const float limit = 3.0f * std::min(std::fabs(before), std::fabs(after));
    return before * after <= 0.0f ? 0.0f : std::min(std::max(mean, -limit), limit);
  }

  bool has_before_, has_after_;
  float before_, here_, after_;
  float from_a_, from_b_, slope_from_a_, slope_from_b_;
};

/// Distances of one slice [pixels] at the lattice's columns and rows [mm], bilinear.
/// \param corner  of the slice's rectangle [pixels]
std::vector<float> SampleSlice(const std::vector<float>& fine, int width, std::array<int, 2> corner,
                               double pixel_mm, const ScalarVolume& lattice) {
  std::vector<int> column(static_cast<std::size_t>(lattice.size[0]));
  std::vector<float> part(column.size());
  for (int i = 0; i < lattice.size[0]; ++i) {
    const double x = (lattice.first[0] + i) * lattice.spacing / pixel_mm - corner[0];
    column[static_cast<std::size_t>(i)] = base::TruncateTo<int>(x);
    part[static_cast<std::size_t>(i)] = static_cast<float>(x - column[static_cast<std::size_t>(i)]);
  }
  std::vector<float> coarse;
  coarse.reserve(column.size() * static_cast<std::size_t>(lattice.size[1]));
  const auto scale = static_cast<float>(pixel_mm);
  for (int j = 0; j < lattice.size[1]; ++j) {
    const double y = (lattice.first[1] + j) * lattice.spacing / pixel_mm - corner[1];
    const int iy = base::TruncateTo<int>(y);
    const auto part_y = static_cast<float>(y - iy);
    const float* row = &fine[static_cast<std::size_t>(iy) * width];
    for (std::size_t i = 0; i < column.size(); ++i) {
      const float* at = row + column[i];
      const float top = at[0] + part[i] * (at[1] - at[0]);
      const float bottom = at[width] + part[i] * (at[width + 1] - at[width]);
      coarse.push_back(scale * (top + part_y * (bottom - top)));
    }
  }
  return coarse;
}

/// Index of the nearest set pixel for every pixel, by the same envelopes as CalcSquaredDistances.
/// \pre at least one pixel is set
std::vector<std::uint32_t> FindNearestSet(std::span<const std::uint8_t> set, int width, int height) {
  const auto row_length = static_cast<std::size_t>(width);
  std::vector<double> f(row_length), from(row_length + 1);
  std::vector<int> apex(row_length);
  // nearest set pixel in the column, then the best column of the row
  std::vector<int> row_of(set.size(), -1);
  for (int x = 0; x < width; ++x) {
    int last = -1;
    for (int y = 0; y < height; ++y) {
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      if (set[i]) last = y;
      row_of[i] = last;
    }
    last = -1;
    for (int y = height - 1; y >= 0; --y) {
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      if (set[i]) last = y;
      if (last >= 0 && (row_of[i] < 0 || last - y < y - row_of[i])) row_of[i] = last;
    }
  }
  std::vector<std::uint32_t> nearest(set.size(), 0);
  for (int y = 0; y < height; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * width;
    for (int x = 0; x < width; ++x) {
      const int r = row_of[row + x];
      f[x] = r < 0 ? kInfinity : static_cast<double>(r - y) * (r - y);
    }
    const int k = FindLowerEnvelope(f, apex, from);
    int i = 0;
    for (int x = 0; x < width; ++x) {
      while (i < k && from[i + 1] < x) ++i;
      nearest[row + x] =
          static_cast<std::uint32_t>(static_cast<std::size_t>(row_of[row + apex[i]]) * width + apex[i]);
    }
  }
  return nearest;
}

/// Part of the way from the shared area to the far end of the pixels that only `own` has, for each of them: 0
/// at the shared area, 1 at the end; negative for parts that touch nothing shared.
std::vector<float> CalcWayOut(const std::vector<std::uint8_t>& own, const std::vector<std::uint8_t>& shared,
                              int width, int height) {
  std::vector<float> way(own.size(), -1.0f);
  // only parts that hang together with the shared area
  std::vector<std::size_t> stack;
  std::vector<std::uint8_t> reached(own.size(), 0);
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (shared[i]) reached[i] = 1, stack.push_back(i);
  }
  if (stack.empty()) return way;
  while (!stack.empty()) {
    const std::size_t here = stack.back();
    stack.pop_back();
    const int x = static_cast<int>(here % width), y = static_cast<int>(here / width);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height) continue;
        const std::size_t to = static_cast<std::size_t>(y + dy) * width + x + dx;
        if (!own[to] || reached[to]) continue;
        reached[to] = 1;
        stack.push_back(to);
      }
    }
  }
  const auto nearest = FindNearestSet(shared, width, height);
  const auto distance_of = [&](std::size_t i) {
    const double dx = static_cast<double>(i % width) - static_cast<double>(nearest[i] % width);
    const double dy = static_cast<double>(i / width) - static_cast<double>(nearest[i] / width);
    return static_cast<float>(std::sqrt(dx * dx + dy * dy));
  };
  // how far the pixels reach that start from each place of the shared border
  std::vector<float> reach(own.size(), 0.0f);
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (own[i] && !shared[i] && reached[i]) reach[nearest[i]] = std::max(reach[nearest[i]], distance_of(i));
  }
  constexpr int kWindow = 2;  // neighbours along the border share their reach [pixels]
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (!own[i] || shared[i] || !reached[i]) continue;
    const int x = static_cast<int>(nearest[i] % width), y = static_cast<int>(nearest[i] / width);
    float longest = 0.0f;
    for (int v = std::max(0, y - kWindow); v <= std::min(height - 1, y + kWindow); ++v) {
      for (int u = std::max(0, x - kWindow); u <= std::min(width - 1, x + kWindow); ++u) {
        longest = std::max(longest, reach[static_cast<std::size_t>(v) * width + u]);
      }
    }
    way[i] = (distance_of(i) - 0.5f) / longest;
  }
  return way;
}

}  // namespace

std::vector<FilledSlice> InsertSlices(std::span<const FilledSlice> slices, double step_mm) {
  TROCAR_ASSERT(step_mm > 0);
  std::vector<FilledSlice> dense;
  for (std::size_t s = 0; s < slices.size(); ++s) {
    dense.push_back(slices[s]);
    if (s + 1 == slices.size()) break;
    const FilledSlice &a = slices[s], &b = slices[s + 1];
    const int parts = base::CeilTo<int>((b.position_mm - a.position_mm) / step_mm - 1e-9);
    if (parts < 2) continue;
    // both in one rectangle
    images::Mask frame;
    frame.x0 = std::min(a.mask.x0, b.mask.x0), frame.y0 = std::min(a.mask.y0, b.mask.y0);
    frame.width = std::max(a.mask.x0 + a.mask.width, b.mask.x0 + b.mask.width) - frame.x0;
    frame.height = std::max(a.mask.y0 + a.mask.height, b.mask.y0 + b.mask.height) - frame.y0;
    const std::size_t count = static_cast<std::size_t>(frame.width) * frame.height;
    const auto place = [&](const images::Mask& mask) {
      std::vector<std::uint8_t> set(count, 0);
      for (int y = 0; y < mask.height; ++y) {
        for (int x = 0; x < mask.width; ++x) {
          set[static_cast<std::size_t>(y + mask.y0 - frame.y0) * frame.width + x + mask.x0 - frame.x0] =
              mask.At(x, y);
        }
      }
      return set;
    };
    const auto set_a = place(a.mask), set_b = place(b.mask);
    std::vector<std::uint8_t> shared(count);
    for (std::size_t i = 0; i < count; ++i) shared[i] = set_a[i] & set_b[i];
    const auto way_a = CalcWayOut(set_a, shared, frame.width, frame.height);
    const auto way_b = CalcWayOut(set_b, shared, frame.width, frame.height);
    const auto distance_a = CalcSignedDistances(set_a, frame.width, frame.height);
    const auto distance_b = CalcSignedDistances(set_b, frame.width, frame.height);
    for (int part = 1; part < parts; ++part) {
      const double t = static_cast<double>(part) / parts;
      frame.inside.assign(count, 0);
      for (std::size_t i = 0; i < count; ++i) {
        bool inside = shared[i] != 0;
        if (set_a[i] && !set_b[i]) {
          inside = way_a[i] >= 0 ? way_a[i] < 1.0 - t : (1.0 - t) * distance_a[i] + t * distance_b[i] > 0;
        } else if (set_b[i] && !set_a[i]) {
          inside = way_b[i] >= 0 ? way_b[i] < t : (1.0 - t) * distance_a[i] + t * distance_b[i] > 0;
        }
        frame.inside[i] = inside;
      }
      dense.push_back({a.position_mm + t * (b.position_mm - a.position_mm), frame});
    }
  }
  return dense;
}

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

void OpenMask(images::Mask& mask, double radius_px) {
  const int band = base::CeilTo<int>(radius_px) + 2;
  if (band > kWidestBand || mask.inside.empty()) return;
  const auto depth = CalcBandedDistances(mask.inside, mask.width, mask.height, band);
  std::vector<std::uint8_t> core(mask.inside.size());
  for (std::size_t i = 0; i < core.size(); ++i) core[i] = depth[i] >= static_cast<float>(radius_px);
  if (std::find(core.begin(), core.end(), 1) == core.end()) return;
  // the distance to the core's border is half a pixel less than that to its nearest pixel
  const auto around = CalcBandedDistances(core, mask.width, mask.height, band);
  for (std::size_t i = 0; i < core.size(); ++i)
    mask.inside[i] = mask.inside[i] && around[i] >= static_cast<float>(-radius_px - 1e-4);
}

base::Result<ScalarVolume> MakeVolume(std::span<const FilledSlice> slices, double pixel_mm, double spacing_mm,
                                      std::optional<std::array<double, 2>> ends_mm) {
  TROCAR_ASSERT(slices.size() >= 2 && pixel_mm > 0 && spacing_mm > 0);
  // common rectangle of pixels
  int x0 = std::numeric_limits<int>::max(), y0 = x0, x1 = std::numeric_limits<int>::min(), y1 = x1;
  for (const FilledSlice& slice : slices) {
    if (slice.mask.Count() == 0) {
      return base::Error{base::ErrorCode::kContourEmpty,
                         "the slice at " + std::to_string(slice.position_mm) +
                             " mm encloses no pixel; enlarge its contour or remove the slice"};
    }
    x0 = std::min(x0, slice.mask.x0), y0 = std::min(y0, slice.mask.y0);
    x1 = std::max(x1, slice.mask.x0 + slice.mask.width), y1 = std::max(y1, slice.mask.y0 + slice.mask.height);
  }
  const int margin = base::CeilTo<int>((kMarginMm + 2 * spacing_mm) / pixel_mm);
  x0 -= margin, y0 -= margin, x1 += margin, y1 += margin;
  const int width = x1 - x0, height = y1 - y0;

  ScalarVolume volume;
  volume.spacing = spacing_mm;
  const std::array<double, 2> ends =
      ends_mm.value_or(std::array{0.5 * (slices[1].position_mm - slices[0].position_mm),
                                  0.5 * (slices.back().position_mm - slices[slices.size() - 2].position_mm)});
  TROCAR_ASSERT(ends[0] > 0 && ends[1] > 0);
  const double low[3] = {(x0 + 1) * pixel_mm, (y0 + 1) * pixel_mm,
                         slices.front().position_mm - ends[0] - spacing_mm};
  const double high[3] = {(x1 - 2) * pixel_mm, (y1 - 2) * pixel_mm,
                          slices.back().position_mm + ends[1] + spacing_mm};
  for (int axis = 0; axis < 3; ++axis) {
    volume.first[axis] = base::CeilTo<int>(low[axis] / spacing_mm);
    volume.size[axis] = base::FloorTo<int>(high[axis] / spacing_mm) - volume.first[axis] + 1;
  }
  const std::size_t plane = static_cast<std::size_t>(volume.size[0]) * volume.size[1];
  volume.values.resize(plane * volume.size[2]);

  // signed distances of each slice at the lattice's columns and rows [mm]
  const std::size_t n = slices.size();
  double widest_gap = 0;
  std::vector<double> knots(n);
  for (std::size_t s = 0; s < n; ++s) {
    knots[s] = slices[s].position_mm;
    if (s > 0) widest_gap = std::max(widest_gap, knots[s] - knots[s - 1]);
  }
  const double band_mm = std::max({kBandMm, kBandSpacings * spacing_mm, kBandGaps * widest_gap});
  const int band = std::clamp(base::CeilTo<int>(band_mm / pixel_mm), 4, kWidestBand);
  std::vector<std::vector<float>> distances(n);
  std::vector<float> deepest(n);
  oneapi::tbb::parallel_for(std::size_t{0}, n, [&](std::size_t s) {
    const FilledSlice& slice = slices[s];
    std::vector<std::uint8_t> set(static_cast<std::size_t>(width) * height, 0);
    for (int y = 0; y < slice.mask.height; ++y) {
      const auto* from = &slice.mask.inside[static_cast<std::size_t>(y) * slice.mask.width];
      const auto to = static_cast<std::size_t>(y + slice.mask.y0 - y0) * width + (slice.mask.x0 - x0);
      for (int x = 0; x < slice.mask.width; ++x) set[to + x] = from[x] != 0;
    }
    const auto fine = CalcBandedDistances(set, width, height, band);
    deepest[s] = static_cast<float>(pixel_mm) * *std::max_element(fine.begin(), fine.end());
    distances[s] = SampleSlice(fine, width, {x0, y0}, pixel_mm, volume);
  });

  // each lattice plane between its two slices, with the slopes that their neighbours give
  oneapi::tbb::parallel_for(0, volume.size[2], [&](int k) {
    float* out = &volume.values[plane * static_cast<std::size_t>(k)];
    const double z = (volume.first[2] + k) * spacing_mm;
    if (z < knots.front() || z >= knots.back()) {
      const bool is_below = z < knots.front();
      const std::size_t end = is_below ? 0 : n - 1;
      const double part = is_below ? (knots.front() - z) / ends[0] : (z - knots.back()) / ends[1];
      const float less = deepest[end] * static_cast<float>(part * part);
      for (std::size_t p = 0; p < plane; ++p) out[p] = distances[end][p] - less;
      return;
    }
    const auto after = std::upper_bound(knots.begin(), knots.end(), z);
    const auto a = static_cast<std::size_t>(after - knots.begin()) - 1;
    const PlaneBetween between(knots, a, z);
    const std::size_t before_a = a == 0 ? 0 : a - 1, after_b = a + 2 == n ? a + 1 : a + 2;
    const float *p0 = distances[before_a].data(), *p1 = distances[a].data(), *p2 = distances[a + 1].data(),
                *p3 = distances[after_b].data();
    for (std::size_t p = 0; p < plane; ++p) out[p] = between.At(p0[p], p1[p], p2[p], p3[p]);
  });
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

}  // namespace trocar::meshing
