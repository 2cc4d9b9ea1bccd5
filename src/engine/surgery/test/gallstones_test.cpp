// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/gallstones.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "trocar/geometry/omentum.h"
#include "trocar/geometry/primitives.h"
#include "trocar/math/pose.h"
#include "trocar/math/random.h"

namespace trocar::surgery {

using math::Vec3;

namespace {

constexpr double kTick = 1.0 / 120;
constexpr double kCapacity = 40e-6;  // m^3

double Ball(double diameter) {
  return M_PI / 6.0 * diameter * diameter * diameter;
}

TEST(DrawGallstones, AreAsManyAndAsLargeAsThePatientHas) {
  std::vector<double> logs;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const auto stones = DrawGallstones({20, 0.004}, kCapacity, seed);
    ASSERT_EQ(stones.size(), 20u);
    for (const double d : stones) logs.push_back(std::log(d / 0.004));
  }
  const double n = static_cast<double>(logs.size());
  const double mean = std::accumulate(logs.begin(), logs.end(), 0.0) / n;
  const double square = std::inner_product(logs.begin(), logs.end(), logs.begin(), 0.0) / n;
  EXPECT_NEAR(mean, 0.0, 4 * 0.25 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(square - mean * mean), 0.25, 0.015);
  EXPECT_EQ(DrawGallstones({20, 0.004}, kCapacity, 3), DrawGallstones({20, 0.004}, kCapacity, 3));
  EXPECT_NE(DrawGallstones({20, 0.004}, kCapacity, 3), DrawGallstones({20, 0.004}, kCapacity, 4));
  EXPECT_TRUE(DrawGallstones({0, 0.004}, kCapacity, 3).empty()) << "a patient may have none";
}

TEST(DrawGallstones, FitIntoTheGallbladder) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const auto stones = DrawGallstones({40, 0.020}, kCapacity, seed);
    double volume = 0;
    for (const double d : stones) volume += Ball(d);
    EXPECT_LE(volume, 0.5 * kCapacity);
    EXPECT_LT(stones.size(), 40u);
  }
}

TEST(CalcPassingDiameter, IsThatOfTheHoleWhereItIsRoundAndLessThanASlitIsLong) {
  EXPECT_NEAR(CalcPassingDiameter(M_PI * 0.005), 0.005, 1e-15);
  const double slit = 0.010;
  EXPECT_NEAR(CalcPassingDiameter(2 * slit), 0.00637, 1e-5);
  EXPECT_EQ(CalcPassingDiameter(-1), 0.0);
}

// Poured out drop by drop, the bile takes as many stones with it as were in its volume.
TEST(CalcStoneOutflow, EmptiesInProportionToTheBile) {
  double content = 40e-6, carried = 0;
  std::size_t stones = 1000;
  const double drop = 1e-9;
  for (int i = 0; i < 20000; ++i) {  // half of it
    carried += CalcStoneOutflow(drop, content, stones);
    content -= drop;
    const auto whole = static_cast<std::size_t>(carried);
    carried -= static_cast<double>(whole);
    stones -= whole;
  }
  EXPECT_NEAR(static_cast<double>(stones), 500.0, 2.0);
  EXPECT_EQ(CalcStoneOutflow(0.0, content, stones), 0.0);
  EXPECT_EQ(CalcStoneOutflow(drop, 0.0, stones), 0.0);
  EXPECT_EQ(CalcStoneOutflow(1.0, content, 7), 7.0) << "never more than there are";
}

/// A level box as organ, a bed of fat below it.
class MoveStonesTest : public testing::Test {
 protected:
  void SetUp() override {
    Place(geometry::MakeBox({-0.02, -0.02, -0.01}, {0.02, 0.02, 0.0}));
    bed_mesh_ = geometry::MakeOmentum({});
    auto bed = MakeOrganSurface(bed_mesh_.positions, 0, bed_mesh_);
    ASSERT_TRUE(bed.ok());
    bed_ = std::move(*bed);
  }

  void Place(geometry::TriangleMesh mesh) {
    positions_ = mesh.positions;
    auto organ = MakeOrganSurface(positions_, 0, mesh);
    ASSERT_TRUE(organ.ok());
    organs_ = {std::move(*organ)};
  }

  void Turn(double angle) {
    for (Vec3& p : positions_) p = math::Rotate(math::RotationAbout({1, 0, 0}, angle), p);
    UpdateOrganSurface(organs_[0], positions_);
  }

  StoneGround Ground() const {
    return {organs_, positions_, &bed_, bed_mesh_.positions, {0, 0, -9.81}, pusher_, -0.3};
  }

  void Run(double seconds) {
    std::vector<LooseStone*> all;
    for (LooseStone& stone : stones_) all.push_back(&stone);
    for (double t = 0; t < seconds; t += kTick) MoveStones(Ground(), kTick, all);
  }

  geometry::TriangleMesh bed_mesh_;
  std::vector<Vec3> positions_;
  std::vector<OrganSurface> organs_;
  OrganSurface bed_;
  std::vector<LooseStone> stones_;
  std::vector<StonePusher> pusher_;
};

LooseStone StoneAt(const Vec3& p, double radius) {
  LooseStone stone;
  stone.position = p;
  stone.radius = radius;
  return stone;
}

