// SPDX-License-Identifier: Apache-2.0
#include "pool_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/primitives.h"
#include "trocar/host/data_folder.h"
#include "trocar/render/offscreen_context.h"
#include "trocar/render/offscreen_target.h"
#include "trocar/scene/scene.h"

namespace trocar::view {
namespace {

using math::Vec3;

constexpr double kLevel = -0.096, kRadius = 0.02;

/// A bowl whose lowest place is (0, 0, -0.1); the level meets it at a radius of 0.02 m.
geometry::TriangleMesh MakeBowl() {
  geometry::TriangleMesh bowl = geometry::MakeGrid(50, 0.0016);
  for (Vec3& p : bowl.positions) {
    p += Vec3{-0.04, -0.04, 0};
    p.z = -0.1 + 0.004 * (p.x * p.x + p.y * p.y) / (kRadius * kRadius);
  }
  return bowl;
}

render::Puddle MakePuddle() {
  render::Puddle puddle;
  puddle.centre = {0, 0, kLevel};
  puddle.radius = kRadius;
  return puddle;
}

PoolSurface MakePool(const geometry::TriangleMesh& ground) {
  PoolSurface pool;
  const GroundShape shape{ground.positions, ground.triangles};
  pool.Make(MakePuddle(), {0, 0, -0.1}, std::span(&shape, 1));
  return pool;
}

TEST(PoolSurface, IsLevelWhereItIsDeepAndDrawnUpAtItsShore) {
  const PoolSurface pool = MakePool(MakeBowl());
  ASSERT_FALSE(pool.Mesh().triangles.empty());
  double highest = -1;
  for (std::size_t v = 0; v < pool.Mesh().positions.size(); ++v) {
    const Vec3& p = pool.Mesh().positions[v];
    const double side = std::hypot(p.x, p.y);
    if (side < 0.008) {
      EXPECT_NEAR(p.z, kLevel, 0.0001);
      EXPECT_GT(pool.Shares()[v], 0.95);
    }
    if (side > kRadius + 0.006) {
      EXPECT_LT(pool.Shares()[v], 0.05) << "no hard edge";
    }
    if (pool.Shares()[v] > 0.3) highest = std::max(highest, p.z);
  }
  EXPECT_GT(highest, kLevel + 0.0003) << "a meniscus";
}

TEST(PoolSurface, ItsShoreFollowsTheGround) {
  geometry::TriangleMesh bowl = MakeBowl();
  for (Vec3& p : bowl.positions)
    if (p.x > 0.005 && p.x < 0.011 && std::abs(p.y) < 0.004) p.z = kLevel + 0.004;  // an island
  const PoolSurface pool = MakePool(bowl);
  for (std::size_t v = 0; v < pool.Mesh().positions.size(); ++v) {
    const Vec3& p = pool.Mesh().positions[v];
    if (std::hypot(p.x - 0.008, p.y) < 0.0015) {
      EXPECT_LT(pool.Shares()[v], 0.6) << "the island stands out";
    }
  }
}

// The ground rises 6 mm between two points of the lattice: a wall that holds no liquid.
TEST(PoolSurface, EndsNowhereAsAWall) {
  geometry::TriangleMesh cliff = MakeBowl();
  for (Vec3& p : cliff.positions)
    if (p.x > 0.004) p.z = kLevel + 0.0025;
  const PoolSurface pool = MakePool(cliff);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const geometry::Triangle& t : pool.Mesh().triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
  }
  int border = 0;
  for (const auto& [edge, triangles] : edges) {
    if (triangles != 1) continue;
    ++border;
    EXPECT_LT(std::max(pool.Shares()[edge.first], pool.Shares()[edge.second]), 0.05);
  }
  EXPECT_GT(border, 20);
  EXPECT_GT(*std::max_element(pool.Shares().begin(), pool.Shares().end()), 0.95) << "there is a pool";
}

// It stands in deep liquid, so without it there is no shore for a long way round.
TEST(PoolSurface, ThinsOutToNothingAtALobuleOfFat) {
  const geometry::TriangleMesh bowl = MakeBowl();
  const GroundShape shape{bowl.positions, bowl.triangles};
  const FatLobule lobule{{0.004, 0, kLevel - 0.001}, {}, 0.005};
  PoolSurface pool;
  pool.Make(MakePuddle(), {0, 0, -0.1}, std::span(&shape, 1), std::span(&lobule, 1));
  const double radius = std::sqrt(0.005 * 0.005 - 0.001 * 0.001);  // where it passes through the level
  int at_shore = 0;
  for (std::size_t v = 0; v < pool.Mesh().positions.size(); ++v) {
    const Vec3& p = pool.Mesh().positions[v];
    const double from = std::hypot(p.x - lobule.centre.x, p.y) - radius;
    if (from < 0.0) {
      EXPECT_EQ(pool.Shares()[v], 0.0);
    } else if (from < 0.0004) {
      EXPECT_LT(pool.Shares()[v], 0.4);
      ++at_shore;
    } else if (from > 0.0055 && std::hypot(p.x, p.y) < 0.010) {
      EXPECT_GT(pool.Shares()[v], 0.9) << "as without it";
    }
  }
  EXPECT_GT(at_shore, 4);
}

TEST(PoolSurface, ThickerHidesMore) {
  EXPECT_EQ(CalcPoolShare(-0.002), 0.0);
  EXPECT_LT(CalcPoolShare(-0.0005), CalcPoolShare(0.0002));
  EXPECT_LT(CalcPoolShare(0.0002), CalcPoolShare(0.002));
  EXPECT_GT(CalcPoolShare(0.004), 0.99);
}

/// A pool of blood on black ground, seen aslant.
class PoolPictureTest : public testing::Test {
 protected:
  static constexpr int kWidth = 320, kHeight = 180;

