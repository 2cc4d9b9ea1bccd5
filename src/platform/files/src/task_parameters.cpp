// SPDX-License-Identifier: Apache-2.0
#include "task_parameters.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <optional>
#include <utility>

#include "field_ranges.h"
#include "trocar/math/random.h"

namespace trocar::files {
namespace {

using base::ErrorCode;
using host::JsonView;

/// Parts the row of what varies from the row of what is standardised.
constexpr std::uint64_t kVariedSeed = 0x7ec4a9d3f0b6512dULL;

double ReadValue(const JsonView& view, const std::vector<std::string>& levels, const std::string& level) {
  if (view.Has("value") == view.Has("by_level")) {
    view.Complain("a parameter has either value or by_level", ErrorCode::kSceneInvalid);
    return 0;
  }
  if (view.Has("value")) return view.Number("value", range::kParameter);
  const JsonView by_level = view.Object("by_level");
  for (const std::string& each : levels)
    (void)by_level.Number(each, range::kParameter);  // each level needs its number
  return by_level.Number(level, range::kParameter);
}

/// Rows of names whose values change places as wholes; nothing where it complained.
std::vector<std::vector<std::string>> ReadShuffle(const JsonView& list, const TaskParameters& parameters) {
  const auto is_known = [&](const std::string& name) {
    return std::any_of(parameters.all.begin(), parameters.all.end(),
                       [&](const TaskParameters::Parameter& one) { return one.name == name; });
  };
  std::vector<std::vector<std::string>> rows;
  for (const JsonView& row : list.Elements()) {
    std::vector<std::string> names;
    for (const JsonView& name : row.Elements()) {
      names.push_back(name.AsText());
      if (is_known(names.back())) continue;
      name.Complain("there is no parameter \"" + names.back() + "\" to shuffle", ErrorCode::kSceneInvalid);
      return {};
    }
    rows.push_back(std::move(names));
    if (rows.back().size() == rows.front().size() && !rows.back().empty()) continue;
    row.Complain("rows that are shuffled name equally many parameters, at least one",
                 ErrorCode::kSceneInvalid);
    return {};
  }
  return rows;
}

void Shuffle(const std::vector<std::vector<std::string>>& rows, math::Random& random,
             ParameterValues& values) {
  for (std::size_t left = rows.size(); left > 1; --left) {
    const auto other = static_cast<std::size_t>(random.NextWord() % left);
    for (std::size_t i = 0; i < rows.front().size(); ++i)
      std::swap(values.find(rows[left - 1][i])->second, values.find(rows[other][i])->second);
  }
}

/// Reads a sum of numbers, parameters and products of both.
class SumReader {
 public:
  SumReader(std::string_view text, const ParameterValues& values) : rest_(text), values_(values) {}

  /// Nothing where it is no such sum, or has no parameter.
  std::optional<double> Read() {
    double sum = 0;
    for (bool is_first = true; is_first || !rest_.empty(); is_first = false) {
      SkipSpaces();
      const bool is_minus = Take('-');
      if (!is_minus && !Take('+') && !is_first) return {};
      SkipSpaces();
      const std::optional<double> term = ReadTerm();
      if (!term) return {};
      // the first as it is: 0 - x has another sign where x is 0
      const double signed_term = is_minus ? -*term : *term;
      sum = is_first ? signed_term : sum + signed_term;
      SkipSpaces();
    }
    return has_parameter_ ? std::optional(sum) : std::nullopt;
  }

 private:
  std::optional<double> ReadTerm() {
    if (rest_.starts_with('{')) return ReadParameter();
    double number = 0;
    const auto end = std::from_chars(rest_.data(), rest_.data() + rest_.size(), number);
    if (end.ec != std::errc()) return {};
    rest_.remove_prefix(static_cast<std::size_t>(end.ptr - rest_.data()));
    SkipSpaces();
    if (!Take('*')) return number;
    SkipSpaces();
    const std::optional<double> parameter = ReadParameter();
    return parameter ? std::optional(number * *parameter) : std::nullopt;
  }
  std::optional<double> ReadParameter() {
    const std::size_t close = rest_.find('}');
    if (!Take('{') || close == std::string_view::npos) return {};
    const auto found = values_.find(rest_.substr(0, close - 1));
    if (found == values_.end()) return {};
    rest_.remove_prefix(close);
    has_parameter_ = true;
    return found->second;
  }
  bool Take(char c) {
    if (!rest_.starts_with(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }
  void SkipSpaces() {
    while (Take(' ')) {
    }
  }

  std::string_view rest_;
  const ParameterValues& values_;
  bool has_parameter_ = false;
};

}  // namespace

TaskParameters ReadTaskParameters(const JsonView& root, const std::vector<std::string>& levels,
                                  const std::string& level) {
  TaskParameters made;
  if (!root.Has("parameters")) {
    if (root.Has("shuffle"))
      root.Complain("shuffle names parameters, and there are none", ErrorCode::kSceneInvalid);
    return made;
  }
  const JsonView parameters = root.Object("parameters");
  for (const std::string& name : parameters.Keys()) {
    const JsonView view = parameters.Object(name);
    view.AllowOnly({"about", "value", "by_level", "spread", "vary"});
    // what only varies takes no number from the row of the others, whose layouts are older than it
    made.all.push_back({name, ReadValue(view, levels, level), view.NumberOr("spread", 0.0, range::kSpread),
                        view.NumberOr("vary", 0.0, range::kSpread), view.Has("spread") || !view.Has("vary")});
  }
  if (!root.Has("shuffle")) return made;
  for (const JsonView& list : root.Array("shuffle")) {
    auto rows = ReadShuffle(list, made);
    if (!rows.empty()) made.shuffled.push_back(std::move(rows));
  }
  return made;
}

ParameterValues TaskParameters::Draw(std::uint64_t seed, bool is_varied) const {
  ParameterValues values;
  math::Random random(seed), varied(seed ^ kVariedSeed);
  for (const Parameter& parameter : all) {
    double value = parameter.value;
    if (parameter.is_standard) value += random.Uniform(-parameter.spread, parameter.spread);
    const double moved = varied.Uniform(-parameter.vary, parameter.vary);
    values[parameter.name] = is_varied && parameter.vary > 0 ? value + moved : value;
  }
  for (const auto& rows : shuffled) {
    if (is_varied) Shuffle(rows, varied, values);
  }
  return values;
}

std::string WithoutBlanks(std::string_view json) {
  std::string out;
  out.reserve(json.size());
  bool is_text = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (!is_text && (c == ' ' || c == '\n' || c == '\t' || c == '\r')) continue;
    out += c;
    if (is_text && c == '\\' && i + 1 < json.size()) out += json[++i];
    if (c == '"') is_text = !is_text;
  }
  return out;
}

std::string SubstituteParameters(std::string_view text, const ParameterValues& values) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t open = text.find('"', at);
    if (open == std::string_view::npos) {
      out += text.substr(at);
      break;
    }
    std::size_t close = open + 1;
    while (close < text.size() && text[close] != '"') close += text[close] == '\\' ? 2 : 1;
    close = std::min(close, text.size() - 1);
    out += text.substr(at, open - at);
    const std::string_view content = text.substr(open + 1, close - open - 1);
    const auto sum =
        content.find('{') == std::string_view::npos ? std::nullopt : SumReader(content, values).Read();
    if (sum) {
      char number[40];
      std::snprintf(number, sizeof number, "%.17g", *sum);
      out += number;
    } else {
      out += text.substr(open, close - open + 1);
    }
    at = close + 1;
  }
  return out;
}

}  // namespace trocar::files
