// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/contour_fit.h"

#include <algorithm>
#include <cmath>

#include "edge_path.h"
#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"

namespace trocar::contours {

using math::Vec2;

namespace {

constexpr double kLeastShift = 0.5;  // a smaller reach moves nothing [pixels]
constexpr int kMaxRounds = 6;        // of insertion
constexpr std::size_t kClosest = 3;  // rows between two points at least

double DistanceToCurve(const Vec2& p, const ContourCurve& curve, std::size_t first, std::size_t last) {
  double nearest = 1e300;
  for (std::size_t i = first; i < last; ++i) nearest = std::min(nearest, Norm(curve.points[i] - p));
  if (last < curve.points.size() || first > 0)
    nearest = std::min(nearest, Norm(curve.points[last % curve.points.size()] - p));
  return nearest;
}

struct Control {
  Vec2 at;
  std::size_t row;
  bool is_inserted;
};

/// Divides the spline through the controls by points on the edge until it follows the edge.
ContourCurve InsertPoints(const EdgePath& edge, const ContourFitSettings& settings,
                          std::vector<Control>& controls) {
  const std::size_t rows = edge.at.size();
  for (int round = 0;; ++round) {
    std::vector<Vec2> points;
    for (const Control& c : controls) points.push_back(c.at);
    ContourCurve curve = FitContourCurve(points, settings.spline);
    if (!settings.is_inserting || round == kMaxRounds) return curve;
    std::vector<Control> denser;
    for (std::size_t i = 0; i < controls.size(); ++i) {
      denser.push_back(controls[i]);
      const std::size_t first_row = controls[i].row, last_row = controls[(i + 1) % controls.size()].row;
      const std::size_t between = (last_row + rows - first_row) % rows;
      const auto [begin, end] = std::equal_range(curve.segment.begin(), curve.segment.end(), i);
      const auto first = static_cast<std::size_t>(begin - curve.segment.begin());
      const auto last = static_cast<std::size_t>(end - curve.segment.begin());
      double furthest = settings.tolerance_px;
      std::size_t worst = 0;
      for (std::size_t r = kClosest; r + kClosest <= between; ++r) {
        const std::size_t row = (first_row + r) % rows;
        if (!edge.is_edge[row]) continue;
        const double away = DistanceToCurve(edge.at[row], curve, first, last);
        if (away > furthest) furthest = away, worst = r;
      }
      if (worst == 0) continue;
      const std::size_t row = (first_row + worst) % rows;
      denser.push_back({edge.at[row], row, true});
    }
    if (denser.size() == controls.size()) return curve;
    controls = std::move(denser);
  }
}

/// The row of each control point of a closed curve that was resampled in equal steps: in the points' order, as
/// the nearest row would not always be where clicks overtake each other.
std::vector<std::size_t> FindRows(const ContourCurve& curve, std::size_t count, std::size_t rows) {
  std::vector<double> passed = {0.0};
  for (std::size_t i = 0; i < curve.points.size(); ++i)
    passed.push_back(passed.back() + Norm(curve.points[(i + 1) % curve.points.size()] - curve.points[i]));
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < count; ++i) {
    const auto sample =
        std::lower_bound(curve.segment.begin(), curve.segment.end(), i) - curve.segment.begin();
    const double part = passed[static_cast<std::size_t>(sample)] / passed.back();
    found.push_back(base::RoundTo<std::size_t>(part * static_cast<double>(rows)) % rows);
  }
  return found;
}

}  // namespace

std::string_view FitProblemText(FitProblem problem) {
  switch (problem) {
    case FitProblem::kNoEdge:
      return "no edge within reach";
    case FitProblem::kTooIrregular:
      return "too irregular";
    case FitProblem::kCrossesItself:
      return "crosses itself";
  }
  return {};
}

ContourFit FitContourToEdges(const images::ColorImage& image, std::span<const Vec2> clicked,
                             const ContourFitSettings& settings) {
  return FitContourToEdges(EdgeField(image, settings.adaption.blur_px), clicked, settings);
}

ContourFit FitContourToEdges(const EdgeField& field, std::span<const Vec2> clicked,
                             const ContourFitSettings& settings) {
  TROCAR_ASSERT(clicked.size() >= 3);
  ContourFit fit;
  if (CrossesItself(clicked)) {
    fit.notes.push_back({FitProblem::kCrossesItself, clicked[0], 0.0});
  }
  if (settings.adaption.max_shift_px < kLeastShift || !fit.notes.empty()) {
    fit.adapted.assign(clicked.begin(), clicked.end());
    fit.spline = FitContour(clicked, settings.spline);
    return fit;
  }
  if (!settings.adaption.inserts_points) {
    fit.adapted = AdaptToEdges(field, clicked, settings.adaption);
    fit.spline = FitContour(fit.adapted, settings.spline);
    return fit;
  }
  const double max_shift = settings.adaption.max_shift_px;
  const ContourCurve clicked_curve = FitContourCurve(clicked, settings.spline);
  const EdgePath edge =
      FindEdgePath(field, ResampleClosed(clicked_curve.points, kEdgeRowStep), settings.adaption);
  const auto point_rows = FindRows(clicked_curve, clicked.size(), edge.at.size());
  std::vector<Control> controls;
  for (std::size_t i = 0; i < clicked.size(); ++i) {
    const Vec2& p = clicked[i];
    const std::size_t row = point_rows[i];
    // the row lies beside the point by up to half a row, which counts against its reach
    const Vec2 shift = edge.is_edge[row] ? edge.at[row] - p : Vec2{};
    const double length = Norm(shift);
    controls.push_back({p + (length > max_shift ? max_shift / length : 1.0) * shift, row, false});
    fit.adapted.push_back(controls.back().at);
  }
  ContourCurve curve = InsertPoints(edge, settings, controls);
  const std::size_t rows = edge.at.size();
  fit.spline = std::move(curve.points);
  for (const Control& c : controls) {
    if (c.is_inserted) fit.inserted.push_back(c.at);
  }
  // runs of rows without an edge
  std::size_t begin = 0;
  while (begin < rows && !edge.is_edge[begin]) ++begin;
  if (begin == rows) {
    fit.notes.push_back({FitProblem::kNoEdge, edge.at[0], kEdgeRowStep * static_cast<double>(rows)});
    return fit;
  }
  for (std::size_t i = 0, run = 0; i <= rows; ++i) {
    const std::size_t row = (begin + i) % rows;
    if (i < rows && !edge.is_edge[row]) {
      ++run;
      continue;
    }
    if (run >= 4) {
      fit.notes.push_back({FitProblem::kNoEdge, edge.at[(row + rows - run / 2 - 1) % rows],
                           kEdgeRowStep * static_cast<double>(run)});
    }
    run = 0;
  }
  for (const std::size_t i : curve.divided) {
    fit.notes.push_back({FitProblem::kTooIrregular, controls[i].at, 0.0});
  }
  return fit;
}

}  // namespace trocar::contours
