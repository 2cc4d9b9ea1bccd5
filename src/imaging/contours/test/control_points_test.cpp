// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/control_points.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace trocar::contours {
namespace {

using base::ErrorCode;

ControlPoints MakePoints() {
  ControlPoints points;
  points.name = "Test";
  points.provenance = "made up";
  points.image_pattern = "slice-{slice:03}.png";
  points.first_slice = 1, points.last_slice = 20;
  points.width = 100, points.height = 80;
  points.pixel_mm = 0.5, points.slice_mm = 2.0;
  points.axes = {"left", "anterior", "inferior"};
  points.origin_landmark = "fundus";
  points.origin_mm = {-75, 95, -70};
  Structure liver;
  liver.name = "liver", liver.triangle_budget = 500, liver.reference_label = 1,
  liver.reference_left_out = {4, 6};
  liver.adaption.max_shift_px = 2.5;
  liver.adaption.skipped_shift_px = 1.5;
  liver.slices = {{3, {{{10, 10}, {50.25, 12}, {30, 60}}}, {}},
                  {7, {{{10, 10}, {50, 12}, {30, 60}}}, {{{20, 20}, {25, 20}, {22, 30}}}}};
  points.structures = {liver};
  points.tubes = {
      {"cystic_duct", "duct", "gallbladder", "", false, {{3, {20, 20}, 1.5}, {4.5, {22, 20}, 1.4}}}};
  points.landmarks = {{"umbilical_fissure", 5, {44, 33}}};
  return points;
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

ErrorCode CodeOf(const std::string& text) {
  const auto parsed = ParseControlPoints(text, "test");
  return parsed.ok() ? ErrorCode::kNone : parsed.error().code;
}

TEST(ControlPoints, ComeBackUnchanged) {
  const std::string text = FormatControlPoints(MakePoints());
  const auto parsed = ParseControlPoints(text, "test");
  ASSERT_TRUE(parsed.ok()) << parsed.error().Text();
  EXPECT_EQ(FormatControlPoints(*parsed), text);
  const Structure* liver = parsed->FindStructure("liver");
  ASSERT_NE(liver, nullptr);
  EXPECT_EQ(liver->slices[1].holes[0][2], (math::Vec2{22, 30}));
  EXPECT_EQ(liver->slices[0].contours[0][1], (math::Vec2{50.25, 12}));
  EXPECT_EQ(liver->adaption.max_shift_px, 2.5);
  EXPECT_EQ(liver->adaption.skipped_shift_px, 1.5);
  EXPECT_EQ(liver->reference_left_out[1], 6);
  EXPECT_FALSE(parsed->tubes[0].is_seen);
  EXPECT_EQ(parsed->tubes[0].points[1].slice, 4.5);
  EXPECT_NE(parsed->FindLandmark("umbilical_fissure"), nullptr);
}

TEST(ControlPoints, NeedAPatternForPicturesOnly) {
  ControlPoints points = MakePoints();
  points.image_pattern.clear();
  const std::string text = FormatControlPoints(points);
  const auto parsed = ParseControlPoints(text, "test");
  ASSERT_TRUE(parsed.ok()) << parsed.error().Text();
  EXPECT_EQ(parsed->image_pattern, "");
  EXPECT_EQ(FormatControlPoints(*parsed), text);
  const std::string with = FormatControlPoints(MakePoints());
  EXPECT_EQ(CodeOf(Replaced(with, "slice-{slice:03}.png", "slice.png")), ErrorCode::kJsonField);
  EXPECT_EQ(CodeOf(Replaced(with, "slice-{slice:03}.png", "../{slice}.png")), ErrorCode::kJsonField);
}

TEST(ControlPoints, RejectAPointOutsideTheImage) {
  const std::string text = FormatControlPoints(MakePoints());
  EXPECT_EQ(CodeOf(Replaced(text, "[50.25, 12]", "[100, 12]")), ErrorCode::kControlPointOutside);
  EXPECT_EQ(CodeOf(Replaced(text, "[50.25, 12]", "[99, 79]")), ErrorCode::kNone);
  EXPECT_EQ(CodeOf(Replaced(text, "[50.25, 12]", "[50.25, -0.5]")), ErrorCode::kControlPointOutside);
  const auto parsed = ParseControlPoints(Replaced(text, "[50.25, 12]", "[100, 12]"), "test");
  EXPECT_NE(parsed.error().message.find("slices[0].contours[0][1]"), std::string::npos)
      << parsed.error().message;
}

TEST(ControlPoints, RejectAContourOfTwoPoints) {
  const std::string text = FormatControlPoints(MakePoints());
  EXPECT_EQ(CodeOf(Replaced(text, "[10, 10], [50.25, 12], [30, 60]", "[10, 10], [30, 60]")),
            ErrorCode::kContourTooShort);
  EXPECT_EQ(CodeOf(Replaced(text, "[10, 10], [50.25, 12], [30, 60]", "[10, 10], [30, 60], [10, 10]")),
            ErrorCode::kContourTooShort);
}

TEST(ControlPoints, RejectWhatIsMisspeltOrContradicts) {
  const std::string text = FormatControlPoints(MakePoints());
  EXPECT_EQ(CodeOf(Replaced(text, "\"max_shift_px\"", "\"max_shift\"")), ErrorCode::kJsonField);
  EXPECT_EQ(CodeOf(Replaced(text, "\"skipped_shift_px\": 1.5", "\"skipped_shift_px\": 31")),
            ErrorCode::kJsonField);
  EXPECT_EQ(CodeOf(Replaced(text, "\"slice\": 7", "\"slice\": 3")), ErrorCode::kJsonField);
  EXPECT_EQ(CodeOf(Replaced(text, "\"slice\": 7", "\"slice\": 77")), ErrorCode::kJsonField);
  EXPECT_EQ(CodeOf(Replaced(text, "\"row\": \"anterior\"", "\"row\": \"right\"")), ErrorCode::kJsonField);
  EXPECT_EQ(CodeOf(Replaced(text, "slice-{slice:03}.png", "../{slice:03}.png")), ErrorCode::kJsonField);
  EXPECT_EQ(CodeOf(Replaced(text, "\"version\": 1", "\"version\": 2")), ErrorCode::kJsonField);
  EXPECT_EQ(CodeOf(Replaced(text, "\"kind\": \"duct\"", "\"kind\": \"vein\"")), ErrorCode::kJsonField);
  EXPECT_EQ(CodeOf(Replaced(text, "20, 20, 1.5", "20, 20, -1.5")), ErrorCode::kJsonField);
}

TEST(ControlPoints, RejectEveryTruncation) {
  const std::string text = FormatControlPoints(MakePoints());
  for (std::size_t length = 0; length + 2 < text.size(); ++length) {
    ASSERT_EQ(CodeOf(text.substr(0, length)), ErrorCode::kJsonSyntax) << length;
  }
}

TEST(AxisDirections, PointIntoTheWorld) {
  const auto d = AxisDirections(MakePoints());
  EXPECT_EQ(d[0], (std::array<double, 3>{1, 0, 0}));
  EXPECT_EQ(d[1], (std::array<double, 3>{0, 0, 1}));
  EXPECT_EQ(d[2], (std::array<double, 3>{0, -1, 0}));
}

}  // namespace
}  // namespace trocar::contours
