// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "console.h"
#include "physics_checks.h"
#include "trocar/core/version.h"

namespace trocar::cli {
namespace {

constexpr const char* kStyle = R"(
body { font: 16px/1.5 system-ui, "DejaVu Sans", sans-serif; color: #1d2327; background: #fff; margin: 0 auto;
  max-width: 60rem; padding: 1.5rem; }
h1 { font-size: 1.7rem; margin: 0; } h2 { font-size: 1.2rem; margin: 2.2rem 0 .3rem; }
table { border-collapse: collapse; width: 100%; font-size: .9rem; margin: .5rem 0; }
th, td { text-align: left; padding: .3rem .6rem; border-bottom: 1px solid #dcdcde; }
td.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.pass { color: #00693e; } .fail { color: #a4161a; font-weight: 600; } .limit { color: #8a5a00; }
svg { width: 100%; height: auto; background: #fafafa; border: 1px solid #dcdcde; }
svg text { font: 12px system-ui, "DejaVu Sans", sans-serif; fill: #1d2327; }
svg .title { font-size: 14px; font-weight: 600; } svg .mark { font-size: 11px; fill: #50575e; }
svg .grid { stroke: #dcdcde; } svg .line { fill: none; stroke-width: 1.8; }
)";

std::string FormatBounds(const CheckFigure& figure) {
  const bool has_low = std::isfinite(figure.low) && figure.low != 0.0, has_high = std::isfinite(figure.high);
  const std::string high = FormatNumber(figure.high);
  if (has_low && has_high) return FormatNumber(figure.low) + " to " + high;
  return has_high ? "at most " + high : has_low ? "at least " + FormatNumber(figure.low) : "";
}

std::string FormatVerdict(const CheckFigure& figure) {
  if (figure.Passes()) return "<td class=\"pass\">passes</td>";
  return figure.is_known_limit ? "<td class=\"limit\">does not hold (a known limit)</td>"
                               : "<td class=\"fail\">FAILS</td>";
}

}  // namespace

int CountFailures(const std::vector<PhysicsCheck>& checks) {
  int failures = 0;
  for (const PhysicsCheck& check : checks) {
    for (const CheckFigure& figure : check.figures) failures += !figure.Passes() && !figure.is_known_limit;
  }
  return failures;
}

std::string FormatReportCard(const std::vector<PhysicsCheck>& checks, const std::string& machine) {
  int figures = 0, passed = 0;
  for (const PhysicsCheck& check : checks) {
    for (const CheckFigure& figure : check.figures) ++figures, passed += figure.Passes();
  }
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>Physics report card - "
      "Trocar</title>\n<style>" +
      std::string(kStyle) + "</style>\n</head>\n<body>\n<h1>Physics report card</h1>\n<p>" +
      std::to_string(passed) + " of " + std::to_string(figures) + " figures hold. Trocar " +
      EscapeMarkup(core::VersionText()) + ", " + EscapeMarkup(machine) +
      ". Repeat with <code>trocar reproduce report-card -o FOLDER</code>.</p>\n";
  for (const PhysicsCheck& check : checks) {
    html +=
        "<h2>" + EscapeMarkup(check.title) + "</h2>\n<p>" + EscapeMarkup(check.method) +
        "</p>\n<table>\n<tr><th>Figure</th><th>Measured</th><th>Unit</th><th>Must be</th><th></th></tr>\n";
    for (const CheckFigure& figure : check.figures) {
      html += "<tr><td>" + EscapeMarkup(figure.name) + "</td><td class=\"number\">" +
              FormatNumber(figure.value) + "</td><td>" + EscapeMarkup(figure.unit) + "</td><td>" +
              FormatBounds(figure) + "</td>" + FormatVerdict(figure) + "</tr>\n";
    }
    html += "</table>\n";
    if (!check.lines.empty()) html += FormatSvgPlot(check.plot, check.lines);
  }
  return html + "</body>\n</html>\n";
}

}  // namespace trocar::cli
