// SPDX-License-Identifier: Apache-2.0
#include "skipped_slices.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "edge_path.h"
#include "even_places.h"
#include "tissue_colours.h"
#include "trocar/base/assert.h"
#include "trocar/contours/contour_fill.h"
#include "trocar/contours/contour_spline.h"

namespace trocar::contours {

using math::Vec2;

namespace {

constexpr double kBendSlices = 1.0;  // weight of bending from slice to slice against one edge [-]
constexpr double kSlopeRows = 0.5;   // weight of unequal neighbouring rows against one edge [-]
constexpr double kOutlierPx = 1.0;   // an edge this far from its neighbours counts a quarter [pixels]
constexpr int kReweightings = 5;     // of the edges
constexpr int kSweeps = 30;          // of the equations for each
constexpr double kSeen = 0.5;        // least part of an end's contour with an edge [-]
constexpr double kAlike = 3.0;       // colours nearer to the organ's than this are its own [deviations]
constexpr double kFilled = 0.6;      // least part of an end's area with such colours [-]
constexpr double kGone = 0.2;  // less of the slice before with such colours says that the organ is over [-]

/// Shifts along normals: of each row of the contour in each of some slices [pixels].
struct ShiftGrid {
  std::size_t slices = 0, rows = 0;
  std::vector<double> found, weight, shift;  // (slices * rows)

  ShiftGrid(std::size_t slice_count, std::size_t row_count)
      : slices(slice_count),
        rows(row_count),
        found(slices * rows, 0.0),
        weight(slices * rows, 0.0),
        shift(slices * rows, 0.0) {}

  /// The edge that was found in a slice; rows without one keep weight 0.
  void Take(std::size_t slice, const EdgePath& edge) {
    for (std::size_t row = 0; row < rows; ++row) {
      if (!edge.is_edge[row]) continue;
      found[slice * rows + row] = Dot(edge.at[row] - edge.curve.at[row], edge.curve.normal[row]);
      weight[slice * rows + row] = 1.0;
    }
  }
};

/// Which slices the shifts of a grid's slices must agree with.
enum class Beside {
  kContoured,  ///< the slices before the first and after the last are contoured: their shift is 0
  kNothing,    ///< each slice stands alone
};

/// Least squares of the shifts against the edges found, their bending across slices and their differences
/// along rows, by Gauss and Seidel's sweeps; edges that disagree lose their weight from round to round.
void Solve(ShiftGrid& grid, Beside beside) {
  const auto n = static_cast<std::ptrdiff_t>(grid.slices);
  const std::size_t rows = grid.rows;
  const auto at = [&](std::ptrdiff_t slice, std::size_t row) {
    return slice < 0 || slice >= n ? 0.0 : grid.shift[static_cast<std::size_t>(slice) * rows + row];
  };
  const double bend = beside == Beside::kContoured ? kBendSlices : 0.0;
  std::vector<double> weight = grid.weight;
  for (int round = 0; round < kReweightings; ++round) {
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (std::ptrdiff_t k = 0; k < n; ++k) {
        for (std::size_t row = 0; row < rows; ++row) {
          const std::size_t here = static_cast<std::size_t>(k) * rows + row;
          double sum = weight[here] * grid.found[here] +
                       kSlopeRows * (at(k, (row + 1) % rows) + at(k, (row + rows - 1) % rows)) +
                       bend * 2 * (at(k - 1, row) + at(k + 1, row));
          double share = weight[here] + 2 * kSlopeRows + 4 * bend;
          // the bends of the slices beside this one
          if (k > 0) sum -= bend * (at(k - 2, row) - 2 * at(k - 1, row)), share += bend;
          if (k + 1 < n) sum -= bend * (at(k + 2, row) - 2 * at(k + 1, row)), share += bend;
          grid.shift[here] = sum / share;
        }
      }
    }
    for (std::size_t i = 0; i < weight.size(); ++i) {
      const double away = (grid.shift[i] - grid.found[i]) / kOutlierPx;
      weight[i] = grid.weight[i] / ((1 + away * away) * (1 + away * away));
    }
  }
}

/// The curve moved along its normals, inside the picture and never across itself.
std::vector<Vec2> Shift(const ClosedCurve& curve, std::span<const double> shift, double most,
                        const EdgeField& field) {
  const bool did_cross = CrossesItself(curve.at);
  std::vector<Vec2> moved(curve.at.size());
  for (double part = 1.0; part > 0.1; part *= 0.5) {
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const Vec2 p = curve.at[i] + (part * std::clamp(shift[i], -most, most)) * curve.normal[i];
      moved[i] = {std::clamp(p.x, 0.0, field.Width() - 1.0), std::clamp(p.y, 0.0, field.Height() - 1.0)};
    }
    if (did_cross || !CrossesItself(moved)) return moved;
  }
  return curve.at;
}

