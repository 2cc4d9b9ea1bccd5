// SPDX-License-Identifier: Apache-2.0
#include "dicom_series.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace trocar::images {
namespace {

using core::ErrorCode;
using testing::HasSubstr;

/// Axial slices `step` apart; instance numbers ascend from 11.
std::vector<DicomSlice> MakeSlices(int count, double step) {
  std::vector<DicomSlice> slices;
  for (int i = 0; i < count; ++i) {
    DicomSlice slice;
    slice.file = "IM" + std::to_string(i);
    ImageHeader& header = slice.header;
    header.width = header.height = 8, header.depth = header.channels = 1;
    header.has_position = 1;
    header.spacing[0] = header.spacing[1] = 0.7;
    for (int axis = 0; axis < 3; ++axis) header.direction[axis][axis] = 1;
    header.origin[2] = 100 + i * step;
    header.instance_number = 11 + i;
    slices.push_back(slice);
  }
  return slices;
}

TEST(OrderDicomSlices, SortsByPositionWhateverTheFilesAreCalled) {
  auto slices = MakeSlices(9, 2.5);
  std::reverse(slices.begin() + 2, slices.end());
  std::swap(slices[0], slices[5]);
  const auto order = OrderDicomSlices(slices);
  ASSERT_TRUE(order.ok()) << order.error().Text();
  EXPECT_DOUBLE_EQ(order->slice_mm, 2.5);
  EXPECT_EQ(order->direction, (math::Vec3{0, 0, 1}));
  for (int i = 0; i < 9; ++i) {
    EXPECT_EQ(order->numbers[i], 11 + i);
    EXPECT_DOUBLE_EQ(slices[order->slices[i]].header.origin[2], 100 + 2.5 * i);
  }
}

TEST(OrderDicomSlices, FollowsInstanceNumbersDownwards) {
  const auto order = OrderDicomSlices(MakeSlices(5, -3));
  ASSERT_TRUE(order.ok());
  EXPECT_EQ(order->numbers.front(), 11);
  EXPECT_EQ(order->direction, (math::Vec3{0, 0, -1}));
  EXPECT_DOUBLE_EQ(order->slice_mm, 3);
}

TEST(OrderDicomSlices, NumbersSlicesItselfWhereInstancesAreNoUse) {
  auto slices = MakeSlices(4, 2);
  slices[2].header.instance_number = 99;
  const auto order = OrderDicomSlices(slices);
  ASSERT_TRUE(order.ok());
  EXPECT_EQ(order->numbers, (std::vector{1, 2, 3, 4}));
}

TEST(OrderDicomSlices, NamesGaps) {
  auto slices = MakeSlices(10, 2);
  slices.erase(slices.begin() + 4, slices.begin() + 6);
  const auto order = OrderDicomSlices(slices);
  EXPECT_EQ(order.error().code, ErrorCode::kImageSeriesGap);
  EXPECT_THAT(order.error().message, HasSubstr("2 between slice 14 (IM3) and slice 17 (IM6)"));
  slices = MakeSlices(4, 2);
  slices.erase(slices.begin() + 1);
  EXPECT_EQ(OrderDicomSlices(slices).error().code, ErrorCode::kImageSeriesGap) << "three slices";
}

TEST(OrderDicomSlices, NamesUnevenAndDoubledSlices) {
  auto slices = MakeSlices(6, 2);
  slices[3].header.origin[2] += 0.7;
  EXPECT_EQ(OrderDicomSlices(slices).error().code, ErrorCode::kImageSeriesUneven);
  EXPECT_THAT(OrderDicomSlices(slices).error().message, HasSubstr("IM3"));
  slices = MakeSlices(6, 2);
  slices[3].header.origin[2] = slices[2].header.origin[2];
  EXPECT_EQ(OrderDicomSlices(slices).error().code, ErrorCode::kImageSeriesUneven);
  EXPECT_THAT(OrderDicomSlices(slices).error().message, HasSubstr("same place"));
  // rounding of headers is no unevenness
  slices = MakeSlices(6, 2);
  slices[3].header.origin[2] += 0.009;
  EXPECT_TRUE(OrderDicomSlices(slices).ok());
}

TEST(OrderDicomSlices, RefusesATiltedGantry) {
  auto slices = MakeSlices(6, 2);
  for (int i = 0; i < 6; ++i) slices[i].header.origin[1] = 0.3 * i;
  EXPECT_EQ(OrderDicomSlices(slices).error().code, ErrorCode::kImageSeriesUneven);
}

TEST(OrderDicomSlices, RefusesMixtures) {
  const auto refuses = [](const std::function<void(ImageHeader&)>& change, const char* why) {
    auto slices = MakeSlices(5, 2);
    change(slices[2].header);
    const auto order = OrderDicomSlices(slices);
    ASSERT_FALSE(order.ok()) << why;
    EXPECT_EQ(order.error().code, ErrorCode::kImageSeriesMixed) << why;
    EXPECT_THAT(order.error().message, HasSubstr(why));
    EXPECT_THAT(order.error().message, HasSubstr("slice 13 (IM2)"));
  };
  refuses([](ImageHeader& h) { h.patient_hash = 1; }, "two patients");
  refuses([](ImageHeader& h) { h.series_hash = 1; }, "two series");
  refuses([](ImageHeader& h) { h.frame_hash = 1; }, "frames of reference");
  refuses([](ImageHeader& h) { h.width = 9; }, "different sizes");
  refuses([](ImageHeader& h) { h.samples = SampleKind::kInt16; }, "kinds of pixels");
  refuses([](ImageHeader& h) { h.spacing[1] = 0.8; }, "pixels of different sizes");
  refuses([](ImageHeader& h) { h.direction[0][0] = std::cos(0.1), h.direction[0][1] = std::sin(0.1); },
          "different orientations");
}

TEST(SplitSeries, KeepsEachTogether) {
  auto slices = MakeSlices(6, 2);
  for (const int i : {1, 3, 5}) slices[i].header.series_hash = 7;
  const auto series = SplitSeries(slices);
  ASSERT_EQ(series.size(), 2u);
  EXPECT_EQ(series[1][0].file, "IM1");
  EXPECT_EQ(series[0].size(), 3u);
}

}  // namespace
}  // namespace trocar::images
