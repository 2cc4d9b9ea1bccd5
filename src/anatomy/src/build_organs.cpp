// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/build_organs.h"

#include <algorithm>
#include <cmath>

#include "trocar/anatomy/contour_fill.h"
#include "trocar/anatomy/contour_fit.h"
#include "trocar/anatomy/contour_morph.h"
#include "trocar/anatomy/volume.h"
#include "trocar/anatomy/volume_mesher.h"

namespace trocar::anatomy {
namespace {

using core::Error;

constexpr double kCubicMmPerMl = 1000.0;
constexpr double kSliceStepMm = 1.0;  // slices are added down to this distance
constexpr double kThinnestMm = 7.0;   // tips thinner than this are cut off

/// The first stage of the paper for one structure: control points become filled slices.
struct ContouredStructure {
  OrganReport report;
  std::vector<FilledSlice> slices;
  std::vector<std::vector<std::vector<Vec2>>> curves;  // of each slice; empty where the slice has holes
};

Error GivenUp() {
  return {core::ErrorCode::kCancelled, "the organs were given up"};
}

/// Slices down to kSliceStepMm: between two single contours by matching them, elsewhere by InsertSlices.
std::vector<FilledSlice> MakeDenseSlices(const ContouredStructure& structure) {
  std::vector<FilledSlice> dense = {structure.slices.front()};
  for (std::size_t s = 0; s + 1 < structure.slices.size(); ++s) {
    const FilledSlice &a = structure.slices[s], &b = structure.slices[s + 1];
    if (structure.curves[s].size() != 1 || structure.curves[s + 1].size() != 1) {
      const auto between = InsertSlices(std::vector<FilledSlice>{a, b}, kSliceStepMm);
      dense.insert(dense.end(), between.begin() + 1, between.end());
      continue;
    }
    const ContourMatch match = MatchContours(structure.curves[s][0], structure.curves[s + 1][0]);
    const int parts = static_cast<int>(std::ceil((b.position_mm - a.position_mm) / kSliceStepMm - 1e-9));
    for (int part = 1; part < parts; ++part) {
      const double t = static_cast<double>(part) / parts;
      dense.push_back({a.position_mm + t * (b.position_mm - a.position_mm), FillArea({match.At(t)}, {})});
    }
    dense.push_back(b);
  }
  return dense;
}

core::Result<ContouredStructure> ExtractContours(const ControlPoints& points, const Structure& structure,
                                                 const std::map<int, ColorImage>& images,
                                                 const std::stop_token& stop,
                                                 std::map<int, Overlay>& overlays) {
  if (structure.slices.size() < 2) {
    return Error{core::ErrorCode::kContourTooShort,
                 structure.name + " has contours in fewer than two slices; a volume needs two"};
  }
  ContouredStructure result;
  result.report.name = structure.name;
  result.report.slices = structure.slices.size();
  double shift_sum = 0;
  for (const SliceContours& slice : structure.slices) {
    if (stop.stop_requested()) return GivenUp();
    const EdgeField field(images.at(slice.slice), structure.adaption.blur_px);
    Overlay& overlay = overlays[slice.slice];
    const auto follow = [&](const std::vector<std::vector<Vec2>>& polygons) {
      std::vector<std::vector<Vec2>> curves;
      for (const auto& polygon : polygons) {
        ContourFit fit = FitContourToEdges(field, polygon, {.adaption = structure.adaption});
        ContourStages stages;
        stages.structure = structure.name;
        stages.placed = polygon;
        stages.adapted = std::move(fit.adapted);
        stages.inserted = std::move(fit.inserted);
        stages.curve = std::move(fit.spline);
        stages.notes = fit.notes.size();
        for (std::size_t i = 0; i < polygon.size(); ++i) {
          const double shift = Norm(stages.adapted[i] - polygon[i]);
          shift_sum += shift;
          result.report.largest_shift_px = std::max(result.report.largest_shift_px, shift);
        }
        result.report.control_points += polygon.size();
        curves.push_back(stages.curve);
        overlay.contours.push_back(std::move(stages));
      }
      return curves;
    };
    const auto contours = follow(slice.contours), holes = follow(slice.holes);
    FilledSlice filled{points.slice_mm * slice.slice, FillArea(contours, holes)};
    if (filled.mask.Count() == 0) {
      return Error{core::ErrorCode::kContourEmpty,
                   structure.name + ", slice " + std::to_string(slice.slice) +
                       ": the contour encloses nothing; place it around the organ"};
    }
    overlay.areas.push_back(filled.mask);
    result.slices.push_back(std::move(filled));
    result.curves.push_back(holes.empty() ? contours : std::vector<std::vector<Vec2>>{});
  }
  result.report.mean_shift_px = shift_sum / static_cast<double>(result.report.control_points);
  return result;
}

}  // namespace

core::Result<std::map<int, ColorImage>> ReadContouredSlices(const ControlPoints& points,
                                                            const std::filesystem::path& folder,
                                                            const std::vector<int>& numbers,
                                                            std::optional<DisplayWindow> window,
                                                            const Progress& progress) {
  ImageSeriesOptions series_options;
  series_options.pixel_mm = points.pixel_mm;
  series_options.slice_mm = points.slice_mm;
  series_options.axes = points.axes;
  series_options.pattern = points.image_pattern;
  series_options.slices = numbers;
  const auto series = ImageSeries::Open(folder, series_options, progress);
  if (!series.ok()) return series.error();
  const ImageSeriesInfo& info = series->Info();
  if (info.width != points.width || info.height != points.height) {
    return Error{core::ErrorCode::kImageSizeDiffers,
                 "the images have " + std::to_string(info.width) + " x " + std::to_string(info.height) +
                     " pixels, but the control points were placed on " + std::to_string(points.width) +
                     " x " + std::to_string(points.height) + "; use the images that the points belong to"};
  }
  return ReadSlices(*series, numbers, window.value_or(info.suggested_window), progress);
}

core::Result<BuiltOrgans> BuildOrgans(const ControlPoints& points, const std::map<int, ColorImage>& images,
                                      const OrganOptions& options, const Progress& progress) {
  const auto tell = [&](std::string_view what, double part) {
    if (progress) progress(what, part);
  };
  if (!(options.spacing_mm >= 0.4 && options.spacing_mm <= 4.0) ||
      !(options.gap_mm >= 0.0 && options.gap_mm <= 5.0)) {
    return Error{core::ErrorCode::kUsage, "spacing_mm must lie between 0.4 and 4, gap_mm between 0 and 5"};
  }
  BuiltOrgans built;
  auto& overlays = built.overlays;
  std::vector<ScalarVolume> volumes;
  const auto count = static_cast<double>(points.structures.size());
  for (const Structure& structure : points.structures) {
    tell("following contours of " + structure.name, static_cast<double>(volumes.size()) / count);
    auto contoured = ExtractContours(points, structure, images, options.stop, overlays);
    if (!contoured.ok()) return contoured.error();
    auto dense = MakeDenseSlices(*contoured);
    for (FilledSlice& slice : dense) OpenMask(slice.mask, kThinnestMm / 2 / points.pixel_mm);
    const auto& clicked = contoured->slices;
    const auto half_way = [&](std::size_t a, std::size_t b) {
      return 0.5 * (clicked[b].position_mm - clicked[a].position_mm);
    };
    auto volume = MakeVolume(dense, points.pixel_mm, options.spacing_mm,
                             std::array{half_way(0, 1), half_way(clicked.size() - 2, clicked.size() - 1)});
    if (!volume.ok()) return Error{volume.error().code, structure.name + ": " + volume.error().message};
    volumes.push_back(std::move(*volume));
    built.organs.push_back(std::move(contoured->report));
  }
  for (const TubePoints& tube : points.tubes) {
    for (const TubePoint& point : tube.points) {
      const auto found = overlays.find(static_cast<int>(std::lround(point.slice)));
      if (found != overlays.end()) found->second.tube_points.push_back(point.pixel);
    }
  }
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    for (std::size_t k = i + 1; k < volumes.size(); ++k) Subtract(volumes[i], volumes[k], options.gap_mm);
  }

  for (std::size_t i = 0; i < volumes.size(); ++i) {
    const Structure& structure = points.structures[i];
    if (options.stop.stop_requested()) return GivenUp();
    tell("meshing " + structure.name, static_cast<double>(i) / count);
    MeshingSettings settings;
    settings.triangle_budget = structure.triangle_budget;
    auto meshed = MeshVolume(std::move(volumes[i]), settings);
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

void AddMeshQuality(OrganReport& report, const MeshQuality& quality) {
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

}  // namespace trocar::anatomy
