// SPDX-License-Identifier: Apache-2.0
#include "label_neighbours.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "trocar/base/to_integer.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/math/elementary.h"
#include "trocar/meshing/label_volume.h"
#include "trocar/meshing/mesh_smoothing.h"
#include "trocar/meshing/volume_mesher.h"

namespace trocar::anatomy {
namespace {

constexpr double kPixelMm = 1.0;    // of a slice, unless the voxels are larger
constexpr double kSpacingMm = 2.0;  // of the volume's lattice
constexpr double kLeastPartMl = 0.4, kLeastPartShare = 0.03;
constexpr int kMostParts = 8;          // of one label
constexpr double kTriangleMm2 = 22.0;  // one for so much of a ball's surface of that volume
constexpr int kFewestTriangles = 240, kMostTriangles = 3600;  // of a part

/// Part of a map with one label as 1, and where it lies in the map.
struct Crop {
  images::LabelVolume part;
  std::array<int, 3> low{};
};

/// Voxels near liver and gallbladder.
struct Reach {
  std::array<int, 3> low{}, high{};
};

Reach FindReach(const images::LabelVolume& volume, const OrganLabels& organs, const LabelBoxes& boxes,
                const VoxelFrame& frame) {
  Reach reach;
  const LabelBox &liver = boxes.at(organs.liver), &gallbladder = boxes.at(organs.gallbladder);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int margin = base::RoundTo<int>(kNeighbourReachMm / frame.step_mm[axis]);
    reach.low[axis] = std::max(0, std::min(liver.low[axis], gallbladder.low[axis]) - margin);
    reach.high[axis] =
        std::min(volume.size[axis] - 1, std::max(liver.high[axis], gallbladder.high[axis]) + margin);
  }
  return reach;
}

/// The label within reach, with an empty voxel all round; nothing where there is none.
std::optional<Crop> CropLabel(const images::LabelVolume& volume, int label, const LabelBox& box,
                              const Reach& reach) {
  Crop crop;
  std::array<int, 3> low{}, high{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = std::max(box.low[axis], reach.low[axis]);
    high[axis] = std::min(box.high[axis], reach.high[axis]);
    if (low[axis] > high[axis]) return std::nullopt;
    crop.low[axis] = low[axis] - 1;
    crop.part.size[axis] = high[axis] - low[axis] + 3;
  }
  const auto width = static_cast<std::size_t>(crop.part.size[0]);
  crop.part.labels.assign(width * crop.part.size[1] * crop.part.size[2], 0);
  oneapi::tbb::parallel_for(low[2], high[2] + 1, [&](int k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      const auto row = (static_cast<std::size_t>(k) * volume.size[1] + j) * volume.size[0];
      const auto to =
          (static_cast<std::size_t>(k - crop.low[2]) * crop.part.size[1] + (j - crop.low[1])) * width;
      for (int i = low[0]; i <= high[0]; ++i) {
        if (volume.labels[row + static_cast<std::size_t>(i)] == label)
          crop.part.labels[to + static_cast<std::size_t>(i - crop.low[0])] = 1;
      }
    }
  });
  return crop;
}

/// A part of a label, meshed.
struct PartMesh {
  geometry::TriangleMesh mesh;
  double voxels_ml = 0;
  std::string problem;  ///< why there is no mesh
};

int BudgetOf(double volume_mm3) {
  const double ball = math::Cbrt(36.0 * M_PI * volume_mm3 * volume_mm3);
  // organs are longer and more folded than a ball
  return std::clamp(base::TruncateTo<int>(1.6 * ball / kTriangleMm2), kFewestTriangles, kMostTriangles);
}

PartMesh MeshPart(const images::LabelVolume& part, double volume_mm3, const std::array<int, 3>& low,
                  const VoxelFrame& frame) {
  PartMesh made;
  made.voxels_ml = volume_mm3 / 1000.0;
  const double pixel = std::max(kPixelMm, std::min(frame.step_mm[0], frame.step_mm[1]));
  meshing::LabelVolumeSettings volume_settings;
  volume_settings.spacing_mm = kSpacingMm;
  volume_settings.thinnest_mm = 0.0;
  auto volume = meshing::MakeLabelVolume(meshing::FillLabelSlices(part, 1, frame.step_mm, pixel), pixel,
                                         volume_mm3, volume_settings);
  if (!volume.ok()) return made.problem = volume.error().message, made;
  meshing::MeshingSettings settings;
  settings.triangle_budget = BudgetOf(volume_mm3);
  settings.oversampling = 3.0;
  settings.smoothing.iterations = 40;
  settings.distance_samples = 0;
  auto meshed = meshing::MeshVolume(std::move(*volume), settings);
  if (!meshed.ok()) return made.problem = meshed.error().message, made;
  made.mesh = std::move(meshed->mesh);
  // a lattice this coarse loses some per cent of what is thin
  meshing::SetVolume(made.mesh, volume_mm3);
  const math::Vec3 shift = {low[0] * frame.step_mm[0], low[1] * frame.step_mm[1], low[2] * frame.step_mm[2]};
  for (math::Vec3& p : made.mesh.positions) {
    p += shift;
    p = p.x * frame.axes[0] + p.y * frame.axes[1] + p.z * frame.axes[2];
  }
  // a mirrored frame turns the triangles inside out
  if (geometry::CalcVolume(made.mesh.positions, made.mesh.triangles) < 0) {
    for (auto& t : made.mesh.triangles) std::swap(t[1], t[2]);
  }
  return made;
}

