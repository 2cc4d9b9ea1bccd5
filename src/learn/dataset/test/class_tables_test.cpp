// SPDX-License-Identifier: Apache-2.0
#include "class_tables.h"

#include <gtest/gtest.h>

#include <set>

#include "files.h"

namespace trocar::dataset {
namespace {

using cholecystectomy::InstrumentKind;
using cholecystectomy::Target;
using cholecystectomy::Verb;

TEST(ClassTables, HaveThePublishedGreysOfCholecSeg8k) {
  const std::array<int, 13> greys = {50, 11, 21, 13, 12, 31, 23, 24, 25, 32, 22, 33, 5};
  ASSERT_EQ(CholecSeg8kClasses().size(), greys.size());
  for (std::size_t i = 0; i < greys.size(); ++i) {
    EXPECT_EQ(CholecSeg8kClasses()[i].id, static_cast<int>(i));
    EXPECT_EQ(CholecSeg8kClasses()[i].watershed, greys[i]);
  }
}

TEST(ClassTables, MapEveryLabelToAClassThatIsThere) {
  for (std::size_t i = 0; i < view::kLabelClassCount; ++i) {
    const auto label = static_cast<view::LabelClass>(i);
    EXPECT_LT(ToCholecSeg8k(label), 13);
    EXPECT_LT(ToEndoscapes(label), 7);
  }
  EXPECT_EQ(ToCholecSeg8k(view::LabelClass::kGallbladder), 10);
  EXPECT_EQ(ToCholecSeg8k(view::LabelClass::kHook), 9);
  EXPECT_EQ(ToEndoscapes(view::LabelClass::kCysticDuct), 4);
  EXPECT_EQ(ToEndoscapes(view::LabelClass::kScissors), 6);
}

// issue 47: the second and the third were exchanged. Ours are triangle, plate, structures; theirs structures, triangle, plate.
TEST(ClassTables, OrderTheCriticalViewAsEndoscapesDoes) {
  scene::ViewScore score;
  score.criteria = {2, 1, 0};
  EXPECT_EQ(EndoscapesCriteria(score), (std::array{0.0, 1.0, 0.5}));
  score.criteria = {0, 0, 2};
  EXPECT_EQ(EndoscapesCriteria(score), (std::array{1.0, 0.0, 0.0}));
}

TEST(ClassTables, NumberTheTripletsOfCholecT50AsPublished) {
  const auto find = [](InstrumentKind i, Verb v, Target t) { return FindCholecT50Triplet({i, v, t}); };
  EXPECT_EQ(find(InstrumentKind::kGrasper, Verb::kRetract, Target::kGallbladder), 17);
  EXPECT_EQ(find(InstrumentKind::kHook, Verb::kDissect, Target::kGallbladder), 60);
  EXPECT_EQ(find(InstrumentKind::kClipper, Verb::kClip, Target::kCysticDuct), 79);
  EXPECT_EQ(find(InstrumentKind::kScissors, Verb::kCut, Target::kCysticArtery), 68);
  EXPECT_EQ(find(InstrumentKind::kIrrigator, Verb::kNullVerb, Target::kNullTarget), 99);
  EXPECT_EQ(find(InstrumentKind::kHook, Verb::kPack, Target::kLiver), -1);
  std::set<std::string> names;
  for (const cholecystectomy::Triplet& triplet : CholecT50Triplets())
    names.insert(cholecystectomy::NameOf(triplet));
  EXPECT_EQ(names.size(), 100U);
}

TEST(Runs, CountColumnsAndBeginWithZeros) {
  // 2 rows, 3 columns: 0 1 1 / 1 1 0
  const std::vector<std::uint8_t> mask = {0, 1, 1, 1, 1, 0};
  EXPECT_EQ(CountRuns(mask, 3, 2), (std::vector<std::uint32_t>{1, 4, 1}));
  EXPECT_EQ(CountRuns(std::vector<std::uint8_t>{1, 1}, 2, 1), (std::vector<std::uint32_t>{0, 2}));
}

TEST(Boxes, HoldTheirPixelsAndNoMore) {
  render::GeometryPicture picture{4, 3, {}, {}, {0, 0, 0, 0, 0, 7, 7, 0, 0, 0, 7, 0}};
  const auto box = FindBox(picture, [](std::uint16_t label) { return label == 7; });
  ASSERT_TRUE(box);
  EXPECT_EQ((std::array{box->x, box->y, box->width, box->height}), (std::array{1, 1, 2, 2}));
  EXPECT_FALSE(FindBox(picture, [](std::uint16_t label) { return label == 8; }));
}

}  // namespace
}  // namespace trocar::dataset
