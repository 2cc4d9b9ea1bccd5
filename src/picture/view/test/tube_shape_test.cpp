// SPDX-License-Identifier: Apache-2.0
#include "tube_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace trocar::view {
namespace {

using math::Vec3;

constexpr double kRadius = 0.002;
constexpr std::uint32_t kNodes = 16;

std::vector<Vec3> MakeLine(const Vec3& from) {
  std::vector<Vec3> nodes;
  for (std::uint32_t i = 0; i < kNodes; ++i) nodes.push_back(from + Vec3{0.003 * i, 0, 0});
  return nodes;
}

/// Standard deviation of a tube's half width as it is seen from +z, in its mean.
double MeasureUnevenness(TubeCourse& course, std::span<const Vec3> nodes) {
  std::vector<Vec3> skin(course.SkinSize());
  course.CalcSkin(nodes, skin);
  std::vector<double> widths;
  for (std::size_t ring = 0; ring < course.RingCount(); ++ring) {
    double low = 1, high = -1;
    for (std::size_t side = 0; side < TubeCourse::kSides; ++side) {
      low = std::min(low, skin[ring * TubeCourse::kSides + side].y);
      high = std::max(high, skin[ring * TubeCourse::kSides + side].y);
    }
    widths.push_back(0.5 * (high - low));
  }
  double mean = 0, squares = 0;
  for (const double w : widths) mean += w / static_cast<double>(widths.size());
  for (const double w : widths) squares += (w - mean) * (w - mean) / static_cast<double>(widths.size());
  return std::sqrt(squares) / mean;
}

TEST(TubeCourse, ALivingTubeIsUnevenAlongItsSilhouetteAndARubberOneIsNot) {
  const std::vector<Vec3> nodes = MakeLine({0.01, 0.02, -0.1});
  const std::vector<double> radii(kNodes, kRadius);
  TubeCourse even(nodes, radii, {}, TubeLook::kEven), living(nodes, radii, {}, TubeLook::kLiving);
  EXPECT_EQ(even.RingCount(), std::size_t{kNodes});
  EXPECT_LT(MeasureUnevenness(even, nodes), 1e-9);
  EXPECT_GT(MeasureUnevenness(living, nodes), 0.04);
  for (const double radius : living.Radii()) {
    EXPECT_GT(radius, 0.7 * kRadius);
    EXPECT_LT(radius, 1.35 * kRadius);
  }
}

TEST(TubeCourse, MeetsWhatItJoinsAsTheModelHasIt) {
  const std::vector<Vec3> nodes = MakeLine({0.01, 0.02, -0.1});
  const std::vector<double> radii(kNodes, kRadius);
  const std::vector<Vec3> fixed = {nodes.front()};
  TubeCourse course(nodes, radii, fixed, TubeLook::kLiving);
  std::vector<Vec3> skin(course.SkinSize());
  course.CalcSkin(nodes, skin);
  for (std::size_t side = 0; side < TubeCourse::kSides; ++side)
    EXPECT_NEAR(math::Distance(skin[side], nodes.front()), kRadius, 1e-12);
}

TEST(TubeCourse, StaysNearTheModelAndMovesWithIt) {
  const std::vector<Vec3> nodes = MakeLine({0.01, 0.02, -0.1});
  const std::vector<double> radii(kNodes, kRadius);
  TubeCourse course(nodes, radii, {}, TubeLook::kLiving);
  std::vector<Vec3> skin(course.SkinSize()), moved(course.SkinSize());
  course.CalcSkin(nodes, skin);
  for (std::size_t v = 0; v + 2 < skin.size(); ++v) {
    const double away = std::hypot(skin[v].y - 0.02, skin[v].z + 0.1);
    EXPECT_GT(away, 0.4 * kRadius);
    EXPECT_LT(away, 1.8 * kRadius);
  }
  std::vector<Vec3> there = nodes;
  for (Vec3& p : there) p += Vec3{0.01, -0.02, 0.005};
  course.CalcSkin(there, moved);
  for (std::size_t v = 0; v < skin.size(); ++v)
    EXPECT_LT(math::Distance(moved[v], skin[v] + Vec3{0.01, -0.02, 0.005}), 1e-12);
}

class TubeShapeTest : public testing::Test {
 protected:
  void SetUp() override {
    now_.positions = MakeLine({0.01, 0.02, -0.1});
    now_.gravity = {0, 0, -9.81};
  }
  TubeShape Make(TubeLook look) {
    scene::SurfaceInfo info{"cystic_duct", "duct", 0, kNodes, {}, std::vector<double>(kNodes, kRadius)};
    TubeShape tube(info, 0, render::Material::kDuct, now_.positions, look);
    tube.Update(now_, Film(now_));
    return tube;
  }
  simulation::Snapshot now_;
};

TEST_F(TubeShapeTest, RagsAndThreadsHangOnALivingWallAndKeepTheirPlaceThroughACut) {
  render::Frame rubber, whole, cut;
  Make(TubeLook::kEven).AddRemnants(rubber);
  EXPECT_TRUE(rubber.fibres.empty());
  TubeShape tube = Make(TubeLook::kLiving);
  tube.AddRemnants(whole);
  std::set<render::Material> kinds;
  for (const render::Fibre& fibre : whole.fibres) {
    kinds.insert(fibre.material);
    EXPECT_LT(std::hypot(fibre.a.y - 0.02, fibre.a.z + 0.1), 2.0 * kRadius) << "they begin at the wall";
  }
  EXPECT_GE(whole.fibres.size(), 2u * kNodes);
  EXPECT_TRUE(kinds.contains(render::Material::kFilm) && kinds.contains(render::Material::kFibre));

  RowMemory memory;
  memory.Resize(kNodes);
  for (std::uint32_t i = 0; i < kNodes; ++i) memory.Set(i, now_.positions[i], 1.0);
  std::vector<surgery::TubePiece> pieces;
  for (std::uint32_t i = 0; i + 1 < kNodes; ++i)
    if (i != 7) pieces.push_back({i, i + 1, kRadius, kRadius, 0});
  tube.SetPieces(pieces, memory, now_.positions);
  tube.Update(now_, Film(now_));
  tube.AddRemnants(cut);
  // those of the first nodes are far from the cut
  for (std::size_t i = 0; i < 12; ++i)
    EXPECT_LT(math::Distance(cut.fibres[i].a, whole.fibres[i].a), 1e-9) << i;
  EXPECT_LT(cut.fibres.size(), whole.fibres.size()) << "none spans the gap";
}

}  // namespace
}  // namespace trocar::view
