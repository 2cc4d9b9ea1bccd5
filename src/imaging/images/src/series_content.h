// SPDX-License-Identifier: Apache-2.0
/// \file series_content.h  Content of an open ImageSeries, and the functions that fill it.
#pragma once

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "dicom_series.h"
#include "import_worker.h"
#include "trocar/base/result.h"
#include "trocar/images/image_series.h"

namespace trocar::images {

/// Bytes of one slice.
inline std::uint64_t PictureBytes(const ImageHeader& header) {
  return std::uint64_t{header.width} * header.height * header.channels * SampleBytes(header.samples);
}

struct ImageSeries::Content {
  explicit Content(ImportLimits limits)
      : pool(std::make_unique<ImportPool>(
            std::move(limits), std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, 8))) {}

  ImageSeriesInfo info;
  std::vector<ImageHeader> headers;  ///< of each slice; of a volume, one for all
  // a stack of pictures: decoded when asked for
  std::vector<std::filesystem::path> files;
  std::unique_ptr<ImportPool> pool;
  // a volume: its samples, slice after slice, or from the bytes on that `offsets` says
  SampleBuffer samples;
  std::vector<std::uint64_t> offsets;
  std::vector<SlicePlace> places;  ///< of each slice number where slices are interpolated; else empty

  const ImageHeader& HeaderOf(std::size_t slice) const {
    return headers[std::min(slice, headers.size() - 1)];
  }
  /// Samples of a stored slice of a volume.
  const std::byte* SamplesOf(std::size_t slice) const {
    return samples.Data() + (offsets.empty() ? slice * PictureBytes(HeaderOf(slice)) : offsets[slice]);
  }
  /// Decodes one picture of a stack and hands its samples to `use`, which returns what the caller wants.
  template <typename Use>
  auto WithPicture(std::size_t slice, const Use& use) const -> base::Result<decltype(use(nullptr))> {
    const ImageHeader& header = headers[slice];
    const auto file = ImportFile::Open(files[slice], Links::kRefuse);
    if (!file) return file.error();
    auto buffer = TakeBuffer(PictureBytes(header));
    if (!buffer) return buffer.error();
    const auto status = pool->Decode(*file, nullptr, header, *buffer, 0);
    if (!status) return status.error();
    auto result = use(buffer->Data());
    const std::scoped_lock lock(mutex_);
    buffers_.push_back(std::move(*buffer));
    return result;
  }

 private:
  /// The memory of the slice before serves again: making new pages takes time.
  base::Result<SampleBuffer> TakeBuffer(std::uint64_t bytes) const {
    {
      const std::scoped_lock lock(mutex_);
      if (!buffers_.empty()) {
        SampleBuffer buffer = std::move(buffers_.back());
        buffers_.pop_back();
        if (buffer.Bytes() >= bytes) return buffer;
      }
    }
    return SampleBuffer::Make(bytes);
  }

  mutable std::mutex mutex_;
  mutable std::vector<SampleBuffer> buffers_;  // not in use, as many as threads ever read at once
};

/// Runs `work` for every index in parallel and tells the progress from this thread.
/// \return the error of the lowest index
template <typename Work>
base::Status ForEach(std::size_t count, const Progress& progress, const char* what, const Work& work) {
  constexpr std::size_t kBatch = 16;  // indices between two calls of the progress
  for (std::size_t begin = 0; begin < count; begin += kBatch) {
    const std::size_t end = std::min(begin + kBatch, count);
    if (progress) progress(what, static_cast<double>(begin) / static_cast<double>(count));
    std::vector<base::Status> status(end - begin);
    oneapi::tbb::parallel_for(begin, end, [&](std::size_t i) { status[i - begin] = work(i); });
    for (base::Status& one : status) {
      if (!one) return std::move(one);
    }
  }
  return {};
}

/// Names in a folder, sorted into what could be slices.
struct FolderContent {
  std::vector<std::string> files, dicom;
  std::vector<std::string> volumes;  ///< files that are a series each
};
/// \return kImagePathUnsafe for a link or a pipe among them
base::Result<FolderContent> LookInto(const std::filesystem::path& folder);

/// Numbered pictures in a folder: headers now, samples when asked for.
base::Status OpenStack(const std::filesystem::path& folder, std::span<const std::string> names,
                       const ImageSeriesOptions& options, const Progress& progress,
                       ImageSeries::Content& content);

/// The DICOM files of a folder, or one file, decoded and sorted.
/// \param links  whether the files may be symbolic links
base::Status OpenDicom(const std::filesystem::path& folder, std::span<const std::string> names, Links links,
                       const ImageSeriesOptions& options, const Progress& progress,
                       ImageSeries::Content& content);

}  // namespace trocar::images
