// SPDX-License-Identifier: Apache-2.0
// The only file that sees ITK. Its reader classes are used directly, without the object factories.
#include "trocar/anatomy/image_stack.h"

#include <itkJPEGImageIO.h>
#include <itkMetaDataObject.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkPNGImageIO.h>
#include <oneapi/tbb/parallel_for.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <optional>

#include "trocar/anatomy/control_points.h"
#include "trocar/core/safe_file.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;
using core::Error;
using core::ErrorCode;

constexpr std::size_t kMaxSide = 16384;  // pixels
constexpr std::size_t kMaxVoxels = std::size_t{1} << 28;
constexpr double kMostDeflated = 1040.0;  // no deflate stream holds more bytes for one of its own
constexpr std::size_t kMaxFileBytes = std::size_t{256} << 20;

Error Undecodable(const fs::path& path, const std::string& why) {
  return {ErrorCode::kImageUndecodable,
          path.string() + " cannot be decoded: " + why + "; get the file again"};
}

enum class Kind { kJpeg, kPng };

/// JPEG decoders fill what is missing with grey: a file must reach its end marker to count as whole.
std::optional<Kind> FindWholeKind(std::string_view bytes) {
  if (bytes.size() > 4 && bytes.substr(0, 3) == "\xff\xd8\xff") {
    const auto end = bytes.find_last_not_of('\0');
    if (end != std::string_view::npos && end > 3 && bytes.substr(end - 1, 2) == "\xff\xd9")
      return Kind::kJpeg;
  }
  if (bytes.size() > 8 && bytes.substr(0, 8) == "\x89PNG\r\n\x1a\n" &&
      bytes.find("IEND") != std::string_view::npos) {
    return Kind::kPng;
  }
  return std::nullopt;
}

struct ExpectedSize {
  int width = 0, height = 0;  // 0: any
};

core::Result<ColorImage> Decode(const fs::path& path, ExpectedSize expected) {
  const auto bytes = core::ReadFile(path, kMaxFileBytes);
  if (!bytes.ok()) {
    if (bytes.error().code == ErrorCode::kFileMissing) return bytes.error();
    return Undecodable(path, bytes.error().message);
  }
  const auto kind = FindWholeKind(*bytes);
  if (!kind) return Undecodable(path, "it is no whole JPEG or PNG file");
  try {
    itk::ImageIOBase::Pointer reader;
    if (*kind == Kind::kJpeg)
      reader = itk::JPEGImageIO::New();
    else
      reader = itk::PNGImageIO::New();
    reader->SetFileName(path.string());
    reader->ReadImageInformation();
    const std::size_t width = reader->GetDimensions(0), height = reader->GetDimensions(1);
    const std::size_t channels = reader->GetNumberOfComponents();
    if (width == 0 || height == 0 || width > kMaxSide || height > kMaxSide) {
      return Undecodable(path, "its size is not between 1 and 16384 pixels");
    }
    if (expected.width != 0 &&
        (static_cast<int>(width) != expected.width || static_cast<int>(height) != expected.height)) {
      return Error{ErrorCode::kImageSizeDiffers,
                   path.string() + " has " + std::to_string(width) + " x " + std::to_string(height) +
                       " pixels, but the control points were placed on " + std::to_string(expected.width) +
                       " x " + std::to_string(expected.height) +
                       "; use the images that the points belong to"};
    }
    if (reader->GetComponentType() != itk::IOComponentEnum::UCHAR || channels == 0 || channels > 4) {
      return Undecodable(path, "it does not have 8 bits a channel");
    }
    std::vector<std::uint8_t> raw(width * height * channels);
    itk::ImageIORegion region(2);
    region.SetSize(0, width);
    region.SetSize(1, height);
    reader->SetIORegion(region);
    reader->Read(raw.data());

    ColorImage image{static_cast<int>(width), static_cast<int>(height), {}};
    image.samples.resize(width * height * 3);
    const bool is_grey = channels < 3;
    for (std::size_t i = 0; i < width * height; ++i) {
      for (std::size_t c = 0; c < 3; ++c) image.samples[3 * i + c] = raw[channels * i + (is_grey ? 0 : c)];
    }
    return image;
  } catch (const std::exception& failure) {
    return Undecodable(path, failure.what());
  }
}

/// Segment names that 3D Slicer keeps: Segment0_Name, Segment0_LabelValue.
std::vector<std::pair<std::string, int>> ReadSegmentNames(const itk::MetaDataDictionary& header) {
  std::vector<std::pair<std::string, int>> names;
  for (int i = 0; i < 256; ++i) {
    const std::string segment = "Segment" + std::to_string(i);
    std::string name, value;
    if (!itk::ExposeMetaData<std::string>(header, segment + "_Name", name)) continue;
    if (!itk::ExposeMetaData<std::string>(header, segment + "_LabelValue", value)) continue;
    char* end = nullptr;
    const long label = std::strtol(value.c_str(), &end, 10);
    if (end != value.c_str() && *end == '\0' && label > 0 && label < 256) {
      names.emplace_back(name, static_cast<int>(label));
    }
  }
  return names;
}

template <typename Sample>
bool CopyLabels(const std::vector<char>& raw, std::vector<std::uint8_t>& labels) {
  for (std::size_t i = 0; i < labels.size(); ++i) {
    Sample value;
    std::memcpy(&value, raw.data() + i * sizeof(Sample), sizeof(Sample));
    const auto number = static_cast<double>(value);
    if (!(number >= 0.0 && number <= 255.0) || number != std::floor(number)) return false;
    labels[i] = static_cast<std::uint8_t>(number);
  }
  return true;
}

}  // namespace

