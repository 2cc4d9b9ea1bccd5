// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/image_series.h"

#include <algorithm>
#include <cstdint>
#include <map>

#include "slice_names.h"
#include "trocar/core/printable.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;
using core::Error;
using core::ErrorCode;

}  // namespace

struct ImageSeries::Content {
  ImageSeriesInfo info;
  std::map<int, fs::path> files;
};

ImageSeries::ImageSeries(std::shared_ptr<const Content> content) : content_(std::move(content)) {}

const ImageSeriesInfo& ImageSeries::Info() const {
  return content_->info;
}

core::Result<ImageSeries> ImageSeries::Open(const fs::path& path, const ImageSeriesOptions& options,
                                            const Progress&) {
  std::error_code failure;
  std::vector<std::string> names;
  for (fs::directory_iterator entry(path, failure), end; !failure && entry != end; entry.increment(failure)) {
    names.push_back(entry->path().filename().string());
  }
  if (failure) {
    return Error{ErrorCode::kFileMissing, core::Printable(path.string()) + " cannot be listed: " +
                                              failure.message() + "; name the folder that holds the slices"};
  }
  auto named = FindNamedSlices(names, options.pattern);
  if (!named) return Error{named.error().code, core::Printable(path.string()) + ": " + named.error().message};
  auto content = std::make_shared<Content>();
  ImageSeriesInfo& info = content->info;
  for (const auto& [number, name] : named->files) {
    const bool is_wanted =
        options.slices.empty() || std::binary_search(options.slices.begin(), options.slices.end(), number);
    if (!is_wanted) continue;
    info.slice_numbers.push_back(number);
    content->files[number] = path / name;
  }
  if (options.slices.empty()) {
    if (auto step = CheckSliceNumbers(info.slice_numbers); !step) return step.error();
  }
  if (!options.pixel_mm || !options.slice_mm || !options.axes) {
    return Error{ErrorCode::kImageSpacingUnknown,
                 core::Printable(path.string()) +
                     ": pictures do not say how large a pixel is, how far slices are apart and how they lie; "
                     "give --pixel-mm, --slice-mm and --axes"};
  }
  auto first = ReadImage(content->files.begin()->second);
  if (!first) return first.error();
  info.format = content->files.begin()->second.extension() == ".png" ? "PNG" : "JPEG";
  info.width = first->width, info.height = first->height;
  info.pixel_mm = *options.pixel_mm, info.slice_mm = *options.slice_mm, info.axes = *options.axes;
  info.is_color = true;
  info.pattern = named->pattern;
  info.ignored_files = named->ignored;
  return ImageSeries(std::move(content));
}

core::Result<ColorImage> ImageSeries::ReadSlice(int number, const DisplayWindow&) const {
  const auto found = content_->files.find(number);
  if (found == content_->files.end()) {
    return Error{ErrorCode::kImageSliceMissing, "the series has no slice " + std::to_string(number) +
                                                    "; it has " +
                                                    std::to_string(content_->files.begin()->first) + " to " +
                                                    std::to_string(content_->files.rbegin()->first)};
  }
  return ReadImage(found->second);
}

}  // namespace trocar::anatomy
