// SPDX-License-Identifier: Apache-2.0
#include "trocar/files/mesh_file.h"

#include <gtest/gtest.h>

#include "trocar/geometry/primitives.h"

namespace trocar::files {
namespace {

TEST(ParsePly, ReadsBackWhatFormatPlyWroteToTheLastBit) {
  const geometry::TriangleMesh sphere = geometry::MakeSphere({0.1, 0.2, 0.3}, 0.7, 2);
  const auto back = ParsePly(FormatPly(sphere, "liver, mm, LPS"), "memory");
  ASSERT_TRUE(back.ok()) << back.error().Text();
  EXPECT_EQ(*back, sphere);
}

TEST(ParsePly, ReadsAsciiAndSkipsOtherProperties) {
  const auto mesh = ParsePly(
      "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 3\nproperty float x\nproperty float "
      "y\nproperty float z\n"
      "property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 255\n1 0 0 255\n0 1.5 0 255\n3 0 1 2\n",
      "memory");
  ASSERT_TRUE(mesh.ok()) << mesh.error().Text();
  EXPECT_EQ(mesh->positions[2], (math::Vec3{0, 1.5, 0}));
}

TEST(ParsePly, RejectsEveryTruncation) {
  const std::string content = FormatPly(geometry::MakeBox({0, 0, 0}, {1, 1, 1}));
  for (std::size_t length = 0; length < content.size(); ++length) {
    const auto mesh = ParsePly(content.substr(0, length), "memory");
    ASSERT_FALSE(mesh.ok()) << length;
    EXPECT_EQ(mesh.error().code, base::ErrorCode::kMeshInvalid);
  }
}

TEST(ParsePly, RejectsACountThatLiesBeforeAllocating) {
  const auto mesh = ParsePly(
      "ply\nformat ascii 1.0\nelement vertex 18446744073709551615\nproperty float x\nend_header\n0\n",
      "memory");
  ASSERT_FALSE(mesh.ok());
  EXPECT_EQ(mesh.error().code, base::ErrorCode::kMeshInvalid);
}

TEST(ParsePly, SurvivesOneFlippedByteAnywhere) {
  const std::string content = FormatPly(geometry::MakeBox({0, 0, 0}, {1, 1, 1}));
  for (std::size_t i = 0; i < content.size(); ++i) {
    std::string damaged = content;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x55);
    (void)ParsePly(damaged, "memory").ok();  // either answer is right; falling over is not
  }
}

}  // namespace
}  // namespace trocar::files
