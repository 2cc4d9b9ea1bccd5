// SPDX-License-Identifier: Apache-2.0
#include "plot_frame.h"

#include <algorithm>
#include <cmath>

#include "trocar/host/text_table.h"
#include "trocar/report/attempt_report.h"
#include "trocar/report/axis.h"

namespace trocar::report {

using math::Vec2;

namespace {

constexpr double kMarkSize = 10.5;  // of the numbers at the axes [px]

}  // namespace

void Extent::Add(double value) {
  if (!std::isfinite(value)) return;
  low = is_empty ? value : std::min(low, value);
  high = is_empty ? value : std::max(high, value);
  is_empty = false;
}

void Extent::Settle(double room) {
  if (is_empty) low = 0, high = 1;
  const double more = high > low ? room * (high - low) : std::max(0.5, room * std::fabs(high));
  low -= more;
  high += more;
  is_empty = false;
}

Vec2 PlotFrame::Map(const Vec2& point) const {
  return {left + width * (point.x - x.low) / x.Length(), top + height * (1 - (point.y - y.low) / y.Length())};
}

std::vector<Vec2> PlotFrame::Map(const std::vector<Vec2>& points) const {
  std::vector<Vec2> mapped;
  mapped.reserve(points.size());
  for (const Vec2& point : points) mapped.push_back(Map(point));
  return mapped;
}

void PlotFrame::AddGround(Drawing& drawing) const {
  drawing.shapes.emplace_back(Area{MakeRectangle(left, top, width, height), Ink::kPanel, 1, ""});
}

void PlotFrame::AddXAxis(Drawing& drawing, int wanted, const std::string& label, bool is_time) const {
  const auto marks = is_time ? FindTimeMarks(x.high, wanted) : FindAxisMarks(x.low, x.high, wanted);
  for (const double mark : marks) {
    const double at = Map({mark, y.low}).x;
    if (at > Right() + 0.5) continue;
    drawing.shapes.emplace_back(Line{{{at, top}, {at, Bottom()}}, Ink::kGrid, 1});
    drawing.shapes.emplace_back(Label{{at, Bottom() + 15},
                                      is_time ? FormatClock(mark) : FormatDigits(mark),
                                      Ink::kMuted,
                                      Anchor::kMiddle,
                                      kMarkSize});
  }
  if (!label.empty()) {
    drawing.shapes.emplace_back(
        Label{{left + width / 2, Bottom() + 31}, label, Ink::kMuted, Anchor::kMiddle, 11});
  }
}

void PlotFrame::AddYAxis(Drawing& drawing, int wanted, const std::string& label) const {
  for (const double mark : FindAxisMarks(y.low, y.high, wanted)) {
    const double at = Map({x.low, mark}).y;
    drawing.shapes.emplace_back(Line{{{left, at}, {Right(), at}}, Ink::kGrid, 1});
    drawing.shapes.emplace_back(
        Label{{left - 6, at + 3.5}, FormatDigits(mark), Ink::kMuted, Anchor::kEnd, kMarkSize});
  }
  if (!label.empty()) {
    drawing.shapes.emplace_back(
        Label{{left - 40, top + height / 2}, label, Ink::kMuted, Anchor::kMiddle, 11, false, true});
  }
}

void PlotFrame::MakeEqual() {
  const double unit = std::max(x.Length() / width, y.Length() / height);  // per px
  const auto widen = [](Extent& extent, double length) {
    const double more = (length - extent.Length()) / 2;
    extent.low -= more;
    extent.high += more;
  };
  widen(x, unit * width);
  widen(y, unit * height);
}

void AddLegend(Drawing& drawing, double left, double baseline, const std::vector<LegendEntry>& entries) {
  double at = left;
  for (const LegendEntry& entry : entries) {
    if (entry.is_area) {
      drawing.shapes.emplace_back(Area{MakeRectangle(at, baseline - 9, 16, 10), entry.ink, 0.35, ""});
    } else {
      drawing.shapes.emplace_back(
          Line{{{at, baseline - 4}, {at + 18, baseline - 4}}, entry.ink, 2.2, entry.dash});
    }
    drawing.shapes.emplace_back(Label{{at + 23, baseline}, entry.text, Ink::kText, Anchor::kStart, 11});
    at += 23 + GuessTextWidth(entry.text, 11) + 18;
  }
}

}  // namespace trocar::report
