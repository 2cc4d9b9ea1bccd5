// SPDX-License-Identifier: Apache-2.0
#include "report.h"

#include <algorithm>

#include "console.h"
#include "metric_text.h"
#include "trocar/bench/svg_plot.h"
#include "trocar/core/markup.h"
#include "trocar/training/metric_definition.h"

namespace trocar::cli {
namespace {

using core::EscapeMarkup;

constexpr const char* kStyle = R"(
:root { color-scheme: light; }
body { font: 16px/1.5 system-ui, "DejaVu Sans", sans-serif; color: #1d2327; background: #fff; margin: 0 auto;
  max-width: 68rem; padding: 1.5rem; }
h1 { font-size: 1.7rem; margin: 0; } h2 { font-size: 1.2rem; margin: 2rem 0 .5rem; }
.note { background: #fff6e0; border-left: .3rem solid #e69f00; padding: .5rem 1rem; }
.strip { display: grid; grid-template-columns: repeat(auto-fill, minmax(19rem, 1fr)); gap: .75rem; }
figure { margin: 0; } figure img, video { width: 100%; border-radius: .3rem; background: #000; display: block; }
figcaption { font-size: .85rem; color: #50575e; padding: .2rem 0; }
table { border-collapse: collapse; width: 100%; font-size: .9rem; }
th, td { text-align: left; padding: .3rem .6rem; border-bottom: 1px solid #dcdcde; vertical-align: top; }
td.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(28rem, 1fr)); gap: 1rem; }
svg { width: 100%; height: auto; background: #fafafa; border: 1px solid #dcdcde; }
svg text { font: 12px system-ui, "DejaVu Sans", sans-serif; fill: #1d2327; }
svg .title { font-size: 14px; font-weight: 600; } svg .mark { font-size: 11px; fill: #50575e; }
svg .grid { stroke: #dcdcde; } svg .line { fill: none; stroke-width: 1.8; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .1rem 1rem; } dd { margin: 0; }
dt { color: #50575e; } code { font-size: .9em; }
@media print { body { max-width: none; } }
)";

std::string CellText(const std::string& value) {
  return value.empty() ? "&ndash;" : EscapeMarkup(value);
}

/// Unit, which way is better, and what it is.
std::string FormatMeaning(const training::MetricDefinition& d) {
  const bool is_neither = d.better == training::BetterWhen::kNeither;
  return "<td>" + EscapeMarkup(d.shown_unit) + "</td><td>" +
         (is_neither ? std::string() : std::string(NameOf(d.better))) + "</td><td>" + EscapeMarkup(d.about) +
         " <small>(" + EscapeMarkup(d.source) + ")</small></td></tr>\n";
}

/// Rows of one kind: of each hand, or of the attempt and the camera.
std::string FormatMetricsTable(const training::AttemptMetrics& metrics, bool per_hand) {
  std::string table = "<table>\n<tr><th>Measure</th>";
  table += per_hand ? "<th>left</th><th>right</th>" : "<th>Value</th>";
  table += "<th>Unit</th><th>Better when</th><th>What it is</th></tr>\n";
  for (const MetricRow& row : MakeMetricRows(metrics, {}, {}, true)) {
    const training::MetricDefinition& d = *row.definition;
    const bool is_of_hands = std::find(d.of.begin(), d.of.end(), "hand") != d.of.end();
    const bool is_of_others = d.of.size() > 1 || !is_of_hands;
    if (per_hand ? !is_of_hands || d.id == "time" : !is_of_others) continue;
    table += "<tr><td>" + EscapeMarkup(per_hand ? d.name : NameOfOther(d)) + "</td>";
    const auto add = [&](const std::string& value) {
      table += "<td class=\"number\">" + CellText(value) + "</td>";
    };
    if (per_hand) {
      add(row.left);
      add(row.right);
    } else {
      add(row.other);
    }
    table += FormatMeaning(d);
  }
  return table + "</table>\n";
}

std::string FormatPictures(const ReportContent& content) {
  std::string html = "<div class=\"strip\">\n";
  for (const ReportPicture& picture : content.pictures) {
    html += "<figure><img alt=\"" + EscapeMarkup(picture.caption) + "\" src=\"data:image/png;base64," +
            EncodeBase64(picture.png) + "\"><figcaption>" + EscapeMarkup(picture.caption) +
            "</figcaption></figure>\n";
  }
  return html + "</div>\n";
}

std::string FormatPlots(const ReportContent& content) {
  std::vector<bench::PlotLine> force, frontal, sagittal;
  for (const ReportHand& hand : content.hands) {
    bench::PlotLine over_time{hand.name, {}}, from_front{hand.name, {}}, from_left{hand.name, {}};
    for (std::size_t i = 0; i < hand.force.size(); ++i)
      over_time.points.push_back({content.times[i], hand.force[i]});
    for (const math::Vec3& tip : hand.p_world_tip) {
      // as the surgeon looks at the patient: the patient's left is at the right of the plot
      from_front.points.push_back({1e3 * tip.x, 1e3 * tip.y});
      from_left.points.push_back({1e3 * tip.z, 1e3 * tip.y});
    }
    force.push_back(std::move(over_time));
    frontal.push_back(std::move(from_front));
    sagittal.push_back(std::move(from_left));
  }
  std::string html = bench::FormatSvgPlot(
      {"Force of the tissue on each instrument", "time [s]", "force [N]", false, 1060, 280}, force);
  html += "<div class=\"plots\">\n";
  html += bench::FormatSvgPlot({"Path of the tips, from the front", "towards the patient's left [mm]",
                                "towards the head [mm]", true, 520, 420},
                               frontal);
  html += bench::FormatSvgPlot({"Path of the tips, from the side", "towards the front of the body [mm]",
                                "towards the head [mm]", true, 520, 420},
                               sagittal);
  return html + "</div>\n";
}

std::string FormatFacts(const ReportContent& content) {
  const auto fact = [](std::string_view name, std::string_view value) {
    return "<dt>" + EscapeMarkup(name) + "</dt><dd>" + EscapeMarkup(value) + "</dd>\n";
  };
  return "<dl>\n" + fact("Scene", content.scene) + fact("Patient", content.patient) +
         fact("Ticks", std::to_string(content.ticks) + " of " + FormatNumber(1e3 * content.tick_seconds) +
                           " ms, " + FormatNumber(static_cast<double>(content.ticks) * content.tick_seconds) +
                           " s in all") +
         fact("Seed", std::to_string(content.seed)) + fact("State hash", content.hash) +
         fact("Program", "Trocar " + content.version) +
         fact("Where the patient comes from", content.provenance) + "</dl>\n";
}

std::string FormatHaptics(const ReportContent& content) {
  if (content.haptics.empty()) return "<p>No haptic device took part.</p>\n";
  std::string html = "<dl>\n";
  for (const auto& [what, how] : content.haptics)
    html += "<dt>" + EscapeMarkup(what) + "</dt><dd>" + EscapeMarkup(how) + "</dd>\n";
  return html + "</dl>\n";
}

}  // namespace

std::string EncodeBase64(std::string_view bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  const auto byte = [&](std::size_t i) {
    return i < bytes.size() ? static_cast<unsigned>(static_cast<unsigned char>(bytes[i])) : 0u;
  };
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const unsigned word = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    text += kDigits[word >> 18];
    text += kDigits[word >> 12 & 63];
    text += i + 1 < bytes.size() ? kDigits[word >> 6 & 63] : '=';
    text += i + 2 < bytes.size() ? kDigits[word & 63] : '=';
  }
  return text;
}

std::string FormatReportPage(const ReportContent& content) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
      EscapeMarkup(content.scene) + " - Trocar</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n";
  html += "<h1>" + EscapeMarkup(content.scene) +
          "</h1>\n<p>Played by Trocar, an open laparoscopic surgery simulator.</p>\n";
  html += "<p class=\"note\">This is " + EscapeMarkup(training::MetricsDisclaimer()) + ".</p>\n";
  html += "<h2>What was seen</h2>\n";
  if (!content.video.empty()) {
    html += "<figure><video controls preload=\"metadata\" src=\"" + EscapeMarkup(content.video) +
            "\"></video><figcaption><a href=\"" + EscapeMarkup(content.video) + "\">" +
            EscapeMarkup(content.video) + "</a></figcaption></figure>\n";
  }
  html += FormatPictures(content);
  html += "<h2>Force and path</h2>\n" + FormatPlots(content);
  html += "<h2>Of each instrument</h2>\n" + FormatMetricsTable(content.metrics, true);
  html += "<h2>Of the attempt</h2>\n" + FormatMetricsTable(content.metrics, false);
  html +=
      "<p>All numbers: <a href=\"metrics.json\">metrics.json</a>. A dash stands where a measure has no "
      "meaning for "
      "this recording.</p>\n";
  html += "<h2>Force feedback</h2>\n" + FormatHaptics(content);
  html += "<h2>What was played</h2>\n" + FormatFacts(content);
  return html + "</body>\n</html>\n";
}

}  // namespace trocar::cli
