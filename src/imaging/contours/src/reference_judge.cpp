// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/reference_judge.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "trocar/base/to_integer.h"
#include "trocar/contours/reference_contours.h"
#include "trocar/meshing/mesh_slice.h"

namespace trocar::contours {
namespace {

// moves the planes and rows off the mesh's vertices
constexpr double kNudge = 1.7e-6;  // mm

}  // namespace

base::Result<Judgement> Judge(const images::LabelVolume& reference, const ControlPoints& points, int label,
                              const geometry::TriangleMesh& mesh, std::array<int, 2> left_out) {
  const auto found = FindLabelStep(reference, points);
  if (!found.ok()) return found.error();
  const std::array<double, 3>& step = *found;

  std::size_t built = 0, expected = 0, both = 0;
  std::vector<std::vector<double>> crossings(reference.size[1]);
  for (int k = 0; k < reference.size[2]; ++k) {
    const double slice = points.first_slice + ((k + 0.5) * step[2] - 0.5 * points.slice_mm) / points.slice_mm;
    if (slice > left_out[0] - 0.5 && slice < left_out[1] + 0.5) continue;
    for (auto& row : crossings) row.clear();
    const auto row_position = [&](int j) { return (j + 0.5) * step[1] - 0.5 * points.pixel_mm + kNudge; };
    for (meshing::SliceSegment s : meshing::CutMesh(mesh, slice * points.slice_mm + kNudge)) {
      if (s.a.y > s.b.y) std::swap(s.a, s.b);
      int j = std::max(0, base::FloorTo<int>((s.a.y + 0.5 * points.pixel_mm) / step[1] - 0.5));
      for (; j < reference.size[1] && row_position(j) < s.b.y; ++j) {
        if (row_position(j) >= s.a.y)
          crossings[j].push_back(s.a.x + (s.b.x - s.a.x) * (row_position(j) - s.a.y) / (s.b.y - s.a.y));
      }
    }
    for (int j = 0; j < reference.size[1]; ++j) {
      auto& row = crossings[j];
      std::sort(row.begin(), row.end());
      std::size_t passed = 0;
      for (int i = 0; i < reference.size[0]; ++i) {
        const double x = (i + 0.5) * step[0] - 0.5 * points.pixel_mm;
        while (passed < row.size() && row[passed] < x) ++passed;
        const bool is_built = passed % 2 == 1;
        const std::size_t voxel =
            (static_cast<std::size_t>(k) * reference.size[1] + j) * reference.size[0] + i;
        const bool is_expected = reference.labels[voxel] == label;
        built += is_built, expected += is_expected, both += is_built && is_expected;
      }
    }
  }
  if (expected == 0) {
    return base::Error{base::ErrorCode::kLabelsMismatch,
                       "the reference labels do not belong to these images: label " + std::to_string(label) +
                           " does not occur; name the labels of this series"};
  }
  const double voxel_ml = step[0] * step[1] * step[2] / 1000.0;
  Judgement judgement;
  judgement.volume_ml = static_cast<double>(built) * voxel_ml;
  judgement.reference_ml = static_cast<double>(expected) * voxel_ml;
  judgement.ratio = judgement.volume_ml / judgement.reference_ml;
  judgement.dice = 2.0 * static_cast<double>(both) / static_cast<double>(built + expected);
  return judgement;
}

}  // namespace trocar::contours
