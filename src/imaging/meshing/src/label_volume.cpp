// SPDX-License-Identifier: Apache-2.0
#include "trocar/meshing/label_volume.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "connected_parts.h"
#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"

namespace trocar::meshing {
namespace {

/// Only the rectangle that is filled.
images::Mask Crop(const std::vector<std::uint8_t>& inside, int width, int height) {
  images::Mask mask;
  mask.x0 = width, mask.y0 = height;
  int x1 = 0, y1 = 0;
  for (int y = 0; y < height; ++y) {
    const auto begin = inside.begin() + static_cast<std::ptrdiff_t>(y) * width, end = begin + width;
    const auto first = std::find(begin, end, 1);
    if (first == end) continue;
    const auto last = std::find(std::make_reverse_iterator(end), std::make_reverse_iterator(begin), 1);
    mask.x0 = std::min(mask.x0, static_cast<int>(first - begin));
    x1 = std::max(x1, static_cast<int>(last.base() - begin));
    mask.y0 = std::min(mask.y0, y), y1 = y + 1;
  }
  if (y1 == 0) return {};
  mask.width = x1 - mask.x0, mask.height = y1 - mask.y0;
  for (int y = mask.y0; y < y1; ++y) {
    const auto row = inside.begin() + static_cast<std::ptrdiff_t>(y) * width;
    mask.inside.insert(mask.inside.end(), row + mask.x0, row + x1);
  }
  return mask;
}

/// Binomial blur (1 2 1) / 4 along every axis; the border repeats.
void Blur(ScalarVolume& volume, int rounds) {
  const auto width = static_cast<std::size_t>(volume.size[0]);
  const auto rows = static_cast<std::size_t>(volume.size[1]);
  const auto layers = static_cast<std::size_t>(volume.size[2]);
  const auto blend = [](const float* before, const float* here, const float* after, float* out,
                        std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) out[i] = 0.25f * before[i] + 0.5f * here[i] + 0.25f * after[i];
  };
  std::vector<float> blurred(volume.values.size());
  for (int round = 0; round < rounds; ++round) {
    // along rows and columns within each layer, then across the layers
    oneapi::tbb::parallel_for(std::size_t{0}, layers, [&](std::size_t k) {
      std::vector<float> layer(width * rows), padded(width + 2);
      for (std::size_t j = 0; j < rows; ++j) {
        const float* row = &volume.values[(k * rows + j) * width];
        std::copy(row, row + width, padded.begin() + 1);
        padded.front() = row[0], padded.back() = row[width - 1];
        blend(&padded[0], &padded[1], &padded[2], &layer[j * width], width);
      }
      for (std::size_t j = 0; j < rows; ++j) {
        blend(&layer[(j == 0 ? 0 : j - 1) * width], &layer[j * width],
              &layer[std::min(j + 1, rows - 1) * width], &blurred[(k * rows + j) * width], width);
      }
    });
    const std::size_t plane = width * rows;
    oneapi::tbb::parallel_for(std::size_t{0}, layers, [&](std::size_t k) {
      blend(&blurred[(k == 0 ? 0 : k - 1) * plane], &blurred[k * plane],
            &blurred[std::min(k + 1, layers - 1) * plane], &volume.values[k * plane], plane);
    });
  }
}

/// Moves the surface so that `volume_mm3` lies inside: what a blur took comes back.
void SetInsideVolume(ScalarVolume& volume, double volume_mm3) {
  const auto wanted =
      base::TruncateTo<std::size_t>(volume_mm3 / (volume.spacing * volume.spacing * volume.spacing));
  // the level lies near zero: only what is near needs an order
  for (double reach = 2.0 * volume.spacing;; reach *= 4.0) {
    std::vector<float> near;
    std::size_t above = 0;
    for (const float value : volume.values) {
      if (value > reach)
        ++above;
      else if (value >= -reach)
        near.push_back(value);
    }
    if (above <= wanted && wanted < above + near.size()) {
      const auto nth = near.begin() + static_cast<std::ptrdiff_t>(wanted - above);
      std::nth_element(near.begin(), nth, near.end(), std::greater<>());
      const float level = *nth;
      for (float& value : volume.values) value -= level;
      return;
    }
    if (near.size() == volume.values.size()) return;  // more is wanted than the volume holds
  }
}

}  // namespace

std::vector<std::size_t> KeepLargestPart(images::LabelVolume& labels, int label) {
  const auto width = static_cast<std::size_t>(labels.size[0]);
  ConnectedParts parts(labels.size, [&](std::size_t row, int i) {
    return labels.labels[row * width + static_cast<std::size_t>(i)] == label;
  });
  for (const Run& run : parts.FindLesser()) {
    std::int32_t* row = &labels.labels[run.row * width];
    std::fill(row + run.begin, row + run.end, 0);
  }
  return parts.CountSamples();
}

