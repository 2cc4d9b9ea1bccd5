// SPDX-License-Identifier: Apache-2.0
#include "trocar/report/charts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "palette.h"
#include "plot_frame.h"
#include "sample_reports.h"
#include "trocar/report/axis.h"

namespace trocar::report {

using math::Vec2;

namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::size_t CountMarks(const Drawing& drawing, Ink ink) {
  std::size_t count = 0;
  for (const Shape& shape : drawing.shapes) {
    const Mark* mark = std::get_if<Mark>(&shape);
    count += mark != nullptr && mark->ink == ink ? 1 : 0;
  }
  return count;
}

void ExpectInside(const Drawing& drawing) {
  const auto check = [&](const Vec2& point) {
    if (!std::isfinite(point.x)) return;
    EXPECT_GE(point.x, -1) << drawing.title;
    EXPECT_LE(point.x, drawing.width + 1) << drawing.title;
    EXPECT_GE(point.y, -1) << drawing.title;
    EXPECT_LE(point.y, drawing.height + 1) << drawing.title;
  };
  for (const Shape& shape : drawing.shapes) {
    if (const auto* line = std::get_if<Line>(&shape)) {
      for (const Vec2& point : line->points) check(point);
    } else if (const auto* area = std::get_if<Area>(&shape)) {
      for (const Vec2& point : area->points) check(point);
    } else if (const auto* mark = std::get_if<Mark>(&shape)) {
      check(mark->at);
    } else {
      check(std::get<Label>(shape).at);
    }
  }
}

TEST(Timeline, HasAMarkForEachErrorAtItsTime) {
  const AttemptReport report = test::MakeOperationReport();
  const Drawing drawing = DrawTimeline(report);
  EXPECT_EQ(CountMarks(drawing, Ink::kMinor), 1u);
  EXPECT_EQ(CountMarks(drawing, Ink::kMajor), 1u);
  EXPECT_EQ(CountMarks(drawing, Ink::kCritical), 1u);
  ExpectInside(drawing);
  std::vector<double> at;
  for (const Shape& shape : drawing.shapes) {
    if (const Mark* mark = std::get_if<Mark>(&shape)) at.push_back(mark->at.x);
  }
  // lanes from critical to minor; 0.77, 0.42 and 0.11 of the axis
  ASSERT_EQ(at.size(), 3u);
  EXPECT_NEAR((at[0] - at[1]) / (at[1] - at[2]), (0.77 - 0.42) / (0.42 - 0.11), 1e-6);
}

TEST(Timeline, KeepsTheHighestForceWhenThinned) {
  auto trace = test::MakeTrace(600, false);
  trace.hands[0][40001].force = 17.25;
  const AttemptReport report = MakeAttemptReport(trace, {}, {test::MakeFacts(), {}, {}});
  double peak = 0;
  for (const Vec2& point : report.hands[0].force) peak = std::max(peak, point.y);
  EXPECT_EQ(peak, 17.25);
  EXPECT_LE(report.hands[0].force.size(), 1600u);
  EXPECT_THAT(DrawTimeline(report).description, HasSubstr("at most 17.2 newtons"));
}

TEST(Paths, OneUnitIsAsLongAcrossAsUp) {
  const Drawing drawing = DrawPaths(test::MakeTaskReport(), PathView::kFromFront);
  ExpectInside(drawing);
  PlotFrame frame;
  frame.width = 400, frame.height = 300;
  frame.x.Add(0), frame.x.Add(10);
  frame.y.Add(0), frame.y.Add(30);
  frame.MakeEqual();
  const Vec2 a = frame.Map({0, 0}), b = frame.Map({1, 1});
  EXPECT_NEAR(b.x - a.x, a.y - b.y, 1e-12);
}

TEST(Radar, PutsTheExpertsMeanOnItsRing) {
  AttemptReport report = test::MakeTaskReport();
  for (MetricRow& row : report.metrics) {
    if (row.expert_mean) row.value = *row.expert_mean;
  }
  const auto drawing = DrawRadar(report);
  ASSERT_TRUE(drawing.has_value());
  ExpectInside(*drawing);
  std::size_t axes = 0;
  for (const Shape& shape : drawing->shapes) {
    const Mark* mark = std::get_if<Mark>(&shape);
    if (mark == nullptr || mark->at.x > 480) continue;  // at the right is the same on straight lines
    ++axes;
    // of the rim's 112 px four of six deviations
    EXPECT_NEAR(std::hypot(mark->at.x - 232, mark->at.y - 192), 112 * 4.0 / 6, 1e-6);
  }
  EXPECT_GE(axes, 6u);
  EXPECT_LE(axes, 8u);
}

TEST(Radar, IsAbsentWithoutAnExpertSet) {
  AttemptReport report = test::MakeTaskReport();
  for (MetricRow& row : report.metrics) row.expert_mean.reset();
  EXPECT_FALSE(DrawRadar(report).has_value());
}

/// Of the group, on every axis, 1 to 3 deviations of the experts' mean beyond it.
AttemptReport MakeReportWithGroup() {
  AttemptReport report = test::MakeTaskReport();
  for (MetricRow& row : report.metrics) {
    if (!row.expert_mean) continue;
    row.expert_deviation = std::fabs(*row.expert_mean);
    const double worse = row.better == training::BetterWhen::kLower ? 1 : -1;
    row.group.clear();
    for (const double many : {1.0, 1.0, 2.0, 3.0, 3.0})
      row.group.push_back(*row.expert_mean + worse * many * *row.expert_deviation);
    std::sort(row.group.begin(), row.group.end());
  }
  return report;
}

TEST(Radar, DrawsTheGroupsMedianAndItsMiddleHalf) {
  const auto drawing = DrawRadar(MakeReportWithGroup());
  ASSERT_TRUE(drawing.has_value());
  ExpectInside(*drawing);
  const auto radius = [](Vec2 point) { return std::hypot(point.x - 232, point.y - 192); };
  int medians = 0, bands = 0;
  for (const Shape& shape : drawing->shapes) {
    const Line* line = std::get_if<Line>(&shape);
    if (line != nullptr && line->ink == Ink::kGroup && line->points.size() > 2) {
      ++medians;
      for (const Vec2 point : line->points) EXPECT_NEAR(radius(point), 112 * 2.0 / 6, 1e-6);
    }
    const Area* area = std::get_if<Area>(&shape);
    // at the right, and in the legend, the group is a rectangle
    if (area == nullptr || area->ink != Ink::kGroup || area->points.size() <= 5) continue;
    ++bands;
    EXPECT_NEAR(radius(area->points.front()), 112 * 3.0 / 6, 1e-6);
    EXPECT_NEAR(radius(area->points.back()), 112 * 1.0 / 6, 1e-6);
  }
  EXPECT_EQ(medians, 1);
  EXPECT_EQ(bands, 1);
}

TEST(Radar, LeavesOutAGroupThatLacksAnAxis) {
  AttemptReport report = MakeReportWithGroup();
  for (MetricRow& row : report.metrics) {
    if (row.group.empty()) continue;
    row.group.clear();
    break;
  }
  const auto drawing = DrawRadar(report);
  ASSERT_TRUE(drawing.has_value());
  for (const Shape& shape : drawing->shapes) {
    const Label* label = std::get_if<Label>(&shape);
    EXPECT_TRUE(label == nullptr || label->text.find("group") == std::string::npos) << label->text;
  }
}

TEST(Radar, LeavesOutWhatDoesNotSeparateLevels) {
  const auto drawing = DrawRadar(test::MakeTaskReport());
  ASSERT_TRUE(drawing.has_value());
  EXPECT_THAT(drawing->description, testing::Not(HasSubstr("Mean speed")));
}

TEST(LearningCurveChart, DrawsTheFittedCurveThroughItsValues) {
  const LearningCurve curve{"Peg transfer", "Time", "s", {120, 90, 80}, CurveFit{60, 60, 1}, 65.0};
  const Drawing drawing = DrawLearningCurve(curve);
  ExpectInside(drawing);
  EXPECT_EQ(CountMarks(drawing, Ink::kThis), 3u);
  const Line* fitted = nullptr;
  const Mark* first = nullptr;
  for (const Shape& shape : drawing.shapes) {
    if (const Line* line = std::get_if<Line>(&shape);
        line != nullptr && line->ink == Ink::kGood && line->points.size() > 2)
      fitted = line;
    if (const Mark* mark = std::get_if<Mark>(&shape); mark != nullptr && first == nullptr) first = mark;
  }
  ASSERT_NE(fitted, nullptr);
  ASSERT_NE(first, nullptr);
  // T(1) = 60 + 60, which is the first attempt's value
  EXPECT_NEAR(fitted->points.front().x, first->at.x, 1e-9);
  EXPECT_NEAR(fitted->points.front().y, first->at.y, 1e-9);
}

TEST(Charts, DrawNothingOfNothing) {
  const AttemptReport empty = MakeAttemptReport({}, {}, {{}, {}, {}});
  ExpectInside(DrawTimeline(empty));
  ExpectInside(DrawPaths(empty, PathView::kFromHead));
  ExpectInside(DrawLearningCurve({}));
  ExpectInside(DrawCusum({}));
  EXPECT_FALSE(FormatPdf(MakeDocument(empty)).empty());
}

TEST(FormatSvg, BreaksALineWhereAPointIsNotFinite) {
  Drawing drawing{"t", "d", 10, 10, {}};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  drawing.shapes.emplace_back(Line{{{0, 0}, {1, 1}, {nan, 1}, {3, 3}, {4, 4}}, Ink::kLeft, 1, Dash::kSolid});
  EXPECT_THAT(FormatSvg(drawing, "p"), HasSubstr("d=\"M0.0 0.0L1.0 1.0M3.0 3.0L4.0 4.0\""));
}

TEST(CutToWidth, CutsBetweenLetters) {
  EXPECT_EQ(CutToWidth("short", 10, 100), "short");
  const std::string cut = CutToWidth("Gallenblasen\xc3\xbc\xc3\xbc\xc3\xbc\xc3\xbc", 10, 80);
  EXPECT_LE(GuessTextWidth(cut, 10), 80);
  EXPECT_EQ(cut.substr(cut.size() - 3), "…");
  EXPECT_EQ(CutToWidth("Gallbladder", 10, 8), "");
}

TEST(FindTimeMarks, AreWholeSecondsAndMinutes) {
  EXPECT_THAT(FindTimeMarks(60, 4), ElementsAre(0, 15, 30, 45, 60));
  EXPECT_THAT(FindTimeMarks(1800, 6), ElementsAre(0, 300, 600, 900, 1200, 1500, 1800));
}

TEST(FindAxisMarks, AreRoundAndInside) {
  EXPECT_THAT(FindAxisMarks(0, 10, 5), ElementsAre(0, 2, 4, 6, 8, 10));
  EXPECT_THAT(FindAxisMarks(-0.5, 1.2, 4), ElementsAre(-0.5, 0, 0.5, 1.0));
  EXPECT_THAT(FindAxisMarks(93, 311, 4), ElementsAre(100, 200, 300));
}

TEST(FindLogMarks, ArePowersOfTenWithTwosAndFivesWhereTheyAreFew) {
  EXPECT_THAT(FindLogMarks(0.9, 1.1e4), ElementsAre(1, 10, 100, 1000, 10'000));
  EXPECT_THAT(FindLogMarks(3, 60), ElementsAre(5, 10, 20, 50));
}

TEST(ThinOut, KeepsEveryPeak) {
  std::vector<math::Vec2> points;
  for (int i = 0; i < 10'000; ++i)
    points.push_back({static_cast<double>(i), i == 4321 ? 7.0 : i == 8765 ? -3.0 : 1.0});
  const auto kept = ThinOut(points, 200);
  EXPECT_LE(kept.size(), 200u);
  EXPECT_TRUE(
      std::is_sorted(kept.begin(), kept.end(), [](const auto& a, const auto& b) { return a.x < b.x; }));
  const auto has = [&](double y) {
    return std::any_of(kept.begin(), kept.end(), [&](const math::Vec2& point) { return point.y == y; });
  };
  EXPECT_TRUE(has(7.0));
  EXPECT_TRUE(has(-3.0));
}

// WCAG 2.1, relative luminance and contrast ratio.
double CalcLuminance(std::uint32_t colour) {
  const auto channel = [&](int shift) {
    const double c = (colour >> shift & 0xff) / 255.0;
    return c <= 0.03928 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * channel(16) + 0.7152 * channel(8) + 0.0722 * channel(0);
}
double CalcContrast(std::uint32_t a, std::uint32_t b) {
  const double la = CalcLuminance(a), lb = CalcLuminance(b);
  return (std::max(la, lb) + 0.05) / (std::min(la, lb) + 0.05);
}

TEST(Palette, TextsAndMarksStandOutFromTheirGround) {
  EXPECT_NEAR(CalcContrast(0xffffff, 0x000000), 21, 1e-9);
  for (const bool is_dark : {false, true}) {
    const auto pick = [&](TwoColours colours) { return is_dark ? colours.dark : colours.light; };
    for (const Ink ink : {Ink::kText, Ink::kMuted, Ink::kThis, Ink::kGood, Ink::kMajor, Ink::kCritical}) {
      for (const TwoColours ground : {kPaper, kSoft, ColoursOf(Ink::kPanel)})
        EXPECT_GE(CalcContrast(pick(ColoursOf(ink)), pick(ground)), 4.5) << NameOf(ink) << is_dark;
    }
    for (const Ink ink : {Ink::kLeft, Ink::kRight, Ink::kExpert, Ink::kGroup, Ink::kMinor})
      EXPECT_GE(CalcContrast(pick(ColoursOf(ink)), pick(ColoursOf(Ink::kPanel))), 3.0)
          << NameOf(ink) << is_dark;
    for (const Ink ink : {Ink::kPhaseEven, Ink::kPhaseOdd})
      EXPECT_GE(CalcContrast(pick(ColoursOf(Ink::kText)), pick(ColoursOf(ink))), 4.5)
          << NameOf(ink) << is_dark;
  }
}

}  // namespace
}  // namespace trocar::report
