// SPDX-License-Identifier: Apache-2.0
#include "label_sights.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "label_neighbours.h"

#include "trocar/base/to_integer.h"
#include "trocar/math/elementary.h"

namespace trocar::anatomy {
namespace {

using math::Acos;
using math::Cbrt;
using math::Cos;

constexpr double kSpacingMm = 3.0;  // of the lattice; a gallbladder is 30 mm wide
constexpr double kMostCells = 4e6;  // of it; a larger map gets a coarser one

/// The map's labels, counted from 1 on, at the points of a lattice along left, cranial and anterior.
struct Lattice {
  std::array<int, 3> size{};
  double spacing = kSpacingMm;
  math::Vec3 first;
  std::vector<std::uint16_t> labels;

  std::size_t At(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * size[1] + j) * size[0] + i;
  }
  math::Vec3 PlaceOf(int i, int j, int k) const {
    return first + spacing * math::Vec3{double(i), double(j), double(k)};
  }
};

/// \param numbers  (labels) in ascending order
Lattice Sample(const images::LabelVolume& volume, const VoxelFrame& frame, const LabelBoxes& boxes,
               const std::vector<std::int32_t>& numbers) {
  Lattice lattice;
  math::Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = -1.0 * low;
  for (const auto& entry : boxes) {
    const LabelBox& box = entry.second;
    for (int corner = 0; corner < 8; ++corner) {
      const auto at = [&](int axis) { return (corner >> axis & 1) != 0 ? box.high[axis] : box.low[axis]; };
      const math::Vec3 p = frame.PlaceOf(at(0), at(1), at(2));
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], p[axis]);
        high[axis] = std::max(high[axis], p[axis]);
      }
    }
  }
  const math::Vec3 extent = high - low;
  const double margin = 2.0 * kSpacingMm;
  lattice.spacing = std::max(
      kSpacingMm, Cbrt((extent.x + margin) * (extent.y + margin) * (extent.z + margin) / kMostCells));
  // two empty points all round
  for (int axis = 0; axis < 3; ++axis) {
    lattice.size[axis] = base::FloorTo<int>(extent[axis] / lattice.spacing) + 5;
    lattice.first[axis] = 0.5 * (low[axis] + high[axis]) - 0.5 * (lattice.size[axis] - 1) * lattice.spacing;
  }
  lattice.labels.assign(lattice.At(0, 0, lattice.size[2]), 0);
  oneapi::tbb::parallel_for(2, lattice.size[2] - 2, [&](int k) {
    for (int j = 2; j < lattice.size[1] - 2; ++j) {
      for (int i = 2; i < lattice.size[0] - 2; ++i) {
        const math::Vec3 p = lattice.PlaceOf(i, j, k);
        std::size_t at = 0;
        bool is_in = true;
        for (int axis = 2; axis >= 0; --axis) {
          const int index = base::RoundTo<int>(Dot(p, frame.axes[axis]) / frame.step_mm[axis]);
          is_in = is_in && index >= 0 && index < volume.size[axis];
          at =
              at * static_cast<std::size_t>(volume.size[axis]) + static_cast<std::size_t>(std::max(0, index));
        }
        if (!is_in || volume.labels[at] == 0) continue;
        const auto number =
            std::lower_bound(numbers.begin(), numbers.end(), volume.labels[at]) - numbers.begin();
        lattice.labels[lattice.At(i, j, k)] = static_cast<std::uint16_t>(number + 1);
      }
    }
  });
  return lattice;
}

