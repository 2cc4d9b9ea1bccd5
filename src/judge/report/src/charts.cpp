// SPDX-License-Identifier: Apache-2.0
#include "trocar/report/charts.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "plot_frame.h"
#include "trocar/host/text_table.h"
#include "trocar/host/translate.h"

namespace trocar::report {

using math::Vec2;

namespace {

constexpr double kWideWidth = 960;  // of a drawing that stands alone [px]
constexpr double kWidth = 470;      // of drawings that stand side by side [px]
constexpr std::size_t kMostAxes = 8, kFewestAxes = 3;
// standard deviations of the expert set at the centre and at the rim of a radar
constexpr double kWorst = -4, kBest = 2;
// a set that agrees to a hair must not decide everything: share of the mean
constexpr double kLeastDeviation = 0.05;
constexpr Vec2 kRadarCentre = {232, 192};
constexpr double kRadarRadius = 112, kRadarText = 120;  // [px]
constexpr const char* kHands[] = {host::Mark("left hand"), host::Mark("right hand")};
constexpr Ink kHandInks[] = {Ink::kLeft, Ink::kRight};

/// How far from the experts, better positive [standard deviations].
double CalcDeviation(const MetricRow& row, double value) {
  const double mean = *row.expert_mean;
  const double deviation =
      std::max({row.expert_deviation.value_or(0), kLeastDeviation * std::fabs(mean), 1e-12});
  const double sign = row.better == training::BetterWhen::kLower ? -1 : 1;
  return std::clamp(sign * (value - mean) / deviation, kWorst, kBest);
}

/// Between the two values about it, so that it is seldom one person's. \param ascending  not empty
double CalcQuantile(const std::vector<double>& ascending, double share) {
  const double place = share * static_cast<double>(ascending.size() - 1);
  const auto below = static_cast<std::size_t>(place), above = std::min(below + 1, ascending.size() - 1);
  return std::lerp(ascending[below], ascending[above], place - static_cast<double>(below));
}

std::vector<const MetricRow*> ChooseAxes(const AttemptReport& report) {
  std::vector<const MetricRow*> axes;
  for (const MetricRow& row : report.metrics) {
    if (!row.expert_mean || !row.phase.empty() || !row.tool.empty() || row.separates == false ||
        row.better == training::BetterWhen::kNeither)
      continue;
    axes.push_back(&row);
    if (axes.size() == kMostAxes) break;
  }
  return axes;
}

struct RadarShape {
  Vec2 centre;
  double radius = 0;
  std::size_t axes = 0;

