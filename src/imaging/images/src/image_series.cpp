// SPDX-License-Identifier: Apache-2.0
#include "trocar/images/image_series.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "series_content.h"
#include "series_geometry.h"
#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/host/printable.h"
#include "trocar/images/slice_names.h"
#include "volume_file.h"

namespace trocar::images {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;
using Content = ImageSeries::Content;

/// A volume in one file.
base::Status OpenVolume(const fs::path& path, const ImageSeriesOptions& options, const Progress& progress,
                        Content& content) {
  if (progress) progress("reading the volume", 0.0);
  auto decoded = DecodeFile(path, Links::kFollow, *content.pool);
  if (!decoded) return decoded.error();
  if (decoded->header.is_layered != 0) {
    const std::string printed = host::Printable(path.string());
    if (!decoded->names.empty())
      return Error{ErrorCode::kImageUnsupported,
                   printed + ": it holds segments in layers, no image; it is read as a label map"};
    return Error{ErrorCode::kImageUnsupported, printed + ": it holds a list of " +
                                                   std::to_string(decoded->header.channels) +
                                                   " values a voxel, no image; extract one of them"};
  }
  const ImageHeader& header = decoded->header;
  ImageSeriesInfo& info = content.info;
  info.format = FormatName(header.kind);
  info.file_frame = FrameName(header.frame);
  for (int k = 0; k < static_cast<int>(header.depth); ++k) info.slice_numbers.push_back(k);
  if (auto status = SetGeometry(GeometryOf(header), header, options, info); !status)
    return Error{status.error().code, host::Printable(path.string()) + ": " + status.error().message};
  SetGreyValues(header, decoded->samples.Data(), header.SampleCount(), info);
  content.headers = {header};
  content.samples = std::move(decoded->samples);
  return {};
}

/// A slice between two stored ones.
ColorImage RenderBetween(const Content& content, const SlicePlace& place, const DisplayWindow& window) {
  const ImageSeriesInfo& info = content.info;
  const ImageHeader& below = content.headers[place.below];
  if (place.part == 0)
    return RenderSlice(below, content.SamplesOf(place.below), window, info.width, info.height);
  const ImageHeader& above = content.headers[place.below + 1];
  if (below.channels == 3) {
    ColorImage mixed = RenderSlice(below, content.SamplesOf(place.below), window, info.width, info.height);
    const ColorImage other =
        RenderSlice(above, content.SamplesOf(place.below + 1), window, info.width, info.height);
    for (std::size_t i = 0; i < mixed.samples.size(); ++i) {
      mixed.samples[i] =
          base::RoundTo<std::uint8_t>(mixed.samples[i] + place.part * (other.samples[i] - mixed.samples[i]));
    }
    return mixed;
  }
  // before the window, which would cut what lies outside it
  ImageHeader header = below;
  header.samples = SampleKind::kFloat32;
  header.slope = 1, header.intercept = 0;
  std::vector<float> samples(below.SampleCount());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double low = below.slope * SampleAt(below, content.SamplesOf(place.below), i) + below.intercept;
    const double high =
        above.slope * SampleAt(above, content.SamplesOf(place.below + 1), i) + above.intercept;
    samples[i] = static_cast<float>(low + place.part * (high - low));
  }
  return RenderSlice(header, std::as_bytes(std::span(samples)).data(), window, info.width, info.height);
}

base::Status OpenFolder(const fs::path& folder, const ImageSeriesOptions& options, const Progress& progress,
                        Content& content) {
  auto found = LookInto(folder);
  if (!found) return found.error();
  if (found->files.empty())
    return Error{ErrorCode::kImageSliceMissing,
                 "the folder holds no files; name the one that the slices lie in"};
  if (options.pattern.empty() && !found->dicom.empty()) {
    content.info.ignored_files = found->files.size() - found->dicom.size();
    auto status = OpenDicom(folder, found->dicom, Links::kRefuse, options, progress, content);
    // reports or lists of contents beside pictures
    const bool has_pictures = std::any_of(found->files.begin(), found->files.end(), IsPictureName);
    if (status || status.error().code != ErrorCode::kImageSliceMissing || options.series != 0 ||
        !has_pictures)
      return status;
    content.info = {};
    auto stacked = OpenStack(folder, found->files, options, progress, content);
    return !stacked && stacked.error().code == ErrorCode::kImageSliceMissing ? status : stacked;
  }
  auto status = OpenStack(folder, found->files, options, progress, content);
  if (!status && status.error().code == ErrorCode::kImageSliceMissing && !found->volumes.empty() &&
      options.pattern.empty()) {
    return Error{ErrorCode::kImageSliceMissing, "the folder holds no slices, but the volume " +
                                                    host::Printable(found->volumes.front()) +
                                                    "; name that file itself"};
  }
  return status;
}

}  // namespace

