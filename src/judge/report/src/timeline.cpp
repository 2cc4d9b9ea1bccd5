// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "plot_frame.h"
#include "trocar/host/text_table.h"
#include "trocar/host/translate.h"
#include "trocar/report/charts.h"
#include "trocar/training/metric_settings.h"

namespace trocar::report {

using math::Vec2;

namespace {

constexpr double kWidth = 960, kLabelRoom = 112, kRightRoom = 22;  // [px]
constexpr double kPhaseHeight = 24, kLaneHeight = 18, kForceHeight = 74, kGap = 12;
constexpr double kViewLabel = 16;  // its base line, where there is a critical view

struct Lane {
  surgery::Severity severity;
  const char* name;
  Ink ink;
  MarkKind kind;
};
constexpr std::array<Lane, 3> kLanes = {
    {{surgery::Severity::kCritical, host::Mark("Critical errors"), Ink::kCritical, MarkKind::kDiamond},
     {surgery::Severity::kMajor, host::Mark("Major errors"), Ink::kMajor, MarkKind::kTriangle},
     {surgery::Severity::kMinor, host::Mark("Minor errors"), Ink::kMinor, MarkKind::kDot}}};

void AddRowName(Drawing& drawing, double middle, const std::string& name) {
  drawing.shapes.emplace_back(Label{{kLabelRoom - 34, middle + 4}, name, Ink::kMuted, Anchor::kEnd, 11});
}

void AddPhases(Drawing& drawing, const AttemptReport& report, const PlotFrame& frame) {
  AddRowName(drawing, frame.top + frame.height / 2, host::Translate("Phases"));
  bool is_odd = false;
  for (const training::PhaseSpan& phase : report.phases) {
    const double from = frame.Map({phase.start, 0}).x, to = frame.Map({phase.end, 0}).x;
    const std::string name = PhaseName(phase.name);
    drawing.shapes.emplace_back(Area{
        MakeRectangle(from, frame.top, std::max(to - from - 1, 0.5), frame.height),
        is_odd ? Ink::kPhaseOdd : Ink::kPhaseEven, 1,
        host::TranslateWith("{1}, {2} to {3}", {name, FormatClock(phase.start), FormatClock(phase.end)})});
    if (const std::string shown = CutToWidth(name, 10.5, to - from - 10); !shown.empty()) {
      drawing.shapes.emplace_back(
          Label{{from + 5, frame.top + frame.height / 2 + 4}, shown, Ink::kText, Anchor::kStart, 10.5});
    }
    is_odd = !is_odd;
  }
}

double AddErrors(Drawing& drawing, const AttemptReport& report, PlotFrame lane) {
  for (const Lane& kind : kLanes) {
    lane.AddGround(drawing);
    AddRowName(drawing, lane.top + lane.height / 2, host::Translate(kind.name));
    for (const ErrorRow& error : report.errors) {
      if (error.severity != kind.severity) continue;
      const double at = lane.Map({error.time, 0}).x;
      drawing.shapes.emplace_back(Mark{{at, lane.top + lane.height / 2},
                                       kind.kind,
                                       kind.ink,
                                       4.6,
                                       FormatClock(error.time) + " " + host::TranslateComposed(error.what)});
    }
    lane.top += kLaneHeight + 2;
  }
  return lane.top;
}

void AddForce(Drawing& drawing, const AttemptReport& report, std::size_t hand, const PlotFrame& frame) {
  frame.AddGround(drawing);
  frame.AddYAxis(drawing, 3, "");
  AddRowName(drawing, frame.top + frame.height / 2 - 7,
             hand == 0 ? host::Translate("Left hand") : host::Translate("Right hand"));
  AddRowName(drawing, frame.top + frame.height / 2 + 7, host::Translate("force [N]"));
  const double threshold = training::MetricSettings().force_threshold;
  if (threshold < frame.y.high) {
    drawing.shapes.emplace_back(
        Line{frame.Map(std::vector<Vec2>{{frame.x.low, threshold}, {frame.x.high, threshold}}), Ink::kMajor,
             1.2, Dash::kDashed});
  }
  for (const ErrorRow& error : report.errors) {
    if (error.severity == surgery::Severity::kMinor) continue;
    drawing.shapes.emplace_back(Line{
        frame.Map(std::vector<Vec2>{{error.time, frame.y.low}, {error.time, frame.y.high}}),
        error.severity == surgery::Severity::kCritical ? Ink::kCritical : Ink::kMajor, 0.8, Dash::kDotted});
  }
  drawing.shapes.emplace_back(
      Line{frame.Map(report.hands[hand].force), hand == 0 ? Ink::kLeft : Ink::kRight, 1.3});
}

std::string DescribeTimeline(const AttemptReport& report, double peak) {
  std::string text = host::TranslateWith("Over {1}: ", {FormatDuration(report.seconds)});
  if (!report.phases.empty())
    text += host::TranslateWith("{1} stretches of phases, ", {std::to_string(report.phases.size())});
  text += host::TranslateCount("{1} error", "{1} errors", report.errors.size());
  return host::TranslateWith(
      "{1}, and the force of the tissue on each instrument, at most {2} newtons. The tables say the same in "
      "words.",
      {text, FormatDigits(peak, 3)});
}

}  // namespace

Drawing DrawTimeline(const AttemptReport& report) {
  Drawing drawing;
  drawing.title = host::Translate("Time line");
  drawing.width = kWidth;
  double peak = 0;
  for (const HandSeries& hand : report.hands) {
    for (const Vec2& point : hand.force) peak = std::max(peak, point.y);
  }
  PlotFrame frame;
  frame.left = kLabelRoom;
  frame.width = kWidth - kLabelRoom - kRightRoom;
  frame.x.Add(0);
  frame.x.Add(std::max(report.seconds, 1e-3));
  frame.y.Add(0);
  frame.y.Add(std::max(1.08 * peak, 0.5));
  double top = report.critical_view_time ? kViewLabel + 4 : 4;
  if (!report.phases.empty()) {
    frame.top = top;
    frame.height = kPhaseHeight;
    AddPhases(drawing, report, frame);
    top += kPhaseHeight + kGap;
  }
  if (!report.errors.empty()) {
    frame.top = top;
    frame.height = kLaneHeight;
    top = AddErrors(drawing, report, frame) + kGap;
  }
  for (std::size_t hand = 0; hand < report.hands.size(); ++hand) {
    frame.top = top;
    frame.height = kForceHeight;
    AddForce(drawing, report, hand, frame);
    top += kForceHeight + kGap;
  }
  // marks below the last panel, and the moment of the critical view through all
  frame.AddXAxis(drawing, 10, host::Translate("time [min:s]"), true);
  if (report.critical_view_time) {
    const double at = frame.Map({*report.critical_view_time, 0}).x;
    drawing.shapes.emplace_back(
        Line{{{at, kViewLabel}, {at, frame.Bottom()}}, Ink::kGood, 1.6, Dash::kDashed});
    drawing.shapes.emplace_back(Label{{std::clamp(at, kLabelRoom + 60, kWidth - 80), kViewLabel - 3},
                                      host::Translate("critical view of safety"),
                                      Ink::kGood,
                                      Anchor::kMiddle,
                                      10.5,
                                      true});
  }
  drawing.height = frame.Bottom() + 40;
  drawing.description = DescribeTimeline(report, peak);
  return drawing;
}

}  // namespace trocar::report