TEST_F(MoveStonesTest, FallsAsGravityHasItUntilItTouches) {
  stones_ = {StoneAt({0, 0, 0.05}, 0.002)};
  const double t = 10 * kTick;
  Run(t - 0.5 * kTick);
  // symplectic Euler: n (n + 1) / 2 ticks squared
  EXPECT_NEAR(stones_[0].position.z, 0.05 - 9.81 * kTick * kTick * 55, 1e-9);
  EXPECT_FALSE(stones_[0].IsLying());
}

TEST_F(MoveStonesTest, ComesToRestOnAnOrganAndLiesStill) {
  stones_ = {StoneAt({0.003, 0.001, 0.03}, 0.002)};
  Run(1.0);
  ASSERT_TRUE(stones_[0].IsLying());
  EXPECT_EQ(stones_[0].support, 0);
  EXPECT_NEAR(stones_[0].position.z, 0.002, 1e-9);
  EXPECT_NEAR(stones_[0].position.x, 0.003, 1e-6);
  const Vec3 at = stones_[0].position;
  Run(1.0);
  EXPECT_EQ(stones_[0].position, at) << "to the bit: no jitter";
}

TEST_F(MoveStonesTest, IsCarriedAlongAndSlidesOffWhatBecomesSteep) {
  stones_ = {StoneAt({0.003, 0.001, 0.01}, 0.002)};
  Run(1.0);
  ASSERT_EQ(stones_[0].support, 0);
  Turn(0.2);  // 11 degrees
  Run(0.5);
  EXPECT_EQ(stones_[0].support, 0) << "it lies";
  const Vec3 normal = math::Rotate(math::RotationAbout({1, 0, 0}, 0.2), {0, 0, 1});
  EXPECT_NEAR(math::Dot(stones_[0].position, normal), 0.002, 1e-9) << "and has turned with the organ";
  Turn(0.6);  // 46 degrees
  Run(3.0);
  EXPECT_EQ(stones_[0].support, LooseStone::kOnBed) << "it has slid off, and lies on the fat below";
  EXPECT_LT(stones_[0].position.z, -0.09);
}

TEST_F(MoveStonesTest, EveryStoneEndsOnSomethingAndInNothing) {
  math::Random random(11);
  for (int i = 0; i < 40; ++i)
    stones_.push_back(StoneAt({random.Uniform(-0.03, 0.03), random.Uniform(-0.03, 0.03), 0.02 + 0.001 * i},
                              random.Uniform(0.0007, 0.005)));
  Run(6.0);
  int lying = 0;
  for (std::size_t i = 0; i < stones_.size(); ++i) {
    const LooseStone& stone = stones_[i];
    lying += stone.IsLying() ? 1 : 0;
    ASSERT_TRUE(math::IsFinite(stone.position));
    for (const OrganSurface* surface : {&organs_[0], &bed_}) {
      const auto nodes = std::span<const Vec3>(surface == &bed_ ? bed_mesh_.positions : positions_);
      const auto nearest = surface->tree.FindNearest(nodes, stone.position);
      EXPECT_GT(std::sqrt(nearest.squared_distance), stone.radius - 0.0003) << "seed 11, stone " << i;
    }
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_GT(math::Distance(stone.position, stones_[j].position), 0.9 * (stone.radius + stones_[j].radius))
          << "seed 11, stones " << i << " and " << j;
  }
  EXPECT_GE(lying, 30) << "the others are held up by stones";
}

TEST_F(MoveStonesTest, TwoFromTheSamePlaceDoNotLieInEachOther) {
  stones_ = {StoneAt({0, 0, 0.01}, 0.002), StoneAt({0, 0, 0.01}, 0.002)};
  Run(2.0);
  EXPECT_GT(math::Distance(stones_[0].position, stones_[1].position), 0.0038);
}

TEST_F(MoveStonesTest, AToolPushesThemAside) {
  stones_ = {StoneAt({0, 0, 0.01}, 0.002)};
  Run(1.0);
  pusher_ = {{{-0.01, 0.0005, 0.001}, {0.01, 0.0005, 0.001}, 0.0025}};
  Run(1.0);
  ASSERT_TRUE(stones_[0].IsLying());
  EXPECT_LT(stones_[0].position.y, -0.003) << "beside the tool";
  EXPECT_NEAR(stones_[0].position.z, 0.002, 1e-4) << "still on the organ";
}

TEST_F(MoveStonesTest, BesideEverythingItStopsAtTheDeepest) {
  stones_ = {StoneAt({0.5, 0.5, 0}, 0.002)};
  Run(2.0);
  EXPECT_EQ(stones_[0].support, LooseStone::kOnFloor);
  EXPECT_EQ(stones_[0].position.z, -0.298);
}

TEST_F(MoveStonesTest, AfterACutItLooksForItsPlaceAnew) {
  stones_ = {StoneAt({0.003, 0.001, 0.01}, 0.002)};
  Run(1.0);
  const Vec3 at = stones_[0].position;
  std::vector<LooseStone*> all{stones_.data()};
  ForgetSupports(all);
  EXPECT_FALSE(stones_[0].IsLying());
  Run(0.5);
  EXPECT_EQ(stones_[0].support, 0);
  EXPECT_NEAR(math::Distance(stones_[0].position, at), 0.0, 1e-5);
}

TEST_F(MoveStonesTest, IsTheSameBitForBit) {
  stones_ = {StoneAt({0.019, 0, 0.02}, 0.003), StoneAt({0.0195, 0.001, 0.03}, 0.002)};
  const auto start = stones_;
  Run(1.5);
  const auto end = stones_;
  stones_ = start;
  Run(1.5);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(stones_[i].position, end[i].position);
}

}  // namespace
}  // namespace trocar::surgery
