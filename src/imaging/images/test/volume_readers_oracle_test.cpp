// SPDX-License-Identifier: Apache-2.0
// Our readers of NIfTI, NRRD and MetaImage against ITK's writers: values, sizes and places must agree.
#include <gtest/gtest.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "trocar_test/temporary_folder.h"
#include "volume_file.h"

namespace trocar::images {
namespace {

namespace fs = std::filesystem;

constexpr int kSize[3] = {7, 5, 4};
constexpr double kSpacing[3] = {0.75, 0.5, 2.5};
constexpr double kOrigin[3] = {-31.5, 12.25, 408};

/// A turn by 10 degrees about a crooked axis, columns are the image's axes.
std::vector<std::vector<double>> MakeDirections() {
  const double angle = 10 * M_PI / 180, x = 0.48, y = -0.6, z = 0.64;
  const double c = std::cos(angle), s = std::sin(angle), k = 1 - c;
  // rows of the transposed matrix: [axis][world]
  return {{c + x * x * k, y * x * k + z * s, z * x * k - y * s},
          {x * y * k - z * s, c + y * y * k, z * y * k + x * s},
          {x * z * k + y * s, y * z * k - x * s, c + z * z * k}};
}

template <typename Sample>
Sample Value(std::size_t i) {
  return static_cast<Sample>(std::is_signed_v<Sample> ? 3.0 * static_cast<double>(i) - 60.0
                                                      : static_cast<double>(i));
}

struct Format {
  const char* extension;
  bool is_packed;
};

template <typename Sample>
void ExpectSameAsWritten(itk::ImageIOBase& writer, itk::IOComponentEnum type, const Format& format) {
  const test::TemporaryFolder folder;
  const fs::path path = folder.Path() / ("oracle" + std::string(format.extension));
  SCOPED_TRACE(path.string() + " type " + itk::ImageIOBase::GetComponentTypeAsString(type));
  const auto directions = MakeDirections();
  writer.SetFileName(path.string());
  writer.SetNumberOfDimensions(3);
  writer.SetNumberOfComponents(1);
  writer.SetComponentType(type);
  writer.SetPixelType(itk::IOPixelEnum::SCALAR);
  writer.SetUseCompression(format.is_packed);
  itk::ImageIORegion region(3);
  std::vector<Sample> samples;
  for (unsigned axis = 0; axis < 3; ++axis) {
    writer.SetDimensions(axis, static_cast<itk::SizeValueType>(kSize[axis]));
    writer.SetSpacing(axis, kSpacing[axis]);
    writer.SetOrigin(axis, kOrigin[axis]);
    writer.SetDirection(axis, directions[axis]);
    region.SetSize(axis, static_cast<itk::SizeValueType>(kSize[axis]));
  }
  for (std::size_t i = 0; i < 7u * 5 * 4; ++i) samples.push_back(Value<Sample>(i));
  writer.SetIORegion(region);
  writer.Write(samples.data());

  ImportPool pool({}, 1);
  const auto read = DecodeFile(path, Links::kFollow, pool);
  ASSERT_TRUE(read.ok()) << read.error().Text();
  const ImageHeader& header = read->header;
  EXPECT_EQ(header.width, 7u);
  EXPECT_EQ(header.height, 5u);
  EXPECT_EQ(header.depth, 4u);
  EXPECT_NE(header.frame, FileFrame::kNotSaid);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(header.spacing[axis], kSpacing[axis], 1e-5);
    EXPECT_NEAR(header.origin[axis], kOrigin[axis], 1e-4);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(header.direction[axis][k],
                  directions[static_cast<std::size_t>(axis)][static_cast<std::size_t>(k)], 1e-6);
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    ASSERT_EQ(header.slope * SampleAt(header, read->samples.Data(), i) + header.intercept,
              static_cast<double>(samples[i]))
        << i;
  }
}

template <typename Io>
void ExpectEveryType(std::initializer_list<Format> formats) {
  using Type = itk::IOComponentEnum;
  for (const Format& format : formats) {
    const auto check = [&](auto sample, Type type) {
      const auto io = Io::New();
      ExpectSameAsWritten<decltype(sample)>(*io, type, format);
    };
    check(std::uint8_t{}, Type::UCHAR);
    check(std::int8_t{}, Type::CHAR);
    check(std::int16_t{}, Type::SHORT);
    check(std::uint16_t{}, Type::USHORT);
    check(std::int32_t{}, Type::INT);
    check(std::uint32_t{}, Type::UINT);
    check(float{}, Type::FLOAT);
    check(double{}, Type::DOUBLE);
  }
}

TEST(VolumeReaders, AgreeWithItkOnNifti) {
  ExpectEveryType<itk::NiftiImageIO>({{".nii", false}, {".nii.gz", true}});
}

TEST(VolumeReaders, AgreeWithItkOnNrrd) {
  ExpectEveryType<itk::NrrdImageIO>({{".nrrd", false}, {".nrrd", true}, {".nhdr", false}, {".nhdr", true}});
}

TEST(VolumeReaders, AgreeWithItkOnMetaImage) {
  ExpectEveryType<itk::MetaImageIO>({{".mha", false}, {".mha", true}, {".mhd", false}, {".mhd", true}});
}

}  // namespace
}  // namespace trocar::images
