// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/contour_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "phantom_picture.h"

namespace trocar::contours {

using math::Vec2;

namespace {

constexpr double kRadius = 45.0;
const Vec2 kCentre{80, 80};

double DistanceToCircle(const Vec2& p) {
  return Norm(p - kCentre) - kRadius;
}

images::ColorImage MakeDisc() {
  return DrawPhantom({}, [](double x, double y) { return DistanceToCircle({x, y}); });
}

TEST(FitContourToEdges, BringsNoisyClicksToACircle) {
  const images::ColorImage image = MakeDisc();
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    math::Random random(seed);
    auto clicked = MakePolar(kCentre, 10, [](double) { return kRadius; });
    for (Vec2& p : clicked) {
      const double angle = random.Uniform(0, 2 * M_PI);
      p = p + 5.0 * Vec2{std::cos(angle), std::sin(angle)};
    }
    const ContourFit fit = FitContourToEdges(image, clicked, {.adaption = {.max_shift_px = 8}});
    ASSERT_EQ(fit.adapted.size(), clicked.size());
    double mean = 0;
    for (const Vec2& p : fit.adapted) {
      EXPECT_NEAR(DistanceToCircle(p), 0.0, 1.0) << "seed " << seed;
      mean += std::fabs(DistanceToCircle(p)) / static_cast<double>(fit.adapted.size());
    }
    EXPECT_LT(mean, 0.35) << "seed " << seed;
    for (const Vec2& p : fit.spline) EXPECT_NEAR(DistanceToCircle(p), 0.0, 1.5) << "seed " << seed;
    EXPECT_TRUE(fit.notes.empty()) << "seed " << seed;
  }
}

// Clicks that overtake each other along a small outline once made the curve go round twice, and an area that is
// enclosed twice is empty.
TEST(FitContourToEdges, GoesRoundOnceWhereClicksOvertakeEachOther) {
  const double a = 9, b = 18;  // pixels
  const auto radius = [&](double angle) {
    return a * b / std::hypot(b * std::cos(angle), a * std::sin(angle));
  };
  const images::ColorImage image = DrawPhantom({}, [&](double x, double y) {
    const Vec2 away = Vec2{x, y} - kCentre;
    return Norm(away) - radius(std::atan2(away.y, away.x));
  });
  const EdgeField field(image, 0.6);
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    math::Random random(seed);
    std::vector<Vec2> clicked;
    do {
      clicked = MakePolar(kCentre, 11, radius);
      for (Vec2& p : clicked) {
        const double angle = random.Uniform(0, 2 * M_PI);
        p = p + 3.75 * Vec2{std::cos(angle), std::sin(angle)};
      }
    } while (CrossesItself(clicked));
    const ContourFit fit = FitContourToEdges(field, clicked, {.adaption = {.max_shift_px = 6}});
    double length = 0;
    for (std::size_t i = 0; i < fit.spline.size(); ++i)
      length += Norm(fit.spline[(i + 1) % fit.spline.size()] - fit.spline[i]);
    EXPECT_LT(length, 1.5 * 2 * M_PI * std::sqrt(0.5 * (a * a + b * b))) << "seed " << seed;
  }
}

// Blurred, the two borders of a line that is thinner than the blur push each other apart.
TEST(FitContourToEdges, IsNotPushedInwardsByAThinLineAroundTheOrgan) {
  const double softness = 0.7, line = 1.5;  // pixels
  images::ColorImage image{160, 160, std::vector<std::uint8_t>(160 * 160 * 3)};
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 160; ++x) {
      const double away = Norm(Vec2{static_cast<double>(x), static_cast<double>(y)} - kCentre) - kRadius;
      const auto step = [&](double at) {
        return 0.5 * (1 + std::erf((away - at) / (softness * std::sqrt(2.0))));
      };
      const double inside[3] = {100, 96, 45}, sheet[3] = {220, 190, 150}, outside[3] = {110, 56, 40};
      for (int c = 0; c < 3; ++c) {
        const double value =
            inside[c] + (sheet[c] - inside[c]) * step(0) + (outside[c] - sheet[c]) * step(line);
        image.At(x, y)[c] = static_cast<std::uint8_t>(std::lround(value));
      }
    }
  }
  const auto clicked = MakePolar(kCentre, 12, [](double) { return kRadius; });
  const auto mean = [&](const ContourFit& fit) {
    double sum = 0;
    for (const Vec2& p : fit.spline) sum += DistanceToCircle(p) / static_cast<double>(fit.spline.size());
    return sum;
  };
  // in the blurred picture the steepest place lies two thirds of a pixel inside; what is left is the lens's
  const ContourFit fit = FitContourToEdges(image, clicked, {.adaption = {.max_shift_px = 4, .blur_px = 1.0}});
  EXPECT_GT(mean(fit), -0.4);
  EXPECT_LT(mean(fit), 0.1);
}