  Vec2 At(std::size_t axis, double deviation) const {
    const double angle = 2 * std::numbers::pi * static_cast<double>(axis) / static_cast<double>(axes);
    const double r = radius * (deviation - kWorst) / (kBest - kWorst);
    return {centre.x + r * std::sin(angle), centre.y - r * std::cos(angle)};
  }
  std::vector<Vec2> Ring(double deviation) const {
    std::vector<Vec2> ring;
    for (std::size_t i = 0; i <= axes; ++i) ring.push_back(At(i % axes, deviation));
    return ring;
  }
};

/// "left hand: 3829 mm"
std::string ValueText(const MetricRow& row) {
  return (row.hand.empty() ? "" : host::Translate(row.hand) + ": ") + FormatShown(row.value) +
         (row.unit.empty() ? "" : " " + row.unit);
}

/// A long name in two lines, parted at the space nearest to its middle.
std::vector<std::string> PartName(const std::string& name) {
  constexpr std::size_t kOneLine = 16;
  std::size_t best = std::string::npos;
  const auto off = [&](std::size_t at) { return std::max(at, name.size() - at) - name.size() / 2; };
  for (std::size_t at = name.find(' '); at != std::string::npos; at = name.find(' ', at + 1)) {
    if (best == std::string::npos || off(at) < off(best)) best = at;
  }
  if (name.size() <= kOneLine || best == std::string::npos) return {name};
  return {name.substr(0, best), name.substr(best + 1)};
}

void AddAxisName(Drawing& drawing, const RadarShape& radar, std::size_t axis, const MetricRow& row) {
  const Vec2 end = radar.At(axis, kBest), name = radar.At(axis, kBest + 0.45);
  drawing.shapes.emplace_back(Line{{radar.centre, end}, Ink::kGrid, 1});
  const double side = name.x - radar.centre.x;
  const Anchor anchor = std::fabs(side) < 8 ? Anchor::kMiddle : side > 0 ? Anchor::kStart : Anchor::kEnd;
  std::vector<std::string> lines = PartName(host::Translate(row.name));
  lines.push_back(ValueText(row));
  // above the rim, below it, or about its height
  constexpr double kLine = 13;
  const auto count = static_cast<double>(lines.size());
  double y = name.y < radar.centre.y - 8   ? name.y - kLine * (count - 1)
             : name.y > radar.centre.y + 8 ? name.y + 8
                                           : name.y - kLine * (count - 2) / 2;
  for (const std::string& line : lines) {
    const bool is_value = &line == &lines.back();
    drawing.shapes.emplace_back(Label{
        {name.x, y}, CutToWidth(line, 10.5, kRadarText), is_value ? Ink::kMuted : Ink::kText, anchor, 10.5});
    y += kLine;
  }
}

/// The same numbers on straight lines below one another.
void AddDeviations(Drawing& drawing, const std::vector<const MetricRow*>& axes) {
  PlotFrame frame;
  frame.left = 690, frame.top = 34, frame.width = 250, frame.height = 288;
  frame.x.Add(kWorst), frame.x.Add(kBest);
  frame.y.Add(0), frame.y.Add(static_cast<double>(axes.size()));
  frame.AddGround(drawing);
  frame.AddXAxis(drawing, 6, host::Translate("SD from the experts' mean; right is better"));
  drawing.shapes.emplace_back(
      Line{{frame.Map({0, frame.y.low}), frame.Map({0, frame.y.high})}, Ink::kExpert, 1.6, Dash::kDashed});
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const MetricRow& row = *axes[i];
    const double y = frame.y.high - 0.5 - static_cast<double>(i);
    if (!row.group.empty()) {
      const auto at = [&](double share) { return CalcDeviation(row, CalcQuantile(row.group, share)); };
      const double low = std::min(at(0.25), at(0.75)), high = std::max(at(0.25), at(0.75));
      const Vec2 from = frame.Map({low, y + 0.18}), to = frame.Map({high, y - 0.18});
      drawing.shapes.emplace_back(
          Area{MakeRectangle(from.x, from.y, std::max(to.x - from.x, 1.0), to.y - from.y), Ink::kGroup, 0.35,
               host::Translate("Middle half of the group")});
      const double median = frame.Map({at(0.5), y}).x;
      drawing.shapes.emplace_back(Line{{{median, from.y}, {median, to.y}}, Ink::kGroup, 2});
    }
    const Vec2 here = frame.Map({CalcDeviation(row, row.value), y});
    drawing.shapes.emplace_back(
        Mark{here, MarkKind::kDot, Ink::kThis, 4.5, host::Translate(row.name) + ", " + ValueText(row)});
    const std::string name =
        host::Translate(row.name) + (row.hand.empty() ? "" : ", " + host::Translate(row.hand));
    drawing.shapes.emplace_back(
        Label{{frame.left - 8, here.y + 4}, CutToWidth(name, 11, 200), Ink::kText, Anchor::kEnd, 11});
  }
}

bool HasGroup(const std::vector<const MetricRow*>& axes) {
  return std::all_of(axes.begin(), axes.end(), [](const MetricRow* row) { return !row->group.empty(); });
}

/// The middle half of the group as a ring of two edges, and the median as a line.
void AddGroup(Drawing& drawing, const RadarShape& radar, const std::vector<const MetricRow*>& axes) {
  std::vector<Vec2> outer, inner, median;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto at = [&](double share) {
      return CalcDeviation(*axes[i], CalcQuantile(axes[i]->group, share));
    };
    const double a = at(0.25), b = at(0.75);
    outer.push_back(radar.At(i, std::max(a, b)));
    inner.push_back(radar.At(i, std::min(a, b)));
    median.push_back(radar.At(i, at(0.5)));
  }
  // outwards around, then back around the hole
  std::vector<Vec2> band = outer;
  band.push_back(outer.front());
  band.push_back(inner.front());
  band.insert(band.end(), inner.rbegin(), inner.rend());
  drawing.shapes.emplace_back(Area{band, Ink::kGroup, 0.3, host::Translate("Middle half of the group")});
  median.push_back(median.front());
  drawing.shapes.emplace_back(Line{median, Ink::kGroup, 1.6});
}

}  // namespace

