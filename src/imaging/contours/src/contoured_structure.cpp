// SPDX-License-Identifier: Apache-2.0
#include "contoured_structure.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "skipped_slices.h"
#include "trocar/base/to_integer.h"
#include "trocar/contours/contour_fill.h"
#include "trocar/contours/contour_fit.h"
#include "trocar/contours/contour_morph.h"
#include "trocar/contours/edge_field.h"

namespace trocar::contours {

using math::Vec2;

namespace {

using base::Error;

constexpr double kSliceStepMm = 1.0;  // slices are added down to this distance
constexpr double kLeastShift = 0.5;   // a smaller reach moves nothing [pixels]
constexpr double kNarrowestMm = 4.0;  // an end narrower than this on average is over

Error GivenUp() {
  return {base::ErrorCode::kCancelled, "the organs were given up"};
}

Vec2 FindCentre(const std::vector<Vec2>& curve) {
  Vec2 sum{};
  for (const Vec2& p : curve) sum = sum + p;
  return (1.0 / static_cast<double>(curve.size())) * sum;
}

/// The contours of two slices that belong together; empty unless each has its own nearest one.
std::vector<ContourMatch> MatchAll(const std::vector<std::vector<Vec2>>& a,
                                   const std::vector<std::vector<Vec2>>& b) {
  if (a.empty() || a.size() != b.size()) return {};
  std::vector<ContourMatch> matches;
  std::set<std::size_t> taken;
  for (const auto& curve : a) {
    const Vec2 centre = FindCentre(curve);
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < b.size(); ++i) {
      if (Norm(FindCentre(b[i]) - centre) < Norm(FindCentre(b[nearest]) - centre)) nearest = i;
    }
    if (!taken.insert(nearest).second) return {};
    matches.push_back(MatchContours(curve, b[nearest]));
  }
  return matches;
}

/// Fields of some slices, whose pictures are read where they are not at hand.
class SkippedFields {
 public:
  SkippedFields(const std::map<int, images::ColorImage>& images, const OrganOptions& options, double blur_px)
      : images_(images), options_(options), blur_px_(blur_px) {}

  base::Result<std::vector<EdgeField>> Make(const std::vector<int>& slices) const {
    std::vector<int> missing;
    for (const int slice : slices) {
      if (!images_.contains(slice)) missing.push_back(slice);
    }
    std::map<int, images::ColorImage> read;
    if (!missing.empty()) {
      std::vector<int> ascending = missing;
      std::sort(ascending.begin(), ascending.end());
      if (!options_.read_skipped) {
        return Error{
            base::ErrorCode::kUsage,
            "the picture of slice " + std::to_string(ascending.front()) +
                " is needed to follow edges in skipped slices; give it, or set skipped_shift_px to 0"};
      }
      auto pictures = options_.read_skipped(ascending);
      if (!pictures.ok()) return pictures.error();
      read = std::move(*pictures);
    }
    std::vector<EdgeField> fields;
    for (const int slice : slices) {
      const auto found = images_.find(slice);
      fields.emplace_back(found != images_.end() ? found->second : read.at(slice), blur_px_);
    }
    return fields;
  }

 private:
  const std::map<int, images::ColorImage>& images_;
  const OrganOptions& options_;
  double blur_px_;
};

}  // namespace

