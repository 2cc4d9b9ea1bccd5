// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/grow_contours.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/contours/contour_fill.h"
#include "trocar/contours/contour_spline.h"
#include "trocar/contours/reference_contours.h"
#include "trocar/math/vector.h"

namespace trocar::contours {

using math::Vec2;

namespace {

using base::Error;
using base::ErrorCode;
using roles::OrganRole;

constexpr double kCtCentre = 60, kCtWidth = 500;    // greys that tell soft tissue, fat and bone apart [HU]
constexpr double kCtLow = -300, kCtHigh = 300;      // a series that reaches beyond both is CT [HU]
constexpr double kTolerance = 0.8, kSmallest = 25;  // of a contour [mm], [mm^2]
constexpr int kMostPoints = 28, kFirstPoints = 6;   // of a contour
constexpr double kColourful = 6;                    // mean difference of the channels in photographs
constexpr double kMarginMm = 25;                    // of the box beyond the prior's longest extent
constexpr double kBesideLiver = 60;                 // a gallbladder lies this near [mm]

Error Refused(std::string why) {
  return {ErrorCode::kEditRefused, std::move(why)};
}

/// How finely an organ is looked at.
struct Sampling {
  double pixel_mm, slice_mm;  // of the voxels, about
  double contour_mm;          // from one contour to the next
};
Sampling FindSampling(OrganRole organ) {
  return organ == OrganRole::kLiver ? Sampling{1.5, 2.0, 6.0} : Sampling{0.8, 1.0, 4.0};
}

/// The voxels that are looked at: blocks of pixels of some slices, in a box about the click.
struct Box {
  int across = 1, along = 1;  // pixels and slices a voxel
  int column = 0, row = 0;    // of the first pixel
  int first = 0;              // index into the slices
  GreyVolume volume;
};

Box MakeBox(const GrowthRequest& request, const ShapePrior& prior, const Sampling& sampling) {
  const ControlPoints& points = request.points;
  Box box;
  const int step = request.slices.size() > 1 ? request.slices[1] - request.slices[0] : 1;
  const double slice_mm = points.slice_mm * step;
  box.across = std::max(1, base::TruncateTo<int>(sampling.pixel_mm / points.pixel_mm + 0.3));
  box.along = std::max(1, base::TruncateTo<int>(sampling.slice_mm / slice_mm + 0.3));
  box.volume.step_mm = {box.across * points.pixel_mm, box.across * points.pixel_mm, box.along * slice_mm};
  const auto fit = [](double centre, double half, int count, int block, int& begin) {
    begin = std::clamp(base::TruncateTo<int>(centre - half), 0, count - 1) / block * block;
    const int end = std::clamp(std::min(base::TruncateTo<int>(centre + half), count) + 1, begin + 1, count);
    return (end - begin + block - 1) / block;
  };
  // the directions of the picture are not those of the body: the longest extent holds for all
  const double half = std::max({prior.most_mm[0], prior.most_mm[1], prior.most_mm[2]}) + kMarginMm;
  const double at = static_cast<double>(
      std::lower_bound(request.slices.begin(), request.slices.end(), request.slice) - request.slices.begin());
  auto& size = box.volume.size;
  size[0] = fit(request.click.x, half / points.pixel_mm, points.width, box.across, box.column);
  size[1] = fit(request.click.y, half / points.pixel_mm, points.height, box.across, box.row);
  size[2] = fit(at, half / slice_mm, static_cast<int>(request.slices.size()), box.along, box.first);
  return box;
}

/// Adds a picture's greys to one layer of the volume.
/// \return mean difference of its colour channels
double AddPicture(const images::ColorImage& image, const Box& box, std::vector<float>& sum,
                  std::vector<float>& count) {
  double difference = 0;
  const int width = box.volume.size[0], height = box.volume.size[1];
  const int last_x = std::min(image.width, box.column + width * box.across);
  const int last_y = std::min(image.height, box.row + height * box.across);
  for (int y = box.row; y < last_y; ++y) {
    for (int x = box.column; x < last_x; ++x) {
      const std::uint8_t* p = image.At(x, y);
      difference += std::abs(p[0] - p[1]) + std::abs(p[1] - p[2]);
      const std::size_t at =
          static_cast<std::size_t>((y - box.row) / box.across) * width + (x - box.column) / box.across;
      sum[at] += (p[0] + p[1] + p[2]) / 3.0f;
      count[at] += 1;
    }
  }
  return difference / std::max(1, (last_x - box.column) * (last_y - box.row));
}

base::Status ReadGreys(const GrowthRequest& request, Box& box, const std::stop_token& stop,
                       const images::Progress& progress) {
  GreyVolume& volume = box.volume;
  const std::size_t plane = static_cast<std::size_t>(volume.size[0]) * volume.size[1];
  volume.values.resize(plane * volume.size[2]);
  for (int k = 0; k < volume.size[2]; ++k) {
    if (stop.stop_requested())
      return Error{ErrorCode::kCancelled, "growing was given up; nothing has changed"};
    if (progress) progress("reading slices", 0.4 * k / volume.size[2]);
    std::vector<float> sum(plane, 0.0f), count(plane, 0.0f);
    for (int i = 0; i < box.along; ++i) {
      const std::size_t at = static_cast<std::size_t>(box.first + k * box.along + i);
      if (at >= request.slices.size()) break;
      const auto picture = request.read(request.slices[at]);
      if (!picture) return picture.error();
      if (AddPicture(*picture, box, sum, count) > kColourful)
        return Refused(
            "an organ grows on grey pictures such as CT or MR; these are photographs, draw it by hand");
    }
    for (std::size_t i = 0; i < plane; ++i) volume.values[k * plane + i] = sum[i] / std::max(1.0f, count[i]);
  }
  return {};
}

/// Voxels that other structures' contours enclose: between two contoured slices, what both enclose.
std::vector<std::uint8_t> FindBlocked(const GrowthRequest& request, const Box& box) {
  const auto& size = box.volume.size;
  const std::size_t plane = static_cast<std::size_t>(size[0]) * size[1];
  std::vector<std::uint8_t> blocked;
  for (std::size_t s = 0; s < request.points.structures.size(); ++s) {
    if (static_cast<int>(s) == request.structure) continue;
    std::vector<std::pair<int, std::vector<std::uint8_t>>> areas;  // by slice
    for (const SliceContours& slice : request.points.structures[s].slices) {
      if (slice.contours.empty()) continue;
      std::vector<std::vector<Vec2>> curves, holes;
      for (const auto& polygon : slice.contours) curves.push_back(FitContour(polygon));
      for (const auto& polygon : slice.holes) holes.push_back(FitContour(polygon));
      const images::Mask mask = FillArea(curves, holes);
      std::vector<std::uint8_t> area(plane, 0);
      for (int j = 0; j < size[1]; ++j) {
        for (int i = 0; i < size[0]; ++i) {
          const int x = box.column + i * box.across + box.across / 2 - mask.x0;
          const int y = box.row + j * box.across + box.across / 2 - mask.y0;
          if (x >= 0 && y >= 0 && x < mask.width && y < mask.height)
            area[static_cast<std::size_t>(j) * size[0] + i] = mask.At(x, y);
        }
      }
      areas.emplace_back(slice.slice, std::move(area));
    }
    if (areas.empty()) continue;
    if (blocked.empty()) blocked.assign(plane * size[2], 0);
    for (int k = 0; k < size[2]; ++k) {
      const int number =
          request.slices[std::min<std::size_t>(box.first + k * box.along, request.slices.size() - 1)];
      const auto after =
          std::find_if(areas.begin(), areas.end(), [&](const auto& a) { return a.first >= number; });
      if (after == areas.end() || (after == areas.begin() && after->first != number)) continue;
      const auto before = after->first == number ? after : after - 1;
      for (std::size_t i = 0; i < plane; ++i) blocked[k * plane + i] |= before->second[i] & after->second[i];
    }
  }
  return blocked;
}

/// Column of the body's midline in a layer, in voxels: halfway between its sides.
std::optional<double> FindMidline(const GreyVolume& volume, int k) {
  constexpr float kAir = 8;            // [grey levels]
  constexpr double kLeastShare = 0.2;  // of a column's rows in the body
  int first = -1, last = -1;
  for (int i = 0; i < volume.size[0]; ++i) {
    int rows = 0;
    for (int j = 0; j < volume.size[1]; ++j) rows += volume.values[volume.Index(i, j, k)] > kAir;
    if (rows < kLeastShare * volume.size[1]) continue;
    if (first < 0) first = i;
    last = i;
  }
  if (first < 0) return std::nullopt;
  return 0.5 * (first + last);
}

/// Whether the organ lies where such an organ lies.
base::Status CheckPlace(const GrowthRequest& request, const Box& box, OrganRole organ,
                        const std::vector<std::uint8_t>& inside, int click_layer) {
  const GreyVolume& volume = box.volume;
  double x = 0, y = 0, count = 0;
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (inside[i] == 0) continue;
    x += static_cast<double>(i % volume.size[0]), ++count;
    y += static_cast<double>(i / volume.size[0] % volume.size[1]);
  }
  x /= count, y /= count;
  const std::string& columns = request.points.axes[0];
  if (organ == OrganRole::kLiver && request.is_hounsfield && (columns == "left" || columns == "right")) {
    const auto midline = FindMidline(volume, click_layer);
    if (midline && (columns == "left" ? x > *midline : x < *midline)) {
      return Refused(
          "what grew lies in the left half of the body, where the liver is not; click into the liver, or "
          "draw it by hand where organs are mirrored");
    }
  }
  if (organ != OrganRole::kGallbladder) return {};
  const double column = box.column + (x + 0.5) * box.across, row = box.row + (y + 0.5) * box.across;
  double nearest = 1e300;
  for (const Structure& other : request.points.structures) {
    if (roles::ConventionalRole<OrganRole>(other.name) != OrganRole::kLiver) continue;
    for (const SliceContours& slice : other.slices) {
      for (const auto& polygon : slice.contours) {
        for (const Vec2& p : polygon) {
          const double along = (slice.slice - request.slice) * request.points.slice_mm;
          const double pixel = request.points.pixel_mm;
          nearest =
              std::min(nearest, math::Norm(math::Vec3{pixel * (p.x - column), pixel * (p.y - row), along}));
        }
      }
    }
  }
  if (nearest < 1e299 && nearest > kBesideLiver) {
    return Refused(
        "what grew lies " + std::to_string(base::RoundTo<std::int64_t>(nearest)) +
        " mm from the liver's contours, and a gallbladder lies beside them; click into the gallbladder");
  }
  return {};
}

/// Contours around the region on every n-th slice.
std::vector<SliceContours> DrawAround(const GrowthRequest& request, const Box& box,
                                      const std::vector<std::uint8_t>& inside, double contour_mm) {
  const GreyVolume& volume = box.volume;
  const ControlPoints& points = request.points;
  const std::size_t plane = static_cast<std::size_t>(volume.size[0]) * volume.size[1];
  std::vector<int> layers;
  for (int k = 0; k < volume.size[2]; ++k) {
    const auto begin = inside.begin() + static_cast<std::ptrdiff_t>(k * plane);
    const auto voxels = std::count(begin, begin + static_cast<std::ptrdiff_t>(plane), 1);
    if (static_cast<double>(voxels) * volume.step_mm[0] * volume.step_mm[1] >= kSmallest) layers.push_back(k);
  }
  // whole numbers of layers, the last one always
  const auto every = base::TruncateTo<std::size_t>(std::max(1.0, std::round(contour_mm / volume.step_mm[2])));
  std::vector<SliceContours> drawn;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const bool is_last = i + 1 == layers.size();
    if (i % every != 0 && !is_last) continue;
    const int k = layers[i];
    // the middle of the slices that the layer was made of
    const std::size_t at =
        std::min<std::size_t>(box.first + k * box.along + (box.along - 1) / 2, request.slices.size() - 1);
    images::LabelVolume layer;
    layer.size = {volume.size[0], volume.size[1], 1};
    layer.labels.assign(inside.begin() + static_cast<std::ptrdiff_t>(k * plane),
                        inside.begin() + static_cast<std::ptrdiff_t>((k + 1) * plane));
    ControlPoints geometry;
    geometry.first_slice = geometry.last_slice = 0;
    geometry.pixel_mm = points.pixel_mm, geometry.slice_mm = 1.0;
    SliceContours contours;
    contours.slice = request.slices[at];
    for (const Outline& outline :
         TraceLabel(layer, geometry, {volume.step_mm[0], volume.step_mm[1], 1.0}, 1, 0)) {
      const bool is_small = std::fabs(outline.area_px) * points.pixel_mm * points.pixel_mm < kSmallest;
      if (is_small || outline.points.size() < 8) continue;
      std::vector<Vec2> few = ChooseFewPoints(outline.points, kTolerance / points.pixel_mm, kMostPoints);
      for (Vec2& p : few) {
        p = {std::clamp(p.x + box.column, 0.0, points.width - 1.0),
             std::clamp(p.y + box.row, 0.0, points.height - 1.0)};
      }
      (outline.area_px > 0 ? contours.contours : contours.holes).push_back(std::move(few));
    }
    if (!contours.contours.empty()) drawn.push_back(std::move(contours));
  }
  return drawn;
}

