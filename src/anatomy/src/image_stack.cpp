// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/image_stack.h"

#include <cmath>

#include "trocar/core/printable.h"
#include "volume_file.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;
using core::Error;
using core::ErrorCode;

constexpr std::uint64_t kMostVoxels = std::uint64_t{1} << 28;
constexpr std::uint64_t kForItself = std::uint64_t{1} << 30;  // address space of a reader beside the samples

Error Undecodable(const fs::path& path, const std::string& why) {
  return {ErrorCode::kImageUndecodable, core::Printable(path.string()) + ": " + why};
}

core::Result<DecodedFile> DecodeAlone(const fs::path& path, std::uint64_t most_bytes) {
  ImportLimits limits;
  limits.most_bytes = most_bytes;
  limits.reader_bytes = 2 * most_bytes + kForItself;
  ImportPool pool(limits, 1);
  return DecodeFile(path, Links::kFollow, pool);
}

}  // namespace

core::Result<ColorImage> ReadImage(const fs::path& path) {
  constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 28;
  const auto decoded = DecodeAlone(path, 3 * kMostPixels);
  if (!decoded) return decoded.error();
  const ImageHeader& header = decoded->header;
  if (header.kind > FileKind::kTiff || header.depth != 1 || header.samples != SampleKind::kUint8) {
    return Error{ErrorCode::kImageUnsupported,
                 core::Printable(path.string()) + ": it is no single picture of 8 bits; convert it to PNG"};
  }
  return RenderSlice(header, decoded->samples.Data(), {}, static_cast<int>(header.width),
                     static_cast<int>(header.height));
}

core::Result<LabelVolume> ReadLabelVolume(const fs::path& path) {
  auto decoded = DecodeAlone(path, kMostVoxels * SampleBytes(SampleKind::kFloat32));
  if (!decoded) return decoded.error();
  const ImageHeader& header = decoded->header;
  if (header.kind < FileKind::kNifti || header.channels != 1)
    return Undecodable(path, "it is no volume of labels; name a NIfTI, NRRD or MetaImage label map");
  const std::uint64_t count = header.SampleCount();
  if (count > kMostVoxels)
    return Error{ErrorCode::kImageTooLarge,
                 core::Printable(path.string()) + ": it has more than 2^28 voxels; crop or resample it"};
  const bool has_spacing = header.spacing[0] > 0 && header.spacing[1] > 0 && header.spacing[2] > 0;
  if (header.frame == FileFrame::kNotSaid || !has_spacing) {
    return Error{ErrorCode::kImageSpacingUnknown,
                 core::Printable(path.string()) +
                     ": it does not say how large its voxels are or how it lies in the "
                     "body; save it with both, for instance with 3D Slicer"};
  }
  LabelVolume volume;
  volume.size = {static_cast<int>(header.width), static_cast<int>(header.height),
                 static_cast<int>(header.depth)};
  for (int axis = 0; axis < 3; ++axis) {
    volume.origin[axis] = header.origin[axis];
    for (int k = 0; k < 3; ++k) volume.direction[axis][k] = header.direction[axis][k] * header.spacing[axis];
  }
  volume.labels.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double label = header.slope * SampleAt(header, decoded->samples.Data(), i) + header.intercept;
    if (!(label >= 0.0 && label <= 255.0) || label != std::floor(label))
      return Undecodable(path, "its voxels are not whole numbers from 0 to 255; name a label map");
    volume.labels[i] = static_cast<std::uint8_t>(label);
  }
  volume.names = std::move(decoded->names);
  return volume;
}

}  // namespace trocar::anatomy
