// SPDX-License-Identifier: Apache-2.0
#include "trocar/images/label_alignment.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "trocar/base/to_integer.h"
#include "trocar/math/vector.h"

namespace trocar::images {
namespace {

using base::Error;
using base::ErrorCode;
using math::Vec3;

constexpr double kExtentTolerance = 1.5;  // of pictures and map without a common frame [mm]
constexpr double kSameAxis = 0.94;        // cosine: 20 degrees, as slices may be oblique

Error Mismatch(const std::string& why) {
  return {ErrorCode::kLabelsMismatch,
          "the label map does not belong to these images: " + why +
              "; choose the map that was drawn on this series, or the series that it was drawn on"};
}

Vec3 Vector(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.0f", value);
  return text;
}

/// A grid in the body: place of a voxel and back.
struct Grid {
  Vec3 origin;
  std::array<Vec3, 3> step;  // of one voxel [mm]
  std::array<int, 3> size;

  Vec3 PlaceOf(double i, double j, double k) const {
    return origin + i * step[0] + j * step[1] + k * step[2];
  }
  /// [voxels]
  Vec3 VoxelOf(const Vec3& place) const {
    const Vec3 p = place - origin, b = Cross(step[1], step[2]), c = Cross(step[2], step[0]),
               a = Cross(step[0], step[1]);
    const double volume = Dot(step[0], b);
    return {Dot(p, b) / volume, Dot(p, c) / volume, Dot(p, a) / volume};
  }
  bool Holds(const Vec3& voxel) const {
    return voxel.x >= -0.5 && voxel.y >= -0.5 && voxel.z >= -0.5 && voxel.x < size[0] - 0.5 &&
           voxel.y < size[1] - 0.5 && voxel.z < size[2] - 0.5;
  }
};

Grid GridOf(const LabelVolume& labels) {
  Grid grid{Vector(labels.origin), {}, labels.size};
  for (int axis = 0; axis < 3; ++axis) grid.step[axis] = Vector(labels.direction[axis]);
  return grid;
}

Grid GridOf(const ImageSeriesInfo& series) {
  const auto& numbers = series.slice_numbers;
  const int step = numbers.size() > 1 ? numbers[1] - numbers[0] : 1;
  Grid grid{Vector(series.origin_mm), {}, {series.width, series.height, static_cast<int>(numbers.size())}};
  const double lengths[3] = {series.pixel_mm, series.pixel_mm, series.slice_mm * step};
  for (int axis = 0; axis < 3; ++axis) grid.step[axis] = lengths[axis] * Vector(series.direction[axis]);
  return grid;
}

/// Pictures say how their axes run, by a person's word, but not where they lie.
base::Result<LabelVolume> CheckAsItIs(LabelVolume labels, const Grid& map, const Grid& images) {
  constexpr const char* kAxes[] = {"columns", "rows", "slices"};
  for (int axis = 0; axis < 3; ++axis) {
    const double length = Norm(map.step[axis]), wanted = Norm(images.step[axis]);
    if (Dot(map.step[axis], images.step[axis]) < kSameAxis * length * wanted)
      return Mismatch(std::string("its ") + kAxes[axis] + " run to another side of the patient");
    const double extent = map.size[axis] * length, pictures = images.size[axis] * wanted;
    if (std::fabs(extent - pictures) > kExtentTolerance) {
      return Mismatch(std::string("its ") + kAxes[axis] + " cover " + Number(extent) +
                      " mm, those of the images " + Number(pictures) + " mm");
    }
  }
  return labels;
}

/// Share of the labelled voxels whose middle lies in the images, and how far apart the middles of both grids are.
base::Status CheckPlace(const LabelVolume& labels, const Grid& map, const Grid& images) {
  std::size_t all = 0, inside = 0;
  std::size_t at = 0;
  for (int k = 0; k < map.size[2]; ++k) {
    for (int j = 0; j < map.size[1]; ++j) {
      for (int i = 0; i < map.size[0]; ++i, ++at) {
        if (labels.labels[at] == 0) continue;
        ++all;
        inside += images.Holds(images.VoxelOf(map.PlaceOf(i, j, k))) ? 1 : 0;
      }
    }
  }
  if (all == 0)
    return Error{ErrorCode::kLabelsMismatch, "the label map holds no label at all; choose another file"};
  const double share = static_cast<double>(inside) / static_cast<double>(all);
  if (share >= kLeastInside) return {};
  const auto middle = [](const Grid& grid) {
    return grid.PlaceOf(0.5 * (grid.size[0] - 1), 0.5 * (grid.size[1] - 1), 0.5 * (grid.size[2] - 1));
  };
  return Mismatch("only " + Number(100 * share) + " % of what it marks lies in them, and their middles are " +
                  Number(Norm(middle(map) - middle(images))) + " mm apart");
}

}  // namespace

base::Result<LabelVolume> AlignLabels(LabelVolume labels, const ImageSeriesInfo& series) {
  const Grid map = GridOf(labels), images = GridOf(series);
  if (series.file_frame.empty()) return CheckAsItIs(std::move(labels), map, images);
  if (auto status = CheckPlace(labels, map, images); !status.ok()) return status.error();
  LabelVolume aligned;
  aligned.size = images.size;
  aligned.origin = series.origin_mm;
  for (int axis = 0; axis < 3; ++axis)
    aligned.direction[axis] = {images.step[axis].x, images.step[axis].y, images.step[axis].z};
  aligned.names = std::move(labels.names);
  aligned.labels.resize(static_cast<std::size_t>(images.size[0]) * images.size[1] * images.size[2]);
  std::size_t at = 0;
  const Vec3 along = map.VoxelOf(images.PlaceOf(1, 0, 0)) - map.VoxelOf(images.PlaceOf(0, 0, 0));
  for (int k = 0; k < images.size[2]; ++k) {
    for (int j = 0; j < images.size[1]; ++j) {
      const Vec3 begin = map.VoxelOf(images.PlaceOf(0, j, k));
      for (int i = 0; i < images.size[0]; ++i, ++at) {
        const Vec3 voxel = begin + i * along;
        if (!map.Holds(voxel)) continue;
        const auto x = base::TruncateTo<std::size_t>(voxel.x + 0.5),
                   y = base::TruncateTo<std::size_t>(voxel.y + 0.5),
                   z = base::TruncateTo<std::size_t>(voxel.z + 0.5);
        aligned.labels[at] = labels.labels[(z * map.size[1] + y) * map.size[0] + x];
      }
    }
  }
  return aligned;
}

}  // namespace trocar::images
