// SPDX-License-Identifier: Apache-2.0
/// \file experiment_pages.cpp  An experiment as text, JSON, HTML, Markdown and SVG.
#include <nlohmann/json.hpp>

#include "page_style.h"
#include "trocar/bench/experiment.h"
#include "trocar/host/json_text.h"
#include "trocar/host/markup.h"
#include "trocar/host/text_table.h"
#include "trocar/host/version.h"

namespace trocar::bench {
namespace {

using host::EscapeMarkup;

std::string BeginPage(const std::string& title) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
         "content=\"width=device-width, initial-scale=1\">\n<title>" +
         EscapeMarkup(title) + " - Trocar</title>\n<style>" + kPageStyle + kPlotStyle +
         "</style>\n</head>\n<body>\n<h1>" + EscapeMarkup(title) + "</h1>\n";
}

std::string FormatTableHtml(const ExperimentTable& table) {
  std::string html = "<h2>" + EscapeMarkup(table.title) + "</h2>\n<table>\n<tr>";
  for (const std::string& column : table.heading) html += "<th>" + EscapeMarkup(column) + "</th>";
  html += "</tr>\n";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (const ExperimentCell& cell : row) {
      html +=
          (std::isfinite(cell.number) ? "<td class=\"number\">" : "<td>") + EscapeMarkup(cell.text) + "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

std::string FormatTableMarkdown(const ExperimentTable& table) {
  const auto cells = [](const auto& row, const auto& text) {
    std::string line = "|";
    for (const auto& cell : row) {
      std::string escaped;
      for (const char c : text(cell)) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
      line += " " + escaped + " |";
    }
    return line + "\n";
  };
  std::string markdown = table.title + ":\n\n";
  markdown += cells(table.heading, [](const std::string& text) { return text; }) + "|";
  for (std::size_t i = 0; i < table.heading.size(); ++i) markdown += "---|";
  markdown += "\n";
  for (const auto& row : table.rows)
    markdown += cells(row, [](const ExperimentCell& cell) { return cell.text; });
  return markdown + "\n";
}

}  // namespace

ExperimentCell::ExperimentCell(double value, int digits)
    : text(std::isfinite(value) ? host::FormatNumber(value, digits) : "-"), number(value) {}

std::string FormatExperimentText(const Experiment& experiment) {
  std::string text = experiment.title + "\n" + experiment.method + "\n";
  for (const ExperimentTable& table : experiment.tables) {
    std::vector<std::vector<std::string>> rows = {table.heading};
    for (const auto& row : table.rows) {
      rows.emplace_back();
      for (const ExperimentCell& cell : row) rows.back().push_back(cell.text);
    }
    text += "\n" + table.title + "\n" + host::FormatTable(rows);
  }
  if (!experiment.notes.empty()) text += "\n";
  for (const std::string& note : experiment.notes) text += "- " + note + "\n";
  return text;
}

std::string FormatExperimentsJson(std::span<const Experiment> experiments, const std::string& machine) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Experiment& experiment : experiments) {
    nlohmann::ordered_json tables = nlohmann::ordered_json::array();
    for (const ExperimentTable& table : experiment.tables) {
      nlohmann::ordered_json rows = nlohmann::ordered_json::array();
      for (const auto& row : table.rows) {
        nlohmann::ordered_json object = nlohmann::ordered_json::object();
        for (std::size_t i = 0; i < row.size(); ++i) {
          if (std::isfinite(row[i].number)) {
            object[table.heading[i]] = row[i].number;
          } else {
            object[table.heading[i]] = row[i].text;
          }
        }
        rows.push_back(std::move(object));
      }
      tables.push_back({{"title", table.title}, {"rows", std::move(rows)}});
    }
    list.push_back({{"name", experiment.name},
                    {"title", experiment.title},
                    {"method", experiment.method},
                    {"tables", std::move(tables)},
                    {"notes", experiment.notes}});
  }
  const nlohmann::ordered_json json = {
      {"version", host::VersionText()}, {"machine", machine}, {"experiments", std::move(list)}};
  return host::FormatJson(json, 2) + "\n";
}