core::Result<ColorImage> ReadImage(const fs::path& path) {
  return Decode(path, {});
}

core::Result<std::map<int, ColorImage>> LoadSlices(const SliceFolder& source, std::span<const int> slices,
                                                   const Progress& progress) {
  std::error_code ignored;
  if (!fs::is_directory(source.folder, ignored)) {
    return Error{ErrorCode::kImageFolderMissing,
                 source.folder.string() + " is not a folder; name the folder that holds the slices"};
  }
  // batches keep the progress callback on this thread
  constexpr std::size_t kBatch = 8;
  std::vector<std::optional<core::Result<ColorImage>>> decoded(slices.size());
  for (std::size_t begin = 0; begin < slices.size(); begin += kBatch) {
    const std::size_t end = std::min(begin + kBatch, slices.size());
    if (progress) progress("reading slices", static_cast<double>(begin) / static_cast<double>(slices.size()));
    oneapi::tbb::parallel_for(begin, end, [&](std::size_t i) {
      decoded[i] =
          Decode(source.folder / FormatImageName(source.pattern, slices[i]), {source.width, source.height});
    });
    for (std::size_t i = begin; i < end; ++i) {
      if (decoded[i]->ok()) continue;
      Error error = decoded[i]->error();
      if (error.code == ErrorCode::kFileMissing) {
        return Error{ErrorCode::kImageSliceMissing,
                     "slice " + std::to_string(slices[i]) + " is missing: " +
                         (source.folder / FormatImageName(source.pattern, slices[i])).string() +
                         " does not exist; complete the folder or correct the naming pattern"};
      }
      error.message = "slice " + std::to_string(slices[i]) + ": " + error.message;
      return error;
    }
  }
  std::map<int, ColorImage> images;
  for (std::size_t i = 0; i < slices.size(); ++i) images[slices[i]] = std::move(**decoded[i]);
  return images;
}

core::Result<LabelVolume> ReadLabelVolume(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) {
    return Error{ErrorCode::kFileMissing, path.string() + " does not exist; name a NIfTI or NRRD label map"};
  }
  try {
    itk::ImageIOBase::Pointer reader = itk::NiftiImageIO::New().GetPointer();
    if (!reader->CanReadFile(path.c_str())) reader = itk::NrrdImageIO::New().GetPointer();
    if (!reader->CanReadFile(path.c_str())) return Undecodable(path, "it is no NIfTI or NRRD file");
    reader->SetFileName(path.string());
    reader->ReadImageInformation();
    if (reader->GetNumberOfDimensions() != 3 || reader->GetNumberOfComponents() != 1) {
      return Undecodable(path, "it is no volume of single labels");
    }
    LabelVolume volume;
    std::size_t count = 1;
    itk::ImageIORegion region(3);
    for (unsigned axis = 0; axis < 3; ++axis) {
      const std::size_t size = reader->GetDimensions(axis);
      if (size == 0 || size > kMaxVoxels / count) return Undecodable(path, "it has too many voxels");
      count *= size;
      volume.size[axis] = static_cast<int>(size);
      region.SetSize(axis, size);
      volume.origin[axis] = reader->GetOrigin(axis);
      const std::vector<double> unit = reader->GetDirection(axis);
      for (unsigned k = 0; k < 3; ++k) volume.direction[axis][k] = unit[k] * reader->GetSpacing(axis);
    }
    const auto bytes = static_cast<std::size_t>(reader->GetImageSizeInBytes());
    // a detached header keeps its voxels in another file, whose size the reader itself compares
    const std::string extension = path.extension().string();
    const double most = extension == ".nii" ? 1.0 : kMostDeflated;
    if (extension != ".nhdr" &&
        static_cast<double>(bytes) > most * static_cast<double>(fs::file_size(path))) {
      return Undecodable(path, "it is too small for the size in its header");
    }
    volume.names = ReadSegmentNames(reader->GetMetaDataDictionary());
    std::vector<char> raw(bytes);
    reader->SetIORegion(region);
    reader->Read(raw.data());
    volume.labels.resize(count);
    bool is_whole = false;
    switch (reader->GetComponentType()) {
      case itk::IOComponentEnum::UCHAR:
        is_whole = CopyLabels<std::uint8_t>(raw, volume.labels);
        break;
      case itk::IOComponentEnum::CHAR:
        is_whole = CopyLabels<std::int8_t>(raw, volume.labels);
        break;
      case itk::IOComponentEnum::USHORT:
        is_whole = CopyLabels<std::uint16_t>(raw, volume.labels);
        break;
      case itk::IOComponentEnum::SHORT:
        is_whole = CopyLabels<std::int16_t>(raw, volume.labels);
        break;
      case itk::IOComponentEnum::INT:
        is_whole = CopyLabels<std::int32_t>(raw, volume.labels);
        break;
      case itk::IOComponentEnum::UINT:
        is_whole = CopyLabels<std::uint32_t>(raw, volume.labels);
        break;
      case itk::IOComponentEnum::FLOAT:
        is_whole = CopyLabels<float>(raw, volume.labels);
        break;
      case itk::IOComponentEnum::DOUBLE:
        is_whole = CopyLabels<double>(raw, volume.labels);
        break;
      default:
        break;
    }
    if (!is_whole) return Undecodable(path, "its voxels are not whole numbers from 0 to 255");
    return volume;
  } catch (const std::exception& failure) {
    return Undecodable(path, failure.what());
  }
}

}  // namespace trocar::anatomy
