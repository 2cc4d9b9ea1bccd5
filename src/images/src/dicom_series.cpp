// SPDX-License-Identifier: Apache-2.0
#include "dicom_series.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>

#include "trocar/core/printable.h"

namespace trocar::images {
namespace {

using core::Error;
using core::ErrorCode;
using math::Vec3;

constexpr double kSameDirection = 1e-3;  // of unit vectors
constexpr double kSameSpacing = 1e-3;    // mm
constexpr double kDoubledMm = 0.01;
constexpr double kUnevenShare = 0.05;  // of the slice distance; headers round to 0.01 mm
constexpr double kShearMm = 0.5;       // sideways from the first slice to the last
constexpr std::size_t kMostNamed = 6;

Vec3 Vector(const double (&numbers)[3]) {
  return {numbers[0], numbers[1], numbers[2]};
}

/// "slice 12 (IM000012)"
std::string Name(const DicomSlice& slice) {
  return "slice " + std::to_string(slice.header.instance_number) + " (" + core::Printable(slice.file, 80) +
         ")";
}

std::string Millimetres(double length) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g mm", length);
  return text;
}

Error Mixed(const DicomSlice& a, const DicomSlice& b, const char* what) {
  return {ErrorCode::kImageSeriesMixed,
          Name(a) + " and " + Name(b) + " " + what +
              "; put one series into a folder of its own, or choose one with --series"};
}

std::optional<Error> FindDifference(const DicomSlice& a, const DicomSlice& b) {
  const ImageHeader &x = a.header, &y = b.header;
  if (x.patient_hash != y.patient_hash) return Mixed(a, b, "are of two patients");
  if (x.series_hash != y.series_hash) return Mixed(a, b, "are of two series");
  if (x.frame_hash != y.frame_hash) return Mixed(a, b, "have two frames of reference");
  if (x.width != y.width || x.height != y.height) return Mixed(a, b, "have different sizes");
  if (x.channels != y.channels || x.samples != y.samples || x.is_inverted != y.is_inverted)
    return Mixed(a, b, "have different kinds of pixels");
  for (int axis = 0; axis < 2; ++axis) {
    if (std::fabs(x.spacing[axis] - y.spacing[axis]) > kSameSpacing)
      return Mixed(a, b, "have pixels of different sizes");
    if (Norm(Vector(x.direction[axis]) - Vector(y.direction[axis])) > kSameDirection)
      return Mixed(a, b, "have different orientations");
  }
  return std::nullopt;
}

struct Placed {
  std::size_t slice;
  double along;  // the normal [mm]
};

/// What is wrong with the distances between neighbours.
std::optional<Error> FindUneven(std::span<const DicomSlice> slices, std::span<const Placed> placed,
                                double step) {
  const auto distance_to = [&](std::size_t i) { return placed[i].along - placed[i - 1].along; };
  for (std::size_t i = 1; i < placed.size(); ++i) {
    if (distance_to(i) >= kDoubledMm) continue;
    return Error{ErrorCode::kImageSeriesUneven, Name(slices[placed[i - 1].slice]) + " and " +
                                                    Name(slices[placed[i].slice]) +
                                                    " lie in the same place; remove one of them"};
  }
  std::string gaps;
  std::size_t count = 0;
  for (std::size_t i = 1; i < placed.size(); ++i) {
    const double distance = distance_to(i);
    const DicomSlice &a = slices[placed[i - 1].slice], &b = slices[placed[i].slice];
    const double ratio = distance / step;
    if (std::fabs(ratio - 1) <= kUnevenShare) continue;
    const double missing = std::round(ratio) - 1;
    if (missing < 1 || std::fabs(ratio - std::round(ratio)) > kUnevenShare * std::round(ratio)) {
      return Error{ErrorCode::kImageSeriesUneven,
                   Name(a) + " and " + Name(b) + " are " + Millimetres(distance) + " apart, others " +
                       Millimetres(step) + "; resample the series to even distances"};
    }
    if (++count <= kMostNamed) {
      char number[32];
      std::snprintf(number, sizeof(number), "%.0f", missing);
      gaps += (gaps.empty() ? "" : "; ") + std::string(number) + " between " + Name(a) + " and " + Name(b);
    }
  }
  if (count == 0) return std::nullopt;
  return Error{
      ErrorCode::kImageSeriesGap,
      "slices are missing: " + gaps + (count > kMostNamed ? "; and more" : "") + "; get the whole series"};
}

/// Instance numbers that run along with the positions.
bool AreInstancesUsable(std::span<const DicomSlice> slices, std::span<const Placed> placed, int& sign) {
  sign = 1;
  if (placed.size() < 2) return slices[placed[0].slice].header.instance_number >= 0;
  const auto number = [&](std::size_t i) { return slices[placed[i].slice].header.instance_number; };
  sign = number(1) < number(0) ? -1 : 1;
  for (std::size_t i = 1; i < placed.size(); ++i) {
    if (number(i) - number(i - 1) != sign) return false;
  }
  return std::min(number(0), number(placed.size() - 1)) >= 0;
}

}  // namespace