std::string FormatExperimentPage(const Experiment& experiment, const std::string& machine) {
  std::string html = BeginPage(experiment.title);
  html += "<p>" + EscapeMarkup(experiment.method) + "</p>\n";
  for (const ExperimentTable& table : experiment.tables) html += FormatTableHtml(table);
  for (const ExperimentPlot& plot : experiment.plots) html += FormatSvgPlot(plot.settings, plot.lines);
  if (!experiment.notes.empty()) {
    html += "<h2>What to know</h2>\n<ul>\n";
    for (const std::string& note : experiment.notes) html += "<li>" + EscapeMarkup(note) + "</li>\n";
    html += "</ul>\n";
  }
  return html + "<p>Trocar " + EscapeMarkup(host::VersionText()) + ", " + EscapeMarkup(machine) +
         ". Repeat with <code>trocar reproduce " + EscapeMarkup(experiment.name) +
         " -o FOLDER</code>.</p>\n</body>\n</html>\n";
}

std::string FormatExperimentIndex(std::span<const Experiment> experiments, const std::string& machine) {
  std::string html = BeginPage("The paper's experiments");
  html +=
      "<p>\"General algorithms for laparoscopic surgical simulators\", its tables and figures done again by "
      "Trocar " +
      EscapeMarkup(host::VersionText()) + " on " + EscapeMarkup(machine) + ".</p>\n<ul>\n";
  for (const Experiment& experiment : experiments) {
    html += "<li><a href=\"" + EscapeMarkup(experiment.name) + ".html\">" + EscapeMarkup(experiment.title) +
            "</a></li>\n";
  }
  html += "</ul>\n";
  for (const Experiment& experiment : experiments) {
    for (const ExperimentPlot& plot : experiment.plots) html += FormatSvgPlot(plot.settings, plot.lines);
  }
  return html + "<p>Repeat with <code>trocar reproduce all -o FOLDER</code>.</p>\n</body>\n</html>\n";
}

std::string FormatExperimentsMarkdown(std::span<const Experiment> experiments, const std::string& machine) {
  std::string markdown = "Measured on: " + machine + ", Trocar " + std::string(host::VersionText()) + ".\n\n";
  for (const Experiment& experiment : experiments) {
    markdown += "## " + experiment.title + "\n\n`trocar reproduce " + experiment.name + " -o FOLDER`. " +
                experiment.method + "\n\n";
    for (const ExperimentTable& table : experiment.tables) markdown += FormatTableMarkdown(table);
    for (const std::string& note : experiment.notes) markdown += "- " + note + "\n";
    if (!experiment.notes.empty()) markdown += "\n";
  }
  return markdown;
}

std::string FormatSvgFile(const ExperimentPlot& plot) {
  std::string svg = FormatSvgPlot(plot.settings, plot.lines);
  const std::string open = "<svg ";
  svg.replace(0, open.size(), "<svg xmlns=\"http://www.w3.org/2000/svg\" ");
  const std::size_t inside = svg.find(">\n") + 2;
  return svg.insert(inside, "<style>" + std::string(kPlotStyle) +
                                "</style>\n<rect width=\"100%\" "
                                "height=\"100%\" fill=\"#fafafa\"/>\n");
}

base::Result<std::string> ReplaceGeneratedPart(std::string_view document, std::string_view generated) {
  const std::size_t begin = document.find(kGeneratedBegin), end = document.find(kGeneratedEnd);
  const bool is_sound = begin != std::string_view::npos && end != std::string_view::npos && begin < end &&
                        document.find(kGeneratedBegin, begin + 1) == std::string_view::npos &&
                        document.find(kGeneratedEnd, end + 1) == std::string_view::npos;
  if (!is_sound) {
    return base::Error{base::ErrorCode::kUsage, "the document must have the line \"" +
                                                    std::string(kGeneratedBegin) + "\" and after it \"" +
                                                    std::string(kGeneratedEnd) + "\", each once"};
  }
  return std::string(document.substr(0, begin + kGeneratedBegin.size())) + "\n\n" + std::string(generated) +
         std::string(document.substr(end));
}

}  // namespace trocar::bench
