// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/series_form.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace trocar::editor {
namespace {

using testing::HasSubstr;

const std::array<std::string, 3> kAxial = {"left", "posterior", "inferior"};

TEST(SeriesForm, BecomesWhatASeriesIsOpenedWith) {
  images::ImageSeriesOptions known;
  known.series = 2, known.pattern = "s{slice}.png";
  const auto read = ReadSeriesForm({" 0.528", "1,5 ", kAxial}, known);
  ASSERT_TRUE(read.ok()) << read.error().Text();
  EXPECT_EQ(read->pixel_mm, 0.528);
  EXPECT_EQ(read->slice_mm, 1.5) << "a decimal comma";
  EXPECT_EQ(read->axes, kAxial);
  EXPECT_EQ(read->series, 2);
  EXPECT_EQ(read->pattern, "s{slice}.png");
  // and back
  const SeriesForm form = MakeSeriesForm(*read);
  EXPECT_EQ(form.pixel_mm, "0.528");
  EXPECT_EQ(form.slice_mm, "1.5");
  EXPECT_EQ(form.axes, kAxial);
}

TEST(SeriesForm, LeavesToTheFilesWhatIsEmpty) {
  images::ImageSeriesOptions known;
  known.pixel_mm = 3, known.axes = kAxial;
  const auto read = ReadSeriesForm({"", "2", {}}, known);
  ASSERT_TRUE(read.ok());
  EXPECT_FALSE(read->pixel_mm);
  EXPECT_EQ(read->slice_mm, 2.0);
  EXPECT_FALSE(read->axes);
}

TEST(SeriesForm, NamesTheFieldThatIsWrong) {
  const auto message = [](const SeriesForm& form) {
    const auto read = ReadSeriesForm(form, {});
    EXPECT_FALSE(read.ok());
    return read.ok() ? std::string() : read.error().message;
  };
  for (const char* odd : {"0", "-1", "nan", "inf", "1 mm", "21", "1e9", "x", "0.5.5"})
    EXPECT_THAT(message({odd, "1", kAxial}), HasSubstr("Pixel")) << odd;
  EXPECT_THAT(message({"1", "51", kAxial}), HasSubstr("Slice distance"));
  EXPECT_TRUE(ReadSeriesForm({"20", "50", kAxial}, {}).ok());
  EXPECT_THAT(message({"1", "1", {"left", "right", "inferior"}}), HasSubstr("Columns"));
  EXPECT_THAT(message({"1", "1", {"left", "", "inferior"}}), HasSubstr("Columns"));
  EXPECT_THAT(message({"1", "1", {"left", "posterior", "down"}}), HasSubstr("Columns"));
}

TEST(SeriesForm, OffersTheSixDirections) {
  EXPECT_THAT(PatientDirections(), testing::SizeIs(6));
}

}  // namespace
}  // namespace trocar::editor
