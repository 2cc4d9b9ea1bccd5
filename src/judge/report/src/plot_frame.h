// SPDX-License-Identifier: Apache-2.0
/// \file plot_frame.h  Axes, grid and legend that the charts share.
#pragma once

#include <string>
#include <vector>

#include "trocar/report/drawing.h"

namespace trocar::report {

/// Closed interval that grows.
struct Extent {
  double low = 0, high = 0;
  bool is_empty = true;

  void Add(double value);
  /// Never of no length, with a share of room at both ends.
  void Settle(double room);
  double Length() const { return high - low; }
};

/// A rectangle of a drawing in which data is shown.
struct PlotFrame {
  double left = 0, top = 0, width = 0, height = 0;  ///< [px]
  Extent x, y;

  math::Vec2 Map(const math::Vec2& point) const;
  std::vector<math::Vec2> Map(const std::vector<math::Vec2>& points) const;
  double Right() const { return left + width; }
  double Bottom() const { return top + height; }

  void AddGround(Drawing& drawing) const;
  /// Marks with grid lines. \param is_time  marks are "m:ss"
  void AddXAxis(Drawing& drawing, int wanted, const std::string& label, bool is_time = false) const;
  void AddYAxis(Drawing& drawing, int wanted, const std::string& label) const;
  /// Room is added along the axis that has too little, so that one unit is as long across as up.
  void MakeEqual();
};

struct LegendEntry {
  std::string text;
  Ink ink = Ink::kText;
  Dash dash = Dash::kSolid;
  bool is_area = false;
};
/// In a row from `left` on.
void AddLegend(Drawing& drawing, double left, double baseline, const std::vector<LegendEntry>& entries);

}  // namespace trocar::report
