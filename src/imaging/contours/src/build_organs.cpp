// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/build_organs.h"

#include <algorithm>
#include <cmath>

#include "contoured_structure.h"
#include "trocar/base/to_integer.h"
#include "trocar/meshing/volume.h"
#include "trocar/meshing/volume_mesher.h"
#include "volume_opening.h"

namespace trocar::contours {
namespace {

using base::Error;

constexpr double kCubicMmPerMl = 1000.0;
constexpr double kThinnestMm = 7.0;  // within a slice; tips thinner than this are cut off
constexpr double kBallEdges =
    1.54;  // across the ball that fits wherever an organ is kept, chosen from pictures

Error GivenUp() {
  return {base::ErrorCode::kCancelled, "the organs were given up"};
}

}  // namespace

base::Result<images::ImageSeries> OpenContouredSeries(const ControlPoints& points,
                                                      const std::filesystem::path& folder,
                                                      const std::vector<int>& numbers,
                                                      const images::Progress& progress, int dicom_series) {
  images::ImageSeriesOptions series_options;
  series_options.pixel_mm = points.pixel_mm;
  series_options.slice_mm = points.slice_mm;
  series_options.axes = points.axes;
  series_options.pattern = points.image_pattern;
  series_options.slices = numbers;
  series_options.series = dicom_series;
  const auto series = images::ImageSeries::Open(folder, series_options, progress);
  if (!series.ok()) return series.error();
  const images::ImageSeriesInfo& info = series->Info();
  if (info.width != points.width || info.height != points.height) {
    return Error{base::ErrorCode::kImageSizeDiffers,
                 "the images have " + std::to_string(info.width) + " x " + std::to_string(info.height) +
                     " pixels, but the control points were placed on " + std::to_string(points.width) +
                     " x " + std::to_string(points.height) + "; use the images that the points belong to"};
  }
  return series;
}

base::Result<std::map<int, images::ColorImage>> ReadContouredSlices(
    const ControlPoints& points, const std::filesystem::path& folder, const std::vector<int>& numbers,
    std::optional<images::DisplayWindow> window, const images::Progress& progress, int dicom_series) {
  const auto series = OpenContouredSeries(points, folder, numbers, progress, dicom_series);
  if (!series.ok()) return series.error();
  return images::ReadSlices(*series, numbers, window.value_or(series->Info().suggested_window), progress);
}

bool FollowsSkippedSlices(const ControlPoints& points) {
  return std::any_of(points.structures.begin(), points.structures.end(), [](const Structure& structure) {
    return structure.adaption.max_shift_px > 0 && structure.adaption.skipped_shift_px > 0;
  });
}

base::Status ReadSkippedFrom(const ControlPoints& points, const std::filesystem::path& folder,
                             std::optional<images::DisplayWindow> window, OrganOptions& options,
                             int dicom_series) {
  const auto series = OpenContouredSeries(points, folder, {}, {}, dicom_series);
  if (!series.ok()) {
    return Error{series.error().code,
                 series.error().message + "; without the slices that were skipped: skipped_shift_px 0"};
  }
  options.series = series->Info().slice_numbers;
  options.read_skipped = [series = *series, window](const std::vector<int>& slices) {
    return images::ReadSlices(series, slices, window.value_or(series.Info().suggested_window));
  };
  return {};
}

base::Result<BuiltOrgans> BuildOrgans(const ControlPoints& points,
                                      const std::map<int, images::ColorImage>& images,
                                      const OrganOptions& options, const images::Progress& progress) {
  const auto report_progress = [&](std::string_view what, double part) {
    if (progress) progress(what, part);
  };
  if (!(options.spacing_mm >= 0.4 && options.spacing_mm <= 4.0) ||
      !(options.gap_mm >= 0.0 && options.gap_mm <= 5.0)) {
    return Error{base::ErrorCode::kUsage, "spacing_mm must lie between 0.4 and 4, gap_mm between 0 and 5"};
  }
  BuiltOrgans built;
  auto& overlays = built.overlays;
  std::vector<meshing::ScalarVolume> volumes;
  const auto count = static_cast<double>(points.structures.size());
  for (const Structure& structure : points.structures) {
    report_progress("following contours of " + structure.name, static_cast<double>(volumes.size()) / count);
    auto contoured = FollowContours(points, structure, images, options.stop, overlays);
    if (!contoured.ok()) return contoured.error();
    const images::Progress tell_part = [&](std::string_view what, double part) {
      report_progress(what, (static_cast<double>(volumes.size()) + part) / count);
    };
    if (auto status = AddSlicesByPictures(points, structure, images, options, tell_part, *contoured); !status)
      return status.error();
    auto dense = AddSlicesByShape(*contoured);
    for (meshing::FilledSlice& slice : dense)
      meshing::OpenMask(slice.mask, kThinnestMm / 2 / points.pixel_mm);
    auto volume = meshing::MakeVolume(dense, points.pixel_mm, options.spacing_mm, contoured->ends_mm);
    if (!volume.ok()) return Error{volume.error().code, structure.name + ": " + volume.error().message};
    volumes.push_back(std::move(*volume));
    built.organs.push_back(std::move(contoured->report));
  }
  for (const TubePoints& tube : points.tubes) {
    for (const TubePoint& point : tube.points) {
      const auto found = overlays.find(base::RoundTo<int>(point.slice));
      if (found != overlays.end()) found->second.tube_points.push_back(point.pixel);
    }
  }
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    for (std::size_t k = i + 1; k < volumes.size(); ++k)
      meshing::Subtract(volumes[i], volumes[k], options.gap_mm);
  }

  for (std::size_t i = 0; i < volumes.size(); ++i) {
    const Structure& structure = points.structures[i];
    if (options.stop.stop_requested()) return GivenUp();
    report_progress("meshing " + structure.name, static_cast<double>(i) / count);
    meshing::MeshingSettings settings;
    settings.triangle_budget = structure.triangle_budget;
    OpenVolume(volumes[i], kBallEdges / 2 * CalcEdgeLength(volumes[i], structure.triangle_budget));
    auto meshed = meshing::MeshVolume(std::move(volumes[i]), settings);
    if (!meshed.ok()) return Error{meshed.error().code, structure.name + ": " + meshed.error().message};
    OrganReport& organ = built.organs[i];
    AddMeshQuality(organ, meshed->quality);
    if (options.reference != nullptr && structure.reference_label > 0) {
      auto judged = Judge(*options.reference, points, structure.reference_label, meshed->mesh,
                          structure.reference_left_out);
      if (!judged.ok()) return judged.error();
      organ.judgement = *judged;
    }
    built.meshes.push_back({structure.name, std::move(meshed->mesh)});
  }

  return built;
}

void AddMeshQuality(OrganReport& report, const meshing::MeshQuality& quality) {
  const geometry::MeshReport& surface = quality.surface;
  report.triangles = surface.triangles;
  report.closed = surface.closed, report.manifold = surface.manifold, report.outward = surface.outward;
  report.genus = surface.genus;
  report.self_intersections = quality.self_intersections;
  report.min_angle_deg = surface.min_angle * 180.0 / M_PI;
  report.mean_min_angle_deg = surface.mean_min_angle * 180.0 / M_PI;
  report.volume_ml = surface.volume / kCubicMmPerMl;
  report.volume_change = quality.volume_change;
  report.hausdorff_mm = quality.distance.Hausdorff();
  report.mean_distance_mm = quality.distance.mean_from_mesh;
  report.samples_per_square_mm = static_cast<double>(quality.distance.mesh_samples) / surface.area;
}

}  // namespace trocar::contours
