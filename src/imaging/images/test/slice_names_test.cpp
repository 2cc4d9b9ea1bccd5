// SPDX-License-Identifier: Apache-2.0
#include "trocar/images/slice_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace trocar::images {
namespace {

using base::ErrorCode;
using testing::HasSubstr;
using Names = std::vector<std::string>;

TEST(FindNamedSlices, SortsByNumberNotByLetter) {
  const auto found = FindNamedSlices(Names{"s10.png", "s9.png", "s100.png", "readme.txt"}, "");
  ASSERT_TRUE(found.ok()) << found.error().Text();
  EXPECT_EQ(found->pattern, "s{slice}.png");
  EXPECT_EQ(found->ignored, 1u);
  EXPECT_EQ(found->files, (std::map<int, std::string>{{9, "s9.png"}, {10, "s10.png"}, {100, "s100.png"}}));
}

TEST(FindNamedSlices, TakesTheLastNumberAndItsZeros) {
  const auto found = FindNamedSlices(Names{"scan2_0007.TIF", "scan2_0008.TIF"}, "");
  ASSERT_TRUE(found.ok()) << found.error().Text();
  EXPECT_EQ(found->pattern, "scan2_{slice:04}.TIF");
  EXPECT_EQ(found->files.begin()->first, 7);
}

TEST(FindNamedSlices, AsksWhichOfTwoStacks) {
  const Names names = {"a1.png", "a2.png", "b1.png", "b2.png"};
  const auto found = FindNamedSlices(names, "");
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().code, ErrorCode::kImageSeriesMixed);
  EXPECT_THAT(found.error().message, HasSubstr("b{slice}.png (2)"));
  const auto chosen = FindNamedSlices(names, "b{slice}.png");
  ASSERT_TRUE(chosen.ok());
  EXPECT_EQ(chosen->files.at(2), "b2.png");
  EXPECT_EQ(chosen->ignored, 2u);
}

TEST(FindNamedSlices, RefusesOneNumberTwice) {
  EXPECT_EQ(FindNamedSlices(Names{"s1.png", "s01.png"}, "").error().code, ErrorCode::kImageSeriesUneven);
  EXPECT_EQ(FindNamedSlices(Names{"cover.png", "s99999999.png"}, "").error().code,
            ErrorCode::kImageSliceMissing);
  EXPECT_EQ(FindNamedSlices(Names{"s1.png"}, "t{slice}.png").error().code, ErrorCode::kImageSliceMissing);
}

TEST(FindNamedSlices, ShowsOddNamesSafely) {
  const auto found = FindNamedSlices(Names{"a\n1.png", "\u202Eb1.png", std::string(240, 'x') + "1.png"}, "");
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().message.find('\n'), std::string::npos);
  EXPECT_EQ(found.error().message.find("\u202E"), std::string::npos);
  EXPECT_LT(found.error().message.size(), 700u);
}

TEST(CheckSliceNumbers, NamesTheGaps) {
  EXPECT_EQ(*CheckSliceNumbers(std::vector{4}), 1);
  EXPECT_EQ(*CheckSliceNumbers(std::vector{4, 5, 6}), 1);
  EXPECT_EQ(*CheckSliceNumbers(std::vector{10, 18, 26}), 8) << "a stack that was thinned evenly";
  const auto gap = CheckSliceNumbers(std::vector{1, 2, 4, 5, 9});
  EXPECT_EQ(gap.error().code, ErrorCode::kImageSeriesGap);
  EXPECT_THAT(gap.error().message, HasSubstr("missing: 3, 6 to 8;"));
  EXPECT_EQ(CheckSliceNumbers(std::vector{1, 3}).error().code, ErrorCode::kImageSeriesGap);
  EXPECT_EQ(CheckSliceNumbers(std::vector{10, 18, 34}).error().code, ErrorCode::kImageSeriesGap);
  EXPECT_EQ(CheckSliceNumbers(std::vector{10, 14, 18, 25}).error().code, ErrorCode::kImageSeriesUneven);
}

TEST(FormatImageName, FillsInTheNumber) {
  EXPECT_EQ(FormatImageName("image-{slice:04}.jpeg", 546), "image-0546.jpeg");
  EXPECT_EQ(FormatImageName("{slice}.png", 7), "7.png");
  EXPECT_EQ(FormatImageName("a{slice:2}b", 1234), "a1234b");
}

}  // namespace
}  // namespace trocar::images
