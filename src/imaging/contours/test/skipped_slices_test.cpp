// SPDX-License-Identifier: Apache-2.0
// Contours of slices that nobody contoured, from pictures of known shapes.
#include "skipped_slices.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <vector>

#include "phantom_picture.h"
#include "trocar/contours/build_organs.h"
#include "trocar/contours/contour_fill.h"

namespace trocar::contours {

using math::Vec2;

namespace {

constexpr std::size_t kBetween = 7;  // of every eighth slice
constexpr double kRadius = 24.0;     // pixels

// a tube whose middle bends aside between two contoured slices, where interpolation sees a straight one
Vec2 BentCentre(double part) {
  return {80 + 10 * part * (1 - part), 80};  // 2.5 pixels at most
}

double Away(const Vec2& p, const Vec2& centre) {
  return Norm(p - centre) - kRadius;
}

ContourMatch MatchEnds() {
  const auto circle = [](double part) {
    return MakePolar(BentCentre(part), 200, [](double) { return kRadius; });
  };
  return MatchContours(circle(0), circle(1));
}

std::vector<EdgeField> DrawSlices(const EdgeAdaptionSettings& adaption,
                                  const std::function<Vec2(double part)>& centre) {
  std::vector<EdgeField> fields;
  for (std::size_t k = 1; k <= kBetween; ++k) {
    const Vec2 at = centre(static_cast<double>(k) / (kBetween + 1));
    fields.emplace_back(DrawPhantom({.seed = k},
                                    [&](double x, double y) {
                                      return Away({x, y}, at);
                                    }),
                        adaption.blur_px);
  }
  return fields;
}

double MeanDistance(const std::vector<Vec2>& contour, const Vec2& centre) {
  double sum = 0;
  for (const Vec2& p : contour) sum += std::fabs(Away(p, centre));
  return sum / static_cast<double>(contour.size());
}

TEST(FollowBetween, FollowsAShapeThatBendsBetweenTheContouredSlices) {
  const EdgeAdaptionSettings adaption{.skipped_shift_px = 4};
  const auto match = MatchEnds();
  const auto contours = FollowBetween(match, DrawSlices(adaption, BentCentre), adaption);
  ASSERT_EQ(contours.size(), kBetween);
  for (std::size_t k = 0; k < kBetween; ++k) {
    const double part = static_cast<double>(k + 1) / (kBetween + 1);
    EXPECT_LT(MeanDistance(contours[k], BentCentre(part)), 0.2) << k;
  }
  // what interpolation alone makes of the middle slice
  EXPECT_GT(MeanDistance(match.At(0.5), BentCentre(0.5)), 1.4);
}

TEST(FollowBetween, KeepsTheInterpolationWhereNothingIsSeen) {
  const EdgeAdaptionSettings adaption{.skipped_shift_px = 4};
  const images::ColorImage flat{160, 160, std::vector<std::uint8_t>(160 * 160 * 3, 90)};
  const std::vector<EdgeField> fields(kBetween, EdgeField(flat, adaption.blur_px));
  for (const auto& contour : FollowBetween(MatchEnds(), fields, adaption)) {
    for (const Vec2& p : contour) EXPECT_NEAR(Away(p, BentCentre(0)), 0, 0.05);
  }
}

TEST(FollowBetween, GoesNoFurtherThanItsReach) {
  const EdgeAdaptionSettings adaption{.skipped_shift_px = 2};
  const auto far = [](double) { return Vec2{84.5, 80}; };
  for (const auto& contour : FollowBetween(MatchEnds(), DrawSlices(adaption, far), adaption)) {
    for (const Vec2& p : contour) EXPECT_LE(std::fabs(Away(p, BentCentre(0))), 2.05);
  }
}

TEST(FollowBetween, OutvotesASliceThatDisagreesWithItsNeighbours) {
  const EdgeAdaptionSettings adaption{.skipped_shift_px = 4};
  const auto one_is_off = [](double part) { return Vec2{part == 0.5 ? 83.5 : 80, 80}; };
  const auto contours = FollowBetween(MatchEnds(), DrawSlices(adaption, one_is_off), adaption);
  EXPECT_LT(MeanDistance(contours[kBetween / 2], {80, 80}), MeanDistance(contours[kBetween / 2], {83.5, 80}));
  for (const std::size_t k : {std::size_t{0}, kBetween - 1})
    EXPECT_LT(MeanDistance(contours[k], {80, 80}), 0.3);
}

TEST(FollowBetween, GivesTheSameBitsAgain) {
  const EdgeAdaptionSettings adaption{.skipped_shift_px = 4};
  const auto fields = DrawSlices(adaption, BentCentre);
  EXPECT_EQ(FollowBetween(MatchEnds(), fields, adaption), FollowBetween(MatchEnds(), fields, adaption));
}

// A ball's cap: from 12 slices below its pole outwards.
TEST(FollowEnd, FollowsABallToItsPole) {
  const EdgeAdaptionSettings adaption{.skipped_shift_px = 4};
  const double ball = 40;
  const auto radius = [&](int from_pole) { return std::sqrt(ball * ball - std::pow(ball - from_pole, 2)); };
  const auto draw = [&](int from_pole) {
    return EdgeField(DrawPhantom({.seed = static_cast<std::uint64_t>(50 + from_pole)},
                                 [&](double x, double y) {
                                   return from_pole > 0 ? std::hypot(x - 80, y - 80) - radius(from_pole) : 50;
                                 }),
                     adaption.blur_px);
  };
  std::vector<EdgeField> fields;
  for (int from_pole = 11; from_pole > -3; --from_pole) fields.push_back(draw(from_pole));
  const auto contour = MakePolar({80, 80}, 100, [&](double) { return radius(12); });
  const FollowedEnd end = FollowEnd(draw(12), contour, fields, 5.0, adaption);
  EXPECT_TRUE(end.is_ended);
  ASSERT_GE(end.contours.size(), 9u);
  ASSERT_LE(end.contours.size(), 11u);
  for (std::size_t i = 0; i + 2 < end.contours.size(); ++i) {
    for (const Vec2& p : end.contours[i])
      EXPECT_NEAR(Norm(p - Vec2{80, 80}), radius(11 - static_cast<int>(i)), 1.0) << i;
  }
}

TEST(FollowEnd, DoesNotKnowWhereNothingIsSeen) {
  const EdgeAdaptionSettings adaption{.skipped_shift_px = 4};
  const images::ColorImage flat{160, 160, std::vector<std::uint8_t>(160 * 160 * 3, 90)};
  const std::vector<EdgeField> fields(5, EdgeField(flat, adaption.blur_px));
  const FollowedEnd end =
      FollowEnd(fields[0], MakePolar({80, 80}, 100, [](double) { return kRadius; }), fields, 5.0, adaption);
  EXPECT_TRUE(end.contours.empty());
  EXPECT_FALSE(end.is_ended);
}

// A ball clicked exactly in every eighth slice, in a series that its pictures and labels tell in full.
class BallInSlices : public testing::Test {
 protected:
  static double RadiusPx(int slice) {
    return std::sqrt(std::max(0.0, 24.0 * 24.0 - std::pow(slice - 40, 2))) / 0.5;
  }
  BallInSlices() {
    points_.first_slice = 0, points_.last_slice = 79;
    points_.width = points_.height = 160;
    points_.pixel_mm = 0.5, points_.slice_mm = 1.0;
    points_.axes = {"left", "anterior", "inferior"};
    points_.structures.resize(1);
    Structure& ball = points_.structures[0];
    ball.name = "ball", ball.triangle_budget = 2000, ball.reference_label = 3;
    for (int slice = 20; slice <= 60; slice += 8)
      ball.slices.push_back(
          {slice, {MakePolar({80, 80}, 12, [&](double) { return RadiusPx(slice); })}, {}, {}});
    labels_.size = {160, 160, 80};
    labels_.direction = {{{0.5, 0, 0}, {0, -0.5, 0}, {0, 0, -1}}};
    for (int slice = 0; slice < 80; ++slice) {
      for (int y = 0; y < 160; ++y) {
        for (int x = 0; x < 160; ++x)
          labels_.labels.push_back(std::hypot(x - 80, y - 80) < RadiusPx(slice) ? 3 : 0);
      }
    }
    for (int slice = 0; slice < 80; ++slice) pictures_[slice] = Draw(slice);
  }
  static images::ColorImage Draw(int slice) {
    return DrawPhantom({.seed = static_cast<std::uint64_t>(slice)}, [&](double x, double y) {
      return RadiusPx(slice) > 0 ? std::hypot(x - 80, y - 80) - RadiusPx(slice) : 50;
    });
  }

