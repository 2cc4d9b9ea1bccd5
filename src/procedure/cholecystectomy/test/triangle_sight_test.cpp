// SPDX-License-Identifier: Apache-2.0
// Sight of the hepatocystic triangle, alone and as the judge of a dissection asks for it.
#include "trocar/cholecystectomy/triangle_sight.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "trocar/cholecystectomy/dissection_monitor.h"

namespace trocar::cholecystectomy {
namespace {

using math::Vec3;

constexpr double kKept = 0.005;  // m

/// Cystic and hepatic duct of 20 mm along x, 15 mm apart along y; a strand of fat over the middle of the cystic one. Tubes 0
/// and 1, the cystic duct and an artery beside it, enter a gallbladder that begins 24 mm out; they show 5 mm before it.
struct Triangle {
  static constexpr std::uint32_t kDuct = 0, kArtery = 1;
  std::vector<std::uint32_t> cystic, hepatic;
  std::vector<TubeEntry> entries;
  std::vector<Vec3> rest;
  std::vector<surgery::FatStrand> fat;

  explicit Triangle(double apart = 0.015) {
    const auto add_duct = [&](double y) {
      std::vector<std::uint32_t> nodes;
      for (int k = 0; k <= 10; ++k) {
        nodes.push_back(static_cast<std::uint32_t>(rest.size()));
        rest.push_back({0.002 * k, y, 0});
      }
      return nodes;
    };
    cystic = add_duct(0);
    hepatic = add_duct(apart);
    const auto node = static_cast<std::uint32_t>(rest.size());
    rest.push_back({0.004, 0, 0.009});
    rest.push_back({0.008, 0, 0.009});
    fat.push_back({0, node, node + 1});
    const auto add_entry = [&](std::uint32_t tube, double y) {
      const auto first = static_cast<std::uint32_t>(rest.size());
      rest.push_back({0.018, y, 0});
      rest.push_back({0.022, y, 0});
      entries.push_back({tube, {first, first + 1}, 0.25});
    };
    add_entry(kDuct, 0.0);
    add_entry(kArtery, 0.008);
  }
  TriangleSight Sight(double kept_share = 0) const {
    return {cystic, hepatic, kept_share, entries, surgery::FatLobules(fat, rest, 0.003), kKept};
  }
};

TEST(TriangleSight, AsksForTheCysticDuctAndTheMiddleOfTheWindow) {
  const Triangle triangle;
  TriangleSight sight = triangle.Sight();
  const auto points = sight.FindPoints(triangle.rest);
  EXPECT_NEAR(math::Distance(points[0], {0.006, 0, 0}), 0, 1e-12);
  EXPECT_NEAR(math::Distance(points[1], {0.014, 0, 0}), 0, 1e-12);
  // the last 5 mm before the hepatic duct are no window
  EXPECT_NEAR(math::Distance(points[2], {0.010, 0.005, 0}), 0, 1e-12);
  const Triangle narrow(0.004);
  TriangleSight sight_of_narrow = narrow.Sight();
  EXPECT_NEAR(math::Distance(sight_of_narrow.FindPoints(narrow.rest)[2], {0.010, 0, 0}), 0, 1e-12);
  EXPECT_FALSE(TriangleSight().HasTriangle());
}

// It runs beside the hepatic duct for more than half of its length.
TEST(TriangleSight, AsksForNothingThatKeepsItsFat) {
  const Triangle triangle;
  TriangleSight sight = triangle.Sight(0.6);
  const auto points = sight.FindPoints(triangle.rest);
  EXPECT_NEAR(math::Distance(points[0], {0.012, 0, 0}), 0, 1e-12);
  EXPECT_NEAR(math::Distance(points[1], {0.014, 0, 0}), 0, 1e-12) << "as ever";
  const Vec3 beside{0.012, 0, 0}, across{0.010, 0.015, 0};
  const double window = math::Distance(beside, across) - 0.005;
  EXPECT_NEAR(math::Distance(points[2], beside), 0.5 * window, 1e-12)
      << "the middle of the window from there";
  TriangleSight between = triangle.Sight(0.55);
  EXPECT_NEAR(math::Distance(between.FindPoints(triangle.rest)[0], {0.012, 0, 0}), 0, 1e-12)
      << "the next node that is exposable, not the last that is not";
}

// A lobule that touches what is kept stays as a whole.
TEST(TriangleSight, AsksForNoMiddleThatKeptFatReachesOver) {
  const Triangle triangle(0.0095);
  TriangleSight sight = triangle.Sight();
  const Vec3 middle = sight.FindPoints(triangle.rest)[2];
  EXPECT_NEAR(middle.x, 0.010, 1e-12);
  EXPECT_LE(middle.y, 0.0095 - kKept - 0.003);
  EXPECT_GT(middle.y, 0.001) << "but for what fat is reached over, in the window";
}

TEST(TriangleSight, AsksForWhereEachWholeTubeEntersTheGallbladder) {
  const Triangle triangle;
  TriangleSight sight = triangle.Sight();
  const auto ask = [&](std::vector<std::uint32_t> divided) {
    sight.Update(std::vector<std::uint8_t>{1}, [&](std::uint32_t tube) {
      return std::find(divided.begin(), divided.end(), tube) != divided.end();
    });
    const auto points = sight.FindPoints(triangle.rest);
    return std::vector<Vec3>(points.begin() + 3, points.end());
  };
  const Vec3 duct = {0.019, 0, 0}, artery = {0.019, 0.008, 0};
  EXPECT_EQ(ask({}), (std::vector<Vec3>{duct, artery}));
  EXPECT_EQ(ask({Triangle::kDuct}), std::vector<Vec3>{artery});
  EXPECT_EQ(ask({Triangle::kArtery}), std::vector<Vec3>{duct});
  EXPECT_TRUE(ask({Triangle::kDuct, Triangle::kArtery}).empty());
}

TEST(TriangleSight, EndsAtTheSkin) {
  const collision::Segment line = TriangleSight::LineTo({0, 0, 0}, {0, 0, 0.06});
  EXPECT_EQ(line.start, (Vec3{0, 0, 0.06}));
  EXPECT_NEAR(math::Distance(line.end, {0, 0, 0.004}), 0, 1e-12);
}

class SightOfMonitor : public ::testing::Test {
 protected:
  bool Sees(const Vec3& eye) {
    DissectedAnatomy anatomy;
    anatomy.sight = triangle_.Sight();
    anatomy.cystic_duct = triangle_.cystic;
    anatomy.neck = {triangle_.cystic[9], triangle_.cystic[10], triangle_.hepatic[10]};
    DissectionMonitor monitor(std::move(anatomy), triangle_.rest);
    const surgery::Vessels none({surgery::FlowNetwork::Make({}, {}).value(), {}, {}, {}, {}},
                                std::span<const surgery::VesselTube>{}, 0, 0);
    monitor.Update(tissue_, none, {}, {{{}, eye}, 1.2});
    return monitor.Facts().is_triangle_in_view;
  }
  void SetUp() override {
    tissue_.position = triangle_.rest;
    tissue_.strand_is_intact = {1};
  }

