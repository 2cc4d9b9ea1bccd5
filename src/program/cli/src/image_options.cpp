// SPDX-License-Identifier: Apache-2.0
#include "image_options.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
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

CLI::Option* AddSeriesOption(CLI::App& command, int& series) {
  return command.add_option("--series", series, "Which DICOM series, where a folder holds several")
      ->check(CLI::Range(1, 999999999))
      ->type_name("N");
}

CLI::Option* AddPatternOption(CLI::App& command, std::string& pattern) {
  return command
      .add_option("--pattern", pattern,
                  "Only pictures with such names, where a folder holds several stacks: image-{slice:04}.jpeg")
      ->type_name("NAME");
}

void AddSpacingOptions(CLI::App& command, std::optional<double>& pixel_mm, std::optional<double>& slice_mm) {
  command.add_option("--pixel-mm", pixel_mm, "Side of a pixel, where the files do not say it")
      ->check(CLI::Range(0.01, 20.0))
      ->type_name("MM");
  command
      .add_option("--slice-mm", slice_mm,
                  "Distance from one slice number to the next, where the files do not say it")
      ->check(CLI::Range(0.01, 50.0))
      ->type_name("MM");
}

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
