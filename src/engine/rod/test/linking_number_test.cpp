// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "trocar/rod/rod.h"

namespace trocar::rod {
namespace {

using math::Vec3;

constexpr int kCorners = 60;

std::vector<Vec3> MakeRing(const Vec3& centre, bool is_upright) {
  std::vector<Vec3> ring;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2.0 * M_PI * i / kCorners;
    ring.push_back(centre + (is_upright ? Vec3{std::cos(angle), 0, std::sin(angle)}
                                        : Vec3{std::cos(angle), std::sin(angle), 0}));
  }
  return ring;
}

TEST(LinkingNumber, OfLinkedRingsIsOneWithItsSign) {
  const std::vector<Vec3> a = MakeRing({}, false);
  std::vector<Vec3> b = MakeRing({1, 0.01, 0.003}, true);
  const double linked = CalcLinkingNumber(a, b);
  EXPECT_NEAR(std::fabs(linked), 1.0, 1e-9);
  EXPECT_NEAR(CalcLinkingNumber(std::vector<Vec3>(a.rbegin(), a.rend()), b), -linked, 1e-9);
  EXPECT_NEAR(CalcLinkingNumber(b, a), linked, 1e-9);
  EXPECT_NEAR(CalcLinkingNumber(a, MakeRing({2.5, 0.01, 0.003}, true)), 0.0, 1e-9) << "beside each other";
}

TEST(LinkingNumber, OfATorusKnotsPairIsItsTurns) {
  // two strands on a torus that wind three times round each other
  std::vector<Vec3> a, b;
  for (int i = 0; i < 400; ++i) {
    const double u = 2.0 * M_PI * i / 400;
    for (auto* strand : {&a, &b}) {
      const double v = 3.0 * u + (strand == &a ? 0.0 : M_PI);
      const double r = 2.0 + 0.5 * std::cos(v);
      strand->push_back({r * std::cos(u), r * std::sin(u), 0.5 * std::sin(v)});
    }
  }
  EXPECT_NEAR(std::fabs(CalcLinkingNumber(a, b)), 3.0, 1e-9);
}

TEST(Writhe, OfAPlaneCurveIsNoneAndOfItsMirrorImageTheOpposite) {
  EXPECT_NEAR(CalcWrithe(MakeRing({}, false)), 0.0, 1e-12);
  std::vector<Vec3> eight, mirrored;
  for (int i = 0; i < 400; ++i) {
    const double u = 2.0 * M_PI * i / 400;
    eight.push_back({std::sin(u), std::sin(2.0 * u), 0.02 * std::cos(u)});
    mirrored.push_back({eight.back().x, eight.back().y, -eight.back().z});
  }
  // one crossing seen from nearly everywhere
  EXPECT_NEAR(std::fabs(CalcWrithe(eight)), 1.0, 0.05);
  EXPECT_NEAR(CalcWrithe(eight), -CalcWrithe(mirrored), 1e-9);
}

}  // namespace
}  // namespace trocar::rod