/// Points of the pairs that make equal steps half way between both contours.
ContourMatch Resample(const ContourMatch& match) {
  ContourMatch even;
  for (const auto& [side, part] : FindEvenPlaces(match.At(0.5), kEdgeRowStep, 8, 4000)) {
    const auto &from = match.pairs[side], &to = match.pairs[(side + 1) % match.pairs.size()];
    even.pairs.push_back({from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1])});
  }
  return even;
}

EdgeAdaptionSettings WithinReach(EdgeAdaptionSettings adaption) {
  TROCAR_ASSERT(adaption.skipped_shift_px >= 0.5);
  adaption.max_shift_px = adaption.skipped_shift_px;
  return adaption;
}

ColourMoments SumColours(const EdgeField& field, const images::Mask& area) {
  ColourMoments colours;
  for (int y = 0; y < area.height; ++y) {
    for (int x = 0; x < area.width; ++x) {
      if (area.At(x, y))
        colours.Add(field.Sample({static_cast<double>(area.x0 + x), static_cast<double>(area.y0 + y)}));
    }
  }
  return colours;
}

/// Share of an area whose colours are the tissue's.
double CalcShareAlike(const EdgeField& field, const images::Mask& area, const TissueColours& tissue) {
  std::size_t alike = 0;
  for (int y = 0; y < area.height; ++y) {
    for (int x = 0; x < area.width; ++x) {
      const Vec2 at{static_cast<double>(area.x0 + x), static_cast<double>(area.y0 + y)};
      if (area.At(x, y) && tissue.Distance(field.Sample(at)) < kAlike) ++alike;
    }
  }
  return static_cast<double>(alike) / static_cast<double>(std::max<std::size_t>(1, area.Count()));
}

}  // namespace

std::vector<std::vector<Vec2>> FollowBetween(const ContourMatch& match, std::span<const EdgeField> fields,
                                             const EdgeAdaptionSettings& adaption) {
  const EdgeAdaptionSettings settings = WithinReach(adaption);
  const ContourMatch even = Resample(match);
  ShiftGrid grid(fields.size(), even.pairs.size());
  std::vector<ClosedCurve> curves;
  for (std::size_t k = 0; k < fields.size(); ++k) {
    const double part = static_cast<double>(k + 1) / static_cast<double>(fields.size() + 1);
    curves.push_back(MakeClosedCurve(even.At(part)));
    grid.Take(k, FindEdgePath(fields[k], curves.back(), settings));
  }
  Solve(grid, Beside::kContoured);
  std::vector<std::vector<Vec2>> contours;
  for (std::size_t k = 0; k < fields.size(); ++k) {
    contours.push_back(Shift(curves[k], std::span(grid.shift).subspan(k * grid.rows, grid.rows),
                             settings.max_shift_px, fields[k]));
  }
  return contours;
}

FollowedEnd FollowEnd(const EdgeField& last, std::span<const Vec2> contour, std::span<const EdgeField> fields,
                      double least_px, const EdgeAdaptionSettings& adaption) {
  const EdgeAdaptionSettings settings = WithinReach(adaption);
  FollowedEnd end;
  std::vector<Vec2> before(contour.begin(), contour.end());
  ColourMoments inside = SumColours(last, FillArea({before}, {}));
  for (const EdgeField& field : fields) {
    if (inside.count == 0) return end;
    const EdgePath edge = FindEdgePath(field, ResampleClosed(before, kEdgeRowStep), settings);
    ShiftGrid grid(1, edge.at.size());
    grid.Take(0, edge);
    double seen = 0;
    for (const double w : grid.weight) seen += w;
    if (seen < kSeen * static_cast<double>(grid.rows)) {
      end.is_ended = CalcShareAlike(field, FillArea({before}, {}), TissueColours(inside)) < kGone;
      return end;
    }
    Solve(grid, Beside::kNothing);
    auto next = Shift(edge.curve, grid.shift, settings.max_shift_px, field);
    images::Mask area = FillArea({next}, {});
    if (CalcShareAlike(field, area, TissueColours(inside)) < kFilled ||
        static_cast<double>(area.Count()) < 0.25 * M_PI * least_px * least_px) {
      end.is_ended = true;
      return end;
    }
    inside = SumColours(field, area);
    end.contours.push_back(next);
    before = std::move(next);
  }
  // the next contoured slice does not show it any more
  end.is_ended = true;
  return end;
}

}  // namespace trocar::contours
