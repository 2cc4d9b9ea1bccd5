// SPDX-License-Identifier: Apache-2.0
// What density the labels of a map have in the CT that they were drawn on.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <functional>
#include <string>

#include "trocar/anatomy/patient_from_labels.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::anatomy {
namespace {

constexpr int kSide = 24, kSlices = 10;

class LabelDensity : public testing::Test {
 protected:
  /// Pixels of 2 mm, slices 3 mm apart; label 4 is a box, label 9 another, 2 a few voxels.
  static images::LabelVolume MakeLabels() {
    images::LabelVolume volume;
    volume.size = {kSide, kSide, kSlices};
    volume.direction = {{{2, 0, 0}, {0, 2, 0}, {0, 0, 3}}};
    for (int z = 0; z < kSlices; ++z) {
      for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
          const bool is_in = z > 1 && z < 8 && y > 4 && y < 14;
          volume.labels.push_back(!is_in              ? 0
                                  : x > 2 && x < 10   ? 4
                                  : x > 12 && x < 20  ? 9
                                  : x == 11 && y == 9 ? 2
                                                      : 0);
        }
      }
    }
    return volume;
  }
  base::Result<images::ImageSeries> Write(const std::function<int(int label, std::size_t i)>& hu) {
    const images::LabelVolume labels = MakeLabels();
    std::string file =
        "NRRD0004\ntype: short\ndimension: 3\nsizes: 24 24 10\nencoding: raw\nendian: little\n"
        "space: left-posterior-superior\nspace directions: (2,0,0) (0,2,0) (0,0,3)\nspace origin: "
        "(0,0,0)\n\n";
    for (std::size_t i = 0; i < labels.labels.size(); ++i) {
      const auto value = static_cast<std::int16_t>(hu(labels.labels[i], i));
      file.append(reinterpret_cast<const char*>(&value), 2);
    }
    EXPECT_TRUE(host::WriteFile(folder_.Path() / "ct.nrrd", file).ok());
    return images::ImageSeries::Open(folder_.Path() / "ct.nrrd");
  }
  test::TemporaryFolder folder_;
};

TEST_F(LabelDensity, IsTheMedianOfItsVoxels) {
  // noise of 40 HU, a stent of 3000 HU in a tenth of the voxels
  const auto series = Write([](int label, std::size_t i) {
    const int noise = static_cast<int>(i * 7919 % 81) - 40;
    return label == 4 ? (i % 10 == 0 ? 3000 : 104 + noise) : label == 9 ? 8 + noise : -1000;
  });
  ASSERT_TRUE(series.ok()) << series.error().Text();
  const auto found = MeasureDensities(MakeLabels(), *series);
  ASSERT_TRUE(found.ok()) << found.error().Text();
  ASSERT_EQ(found->size(), 2u) << "six voxels of label 2 are too few to tell";
  EXPECT_NEAR(found->at(4), 104, 10);
  EXPECT_NEAR(found->at(9), 8, 8);
}

TEST_F(LabelDensity, IsThatOfAMapWhoseAxesRunOtherwise) {
  const auto series = Write([](int label, std::size_t) { return label == 4 ? 104 : label == 9 ? 8 : -1000; });
  ASSERT_TRUE(series.ok());
  const images::LabelVolume labels = MakeLabels();
  images::LabelVolume turned = labels;
  turned.direction[0] = {-2, 0, 0}, turned.origin[0] = 2.0 * (kSide - 1);
  for (std::size_t i = 0; i < labels.labels.size(); ++i)
    turned.labels[i - i % kSide + (kSide - 1 - i % kSide)] = labels.labels[i];
  const auto found = MeasureDensities(turned, *series);
  ASSERT_TRUE(found.ok()) << found.error().Text();
  EXPECT_NEAR(found->at(4), 104, 4);
  EXPECT_NEAR(found->at(9), 8, 4);
}

TEST_F(LabelDensity, NeedsHounsfieldUnitsAndTheImagesOfTheMap) {
  const auto resonance = Write([](int label, std::size_t) { return 100 * label; });
  ASSERT_TRUE(resonance.ok());
  EXPECT_FALSE(HoldsHounsfieldUnits(resonance->Info()));
  EXPECT_TRUE(MeasureDensities(MakeLabels(), *resonance)->empty());
  const auto series = Write([](int label, std::size_t) { return label == 4 ? 104 : -1000; });
  ASSERT_TRUE(series.ok());
  images::LabelVolume elsewhere = MakeLabels();
  elsewhere.origin[0] = 500;
  const auto found = MeasureDensities(elsewhere, *series);
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().code, base::ErrorCode::kLabelsMismatch);
}

}  // namespace
}  // namespace trocar::anatomy