std::vector<FilledSlice> FillLabelSlices(const images::LabelVolume& labels, int label,
                                         const std::array<double, 3>& voxel_mm, double pixel_mm) {
  const auto plane = static_cast<std::size_t>(labels.size[0]) * labels.size[1];
  const int width = base::CeilTo<int>(labels.size[0] * voxel_mm[0] / pixel_mm);
  const int height = base::CeilTo<int>(labels.size[1] * voxel_mm[1] / pixel_mm);
  std::vector<std::size_t> column(static_cast<std::size_t>(width));
  for (int x = 0; x < width; ++x) {
    column[static_cast<std::size_t>(x)] = static_cast<std::size_t>(
        std::min(labels.size[0] - 1, base::RoundTo<int>(x * pixel_mm / voxel_mm[0])));
  }
  std::vector<FilledSlice> all(static_cast<std::size_t>(labels.size[2]));
  oneapi::tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t k) {
    const auto* slice = &labels.labels[plane * k];
    all[k].position_mm = static_cast<double>(k) * voxel_mm[2];
    if (std::find(slice, slice + plane, label) == slice + plane) return;
    std::vector<std::uint8_t> inside(static_cast<std::size_t>(width) * height);
    for (int y = 0; y < height; ++y) {
      const auto j = static_cast<std::size_t>(
          std::min(labels.size[1] - 1, base::RoundTo<int>(y * pixel_mm / voxel_mm[1])));
      const auto* row = slice + j * static_cast<std::size_t>(labels.size[0]);
      auto* to = &inside[static_cast<std::size_t>(y) * width];
      for (std::size_t x = 0; x < column.size(); ++x) to[x] = row[column[x]] == label ? 1 : 0;
    }
    all[k].mask = Crop(inside, width, height);
  });
  std::erase_if(all, [](const FilledSlice& slice) { return slice.mask.inside.empty(); });
  return all;
}

base::Result<ScalarVolume> MakeLabelVolume(std::vector<FilledSlice> slices, double pixel_mm,
                                           double enclosed_mm3, const LabelVolumeSettings& settings) {
  if (slices.size() < 2) {
    return base::Error{base::ErrorCode::kContourEmpty, "the label lies in " + std::to_string(slices.size()) +
                                                           " slices; at least two are needed"};
  }
  oneapi::tbb::parallel_for(std::size_t{0}, slices.size(), [&](std::size_t s) {
    OpenMask(slices[s].mask, 0.5 * settings.thinnest_mm / pixel_mm);
  });
  auto volume = MakeVolume(slices, pixel_mm, settings.spacing_mm);
  if (!volume.ok()) return volume.error();
  const double reach = settings.blur_mm / settings.spacing_mm;
  Blur(*volume, base::RoundTo<int>(reach * reach));
  SetInsideVolume(*volume, enclosed_mm3);
  return volume;
}

double SuggestSpacing(std::span<const FilledSlice> slices, double pixel_mm, int triangle_budget) {
  constexpr double kTrianglesForEach = 18.0;
  constexpr double kTrianglesPerCell = 2.7;  // of marching cubes, for each square of the spacing
  TROCAR_ASSERT(slices.size() >= 2 && triangle_budget > 0);
  std::vector<double> areas(slices.size());
  oneapi::tbb::parallel_for(std::size_t{0}, slices.size(), [&](std::size_t s) {
    const images::Mask& mask = slices[s].mask;
    const auto at = [](const images::Mask& m, int x, int y) {
      const int u = x - m.x0, v = y - m.y0;
      return u >= 0 && v >= 0 && u < m.width && v < m.height && m.At(u, v) != 0;
    };
    const images::Mask* above = s + 1 < slices.size() ? &slices[s + 1].mask : nullptr;
    std::size_t walls = 0, lids = s == 0 ? mask.Count() : 0;
    for (int y = mask.y0 - 1; y < mask.y0 + mask.height; ++y) {
      for (int x = mask.x0 - 1; x < mask.x0 + mask.width; ++x) {
        const bool here = at(mask, x, y);
        walls += (here != at(mask, x + 1, y)) + (here != at(mask, x, y + 1));
        if (here && (above == nullptr || !at(*above, x, y))) ++lids;
      }
    }
    if (above != nullptr) {
      for (int y = above->y0; y < above->y0 + above->height; ++y) {
        for (int x = above->x0; x < above->x0 + above->width; ++x)
          lids += at(*above, x, y) && !at(mask, x, y);
      }
    }
    const double thickness = s + 1 < slices.size() ? slices[s + 1].position_mm - slices[s].position_mm
                                                   : slices[s].position_mm - slices[s - 1].position_mm;
    areas[s] =
        static_cast<double>(walls) * pixel_mm * thickness + static_cast<double>(lids) * pixel_mm * pixel_mm;
  });
  double area = 0;
  for (const double a : areas) area += a / 1.5;
  return std::sqrt(kTrianglesPerCell * area / (kTrianglesForEach * triangle_budget));
}

}  // namespace trocar::meshing
