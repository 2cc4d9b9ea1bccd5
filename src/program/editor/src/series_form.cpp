// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/series_form.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>
#include <string_view>

#include "trocar/host/translate.h"

namespace trocar::editor {
namespace {

using base::Error;
using base::ErrorCode;

// opposite directions side by side: half the index is the body's axis
constexpr const char* kDirections[] = {"left", "right", "anterior", "posterior", "superior", "inferior"};

std::string LengthText(const std::optional<double>& mm) {
  if (!mm) return {};
  char text[32];
  std::snprintf(text, sizeof(text), "%g", *mm);
  return text;
}

base::Result<std::optional<double>> ReadLength(std::string text, const char* field, double least,
                                               double most) {
  text.erase(0, text.find_first_not_of(" \t"));
  text.erase(text.find_last_not_of(" \t") + 1);
  if (text.empty()) return std::optional<double>();
  std::replace(text.begin(), text.end(), ',', '.');
  double value = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc() || end != text.data() + text.size() || !(value >= least && value <= most)) {
    char range[80];
    std::snprintf(range, sizeof(range), ": write a length of %g to %g mm, for example 0.5", least, most);
    return Error{ErrorCode::kUsage, field + std::string(range)};
  }
  return std::optional(value);
}

}  // namespace

std::span<const char* const> PatientDirections() noexcept {
  return kDirections;
}

SeriesForm MakeSeriesForm(const images::ImageSeriesOptions& series) {
  SeriesForm form{LengthText(series.pixel_mm), LengthText(series.slice_mm), {}};
  if (series.axes) form.axes = *series.axes;
  return form;
}

base::Result<images::ImageSeriesOptions> ReadSeriesForm(const SeriesForm& form,
                                                        images::ImageSeriesOptions series) {
  const auto pixel_mm = ReadLength(form.pixel_mm, host::Mark("Pixel"), 0.01, 20.0);
  if (!pixel_mm) return pixel_mm.error();
  const auto slice_mm = ReadLength(form.slice_mm, host::Mark("Slice distance"), 0.01, 50.0);
  if (!slice_mm) return slice_mm.error();
  series.pixel_mm = *pixel_mm;
  series.slice_mm = *slice_mm;
  series.axes.reset();
  const auto is_empty = [](const std::string& name) { return name.empty(); };
  if (std::all_of(form.axes.begin(), form.axes.end(), is_empty)) return series;
  std::set<std::ptrdiff_t> body_axes;
  for (const std::string& name : form.axes) {
    const auto* found = std::find(std::begin(kDirections), std::end(kDirections), std::string_view(name));
    if (found != std::end(kDirections)) body_axes.insert((found - std::begin(kDirections)) / 2);
  }
  if (body_axes.size() != 3) {
    return Error{
        ErrorCode::kUsage,
        "Columns, rows and slices: choose one each of left or right, anterior or posterior, superior or "
        "inferior"};
  }
  series.axes = form.axes;
  return series;
}

}  // namespace trocar::editor
