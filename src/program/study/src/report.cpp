// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <map>
#include <type_traits>
#include <utility>

#include "study_folder.h"
#include "table.h"
#include "trocar/base/statistics.h"
#include "trocar/bench/svg_plot.h"
#include "trocar/host/markup.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/text_table.h"

namespace trocar::study {
namespace {

using host::FormatNumber;

constexpr const char* kStyle =
    "body{font:16px/1.5 system-ui,\"DejaVu Sans\",sans-serif;color:#1d2327;margin:0 "
    "auto;max-width:60rem;padding:1.5rem}"
    "table{border-collapse:collapse;font-size:.9rem}th,td{text-align:left;padding:.3rem "
    ".6rem;border-bottom:1px solid #dcdcde}"
    "svg{width:100%;height:auto;background:#fafafa;border:1px solid "
    "#dcdcde}.bad{color:#a4161a;font-weight:600}";
constexpr const char* kPlotStyle =
    "svg text{font:12px system-ui,\"DejaVu Sans\",sans-serif;fill:#1d2327}svg "
    ".title{font-size:14px;font-weight:600}svg .grid{stroke:#dcdcde}svg .line{fill:none;stroke-width:1.8}";
constexpr std::size_t kMostFailuresShown = 50;

/// A number of a run in words, and its unit.
struct Label {
  const char *name, *words, *unit;
};
constexpr std::array kLabels = {Label{"completed", "Share of runs completed", ""},
                                Label{"seconds", "Time", "s"},
                                Label{"score", "Score", "%"},
                                Label{"errors", "Errors", ""},
                                Label{"critical_errors", "Critical errors", ""},
                                Label{"path_left_m", "Path of the left hand", "m"},
                                Label{"path_right_m", "Path of the right hand", "m"},
                                Label{"most_force_left_n", "Greatest force, left hand", "N"},
                                Label{"most_force_right_n", "Greatest force, right hand", "N"},
                                Label{"impulse_left_ns", "Impulse, left hand", "N s"},
                                Label{"impulse_right_ns", "Impulse, right hand", "N s"},
                                Label{"pinch_damages", "Places that jaws crushed", ""},
                                Label{"tears", "Tears", ""},
                                Label{"critical_view", "Critical view (0 to 6)", ""},
                                Label{"detached_share", "Share of the bed that is detached", ""},
                                Label{"cleared_share", "Share of the triangle that is cleared", ""},
                                Label{"blood_pooled_ml", "Blood that lies there", "mL"},
                                Label{"solver_iterations_per_tick", "Solver iterations a tick", ""},
                                Label{"restored_states", "States taken back", ""}};

Label LabelOf(const std::string& name) {
  const auto found =
      std::find_if(kLabels.begin(), kLabels.end(), [&](const Label& label) { return label.name == name; });
  return found != kLabels.end() ? *found : Label{"", name.c_str(), ""};
}

/// "Time [s]"
std::string HeadOf(const std::string& name) {
  const Label label = LabelOf(name);
  return label.words + (*label.unit != 0 ? " [" + std::string(label.unit) + "]" : "");
}

/// "stiffness scale"
std::string Spaced(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

double FindNumber(const Row& row, const std::string& name) {
  for (const auto& [column, value] : row.result.numbers)
    if (column == name) return value;
  return std::numeric_limits<double>::quiet_NaN();
}

/// Numbers that are not the same in all runs.
std::vector<std::string> ListVarying(std::span<const Row> rows) {
  std::vector<std::string> names;
  if (rows.empty()) return names;
  for (const auto& [name, first] : rows.front().result.numbers) {
    const double value = first;
    if (std::any_of(rows.begin(), rows.end(),
                    [&, n = name](const Row& row) { return FindNumber(row, n) != value; }))
      names.push_back(name);
  }
  return names;
}

/// What runs are compared by: a parameter, or the patients by their places in the plan.
struct PlotAxis {
  std::string name;
  bool is_log = false;
  std::function<double(const Row&)> value_of;
};

PlotAxis AxisOf(const StudyPlan& plan, std::size_t parameter) {
  const auto& values = plan.parameters[parameter].values;
  const double least = *std::min_element(values.begin(), values.end()),
               most = *std::max_element(values.begin(), values.end());
  return {plan.parameters[parameter].name, least > 0 && most >= 20 * least,
          [parameter](const Row& row) { return row.run.values[parameter]; }};
}

PlotAxis AxisOfPatients(const StudyPlan& plan) {
  return {"patient", false, [&plan](const Row& row) {
            const auto at = std::find(plan.patients.begin(), plan.patients.end(), row.run.patient);
            return static_cast<double>(at - plan.patients.begin() + 1);
          }};
}

/// Middle, and where the middle eight of ten lie.
std::string PlotNumber(std::span<const Row> rows, const PlotAxis& axis, const std::string& number) {
  std::map<double, std::vector<double>> groups;
  for (const Row& row : rows) groups[axis.value_of(row)].push_back(FindNumber(row, number));
  bench::PlotLine low{"10 %", {}}, middle{"median", {}}, high{"90 %", {}};
  for (auto& [value, numbers] : groups) {
    low.points.push_back({value, base::CalcPercentile(numbers, 0.1)});
    middle.points.push_back({value, base::CalcPercentile(numbers, 0.5)});
    high.points.push_back({value, base::CalcPercentile(numbers, 0.9)});
  }
  const Label label = LabelOf(number);
  return bench::FormatSvgPlot(
      {.title = label.words, .x_label = Spaced(axis.name), .y_label = label.unit, .is_log_x = axis.is_log},
      {middle, low, high});
}

/// A plot that needs no page around it.
base::Status WritePlot(const std::filesystem::path& path, std::string plot) {
  const std::string root = "<svg ";
  plot.replace(plot.find(root), root.size(), root + "xmlns=\"http://www.w3.org/2000/svg\" ");
  plot.insert(plot.find('>') + 1, "<style>" + std::string(kPlotStyle) +
                                      "</style><rect width=\"100%\" height=\"100%\" fill=\"#fafafa\"/>");
  return host::WriteFile(path, plot);
}

/// Runs that are compared with others, and what they have in common.
using Groups = std::vector<std::pair<std::string, std::vector<const Row*>>>;

/// In the order of what they have in common: a name or a number.
template <typename KeyOf>
Groups GroupBy(std::span<const Row> rows, KeyOf&& key_of) {
  std::map<decltype(key_of(rows.front())), std::vector<const Row*>> groups;
  for (const Row& row : rows) groups[key_of(row)].push_back(&row);
  Groups named;
  for (auto& [key, members] : groups) {
    if constexpr (std::is_same_v<std::decay_t<decltype(key)>, double>) {
      named.emplace_back(FormatNumber(key, 6), std::move(members));
    } else {
      named.emplace_back(key, std::move(members));
    }
  }
  return named;
}

/// Medians, a line a group.
std::string FormatGroups(const Groups& groups, const std::vector<std::string>& names,
                         const std::string& head) {
  std::string text = "<table><tr><th>" + host::EscapeMarkup(head) + "</th><th>runs</th>";
  for (const std::string& name : names) text += "<th>" + host::EscapeMarkup(HeadOf(name)) + "</th>";
  text += "</tr>\n";
  for (const auto& [group, members] : groups) {
    text += "<tr><td>" + host::EscapeMarkup(group.empty() ? "the scene's own" : group) + "</td><td>" +
            std::to_string(members.size()) + "</td>";
    for (const std::string& name : names) {
      std::vector<double> numbers;
      for (const Row* row : members) numbers.push_back(FindNumber(*row, name));
      text += "<td>" + FormatNumber(base::CalcPercentile(numbers, 0.5), 4) + "</td>";
    }
    text += "</tr>\n";
  }
  return text + "</table>\n";
}

}  // namespace

base::Status WriteReport(const std::filesystem::path& path, const StudyPlan& plan, std::span<const Row> rows,
                         const StudySummary& summary) {
  std::string page = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" +
                     host::EscapeMarkup(plan.name) + "</title><style>" + kStyle + kPlotStyle +
                     "</style></head><body>\n<h1>" + host::EscapeMarkup(plan.name) + "</h1>\n<p>" +
                     host::EscapeMarkup(plan.about) + "</p>\n<p>" + std::to_string(summary.done) + " of " +
                     std::to_string(summary.runs) + " runs are done";
  if (summary.done + summary.failed < summary.runs)
    page += "; <span class=\"bad\">the same command goes on</span>";
  page += ".</p>\n";
  if (!summary.failures.empty()) {
    page += "<h2>Runs that failed</h2>\n<ul class=\"bad\">\n";
    for (std::size_t i = 0; i < std::min(kMostFailuresShown, summary.failures.size()); ++i)
      page += "<li>" + host::EscapeMarkup(summary.failures[i]) + "</li>\n";
    page += "</ul>\n";
  }
  const std::vector<std::string> names = ListVarying(rows);
  if (!rows.empty()) {
    const auto surgeon_of = [](const Row& row) { return row.run.surgeon; };
    const auto patient_of = [](const Row& row) { return row.run.patient.filename().string(); };
    page += "<h2>Medians</h2>\n" + FormatGroups(GroupBy(rows, surgeon_of), names, "surgeon");
    if (plan.patients.size() > 1) page += FormatGroups(GroupBy(rows, patient_of), names, "patient");
  }
  std::vector<PlotAxis> axes;
  for (std::size_t i = 0; i < plan.parameters.size() && !rows.empty(); ++i)
    if (plan.parameters[i].values.size() > 1) axes.push_back(AxisOf(plan, i));
  if (plan.patients.size() > 1 && !rows.empty()) axes.push_back(AxisOfPatients(plan));
  for (const PlotAxis& axis : axes) {
    page += "<h2>Over " + host::EscapeMarkup(Spaced(axis.name)) + "</h2>\n";
    if (axis.name != "patient") page += FormatGroups(GroupBy(rows, axis.value_of), names, Spaced(axis.name));
    for (const std::string& name : names) {
      const std::string plot = PlotNumber(rows, axis, name);
      page += plot + "\n";
      const auto file = path.parent_path() / "plots" / (name + "-by-" + axis.name + ".svg");
      if (auto status = WritePlot(file, plot); !status) return status;
    }
  }
  return host::WriteFile(path, page + "</body></html>\n");
}

}  // namespace trocar::study
