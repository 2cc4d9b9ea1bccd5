// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "series_content.h"
#include "series_geometry.h"
#include "trocar/host/printable.h"
#include "trocar/images/slice_names.h"

namespace trocar::images {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;

base::Status OpenStack(const fs::path& folder, std::span<const std::string> names,
                       const ImageSeriesOptions& options, const Progress& progress,
                       ImageSeries::Content& content) {
  const auto named = FindNamedSlices(names, options.pattern);
  if (!named) return named.error();
  ImageSeriesInfo& info = content.info;
  for (const int wanted : options.slices) {
    if (named->files.contains(wanted)) continue;
    return Error{ErrorCode::kImageSliceMissing, "slice " + std::to_string(wanted) +
                                                    " is missing: there is no " +
                                                    host::Printable(FormatImageName(named->pattern, wanted)) +
                                                    "; complete the folder or correct the naming pattern"};
  }
  for (const auto& [number, name] : named->files) {
    if (!options.slices.empty() && !std::binary_search(options.slices.begin(), options.slices.end(), number))
      continue;
    info.slice_numbers.push_back(number);
    content.files.push_back(folder / name);
  }
  if (options.slices.empty()) {
    if (const auto step = CheckSliceNumbers(info.slice_numbers); !step) return step.error();
  }
  info.pattern = named->pattern;
  info.ignored_files = named->ignored;

  content.headers.resize(content.files.size());
  const auto status =
      ForEach(content.files.size(), progress, "looking at slices", [&](std::size_t i) -> base::Status {
        const auto file = ImportFile::Open(content.files[i], Links::kRefuse);
        if (!file) return file.error();
        const auto reply = content.pool->Probe(*file);
        if (!reply) return reply.error();
        content.headers[i] = reply->header;
        return {};
      });
  if (!status) return status;
  for (std::size_t i = 0; i < content.headers.size(); ++i) {
    const ImageHeader &first = content.headers[0], &header = content.headers[i];
    const auto name_of = [&](std::size_t k) {
      return "slice " + std::to_string(info.slice_numbers[k]) + " (" +
             host::Printable(content.files[k].filename().string()) + ")";
    };
    if (header.depth != 1 || header.kind > FileKind::kTiff) {
      return Error{ErrorCode::kImageSeriesMixed, name_of(i) + " is no single picture; open it by itself"};
    }
    if (header.width != first.width || header.height != first.height) {
      return Error{ErrorCode::kImageSizeDiffers, name_of(i) + " has " + std::to_string(header.width) + " x " +
                                                     std::to_string(header.height) + " pixels, " +
                                                     name_of(0) + " has " + std::to_string(first.width) +
                                                     " x " + std::to_string(first.height) +
                                                     "; give all one size"};
    }
  }
  info.format = FormatName(content.headers[0].kind);
  SaidGeometry
      said;  // resolutions in pictures are for printers: dots an inch, not millimetres of the patient
  if (auto fitted = SetGeometry(said, content.headers[0], options, info); !fitted) return fitted;
  info.bits = static_cast<int>(content.headers[0].bits);
  info.is_color = content.headers[0].channels == 3;
  if (content.headers[0].samples == SampleKind::kUint8) return {};
  // wide grey values: the middle slice shows what range they have
  const std::size_t middle = content.files.size() / 2;
  const auto measured = content.WithPicture(middle, [&](const std::byte* samples) {
    SetGreyValues(content.headers[middle], samples, content.headers[middle].SampleCount(), info);
    return true;
  });
  if (!measured) return measured.error();
  return {};
}

}  // namespace trocar::images
