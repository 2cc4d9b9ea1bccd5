// SPDX-License-Identifier: Apache-2.0
#include "image_options.h"

#include <charconv>
#include <cmath>
#include <string_view>
#include <vector>

#include "trocar/host/printable.h"

namespace trocar::cli {
namespace {

std::vector<std::string> SplitAtCommas(std::string_view text) {
  std::vector<std::string> parts;
  for (;;) {
    const auto comma = text.find(',');
    parts.emplace_back(text.substr(0, comma));
    if (comma == std::string_view::npos) return parts;
    text.remove_prefix(comma + 1);
  }
}

std::optional<double> ParseNumber(const std::string& text) {
  double number = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_number =
      parsed.ec == std::errc() && parsed.ptr == text.data() + text.size() && std::isfinite(number);
  return is_number ? std::optional(number) : std::nullopt;
}

}  // namespace

base::Result<std::array<std::string, 3>> ParseAxes(const std::string& text) {
  const auto parts = SplitAtCommas(text);
  if (parts.size() != 3) {
    return base::Error{base::ErrorCode::kUsage,
                       "--axes: \"" + host::Printable(text) +
                           "\" is not like left,posterior,superior (where columns, rows and "
                           "slice numbers grow to)"};
  }
  return std::array{parts[0], parts[1], parts[2]};
}

base::Result<images::DisplayWindow> ParseWindow(const std::string& text) {
  const auto parts = SplitAtCommas(text);
  const auto centre = ParseNumber(parts.front()), width = ParseNumber(parts.back());
  if (parts.size() != 2 || !centre || !width || !(*width > 0)) {
    return base::Error{base::ErrorCode::kUsage,
                       "--window: \"" + host::Printable(text) +
                           "\" is not like 40,400 (centre and width, in the file's grey "
                           "values)"};
  }
  return images::DisplayWindow{*centre, *width};
}

}  // namespace trocar::cli