TEST(FitContourToEdges, InsertsPointsWhereTheSplineLeavesTheEdge) {
  // a star of three lobes clicked at too few places
  const auto radius = [](double angle) { return 45.0 + 5.0 * std::cos(6 * angle); };
  const images::ColorImage image = DrawPhantom({}, [&](double x, double y) {
    const Vec2 away = Vec2{x, y} - kCentre;
    return (Norm(away) - radius(std::atan2(away.y, away.x))) * 0.85;
  });
  const auto clicked = MakePolar(kCentre, 6, radius);
  const auto error = [&](const ContourFit& fit) {
    double sum = 0;
    for (const Vec2& p : fit.spline) {
      const Vec2 away = p - kCentre;
      sum += std::fabs(Norm(away) - radius(std::atan2(away.y, away.x)));
    }
    return sum / static_cast<double>(fit.spline.size());
  };
  const ContourFitSettings settings = {.adaption = {.max_shift_px = 14}};
  ContourFitSettings plain = settings;
  plain.adaption.inserts_points = false;
  const ContourFit without = FitContourToEdges(image, clicked, plain);
  const ContourFit with = FitContourToEdges(image, clicked, settings);
  EXPECT_TRUE(without.inserted.empty());
  EXPECT_GE(with.inserted.size(), 6u);
  EXPECT_GT(error(without), 3.0);
  EXPECT_LT(error(with), 0.7);
}

// a dark lumen of radius kRadius - kWall in a pale wall, liver around it
constexpr double kWall = 7.0;

images::ColorImage MakeHollowOrgan(std::uint64_t seed) {
  images::ColorImage image =
      DrawPhantom({.inside = {72, 78, 34}, .outside = {178, 138, 108}, .seed = seed}, [](double x, double y) {
        return DistanceToCircle({x, y}) + kWall;
      });
  const images::ColorImage liver =
      DrawPhantom({.inside = {112, 52, 40}, .outside = {112, 52, 40}, .seed = seed + 100},
                  [](double, double) { return 1.0; });
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const auto away = DistanceToCircle({static_cast<double>(x), static_cast<double>(y)});
      const double share = std::clamp(0.5 + away / 2.0, 0.0, 1.0);
      for (int c = 0; c < 3; ++c) {
        image.At(x, y)[c] = static_cast<std::uint8_t>(
            std::lround((1 - share) * image.At(x, y)[c] + share * liver.At(x, y)[c]));
      }
    }
  }
  return image;
}

/// Mean signed distance of the fitted curve from the outer border [pixels].
double FitHollowOrgan(double clicked_radius, std::uint64_t seed) {
  math::Random random(seed);
  auto clicked = MakePolar(kCentre, 12, [&](double) { return clicked_radius; });
  for (std::size_t i = 0; i < clicked.size(); ++i) {
    // to either side in turn, so that the clicks say which border they mean
    const double slip = (i % 2 == 0 ? 1.0 : -1.0) * random.Uniform(0.5, 3.0);
    clicked[i] = clicked[i] + (slip / Norm(clicked[i] - kCentre)) * (clicked[i] - kCentre);
  }
  const ContourFit fit = FitContourToEdges(MakeHollowOrgan(seed), clicked, {.adaption = {.max_shift_px = 9}});
  double sum = 0;
  for (const Vec2& p : fit.spline) sum += DistanceToCircle(p);
  return sum / static_cast<double>(fit.spline.size());
}

TEST(FitContourToEdges, TakesTheBorderOfAWallThatTheClicksMean) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EXPECT_NEAR(FitHollowOrgan(kRadius, seed), 0.0, 0.5) << "outer, seed " << seed;
    EXPECT_NEAR(FitHollowOrgan(kRadius - kWall, seed), -kWall, 0.5) << "lumen, seed " << seed;
  }
}

TEST(FitContourToEdges, SaysWhereThereIsNoEdge) {
  images::ColorImage image = MakeDisc();
  for (int y = 0; y < image.height; ++y) {
    for (int x = 85; x < image.width; ++x) std::copy_n(image.At(80, 80), 3, image.At(x, y));
  }
  const auto clicked = MakePolar(kCentre, 16, [](double) { return kRadius; });
  const ContourFit fit = FitContourToEdges(image, clicked);
  ASSERT_EQ(fit.notes.size(), 1u);
  EXPECT_EQ(fit.notes[0].problem, FitProblem::kNoEdge);
  EXPECT_GT(fit.notes[0].at.x, 115.0);
  EXPECT_NEAR(fit.notes[0].length_px, M_PI * kRadius, 25.0);
}

TEST(FitContourToEdges, SaysThatClicksCross) {
  const std::vector<Vec2> eight = {{40, 40}, {120, 120}, {120, 40}, {40, 120}};
  const ContourFit fit = FitContourToEdges(MakeDisc(), eight);
  ASSERT_EQ(fit.notes.size(), 1u);
  EXPECT_EQ(fit.notes[0].problem, FitProblem::kCrossesItself);
  EXPECT_EQ(fit.adapted, eight);
}

}  // namespace
}  // namespace trocar::contours