Drawing DrawPaths(const AttemptReport& report, PathView view) {
  const bool is_front = view == PathView::kFromFront;
  Drawing drawing;
  drawing.title = is_front ? host::Translate("Path of the tips, seen from the front")
                           : host::Translate("Path of the tips, seen from the head");
  drawing.description =
      is_front
          ? host::Translate("The way of both instrument tips in millimetres, across and along the body.")
          : host::Translate(
                "The way of both instrument tips in millimetres, across the body and from back to front.");
  drawing.width = kWidth;
  drawing.height = 392;
  PlotFrame frame;
  frame.left = 58, frame.top = 28, frame.width = kWidth - 72, frame.height = 316;
  for (const HandSeries& hand : report.hands) {
    for (const Vec2& point : is_front ? hand.from_front : hand.from_head) {
      frame.x.Add(point.x);
      frame.y.Add(point.y);
    }
  }
  frame.x.Settle(0.04);
  frame.y.Settle(0.04);
  frame.MakeEqual();
  frame.AddGround(drawing);
  frame.AddXAxis(drawing, 6, host::Translate("towards the patient's left [mm]"));
  frame.AddYAxis(
      drawing, 6,
      is_front ? host::Translate("towards the head [mm]") : host::Translate("towards the front [mm]"));
  for (std::size_t h = 0; h < report.hands.size(); ++h) {
    const auto points = frame.Map(is_front ? report.hands[h].from_front : report.hands[h].from_head);
    if (points.empty()) continue;
    drawing.shapes.emplace_back(Line{points, kHandInks[h], 0.9});
    drawing.shapes.emplace_back(Mark{points.front(), MarkKind::kDot, kHandInks[h], 4.5,
                                     host::TranslateWith("Start of the {1}", {host::Translate(kHands[h])})});
    drawing.shapes.emplace_back(Mark{points.back(), MarkKind::kSquare, kHandInks[h], 4.5,
                                     host::TranslateWith("End of the {1}", {host::Translate(kHands[h])})});
  }
  AddLegend(drawing, frame.left, 16,
            {{host::Translate("left hand"), Ink::kLeft}, {host::Translate("right hand"), Ink::kRight}});
  drawing.shapes.emplace_back(
      Label{{frame.Right(), 16}, host::Translate("● start   ■ end"), Ink::kMuted, Anchor::kEnd, 10.5});
  return drawing;
}