/// Ratio of the longest to the shortest axis of a distribution, from its covariance.
/// Source: O. K. Smith, Eigenvalues of a symmetric 3 x 3 matrix, Communications of the ACM 1961.
double Elongation(const std::array<double, 6>& c, double least_variance) {
  const double mean = (c[0] + c[1] + c[2]) / 3.0;
  const double a = c[0] - mean, b = c[1] - mean, d = c[2] - mean;
  const double spread =
      std::sqrt((a * a + b * b + d * d + 2.0 * (c[3] * c[3] + c[4] * c[4] + c[5] * c[5])) / 6.0);
  if (!(spread > 1e-12)) return 1.0;
  const double determinant =
      (a * (b * d - c[5] * c[5]) - c[3] * (c[3] * d - c[5] * c[4]) + c[4] * (c[3] * c[5] - b * c[4])) /
      (spread * spread * spread);
  const double angle = Acos(std::clamp(0.5 * determinant, -1.0, 1.0)) / 3.0;
  const double largest = mean + 2.0 * spread * Cos(angle);
  const double smallest = mean + 2.0 * spread * Cos(angle + 2.0 * M_PI / 3.0);
  return std::sqrt(largest / std::max(smallest, least_variance));
}

/// Points of the largest part of each label that hangs together (26 neighbours).
std::vector<std::size_t> MeasureLargestParts(const Lattice& lattice, std::size_t labels) {
  std::vector<std::size_t> largest(labels + 1, 0);
  std::vector<std::uint16_t> left = lattice.labels;
  std::vector<std::size_t> stack;
  const auto row = static_cast<std::ptrdiff_t>(lattice.size[0]), layer = row * lattice.size[1];
  for (std::size_t seed = 0; seed < left.size(); ++seed) {
    const std::uint16_t label = left[seed];
    if (label == 0) continue;
    std::size_t count = 0;
    left[seed] = 0;
    stack.push_back(seed);
    while (!stack.empty()) {
      const std::size_t at = stack.back();
      stack.pop_back();
      ++count;
      // what is not empty has two empty points all round
      for (std::ptrdiff_t k = -layer; k <= layer; k += layer) {
        for (std::ptrdiff_t j = -row; j <= row; j += row) {
          for (std::ptrdiff_t i = -1; i <= 1; ++i) {
            const auto next = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(at) + i + j + k);
            if (left[next] != label) continue;
            left[next] = 0;
            stack.push_back(next);
          }
        }
      }
    }
    largest[label] = std::max(largest[label], count);
  }
  return largest;
}

}  // namespace

