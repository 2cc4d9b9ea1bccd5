// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/image_series.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <span>
#include <thread>

#include "dicom_series.h"
#include "image_frame.h"
#include "import_worker.h"
#include "slice_names.h"
#include "trocar/core/assert.h"
#include "trocar/core/printable.h"
#include "volume_file.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;
using core::Error;
using core::ErrorCode;
using math::Vec3;

constexpr double kSameLength = 0.01;  // share by which a given distance may differ from the file's
constexpr double kSquare = 1e-3;      // share by which pixels may differ from squares
constexpr std::size_t kMostReaders = 8;
constexpr std::size_t kBatch = 16;  // files between two calls of the progress

const char* FormatName(FileKind kind) {
  switch (kind) {
    case FileKind::kJpeg:
      return "JPEG";
    case FileKind::kPng:
      return "PNG";
    case FileKind::kTiff:
      return "TIFF";
    case FileKind::kDicom:
      return "DICOM";
    case FileKind::kNifti:
      return "NIfTI";
    case FileKind::kNrrd:
      return "NRRD";
    case FileKind::kMetaImage:
      return "MetaImage";
    case FileKind::kUnknown:
      break;
  }
  return "";
}

std::uint64_t PictureBytes(const ImageHeader& header) {
  return std::uint64_t{header.width} * header.height * header.channels * SampleBytes(header.samples);
}

std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.4g", value);
  return text;
}

}  // namespace

struct ImageSeries::Content {
  explicit Content(ImportLimits limits)
      : pool(std::make_unique<ImportPool>(
            std::move(limits),
            std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, kMostReaders))) {}

  ImageSeriesInfo info;
  std::vector<ImageHeader> headers;  ///< of each slice; of a volume, one for all
  // a stack of pictures: decoded when asked for
  std::vector<fs::path> files;
  std::unique_ptr<ImportPool> pool;
  // a volume: its samples, slice after slice
  SampleBuffer samples;

  const ImageHeader& HeaderOf(std::size_t slice) const {
    return headers[std::min(slice, headers.size() - 1)];
  }
  core::Result<SampleBuffer> DecodePicture(std::size_t slice) const {
    const auto file = ImportFile::Open(files[slice], Links::kRefuse);
    if (!file) return file.error();
    auto buffer = SampleBuffer::Make(PictureBytes(headers[slice]));
    if (!buffer) return buffer.error();
    if (auto status = pool->Decode(*file, nullptr, headers[slice], *buffer, 0); !status)
      return status.error();
    return buffer;
  }
};

