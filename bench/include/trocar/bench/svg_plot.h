// SPDX-License-Identifier: Apache-2.0
/// \file svg_plot.h  Line plots as SVG text, for a page that needs nothing from elsewhere.
#pragma once

#include <string>
#include <vector>

#include "trocar/math/vector.h"

namespace trocar::bench {

/// One line of a plot. Points that are not finite are left out and break the line.
struct PlotLine {
  std::string name;                ///< in the legend
  std::vector<math::Vec2> points;  ///< in the axes' units
};

struct PlotSettings {
  std::string title, x_label, y_label;
  bool has_equal_axes = false;  ///< one unit is as long across as up: for maps
  int width = 640, height = 260;
  bool is_log_x = false, is_log_y = false;  ///< logarithmic; points at or below zero are left out
};

/// At most 8 lines; each has its colour and its dashes.
std::string FormatSvgPlot(const PlotSettings& settings, const std::vector<PlotLine>& lines);

/// Marks from at or above `low` to at or below `high`, 1, 2 or 5 times a power of ten apart, about `wanted`
/// of them.
/// \pre low < high, wanted >= 2 (TROCAR_ASSERT)
std::vector<double> FindAxisMarks(double low, double high, int wanted);

/// Marks of a logarithmic axis between `low` and `high`: powers of ten, with 2 and 5 times them where they are few.
/// \pre 0 < low < high (TROCAR_ASSERT)
std::vector<double> FindLogMarks(double low, double high);

/// At most `limit` points, keeping the lowest and highest of each stretch so that no peak is lost.
/// \pre limit >= 2 (TROCAR_ASSERT)
std::vector<math::Vec2> ThinOut(const std::vector<math::Vec2>& points, std::size_t limit);

}  // namespace trocar::bench
