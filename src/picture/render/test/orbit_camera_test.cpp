// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/orbit_camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace trocar::render {
namespace {

using math::Vec2;
using math::Vec3;

constexpr int kWidth = 800, kHeight = 600;
const geometry::Box kBox{{-0.1, -0.2, -0.05}, {0.3, 0.1, 0.15}};

TEST(Viewpoint, NamesAreReadBack) {
  for (int i = 0; i < static_cast<int>(Viewpoint::kCount); ++i) {
    const auto viewpoint = static_cast<Viewpoint>(i);
    EXPECT_EQ(FindViewpoint(ViewpointName(viewpoint)), viewpoint);
  }
  EXPECT_FALSE(FindViewpoint("above").has_value());
}

// Where a step along the body's axes goes in the picture: x right, y down.
struct Look {
  Viewpoint from;
  Vec3 to_the_right, upwards;
};

TEST(LookFrom, HoldsTheBodyAsAnatomistsDo) {
  const Look looks[] = {
      {Viewpoint::kAnterior, {1, 0, 0}, {0, 1, 0}},  {Viewpoint::kPosterior, {-1, 0, 0}, {0, 1, 0}},
      {Viewpoint::kRight, {0, 0, 1}, {0, 1, 0}},     {Viewpoint::kLeft, {0, 0, -1}, {0, 1, 0}},
      {Viewpoint::kSuperior, {-1, 0, 0}, {0, 0, 1}}, {Viewpoint::kInferior, {1, 0, 0}, {0, 0, 1}}};
  for (const Look& look : looks) {
    SCOPED_TRACE(ViewpointName(look.from));
    const OrbitCamera camera = LookFrom(look.from, kBox, double(kWidth) / kHeight);
    const Vec2 middle = CalcPixel(camera, camera.target, kWidth, kHeight);
    EXPECT_NEAR(middle.x, kWidth / 2.0, 1e-9);
    EXPECT_NEAR(middle.y, kHeight / 2.0, 1e-9);
    const Vec2 right = CalcPixel(camera, camera.target + 0.01 * look.to_the_right, kWidth, kHeight);
    const Vec2 up = CalcPixel(camera, camera.target + 0.01 * look.upwards, kWidth, kHeight);
    EXPECT_GT(right.x, middle.x + 5);
    EXPECT_NEAR(right.y, middle.y, 1e-9);
    EXPECT_LT(up.y, middle.y - 5);
    EXPECT_NEAR(up.x, middle.x, 1e-9);
  }
}

TEST(LookFrom, ShowsTheWholeBoxAndNotMuchMore) {
  for (const double aspect : {0.5, 1.0, 2.0}) {
    for (int i = 0; i < static_cast<int>(Viewpoint::kCount); ++i) {
      const int width = static_cast<int>(kHeight * aspect);
      const OrbitCamera camera = LookFrom(static_cast<Viewpoint>(i), kBox, aspect);
      double reach = 0;
      for (int corner = 0; corner < 8; ++corner) {
        const Vec2 p = CalcPixel(camera,
                                 {corner & 1 ? kBox.max.x : kBox.min.x, corner & 2 ? kBox.max.y : kBox.min.y,
                                  corner & 4 ? kBox.max.z : kBox.min.z},
                                 width, kHeight);
        reach = std::max({reach, std::fabs(2 * p.x / width - 1), std::fabs(2 * p.y / kHeight - 1)});
      }
      EXPECT_LE(reach, 1.0) << i << " " << aspect;
      EXPECT_GE(reach, 0.9) << i << " " << aspect;
    }
  }
}

TEST(CalcRay, IsTheInverseOfCalcPixel) {
  OrbitCamera camera = LookFrom(Viewpoint::kUmbilicus, kBox, 4.0 / 3);
  Orbit(camera, 37, -61, kHeight);
  for (const Vec2 at : {Vec2{12, 500}, Vec2{400, 300}, Vec2{790, 4}}) {
    const Ray ray = CalcRay(camera, at.x, at.y, kWidth, kHeight);
    EXPECT_NEAR(Norm(ray.direction), 1, 1e-12);
    const Vec2 back = CalcPixel(camera, ray.origin + 0.3 * ray.direction, kWidth, kHeight);
    EXPECT_NEAR(back.x, at.x, 1e-9);
    EXPECT_NEAR(back.y, at.y, 1e-9);
  }
  const Ray ray = CalcRay(camera, 5, 5, kWidth, kHeight);
  EXPECT_FALSE(std::isfinite(CalcPixel(camera, ray.origin - 0.1 * ray.direction, kWidth, kHeight).x));
}

TEST(Orbit, KeepsTheTargetInTheMiddleAndTheHeadUp) {
  OrbitCamera camera = LookFrom(Viewpoint::kAnterior, kBox, 1);
  const OrbitCamera before = camera;
  Orbit(camera, kHeight / 2.0, 0, kHeight);  // a quarter turn to the right: the model's right side shows
  const Vec3 towards = math::Normalized(camera.Position() - camera.target);
  EXPECT_NEAR(towards.x, -1, 1e-9);
  EXPECT_EQ(camera.target, before.target);
  EXPECT_EQ(camera.distance, before.distance);
  const Vec2 middle = CalcPixel(camera, camera.target, kWidth, kHeight);
  const Vec2 head = CalcPixel(camera, camera.target + Vec3{0, 0.01, 0}, kWidth, kHeight);
  EXPECT_NEAR(head.x, middle.x, 1e-9);
  EXPECT_LT(head.y, middle.y);
  Orbit(camera, -kHeight / 2.0, 0, kHeight);
  EXPECT_NEAR(Distance(camera.Position(), before.Position()), 0, 1e-12);
}

TEST(Pan, MovesWhatLiesAtTheTargetWithThePointer) {
  OrbitCamera camera = LookFrom(Viewpoint::kLeft, kBox, 1);
  const Vec3 held = camera.target;
  Pan(camera, 50, -20, kHeight);
  const Vec2 now = CalcPixel(camera, held, kWidth, kHeight);
  EXPECT_NEAR(now.x, kWidth / 2.0 + 50, 1e-6);
  EXPECT_NEAR(now.y, kHeight / 2.0 - 20, 1e-6);
}

TEST(Zoom, ComesNearerAndStaysInItsLimits) {
  OrbitCamera camera;
  const double before = camera.distance;
  Zoom(camera, 1);
  EXPECT_LT(camera.distance, before);
  Zoom(camera, -1);
  EXPECT_NEAR(camera.distance, before, 1e-12);
  Zoom(camera, 1e4);
  EXPECT_DOUBLE_EQ(camera.distance, 1e-3);
  Zoom(camera, -1e4);
  EXPECT_DOUBLE_EQ(camera.distance, 100);
}

TEST(CalcPointAtDepth, StaysInThePlaneOfTheView) {
  OrbitCamera camera = LookFrom(Viewpoint::kUmbilicus, kBox, 1);
  const Vec3 grabbed = camera.target + Vec3{0.02, 0.01, -0.03};
  const Vec2 from = CalcPixel(camera, grabbed, kWidth, kHeight);
  EXPECT_NEAR(Distance(CalcPointAtDepth(camera, grabbed, from.x, from.y, kWidth, kHeight), grabbed), 0,
              1e-12);
  const Vec3 moved = CalcPointAtDepth(camera, grabbed, from.x + 30, from.y - 7, kWidth, kHeight);
  const Vec2 to = CalcPixel(camera, moved, kWidth, kHeight);
  EXPECT_NEAR(to.x, from.x + 30, 1e-9);
  EXPECT_NEAR(to.y, from.y - 7, 1e-9);
  EXPECT_NEAR(Dot(moved - grabbed, math::Rotate(camera.R_world_camera, {0, 0, 1})), 0, 1e-12);
}

}  // namespace
}  // namespace trocar::render
