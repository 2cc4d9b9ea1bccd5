// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "trocar/anatomy/patient_from_labels.h"
#include "trocar/base/to_integer.h"
#include "trocar/images/label_alignment.h"

namespace trocar::anatomy {
namespace {

/// Grey values of pictures in steps of 4 HU, from below fat to bone; what lies outside counts at the end.
constexpr images::DisplayWindow kWindow = {100, 1020};
constexpr double kAirHu = -500;  // something in a CT of a body is less: air around it, in lungs or bowel
constexpr double kBetweenSlicesMm = 3;      // that are looked at
constexpr std::uint64_t kLeastPixels = 50;  // of a label

using Histogram = std::array<std::uint64_t, 256>;

double MedianHu(const Histogram& histogram, std::uint64_t count) {
  std::uint64_t below = 0;
  std::size_t grey = 0;
  while (below + histogram[grey] <= count / 2) below += histogram[grey++];
  return kWindow.centre - 0.5 * kWindow.width + static_cast<double>(grey) * kWindow.width / 255.0;
}

}  // namespace

bool HoldsHounsfieldUnits(const images::ImageSeriesInfo& series) {
  return !series.is_color && series.bits > 8 && series.grey_range[0] <= kAirHu;
}

base::Result<LabelDensities> MeasureDensities(const images::LabelVolume& volume,
                                              const images::ImageSeries& series) {
  const images::ImageSeriesInfo& info = series.Info();
  LabelDensities densities;
  if (!HoldsHounsfieldUnits(info)) return densities;
  const auto aligned = images::AlignLabels(volume, info);
  if (!aligned.ok()) return aligned.error();
  const auto plane = static_cast<std::size_t>(info.width) * info.height;
  const auto step =
      base::TruncateTo<std::size_t>(std::max(1.0, std::floor(kBetweenSlicesMm / info.slice_mm)));
  std::map<int, Histogram> histograms;
  for (std::size_t slice = 0; slice < info.slice_numbers.size(); slice += step) {
    const auto* labels = &aligned->labels[slice * plane];
    if (std::all_of(labels, labels + plane, [](std::int32_t label) { return label == 0; })) continue;
    const auto picture = series.ReadSlice(info.slice_numbers[slice], kWindow);
    if (!picture.ok()) return picture.error();
    for (std::size_t i = 0; i < plane; ++i) {
      if (labels[i] != 0) ++histograms[labels[i]][picture->samples[3 * i]];
    }
  }
  for (const auto& [label, histogram] : histograms) {
    std::uint64_t count = 0;
    for (const std::uint64_t some : histogram) count += some;
    if (count >= kLeastPixels) densities[label] = MedianHu(histogram, count);
  }
  return densities;
}

}  // namespace trocar::anatomy
