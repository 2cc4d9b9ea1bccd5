// SPDX-License-Identifier: Apache-2.0
#include "trocar/images/series_list.h"

#include <algorithm>
#include <system_error>
#include <thread>
#include <utility>

#include "dicom_folder.h"
#include "series_content.h"
#include "series_geometry.h"
#include "trocar/host/printable.h"
#include "trocar/images/slice_names.h"
#include "volume_file.h"

namespace trocar::images {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;

constexpr int kDeepest = 3;                // folders in folders
constexpr std::size_t kMostFolders = 500;  // that are looked into
constexpr double kAnySliceMm = 1.0;        // of a single slice, which has no distance

/// Smaller by averaging, its longer side kPreviewSide.
ColorImage Shrink(const ColorImage& image) {
  const int longer = std::max(image.width, image.height);
  if (longer <= kPreviewSide) return image;
  ColorImage small{std::max(1, image.width * kPreviewSide / longer),
                   std::max(1, image.height * kPreviewSide / longer),
                   {}};
  small.samples.resize(static_cast<std::size_t>(small.width) * small.height * 3);
  for (int y = 0; y < small.height; ++y) {
    const int y0 = y * image.height / small.height,
              y1 = std::max(y0 + 1, (y + 1) * image.height / small.height);
    for (int x = 0; x < small.width; ++x) {
      const int x0 = x * image.width / small.width,
                x1 = std::max(x0 + 1, (x + 1) * image.width / small.width);
      for (int c = 0; c < 3; ++c) {
        int sum = 0;
        for (int v = y0; v < y1; ++v) {
          for (int u = x0; u < x1; ++u) sum += image.At(u, v)[c];
        }
        small.At(x, y)[c] = static_cast<std::uint8_t>(sum / ((x1 - x0) * (y1 - y0)));
      }
    }
  }
  return small;
}

void TakePreview(const base::Result<ImageSeries>& opened, ListedSeries& listed) {
  if (!opened.ok()) return;
  const ImageSeriesInfo& info = opened->Info();
  const auto slice =
      opened->ReadSlice(info.slice_numbers[info.slice_numbers.size() / 2], info.suggested_window);
  if (slice.ok()) listed.preview = Shrink(*slice);
}

/// Of one DICOM slice, whatever becomes of its series.
void TakePreview(const fs::path& folder, const DicomSlice& slice, ImportPool& pool, ListedSeries& listed) {
  const auto file = ImportFile::Open(folder / slice.file, Links::kRefuse);
  ImageHeader whole = slice.header;
  whole.depth = slice.frames;
  const std::uint64_t picture = PictureBytes(slice.header);
  if (!file || picture * slice.frames > pool.Limits().most_bytes) return;
  const auto samples = SampleBuffer::Make(picture * slice.frames);
  if (!samples || !pool.Decode(*file, nullptr, whole, *samples, 0)) return;
  ImageSeriesOptions alone;
  alone.slice_mm = kAnySliceMm;
  ImageSeriesInfo info;
  if (!SetGeometry(GeometryOf(slice.header), slice.header, alone, info)) return;
  const std::byte* begin = samples->Data() + picture * slice.frame;
  SetGreyValues(slice.header, begin, slice.header.SampleCount(), info);
  listed.preview = Shrink(RenderSlice(slice.header, begin, info.suggested_window, info.width, info.height));
}

/// "FOLDER: MESSAGE" unless the message names a file of it.
std::string NamePath(const fs::path& folder, const Error& error) {
  const bool is_named = error.message.find(folder.filename().string()) != std::string::npos;
  return is_named ? error.message : host::Printable(folder.string()) + ": " + error.message;
}

/// Collects the series of one folder after the other.
class Lister {
 public:
  Lister(const Progress& progress, const std::stop_token& stop) : progress_(progress), stop_(stop) {}

  bool IsStopped() const { return stop_.stop_requested(); }

  void AddFolder(const fs::path& folder, int depth) {
    if (IsStopped() || ++folders_ > kMostFolders) return;
    if (progress_) progress_("looking for images", -1);
    if (auto found = LookInto(folder); found.ok()) {
      const std::size_t before = found_.size();
      AddDicom(folder, found->dicom);
      // pictures beside slices are thumbnails: what the folder opens as are the slices
      const bool has_slices = found_.size() > before;
      for (const std::string& volume : found->volumes) AddVolume(folder / volume);
      if (!has_slices) AddPictures(folder, found->files);
    } else if (!problem_) {
      problem_ = found.error();
    }
    if (depth >= kDeepest) return;
    std::vector<fs::path> inside;
    std::error_code failure;
    for (fs::directory_iterator it(folder, failure), end; !failure && it != end; it.increment(failure)) {
      std::error_code ignored;
      const bool is_hidden = it->path().filename().string().starts_with('.');
      if (!is_hidden && it->symlink_status(ignored).type() == fs::file_type::directory)
        inside.push_back(it->path());
    }
    std::sort(inside.begin(), inside.end());
    for (const fs::path& one : inside) AddFolder(one, depth + 1);
  }

