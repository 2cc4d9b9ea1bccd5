// SPDX-License-Identifier: Apache-2.0
#include "trocar/bench/svg_plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace trocar::bench {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(FormatSvgPlot, DrawsALineFromCornerToCornerOfItsRange) {
  const std::string svg = FormatSvgPlot({"Title <1>", "x", "y"}, {{"left", {{0, 0}, {1, 1}}}});
  EXPECT_THAT(svg, HasSubstr("Title &lt;1&gt;"));
  // 640 x 260 with margins 62, 14, 30, 44 and 4 % of room
  EXPECT_THAT(svg, HasSubstr("M82.9 209.1L605.1 36.9")) << svg;
}

TEST(FormatSvgPlot, LeavesAGapWhereAValueIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::string svg = FormatSvgPlot({"t", "x", "y"}, {{"a", {{0, 0}, {1, 1}, {2, nan}, {3, 1}, {4, 0}}}});
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  const std::string path = svg.substr(svg.find("stroke="));
  EXPECT_EQ(std::count(path.begin(), path.begin() + static_cast<long>(path.find("/>")), 'M'), 2);
}

TEST(FormatSvgPlot, LogarithmicAxesMakePowersALineAndLeaveZeroOut) {
  PlotSettings settings{"t", "x", "y"};
  settings.is_log_x = settings.is_log_y = true;
  const std::string svg = FormatSvgPlot(settings, {{"a", {{0, 1}, {1, 1}, {10, 100}, {100, 10'000}}}});
  EXPECT_THAT(svg, HasSubstr("M82.9 209.1L344.0 123.0L605.1 36.9")) << svg;
  EXPECT_THAT(svg, HasSubstr(">10000<"));
}

TEST(FormatSvgPlot, ALegendThatDoesNotFitBesideTheTitleStandsInAColumn) {
  std::vector<PlotLine> lines;
  for (int i = 0; i < 8; ++i) lines.push_back({"a line with a long name", {{0, 0}, {1, double(i)}}});
  const std::string svg = FormatSvgPlot({"a title", "x", "y"}, lines);
  EXPECT_THAT(svg, Not(HasSubstr("x=\"-")));
  EXPECT_THAT(svg, HasSubstr("y=\"168.0\" text-anchor=\"start\"")) << "the eighth, 18 below each other";
}

TEST(FormatSvgPlot, SurvivesNothingAndOnePoint) {
  EXPECT_THAT(FormatSvgPlot({"t", "x", "y"}, {}), HasSubstr("</svg>"));
  EXPECT_THAT(FormatSvgPlot({"t", "x", "y"}, {{"a", {{5, 5}}}}), Not(HasSubstr("nan")));
  EXPECT_THAT(FormatSvgPlot({"t", "x", "y", true}, {{"a", {{5, 5}}}}), Not(HasSubstr("inf")));
}

}  // namespace
}  // namespace trocar::bench