base::Result<FolderContent> LookInto(const fs::path& folder) {
  auto names = ListFolder(folder);
  if (!names) return names.error();
  FolderContent content;
  for (std::string& name : *names) {
    std::error_code ignored;
    if (fs::symlink_status(folder / name, ignored).type() == fs::file_type::directory) continue;
    // a link or a pipe among the slices is refused here, not left out; among pictures, when it is one of the stack
    const bool is_picture = IsPictureName(name);
    const auto file = ImportFile::Open(folder / name, Links::kRefuse);
    if (!file && file.error().code == ErrorCode::kImagePathUnsafe && !is_picture) return file.error();
    const FileKind kind = file ? SniffKind(file->ReadBegin(348)) : FileKind::kUnknown;
    if (kind == FileKind::kDicom) content.dicom.push_back(name);
    const bool is_volume = kind >= FileKind::kNifti || name.ends_with(".nii.gz");
    if (is_volume && !is_picture) content.volumes.push_back(name);
    content.files.push_back(std::move(name));
  }
  return content;
}

ImageSeries::ImageSeries(std::shared_ptr<const Content> content) : content_(std::move(content)) {}

const ImageSeriesInfo& ImageSeries::Info() const {
  return content_->info;
}

base::Result<ImageSeries> ImageSeries::Open(const fs::path& path, const ImageSeriesOptions& options,
                                            const Progress& progress) {
  TROCAR_ASSERT(std::is_sorted(options.slices.begin(), options.slices.end()));
  ImportLimits limits;
  limits.most_bytes = options.memory_bytes;
  constexpr std::uint64_t kForItself = std::uint64_t{1} << 30;  // libraries, and a copy of one picture
  limits.reader_bytes = 2 * limits.most_bytes + kForItself;
  auto content = std::make_shared<Content>(limits);
  std::error_code failure;
  base::Status status;
  if (fs::is_directory(path, failure)) {
    status = OpenFolder(path, options, progress, *content);
    const bool is_named =
        !status && status.error().message.find(path.filename().string()) != std::string::npos;
    if (!status && !is_named)
      status = Error{status.error().code, host::Printable(path.string()) + ": " + status.error().message};
  } else {
    const auto file = ImportFile::Open(path, Links::kFollow);
    if (!file && file.error().code == ErrorCode::kFileMissing) {
      return Error{ErrorCode::kImageFolderMissing,
                   host::Printable(path.string()) + " does not exist; name the folder or file of the images"};
    }
    if (!file) return file.error();
    // samples of a pair of files may begin like anything
    const bool is_of_pair = FindHeader(path) != path;
    if (!is_of_pair && SniffKind(file->ReadBegin(348)) == FileKind::kDicom) {
      const std::string name = path.filename().string();
      status = OpenDicom(path.parent_path(), {&name, 1}, Links::kFollow, options, progress, *content);
    } else {
      status = OpenVolume(path, options, progress, *content);
    }
  }
  if (!status) return status.error();
  // a volume is here whole: its readers are no longer needed, and nobody else may write to it any more
  if (content->files.empty()) content->pool.reset();
  if (progress) progress("reading slices", 1.0);
  return ImageSeries(std::move(content));
}

base::Result<ColorImage> ImageSeries::ReadSlice(int number, const DisplayWindow& window) const {
  TROCAR_ASSERT(window.width > 0);
  const ImageSeriesInfo& info = content_->info;
  const auto found = std::lower_bound(info.slice_numbers.begin(), info.slice_numbers.end(), number);
  if (found == info.slice_numbers.end() || *found != number) {
    return Error{ErrorCode::kImageSliceMissing, "the series has no slice " + std::to_string(number) +
                                                    "; it has " + std::to_string(info.slice_numbers.front()) +
                                                    " to " + std::to_string(info.slice_numbers.back())};
  }
  const auto slice = static_cast<std::size_t>(found - info.slice_numbers.begin());
  if (!content_->places.empty()) return RenderBetween(*content_, content_->places[slice], window);
  const ImageHeader& header = content_->HeaderOf(slice);
  if (content_->files.empty())
    return RenderSlice(header, content_->SamplesOf(slice), window, info.width, info.height);
  auto picture = content_->WithPicture(slice, [&](const std::byte* samples) {
    return RenderSlice(header, samples, window, info.width, info.height);
  });
  if (!picture)
    return Error{picture.error().code, "slice " + std::to_string(number) + ": " + picture.error().message};
  return picture;
}

base::Result<std::map<int, ColorImage>> ReadSlices(const ImageSeries& series, std::span<const int> numbers,
                                                   const DisplayWindow& window, const Progress& progress) {
  std::vector<ColorImage> pictures(numbers.size());
  const auto status = ForEach(numbers.size(), progress, "reading slices", [&](std::size_t i) -> base::Status {
    auto picture = series.ReadSlice(numbers[i], window);
    if (!picture) return picture.error();
    pictures[i] = std::move(*picture);
    return {};
  });
  if (!status) return status.error();
  std::map<int, ColorImage> images;
  for (std::size_t i = 0; i < numbers.size(); ++i) images[numbers[i]] = std::move(pictures[i]);
  return images;
}

}  // namespace trocar::images