/// The parts of one label, the largest first.
/// \param[out] left_out_ml  of the small ones
std::vector<PartMesh> MeshLabel(const images::LabelVolume& volume, int label, const LabelBox& box,
                                const Reach& reach, const VoxelFrame& frame, double& left_out_ml) {
  std::vector<PartMesh> parts;
  auto crop = CropLabel(volume, label, box, reach);
  if (!crop) return parts;
  double whole_mm3 = 0;
  for (int round = 0; round < kMostParts; ++round) {
    images::LabelVolume part = crop->part;
    const auto voxels = meshing::KeepLargestPart(part, 1);
    if (voxels.empty()) break;
    double rest_mm3 = 0;
    for (const std::size_t count : voxels) rest_mm3 += static_cast<double>(count) * frame.VoxelMm3();
    if (round == 0) whole_mm3 = rest_mm3;
    left_out_ml = rest_mm3 / 1000.0;
    const double volume_mm3 = static_cast<double>(voxels.front()) * frame.VoxelMm3();
    if (volume_mm3 < std::max(1000.0 * kLeastPartMl, kLeastPartShare * whole_mm3)) break;
    left_out_ml -= volume_mm3 / 1000.0;
    parts.push_back(MeshPart(part, volume_mm3, crop->low, frame));
    if (voxels.size() == 1) break;
    for (std::size_t i = 0; i < part.labels.size(); ++i) crop->part.labels[i] -= part.labels[i];
  }
  return parts;
}

void Append(const geometry::TriangleMesh& part, geometry::TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
  for (const geometry::Triangle& t : part.triangles)
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

}  // namespace

LabelBoxes FindLabelBoxes(const images::LabelVolume& volume) {
  LabelBoxes boxes;
  const auto width = static_cast<std::size_t>(volume.size[0]);
  std::int32_t last_label = 0;
  LabelBox* last = nullptr;
  for (int k = 0; k < volume.size[2]; ++k) {
    for (int j = 0; j < volume.size[1]; ++j) {
      const std::int32_t* row = &volume.labels[(static_cast<std::size_t>(k) * volume.size[1] + j) * width];
      for (std::size_t begin = 0; begin < width;) {
        const std::int32_t label = row[begin];
        std::size_t end = begin + 1;
        while (end < width && row[end] == label) ++end;
        if (label != 0) {
          if (last == nullptr || label != last_label) {
            const auto [at, is_new] = boxes.try_emplace(label);
            last = &at->second, last_label = label;
            if (is_new) last->low = volume.size, last->high = {-1, -1, -1};
          }
          last->count += end - begin;
          const std::array<int, 3> first = {static_cast<int>(begin), j, k},
                                   final = {static_cast<int>(end) - 1, j, k};
          for (std::size_t axis = 0; axis < 3; ++axis) {
            last->low[axis] = std::min(last->low[axis], first[axis]);
            last->high[axis] = std::max(last->high[axis], final[axis]);
          }
        }
        begin = end;
      }
    }
  }
  return boxes;
}

NeighbourLabels FindNeighbourLabels(const OrganLabels& organs, const LabelBoxes& boxes) {
  NeighbourLabels found;
  for (const auto& [label, structure] : organs.structures) {
    if (!boxes.contains(label) || label == organs.liver || label == organs.gallbladder) continue;
    if (const roles::NeighbourRole role = RoleOf(structure); role != roles::NeighbourRole::kOther)
      found.roles[label] = role;
    if (structure == Structure::kVertebraL3) found.third_lumbar = label;
    if (structure == Structure::kVertebraL4) found.fourth_lumbar = label;
    if (structure == Structure::kBody) found.body = label;
  }
  return found;
}

std::vector<NeighbourMesh> MeshNeighbours(const images::LabelVolume& volume, const NeighbourLabels& labels,
                                          const OrganLabels& organs, const LabelBoxes& boxes,
                                          const VoxelFrame& frame, std::vector<std::string>& notes) {
  const Reach reach = FindReach(volume, organs, boxes, frame);
  const std::vector<std::pair<int, roles::NeighbourRole>> wanted(labels.roles.begin(), labels.roles.end());
  std::vector<std::vector<PartMesh>> parts(wanted.size());
  std::vector<double> left_out(wanted.size(), 0.0);
  oneapi::tbb::parallel_for(std::size_t{0}, wanted.size(), [&](std::size_t i) {
    parts[i] = MeshLabel(volume, wanted[i].first, boxes.at(wanted[i].first), reach, frame, left_out[i]);
  });
  std::vector<NeighbourMesh> made;
  for (std::size_t r = 1; r < roles::kNeighbourRoleCount; ++r) {
    NeighbourMesh one;
    one.role = static_cast<roles::NeighbourRole>(r);
    one.report.name = roles::NameOf(one.role);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      if (wanted[i].second != one.role) continue;
      one.report.left_out_ml += left_out[i];
      for (const PartMesh& part : parts[i]) {
        if (!part.problem.empty()) {
          notes.push_back("A part of label " + std::to_string(wanted[i].first) + " (" +
                          roles::SpokenName(one.role) + ") is left out: " + part.problem + ".");
          one.report.left_out_ml += part.voxels_ml;
          continue;
        }
        one.report.voxels_ml += part.voxels_ml;
        ++one.report.parts;
        Append(part.mesh, one.mesh);
      }
    }
    if (!one.mesh.triangles.empty()) made.push_back(std::move(one));
  }
  return made;
}

}  // namespace trocar::anatomy