std::optional<Drawing> DrawRadar(const AttemptReport& report) {
  const std::vector<const MetricRow*> axes = ChooseAxes(report);
  if (axes.size() < kFewestAxes) return std::nullopt;
  Drawing drawing;
  drawing.title = host::Translate("Compared with the expert set");
  drawing.width = kWideWidth;
  drawing.height = 392;
  const RadarShape radar{kRadarCentre, kRadarRadius, axes.size()};
  drawing.shapes.emplace_back(Area{radar.Ring(kBest), Ink::kPanel, 1, ""});
  for (const double ring : {-2.0, kBest}) drawing.shapes.emplace_back(Line{radar.Ring(ring), Ink::kGrid, 1});
  const bool has_group = HasGroup(axes);
  if (has_group) AddGroup(drawing, radar, axes);
  drawing.shapes.emplace_back(Line{radar.Ring(0), Ink::kExpert, 1.6, Dash::kDashed});
  std::vector<Vec2> outline;
  std::string values;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    AddAxisName(drawing, radar, i, *axes[i]);
    const double deviation = CalcDeviation(*axes[i], axes[i]->value);
    outline.push_back(radar.At(i, deviation));
    values += (i == 0 ? "" : "; ") + host::Translate(axes[i]->name) +
              (axes[i]->hand.empty() ? "" : ", " + host::Translate(axes[i]->hand)) + ": " +
              FormatDigits(deviation, 2);
  }
  outline.push_back(outline.front());
  drawing.shapes.emplace_back(Area{outline, Ink::kThis, 0.16, ""});
  drawing.shapes.emplace_back(Line{outline, Ink::kThis, 2});
  for (std::size_t i = 0; i < axes.size(); ++i)
    drawing.shapes.emplace_back(
        Mark{outline[i], MarkKind::kDot, Ink::kThis, 3.5,
             host::Translate(axes[i]->name) + ": " + FormatShown(axes[i]->value) + " " + axes[i]->unit});
  std::vector<LegendEntry> legend = {{host::Translate("this attempt"), Ink::kThis},
                                     {host::Translate("experts' mean"), Ink::kExpert, Dash::kDashed}};
  if (has_group)
    legend.push_back({host::Translate("group: middle half, median"), Ink::kGroup, Dash::kSolid, true});
  AddDeviations(drawing, axes);
  AddLegend(drawing, 60, 384, legend);
  drawing.description = host::TranslateWith(
      "Standard deviations from the expert set's mean, better is further out; rings at -2, 0 and +2. {1}.",
      {values});
  return drawing;
}

Drawing DrawLearningCurve(const LearningCurve& curve) {
  Drawing drawing;
  drawing.title = curve.task + ": " + curve.measure;
  drawing.width = kWidth;
  drawing.height = 272;
  PlotFrame frame;
  frame.left = 58, frame.top = 28, frame.width = kWidth - 72, frame.height = 196;
  const auto attempts = static_cast<double>(curve.values.size());
  std::vector<Vec2> points, fitted;
  for (std::size_t i = 0; i < curve.values.size(); ++i) {
    points.push_back({static_cast<double>(i + 1), curve.values[i]});
    frame.y.Add(curve.values[i]);
  }
  if (curve.fit) {
    for (double n = 1; n <= attempts + 1e-9; n += std::max(0.05, attempts / 200))
      fitted.push_back({n, curve.fit->plateau + curve.fit->gain * std::pow(n, -curve.fit->rate)});
    for (const Vec2& point : fitted) frame.y.Add(point.y);
  }
  if (curve.expert_mean) frame.y.Add(*curve.expert_mean);
  frame.y.Add(0);
  frame.y.Settle(0.06);
  frame.x.Add(0.5);
  frame.x.Add(std::max(attempts, 1.0) + 0.5);
  frame.AddGround(drawing);
  frame.AddXAxis(drawing, static_cast<int>(std::clamp(attempts, 2.0, 10.0)), host::Translate("attempt"));
  frame.AddYAxis(drawing, 5, curve.measure + (curve.unit.empty() ? "" : " [" + curve.unit + "]"));
  std::vector<LegendEntry> legend = {{host::Translate("attempts"), Ink::kThis}};
  if (curve.expert_mean) {
    const auto& mean = *curve.expert_mean;
    drawing.shapes.emplace_back(Line{frame.Map(std::vector<Vec2>{{frame.x.low, mean}, {frame.x.high, mean}}),
                                     Ink::kExpert, 1.6, Dash::kDashed});
    legend.push_back({host::Translate("experts' mean"), Ink::kExpert, Dash::kDashed});
  }
  if (curve.fit) {
    drawing.shapes.emplace_back(Line{frame.Map(fitted), Ink::kGood, 2});
    legend.push_back({host::Translate("fitted curve"), Ink::kGood});
  }
  drawing.shapes.emplace_back(Line{frame.Map(points), Ink::kThis, 1, Dash::kDotted});
  for (const Vec2& point : points)
    drawing.shapes.emplace_back(
        Mark{frame.Map(point), MarkKind::kDot, Ink::kThis, 3.6,
             host::TranslateWith("Attempt {1}: {2} {3}",
                                 {FormatDigits(point.x), FormatShown(point.y), curve.unit})});
  AddLegend(drawing, frame.left, 16, legend);
  drawing.description =
      host::TranslateWith("{1} of {2} attempts", {curve.measure, std::to_string(curve.values.size())});
  if (!curve.values.empty())
    drawing.description += host::TranslateWith(
        ", from {1} to {2} {3}",
        {FormatShown(curve.values.front()), FormatShown(curve.values.back()), curve.unit});
  if (curve.fit) {
    drawing.description += host::TranslateWith(". The fitted curve leads to {1} {2}",
                                               {FormatShown(curve.fit->plateau), curve.unit});
  }
  drawing.description += ".";
  return drawing;
}