double DistanceToPolyline(const Vec2& p, const std::vector<Vec2>& line) {
  double nearest = 1e300;
  for (const Vec2& q : line) nearest = std::min(nearest, Dot(q - p, q - p));
  return std::sqrt(nearest);
}

}  // namespace

std::vector<Vec2> ChooseFewPoints(const std::vector<Vec2>& outline, double tolerance_px, int most) {
  TROCAR_ASSERT(outline.size() >= 4 && most >= 4);
  const std::size_t n = outline.size();
  std::vector<std::size_t> chosen;
  const int first = std::min({kFirstPoints, most, static_cast<int>(n)});
  for (int i = 0; i < first; ++i) chosen.push_back(i * n / first);
  while (true) {
    std::vector<Vec2> points;
    for (const std::size_t i : chosen) points.push_back(outline[i]);
    if (static_cast<int>(chosen.size()) >= most) return points;
    const std::vector<Vec2> curve = FitContour(points);
    double furthest = tolerance_px;
    std::size_t worst = n;
    for (std::size_t i = 0; i < n; ++i) {
      const double away = DistanceToPolyline(outline[i], curve);
      if (away > furthest && !std::binary_search(chosen.begin(), chosen.end(), i)) furthest = away, worst = i;
    }
    if (worst == n) return points;
    chosen.insert(std::lower_bound(chosen.begin(), chosen.end(), worst), worst);
  }
}

