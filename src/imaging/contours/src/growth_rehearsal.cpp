// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/growth_rehearsal.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "contoured_structure.h"
#include "trocar/base/to_integer.h"
#include "trocar/contours/contour_fill.h"
#include "trocar/contours/contour_rehearsal.h"
#include "trocar/contours/contour_spline.h"
#include "trocar/contours/reference_contours.h"
#include "trocar/images/label_alignment.h"
#include "trocar/math/elementary.h"
#include "trocar/math/random.h"

namespace trocar::contours {

using math::Vec2;

namespace {

using base::Error;
using base::ErrorCode;
using roles::OrganRole;

constexpr int kDrawnPoints = 12;
constexpr double kShortestMm = 30;  // of an outline that a person would draw
constexpr double kEndMm = 6;        // an organ's end that is missed by more is drawn

/// Pixels that are set in contours, in a label, and in both.
struct Overlap {
  double drawn = 0, labelled = 0, both = 0;
  double Dice() const { return drawn + labelled > 0 ? 2 * both / (drawn + labelled) : 1; }
  double Wrong() const { return drawn + labelled - 2 * both; }
  void Add(const Overlap& other) { drawn += other.drawn, labelled += other.labelled, both += other.both; }
};

/// A label's voxels, slice after slice of a series.
class Labelled {
 public:
  Labelled(const ControlPoints& points, const images::LabelVolume& labels, int label,
           const std::vector<int>& slices)
      : points_(points), labels_(labels), label_(label), slices_(slices) {}

  const std::vector<int>& Slices() const { return slices_; }
  int Label() const { return label_; }
  const images::LabelVolume& Map() const { return labels_; }
  bool At(std::size_t k, int x, int y) const {
    return labels_.labels[(k * labels_.size[1] + y) * labels_.size[0] + x] == label_;
  }
  double Area(std::size_t k) const {
    const auto plane = static_cast<std::ptrdiff_t>(labels_.size[0]) * labels_.size[1];
    const auto begin = labels_.labels.begin() + static_cast<std::ptrdiff_t>(k) * plane;
    return static_cast<double>(std::count(begin, begin + plane, label_));
  }
  Overlap Compare(std::size_t k, const images::Mask* mask) const {
    Overlap overlap;
    overlap.labelled = Area(k);
    if (mask == nullptr) return overlap;
    for (int y = 0; y < mask->height; ++y) {
      for (int x = 0; x < mask->width; ++x) {
        if (mask->At(x, y) == 0) continue;
        const int column = mask->x0 + x, row = mask->y0 + y;
        const bool is_in = column >= 0 && row >= 0 && column < labels_.size[0] && row < labels_.size[1];
        overlap.drawn += 1;
        overlap.both += is_in && At(k, column, row) ? 1 : 0;
      }
    }
    return overlap;
  }
  std::vector<Outline> Trace(int slice) const {
    // the map has a voxel a pixel, and layers as far apart as the series' slices
    const double between =
        slices_.size() > 1 ? (slices_[1] - slices_[0]) * points_.slice_mm : points_.slice_mm;
    return TraceLabel(labels_, points_, {points_.pixel_mm, points_.pixel_mm, between}, label_, slice);
  }

 private:
  const ControlPoints& points_;
  const images::LabelVolume& labels_;
  int label_;
  const std::vector<int>& slices_;
};

images::Mask Fill(const SliceContours& slice) {
  std::vector<std::vector<Vec2>> curves, holes;
  for (const auto& polygon : slice.contours) curves.push_back(FitContour(polygon));
  for (const auto& polygon : slice.holes) holes.push_back(FitContour(polygon));
  return FillArea(curves, holes);
}

/// All slices, those between contours by shape.
Overlap CompareAll(const ControlPoints& points, const Structure& structure, const Labelled& labelled) {
  ContouredStructure contoured;
  for (const SliceContours& slice : structure.slices) {
    if (slice.contours.empty()) continue;
    contoured.slices.push_back({slice.slice * points.slice_mm, Fill(slice)});
    auto& curves = contoured.curves.emplace_back();
    if (slice.holes.empty()) {
      for (const auto& polygon : slice.contours) curves.push_back(FitContour(polygon));
    }
  }
  std::vector<meshing::FilledSlice> dense;
  if (!contoured.slices.empty()) dense = AddSlicesByShape(contoured);
  Overlap sum;
  for (std::size_t k = 0; k < labelled.Slices().size(); ++k) {
    const double position = labelled.Slices()[k] * points.slice_mm;
    const images::Mask* mask = nullptr;
    double nearest = 0.51;  // slices lie a millimetre apart or closer
    for (const meshing::FilledSlice& slice : dense) {
      const double away = std::fabs(slice.position_mm - position);
      if (away <= nearest) nearest = away, mask = &slice.mask;
    }
    sum.Add(labelled.Compare(k, mask));
  }
  return sum;
}

Vec2 Missed(const Vec2& place, double miss_px, math::Random& random) {
  const double angle = random.Uniform(0, 2 * M_PI);
  return place + miss_px * Vec2{math::Cos(angle), math::Sin(angle)};
}

Vec2 NearestOn(const std::vector<Outline>& outlines, const Vec2& p) {
  Vec2 nearest = p;
  double least = 1e300;
  for (const Outline& outline : outlines) {
    for (const Vec2& q : outline.points) {
      if (const double away = Norm(q - p); away < least) least = away, nearest = q;
    }
  }
  return nearest;
}

/// One organ under the hands of the user.
class Rehearsal {
 public:
  Rehearsal(ContourWorkspace& workspace, const Labelled& labelled, int structure, const GrowingUser& user,
            math::Random& random)
      : workspace_(workspace), labelled_(labelled), structure_(structure), user_(user), random_(random) {}

