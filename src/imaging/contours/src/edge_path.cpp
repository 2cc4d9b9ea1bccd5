// SPDX-License-Identifier: Apache-2.0
#include "edge_path.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "edge_cost.h"
#include "trocar/base/to_integer.h"

namespace trocar::contours {

using math::Vec2;

namespace {

constexpr double kColumnStep = 0.5;  // of the band [pixels]
constexpr double kBand = 6.0;        // beyond the reach, where the colours of the inside are learned [pixels]
constexpr double kRegion =
    0.1;  // weight of the colours on either side, a pixel, against the strongest edge [-]
constexpr double kSlightest = 0.05;      // rises below this count in full nowhere [1 / pixel]
constexpr int kClimb = 4;                // columns from where the inside ends to the steepest place
constexpr int kSharpClimb = 2;           // columns from there in the picture without blur
constexpr int kMaxJump = 2;              // columns between neighbouring rows
constexpr int kNarrowRounds = 2;         // of searching again along what was found
constexpr double kSecondReach = 2.5;     // of these searches [pixels]
constexpr double kSecondNearness = 0.3;  // part of an edge's strength that is lost at its ends [-]
constexpr std::size_t kSmoothRows = 2;   // to either side over which a found path is averaged

/// The steepest place next to a column, between columns.
double Climb(const float* gradient, int columns, int k, int most) {
  for (int climbed = 0; climbed < most; ++climbed) {
    const int next = k + 1 < columns && gradient[k + 1] > gradient[k] ? k + 1
                     : k > 0 && gradient[k - 1] > gradient[k]         ? k - 1
                                                                      : k;
    if (next == k) break;
    k = next;
  }
  if (k == 0 || k + 1 == columns) return k;
  const double bend = gradient[k - 1] - 2.0 * gradient[k] + gradient[k + 1];
  return bend < 0 ? k + std::clamp(0.5 * (gradient[k - 1] - gradient[k + 1]) / bend, -1.0, 1.0) : k;
}

}  // namespace

EdgePath FollowEdge(const EdgeField& field, ClosedCurve curve, const EdgeSearch& search,
                    const EdgeAdaptionSettings& settings) {
  const EdgeStrip strip = SampleStrip(field, curve, search.reach_px + kBand, kColumnStep);
  const EdgeEvidence evidence = CalcEdgeEvidence(strip, search.reach_px, kEdgeRowStep, CalcHalfWidth(curve));
  const int reach = evidence.reach, columns = evidence.Columns();
  std::vector<float> cost(evidence.gradient.size());
  const auto least = static_cast<float>(settings.min_gradient);
  for (std::size_t row = 0; row < strip.rows; ++row) {
    const float* gradient = &evidence.gradient[row * columns];
    const float* rise = &evidence.rise[row * columns];
    const float scale = std::max(*std::max_element(rise, rise + columns), static_cast<float>(kSlightest));
    for (int k = 0; k < columns; ++k) {
      const double away = std::abs(k - reach) / static_cast<double>(reach);
      const double strength = gradient[k] >= least ? std::max(0.0f, rise[k]) / scale : 0.0;
      cost[row * columns + k] =
          static_cast<float>(0.02 * away + kRegion * evidence.region[row * columns + k] -
                             (1.0 - search.nearness * away * away) * strength);
    }
  }
  const auto path = FindClosedPath(cost, strip.rows, columns, settings.smoothness, kMaxJump);
  EdgePath edge;
  for (std::size_t row = 0; row < strip.rows; ++row) {
    const float* gradient = &evidence.gradient[row * columns];
    // the inside ends where the blurred edge begins; the edge itself is the steepest place next to it
    const double k = Climb(gradient, columns, path[row], kClimb);
    edge.at.push_back(curve.at[row] + ((k - reach) * kColumnStep) * curve.normal[row]);
    edge.is_edge.push_back(gradient[base::RoundTo<std::size_t>(k)] >= least &&
                           evidence.rise[row * columns + path[row]] > 0);
  }
  edge.curve = std::move(curve);
  return edge;
}

namespace {

ClosedCurve Smooth(const std::vector<Vec2>& path) {
  const std::size_t n = path.size();
  std::vector<Vec2> smooth(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t d = 0; d <= 2 * kSmoothRows; ++d)
      smooth[i] = smooth[i] + path[(i + n + d - kSmoothRows) % n];
    smooth[i] = (1.0 / (2 * kSmoothRows + 1)) * smooth[i];
  }
  return MakeClosedCurve(std::move(smooth));
}

}  // namespace

/// Moves each place to the steepest one beside it in the picture as it was, averaged along the edge. The blurred
/// picture's steepest place is pushed aside where another border lies within the blur.
void LocateSharp(const EdgeField& field, EdgePath& edge) {
  constexpr int kReach = 8, kColumns = 2 * kReach + 1;  // wider than what Climb can reach
  const ClosedCurve curve = Smooth(edge.at);
  const auto rows = static_cast<int>(curve.at.size());
  std::vector<Colour> strip;
  strip.reserve(curve.at.size() * kColumns);
  for (std::size_t row = 0; row < curve.at.size(); ++row) {
    for (int k = -kReach; k <= kReach; ++k)
      strip.push_back(field.SampleSharp(curve.at[row] + (k * kColumnStep) * curve.normal[row]));
  }
  const int along = std::min(static_cast<int>(kSmoothRows), (rows - 1) / 2);
  for (int row = 0; row < rows; ++row) {
    std::array<Colour, kColumns> sum = {};
    for (int d = -along; d <= along; ++d) {
      const Colour* from = &strip[static_cast<std::size_t>((row + d + rows) % rows) * kColumns];
      for (int k = 0; k < kColumns; ++k)
        for (std::size_t c = 0; c < 3; ++c) sum[k][c] += from[k][c];
    }
    std::array<float, kColumns> gradient = {};
    for (int k = 1; k + 1 < kColumns; ++k) {
      float squared = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const float change = sum[k + 1][c] - sum[k - 1][c];
        squared += change * change;
      }
      gradient[k] = std::sqrt(squared);
    }
    const double offset = Dot(edge.at[row] - curve.at[row], curve.normal[row]) / kColumnStep;
    const int start =
        std::clamp(base::RoundTo<int>(offset) + kReach, kSharpClimb + 1, kColumns - kSharpClimb - 2);
    const double k = Climb(gradient.data(), kColumns, start, kSharpClimb);
    edge.at[row] = edge.at[row] + ((k - kReach - offset) * kColumnStep) * curve.normal[row];
  }
}

EdgePath FindEdgePath(const EdgeField& field, ClosedCurve curve, const EdgeAdaptionSettings& settings) {
  const double most = settings.max_shift_px;
  const EdgePath first = FollowEdge(field, std::move(curve), {most, settings.nearness}, settings);
  EdgePath edge = first;
  for (int round = 0; round < kNarrowRounds; ++round)
    edge = FollowEdge(field, Smooth(edge.at), {kSecondReach, kSecondNearness}, settings);
  LocateSharp(field, edge);
  // the rows are still those of the clicks' curve, which no place may leave too far
  edge.curve = first.curve;
  for (std::size_t row = 0; row < edge.at.size(); ++row) {
    const Vec2 shift = edge.at[row] - edge.curve.at[row];
    const double length = Norm(shift);
    const Vec2 at = edge.curve.at[row] + (length > most ? most / length : 1.0) * shift;
    edge.at[row] = {std::clamp(at.x, 0.0, field.Width() - 1.0), std::clamp(at.y, 0.0, field.Height() - 1.0)};
  }
  return edge;
}

}  // namespace trocar::contours