GrowthRequest MakeGrowthRequest(const images::ImageSeries& series, const ControlPoints& points, int structure,
                                int slice, const Vec2& click) {
  TROCAR_ASSERT(structure >= 0 && structure < static_cast<int>(points.structures.size()));
  GrowthRequest request{points, structure, slice, click, series.Info().slice_numbers, {}, false, {}, true};
  const images::ImageSeriesInfo& info = series.Info();
  request.is_hounsfield = !info.is_color && info.grey_range[0] < kCtLow && info.grey_range[1] > kCtHigh;
  request.window = request.is_hounsfield ? images::DisplayWindow{kCtCentre, kCtWidth} : info.suggested_window;
  request.read = [series, window = request.window](int number) { return series.ReadSlice(number, window); };
  return request;
}

bool CanGrow(std::string_view organ) {
  return FindShapePrior(roles::ConventionalRole<OrganRole>(organ)).has_value();
}

base::Result<GrownOrgan> GrowOrgan(const GrowthRequest& request, std::stop_token stop,
                                   const images::Progress& progress) {
  const Structure& structure = request.points.structures[request.structure];
  const OrganRole organ = roles::ConventionalRole<OrganRole>(structure.name);
  const auto prior = FindShapePrior(organ);
  if (!prior)
    return Refused("liver and gallbladder can grow from a click, " + structure.name + " is drawn by hand");
  const bool is_inside = request.click.x >= 0 && request.click.y >= 0 &&
                         request.click.x <= request.points.width - 1.0 &&
                         request.click.y <= request.points.height - 1.0;
  if (!is_inside || !std::binary_search(request.slices.begin(), request.slices.end(), request.slice))
    return Refused("the click lies outside of the pictures; point into the organ");

  const Sampling sampling = FindSampling(organ);
  Box box = MakeBox(request, *prior, sampling);
  if (auto status = ReadGreys(request, box, stop, progress); !status) return status.error();
  const auto blocked = FindBlocked(request, box);
  const int layer =
      static_cast<int>((std::lower_bound(request.slices.begin(), request.slices.end(), request.slice) -
                        request.slices.begin() - box.first) /
                       box.along);
  const std::array<int, 3> seed = {(base::RoundTo<int>(request.click.x) - box.column) / box.across,
                                   (base::RoundTo<int>(request.click.y) - box.row) / box.across, layer};
  GrowthSettings settings;
  settings.prior = *prior;
  settings.uses_prior = request.uses_prior;
  settings.stop = stop;
  if (request.is_hounsfield) {
    for (int i = 0; i < 2; ++i)
      settings.greys[i] = 255 * ((prior->hounsfield[i] - request.window.centre) / request.window.width + 0.5);
  }
  auto region = GrowRegion(box.volume, seed, settings, blocked, [&](std::string_view what, double part) {
    if (progress) progress(what, 0.4 + 0.5 * part);
  });
  if (!region) return region.error();
  if (auto status = CheckPlace(request, box, organ, region->inside, layer); !status) return status.error();
  if (progress) progress("drawing contours", 0.9);
  GrownOrgan grown;
  grown.structure = request.structure;
  grown.name = structure.name;
  grown.volume_ml = region->volume_ml;
  grown.slices = DrawAround(request, box, region->inside, sampling.contour_mm);
  for (const SliceContours& slice : grown.slices) {
    for (const auto& polygon : slice.contours) grown.points += polygon.size();
    for (const auto& polygon : slice.holes) grown.points += polygon.size();
  }
  if (grown.slices.size() < 2)
    return Refused("what grew shows on one slice only; the slices are too far apart for it, draw it by hand");
  if (progress) progress("done", 1.0);
  return grown;
}

