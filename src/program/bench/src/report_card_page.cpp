// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "page_style.h"
#include "trocar/bench/physics_checks.h"
#include "trocar/host/markup.h"
#include "trocar/host/text_table.h"
#include "trocar/host/version.h"

namespace trocar::bench {
namespace {

using host::EscapeMarkup;

std::string FormatBounds(const CheckFigure& figure) {
  const bool has_low = std::isfinite(figure.low) && figure.low != 0.0, has_high = std::isfinite(figure.high);
  const std::string high = host::FormatNumber(figure.high);
  if (has_low && has_high) return host::FormatNumber(figure.low) + " to " + high;
  return has_high ? "at most " + high : has_low ? "at least " + host::FormatNumber(figure.low) : "";
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
      std::string(kPageStyle) + kPlotStyle + "</style>\n</head>\n<body>\n<h1>Physics report card</h1>\n<p>" +
      std::to_string(passed) + " of " + std::to_string(figures) + " figures hold. Trocar " +
      EscapeMarkup(host::VersionText()) + ", " + EscapeMarkup(machine) +
      ". Repeat with <code>trocar reproduce report-card -o FOLDER</code>.</p>\n";
  for (const PhysicsCheck& check : checks) {
    html +=
        "<h2>" + EscapeMarkup(check.title) + "</h2>\n<p>" + EscapeMarkup(check.method) +
        "</p>\n<table>\n<tr><th>Figure</th><th>Measured</th><th>Unit</th><th>Must be</th><th></th></tr>\n";
    for (const CheckFigure& figure : check.figures) {
      html += "<tr><td>" + EscapeMarkup(figure.name) + "</td><td class=\"number\">" +
              host::FormatNumber(figure.value) + "</td><td>" + EscapeMarkup(figure.unit) + "</td><td>" +
              FormatBounds(figure) + "</td>" + FormatVerdict(figure) + "</tr>\n";
    }
    html += "</table>\n";
    if (!check.lines.empty()) html += FormatSvgPlot(check.plot, check.lines);
  }
  return html + "</body>\n</html>\n";
}

}  // namespace trocar::bench