  void AddVolume(const fs::path& file) {
    if (IsStopped()) return;
    if (progress_) progress_("looking for images", -1);
    ListedSeries listed;
    listed.path = file;
    listed.description = host::Printable(file.filename().string(), 80);
    auto opened = ImageSeries::Open(file);
    if (!opened.ok() && opened.error().code == ErrorCode::kImageSpacingUnknown) {
      // the window asks for that; until then any size will do for a preview
      ImageSeriesOptions any;
      any.pixel_mm = any.slice_mm = kAnySliceMm;
      any.axes = {"left", "posterior", "superior"};
      opened = ImageSeries::Open(file, any);
      if (opened.ok()) Describe(opened->Info(), false, listed);
    } else if (opened.ok()) {
      Describe(opened->Info(), true, listed);
    }
    if (!opened.ok()) listed.problem = opened.error();
    TakePreview(opened, listed);
    found_.push_back(std::move(listed));
  }

  base::Result<std::vector<ListedSeries>> Take(const fs::path& path) {
    if (IsStopped()) return Error{ErrorCode::kCancelled, "the search for images was given up"};
    if (!found_.empty()) return std::move(found_);
    if (problem_) return *problem_;
    return Error{
        ErrorCode::kImageSliceMissing,
        host::Printable(path.string()) +
            ": there are no images; choose the folder that the DICOM files or numbered pictures lie in, or a "
            "NIfTI, NRRD or MetaImage file"};
  }

 private:
  static void Describe(const ImageSeriesInfo& info, bool has_sizes, ListedSeries& listed) {
    listed.format = info.format;
    listed.slices = info.slice_numbers.size();
    listed.width = info.width, listed.height = info.height;
    if (has_sizes) listed.pixel_mm = info.pixel_mm, listed.slice_mm = info.slice_mm;
  }

  void AddDicom(const fs::path& folder, const std::vector<std::string>& names) {
    if (names.empty()) return;
    ImportPool pool(ImportLimits(), std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, 8));
    const auto looked =
        LookAtDicom(folder, names, Links::kRefuse, pool, "looking for images", progress_, stop_);
    if (!looked.ok() || looked->slices.empty()) {
      const Error error = looked.ok() ? ExplainNoSlices(*looked) : looked.error();
      if (error.code != ErrorCode::kCancelled && !problem_)
        problem_ = Error{error.code, NamePath(folder, error)};
      return;
    }
    const std::vector<DicomVolume> volumes = SplitVolumes(looked->slices, looked->placeless);
    for (const DicomVolume& volume : volumes) {
      if (IsStopped()) return;
      ListedSeries listed;
      listed.path = folder;
      listed.options.series = volumes.size() > 1 ? volume.number : 0;
      const ImageHeader& first = volume.slices.front().header;
      listed.description = first.description[0] != '\0' ? host::Printable(first.description, 80)
                                                        : host::Printable(folder.filename().string(), 80);
      if (!volume.part.empty()) listed.description += ", " + volume.part;
      listed.format = "DICOM";
      listed.is_volume = volume.is_volume || volumes.size() == 1;
      listed.slices = volume.slices.size();
      listed.width = static_cast<int>(first.width), listed.height = static_cast<int>(first.height);
      listed.pixel_mm = std::min(first.spacing[0], first.spacing[1]);
      std::size_t middle = volume.slices.size() / 2;
      listed.problem = FindProblem(*looked, volumes, volume);
      if (volume.order.ok()) {
        listed.slice_mm = volume.order->slice_mm;
        listed.slices = volume.order->numbers.size();
        middle = volume.order->slices[volume.order->slices.size() / 2];
      }
      TakePreview(folder, volume.slices[middle], pool, listed);
      found_.push_back(std::move(listed));
    }
  }

  void AddPictures(const fs::path& folder, const std::vector<std::string>& files) {
    std::vector<std::string> names;
    for (const std::string& name : files) {
      if (IsPictureName(name)) names.push_back(name);
    }
    if (names.empty() || IsStopped()) return;
    ListedSeries listed;
    listed.path = folder;
    listed.description = host::Printable(folder.filename().string(), 80);
    ImageSeriesOptions any;
    any.pixel_mm = any.slice_mm = kAnySliceMm;
    any.axes = {"left", "posterior", "superior"};
    const auto opened = ImageSeries::Open(folder, any);
    if (!opened.ok()) {
      listed.problem = opened.error();
      listed.format = "PNG, JPEG, TIFF";
      listed.slices = names.size();
    } else {
      Describe(opened->Info(), false, listed);
      listed.options.pattern = opened->Info().pattern;
    }
    TakePreview(opened, listed);
    found_.push_back(std::move(listed));
  }

  const Progress& progress_;
  const std::stop_token& stop_;
  std::vector<ListedSeries> found_;
  std::optional<Error> problem_;  // of the first folder that cannot be read
  std::size_t folders_ = 0;
};

}  // namespace

base::Result<std::vector<ListedSeries>> ListSeries(const fs::path& path, const Progress& progress,
                                                   const std::stop_token& stop) {
  Lister lister(progress, stop);
  std::error_code failure;
  if (fs::is_directory(path, failure)) {
    lister.AddFolder(path, 0);
    return lister.Take(path);
  }
  const auto file = ImportFile::Open(path, Links::kFollow);
  if (!file && file.error().code == ErrorCode::kFileMissing) {
    return Error{ErrorCode::kImageFolderMissing,
                 host::Printable(path.string()) + " does not exist; choose the folder or file of the images"};
  }
  if (!file) return file.error();
  const bool is_slice =
      SniffKind(file->ReadBegin(348)) == FileKind::kDicom || IsPictureName(path.filename().string());
  if (is_slice && path.has_parent_path()) {
    lister.AddFolder(path.parent_path(), kDeepest);
  } else {
    lister.AddVolume(path);
  }
  return lister.Take(path);
}

}  // namespace trocar::images
