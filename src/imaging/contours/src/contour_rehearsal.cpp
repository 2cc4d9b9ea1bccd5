// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/contour_rehearsal.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

#include "edge_strip.h"
#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/contours/build_organs.h"
#include "trocar/contours/contour_spline.h"
#include "trocar/images/png_file.h"
#include "trocar/math/elementary.h"

namespace trocar::contours {

using math::Vec2;

namespace {

using base::Error;
using base::ErrorCode;

constexpr int kMostTries = 100;
constexpr int kFewestPoints = 4;     // on a slice's shorter outlines
constexpr double kSmallestMm = 7.0;  // outlines narrower than this are cut off by the chain anyway

bool IsLeftOut(const Structure& structure, int slice) {
  return slice >= structure.reference_left_out[0] && slice <= structure.reference_left_out[1];
}

/// The numbers of the slices that are contoured.
std::vector<int> PickSlices(const ControlPoints& series, const Structure& structure, int every, int phase) {
  std::set<int> slices;
  for (int slice = series.first_slice + phase; slice <= series.last_slice; slice += every) {
    if (!IsLeftOut(structure, slice)) {
      slices.insert(slice);
      continue;
    }
    for (const int beside : {structure.reference_left_out[0] - 1, structure.reference_left_out[1] + 1}) {
      if (beside >= series.first_slice && beside <= series.last_slice) slices.insert(beside);
    }
  }
  return {slices.begin(), slices.end()};
}

/// Mean distance to the reference of the points as clicked and as adapted.
void MeasurePoints(const images::LabelVolume& labels, const ControlPoints& points,
                   const std::array<double, 3>& step, std::size_t structure_index, const BuiltOrgans& built,
                   RehearsalRun& run) {
  const Structure& structure = points.structures[structure_index];
  double placed = 0, adapted = 0;
  for (const SliceContours& slice : structure.slices) {
    const auto outlines = TraceLabel(labels, points, step, structure.reference_label, slice.slice);
    const Overlay& overlay = built.overlays.at(slice.slice);
    for (const ContourStages& stages : overlay.contours) {
      if (stages.structure != structure.name) continue;
      for (const Vec2& p : stages.placed) placed += DistanceToOutlines(p, outlines);
      for (const Vec2& p : stages.adapted) adapted += DistanceToOutlines(p, outlines);
      run.points += stages.placed.size();
      run.inserted += stages.inserted.size();
      run.notes += stages.notes;
    }
  }
  run.slices = structure.slices.size();
  const double scale = points.pixel_mm / static_cast<double>(std::max<std::size_t>(1, run.points));
  run.error_placed_mm = placed * scale;
  run.error_adapted_mm = adapted * scale;
}

}  // namespace

std::vector<Vec2> SimulateClicks(const Outline& outline, int count, double noise_px,
                                 const ControlPoints& series, math::Random& random) {
  TROCAR_ASSERT(count >= 3 && outline.points.size() >= 3);
  constexpr double kFine = 0.25;  // distance of the places that can be clicked [pixels]
  const auto curve = ResampleClosed(outline.points, kFine, 100000).at;
  std::vector<Vec2> clicks;
  for (int attempt = 0; attempt < kMostTries; ++attempt) {
    clicks.clear();
    const double start = random.Uniform();
    for (int i = 0; i < count; ++i) {
      const double part = start + static_cast<double>(i) / count;
      const auto at =
          base::TruncateTo<std::size_t>((part - std::floor(part)) * static_cast<double>(curve.size()));
      const double angle = random.Uniform(0.0, 2.0 * M_PI);
      const Vec2 moved =
          curve[std::min(at, curve.size() - 1)] + noise_px * Vec2{math::Cos(angle), math::Sin(angle)};
      clicks.push_back(
          {std::clamp(moved.x, 0.0, series.width - 1.0), std::clamp(moved.y, 0.0, series.height - 1.0)});
    }
    if (!CrossesItself(clicks)) break;
  }
  return clicks;
}

Structure SimulateUser(const images::LabelVolume& labels, const ControlPoints& series,
                       const Structure& structure, const ClickSettings& settings, std::uint64_t seed) {
  Structure clicked = structure;
  clicked.slices.clear();
  clicked.adaption = EdgeAdaptionSettings{};
  clicked.adaption.max_shift_px = settings.reach_mm / series.pixel_mm;
  clicked.adaption.skipped_shift_px = settings.skipped_mm / series.pixel_mm;
  const auto step = FindLabelStep(labels, series);
  if (!step.ok()) return clicked;
  math::Random random(seed);
  const int phase = base::TruncateTo<int>(random.Uniform(0, settings.every));
  const double shortest_px = std::max(16 * settings.noise_mm, M_PI * kSmallestMm) / series.pixel_mm;
  for (const int slice : PickSlices(series, structure, settings.every, phase)) {
    SliceContours contours;
    contours.slice = slice;
    const int most = settings.points[0] +
                     base::TruncateTo<int>(random.Uniform(0, settings.points[1] - settings.points[0] + 1));
    double longest = 0;
    for (const Outline& outline : TraceLabel(labels, series, *step, structure.reference_label, slice)) {
      if (outline.length_px < shortest_px) continue;
      if (longest == 0) longest = outline.length_px;
      const int count = std::clamp(base::RoundTo<int>(most * outline.length_px / longest),
                                   std::min(most, kFewestPoints), most);
      auto clicks = SimulateClicks(outline, count, settings.noise_mm / series.pixel_mm, series, random);
      (outline.area_px > 0 ? contours.contours : contours.holes).push_back(std::move(clicks));
    }
    if (!contours.contours.empty()) clicked.slices.push_back(std::move(contours));
  }
  return clicked;
}

base::Result<std::vector<OrganRehearsal>> RehearseContours(const RehearsalOptions& options,
                                                           const images::Progress& progress) {
  const ClickSettings& clicks = options.clicks;
  if (clicks.every < 1 || clicks.points[0] < 3 || clicks.points[1] < clicks.points[0] || options.runs < 1 ||
      !(clicks.noise_mm >= 0 && clicks.noise_mm <= 50) || !(clicks.reach_mm >= 0 && clicks.reach_mm <= 50) ||
      !(clicks.skipped_mm >= 0 && clicks.skipped_mm <= 50)) {
    return Error{
        ErrorCode::kUsage,
        "a rehearsal needs every >= 1, 3 or more points, runs >= 1, noise and reaches from 0 to 50 mm"};
  }
  auto series = ReadControlPoints(options.control_points);
  if (!series.ok()) return series.error();
  const auto labels = images::ReadLabelVolume(options.reference);
  if (!labels.ok()) return labels.error();
  const auto step = FindLabelStep(*labels, *series);
  if (!step.ok()) return step.error();
  std::erase_if(series->structures, [&](const Structure& structure) {
    return structure.reference_label == 0 || (!options.organ.empty() && structure.name != options.organ);
  });
  series->tubes.clear();
  if (series->structures.empty()) {
    return Error{
        ErrorCode::kUsage,
        options.organ.empty()
            ? "no structure of the control points has a reference_label; give it one"
            : "there is no structure " + options.organ + " with a reference_label in the control points"};
  }

  OrganOptions organ_options;
  organ_options.reference = &*labels;
  if (clicks.skipped_mm > 0) {
    if (auto status = ReadSkippedFrom(*series, options.images, {}, organ_options); !status)
      return status.error();
  }
  std::vector<OrganRehearsal> organs;
  for (const Structure& structure : series->structures) organs.push_back({structure.name, {}});
  std::map<int, images::ColorImage> images;
  for (int run = 0; run < options.runs; ++run) {
    const auto report = [&](std::string_view what, double part) {
      if (progress) progress(what, (run + part) / options.runs);
    };
    const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(run);
    ControlPoints clicked = *series;
    std::set<int> missing;
    for (Structure& structure : clicked.structures) {
      structure = SimulateUser(*labels, *series, structure, clicks, seed);
      for (const SliceContours& slice : structure.slices) {
        if (!images.contains(slice.slice)) missing.insert(slice.slice);
      }
    }
    const std::vector<int> numbers(missing.begin(), missing.end());
    report("reading slices", 0.0);
    auto loaded = ReadContouredSlices(*series, options.images, numbers);
    if (!loaded.ok()) return loaded.error();
    images.merge(*loaded);

    for (std::size_t i = 0; i < organs.size(); ++i) organs[i].runs.push_back({.seed = seed});
    for (const bool is_adapted : {false, true}) {
      report(is_adapted ? "building from adapted points" : "building from clicked points",
             is_adapted ? 0.55 : 0.1);
      ControlPoints used = clicked;
      if (!is_adapted) {
        for (Structure& structure : used.structures) structure.adaption.max_shift_px = 0;
      }
      auto built = BuildOrgans(used, images, organ_options);
      if (!built.ok()) return built.error();
      for (std::size_t i = 0; i < organs.size(); ++i) {
        RehearsalRun& result = organs[i].runs.back();
        const double dice = built->organs[i].judgement->dice;
        (is_adapted ? result.dice_adapted : result.dice_placed) = dice;
        if (is_adapted) MeasurePoints(*labels, used, *step, i, *built, result);
      }
      if (!is_adapted || run > 0 || !options.overlays) continue;
      for (auto& [slice, overlay] : built->overlays) {
        for (const Structure& structure : used.structures) {
          for (Outline& outline : TraceLabel(*labels, used, *step, structure.reference_label, slice))
            overlay.reference.push_back(std::move(outline.points));
        }
        char name[32];
        std::snprintf(name, sizeof(name), "rehearsal-%04d.png", slice);
        if (auto status = images::WritePng(*options.overlays / name, DrawOverlay(images.at(slice), overlay));
            !status.ok())
          return status.error();
      }
    }
  }
  if (progress) progress("done", 1.0);
  return organs;
}

}  // namespace trocar::contours