Drawing DrawCusum(const CusumChart& chart) {
  Drawing drawing;
  drawing.title = chart.task + ": CUSUM";
  drawing.description = host::TranslateWith(
      "Cumulative sum of failures: up with a failure, down with a success; limits at {1} and {2}. {3}",
      {FormatDigits(chart.lower, 3), FormatDigits(chart.upper, 3), chart.verdict});
  drawing.width = kWidth;
  drawing.height = 272;
  PlotFrame frame;
  frame.left = 58, frame.top = 28, frame.width = kWidth - 72, frame.height = 196;
  std::vector<Vec2> points = {{0, 0}};
  for (std::size_t i = 0; i < chart.values.size(); ++i)
    points.push_back({static_cast<double>(i + 1), chart.values[i]});
  for (const Vec2& point : points) frame.y.Add(point.y);
  frame.y.Add(chart.lower);
  frame.y.Add(chart.upper);
  frame.y.Settle(0.08);
  frame.x.Add(0);
  frame.x.Add(std::max(1.0, static_cast<double>(chart.values.size())));
  frame.AddGround(drawing);
  frame.AddXAxis(drawing, static_cast<int>(std::clamp<std::size_t>(chart.values.size(), 2, 10)),
                 host::Translate("attempt"));
  frame.AddYAxis(drawing, 5, host::Translate("cumulative sum"));
  for (const auto& [limit, ink] :
       {std::pair{chart.lower, Ink::kGood}, std::pair{chart.upper, Ink::kCritical}}) {
    drawing.shapes.emplace_back(Line{
        frame.Map(std::vector<Vec2>{{frame.x.low, limit}, {frame.x.high, limit}}), ink, 1.4, Dash::kDashed});
  }
  drawing.shapes.emplace_back(Line{frame.Map(points), Ink::kThis, 2});
  for (std::size_t i = 1; i < points.size(); ++i)
    drawing.shapes.emplace_back(Mark{
        frame.Map(points[i]), MarkKind::kDot, Ink::kThis, 3.2,
        host::TranslateWith("After attempt {1}: {2}", {std::to_string(i), FormatDigits(points[i].y, 3)})});
  AddLegend(drawing, frame.left, 16,
            {{host::Translate("sum"), Ink::kThis},
             {host::Translate("acceptable below"), Ink::kGood, Dash::kDashed},
             {host::Translate("not above"), Ink::kCritical, Dash::kDashed}});
  return drawing;
}

}  // namespace trocar::report
