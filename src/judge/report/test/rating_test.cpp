// SPDX-License-Identifier: Apache-2.0
#include "trocar/report/rating.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::report {
namespace {

using testing::HasSubstr;

Rating MakeRating(const RatingForm& form, const std::string& attempt, const std::string& rater, int points) {
  Rating rating{form.key, attempt, rater, "2026-11-24T22:50:20+01:00", "", {}};
  for (const RatingItem& item : form.items) rating.points.emplace_back(item.key, points);
  return rating;
}

TEST(RatingForms, AreTheTwoThatSurgeryKnows) {
  EXPECT_THAT(ListRatingForms(), testing::ElementsAre("goals", "osats"));
  const auto goals = FindRatingForm("goals"), osats = FindRatingForm("osats");
  ASSERT_TRUE(goals.ok()) << goals.error().Text();
  ASSERT_TRUE(osats.ok()) << osats.error().Text();
  EXPECT_EQ(goals->items.size(), 5u);
  EXPECT_EQ(osats->items.size(), 7u);
  for (const RatingItem& item : goals->items)
    EXPECT_FALSE(item.lowest.empty() || item.middle.empty() || item.highest.empty());
  const auto none = FindRatingForm("apgar");
  ASSERT_FALSE(none.ok());
  EXPECT_EQ(none.error().code, base::ErrorCode::kUnknownName);
  EXPECT_THAT(none.error().message, HasSubstr("goals, osats"));
}

TEST(RatingForms, ArePrintedWithABoxForEachPoint) {
  const auto goals = FindRatingForm("goals");
  ASSERT_TRUE(goals.ok());
  const std::string page = FormatHtml(MakeRatingSheet(*goals));
  std::size_t boxes = 0;
  for (std::size_t at = page.find("☐"); at != std::string::npos; at = page.find("☐", at + 1)) ++boxes;
  EXPECT_EQ(boxes, 25u);
  EXPECT_THAT(page, HasSubstr("Vassiliou"));
  EXPECT_EQ(FormatPdf(MakeRatingSheet(*goals)).substr(0, 5), "%PDF-");
}

TEST(RatingForms, RefuseABrokenFile) {
  trocar::test::TemporaryFolder folder;
  const auto file = folder.Path() / "form.json";
  for (
      const char* text :
      {"{", "[]", R"({"format": "trocar-rating-form", "version": 2})",
       R"({"format":"trocar-rating-form","version":1,"key":"k","name":"n","about":"a","source":"s","items":[]})"}) {
    ASSERT_TRUE(host::WriteFile(file, text).ok());
    EXPECT_FALSE(ReadRatingForm(file).ok()) << text;
  }
}

TEST(Rating, IsReadAsItWasWritten) {
  const auto goals = FindRatingForm("goals");
  ASSERT_TRUE(goals.ok());
  Rating rating = MakeRating(*goals, "a.trocar", "I-2", 4);
  rating.points[2].second = 5;
  rating.remarks = "calm";
  trocar::test::TemporaryFolder folder;
  const auto file = folder.Path() / "rating.json";
  ASSERT_TRUE(host::WriteFile(file, FormatRating(rating)).ok());
  const auto read = ReadRating(file);
  ASSERT_TRUE(read.ok()) << read.error().Text();
  EXPECT_EQ(read->points, rating.points);
  EXPECT_EQ(read->Sum(), 21);
  EXPECT_EQ(read->remarks, "calm");
  // a sum that was edited
  std::string text = FormatRating(rating);
  text.replace(text.find("\"sum\": 21"), 9, "\"sum\": 25");
  ASSERT_TRUE(host::WriteFile(file, text).ok());
  EXPECT_EQ(ReadRating(file).error().code, base::ErrorCode::kRatingInvalid);
}

TEST(ParsePoints, WantsEveryItemOnceAndInRange) {
  const auto goals = FindRatingForm("goals");
  ASSERT_TRUE(goals.ok());
  const std::vector<std::string> good = {"autonomy=5", "depth_perception=4", "bimanual_dexterity=3",
                                         "efficiency=2", "tissue_handling=1"};
  const auto points = ParsePoints(*goals, good);
  ASSERT_TRUE(points.ok()) << points.error().Text();
  EXPECT_EQ((*points)[0], (std::pair<std::string, int>{"depth_perception", 4}));
  for (const auto& [at, word] : {std::pair<int, std::string>{0, "autonomy=6"},
                                 {0, "autonomy=0"},
                                 {0, "autonomy"},
                                 {0, "autonomy="},
                                 {0, "autonomy=4x"},
                                 {0, "grace=3"},
                                 {0, "efficiency=2"}}) {
    auto bad = good;
    bad[static_cast<std::size_t>(at)] = word;
    EXPECT_FALSE(ParsePoints(*goals, bad).ok()) << word;
  }
}

TEST(CompareRatings, NeedsEveryRaterOnEveryAttempt) {
  const auto goals = FindRatingForm("goals");
  ASSERT_TRUE(goals.ok());
  std::vector<Rating> ratings;
  for (int a = 0; a < 4; ++a) {
    for (const char* rater : {"I-1", "I-2"})
      ratings.push_back(MakeRating(*goals, "attempt " + std::to_string(a), rater, 1 + a));
  }
  ratings[1].points[0].second = 3;
  ratings[4].points[3].second = 5;
  const auto agreement = CompareRatings(*goals, ratings);
  ASSERT_TRUE(agreement.ok()) << agreement.error().Text();
  EXPECT_EQ(agreement->of[0].first, "sum");
  EXPECT_GT(agreement->of[0].second.two_random.value, 0.9);
  ratings.pop_back();
  EXPECT_THAT(CompareRatings(*goals, ratings).error().message, HasSubstr("rater I-2 did not rate attempt 3"));
  ratings.push_back(ratings[0]);
  EXPECT_THAT(CompareRatings(*goals, ratings).error().message, HasSubstr("twice"));
}

}  // namespace
}  // namespace trocar::report
