// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/contour_propagation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "phantom_picture.h"

namespace trocar::contours {

using math::Vec2;

namespace {

images::ColorImage MakeDisc(const Vec2& centre, double radius, std::uint64_t seed) {
  return DrawPhantom({.seed = seed}, [=](double x, double y) { return Norm(Vec2{x, y} - centre) - radius; });
}

TEST(PropagateContour, FollowsADiscThatMovesAndGrows) {
  const auto ring = MakePolar({80, 80}, 12, [](double) { return 40.0; });
  const auto result = PropagateContour(MakeDisc({80, 80}, 40, 1), MakeDisc({85, 77}, 44, 2), ring);
  ASSERT_EQ(result.points.size(), ring.size());
  for (std::size_t i = 0; i < ring.size(); ++i) {
    EXPECT_NEAR(Norm(result.points[i] - Vec2{85, 77}), 44.0, 0.5) << i;
    EXPECT_GT(result.confidence[i], 0.7) << i;
  }
}

TEST(PropagateContour, StaysWhereNothingChanges) {
  const auto ring = MakePolar({80, 80}, 12, [](double) { return 40.0; });
  const auto picture = MakeDisc({80, 80}, 40, 1);
  const auto result = PropagateContour(picture, picture, ring, {.is_adapting = false});
  for (std::size_t i = 0; i < ring.size(); ++i) {
    EXPECT_NEAR(Norm(result.points[i] - ring[i]), 0.0, 0.05);
    EXPECT_GT(result.confidence[i], 0.9);
  }
}

TEST(PropagateContour, SaysWhereTheOrganIsGone) {
  // the other slice is empty in its right half
  const auto ring = MakePolar({80, 80}, 12, [](double) { return 40.0; });
  images::ColorImage half = MakeDisc({80, 80}, 40, 2);
  for (int y = 0; y < half.height; ++y) {
    for (int x = 82; x < half.width; ++x) std::copy_n(half.At(2, 2), 3, half.At(x, y));
  }
  const auto result = PropagateContour(MakeDisc({80, 80}, 40, 1), half, ring);
  EXPECT_LT(result.confidence[0], 0.4);
  EXPECT_GT(result.confidence[6], 0.7);
}

}  // namespace
}  // namespace trocar::contours
