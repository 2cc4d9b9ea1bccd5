// SPDX-License-Identifier: Apache-2.0
#include "trocar/images/label_alignment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace trocar::images {
namespace {

using base::ErrorCode;
using testing::HasSubstr;

/// 20 x 16 pixels of 2 mm, 10 slices 3 mm apart; columns to the left, rows to posterior, slices to superior.
ImageSeriesInfo MakeSeries(bool says_its_place) {
  ImageSeriesInfo series;
  series.width = 20, series.height = 16;
  series.pixel_mm = 2, series.slice_mm = 3;
  for (int i = 1; i <= 10; ++i) series.slice_numbers.push_back(i);
  series.direction = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  series.origin_mm = {100, -50, 700};
  if (says_its_place) series.file_frame = "LPS";
  return series;
}

/// The same grid, one labelled voxel at (5, 3, 7).
LabelVolume MakeMap(const ImageSeriesInfo& series) {
  LabelVolume map;
  map.size = {20, 16, 10};
  map.direction = {{{2, 0, 0}, {0, 2, 0}, {0, 0, 3}}};
  map.origin = series.origin_mm;
  map.labels.assign(20 * 16 * 10, 0);
  map.labels[(7 * 16 + 3) * 20 + 5] = 4;
  map.names = {{"gallbladder", 4}};
  return map;
}

TEST(AlignLabels, FindsTheSamePlaceWhicheverWayTheMapsAxesRun) {
  const ImageSeriesInfo series = MakeSeries(true);
  const LabelVolume map = MakeMap(series);
  // as NIfTI has it: columns to the right, rows to anterior
  LabelVolume turned = map;
  turned.direction = {{{-2, 0, 0}, {0, -2, 0}, {0, 0, 3}}};
  turned.origin = {map.origin[0] + 2 * 19, map.origin[1] + 2 * 15, map.origin[2]};
  for (int k = 0; k < 10; ++k) {
    for (int j = 0; j < 16; ++j) {
      for (int i = 0; i < 20; ++i)
        turned.labels[(k * 16 + j) * 20 + i] = map.labels[(k * 16 + (15 - j)) * 20 + (19 - i)];
    }
  }
  for (const LabelVolume& one : {map, turned}) {
    const auto aligned = AlignLabels(one, series);
    ASSERT_TRUE(aligned.ok()) << aligned.error().Text();
    EXPECT_EQ(aligned->labels, map.labels);
    EXPECT_EQ(aligned->direction, map.direction);
    EXPECT_EQ(aligned->names, map.names);
  }
}

TEST(AlignLabels, AMapOfAnotherFrameIsRefusedWithTheDistance) {
  const ImageSeriesInfo series = MakeSeries(true);
  LabelVolume map = MakeMap(series);
  map.origin[2] += 400;
  const auto aligned = AlignLabels(map, series);
  ASSERT_FALSE(aligned.ok());
  EXPECT_EQ(aligned.error().code, ErrorCode::kLabelsMismatch);
  EXPECT_THAT(aligned.error().message, HasSubstr("400 mm apart"));
  EXPECT_THAT(aligned.error().message, HasSubstr("only 0 %"));
}

TEST(AlignLabels, AnEmptyMapIsRefused) {
  const ImageSeriesInfo series = MakeSeries(true);
  LabelVolume map = MakeMap(series);
  map.labels.assign(map.labels.size(), 0);
  EXPECT_EQ(AlignLabels(map, series).error().code, ErrorCode::kLabelsMismatch);
}

TEST(AlignLabels, BesidePicturesAxesAndExtentMustAgree) {
  const ImageSeriesInfo pictures = MakeSeries(false);
  LabelVolume map = MakeMap(pictures);
  map.origin = {0, 0, 0};
  const auto aligned = AlignLabels(map, pictures);
  ASSERT_TRUE(aligned.ok()) << aligned.error().Text();
  EXPECT_EQ(aligned->labels, map.labels);
  LabelVolume flipped = map;
  flipped.direction[2] = {0, 0, -3};
  EXPECT_THAT(AlignLabels(flipped, pictures).error().message, HasSubstr("slices run to another side"));
  LabelVolume fine = map;
  fine.direction[0] = {1, 0, 0};
  EXPECT_THAT(AlignLabels(fine, pictures).error().message, HasSubstr("columns cover 20 mm"));
}

}  // namespace
}  // namespace trocar::images
