// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "image_options.h"
#include "trocar/host/printable.h"
#include "trocar/host/text_table.h"
#include "trocar/host/translate.h"
#include "trocar/images/contact_sheet.h"
#include "trocar/images/image_series.h"
#include "trocar/images/png_file.h"

namespace trocar::cli {

using host::Mark;
using host::Translate;
using host::TranslateWith;

namespace {

struct ImagesArguments {
  std::string path, axes, window, preview;
  images::ImageSeriesOptions options;
  double memory_mb = 2048;
  bool is_json = false;
};

std::string FormatSlices(const images::ImageSeriesInfo& info) {
  const int first = info.slice_numbers.front(), last = info.slice_numbers.back();
  const std::string count = std::to_string(info.slice_numbers.size()), from = std::to_string(first);
  if (last == first) return TranslateWith("{1}, number {2}", {count, from});
  const int step = info.slice_numbers[1] - first;
  return TranslateWith(
      step == 1 ? Mark("{1}, number {2} to {3}") : Mark("{1}, number {2} to {3} in steps of {4}"),
      {count, from, std::to_string(last), std::to_string(step)});
}

void PrintSeries(const images::ImageSeriesInfo& info, const images::DisplayWindow& window) {
  const auto number = [](double value) { return host::ShownNumber(value); };
  std::vector<std::vector<std::string>> rows = {{"what", "found"}};
  const auto add = [&rows](const std::string& what, const std::string& found) {
    rows.push_back({what, found});
  };
  add(Translate("format"),
      info.pattern.empty() ? info.format
                           : TranslateWith("{1}, files {2}", {info.format, host::Printable(info.pattern)}));
  add(Translate("slices"), FormatSlices(info));
  add(Translate("size"),
      TranslateWith("{1} x {2} pixels", {std::to_string(info.width), std::to_string(info.height)}));
  add(Translate("pixel"), number(info.pixel_mm) + " mm");
  add(Translate("slice distance"),
      TranslateWith("{1} mm from one number to the next", {number(info.slice_mm)}));
  add(Translate("columns grow to"), Translate(info.axes[0]));
  add(Translate("rows grow to"), Translate(info.axes[1]));
  add(Translate("slice numbers grow to"), Translate(info.axes[2]));
  add(Translate("frame in the file"), info.file_frame.empty() ? Translate("not said") : info.file_frame);
  if (info.tilt_deg > 0.05)
    add(Translate("oblique by"), TranslateWith("{1} degrees", {host::ShownNumber(info.tilt_deg, 3)}));
  add(Translate("samples"), TranslateWith(info.is_color ? Mark("colour, {1} bits") : Mark("grey, {1} bits"),
                                          {std::to_string(info.bits)}));
  if (!info.is_color) {
    add(Translate("grey values"),
        TranslateWith("{1} to {2}", {number(info.grey_range[0]), number(info.grey_range[1])}));
    // as --window wants it
    add(Translate("window"), TranslateWith("{1} (centre,width)", {host::FormatNumber(window.centre) + "," +
                                                                  host::FormatNumber(window.width)}));
  }
  if (info.ignored_files > 0) add(Translate("other files, ignored"), std::to_string(info.ignored_files));
  for (const std::string& note : info.notes) add(Translate("note"), host::TranslateComposed(note));
  host::PrintTable(rows);
}

void PrintSeriesJson(const images::ImageSeriesInfo& info, const images::DisplayWindow& window) {
  nlohmann::ordered_json json;
  json["format"] = info.format;
  json["pattern"] = info.pattern;
  json["slice_numbers"] = info.slice_numbers;
  json["width"] = info.width;
  json["height"] = info.height;
  json["pixel_mm"] = info.pixel_mm;
  json["slice_mm"] = info.slice_mm;
  json["axes"] = {{"column", info.axes[0]}, {"row", info.axes[1]}, {"slice", info.axes[2]}};
  json["file_frame"] = info.file_frame;
  json["origin_lps_mm"] = info.origin_mm;
  json["direction_lps"] = info.direction;
  json["tilt_deg"] = info.tilt_deg;
  json["is_color"] = info.is_color;
  json["bits"] = info.bits;
  json["grey_range"] = info.grey_range;
  json["window"] = {{"centre", window.centre}, {"width", window.width}};
  json["ignored_files"] = info.ignored_files;
  if (info.series > 0) {
    json["series"] = info.series;
    json["series_id"] = info.series_id;
  }
  json["notes"] = info.notes;
  // names come from a folder and may hold any bytes
  PrintJson(json);
}

base::Status Show(ImagesArguments arguments) {
  if (!arguments.axes.empty()) {
    const auto axes = ParseAxes(arguments.axes);
    if (!axes) return axes.error();
    arguments.options.axes = *axes;
  }
  std::optional<images::DisplayWindow> window;
  if (!arguments.window.empty()) {
    const auto parsed = ParseWindow(arguments.window);
    if (!parsed) return parsed.error();
    window = *parsed;
  }
  arguments.options.memory_bytes = static_cast<std::size_t>(arguments.memory_mb) << 20;
  host::ProgressBar bar("opening", 1.0);
  const images::Progress progress = bar.Follow();
  const auto series = images::ImageSeries::Open(arguments.path, arguments.options, progress);
  if (!series) {
    bar.Finish();
    return series.error();
  }
  const images::ImageSeriesInfo& info = series->Info();
  const images::DisplayWindow shown = window.value_or(info.suggested_window);
  if (!arguments.preview.empty()) {
    const auto sheet = images::DrawContactSheet(*series, shown, {}, progress);
    bar.Finish();
    if (!sheet) return sheet.error();
    if (auto status = images::WritePng(arguments.preview, *sheet); !status) return status;
  }
  bar.Finish();
  arguments.is_json ? PrintSeriesJson(info, shown) : PrintSeries(info, shown);
  if (!arguments.preview.empty() && !arguments.is_json) host::Say("\nWrote {1}\n", arguments.preview);
  return {};
}

}  // namespace

void AddAnatomyImagesCommand(CLI::App& anatomy, Outcome& outcome) {
  CLI::App* images = anatomy.add_subcommand("images", "Say what a series of images is, and show it");
  auto arguments = std::make_shared<ImagesArguments>();
  images
      ->add_option("path", arguments->path,
                   "DICOM folder or file, folder of numbered pictures (PNG, JPEG, TIFF), or a volume: NIfTI "
                   "(.nii, .nii.gz), NRRD (.nrrd, .nhdr), MetaImage (.mha, .mhd), TIFF of several pages")
      ->required()
      ->type_name("PATH");
  AddSpacingOptions(*images, arguments->options.pixel_mm, arguments->options.slice_mm);
  images
      ->add_option(
          "--axes", arguments->axes,
          "Where columns, rows and slice numbers grow to in the patient, where the files do not say it: one "
          "each of left/right, anterior/posterior, superior/inferior")
      ->type_name("COLUMN,ROW,SLICE");
  AddPatternOption(*images, arguments->options.pattern);
  AddSeriesOption(*images, arguments->options.series);
  images
      ->add_option("--window", arguments->window,
                   "Grey values to show: centre and width, in the file's units (HU for CT)")
      ->type_name("CENTRE,WIDTH");
  images->add_option("--preview", arguments->preview, "Write up to 20 slices side by side into a PNG")
      ->type_name("FILE");
  images->add_option("--memory-mb", arguments->memory_mb, "Most memory that the samples may take")
      ->check(CLI::Range(1.0, 1048576.0))
      ->capture_default_str()
      ->type_name("MB");
  AddJsonFlag(*images, arguments->is_json, "Machine-readable: the same as one JSON object");
  images->footer(
      "Nothing is changed. Files are read by a process of its own with little memory, no network and a time "
      "limit, so "
      "that\na damaged or hostile file ends in a message. What is read and what is refused: docs/images.md.\n"
      "Examples: trocar anatomy images ct-dicom --preview out/ct.png --window 60,350\n"
      "          trocar anatomy images slices --pixel-mm 0.528 --slice-mm 1 --axes left,anterior,inferior "
      "--json");
  images->callback([arguments, &outcome] { outcome.status = Show(*arguments); });
}

}  // namespace trocar::cli