  base::Result<GrowthTrial> Run(const std::stop_token& stop, const images::Progress& progress) {
    GrowthTrial trial;
    trial.organ = Mine().name;
    std::optional<GrownOrgan> grown;
    while (!grown && trial.clicks < user_.clicks) {
      const auto [slice, click] = Click();
      GrowthRequest request = workspace_.MakeGrowthRequest(structure_, slice, click);
      request.uses_prior = user_.uses_prior;
      ++trial.clicks;
      const auto begun = std::chrono::steady_clock::now();
      auto result = GrowOrgan(request, stop, progress);
      trial.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
      if (result.ok()) {
        grown = std::move(*result);
      } else if (result.error().code == ErrorCode::kEditRefused) {
        trial.refusal = result.error().message;
      } else {
        return result.error();
      }
    }
    if (!grown) return trial;
    trial.refusal.clear();
    if (auto status = ApplyGrowth(workspace_.Document(), *grown); !status) return status.error();
    trial.dice_grown = CompareAll(Points(), Mine(), labelled_).Dice();
    if (auto status = Correct(trial); !status) return status.error();
    trial.dice_corrected = CompareAll(Points(), Mine(), labelled_).Dice();
    Overlap contours;
    for (const SliceContours& slice : Mine().slices) {
      const images::Mask mask = Fill(slice);
      contours.Add(labelled_.Compare(IndexOf(slice.slice), &mask));
      trial.slices += 1;
      for (const auto& polygon : slice.contours) trial.points += polygon.size();
    }
    trial.dice_contours = contours.Dice();
    return trial;
  }

 private:
  const ControlPoints& Points() const { return workspace_.Document().Points(); }
  const Structure& Mine() const { return Points().structures[structure_]; }
  std::size_t IndexOf(int slice) const {
    const auto& slices = labelled_.Slices();
    return static_cast<std::size_t>(std::lower_bound(slices.begin(), slices.end(), slice) - slices.begin());
  }

  /// A place well inside the organ, on a slice that shows much of it.
  std::pair<int, Vec2> Click() {
    const auto& slices = labelled_.Slices();
    std::vector<double> areas;
    for (std::size_t k = 0; k < slices.size(); ++k) areas.push_back(labelled_.Area(k));
    const double most = *std::max_element(areas.begin(), areas.end());
    std::vector<std::size_t> large;
    for (std::size_t k = 0; k < slices.size(); ++k) {
      if (areas[k] >= 0.5 * most) large.push_back(k);
    }
    const std::size_t k =
        large[base::TruncateTo<std::size_t>(random_.Uniform() * static_cast<double>(large.size()))];
    const int width = labelled_.Map().size[0], height = labelled_.Map().size[1];
    std::vector<std::uint8_t> area;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) area.push_back(labelled_.At(k, x, y));
    }
    const auto depth = meshing::CalcSignedDistances(area, width, height);
    const double deepest = *std::max_element(depth.begin(), depth.end());
    std::vector<Vec2> places;
    for (std::size_t i = 0; i < depth.size(); ++i) {
      if (depth[i] >= 0.5 * deepest)
        places.push_back({static_cast<double>(i % width), static_cast<double>(i / width)});
    }
    return {slices[k],
            places[base::TruncateTo<std::size_t>(random_.Uniform() * static_cast<double>(places.size()))]};
  }

  base::Status Correct(GrowthTrial& trial) {
    if (auto status = DrawEnds(trial); !status) return status;
    // the slice that is most wrong comes first
    std::vector<std::pair<double, int>> order;
    for (const SliceContours& slice : Mine().slices) {
      const images::Mask mask = Fill(slice);
      order.emplace_back(-labelled_.Compare(IndexOf(slice.slice), &mask).Wrong(), slice.slice);
    }
    std::sort(order.begin(), order.end());
    for (const auto& [wrong, slice] : order) {
      if (auto status = CorrectSlice(slice, trial); !status) return status;
    }
    return {};
  }

