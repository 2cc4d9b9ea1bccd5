// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/patient_from_labels.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <vector>

#include "duct_template.h"
#include "trocar/anatomy/marching_cubes.h"
#include "trocar/anatomy/mesh_decimation.h"
#include "trocar/anatomy/mesh_smoothing.h"
#include "trocar/anatomy/patient_builder.h"
#include "trocar/anatomy/volume.h"
#include "trocar/geometry/mesh_measures.h"

namespace trocar::anatomy {
namespace {

using core::Error;
using core::ErrorCode;
using math::Vec3;

constexpr int kLiverTriangles = 5132;        // as the built-in patient
constexpr int kGallbladderTriangles = 1798;  // likewise
constexpr double kCubicMmPerMl = 1000.0;
constexpr double kThinnestMm = 5.0;  // what is thinner within a slice is cut off
constexpr double kBlurMm = 2.0;      // width of the blur, about 1.4 times its standard deviation
constexpr double kLargestVoxelMm = 20.0;
constexpr double kMaxPixels = 4e6;  // of one slice after it was given square pixels

Error Mismatch(const std::string& why) {
  return {ErrorCode::kLabelsMismatch, why};
}

std::array<std::size_t, 256> CountLabels(const LabelVolume& volume) {
  std::array<std::size_t, 256> counts{};
  for (const auto label : volume.labels) ++counts[label];
  return counts;
}

std::string LowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::erase_if(text, [](char c) { return c == ' ' || c == '_' || c == '-'; });
  return text;
}

/// Slices of one label along the third axis, with square pixels of `pixel_mm`.
std::vector<FilledSlice> FillSlices(const LabelVolume& volume, int label, const std::array<double, 3>& step,
                                    double pixel_mm) {
  std::vector<FilledSlice> slices;
  const auto plane = static_cast<std::size_t>(volume.size[0]) * volume.size[1];
  const int width = static_cast<int>(std::ceil(volume.size[0] * step[0] / pixel_mm));
  const int height = static_cast<int>(std::ceil(volume.size[1] * step[1] / pixel_mm));
  for (int k = 0; k < volume.size[2]; ++k) {
    FilledSlice slice;
    slice.position_mm = k * step[2];
    slice.mask.x0 = 0, slice.mask.y0 = 0, slice.mask.width = width, slice.mask.height = height;
    slice.mask.inside.assign(static_cast<std::size_t>(width) * height, 0);
    bool is_empty = true;
    for (int y = 0; y < height; ++y) {
      const int j = std::min(volume.size[1] - 1, static_cast<int>(std::lround(y * pixel_mm / step[1])));
      for (int x = 0; x < width; ++x) {
        const int i = std::min(volume.size[0] - 1, static_cast<int>(std::lround(x * pixel_mm / step[0])));
        const bool inside =
            volume.labels[plane * k + static_cast<std::size_t>(j) * volume.size[0] + i] == label;
        slice.mask.inside[static_cast<std::size_t>(y) * width + x] = inside;
        is_empty &= !inside;
      }
    }
    if (is_empty) continue;
    // only the rectangle that is filled
    int x0 = width, x1 = 0, y0 = height, y1 = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        if (!slice.mask.inside[static_cast<std::size_t>(y) * width + x]) continue;
        x0 = std::min(x0, x), x1 = std::max(x1, x + 1), y0 = std::min(y0, y), y1 = std::max(y1, y + 1);
      }
    }
    Mask small;
    small.x0 = x0, small.y0 = y0, small.width = x1 - x0, small.height = y1 - y0;
    for (int y = y0; y < y1; ++y) {
      const auto* row = &slice.mask.inside[static_cast<std::size_t>(y) * width];
      small.inside.insert(small.inside.end(), row + x0, row + x1);
    }
    slice.mask = std::move(small);
    slices.push_back(std::move(slice));
  }
  return slices;
}

/// Binomial blur of the distances along every axis: label maps have tunnels and threads of a voxel or two
/// that no organ has.
void Blur(ScalarVolume& volume, int rounds) {
  const std::array<std::size_t, 3> strides = {
      1, static_cast<std::size_t>(volume.size[0]),
      static_cast<std::size_t>(volume.size[0]) * static_cast<std::size_t>(volume.size[1])};
  std::vector<float> blurred(volume.values.size());
  for (int round = 0; round < rounds; ++round) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto length = static_cast<std::size_t>(volume.size[axis]);
      for (std::size_t i = 0; i < volume.values.size(); ++i) {
        const std::size_t at = i / strides[axis] % length;
        const float here = volume.values[i];
        const float before = at > 0 ? volume.values[i - strides[axis]] : here;
        const float after = at + 1 < length ? volume.values[i + strides[axis]] : here;
        blurred[i] = 0.25f * before + 0.5f * here + 0.25f * after;
      }
      std::swap(blurred, volume.values);
    }
  }
}