namespace {

using Content = ImageSeries::Content;

/// Runs `work` for every index in parallel and tells the progress from this thread.
/// \return the error of the lowest index
template <typename Work>
core::Status ForEach(std::size_t count, const Progress& progress, const char* what, const Work& work) {
  for (std::size_t begin = 0; begin < count; begin += kBatch) {
    const std::size_t end = std::min(begin + kBatch, count);
    if (progress) progress(what, static_cast<double>(begin) / static_cast<double>(count));
    std::vector<core::Status> status(end - begin);
    oneapi::tbb::parallel_for(begin, end, [&](std::size_t i) { status[i - begin] = work(i); });
    for (core::Status& one : status) {
      if (!one) return std::move(one);
    }
  }
  return {};
}

/// What the files say of size and place; unknown where they say nothing.
struct SaidGeometry {
  double spacing[2] = {0, 0};  // of columns and rows [mm]
  double slice_mm = 0;
  bool has_direction = false;
  std::array<Vec3, 3> direction;
  Vec3 origin;
};

/// A length that a file says, a person gives, or both.
core::Result<double> Agree(const char* option, double said, const std::optional<double>& given) {
  if (!given) return said;
  if (said > 0 && std::fabs(said - *given) > kSameLength * said) {
    return Error{ErrorCode::kImageGeometryInvalid, "its header says " + Number(said) + " mm, but " + option +
                                                       " " + Number(*given) +
                                                       " was given; leave the option out"};
  }
  return said > 0 ? said : *given;
}

/// Fills in size, spacing and axes of the pictures that come out.
core::Status SetGeometry(const SaidGeometry& said, const ImageHeader& header,
                         const ImageSeriesOptions& options, ImageSeriesInfo& info) {
  const double finer = std::min(said.spacing[0], said.spacing[1]);
  const auto pixel_mm = Agree("--pixel-mm", finer, options.pixel_mm);
  if (!pixel_mm) return pixel_mm.error();
  const auto slice_mm = Agree("--slice-mm", said.slice_mm, options.slice_mm);
  if (!slice_mm) return slice_mm.error();
  std::string missing;
  const auto ask = [&](bool is_known, const char* option) {
    if (!is_known) missing += (missing.empty() ? "" : ", ") + std::string(option);
  };
  ask(*pixel_mm > 0, "--pixel-mm MM (side of a pixel)");
  ask(*slice_mm > 0, "--slice-mm MM (from one slice number to the next)");
  ask(said.has_direction || options.axes,
      "--axes COLUMN,ROW,SLICE (where they grow to in the patient, for example left,posterior,superior)");
  if (!missing.empty())
    return Error{ErrorCode::kImageSpacingUnknown,
                 "the files do not say how large the patient is or lies; give " + missing};
  info.pixel_mm = *pixel_mm;
  info.slice_mm = *slice_mm;
  if (!(info.pixel_mm >= 0.01 && info.pixel_mm <= 20.0) ||
      !(info.slice_mm >= 0.01 && info.slice_mm <= 50.0)) {
    return Error{
        ErrorCode::kImageGeometryInvalid,
        "pixels of " + Number(info.pixel_mm) + " mm in slices " + Number(info.slice_mm) +
            " mm apart are no images of a patient; pixels of 0.01 to 20 mm and slices of 0.01 to 50 mm are"};
  }
  const auto given = options.axes ? FindDirections(*options.axes) : said.direction;
  if (!given) return given.error();
  const auto named = NameAxes(said.has_direction ? said.direction : *given);
  if (!named) return named.error();
  if (options.axes && named->axes != *options.axes) {
    return Error{ErrorCode::kImageGeometryInvalid, "its axes run " + named->axes[0] + ", " + named->axes[1] +
                                                       ", " + named->axes[2] +
                                                       " by its header, not as --axes says; leave "
                                                       "the option out"};
  }
  info.axes = named->axes;
  info.tilt_deg = named->tilt_deg;
  const auto& direction = said.has_direction ? said.direction : *given;
  for (int axis = 0; axis < 3; ++axis)
    info.direction[axis] = {direction[axis].x, direction[axis].y, direction[axis].z};
  info.origin_mm = {said.origin.x, said.origin.y, said.origin.z};

  info.width = static_cast<int>(header.width), info.height = static_cast<int>(header.height);
  if (finer > 0) {
    const auto resampled = [&](std::uint32_t stored, double spacing) {
      if (spacing <= finer * (1 + kSquare)) return static_cast<int>(stored);
      return static_cast<int>(std::lround((stored - 1) * spacing / finer)) + 1;
    };
    info.width = resampled(header.width, said.spacing[0]);
    info.height = resampled(header.height, said.spacing[1]);
  }
  constexpr int kMostSide = 16384;
  if (info.width > kMostSide || info.height > kMostSide) {
    return Error{ErrorCode::kImageGeometryInvalid, "its pixels are " + Number(said.spacing[0]) + " x " +
                                                       Number(said.spacing[1]) +
                                                       " mm, too far from square; resample it"};
  }
  return {};
}

SaidGeometry GeometryOf(const ImageHeader& header) {
  SaidGeometry said;
  said.spacing[0] = header.spacing[0], said.spacing[1] = header.spacing[1];
  said.slice_mm = header.spacing[2];
  said.has_direction = header.frame != FileFrame::kNotSaid;
  for (int axis = 0; axis < 3; ++axis)
    said.direction[axis] = {header.direction[axis][0], header.direction[axis][1], header.direction[axis][2]};
  said.origin = {header.origin[0], header.origin[1], header.origin[2]};
  return said;
}

const char* FrameName(const ImageHeader& header) {
  return header.frame == FileFrame::kLps ? "LPS" : header.frame == FileFrame::kRas ? "RAS" : "";
}

/// Grey range and suggested window from some samples.
void SetGreyValues(const ImageHeader& header, const std::byte* samples, std::size_t count,
                   ImageSeriesInfo& info) {
  info.is_color = header.channels == 3;
  info.bits = static_cast<int>(header.bits);
  if (info.is_color) return;
  const GreyStatistics grey = MeasureGrey(header, samples, count);
  info.grey_range = {grey.least, grey.greatest};
  if (header.has_window != 0) {
    info.suggested_window = {header.window_centre, header.window_width};
  } else if (header.samples != SampleKind::kUint8 || header.slope != 1 || header.intercept != 0) {
    info.suggested_window = grey.window;
  } else if (constexpr double kFewLabels = 32.0; grey.greatest < kFewLabels) {
    // labels, not light: all of them are to be seen
    info.suggested_window = {0.5 * grey.greatest, std::max(1.0, grey.greatest)};
  }
}

/// A volume in one file.
core::Status OpenVolume(const fs::path& path, const ImageSeriesOptions& options, const Progress& progress,
                        Content& content) {
  if (progress) progress("reading the volume", 0.0);
  auto decoded = DecodeFile(path, Links::kFollow, *content.pool);
  if (!decoded) return decoded.error();
  const ImageHeader& header = decoded->header;
  ImageSeriesInfo& info = content.info;
  info.format = FormatName(header.kind);
  info.file_frame = FrameName(header);
  for (int k = 0; k < static_cast<int>(header.depth); ++k) info.slice_numbers.push_back(k);
  if (auto status = SetGeometry(GeometryOf(header), header, options, info); !status)
    return Error{status.error().code, core::Printable(path.string()) + ": " + status.error().message};
  SetGreyValues(header, decoded->samples.Data(), header.SampleCount(), info);
  content.headers = {header};
  content.samples = std::move(decoded->samples);
  return {};
}

/// Numbered pictures in a folder: headers now, samples when asked for.
core::Status OpenStack(const fs::path& folder, std::span<const std::string> names,
                       const ImageSeriesOptions& options, const Progress& progress, Content& content) {
  const auto named = FindNamedSlices(names, options.pattern);
  if (!named) return named.error();
  ImageSeriesInfo& info = content.info;
  for (const int wanted : options.slices) {
    if (named->files.contains(wanted)) continue;
    return Error{ErrorCode::kImageSliceMissing,
                 "slice " + std::to_string(wanted) + " is missing: there is no file like " +
                     core::Printable(named->pattern) +
                     " for it; complete the folder or correct the naming pattern"};
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
      ForEach(content.files.size(), progress, "looking at slices", [&](std::size_t i) -> core::Status {
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
    const std::string name = "slice " + std::to_string(info.slice_numbers[i]);
    if (header.depth != 1 || header.kind > FileKind::kTiff) {
      return Error{ErrorCode::kImageSeriesMixed, name + " (" + core::Printable(content.files[i].string()) +
                                                     ") is no single picture; open it by itself"};
    }
    if (header.width != first.width || header.height != first.height) {
      return Error{ErrorCode::kImageSizeDiffers, name + " has " + std::to_string(header.width) + " x " +
                                                     std::to_string(header.height) + " pixels, slice " +
                                                     std::to_string(info.slice_numbers[0]) + " has " +
                                                     std::to_string(first.width) + " x " +
                                                     std::to_string(first.height) + "; give all one size"};
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
  const auto samples = content.DecodePicture(middle);
  if (!samples) return samples.error();
  SetGreyValues(content.headers[middle], samples->Data(), content.headers[middle].SampleCount(), info);
  return {};
}

/// The DICOM files of a folder, or one file.
core::Status OpenDicom(const fs::path& folder, std::span<const std::string> names, Links links,
                       const ImageSeriesOptions& options, const Progress& progress, Content& content) {
  std::vector<std::optional<DicomSlice>> found(names.size());
  const auto looked =
      ForEach(names.size(), progress, "looking at slices", [&](std::size_t i) -> core::Status {
        const auto file = ImportFile::Open(folder / names[i], links);
        if (!file) return file.error();
        const auto reply = content.pool->Probe(*file);
        // reports, plans and folders of contents lie among the slices
        if (!reply && reply.error().code == ErrorCode::kImageUnsupported && names.size() > 1 &&
            reply.error().message.find("without a picture") != std::string::npos)
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

/// Sorts a folder's names into what could be a slice.
struct FolderContent {
  std::vector<std::string> files, dicom;
  std::string volume;  ///< a file that is a series by itself
};

core::Result<FolderContent> LookInto(const fs::path& folder) {
  auto names = ListFolder(folder);
  if (!names) return names.error();
  FolderContent content;
  for (std::string& name : *names) {
    std::error_code ignored;
    if (fs::symlink_status(folder / name, ignored).type() == fs::file_type::directory) continue;
    if (!IsPictureName(name)) {
      // a link or a pipe among the slices is refused here, not left out
      const auto file = ImportFile::Open(folder / name, Links::kRefuse);
      if (!file && file.error().code == ErrorCode::kImagePathUnsafe) return file.error();
      const FileKind kind = file ? SniffKind(file->ReadBegin(348)) : FileKind::kUnknown;
      if (kind == FileKind::kDicom) content.dicom.push_back(name);
      const bool is_volume = kind >= FileKind::kNifti || name.ends_with(".nii.gz");
      if (is_volume && content.volume.empty()) content.volume = name;
    }
    content.files.push_back(std::move(name));
  }
  return content;
}

core::Status OpenFolder(const fs::path& folder, const ImageSeriesOptions& options, const Progress& progress,
                        Content& content) {
  auto found = LookInto(folder);
  if (!found) return found.error();
  if (options.pattern.empty() && !found->dicom.empty()) {
    content.info.ignored_files = found->files.size() - found->dicom.size();
    return OpenDicom(folder, found->dicom, Links::kRefuse, options, progress, content);
  }
  auto status = OpenStack(folder, found->files, options, progress, content);
  if (!status && status.error().code == ErrorCode::kImageSliceMissing && !found->volume.empty() &&
      options.pattern.empty()) {
    return Error{ErrorCode::kImageSliceMissing, "the folder holds no slices, but the volume " +
                                                    core::Printable(found->volume) +
                                                    "; name that file itself"};
  }
  return status;
}

}  // namespace

ImageSeries::ImageSeries(std::shared_ptr<const Content> content) : content_(std::move(content)) {}

const ImageSeriesInfo& ImageSeries::Info() const {
  return content_->info;
}

core::Result<ImageSeries> ImageSeries::Open(const fs::path& path, const ImageSeriesOptions& options,
                                            const Progress& progress) {
  TROCAR_ASSERT(std::is_sorted(options.slices.begin(), options.slices.end()));
  ImportLimits limits;
  limits.most_bytes = options.memory_bytes;
  constexpr std::uint64_t kForItself = std::uint64_t{1} << 30;  // libraries, and a copy of one picture
  limits.reader_bytes = 2 * limits.most_bytes + kForItself;
  auto content = std::make_shared<Content>(limits);
  std::error_code failure;
  core::Status status;
  if (fs::is_directory(path, failure)) {
    status = OpenFolder(path, options, progress, *content);
    const bool is_named =
        !status && status.error().message.find(path.filename().string()) != std::string::npos;
    if (!status && !is_named)
      status = Error{status.error().code, core::Printable(path.string()) + ": " + status.error().message};
  } else {
    const auto file = ImportFile::Open(path, Links::kFollow);
    if (!file) return file.error();
    if (SniffKind(file->ReadBegin(348)) == FileKind::kDicom) {
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

core::Result<ColorImage> ImageSeries::ReadSlice(int number, const DisplayWindow& window) const {
  TROCAR_ASSERT(window.width > 0);
  const ImageSeriesInfo& info = content_->info;
  const auto found = std::lower_bound(info.slice_numbers.begin(), info.slice_numbers.end(), number);
  if (found == info.slice_numbers.end() || *found != number) {
    return Error{ErrorCode::kImageSliceMissing, "the series has no slice " + std::to_string(number) +
                                                    "; it has " + std::to_string(info.slice_numbers.front()) +
                                                    " to " + std::to_string(info.slice_numbers.back())};
  }
  const auto slice = static_cast<std::size_t>(found - info.slice_numbers.begin());
  const ImageHeader& header = content_->HeaderOf(slice);
  if (content_->files.empty()) {
    const std::byte* samples = content_->samples.Data() + slice * PictureBytes(header);
    return RenderSlice(header, samples, window, info.width, info.height);
  }
  const auto samples = content_->DecodePicture(slice);
  if (!samples)
    return Error{samples.error().code, "slice " + std::to_string(number) + ": " + samples.error().message};
  return RenderSlice(header, samples->Data(), window, info.width, info.height);
}

core::Result<std::map<int, ColorImage>> ReadSlices(const ImageSeries& series, std::span<const int> numbers,
                                                   const DisplayWindow& window, const Progress& progress) {
  std::vector<ColorImage> pictures(numbers.size());
  const auto status = ForEach(numbers.size(), progress, "reading slices", [&](std::size_t i) -> core::Status {
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

}  // namespace trocar::anatomy