  base::Status CorrectSlice(int number, GrowthTrial& trial) {
    const SliceContours slice = workspace_.Document().At(structure_, number);
    const auto outlines = labelled_.Trace(number);
    const images::Mask mask = Fill(slice);
    const bool is_poor = labelled_.Compare(IndexOf(number), &mask).Dice() < user_.poor;
    if (is_poor && trial.drawn < user_.draws) return Draw(number, outlines, trial);
    if (outlines.empty()) return {};
    const double wrong_px = user_.wrong_mm / Points().pixel_mm, miss_px = user_.miss_mm / Points().pixel_mm;
    SliceContours better = slice;
    for (auto* polygons : {&better.contours, &better.holes}) {
      for (auto& polygon : *polygons) {
        for (Vec2& p : polygon) {
          const Vec2 right = NearestOn(outlines, p);
          if (Norm(right - p) <= wrong_px || trial.dragged >= user_.drags) continue;
          p = Missed(right, miss_px, random_);
          ++trial.dragged;
        }
      }
    }
    return workspace_.Document().SetContours(structure_, number, better.contours, better.holes, "correct");
  }

  /// The slice's contours anew, or none where the organ does not show.
  base::Status Draw(int number, const std::vector<Outline>& outlines, GrowthTrial& trial) {
    SliceContours drawn;
    for (const Outline& outline : outlines) {
      if (outline.length_px * Points().pixel_mm < kShortestMm) continue;
      (outline.area_px > 0 ? drawn.contours : drawn.holes)
          .push_back(
              SimulateClicks(outline, kDrawnPoints, user_.miss_mm / Points().pixel_mm, Points(), random_));
    }
    ++trial.drawn;
    return workspace_.Document().SetContours(structure_, number, drawn.contours, drawn.holes, "correct");
  }

  /// Contours where the organ begins and ends, if what grew ends well before.
  base::Status DrawEnds(GrowthTrial& trial) {
    const auto& slices = labelled_.Slices();
    std::vector<int> shown;
    for (const int slice : slices) {
      const auto outlines = labelled_.Trace(slice);
      if (!outlines.empty() && outlines.front().length_px * Points().pixel_mm >= kShortestMm)
        shown.push_back(slice);
    }
    const auto contoured = workspace_.Document().ContouredSlices(structure_);
    if (shown.empty() || contoured.empty()) return {};
    const double reach = kEndMm / Points().slice_mm;
    for (const auto& [missed, end] : {std::pair{contoured.front() - shown.front(), shown.front()},
                                      std::pair{shown.back() - contoured.back(), shown.back()}}) {
      if (missed <= reach || trial.drawn >= user_.draws) continue;
      if (auto status = Draw(end, labelled_.Trace(end), trial); !status) return status;
    }
    return {};
  }

  ContourWorkspace& workspace_;
  const Labelled& labelled_;
  int structure_;
  const GrowingUser& user_;
  math::Random& random_;
};

/// Value of an organ's voxels: its name's, else the conventional one.
int FindLabel(const images::LabelVolume& labels, OrganRole organ) {
  for (const auto& [name, label] : labels.names) {
    if (name == NameOf(organ)) return label;
  }
  return organ == OrganRole::kLiver ? 1 : 2;
}

}  // namespace

double CalcFilledDice(const ControlPoints& points, const Structure& structure,
                      const images::LabelVolume& labels, int label) {
  std::vector<int> slices;
  for (int k = 0; k < labels.size[2]; ++k) slices.push_back(points.first_slice + k);
  return CompareAll(points, structure, Labelled(points, labels, label, slices)).Dice();
}

base::Result<std::vector<GrowthTrial>> RehearseGrowth(ContourWorkspace& workspace,
                                                      const images::LabelVolume& reference,
                                                      const GrowingUser& user, std::uint64_t seed,
                                                      std::stop_token stop,
                                                      const images::Progress& progress) {
  const auto labels = images::AlignLabels(reference, workspace.Series());
  if (!labels) return labels.error();
  math::Random random(seed);
  std::vector<GrowthTrial> trials;
  for (const OrganRole organ : {OrganRole::kLiver, OrganRole::kGallbladder}) {
    const auto& structures = workspace.Document().Points().structures;
    const auto structure = std::find_if(structures.begin(), structures.end(), [organ](const Structure& s) {
      return roles::ConventionalRole<OrganRole>(s.name) == organ;
    });
    const int label = FindLabel(reference, organ);
    const bool is_there =
        std::find(labels->labels.begin(), labels->labels.end(), label) != labels->labels.end();
    if (structure == structures.end() || !is_there) {
      return Error{ErrorCode::kLabelsMismatch, std::string("the reference or the contours have no ") +
                                                   NameOf(organ) +
                                                   "; name a label map with liver and gallbladder"};
    }
    const Labelled labelled(workspace.Document().Points(), *labels, label, workspace.Slices());
    auto trial =
        Rehearsal(workspace, labelled, static_cast<int>(structure - structures.begin()), user, random)
            .Run(stop, progress);
    if (!trial) return trial.error();
    trials.push_back(std::move(*trial));
  }
  return trials;
}

}  // namespace trocar::contours