LabelSights LookAtLabels(const images::LabelVolume& volume, const VoxelFrame& frame) {
  LabelSights sights;
  const LabelBoxes boxes = FindLabelBoxes(volume);
  if (boxes.empty() || boxes.size() > kMostLabels) return sights;
  std::vector<std::int32_t> numbers;
  for (const auto& [label, box] : boxes) numbers.push_back(label);
  const Lattice lattice = Sample(volume, frame, boxes, numbers);

  struct Sums {
    double count = 0, surface = 0;
    math::Vec3 place, min{HUGE_VAL, HUGE_VAL, HUGE_VAL}, max{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    std::array<double, 6> square{};  // xx, yy, zz, xy, xz, yz
    std::map<std::uint16_t, double> beside;
  };
  std::vector<Sums> sums(numbers.size() + 1);
  const std::array<std::ptrdiff_t, 6> steps = {1,
                                               -1,
                                               lattice.size[0],
                                               -lattice.size[0],
                                               static_cast<std::ptrdiff_t>(lattice.At(0, 0, 1)),
                                               -static_cast<std::ptrdiff_t>(lattice.At(0, 0, 1))};
  for (int k = 2; k < lattice.size[2] - 2; ++k) {
    for (int j = 2; j < lattice.size[1] - 2; ++j) {
      for (int i = 2; i < lattice.size[0] - 2; ++i) {
        const std::size_t at = lattice.At(i, j, k);
        const std::uint16_t label = lattice.labels[at];
        if (label == 0) continue;
        Sums& sum = sums[label];
        const math::Vec3 p = lattice.PlaceOf(i, j, k);
        ++sum.count;
        sum.place += p;
        for (int axis = 0; axis < 3; ++axis) {
          sum.min[axis] = std::min(sum.min[axis], p[axis]);
          sum.max[axis] = std::max(sum.max[axis], p[axis]);
        }
        const std::array<double, 6> square = {p.x * p.x, p.y * p.y, p.z * p.z,
                                              p.x * p.y, p.x * p.z, p.y * p.z};
        for (std::size_t s = 0; s < 6; ++s) sum.square[s] += square[s];
        for (const std::ptrdiff_t step : steps) {
          const auto look = [&](std::ptrdiff_t far) {
            return lattice.labels[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(at) + far * step)];
          };
          std::uint16_t other = look(1);
          if (other == label) continue;
          ++sum.surface;
          // across a gap of one point, too: maps leave some between organs
          if (other == 0) other = look(2);
          if (other != 0 && other != label) ++sum.beside[other];
        }
      }
    }
  }
  const auto largest = MeasureLargestParts(lattice, numbers.size());
  sights.min = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, sights.max = -1.0 * sights.min;
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    const Sums& sum = sums[n + 1];
    const LabelBox& box = boxes.at(numbers[n]);
    LabelSight& sight = sights.labels[numbers[n]];
    sight.volume_ml = static_cast<double>(box.count) * frame.VoxelMm3() / 1000.0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      sight.is_at_border =
          sight.is_at_border || box.low[axis] == 0 || box.high[axis] == volume.size[axis] - 1;
    if (sum.count == 0) {
      // smaller than the lattice sees
      const auto middle = [&](int axis) { return 0.5 * (box.low[axis] + box.high[axis]); };
      sight.centre = sight.min = sight.max = frame.PlaceOf(middle(0), middle(1), middle(2));
    } else {
      const math::Vec3 c = sum.place / sum.count;
      sight.centre = c, sight.min = sum.min, sight.max = sum.max;
      const std::array<double, 6> mean = {c.x * c.x, c.y * c.y, c.z * c.z, c.x * c.y, c.x * c.z, c.y * c.z};
      std::array<double, 6> covariance{};
      for (std::size_t s = 0; s < 6; ++s) covariance[s] = sum.square[s] / sum.count - mean[s];
      sight.elongation = Elongation(covariance, lattice.spacing * lattice.spacing / 12.0);
      sight.largest_part = static_cast<double>(largest[n + 1]) / sum.count;
      for (const auto& [other, faces] : sum.beside) sight.beside[numbers[other - 1]] = faces / sum.surface;
    }
    for (int axis = 0; axis < 3; ++axis) {
      sights.min[axis] = std::min(sights.min[axis], sight.min[axis]);
      sights.max[axis] = std::max(sights.max[axis], sight.max[axis]);
    }
  }
  return sights;
}

std::string ListSights(const LabelSights& sights) {
  constexpr std::size_t kMostListed = 12;
  std::vector<std::pair<double, int>> by_volume;
  for (const auto& [label, sight] : sights.labels) by_volume.emplace_back(-sight.volume_ml, label);
  std::sort(by_volume.begin(), by_volume.end());
  constexpr const char* kWords[3][3] = {
      {"right", "central", "left"}, {"low", "at mid height", "high"}, {"behind", "in between", "in front"}};
  std::string text;
  for (std::size_t i = 0; i < by_volume.size() && i < kMostListed; ++i) {
    const LabelSight& sight = sights.labels.at(by_volume[i].second);
    char volume[32];
    std::snprintf(volume, sizeof volume, sight.volume_ml < 10 ? "%.1f" : "%.0f", sight.volume_ml);
    text += (i == 0 ? "label " : "; label ") + std::to_string(by_volume[i].second) + ": " + volume + " mL";
    for (int axis = 0; axis < 3; ++axis) {
      const double extent = sights.max[axis] - sights.min[axis];
      const double part = extent > 0 ? (sight.centre[axis] - sights.min[axis]) / extent : 0.5;
      text += std::string(", ") + kWords[axis][part < 0.4 ? 0 : part < 0.6 ? 1 : 2];
    }
  }
  if (by_volume.size() > kMostListed) text += "; " + std::to_string(by_volume.size() - kMostListed) + " more";
  return text;
}

}  // namespace trocar::anatomy
