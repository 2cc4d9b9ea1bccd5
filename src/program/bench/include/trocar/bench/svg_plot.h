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

}  // namespace trocar::bench
