// SPDX-License-Identifier: Apache-2.0
#include "trocar/bench/svg_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/host/markup.h"
#include "trocar/host/text_table.h"
#include "trocar/report/axis.h"
#include "trocar/report/drawing.h"

namespace trocar::bench {
namespace {

using host::EscapeMarkup;
using math::Vec2;

// told apart by dashes as well as by colour (Okabe and Ito 2008)
constexpr std::array<const char*, 8> kColours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                 "#e69f00", "#56b4e9", "#000000", "#7a6a00"};
constexpr std::array<const char*, 8> kDashes = {"none", "6 3",  "2 2",     "8 2 2 2",
                                                "1 3",  "10 4", "4 1 1 1", "12 2 2 2"};
constexpr double kLeft = 62, kRight = 14, kTop = 30, kBottom = 44;  // margins [px]
constexpr double kLegendLetter = 8, kColumnLetter = 6.2;            // room for a letter [px]
constexpr std::size_t kMostPoints = 1200;                           // of one line: two to a pixel

/// Closed interval that grows.
struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void Add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// Never empty, with a little room.
  void Settle() {
    if (!(low <= high)) low = 0, high = 1;
    const double room = high > low ? 0.04 * (high - low) : std::max(0.5, 0.04 * std::fabs(high));
    low -= room;
    high += room;
  }
  double Length() const { return high - low; }
};

std::string Text(double x, double y, std::string_view anchor, std::string_view style,
                 std::string_view content) {
  return "<text x=\"" + report::FormatPixels(x) + "\" y=\"" + report::FormatPixels(y) + "\" text-anchor=\"" +
         std::string(anchor) + "\" class=\"" + std::string(style) + "\">" + EscapeMarkup(content) +
         "</text>\n";
}

/// Commands of an SVG path through the points; a gap where a point is not finite.
template <typename Map>
std::string PathCommands(std::vector<Vec2> points, const Map& map) {
  for (Vec2& point : points) {
    if (std::isfinite(point.x) && std::isfinite(point.y)) point = map(point);
  }
  return report::FormatPath(points);
}

}  // namespace

namespace {

/// The lines with logarithms in place of the values on logarithmic axes.
std::vector<PlotLine> TakeLogarithms(const PlotSettings& settings, std::vector<PlotLine> lines) {
  for (PlotLine& line : lines) {
    for (Vec2& point : line.points) {
      // of zero and less it is not finite, which leaves the point out
      if (settings.is_log_x) point.x = std::log10(point.x);
      if (settings.is_log_y) point.y = std::log10(point.y);
    }
  }
  return lines;
}

/// An axis' marks where they are drawn, and what stands beside them.
std::vector<std::pair<double, std::string>> FindMarks(double low, double high, int wanted, bool is_log) {
  std::vector<std::pair<double, std::string>> marks;
  if (is_log) {
    for (const double mark : report::FindLogMarks(std::pow(10.0, low), std::pow(10.0, high)))
      marks.emplace_back(std::log10(mark), host::FormatNumber(mark, 6));
  } else {
    for (const double mark : report::FindAxisMarks(low, high, wanted))
      marks.emplace_back(mark, host::FormatNumber(mark, 6));
  }
  return marks;
}

}  // namespace

std::string FormatSvgPlot(const PlotSettings& settings, const std::vector<PlotLine>& given) {
  TROCAR_ASSERT(given.size() <= kColours.size());
  const std::vector<PlotLine> lines = TakeLogarithms(settings, given);
  Extent x, y;
  for (const PlotLine& line : lines) {
    for (const Vec2& point : line.points) {
      if (!std::isfinite(point.x) || !std::isfinite(point.y)) continue;
      x.Add(point.x);
      y.Add(point.y);
    }
  }
  x.Settle();
  y.Settle();
  // the legend stands beside the title where it fits there, else in a column at the right
  double beside_title = 0, longest = 0;
  for (const PlotLine& line : lines) {
    beside_title += kLegendLetter * static_cast<double>(line.name.size()) + 48;
    longest = std::max(longest, static_cast<double>(line.name.size()));
  }
  const bool has_column =
      beside_title + 8.0 * static_cast<double>(settings.title.size()) > settings.width - kLeft - kRight;
  const double right = has_column ? 44 + kColumnLetter * longest : kRight;
  const double width = settings.width - kLeft - right, height = settings.height - kTop - kBottom;
  if (settings.has_equal_axes) {
    // the axis with fewer units to a pixel is widened about its middle
    const double unit = std::max(x.Length() / width, y.Length() / height);
    const double grow_x = 0.5 * (unit * width - x.Length()), grow_y = 0.5 * (unit * height - y.Length());
    x.low -= grow_x, x.high += grow_x;
    y.low -= grow_y, y.high += grow_y;
  }
  const auto map = [&](const Vec2& point) {
    return Vec2{kLeft + width * (point.x - x.low) / x.Length(),
                kTop + height * (y.high - point.y) / y.Length()};
  };

  std::string svg = "<svg viewBox=\"0 0 " + std::to_string(settings.width) + " " +
                    std::to_string(settings.height) + "\" role=\"img\" aria-label=\"" +
                    EscapeMarkup(settings.title) + "\">\n";
  svg += Text(kLeft, 16, "start", "title", settings.title);
  // grid, marks and their numbers
  for (const auto& [mark, label] : FindMarks(x.low, x.high, 8, settings.is_log_x)) {
    const double at = map({mark, y.low}).x;
    svg += "<path class=\"grid\" d=\"M" + report::FormatPixels(at) + " " + report::FormatPixels(kTop) + "V" +
           report::FormatPixels(kTop + height) + "\"/>\n";
    svg += Text(at, kTop + height + 15, "middle", "mark", label);
  }
  for (const auto& [mark, label] : FindMarks(y.low, y.high, 5, settings.is_log_y)) {
    const double at = map({x.low, mark}).y;
    svg += "<path class=\"grid\" d=\"M" + report::FormatPixels(kLeft) + " " + report::FormatPixels(at) + "H" +
           report::FormatPixels(kLeft + width) + "\"/>\n";
    svg += Text(kLeft - 6, at + 4, "end", "mark", label);
  }
  svg += Text(kLeft + width / 2, settings.height - 8.0, "middle", "label", settings.x_label);
  svg += "<text transform=\"translate(14 " + report::FormatPixels(kTop + height / 2) +
         ") rotate(-90)\" text-anchor=\"middle\" class=\"label\">" + EscapeMarkup(settings.y_label) +
         "</text>\n";
  // lines and legend
  double legend = kLeft + width;
  for (std::size_t i = lines.size(); i-- > 0;) {
    const std::string stroke =
        std::string("stroke=\"") + kColours[i] + "\" stroke-dasharray=\"" + kDashes[i] + "\"";
    const auto points =
        settings.has_equal_axes ? lines[i].points : report::ThinOut(lines[i].points, kMostPoints);
    svg += "<path class=\"line\" " + stroke + " d=\"" + PathCommands(points, map) + "\"/>\n";
    double at = kTop + 12 + 18.0 * static_cast<double>(i);
    if (has_column) {
      legend = kLeft + width + 38;
    } else {
      legend -= kLegendLetter * static_cast<double>(lines[i].name.size()) + 8;
      at = 16;
    }
    svg += Text(legend, at, "start", "mark", lines[i].name);
    svg += "<path class=\"line\" " + stroke + " d=\"M" + report::FormatPixels(legend - 28) + " " +
           (has_column ? report::FormatPixels(at - 4) : "12") + "h24\"/>\n";
    legend -= 40;
  }
  return svg + "</svg>\n";
}

}  // namespace trocar::bench