/// Moves the surface so that `volume_mm3` lies inside: what a blur took comes back.
void SetInsideVolume(ScalarVolume& volume, double volume_mm3) {
  const double wanted = volume_mm3 / std::pow(volume.spacing, 3);
  const auto rank = std::min(static_cast<std::size_t>(wanted), volume.values.size() - 1);
  std::vector<float> sorted = volume.values;
  const auto nth = sorted.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(sorted.begin(), nth, sorted.end(), std::greater<>());
  const float level = *nth;
  for (float& value : volume.values) value -= level;
}

/// The end of the gallbladder that is more cranial and posterior.
Vec3 FindNeck(const geometry::TriangleMesh& gallbladder) {
  Vec3 centre;
  for (const Vec3& p : gallbladder.positions) centre += p / static_cast<double>(gallbladder.positions.size());
  const auto furthest = [&](const Vec3& from) {
    return *std::max_element(
        gallbladder.positions.begin(), gallbladder.positions.end(),
        [&](const Vec3& a, const Vec3& b) { return SquaredDistance(a, from) < SquaredDistance(b, from); });
  };
  const Vec3 one = furthest(centre), other = furthest(one);
  const Vec3 upwards = {0.4, 0.6, -1.0};
  return Dot(one, upwards) > Dot(other, upwards) ? one : other;
}

}  // namespace

core::Result<OrganLabels> FindLabels(const LabelVolume& volume, const LabelOptions& options) {
  const auto counts = CountLabels(volume);
  OrganLabels found{options.liver, options.gallbladder, "named on request"};
  if (found.liver == 0 || found.gallbladder == 0) {
    OrganLabels usual;
    for (const auto& [name, label] : volume.names) {
      const std::string plain = LowerCase(name);
      if (plain == "liver") usual.liver = label;
      if (plain == "gallbladder") usual.gallbladder = label;
    }
    usual.convention = "segment names";
    if (usual.liver == 0 || usual.gallbladder == 0) {
      const bool is_total = counts[5] > counts[1] && counts[5] > counts[2];
      usual = is_total ? OrganLabels{5, 2, "TotalSegmentator's numbers"} : OrganLabels{1, 2, "1 and 2"};
    }
    if (found.liver == 0) found.liver = usual.liver;
    if (found.gallbladder == 0) found.gallbladder = usual.gallbladder;
    found.convention = usual.convention;
  }
  std::string present;
  for (int label = 1; label < 256; ++label) {
    if (counts[label] > 0) present += (present.empty() ? "" : ", ") + std::to_string(label);
  }
  const auto is_missing = [&](int label) { return label < 1 || label > 255 || counts[label] == 0; };
  for (const auto& [name, label] : {std::pair{"liver", found.liver}, {"gallbladder", found.gallbladder}}) {
    if (!is_missing(label)) continue;
    return Mismatch("the label map has no label " + std::to_string(label) + ", which should be the " + name +
                    " (found by: " + found.convention + "); it has " + (present.empty() ? "none" : present) +
                    "; name the right one with --" + name);
  }
  if (found.liver == found.gallbladder) {
    return Mismatch("liver and gallbladder have the same label " + std::to_string(found.liver) +
                    "; name two different ones");
  }
  return found;
}

