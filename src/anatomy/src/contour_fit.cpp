// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/contour_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "edge_cost.h"
#include "edge_strip.h"
#include "trocar/core/assert.h"

namespace trocar::anatomy {
namespace {

constexpr double kRowStep = 2.0;     // distance of the rows of the band [pixels]
constexpr double kColumnStep = 0.5;  // of its columns [pixels]
constexpr double kBand = 6.0;        // beyond the reach, where the colours of the inside are learned [pixels]
constexpr double kRegion =
    0.1;  // weight of the colours on either side, a pixel, against the strongest edge [-]
constexpr double kSlightest = 0.05;  // rises below this count in full nowhere [1 / pixel]
constexpr int kClimb = 6;            // columns from where the inside ends to the steepest place
constexpr int kMaxJump = 2;          // columns between neighbouring rows
constexpr int kMaxRounds = 6;        // of insertion
constexpr std::size_t kClosest = 3;  // rows between two points at least

/// A contour's edge: one place a row of the band.
struct EdgePath {
  ClosedCurve curve;
  std::vector<Vec2> at;               // (rows)
  std::vector<std::uint8_t> is_edge;  // (rows) a clear edge is there
};

EdgePath FindEdge(const EdgeField& field, std::span<const Vec2> polyline, double max_shift,
                  const EdgeAdaptionSettings& settings) {
  EdgePath edge;
  edge.curve = ResampleClosed(polyline, kRowStep);
  const EdgeStrip strip = SampleStrip(field, edge.curve, max_shift + kBand, kColumnStep);
  const EdgeEvidence evidence = CalcEdgeEvidence(strip, max_shift, kRowStep);
  const int reach = evidence.reach, columns = evidence.Columns();
  const auto& gradient = evidence.gradient;
  std::vector<float> cost(gradient.size());
  const auto least = static_cast<float>(settings.min_gradient);
  for (std::size_t row = 0; row < strip.rows; ++row) {
    const float* here = &gradient[row * columns];
    const float* rise = &evidence.rise[row * columns];
    const float scale = std::max(*std::max_element(rise, rise + columns), static_cast<float>(kSlightest));
    for (int k = 0; k < columns; ++k) {
      const double away = std::abs(k - reach) / static_cast<double>(reach);
      cost[row * columns + k] =
          static_cast<float>(0.02 * away + kRegion * evidence.region[row * columns + k] -
                             (1.0 - settings.nearness * away * away) *
                                 (here[k] >= least ? std::max(0.0f, rise[k]) / scale : 0.0f));
    }
  }
  const auto path = FindClosedPath(cost, strip.rows, columns, settings.smoothness, kMaxJump);
  for (std::size_t row = 0; row < strip.rows; ++row) {
    const float* here = &gradient[row * columns];
    int k = path[row];
    // the inside ends where the blurred edge begins; the edge itself is the steepest place next to it
    for (int climbed = 0; climbed < kClimb; ++climbed) {
      const int next = k + 1 < columns && here[k + 1] > here[k] ? k + 1
                       : k > 0 && here[k - 1] > here[k]         ? k - 1
                                                                : k;
      if (next == k) break;
      k = next;
    }
    const bool is_edge = here[k] >= least && evidence.rise[row * columns + path[row]] > 0;
    double offset = 0.0;
    if (k > 0 && k + 1 < columns) {
      const double bend = here[k - 1] - 2.0 * here[k] + here[k + 1];
      if (bend < 0) offset = std::clamp(0.5 * (here[k - 1] - here[k + 1]) / bend, -1.0, 1.0);
    }
    const double shift = std::clamp((k - reach + offset) * kColumnStep, -max_shift, max_shift);
    const Vec2 at = edge.curve.at[row] + shift * edge.curve.normal[row];
    edge.at.push_back(
        {std::clamp(at.x, 0.0, field.Width() - 1.0), std::clamp(at.y, 0.0, field.Height() - 1.0)});
    edge.is_edge.push_back(is_edge);
  }
  return edge;
}

std::size_t FindNearest(std::span<const Vec2> points, const Vec2& p) {
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (Norm(points[i] - p) < Norm(points[nearest] - p)) nearest = i;
  }
  return nearest;
}

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

ContourFit FitContourToEdges(const ColorImage& image, std::span<const Vec2> clicked,
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
  if (settings.adaption.max_shift_px < kColumnStep || !fit.notes.empty()) {
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
  const EdgePath edge = FindEdge(field, FitContour(clicked, settings.spline), max_shift, settings.adaption);
  std::vector<Control> controls;
  for (const Vec2& p : clicked) {
    const std::size_t row = FindNearest(edge.curve.at, p);
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
    fit.notes.push_back({FitProblem::kNoEdge, edge.at[0], kRowStep * static_cast<double>(rows)});
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
                           kRowStep * static_cast<double>(run)});
    }
    run = 0;
  }
  for (const std::size_t i : curve.divided) {
    fit.notes.push_back({FitProblem::kTooIrregular, controls[i].at, 0.0});
  }
  return fit;
}

}  // namespace trocar::anatomy
