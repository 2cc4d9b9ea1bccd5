// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "dicom_series.h"
#include "series_content.h"
#include "series_geometry.h"
#include "trocar/core/printable.h"

namespace trocar::images {

namespace fs = std::filesystem;
using core::Error;
using core::ErrorCode;

core::Status OpenDicom(const fs::path& folder, std::span<const std::string> names, Links links,
                       const ImageSeriesOptions& options, const Progress& progress,
                       ImageSeries::Content& content) {
  std::vector<std::optional<DicomSlice>> found(names.size());
  const auto looked =
      ForEach(names.size(), progress, "looking at slices", [&](std::size_t i) -> core::Status {
        const auto file = ImportFile::Open(folder / names[i], links);
        if (!file) return file.error();
        const auto reply = content.pool->Probe(*file);
        // reports, plans and folders of contents lie among the slices
        if (!reply && reply.error().code == ErrorCode::kImageUnsupported && names.size() > 1 &&
            reply.error().message.find(kWithoutPicture) != std::string::npos)
          return {};
        if (!reply) return reply.error();
        found[i] = DicomSlice{names[i], reply->header};
        return {};
      });
  if (!looked) return looked;
  std::vector<DicomSlice> slices;
  for (auto& slice : found) {
    if (slice) slices.push_back(std::move(*slice));
  }
  content.info.ignored_files += names.size() - slices.size();
  if (slices.empty())
    return Error{ErrorCode::kImageSliceMissing,
                 "its DICOM files hold no picture; name the folder of the slices"};
  if (options.series > 0) {
    auto series = SplitSeries(slices);
    if (static_cast<std::size_t>(options.series) > series.size()) {
      return Error{ErrorCode::kImageSliceMissing, "there is no series " + std::to_string(options.series) +
                                                      "; the folder holds " + std::to_string(series.size())};
    }
    content.info.ignored_files += slices.size();
    slices = std::move(series[static_cast<std::size_t>(options.series) - 1]);
    content.info.ignored_files -= slices.size();
  }
  const auto order = OrderDicomSlices(slices);
  if (!order) return order.error();

  ImageSeriesInfo& info = content.info;
  info.format = "DICOM";
  info.file_frame = "LPS";
  info.slice_numbers = order->numbers;
  for (const std::size_t slice : order->slices) content.headers.push_back(slices[slice].header);
  const ImageHeader& first = content.headers.front();
  SaidGeometry said = GeometryOf(first);
  said.slice_mm = order->slice_mm;
  said.direction[2] = order->direction;
  if (auto status = SetGeometry(said, first, options, info); !status) return status;

  const std::uint64_t picture = PictureBytes(first), all = picture * slices.size();
  if (all > content.pool->Limits().most_bytes) {
    return Error{ErrorCode::kImageTooLarge, "its " + std::to_string(slices.size()) + " slices unpack to " +
                                                std::to_string(all >> 20) + " MiB, more than the " +
                                                std::to_string(content.pool->Limits().most_bytes >> 20) +
                                                " MiB allowed; open a part of it"};
  }
  auto samples = SampleBuffer::Make(all);
  if (!samples) return samples.error();
  content.samples = std::move(*samples);
  const auto decoded = ForEach(slices.size(), progress, "reading slices", [&](std::size_t i) -> core::Status {
    const auto file = ImportFile::Open(folder / slices[order->slices[i]].file, links);
    if (!file) return file.error();
    return content.pool->Decode(*file, nullptr, content.headers[i], content.samples, i * picture);
  });
  if (!decoded) return decoded;
  SetGreyValues(first, content.samples.Data(), all / SampleBytes(first.samples), info);
  return {};
}

}  // namespace trocar::images