core::Result<BuildReport> BuildPatientFromLabels(const LabelOptions& options, const Progress& progress) {
  const auto tell = [&](std::string_view what, double part) {
    if (progress) progress(what, part);
  };
  if (!(options.spacing_mm >= 0.4 && options.spacing_mm <= 4.0) ||
      !(options.gap_mm >= 0.0 && options.gap_mm <= 5.0)) {
    return Error{ErrorCode::kUsage, "spacing_mm must lie between 0.4 and 4, gap_mm between 0 and 5"};
  }
  tell("reading labels", 0.0);
  const auto volume = ReadLabelVolume(options.labels);
  if (!volume.ok()) return volume.error();
  std::array<double, 3> step{};
  std::array<Vec3, 3> axes;  // of one millimetre along each axis, (left, cranial, anterior)
  for (int axis = 0; axis < 3; ++axis) {
    const auto& d = volume->direction[axis];
    const Vec3 world = {d[0], d[2], -d[1]};
    step[axis] = Norm(world);
    if (!(step[axis] > 0.01 && step[axis] <= kLargestVoxelMm)) {
      return Mismatch(options.labels.string() + ": voxels measure " + std::to_string(step[axis]) +
                      " mm along axis " + std::to_string(axis + 1) + "; they must measure 0.01 to 20 mm");
    }
    axes[axis] = world / step[axis];
  }
  if (std::fabs(Dot(Cross(axes[0], axes[1]), axes[2])) < 0.99) {
    return Mismatch(options.labels.string() + ": its axes are not at right angles; resample it");
  }
  const double pixel = std::max(0.5, std::min(step[0], step[1]));
  if (volume->size[0] * step[0] / pixel * (volume->size[1] * step[1] / pixel) > kMaxPixels) {
    return Mismatch(options.labels.string() + ": a slice covers too large an area; crop it");
  }
  const auto labels = FindLabels(*volume, options);
  if (!labels.ok()) return labels.error();

  struct Part {
    const char* name;
    int label, triangles;
  };
  const Part parts[] = {{"liver", labels->liver, kLiverTriangles},
                        {"gallbladder", labels->gallbladder, kGallbladderTriangles}};
  const auto counts = CountLabels(*volume);
  BuildReport report;
  std::vector<ScalarVolume> volumes;
  for (const Part& part : parts) {
    tell(std::string("filling ") + part.name, 0.1);
    auto slices = FillSlices(*volume, part.label, step, pixel);
    for (FilledSlice& slice : slices) OpenMask(slice.mask, 0.5 * kThinnestMm / pixel);
    if (slices.size() < 2) {
      return Error{ErrorCode::kContourEmpty, std::string(part.name) + ": label " +
                                                 std::to_string(part.label) +
                                                 " lies in one slice only; at least two are needed"};
    }
    auto distances = MakeVolume(slices, pixel, options.spacing_mm);
    if (!distances.ok()) return distances.error();
    Blur(*distances, static_cast<int>(std::lround(std::pow(kBlurMm / options.spacing_mm, 2))));
    SetInsideVolume(*distances, static_cast<double>(counts[part.label]) * step[0] * step[1] * step[2]);
    volumes.push_back(std::move(*distances));
    OrganReport organ;
    organ.name = part.name;
    organ.slices = slices.size();
    report.organs.push_back(organ);
  }
  Subtract(volumes[0], volumes[1], options.gap_mm);

  std::vector<StructureMesh> meshes;
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    tell(std::string("meshing ") + parts[i].name, 0.3 + 0.3 * static_cast<double>(i));
    KeepLargestPart(volumes[i]);
    auto mesh = MarchCubes(volumes[i]);
    if (mesh.triangles.empty()) {
      return Error{ErrorCode::kContourEmpty,
                   std::string(parts[i].name) + " encloses nothing; check its label"};
    }
    SmoothMesh(mesh);
    auto decimated = DecimateMesh(mesh, {.triangle_budget = parts[i].triangles});
    if (!decimated.ok())
      return Error{decimated.error().code, std::string(parts[i].name) + ": " + decimated.error().message};
    for (Vec3& p : decimated->positions) p = p.x * axes[0] + p.y * axes[1] + p.z * axes[2];
    // a mirrored frame turns the triangles inside out
    if (geometry::CalcVolume(decimated->positions, decimated->triangles) < 0) {
      for (auto& t : decimated->triangles) std::swap(t[1], t[2]);
    }
    OrganReport& organ = report.organs[i];
    const auto measured = geometry::InspectMesh(*decimated);
    organ.triangles = measured.triangles;
    organ.closed = measured.closed, organ.manifold = measured.manifold, organ.outward = measured.outward;
    organ.genus = measured.genus;
    organ.self_intersections = geometry::CountSelfIntersections(*decimated);
    organ.min_angle_deg = measured.min_angle * 180.0 / M_PI;
    organ.volume_ml = measured.volume / kCubicMmPerMl;
    meshes.push_back({parts[i].name, std::move(*decimated)});
  }

  tell("assembling the patient", 0.9);
  auto usual = DrawParameters(0, MakeUsualSettings());
  if (!usual.ok()) return usual.error();
  ControlPoints frame = MakeWorldFrame();
  // a file name may name a person: it is not kept
  frame.name = "Patient from a label map";
  frame.provenance = "Liver and gallbladder from a label map (" + labels->convention +
                     "); ducts and arteries placed by landmarks, not seen in the images";
  frame.tubes = PlaceDucts(meshes[0].mesh, meshes[1].mesh, FindNeck(meshes[1].mesh), *usual);
  auto patient = AssemblePatient(frame, meshes);
  if (!patient.ok()) return patient.error();
  report.patient = std::move(*patient);
  if (!options.output.empty()) {
    if (const auto status = WritePatient(options.output, report.patient); !status.ok()) return status.error();
  }
  tell("done", 1.0);
  return report;
}

}  // namespace trocar::anatomy
