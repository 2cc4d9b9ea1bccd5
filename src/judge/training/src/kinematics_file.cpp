// SPDX-License-Identifier: Apache-2.0
#include "trocar/training/kinematics_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>
#include <vector>

namespace trocar::training {
namespace {

/// Of JIGSAWS: first column of each arm's tip, counted from 0.
constexpr std::size_t kJigsawsColumns = 76, kJigsawsLeft = 38, kJigsawsRight = 57;
constexpr std::size_t kMostColumns = 512;

constexpr std::array<std::array<std::string_view, 3>, instrument::kHandCount> kCompassHeads = {
    {{"PSML_position_x", "PSML_position_y", "PSML_position_z"},
     {"PSMR_position_x", "PSMR_position_y", "PSMR_position_z"}}};

/// (hands, axes) columns of the tips.
using TipColumns = std::array<std::array<std::size_t, 3>, instrument::kHandCount>;

/// Lines without their ends; an empty last one is none.
std::vector<std::string_view> SplitLines(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

/// \param separator  a space stands for any number of spaces and tabs
std::vector<std::string_view> SplitFields(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  const std::string_view between = separator == ' ' ? " \t" : std::string_view(&separator, 1);
  while (fields.size() <= kMostColumns) {
    if (separator == ' ') line.remove_prefix(std::min(line.find_first_not_of(between), line.size()));
    if (separator == ' ' && line.empty()) break;
    const std::size_t end = line.find_first_of(between);
    fields.push_back(line.substr(0, end));
    if (end == std::string_view::npos) break;
    line.remove_prefix(end + 1);
  }
  return fields;
}

std::optional<double> ReadNumber(std::string_view field) {
  double number = 0;
  const auto [end, failure] = std::from_chars(field.data(), field.data() + field.size(), number);
  if (failure != std::errc() || end != field.data() + field.size() || !std::isfinite(number))
    return std::nullopt;
  return number;
}

base::Error Refuse(const std::string& name, std::size_t line, const std::string& why) {
  return {base::ErrorCode::kDatasetInvalid, name + ": line " + std::to_string(line) + ": " + why};
}

/// The columns that a heading names.
base::Result<TipColumns> FindCompassColumns(const std::vector<std::string_view>& heads,
                                            const std::string& name) {
  TipColumns columns{};
  for (std::size_t hand = 0; hand < kCompassHeads.size(); ++hand) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string_view wanted = kCompassHeads[hand][axis];
      const auto found = std::find(heads.begin(), heads.end(), wanted);
      if (found == heads.end())
        return Refuse(name, 1,
                      "no column " + std::string(wanted) + "; --kinematics says which data set it is of");
      columns[hand][axis] = static_cast<std::size_t>(found - heads.begin());
    }
  }
  return columns;
}

constexpr TipColumns ThreeFrom(std::size_t left, std::size_t right) {
  return {{{left, left + 1, left + 2}, {right, right + 1, right + 2}}};
}

}  // namespace

std::string_view NameOf(KinematicsFormat format) noexcept {
  return format == KinematicsFormat::kJigsaws ? "jigsaws" : "compass";
}
std::optional<KinematicsFormat> FindKinematicsFormat(std::string_view name) noexcept {
  for (const KinematicsFormat format : kKinematicsFormats) {
    if (NameOf(format) == name) return format;
  }
  return std::nullopt;
}

base::Result<AttemptTrace> ParseKinematics(std::string_view text, KinematicsFormat format,
                                           const std::string& name) {
  const std::vector<std::string_view> lines = SplitLines(text);
  const bool has_heads = format == KinematicsFormat::kCompass;
  const char separator = has_heads ? ',' : ' ';
  TipColumns columns = ThreeFrom(kJigsawsLeft, kJigsawsRight);
  std::size_t width = kJigsawsColumns;
  if (has_heads) {
    const auto heads = SplitFields(lines.empty() ? std::string_view() : lines.front(), separator);
    const auto found = FindCompassColumns(heads, name);
    if (!found.ok()) return found.error();
    columns = *found;
    width = heads.size();
  }
  AttemptTrace trace;
  trace.dt = 1.0 / kKinematicsRate;
  trace.tool_names = {"instrument"};
  for (std::size_t i = has_heads ? 1 : 0; i < lines.size(); ++i) {
    const auto fields = SplitFields(lines[i], separator);
    if (fields.size() != width)
      return Refuse(name, i + 1,
                    std::to_string(fields.size()) + " columns, " + std::string(NameOf(format)) + " has " +
                        std::to_string(width));
    for (std::size_t hand = 0; hand < columns.size(); ++hand) {
      std::array<double, 3> tip{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t column = columns[hand][axis];
        const auto number = ReadNumber(fields[column]);
        if (!number)
          return Refuse(name, i + 1, "column " + std::to_string(column + 1) + " is no finite number");
        tip[axis] = *number;
      }
      trace.hands[hand].emplace_back().tip = {tip[0], tip[1], tip[2]};
    }
  }
  if (trace.Ticks() < 2) return Refuse(name, lines.size(), "the file ends before a second row of numbers");
  return trace;
}

std::span<const std::string_view> MetricsOfTips() noexcept {
  static constexpr std::array<std::string_view, 14> kIds = {"time",
                                                            "path_length",
                                                            "path_sum",
                                                            "movement_straightness",
                                                            "mean_speed",
                                                            "max_speed",
                                                            "motion_smoothness",
                                                            "movements",
                                                            "sparc",
                                                            "dimensionless_jerk",
                                                            "log_dimensionless_jerk",
                                                            "idle_fraction",
                                                            "bimanual_fraction",
                                                            "bimanual_correlation"};
  return kIds;
}

AttemptMetrics KeepMetricsOfTips(AttemptMetrics metrics) {
  const auto known = MetricsOfTips();
  std::erase_if(metrics.values, [&](const MetricValue& value) {
    return value.hand == "camera" || std::find(known.begin(), known.end(), value.metric) == known.end();
  });
  return metrics;
}

}  // namespace trocar::training