  ControlPoints points_;
  images::LabelVolume labels_;
  std::map<int, images::ColorImage> pictures_;
};

TEST_F(BallInSlices, KeepsWhatInterpolationLoses) {
  const auto followed = BuildOrgans(points_, pictures_, {.reference = &labels_});
  ASSERT_TRUE(followed.ok()) << followed.error().Text();
  points_.structures[0].adaption.skipped_shift_px = 0;
  const auto interpolated = BuildOrgans(points_, pictures_, {.reference = &labels_});
  ASSERT_TRUE(interpolated.ok()) << interpolated.error().Text();
  EXPECT_EQ(interpolated->organs[0].followed_slices, 0u);
  EXPECT_GE(followed->organs[0].followed_slices, 35u + 4u);
  EXPECT_GT(followed->organs[0].judgement->dice, 0.985);
  EXPECT_LT(interpolated->organs[0].judgement->dice, 0.98);
  EXPECT_NEAR(followed->organs[0].judgement->ratio, 1.0, 0.02);
}

TEST_F(BallInSlices, ReadsThePicturesItNeedsOrSaysThatItLacksThem) {
  std::map<int, images::ColorImage> clicked;
  for (const SliceContours& slice : points_.structures[0].slices)
    clicked[slice.slice] = pictures_[slice.slice];
  EXPECT_EQ(BuildOrgans(points_, clicked).error().code, base::ErrorCode::kUsage);
  OrganOptions options;
  options.read_skipped =
      [&](const std::vector<int>& slices) -> base::Result<std::map<int, images::ColorImage>> {
    std::map<int, images::ColorImage> read;
    for (const int slice : slices) read[slice] = pictures_.at(slice);
    return read;
  };
  const auto all = BuildOrgans(points_, pictures_), read = BuildOrgans(points_, clicked, options);
  ASSERT_TRUE(all.ok() && read.ok());
  EXPECT_EQ(all->meshes[0].mesh.positions, read->meshes[0].mesh.positions);
  options.read_skipped = [](const std::vector<int>&) -> base::Result<std::map<int, images::ColorImage>> {
    return base::Error{base::ErrorCode::kImageSliceMissing, "gone"};
  };
  EXPECT_EQ(BuildOrgans(points_, clicked, options).error().code, base::ErrorCode::kImageSliceMissing);
}

}  // namespace
}  // namespace trocar::contours