  Triangle triangle_;
  tissue::TissueState tissue_;
};

TEST_F(SightOfMonitor, FatOnTheLineOfSightHidesTheTriangleUntilItIsDivided) {
  const Vec3 above = {0.006, 0, 0.06};
  EXPECT_FALSE(Sees(above));
  tissue_.strand_is_intact = {0};
  EXPECT_TRUE(Sees(above));
}

// A gallbladder that was swung about lies with its neck beside the lump: the duct is seen, its entry is not.
TEST_F(SightOfMonitor, FatBeforeAnEntryHidesTheTriangle) {
  const Vec3 above = {0.006, 0, 0.06};
  const auto move_fat = [&](double x, double y) {
    tissue_.position[triangle_.fat[0].a] = {x - 0.002, y, 0.009};
    tissue_.position[triangle_.fat[0].b] = {x + 0.002, y, 0.009};
  };
  move_fat(0.017, 0.007);
  EXPECT_FALSE(Sees(above)) << "before the artery's";
  move_fat(0.017, 0.017);
  EXPECT_TRUE(Sees(above)) << "beside both";
}

TEST_F(SightOfMonitor, TheSameFatBesideTheLineOfSightHidesNothing) {
  EXPECT_TRUE(Sees({0.006, -0.03, 0.06})) << "past the fat";
  for (const std::uint32_t node : {triangle_.fat[0].a, triangle_.fat[0].b})
    tissue_.position[node] += Vec3{0, 0.02, 0};
  EXPECT_TRUE(Sees({0.006, 0, 0.06})) << "drawn aside";
}

}  // namespace
}  // namespace trocar::cholecystectomy
