// SPDX-License-Identifier: Apache-2.0
#include "dicom_series.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace trocar::images {
namespace {

using base::ErrorCode;
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
  // as a scanner writes it: slices tilted about the body's cross axis, one behind the other along the table
  const double tilt = 15 * std::numbers::pi / 180;
  slices = MakeSlices(6, 2);
  for (int i = 0; i < 6; ++i) {
    ImageHeader& header = slices[static_cast<std::size_t>(i)].header;
    const double down[3] = {0, std::cos(tilt), std::sin(tilt)},
                 normal[3] = {0, -std::sin(tilt), std::cos(tilt)};
    for (int k = 0; k < 3; ++k)
      header.direction[1][k] = down[k], header.direction[2][k] = normal[k],
      header.origin[k] = k == 2 ? 2.0 * i : 0;
  }
  const auto tilted = OrderDicomSlices(slices);
  EXPECT_EQ(tilted.error().code, ErrorCode::kImageSeriesUneven);
  EXPECT_THAT(tilted.error().message, HasSubstr("as a gantry tilted by 15 degrees leaves them"));
  // further than any gantry goes
  for (int i = 0; i < 6; ++i) slices[static_cast<std::size_t>(i)].header.origin[1] = -4.0 * i;
  EXPECT_THAT(OrderDicomSlices(slices).error().message, testing::Not(HasSubstr("gantry")));
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

/// Slices at these places along the normal, with instance numbers that follow each other.
std::vector<DicomSlice> MakeSlicesAt(const std::vector<double>& places) {
  auto slices = MakeSlices(static_cast<int>(places.size()), 1);
  for (std::size_t i = 0; i < places.size(); ++i) slices[i].header.origin[2] = places[i];
  return slices;
}

TEST(OrderDicomSlices, InterpolatesWhereTheDistanceChanges) {
  // 5 mm, then 2.5 mm
  const auto slices = MakeSlicesAt({0, 5, 10, 15, 17.5, 20, 22.5});
  const auto order = OrderDicomSlices(slices);
  ASSERT_TRUE(order.ok()) << order.error().Text();
  EXPECT_DOUBLE_EQ(order->slice_mm, 2.5);
  EXPECT_EQ(order->numbers, (std::vector{1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
  ASSERT_EQ(order->places.size(), 10u);
  for (std::size_t i = 0; i < order->places.size(); ++i) {
    const SlicePlace& place = order->places[i];
    const double below = slices[order->slices[place.below]].header.origin[2];
    const double above = place.part > 0 ? slices[order->slices[place.below + 1]].header.origin[2] : below;
    EXPECT_NEAR(below + place.part * (above - below), 2.5 * static_cast<double>(i), 1e-9) << i;
  }
  EXPECT_EQ(order->places[1].part, 0.5);
  EXPECT_EQ(order->places[8].part, 0.0) << "a slice that there is, is taken as it is";
  EXPECT_THAT(order->note, HasSubstr("5 mm, then 2.5 mm"));
  // the other way round, more of the fine ones, lengths that are no multiples, one distance between them
  EXPECT_TRUE(OrderDicomSlices(MakeSlicesAt({0, 2.5, 5, 7.5, 10, 12.5, 17.5, 22.5, 27.5})).ok());
  const auto odd = OrderDicomSlices(MakeSlicesAt({0, 3, 6, 9, 13, 18, 23, 28}));
  ASSERT_TRUE(odd.ok()) << odd.error().Text();
  EXPECT_EQ(odd->numbers.size(), 10u) << "0 to 27 mm";
  EXPECT_FALSE(order->note.empty());
  EXPECT_TRUE(OrderDicomSlices(MakeSlices(5, 2))->note.empty());
}

TEST(OrderDicomSlices, SaysTrulyWhatIsWrongWithDistances) {
  const auto text = [](const std::vector<DicomSlice>& slices) {
    const auto order = OrderDicomSlices(slices);
    return order.ok() ? "opened" : order.error().Text();
  };
  // every other slice of the second half is missing: the numbers say it
  auto slices = MakeSlicesAt({0, 2, 4, 6, 8, 12, 16, 20});
  for (int i = 5; i < 8; ++i)
    slices[i].header.instance_number = slices[4].header.instance_number + 2 * (i - 4);
  EXPECT_THAT(text(slices),
              HasSubstr("E-IMG-007 slices are missing: 1 between slice 15 (IM4) and slice 17 (IM5); 1 "
                        "between"));
  // the numbers go on: the same places are a change of distance
  EXPECT_EQ(text(MakeSlicesAt({0, 2, 4, 6, 8, 12, 16, 20})), "opened");
  // one long distance, and numbers that go on: nothing is known to be missing
  EXPECT_THAT(text(MakeSlicesAt({0, 2, 4, 8, 10, 12})),
              HasSubstr("E-IMG-008 slice 13 (IM2) and slice 14 (IM3) are 4 mm apart, others 2 mm"));
  EXPECT_THAT(text(MakeSlicesAt({0, 1, 3, 6, 10, 15, 21})), HasSubstr("E-IMG-008"));
  // too long to be filled
  EXPECT_THAT(text(MakeSlicesAt({0, 1, 2, 3, 4, 12, 20, 28})), HasSubstr("are 8 mm apart, others 1 mm"));
  // two short ones of the usual length count, however few they are
  const auto two = OrderDicomSlices(MakeSlicesAt({0, 2.5, 5, 10, 15, 20, 22.5, 25}));
  ASSERT_TRUE(two.ok()) << two.error().Text();
  EXPECT_DOUBLE_EQ(two->slice_mm, 2.5);
  // doubles
  EXPECT_THAT(text(MakeSlicesAt({0, 2, 2, 4})),
              HasSubstr("slice 12 (IM1) and slice 13 (IM2) lie in the same place"));
  EXPECT_THAT(text(MakeSlicesAt({0, 0, 2, 2, 4, 4})), HasSubstr("as do 2 more pairs"));
}

TEST(OrderDicomSlices, NamesASliceThatLiesAside) {
  auto slices = MakeSlices(6, 2);
  slices[3].header.origin[0] = 20;
  const auto order = OrderDicomSlices(slices);
  ASSERT_FALSE(order.ok());
  EXPECT_THAT(order.error().message, HasSubstr("slice 14 (IM3) lies 20 mm aside"));
}

TEST(FindStrayInGap, NamesTheSliceThatFillsIt) {
  auto slices = MakeSlices(6, 2);
  DicomSlice stray = slices[2];
  stray.header.spacing[0] = 0.9;
  slices.erase(slices.begin() + 2);
  const auto found = FindStrayInGap(slices, {&stray, 1});
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->code, ErrorCode::kImageSeriesMixed);
  EXPECT_THAT(found->message, HasSubstr("slice 12 (IM1) and slice 13 (IM2) have pixels of different sizes"));
  stray.header.origin[1] += 30;
  EXPECT_FALSE(FindStrayInGap(slices, {&stray, 1})) << "elsewhere";
}

}  // namespace
}  // namespace trocar::images
