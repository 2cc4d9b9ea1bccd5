// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/edge_adaption.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "trocar/math/random.h"

namespace trocar::contours {

using math::Vec2;

namespace {

constexpr double kCentre = 60.0, kRadius = 35.0;

// a dark red disc on a light ground with a soft border and noise
images::ColorImage MakeDisc(double softness, double noise, std::uint64_t seed) {
  math::Random random(seed);
  images::ColorImage image{120, 120, std::vector<std::uint8_t>(120 * 120 * 3)};
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 120; ++x) {
      const double away = std::hypot(x - kCentre, y - kCentre) - kRadius;
      const double outside = 0.5 * (1 + std::erf(away / (softness * std::sqrt(2.0))));
      const double low[3] = {110, 30, 25}, high[3] = {200, 170, 140};
      for (int c = 0; c < 3; ++c) {
        const double value =
            low[c] + outside * (high[c] - low[c]) + noise * (random.Uniform() + random.Uniform() - 1);
        image.At(x, y)[c] = static_cast<std::uint8_t>(std::clamp(std::round(value), 0.0, 255.0));
      }
    }
  }
  return image;
}

std::vector<Vec2> MakeRing(double radius, int n = 24) {
  std::vector<Vec2> ring;
  for (int i = 0; i < n; ++i) {
    ring.push_back(
        {kCentre + radius * std::cos(2 * M_PI * i / n), kCentre + radius * std::sin(2 * M_PI * i / n)});
  }
  return ring;
}

double RadiusOf(const Vec2& p) {
  return std::hypot(p.x - kCentre, p.y - kCentre);
}

TEST(AdaptToEdges, FindsABlurredDiscInNoise) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const images::ColorImage image = MakeDisc(1.5, 8, seed);
    for (const double offset : {-2.0, 1.5, 2.5}) {
      for (const Vec2& p : AdaptToEdges(image, MakeRing(kRadius + offset), {.max_shift_px = 4})) {
        EXPECT_NEAR(RadiusOf(p), kRadius, 0.3) << "seed " << seed << ", offset " << offset;
      }
    }
  }
}

TEST(AdaptToEdges, MovesNothingInAFlatPicture) {
  images::ColorImage flat{120, 120, std::vector<std::uint8_t>(120 * 120 * 3, 128)};
  EXPECT_EQ(AdaptToEdges(flat, MakeRing(kRadius), {}), MakeRing(kRadius));
}

TEST(AdaptToEdges, LeavesPointsWithoutAClearEdge) {
  // the right half of the disc's border is painted over with the inner colour
  images::ColorImage image = MakeDisc(1.0, 0, 1);
  for (int y = 0; y < 120; ++y) {
    for (int x = 62; x < 120; ++x) std::copy_n(image.At(60, 60), 3, image.At(x, y));
  }
  const auto ring = MakeRing(kRadius + 1.5);
  const auto adapted = AdaptToEdges(image, ring, {});
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (ring[i].x > 75) {
      EXPECT_EQ(adapted[i], ring[i]);
    }
    if (ring[i].x < 45) {
      EXPECT_NEAR(RadiusOf(adapted[i]), kRadius, 0.3);
    }
  }
}

TEST(AdaptToEdges, NeverMovesFurtherThanAllowed) {
  const images::ColorImage image = MakeDisc(1.5, 30, 5);
  const auto ring = MakeRing(kRadius + 6);
  const auto adapted = AdaptToEdges(image, ring, {.max_shift_px = 2.0});
  for (std::size_t i = 0; i < ring.size(); ++i) EXPECT_LE(Norm(adapted[i] - ring[i]), 2.0 + 1e-9);
  EXPECT_EQ(AdaptToEdges(image, ring, {.max_shift_px = 0.0}), ring);
}

}  // namespace
}  // namespace trocar::contours