base::Status ApplyGrowth(ContourDocument& document, const GrownOrgan& grown) {
  const auto& structures = document.Points().structures;
  if (grown.structure >= static_cast<int>(structures.size()) ||
      structures[grown.structure].name != grown.name)
    return Refused(grown.name + " has gone from the organs since it was clicked; click again");
  constexpr const char* kWhat = "grow the organ from a click";
  document.BeginGesture();
  base::Status status;
  for (const int slice : document.ContouredSlices(grown.structure)) {
    const bool stays = std::any_of(grown.slices.begin(), grown.slices.end(),
                                   [slice](const SliceContours& s) { return s.slice == slice; });
    if (!stays && status.ok()) status = document.SetContours(grown.structure, slice, {}, {}, kWhat);
  }
  // the points lie on the border already; the strongest edge nearby may be another one, the diaphragm's to fat
  EdgeAdaptionSettings adaption = structures[grown.structure].adaption;
  adaption.max_shift_px = adaption.skipped_shift_px = 0;
  if (status.ok()) status = document.SetAdaption(grown.structure, adaption);
  for (const SliceContours& slice : grown.slices) {
    if (status.ok())
      status = document.SetContours(grown.structure, slice.slice, slice.contours, slice.holes, kWhat);
  }
  if (!status.ok()) {
    document.CancelGesture();
    return status;
  }
  document.EndGesture();
  return {};
}

}  // namespace trocar::contours