std::vector<std::vector<DicomSlice>> SplitSeries(std::span<const DicomSlice> slices) {
  std::vector<std::vector<DicomSlice>> series;
  for (const DicomSlice& slice : slices) {
    const auto same = std::find_if(series.begin(), series.end(), [&](const auto& other) {
      return other.front().header.series_hash == slice.header.series_hash;
    });
    if (same != series.end())
      same->push_back(slice);
    else
      series.push_back({slice});
  }
  return series;
}

core::Result<DicomOrder> OrderDicomSlices(std::span<const DicomSlice> slices) {
  TROCAR_ASSERT(!slices.empty());
  for (const DicomSlice& slice : slices) {
    if (slice.header.has_position == 0 || slice.header.spacing[0] == 0) {
      return Error{ErrorCode::kImageGeometryInvalid,
                   Name(slice) +
                       " does not say where it lies (Image Position, Image Orientation, Pixel Spacing); "
                       "export the original series"};
    }
    if (auto difference = FindDifference(slices[0], slice)) return *difference;
  }
  const Vec3 normal = Vector(slices[0].header.direction[2]);
  std::vector<Placed> placed;
  for (std::size_t i = 0; i < slices.size(); ++i)
    placed.push_back({i, Dot(normal, Vector(slices[i].header.origin))});
  std::stable_sort(placed.begin(), placed.end(),
                   [](const Placed& a, const Placed& b) { return a.along < b.along; });

  DicomOrder order;
  if (placed.size() > 1) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < placed.size(); ++i) steps.push_back(placed[i].along - placed[i - 1].along);
    std::sort(steps.begin(), steps.end());
    // the lower median: a gap makes distances longer, never shorter
    if (auto error = FindUneven(slices, placed, steps[(steps.size() - 1) / 2])) return *error;
    const Vec3 span = Vector(slices[placed.back().slice].header.origin) -
                      Vector(slices[placed.front().slice].header.origin);
    const double along = Dot(span, normal);
    const double sideways = Norm(span - along * normal);
    if (sideways > kShearMm) {
      return Error{ErrorCode::kImageSeriesUneven, "the slices are shifted against each other, by " +
                                                      Millimetres(sideways) +
                                                      " in all (a tilted gantry?); resample the series"};
    }
    order.slice_mm = along / static_cast<double>(placed.size() - 1);
  }
  int sign = 1;
  const bool is_numbered = AreInstancesUsable(slices, placed, sign);
  if (!is_numbered) sign = 1;
  if (sign < 0) std::reverse(placed.begin(), placed.end());
  order.direction = static_cast<double>(sign) * normal;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    order.slices.push_back(placed[i].slice);
    order.numbers.push_back(is_numbered ? slices[placed[i].slice].header.instance_number
                                        : static_cast<int>(i) + 1);
  }
  return order;
}

}  // namespace trocar::images
