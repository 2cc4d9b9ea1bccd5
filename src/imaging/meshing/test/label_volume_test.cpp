// SPDX-License-Identifier: Apache-2.0
#include "trocar/meshing/label_volume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/meshing/marching_cubes.h"

namespace trocar::meshing {
namespace {

using math::Vec3;

/// A ball of 14 mm around (30, 30, 30) mm as label 7, with another label around it.
images::LabelVolume MakeBall(std::array<int, 3> size, const std::array<double, 3>& voxel_mm,
                             double* enclosed_mm3 = nullptr) {
  images::LabelVolume labels;
  labels.size = size;
  std::size_t count = 0;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        const double distance =
            Distance(Vec3{i * voxel_mm[0], j * voxel_mm[1], k * voxel_mm[2]}, {30, 30, 30});
        labels.labels.push_back(distance < 14 ? 7 : 3);
        count += distance < 14;
      }
    }
  }
  if (enclosed_mm3 != nullptr)
    *enclosed_mm3 = static_cast<double>(count) * voxel_mm[0] * voxel_mm[1] * voxel_mm[2];
  return labels;
}

TEST(FillLabelSlices, CropsEverySliceAndLeavesEmptyOnesOut) {
  const auto slices = FillLabelSlices(MakeBall({60, 60, 60}, {1, 1, 1}), 7, {1, 1, 1}, 1.0);
  ASSERT_EQ(slices.size(), 27u);
  EXPECT_EQ(slices.front().position_mm, 17.0);
  const images::Mask& middle = slices[13].mask;
  EXPECT_EQ(middle.x0, 17);
  EXPECT_EQ(middle.width, 27);
  EXPECT_EQ(middle.height, 27);
  EXPECT_EQ(middle.At(13, 13), 1);
  EXPECT_TRUE(FillLabelSlices(MakeBall({60, 60, 60}, {1, 1, 1}), 9, {1, 1, 1}, 1.0).empty());
}

TEST(KeepLargestPart, CountsThePartsAndClearsTheLesser) {
  images::LabelVolume labels = MakeBall({60, 60, 60}, {1, 1, 1});
  const auto ball = static_cast<std::size_t>(std::count(labels.labels.begin(), labels.labels.end(), 7));
  const auto at = [&](int i, int j, int k) -> std::int32_t& {
    return labels.labels[static_cast<std::size_t>((k * 60 + j) * 60 + i)];
  };
  // three in a row across two axes, and one that only touches it over an edge
  at(2, 2, 2) = at(3, 2, 2) = at(3, 3, 2) = 7;
  at(4, 4, 2) = 7;
  EXPECT_EQ(KeepLargestPart(labels, 7), (std::vector<std::size_t>{ball, 3, 1}));
  EXPECT_EQ(at(2, 2, 2), 0);
  EXPECT_EQ(at(4, 4, 2), 0);
  EXPECT_EQ(at(1, 2, 2), 3) << "other labels stay";
  EXPECT_EQ(KeepLargestPart(labels, 7), std::vector<std::size_t>{ball});
  EXPECT_TRUE(KeepLargestPart(labels, 9).empty());
}

TEST(MakeLabelVolume, EnclosesTheLabelsWhateverTheVoxels) {
  struct Case {
    std::array<int, 3> size;
    std::array<double, 3> voxel_mm;
  };
  for (const Case& c :
       {Case{{60, 60, 60}, {1, 1, 1}}, Case{{80, 60, 15}, {0.75, 1, 4}}, Case{{30, 30, 40}, {2, 2, 1.5}}}) {
    double enclosed = 0;
    const images::LabelVolume labels = MakeBall(c.size, c.voxel_mm, &enclosed);
    const double pixel = std::min(c.voxel_mm[0], c.voxel_mm[1]);
    const auto volume = MakeLabelVolume(FillLabelSlices(labels, 7, c.voxel_mm, pixel), pixel, enclosed);
    ASSERT_TRUE(volume.ok());
    const auto mesh = MarchCubes(*volume);
    EXPECT_NEAR(geometry::CalcVolume(mesh.positions, mesh.triangles), enclosed, 0.02 * enclosed);
    for (const Vec3& p : mesh.positions)
      EXPECT_NEAR(Distance(p, {30, 30, 30}), 14, 1.2 + 0.4 * c.voxel_mm[2]);
  }
}

TEST(MakeLabelVolume, RefusesASingleSlice) {
  const auto slices = FillLabelSlices(MakeBall({60, 60, 60}, {1, 1, 1}), 7, {1, 1, 1}, 1.0);
  const auto volume = MakeLabelVolume({slices[0]}, 1.0, 100.0);
  ASSERT_FALSE(volume.ok());
  EXPECT_EQ(volume.error().code, base::ErrorCode::kContourEmpty);
}

TEST(SuggestSpacing, GivesTheSurfaceSoManyTriangles) {
  const auto slices = FillLabelSlices(MakeBall({60, 60, 60}, {1, 1, 1}), 7, {1, 1, 1}, 1.0);
  const double area = 4 * M_PI * 14 * 14;
  EXPECT_NEAR(SuggestSpacing(slices, 1.0, 100), std::sqrt(2.7 * area / 1800), 0.08);
  EXPECT_NEAR(SuggestSpacing(slices, 1.0, 400) / SuggestSpacing(slices, 1.0, 100), 0.5, 1e-9);
}

}  // namespace
}  // namespace trocar::meshing
