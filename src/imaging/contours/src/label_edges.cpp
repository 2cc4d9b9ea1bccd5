// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/label_edges.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "edge_path.h"
#include "trocar/contours/build_organs.h"
#include "trocar/contours/contour_spline.h"
#include "trocar/contours/control_points.h"
#include "trocar/contours/reference_contours.h"

namespace trocar::contours {

using math::Vec2;

namespace {

constexpr double kShortestMm = 48.0;  // outlines below are too small for a band this wide
constexpr int kRounds = 6;            // of least squares, until the shift stands still
constexpr double kDrawnStepPx = 4.0;  // of the drawn contours' places

/// The edge beside one place of a label's outline.
struct Place {
  std::size_t structure;
  double offset_px;  // of the edge, > 0 outside
  Vec2 normal;
  bool is_seen;
};

/// Everything that stays the same while the labels are shifted.
struct Scene {
  const ControlPoints& series;
  const images::LabelVolume& labels;
  std::array<double, 3> step;
  std::map<int, EdgeField> fields;
  double reach_px;

  bool IsUsed(const Structure& structure, int slice) const {
    return structure.reference_label > 0 &&
           (slice < structure.reference_left_out[0] || slice > structure.reference_left_out[1]);
  }
  std::vector<Outline> Trace(const Structure& structure, int slice, const Vec2& shift, int slices) const {
    auto outlines = TraceLabel(labels, series, step, structure.reference_label, slice - slices);
    for (Outline& outline : outlines)
      for (Vec2& p : outline.points) p = p + shift;
    return outlines;
  }
};

std::vector<Place> FindPlaces(const Scene& scene, const Vec2& shift, int slices) {
  std::vector<Place> places;
  for (std::size_t i = 0; i < scene.series.structures.size(); ++i) {
    const Structure& structure = scene.series.structures[i];
    for (const auto& [slice, field] : scene.fields) {
      if (!scene.IsUsed(structure, slice)) continue;
      for (const Outline& outline : scene.Trace(structure, slice, shift, slices)) {
        if (outline.length_px * scene.series.pixel_mm < kShortestMm) continue;
        const EdgePath edge = FollowEdge(field, ResampleClosed(outline.points, kEdgeRowStep),
                                         {.reach_px = scene.reach_px}, EdgeAdaptionSettings{});
        for (std::size_t row = 0; row < edge.at.size(); ++row) {
          const Vec2& normal = edge.curve.normal[row];
          places.push_back(
              {i, Dot(edge.at[row] - edge.curve.at[row], normal), normal, edge.is_edge[row] != 0});
        }
      }
    }
  }
  return places;
}

/// The shift d that makes the sum of (offset - normal d)^2 least.
Vec2 SolveShift(const std::vector<Place>& places) {
  double xx = 1e-9, xy = 0, yy = 1e-9, bx = 0, by = 0;
  for (const Place& p : places) {
    if (!p.is_seen) continue;
    xx += p.normal.x * p.normal.x, xy += p.normal.x * p.normal.y, yy += p.normal.y * p.normal.y;
    bx += p.offset_px * p.normal.x, by += p.offset_px * p.normal.y;
  }
  const double det = xx * yy - xy * xy;
  return {(yy * bx - xy * by) / det, (xx * by - xy * bx) / det};
}

double CalcMeanDistance(const std::vector<Place>& places) {
  double sum = 0, seen = 0;
  for (const Place& p : places) {
    if (p.is_seen) sum += std::fabs(p.offset_px), ++seen;
  }
  return seen > 0 ? sum / seen : 0.0;
}

/// Mean distance of the drawn contours from the shifted label [mm].
double MeasureDrawn(const Scene& scene, const Structure& structure, const Vec2& shift, int slices) {
  double sum = 0, count = 0;
  for (const SliceContours& slice : structure.slices) {
    if (!scene.IsUsed(structure, slice.slice)) continue;
    const auto outlines = scene.Trace(structure, slice.slice, shift, slices);
    if (outlines.empty()) continue;
    for (const auto& contour : slice.contours) {
      for (const Vec2& p : ResampleClosed(FitContour(contour), kDrawnStepPx).at)
        sum += DistanceToOutlines(p, outlines), ++count;
    }
  }
  return count > 0 ? sum / count * scene.series.pixel_mm : 0.0;
}

std::vector<LabelEdgeReport> Report(const Scene& scene, const std::vector<Place>& places, const Vec2& shift,
                                    int slices) {
  std::vector<LabelEdgeReport> reports;
  for (std::size_t i = 0; i < scene.series.structures.size(); ++i) {
    const Structure& structure = scene.series.structures[i];
    if (structure.reference_label == 0) continue;
    LabelEdgeReport report{.name = structure.name};
    std::vector<double> distances;
    for (const Place& p : places) {
      if (p.structure != i) continue;
      ++report.places;
      if (!p.is_seen) continue;
      distances.push_back(std::fabs(p.offset_px) * scene.series.pixel_mm);
      report.signed_mean_mm += p.offset_px * scene.series.pixel_mm;
    }
    if (!distances.empty()) {
      std::sort(distances.begin(), distances.end());
      const auto count = static_cast<double>(distances.size());
      report.seen = count / static_cast<double>(report.places);
      report.signed_mean_mm /= count;
      for (const double d : distances) report.mean_mm += d / count, report.within_1mm += d <= 1.0;
      report.within_1mm /= count;
      report.median_mm = distances[distances.size() / 2];
    }
    report.drawn_mm = MeasureDrawn(scene, structure, shift, slices);
    reports.push_back(std::move(report));
  }
  return reports;
}

}  // namespace

base::Result<LabelEdges> MeasureLabelEdges(const LabelEdgeOptions& options,
                                           const images::Progress& progress) {
  if (options.every < 1 || options.every > 1000 || !(options.reach_mm >= 1 && options.reach_mm <= 30) ||
      options.most_slices < 0 || options.most_slices > 20) {
    return base::Error{base::ErrorCode::kUsage,
                       "every must lie between 1 and 1000, the reach between 1 and 30 mm, the shift along "
                       "the stack between 0 and 20 slices"};
  }
  const auto series = ReadControlPoints(options.control_points);
  if (!series.ok()) return series.error();
  const auto labels = images::ReadLabelVolume(options.reference);
  if (!labels.ok()) return labels.error();
  const auto step = FindLabelStep(*labels, *series);
  if (!step.ok()) return step.error();
  Scene scene{*series, *labels, *step, {}, options.reach_mm / series->pixel_mm};
  std::set<int> numbers;
  for (const Structure& structure : series->structures) {
    for (int slice = series->first_slice; slice <= series->last_slice; slice += options.every) {
      if (scene.IsUsed(structure, slice) && !scene.Trace(structure, slice, {}, 0).empty())
        numbers.insert(slice);
    }
  }
  if (numbers.empty()) {
    return base::Error{base::ErrorCode::kUsage,
                       "no structure of the control points has a reference_label that occurs in the labels"};
  }
  const auto images =
      ReadContouredSlices(*series, options.images, {numbers.begin(), numbers.end()}, {}, progress);
  if (!images.ok()) return images.error();
  for (const auto& [slice, image] : *images)
    scene.fields.emplace(slice, EdgeField(image, EdgeAdaptionSettings{}.blur_px));

  LabelEdges result;
  std::vector<Place> best = FindPlaces(scene, {}, 0);
  result.as_given = Report(scene, best, {}, 0);
  Vec2 best_shift{};
  int best_slices = 0;
  const int most = options.most_slices;
  for (int slices = -most; slices <= most; ++slices) {
    if (progress) progress("shifting the labels", static_cast<double>(slices + most) / (2 * most + 1));
    Vec2 shift{};
    auto places = FindPlaces(scene, shift, slices);
    for (int round = 0; round < kRounds; ++round) {
      shift = shift + SolveShift(places);
      places = FindPlaces(scene, shift, slices);
    }
    if (CalcMeanDistance(places) >= CalcMeanDistance(best)) continue;
    best = std::move(places), best_shift = shift, best_slices = slices;
  }
  result.shifted = Report(scene, best, best_shift, best_slices);
  result.shift_mm = {best_shift.x * series->pixel_mm, best_shift.y * series->pixel_mm,
                     best_slices * series->slice_mm};
  if (progress) progress("done", 1.0);
  return result;
}

}  // namespace trocar::contours