  void SetUp() override {
    auto context = render::OffscreenContext::Make();
    ASSERT_TRUE(context.ok()) << context.error().Text();
    context_.emplace(std::move(*context));
    auto target = render::OffscreenTarget::Make(kWidth, kHeight);
    ASSERT_TRUE(target.ok()) << target.error().Text();
    target_.emplace(std::move(*target));
    const auto looks = render::ReadLooks(*host::FindDataFolder() / render::kLooksFile);
    ASSERT_TRUE(looks.ok()) << looks.error().Text();
    looks_ = *looks;
  }

  /// Pixels that are nearly white, and those that are lit at all.
  std::array<int, 2> CountGlints(const render::Looks& looks) {
    auto renderer = render::Renderer::Make(looks);
    EXPECT_TRUE(renderer.ok());
    const PoolSurface pool = MakePool(MakeBowl());
    render::Frame frame;
    frame.has_mask = frame.has_smooth_edges = false;
    frame.clear_colour = {0, 0, 0};
    frame.puddles = {MakePuddle()};
    frame.puddles[0].surface =
        renderer->AddSurface(pool.Mesh().triangles, pool.Rest(), render::Material::kBlood, pool.Shares());
    std::vector<Vec3> normals(pool.Mesh().positions.size());
    geometry::CalcVertexNormals(pool.Mesh().positions, pool.Mesh().triangles, normals);
    renderer->UpdateSurface(frame.puddles[0].surface, pool.Mesh().positions, normals);
    // from 0.07 m, nearly from above
    const double tilt = 0.15;
    frame.camera.X_world_camera = {math::RotationAbout({1, 0, 0}, tilt),
                                   Vec3{0, -0.07 * std::sin(tilt), kLevel + 0.07 * std::cos(tilt)}};
    target_->Bind();
    renderer->Draw(frame, kWidth, kHeight);
    render::Image image;
    target_->Read(image);
    std::array<int, 2> count{};
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const auto [r, g, b] = image.At(x, y);
        count[0] += std::min({r, g, b}) > 120 ? 1 : 0;
        count[1] += r > 10 ? 1 : 0;
      }
    }
    return count;
  }

  std::optional<render::OffscreenContext> context_;
  std::optional<render::OffscreenTarget> target_;
  render::Looks looks_;
};

TEST_F(PoolPictureTest, GlintsInTheHeadLight) {
  const auto [glints, lit] = CountGlints(looks_);
  EXPECT_GT(lit, 2000);
  EXPECT_GT(glints, 12);
  EXPECT_LT(glints, lit / 5) << "and is blood elsewhere";
  // negative control: without gloss
  render::Looks dull = looks_;
  dull.materials[static_cast<std::size_t>(render::Material::kBlood)].wet = 0;
  EXPECT_EQ(CountGlints(dull)[0], 0);
}

}  // namespace
}  // namespace trocar::view