base::Result<ContouredStructure> FollowContours(const ControlPoints& points, const Structure& structure,
                                                const std::map<int, images::ColorImage>& images,
                                                const std::stop_token& stop,
                                                std::map<int, Overlay>& overlays) {
  if (structure.slices.size() < 2) {
    return Error{base::ErrorCode::kContourTooShort,
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
    meshing::FilledSlice filled{points.slice_mm * slice.slice, FillArea(contours, holes)};
    if (filled.mask.Count() == 0) {
      return Error{base::ErrorCode::kContourEmpty,
                   structure.name + ", slice " + std::to_string(slice.slice) +
                       ": the contour encloses nothing; place it around the organ"};
    }
    overlay.areas.push_back(filled.mask);
    result.slices.push_back(std::move(filled));
    result.curves.push_back(holes.empty() ? contours : std::vector<std::vector<Vec2>>{});
  }
  const auto half_way = [&](std::size_t a, std::size_t b) {
    return 0.5 * (result.slices[b].position_mm - result.slices[a].position_mm);
  };
  result.ends_mm = {half_way(0, 1), half_way(result.slices.size() - 2, result.slices.size() - 1)};
  result.report.mean_shift_px = shift_sum / static_cast<double>(result.report.control_points);
  return result;
}

base::Status AddSlicesByPictures(const ControlPoints& points, const Structure& structure,
                                 const std::map<int, images::ColorImage>& images, const OrganOptions& options,
                                 const images::Progress& progress, ContouredStructure& contoured) {
  const EdgeAdaptionSettings& adaption = structure.adaption;
  if (adaption.skipped_shift_px < kLeastShift || adaption.max_shift_px < kLeastShift) return {};
  const SkippedFields fields(images, options, adaption.blur_px);
  ContouredStructure dense{contoured.report, {}, {}, contoured.ends_mm};
  const auto add = [&](int slice, std::vector<std::vector<Vec2>> curves) {
    meshing::FilledSlice filled{points.slice_mm * slice, FillArea(curves, {})};
    if (filled.mask.Count() == 0) return;  // thinner than a pixel: left to the shape
    dense.slices.push_back(std::move(filled));
    dense.curves.push_back(std::move(curves));
    ++dense.report.followed_slices;
  };
  const auto pictured = [&](int from, int to) {
    std::vector<int> slices;
    for (int slice = std::max(from, points.first_slice); slice <= std::min(to, points.last_slice); ++slice) {
      if (options.series.empty() || std::binary_search(options.series.begin(), options.series.end(), slice))
        slices.push_back(slice);
    }
    return slices;
  };
  const auto number = [&](std::size_t s) { return structure.slices[s].slice; };
  const std::size_t last = structure.slices.size() - 1;

  // the slices beyond the first or last contoured one, outwards
  const auto follow_end = [&](std::size_t end, std::size_t neighbour) -> base::Status {
    if (contoured.curves[end].size() != 1) return {};
    const bool is_first = end == 0;
    const int gap = std::abs(number(neighbour) - number(end));
    std::vector<int> beyond = is_first ? pictured(number(end) - gap + 1, number(end))
                                       : pictured(number(end), number(end) + gap - 1);
    if (is_first) std::reverse(beyond.begin(), beyond.end());
    if (beyond.size() < 2) return {};
    const auto made = fields.Make(beyond);
    if (!made.ok()) return made.error();
    const FollowedEnd followed =
        FollowEnd(made->front(), contoured.curves[end][0], std::span(*made).subspan(1),
                  kNarrowestMm / points.pixel_mm, adaption);
    const std::size_t count = followed.contours.size();
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t k = is_first ? count - 1 - i : i;
      add(beyond[k + 1], {followed.contours[k]});
    }
    const double left = followed.is_ended ? 1.0 : static_cast<double>(beyond.size() - count);
    dense.ends_mm[is_first ? 0 : 1] = 0.5 * left * std::abs(beyond[1] - beyond[0]) * points.slice_mm;
    return {};
  };

  if (auto status = follow_end(0, 1); !status) return status;
  for (std::size_t s = 0; s <= last; ++s) {
    if (options.stop.stop_requested()) return GivenUp();
    if (progress)
      progress("following skipped slices of " + structure.name,
               static_cast<double>(s) / static_cast<double>(last + 1));
    dense.slices.push_back(std::move(contoured.slices[s]));
    dense.curves.push_back(contoured.curves[s]);
    if (s == last) break;
    const std::vector<int> between = pictured(number(s) + 1, number(s + 1) - 1);
    const auto matches = MatchAll(contoured.curves[s], contoured.curves[s + 1]);
    if (between.empty() || matches.empty()) continue;
    const auto made = fields.Make(between);
    if (!made.ok()) return made.error();
    std::vector<std::vector<std::vector<Vec2>>> curves(between.size());
    for (const ContourMatch& match : matches) {
      auto followed = FollowBetween(match, *made, adaption);
      for (std::size_t k = 0; k < between.size(); ++k) curves[k].push_back(std::move(followed[k]));
    }
    for (std::size_t k = 0; k < between.size(); ++k) add(between[k], std::move(curves[k]));
  }
  if (auto status = follow_end(last, last - 1); !status) return status;
  contoured = std::move(dense);
  return {};
}

std::vector<meshing::FilledSlice> AddSlicesByShape(const ContouredStructure& contoured) {
  std::vector<meshing::FilledSlice> dense = {contoured.slices.front()};
  for (std::size_t s = 0; s + 1 < contoured.slices.size(); ++s) {
    const meshing::FilledSlice &a = contoured.slices[s], &b = contoured.slices[s + 1];
    if (contoured.curves[s].size() != 1 || contoured.curves[s + 1].size() != 1) {
      const auto between = meshing::InsertSlices(std::vector<meshing::FilledSlice>{a, b}, kSliceStepMm);
      dense.insert(dense.end(), between.begin() + 1, between.end());
      continue;
    }
    const ContourMatch match = MatchContours(contoured.curves[s][0], contoured.curves[s + 1][0]);
    const int parts = base::CeilTo<int>((b.position_mm - a.position_mm) / kSliceStepMm - 1e-9);
    for (int part = 1; part < parts; ++part) {
      const double t = static_cast<double>(part) / parts;
      dense.push_back({a.position_mm + t * (b.position_mm - a.position_mm), FillArea({match.At(t)}, {})});
    }
    dense.push_back(b);
  }
  return dense;
}

}  // namespace trocar::contours
