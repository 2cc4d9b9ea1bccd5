// SPDX-License-Identifier: Apache-2.0
#include "trocar/images/image_stack.h"

#include <cmath>

#include "trocar/host/printable.h"
#include "trocar/roles/roles.h"
#include "volume_file.h"

namespace trocar::images {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;
using roles::OrganRole;

constexpr std::uint64_t kMostVoxels = std::uint64_t{1} << 28;
constexpr std::uint64_t kForItself = std::uint64_t{1} << 30;  // address space of a reader beside the samples

Error Undecodable(const fs::path& path, const std::string& why) {
  return {ErrorCode::kImageUndecodable, host::Printable(path.string()) + ": " + why};
}

base::Result<DecodedFile> DecodeAlone(const fs::path& path, std::uint64_t most_bytes,
                                      Links links = Links::kFollow) {
  ImportLimits limits;
  limits.most_bytes = most_bytes;
  limits.reader_bytes = 2 * most_bytes + kForItself;
  ImportPool pool(limits, 1);
  return DecodeFile(path, links, pool);
}

/// Joins layers whose segments may overlap into labels 1, 2, ... in the order of `segments`. A voxel of several
/// segments goes to the smallest of them: a gallbladder within a liver stays whole.
/// \return what keeps a sample from being a label; empty when all are labels
std::string JoinLayers(const DecodedFile& file, LabelVolume& volume) {
  const std::size_t count = volume.labels.size();
  std::vector<std::int32_t> layer(count);
  std::vector<std::size_t> sizes(file.names.size(), 0);
  const auto for_each_voxel = [&](const auto& use) -> std::string {
    for (std::uint32_t channel = 0; channel < file.header.channels; ++channel) {
      if (std::string fault = CopyLabels(file.header, file.samples.Data(), channel, layer); !fault.empty())
        return fault;
      for (std::size_t segment = 0; segment < file.names.size(); ++segment) {
        if (file.names[segment].layer != channel) continue;
        for (std::size_t i = 0; i < count; ++i) {
          if (layer[i] == file.names[segment].label) use(segment, i);
        }
      }
    }
    return {};
  };
  if (std::string fault = for_each_voxel([&](std::size_t segment, std::size_t) { ++sizes[segment]; });
      !fault.empty())
    return fault;
  std::string fault = for_each_voxel([&](std::size_t segment, std::size_t i) {
    std::int32_t& label = volume.labels[i];
    if (label == 0 || sizes[segment] < sizes[static_cast<std::size_t>(label - 1)])
      label = static_cast<std::int32_t>(segment + 1);
  });
  for (std::size_t segment = 0; segment < file.names.size(); ++segment) {
    volume.names.emplace_back(file.names[segment].name, static_cast<int>(segment + 1));
    if (file.names[segment].code[0] != '\0')
      volume.codes.emplace_back(file.names[segment].code, static_cast<int>(segment + 1));
  }
  return fault;
}

base::Result<LabelVolume> ReadLabelFile(const fs::path& path, Links links) {
  auto decoded = DecodeAlone(path, kMostVoxels * SampleBytes(SampleKind::kFloat32), links);
  if (!decoded) {
    const Error& error = decoded.error();
    const bool is_seg =
        error.code == ErrorCode::kImageSliceMissing && error.message.find("(SEG)") != std::string::npos;
    if (!is_seg) return error;
    return Error{
        ErrorCode::kImageUnsupported,
        host::Printable(path.string()) +
            ": it is a DICOM segmentation (SEG), which is not read as a label map; export it from 3D "
            "Slicer as .seg.nrrd, or convert it with dcmqi and give its JSON with --names: both keep "
            "what its segments are called and coded as"};
  }
  const ImageHeader& header = decoded->header;
  if (header.kind < FileKind::kNifti || (header.channels != 1 && header.is_layered == 0))
    return Undecodable(path, "it is no volume of labels; name a NIfTI, NRRD or MetaImage label map");
  const std::uint64_t count = header.SampleCount() / header.channels;
  if (count > kMostVoxels)
    return Error{ErrorCode::kImageTooLarge,
                 host::Printable(path.string()) + ": it has more than 2^28 voxels; crop or resample it"};
  const bool has_spacing = header.spacing[0] > 0 && header.spacing[1] > 0 && header.spacing[2] > 0;
  if (!has_spacing) {
    return Error{
        ErrorCode::kImageSpacingUnknown,
        host::Printable(path.string()) +
            ": it does not say how large its voxels are; save it with that, for instance with 3D Slicer"};
  }
  if (header.frame == FileFrame::kNotSaid) {
    return Error{
        ErrorCode::kImageSpacingUnknown,
        host::Printable(path.string()) +
            ": it does not say how it lies in the body; save it with that, for instance with 3D Slicer"};
  }
  LabelVolume volume;
  volume.size = {static_cast<int>(header.width), static_cast<int>(header.height),
                 static_cast<int>(header.depth)};
  for (int axis = 0; axis < 3; ++axis) {
    volume.origin[axis] = header.origin[axis];
    for (int k = 0; k < 3; ++k) volume.direction[axis][k] = header.direction[axis][k] * header.spacing[axis];
  }
  volume.labels.resize(count);
  const bool is_layered = header.is_layered != 0;
  if (is_layered && decoded->names.empty())
    return Undecodable(path,
                       "it has layers of segments, and does not say which label of which layer is what");
  const std::string fault = is_layered ? JoinLayers(*decoded, volume)
                                       : CopyLabels(header, decoded->samples.Data(), 0, volume.labels);
  if (!fault.empty()) {
    return Undecodable(
        path, "its voxels are no labels: " + fault +
                  "; name a label map of whole numbers from 0 on (32-bit integers where they are large), "
                  "resampled by nearest neighbour if at all");
  }
  if (!is_layered) {
    for (const SegmentName& segment : decoded->names) {
      volume.names.emplace_back(segment.name, segment.label);
      if (segment.code[0] != '\0') volume.codes.emplace_back(segment.code, segment.label);
    }
  }
  return volume;
}

/// The file of an organ's mask in a folder; empty where there is none.
fs::path FindMask(const fs::path& folder, const std::string& organ) {
  std::error_code ignored;
  for (const char* ending : {".nii.gz", ".nii", ".nrrd", ".mha"}) {
    const fs::path file = folder / (organ + ending);
    if (fs::symlink_status(file, ignored).type() != fs::file_type::not_found) return file;
  }
  return {};
}

bool LieAlike(const LabelVolume& a, const LabelVolume& b) {
  constexpr double kSamePlaceMm = 0.01;  // headers hold single precision
  const auto is_same = [](double x, double y) { return std::fabs(x - y) <= kSamePlaceMm; };
  bool is_alike = a.size == b.size;
  for (std::size_t k = 0; k < 3; ++k) {
    is_alike = is_alike && is_same(a.origin[k], b.origin[k]);
    // what a voxel's step differs by adds up to the last voxel
    for (std::size_t axis = 0; axis < 3; ++axis)
      is_alike =
          is_alike && is_same(a.size[axis] * a.direction[axis][k], a.size[axis] * b.direction[axis][k]);
  }
  return is_alike;
}

Error DifferingMasks(const fs::path& folder) {
  return {ErrorCode::kLabelsMismatch, host::Printable(folder.string()) +
                                          ": its masks differ in size or place; write them all for the same "
                                          "image"};
}

/// Masks of what lies round liver and gallbladder that are there, as labels from 3 on where no other one is.
base::Status AddNeighbourMasks(const fs::path& folder, LabelVolume& all) {
  std::vector<std::string> names;
  for (std::size_t i = 1; i < roles::kNeighbourRoleCount; ++i)
    names.emplace_back(NameOf(static_cast<roles::NeighbourRole>(i)));
  // between them lies the navel
  names.insert(names.end(), {"vertebrae_L3", "vertebrae_L4"});
  int label = 3;
  for (const std::string& name : names) {
    const fs::path file = FindMask(folder, name);
    if (file.empty()) continue;
    const auto mask = ReadLabelFile(file, Links::kRefuse);
    if (!mask) return mask.error();
    if (!LieAlike(all, *mask)) return DifferingMasks(folder);
    for (std::size_t i = 0; i < all.labels.size(); ++i) {
      if (mask->labels[i] != 0 && all.labels[i] == 0) all.labels[i] = label;
    }
    all.names.emplace_back(name, label++);
  }
  return {};
}

/// One mask an organ, named after it: what TotalSegmentator writes unless it is told otherwise (--ml).
base::Result<LabelVolume> ReadMasks(const fs::path& folder) {
  LabelVolume all;
  for (const auto& [organ, label] :
       {std::pair{NameOf(OrganRole::kLiver), 1}, {NameOf(OrganRole::kGallbladder), 2}}) {
    const fs::path file = FindMask(folder, organ);
    if (file.empty()) {
      return Error{ErrorCode::kFileMissing,
                   host::Printable(folder.string()) + " holds no mask named " + organ +
                       ".nii.gz (or .nii, .nrrd, .mha); name a folder with one for the liver and one for the "
                       "gallbladder, or one file with all labels"};
    }
    auto mask = ReadLabelFile(file, Links::kRefuse);
    if (!mask) return mask.error();
    if (all.labels.empty()) {
      all.size = mask->size, all.direction = mask->direction, all.origin = mask->origin;
      all.labels.resize(mask->labels.size());
    } else if (!LieAlike(all, *mask)) {
      return DifferingMasks(folder);
    }
    for (std::size_t i = 0; i < all.labels.size(); ++i) {
      if (mask->labels[i] != 0) all.labels[i] = label;
    }
    all.names.emplace_back(organ, label);
  }
  if (const auto status = AddNeighbourMasks(folder, all); !status.ok()) return status.error();
  return all;
}

}  // namespace

base::Result<ColorImage> ReadImage(const fs::path& path) {
  constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 28;
  const auto decoded = DecodeAlone(path, 3 * kMostPixels);
  if (!decoded) return decoded.error();
  const ImageHeader& header = decoded->header;
  if (header.kind > FileKind::kTiff || header.depth != 1 || header.samples != SampleKind::kUint8) {
    return Error{ErrorCode::kImageUnsupported,
                 host::Printable(path.string()) + ": it is no single picture of 8 bits; convert it to PNG"};
  }
  return RenderSlice(header, decoded->samples.Data(), {}, static_cast<int>(header.width),
                     static_cast<int>(header.height));
}

base::Result<LabelVolume> ReadLabelVolume(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) ? ReadMasks(path) : ReadLabelFile(path, Links::kFollow);
}

}  // namespace trocar::images
