// SPDX-License-Identifier: Apache-2.0
#include "random_triangles.h"
#include "trocar/collision/capsule_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "trocar/math/random.h"

namespace trocar::collision {

using math::Vec3;

namespace {

struct Tubes {
  std::vector<Vec3> points;
  std::vector<TubePiece> pieces;
};

/// Winding tubes of changing thickness, with pieces without length and copies among them.
Tubes MakeTubes(math::Random& random, int tubes, int pieces) {
  Tubes made;
  for (int tube = 0; tube < tubes; ++tube) {
    Vec3 at = RandomPoint(random, 0.1), step = RandomPoint(random, 0.005);
    made.points.push_back(at);
    for (int i = 0; i < pieces; ++i) {
      step = 0.8 * step + RandomPoint(random, 0.002);
      at += i % 11 == 5 ? Vec3{} : step;
      made.points.push_back(at);
      const auto last = static_cast<std::uint32_t>(made.points.size() - 1);
      made.pieces.push_back({last - 1, last, i % 5 == 0 ? 0.0 : random.Uniform(0.001, 0.006)});
    }
  }
  for (int i = 0; i < 10; ++i) made.pieces.push_back(made.pieces[static_cast<std::size_t>(i)]);
  return made;
}

TEST(CapsuleTree, FindsWhatBruteForceFinds) {
  math::Random random(31);
  const Tubes tubes = MakeTubes(random, 7, 33);
  for (const auto level : {base::SimdLevel::kBaseline, base::SimdLevel::kAvx2, base::SimdLevel::kAvx512}) {
    if (!base::HasSimdLevel(level)) continue;
    const auto tree = CapsuleTree::Make(tubes.points, tubes.pieces, level);
    ASSERT_TRUE(tree.ok());
    int inside = 0;
    for (int trial = 0; trial < 600; ++trial) {
      // near an axis, so that many lie inside of several pieces
      const Vec3 start = tubes.points[random.NextWord() % tubes.points.size()] +
                         RandomPoint(random, trial % 3 == 0 ? 0.05 : 0.003);
      const Vec3 end = trial % 2 == 0 ? start : start + RandomPoint(random, 0.1);
      const double limit = trial % 5 == 0 ? 0.002 : std::numeric_limits<double>::infinity();
      const NearestPiece oracle = FindNearestPieceBruteForce(tubes.points, tubes.pieces, {start, end}, limit);
      const NearestPiece found = tree->FindNearest(tubes.points, {start, end}, limit);
      ASSERT_EQ(found.piece, oracle.piece) << trial;
      EXPECT_EQ(found.distance, oracle.distance);
      EXPECT_EQ(found.axes.on_b, oracle.axes.on_b);
      inside += found.Found() && found.distance < 0.0;
    }
    EXPECT_GT(inside, 50);
  }
}

TEST(CapsuleTree, FindsEveryPieceThatTouchesACapsuleAlsoAfterMoving) {
  math::Random random(32);
  Tubes tubes = MakeTubes(random, 5, 40);
  auto tree = CapsuleTree::Make(tubes.points, tubes.pieces);
  ASSERT_TRUE(tree.ok());
  for (int tick = 0; tick < 20; ++tick) {
    for (Vec3& p : tubes.points) p += RandomPoint(random, 0.004);
    tree->Update(tubes.points);
    const Capsule tool{{RandomPoint(random, 0.1), RandomPoint(random, 0.1)}, 0.01};
    std::vector<std::uint32_t> oracle, found(tubes.pieces.size());
    for (std::uint32_t i = 0; i < tubes.pieces.size(); ++i) {
      const TubePiece& piece = tubes.pieces[i];
      const CapsuleGap gap =
          FindCapsuleGap(tool, {{tubes.points[piece.a], tubes.points[piece.b]}, piece.radius});
      if (gap.distance <= 0.0) oracle.push_back(i);
    }
    found.resize(tree->FindWithin(tubes.points, tool, found));
    EXPECT_EQ(found, oracle) << tick;
  }
}

TEST(CapsuleTree, RefusesBadPieces) {
  const std::vector<Vec3> points{{0, 0, 0}, {0.01, 0, 0}};
  const auto code = [&](const TubePiece& piece) {
    const std::vector<TubePiece> pieces{piece};
    const auto made = CapsuleTree::Make(points, pieces);
    return made.ok() ? base::ErrorCode{} : made.error().code;
  };
  EXPECT_EQ(code({0, 2, 0.001}), base::ErrorCode::kMeshInvalid);
  EXPECT_EQ(code({0, 1, -0.001}), base::ErrorCode::kMeshInvalid);
  EXPECT_EQ(code({0, 1, std::numeric_limits<double>::quiet_NaN()}), base::ErrorCode::kMeshInvalid);
  const auto none = CapsuleTree::Make(points, {});
  ASSERT_TRUE(none.ok());
  EXPECT_FALSE(none->FindNearest(points, {{0, 0, 0}, {0, 0, 0}}).Found());
}

// Analytic: crossing, parallel, end to end, one inside of the other.
TEST(FindCapsuleGap, MeasuresKnownPairs) {
  const Capsule along_x{{{0, 0, 0}, {0.1, 0, 0}}, 0.0025};
  const CapsuleGap crossing = FindCapsuleGap(along_x, {{{0.05, -0.1, 0.02}, {0.05, 0.1, 0.02}}, 0.0025});
  EXPECT_NEAR(crossing.distance, 0.015, 1e-15);
  EXPECT_NEAR(crossing.normal.z, 1.0, 1e-15);
  EXPECT_NEAR(FindCapsuleGap(along_x, {{{0.02, 0.01, 0}, {0.3, 0.01, 0}}, 0.001}).distance, 0.0065, 1e-15);
  EXPECT_NEAR(FindCapsuleGap(along_x, {{{0.2, 0, 0}, {0.3, 0, 0}}, 0.0}).distance, 0.0975, 1e-15);
  EXPECT_NEAR(FindCapsuleGap(along_x, {{{0.05, 0, 0}, {0.06, 0, 0}}, 0.001}).distance, -0.0035, 1e-15);
}

// Oracle of another kind: a dense search over both parameters.
TEST(FindNearestSegmentSegment, AgreesWithADenseSearch) {
  math::Random random(33);
  for (int trial = 0; trial < 200; ++trial) {
    const Segment a{RandomPoint(random, 0.1), RandomPoint(random, 0.1)};
    Segment b{RandomPoint(random, 0.1), RandomPoint(random, 0.1)};
    if (trial % 4 == 1) b.end = b.start + 0.7 * (a.end - a.start) + RandomPoint(random, 1e-10);
    if (trial % 4 == 2) b.end = b.start;
    const SegmentSegmentPoints found = FindNearestSegmentSegment(a, b);
    double best = 1e9;
    constexpr int kSteps = 200;
    for (int i = 0; i <= kSteps; ++i) {
      const Vec3 p = math::Lerp(a.start, a.end, double(i) / kSteps);
      for (int j = 0; j <= kSteps; ++j) {
        best = std::min(best, math::Distance(p, math::Lerp(b.start, b.end, double(j) / kSteps)));
      }
    }
    const double distance = std::sqrt(found.squared_distance);
    EXPECT_LE(distance, best + 1e-12) << trial;
    EXPECT_GE(distance, best - 0.4 / kSteps) << trial;
    EXPECT_NEAR(distance, math::Distance(found.on_a, found.on_b), 1e-15);
  }
}

}  // namespace
}  // namespace trocar::collision
