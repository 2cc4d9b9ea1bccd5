// SPDX-License-Identifier: Apache-2.0
#include "edge_cost.h"

#include <algorithm>
#include <cmath>

#include "tissue_colours.h"
#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"

namespace trocar::contours {
namespace {

constexpr double kWindowPx =
    40.0;                      // of the contour to either side from which a place learns its colours [pixels]
constexpr int kAlongRows = 2;  // averaged to either side along the curve
constexpr double kFar = 3.0;   // a colour this many standard deviations away belongs to something else [-]
// the inside is learned up to this part of the reach from the curve, where it is not sure to be inside any
// more [-]
constexpr double kDoubtful = 0.3;

}  // namespace

EdgeEvidence CalcEdgeEvidence(const EdgeStrip& strip, double reach_px, double row_px, double depth_px) {
  EdgeEvidence evidence;
  evidence.reach = base::FloorTo<int>(reach_px / strip.step_px + 1e-9);
  const int columns = evidence.Columns(), all = strip.Columns(), pad = strip.reach - evidence.reach;
  TROCAR_ASSERT(pad >= 1);
  const auto rows = static_cast<int>(strip.rows);

  // averaged along the curve, which blurs no edge that runs along it
  std::vector<Colour> smooth(strip.colours.size());
  const int along = std::min(kAlongRows, (rows - 1) / 2);
  for (int row = 0; row < rows; ++row) {
    Colour* to = &smooth[static_cast<std::size_t>(row) * all];
    for (int d = -along; d <= along; ++d) {
      const Colour* from = strip.Row(static_cast<std::size_t>((row + d + rows) % rows));
      for (int k = 0; k < all; ++k) {
        for (std::size_t c = 0; c < 4; ++c) to[k][c] += from[k][c] / static_cast<float>(2 * along + 1);
      }
    }
  }
  // colours of the inside, of each row and then of the rows about it
  std::vector<ColourMoments> inside(strip.rows);
  const int last = strip.reach - base::TruncateTo<int>(kDoubtful * evidence.reach);
  const int first = std::clamp(strip.reach - base::TruncateTo<int>(depth_px / strip.step_px), 0, last);
  for (int row = 0; row < rows; ++row) {
    const Colour* colours = &smooth[static_cast<std::size_t>(row) * all];
    for (int k = first; k <= last; k += 2) inside[row].Add(colours[k]);
  }
  const int window = std::min(base::TruncateTo<int>(kWindowPx / row_px), (rows - 1) / 2);
  ColourMoments about;
  const auto slide = [&](int row, double sign) {
    about.Add(inside[static_cast<std::size_t>((row % rows + rows) % rows)], sign);
  };
  for (int row = -window; row <= window; ++row) slide(row, 1);

  evidence.gradient.resize(strip.rows * columns), evidence.rise.resize(strip.rows * columns);
  evidence.region.resize(strip.rows * columns);
  std::vector<float> unlike(all);
  for (int row = 0; row < rows; ++row) {
    const TissueColours tissue(about);
    const Colour* colours = &smooth[static_cast<std::size_t>(row) * all];
    for (int k = 0; k < all; ++k)
      unlike[k] = static_cast<float>(std::min(tissue.Distance(colours[k]), kFar) / kFar);
    float* gradient = &evidence.gradient[static_cast<std::size_t>(row) * columns];
    float* rise = &evidence.rise[static_cast<std::size_t>(row) * columns];
    float* region = &evidence.region[static_cast<std::size_t>(row) * columns];
    double cost = 0, least = 0;
    for (int k = 0; k < columns; ++k) {
      const int at = k + pad;
      float squared = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const float change = colours[at + 1][c] - colours[at - 1][c];
        squared += change * change;
      }
      const auto width = static_cast<float>(2 * strip.step_px);
      gradient[k] = std::sqrt(squared) / width;
      rise[k] = (unlike[at + 1] - unlike[at - 1]) / width;
      cost += (2.0 * unlike[at - 1] - 1.0) * strip.step_px;
      region[k] = static_cast<float>(cost);
      least = k == 0 ? cost : std::min(least, cost);
    }
    for (int k = 0; k < columns; ++k) region[k] -= static_cast<float>(least);
    slide(row - window, -1);
    slide(row + window + 1, 1);
  }
  return evidence;
}

}  // namespace trocar::contours
