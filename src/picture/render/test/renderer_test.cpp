// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/renderer.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "test_scene.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/primitives.h"
#include "trocar/geometry/tube.h"

namespace trocar::render {
namespace {

using geometry::MakeSphere;
using math::Pose;
using math::Vec3;

constexpr double kDistance = 0.10, kRadius = 0.02;

class RendererTest : public DrawingTest {
 protected:
  /// Mean column and row, and number, of the pixels that are not black.
  struct Blob {
    double x = 0, y = 0;
    int count = 0;
  };
  static Blob FindBlob(const Image& image) {
    Blob blob;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        if (Brightness(image, x, y) == 0) continue;
        blob.x += x;
        blob.y += y;
        ++blob.count;
      }
    }
    if (blob.count > 0) blob.x /= blob.count, blob.y /= blob.count;
    return blob;
  }

  SurfaceId AddBall(Material material = Material::kLiver) {
    return renderer_->AddSurface(MakeSphere({0, 0, 0}, kRadius, 5), material);
  }
};

// Analytic: a ball on the axis shows a disc of radius f tan(asin(R / d)), f from the field of view.
TEST_F(RendererTest, BallHasItsProjectedRadius) {
  Frame frame = PlainFrame();
  frame.surfaces = {{AddBall(), {{}, {0, 0, -kDistance}}}};
  const Image image = Draw(frame);
  const double focal = 0.5 * kMaskDiameter * kHeight / std::tan(0.5 * frame.camera.field_of_view);
  const double expected = focal * std::tan(std::asin(kRadius / kDistance));
  const Blob blob = FindBlob(image);
  EXPECT_NEAR(std::sqrt(blob.count / M_PI), expected, 0.5);
  EXPECT_NEAR(blob.x, 0.5 * kWidth - 0.5, 0.5);
  EXPECT_NEAR(blob.y, 0.5 * kHeight - 0.5, 0.5);
}

TEST_F(RendererTest, BallIsBrightestWhereItFacesTheHeadLight) {
  Frame frame = PlainFrame();
  frame.surfaces = {{AddBall(Material::kSleeve), {{}, {0, 0, -kDistance}}}};
  const Image image = Draw(frame);
  const double focal = 0.5 * kMaskDiameter * kHeight / std::tan(0.5 * frame.camera.field_of_view);
  const double radius = focal * std::tan(std::asin(kRadius / kDistance));
  int best_x = 0, best_y = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (Brightness(image, x, y) > Brightness(image, best_x, best_y)) best_x = x, best_y = y;
    }
  }
  EXPECT_LT(std::hypot(best_x - 0.5 * kWidth, best_y - 0.5 * kHeight), 0.3 * radius);
  EXPECT_GT(Brightness(image, kWidth / 2, kHeight / 2),
            2 * Brightness(image, kWidth / 2 + static_cast<int>(0.9 * radius), kHeight / 2));
}

// The light falls with the square of the distance.
TEST_F(RendererTest, FartherIsDarker) {
  const SurfaceId plate =
      renderer_->AddSurface(geometry::MakeBox({-0.5, -0.5, -0.001}, {0.5, 0.5, 0}), Material::kBowel);
  int before = 3 * 255 + 1;
  for (const double distance : {0.05, 0.10, 0.20, 0.40}) {
    Frame frame = PlainFrame();
    frame.surfaces = {{plate, {{}, {0, 0, -distance}}}};
    const Image image = Draw(frame);
    const int now = Brightness(image, kWidth / 2 + 20, kHeight / 2);
    EXPECT_LT(now, before) << distance;
    before = now;
  }
  EXPECT_GT(before, 0);
}

TEST_F(RendererTest, LightDoesNotBurnOutTissueNearTheLens) {
  const SurfaceId plate =
      renderer_->AddSurface(geometry::MakeBox({-0.5, -0.5, -0.001}, {0.5, 0.5, 0}), Material::kLiver);
  Frame frame = PlainFrame();
  // tilted, so that no highlight meets the lens
  frame.surfaces = {{plate, {math::RotationAbout({1, 0, 0}, 0.7), {0, 0, -0.05}}}};
  const Image image = Draw(frame);
  const auto [r, g, b] = image.At(kWidth / 2, kHeight / 2);
  EXPECT_GT(r, 40);
  EXPECT_LT(r, 250);
  EXPECT_GT(r, g + 20);
}

// A highlight of smooth tissue near the lens would be one white patch.
TEST_F(RendererTest, AHighlightOnTissueNearTheLensIsBroadAndALittleBrokenByItsGrain) {
  const auto measure = [this](const Looks& looks) {
    auto renderer = Renderer::Make(looks);
    EXPECT_TRUE(renderer.ok());
    Frame frame = PlainFrame();
    frame.surfaces = {
        {renderer->AddSurface(MakeSphere({0, 0, 0}, 0.03, 5), Material::kLiver), {{}, {0, 0, -0.08}}}};
    target_->Bind();
    renderer->Draw(frame, kWidth, kHeight);
    Image image;
    target_->Read(image);
    // pixels at the edge of white for each that is white: 4 pi / perimeter is small for one round patch
    int white = 0, edge = 0;
    const auto is_white = [&](int x, int y) { return Brightness(image, x, y) > 560; };
    for (int y = 1; y + 1 < kHeight; ++y) {
      for (int x = 1; x + 1 < kWidth; ++x) {
        if (!is_white(x, y)) continue;
        ++white;
        edge += is_white(x + 1, y) && is_white(x - 1, y) && is_white(x, y + 1) && is_white(x, y - 1) ? 0 : 1;
      }
    }
    return std::array<int, 2>{white, edge};
  };
  const auto looks = ReadLooks(std::filesystem::path(TROCAR_SOURCE_DIR) / kLooksFile);
  ASSERT_TRUE(looks.ok());
  const auto [white, edge] = measure(*looks);
  EXPECT_GT(white, 20);
  EXPECT_GT(edge, 0.2 * white);
  EXPECT_LT(edge, 0.4 * white) << "like spilled salt";
  // negative control: without grain it is a patch
  Looks smooth = *looks;
  smooth.materials[static_cast<std::size_t>(Material::kLiver)].bump = 0;
  const auto [patch, rim] = measure(smooth);
  EXPECT_GT(patch, 20);
  EXPECT_LT(static_cast<double>(rim) / patch, 0.8 * edge / white);
}

TEST_F(RendererTest, AnInsulatedShaftIsGreyAndWorn) {
  const SurfaceId shaft = renderer_->AddSurface(
      geometry::MakeTube({{{0, 0, 0}, {0, 0, 0.2}}, {0.005, 0.005}}, 24), Material::kShaft);
  Frame frame = PlainFrame();
  // across the picture
  frame.surfaces = {{shaft, {math::RotationAbout({0, 1, 0}, 0.5 * M_PI), {-0.1, 0, -0.03}}}};
  frame.exposure = 2;
  const Image image = Draw(frame);
  double colour = 0, rough = 0, all = 0;
  for (int x = 20; x + 20 < kWidth; ++x) {
    for (int y = kHeight / 2 - 12; y <= kHeight / 2 + 12; ++y) {
      const auto [r, g, b] = image.At(x, y);
      all += r + g + b;
      colour += std::max({r, g, b}) - std::min({r, g, b});
      rough += std::abs(Brightness(image, x, y) - Brightness(image, x + 8, y));
    }
  }
  ASSERT_GT(all, 0);
  EXPECT_LT(3 * colour, 0.15 * all) << "it does not mirror the red of tissue";
  EXPECT_GT(rough, 0.015 * all) << "scratches and wear along it";
}

TEST_F(RendererTest, PoseMovesThePictureToTheCalculatedPixel) {
  const SurfaceId ball = renderer_->AddSurface(MakeSphere({0, 0, 0}, 0.004, 4), Material::kFat);
  for (const Vec3& p : {Vec3{0.02, 0, -0.1}, Vec3{-0.03, 0.02, -0.12}, Vec3{0.0, -0.015, -0.08}}) {
    Frame frame = PlainFrame();
    // any camera: the picture depends on relative poses only
    frame.camera.X_world_camera = {math::Normalized({0.9, 0.1, -0.3, 0.2}), {0.01, 0.2, -0.05}};
    const Vec3 p_world = frame.camera.X_world_camera * p;
    frame.surfaces = {{ball, {{}, p_world}}};
    const Blob blob = FindBlob(Draw(frame));
    const math::Vec2 pixel = CalcPixel(frame.camera, p_world, kWidth, kHeight);
    EXPECT_NEAR(blob.x, pixel.x, 0.7);
    EXPECT_NEAR(blob.y, pixel.y, 0.7);
  }
  EXPECT_FALSE(std::isfinite(CalcPixel(Camera{}, {0, 0, 0.1}, kWidth, kHeight).x));
}

TEST_F(RendererTest, MaskBlacksWhatLiesOutsideTheCircle) {
  // inside a big ball, so that every pixel shows something
  geometry::TriangleMesh room = MakeSphere({0, 0, 0}, 0.15, 4);
  for (auto& t : room.triangles) std::swap(t[1], t[2]);
  Frame frame;
  frame.surfaces = {{renderer_->AddSurface(room, Material::kPeritoneum), {}}};
  for (const bool is_smooth : {false, true}) {
    frame.has_smooth_edges = is_smooth;
    frame.has_mask = true;
    const Image masked = Draw(frame);
    frame.has_mask = false;
    const Image whole = Draw(frame);
    const double radius = 0.5 * kMaskDiameter * kHeight;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double r = std::hypot(x + 0.5 - 0.5 * kWidth, y + 0.5 - 0.5 * kHeight);
        if (r > radius + 1.0) {
          ASSERT_EQ(Brightness(masked, x, y), 0) << x << " " << y;
        }
        if (r < radius - 4.0) {
          ASSERT_GT(Brightness(masked, x, y), 0) << x << " " << y;
        }
        ASSERT_GT(Brightness(whole, x, y), 0);
      }
    }
    // vignetting: darker at the rim than without mask
    EXPECT_LT(Brightness(masked, kWidth / 2 + static_cast<int>(0.95 * radius), kHeight / 2),
              Brightness(whole, kWidth / 2 + static_cast<int>(0.95 * radius), kHeight / 2));
  }
}

TEST_F(RendererTest, SameFrameGivesTheSamePixels) {
  Frame frame;
  frame.surfaces = {{AddBall(Material::kGallbladder), {{}, {0.01, 0, -kDistance}}}};
  frame.arrows = {{{0, 0, -0.08}, {0.02, 0.01, 0}}};
  const Image first = Draw(frame);
  EXPECT_EQ(first, Draw(frame));
  frame.surfaces[0].X_world_surface.translation.x = 0.012;
  EXPECT_NE(first, Draw(frame));
}

TEST_F(RendererTest, DeformingSurfaceIsDrawnWhereItIsNow) {
  const geometry::TriangleMesh rest = MakeSphere({0, 0, -kDistance}, 0.01, 4);
  const SurfaceId surface = renderer_->AddSurface(rest, Material::kGallbladder);
  Frame frame = PlainFrame();
  frame.surfaces = {{surface, {}}};
  const Blob before = FindBlob(Draw(frame));
  std::vector<Vec3> moved = rest.positions, normals(rest.positions.size());
  for (Vec3& p : moved) p = p + Vec3{0.02, 0, 0};
  geometry::CalcVertexNormals(moved, rest.triangles, normals);
  renderer_->UpdateSurface(surface, moved, normals);
  const Blob after = FindBlob(Draw(frame));
  const double focal = 0.5 * kMaskDiameter * kHeight / std::tan(0.5 * frame.camera.field_of_view);
  EXPECT_NEAR(after.x - before.x, focal * 0.02 / kDistance, 1.0);
}

TEST_F(RendererTest, UpdatedTrianglesReplaceTheOldOnes) {
  const geometry::TriangleMesh rest = MakeSphere({0, 0, -kDistance}, 0.01, 3);
  const SurfaceId surface = renderer_->AddSurface(rest, Material::kLiver);
  Frame frame = PlainFrame();
  frame.surfaces = {{surface, {}}};
  EXPECT_GT(FindBlob(Draw(frame)).count, 0);
  renderer_->UpdateTriangles(surface, {});
  EXPECT_EQ(FindBlob(Draw(frame)).count, 0);
}

// A square of two triangles, of which the coarse surface has one: half of it is gone where a picture is small.
TEST_F(RendererTest, SmallPicturesShowTheCoarseTriangles) {
  const std::vector<Vec3> corners = {
      {-0.02, -0.02, -0.1}, {0.02, -0.02, -0.1}, {0.02, 0.02, -0.1}, {-0.02, 0.02, -0.1}};
  const std::vector<geometry::Triangle> both = {{0, 1, 2}, {0, 2, 3}};
  Frame frame = PlainFrame();
  const auto find_share = [&](SurfaceId surface, int height) {
    frame.surfaces = {{surface, {}}};
    const int width = 16 * height / 9;
    auto target = OffscreenTarget::Make(width, height);
    EXPECT_TRUE(target.ok());
    target->Bind();
    renderer_->Draw(frame, width, height);
    Image image;
    target->Read(image);
    return FindBlob(image).count / static_cast<double>(width * height);
  };
  const SurfaceId plain = renderer_->AddSurface(both, corners, Material::kForce);
  const double whole = find_share(plain, kCoarseHeight);
  ASSERT_GT(whole, 0.03);
  const SurfaceId refined =
      renderer_->AddSurface(both, corners, Material::kForce, {}, std::span(both).first(1));
  EXPECT_NEAR(find_share(refined, kCoarseHeight), 0.5 * whole, 0.02 * whole);
  EXPECT_NEAR(find_share(refined, kCoarseHeight + 1), whole, 0.02 * whole);
  renderer_->UpdateTriangles(refined, both);
  EXPECT_NEAR(find_share(refined, kCoarseHeight), whole, 0.02 * whole);
}

TEST_F(RendererTest, RemovedSurfaceIsGoneAndItsIdNamesNothingNew) {
  const SurfaceId old_id = AddBall();
  Frame frame = PlainFrame();
  frame.surfaces = {{old_id, {{}, {0, 0, -kDistance}}}};
  renderer_->RemoveSurface(old_id);
  const SurfaceId new_id = AddBall();
  EXPECT_EQ(FindBlob(Draw(frame)).count, 0);
  frame.surfaces[0].surface = new_id;
  EXPECT_GT(FindBlob(Draw(frame)).count, 0);
}

TEST_F(RendererTest, NearerSurfaceHidesTheFarther) {
  Frame frame = PlainFrame();
  const SurfaceDraw near_ball{AddBall(Material::kLiver), {{}, {0, 0, -0.08}}};
  const SurfaceDraw far_ball{AddBall(Material::kFat), {{}, {0, 0, -0.14}}};
  frame.surfaces = {near_ball, far_ball};
  const Image one = Draw(frame);
  frame.surfaces = {far_ball, near_ball};
  EXPECT_EQ(one, Draw(frame));
  frame.surfaces = {near_ball};
  EXPECT_EQ(one, Draw(frame));
}

TEST_F(RendererTest, ToolShadesTheTissueNearIt) {
  const geometry::TriangleMesh plate = geometry::MakeGrid(60, 0.002);
  const SurfaceId surface = renderer_->AddSurface(plate, Material::kBowel);
  Frame frame = PlainFrame();
  frame.surfaces = {{surface, {{}, {-0.059, -0.059, -0.1}}}};
  const Image lit = Draw(frame);
  frame.shades = {{{-0.02, 0, -0.097}, {0.02, 0, -0.097}, 0.0025}};
  const Image shaded = Draw(frame);
  EXPECT_LT(Brightness(shaded, kWidth / 2, kHeight / 2), Brightness(lit, kWidth / 2, kHeight / 2));
  EXPECT_EQ(Brightness(shaded, kWidth / 2, 5), Brightness(lit, kWidth / 2, 5));
}

TEST_F(RendererTest, ClosedInPlacesAreDarker) {
  const geometry::TriangleMesh ball = MakeSphere({0, 0, -kDistance}, kRadius, 4);
  Frame frame = PlainFrame();
  const std::vector<double> closed(ball.positions.size(), 0.2);
  frame.surfaces = {{renderer_->AddSurface(ball, Material::kLiver, closed), {}}};
  const int dark = Brightness(Draw(frame), kWidth / 2, kHeight / 2);
  frame.surfaces = {{renderer_->AddSurface(ball, Material::kLiver), {}}};
  EXPECT_LT(dark, Brightness(Draw(frame), kWidth / 2, kHeight / 2));
}

/// A lamp in the lid, and nothing else, on a level board 100 mm away that is seen from straight above.
class BoxTrainerTest : public RendererTest {
 protected:
  static Frame LidFrame() {
    Frame frame = PlainFrame();
    frame.light_power = 0;
    frame.overhead = {{0, 0, 1}, 1};
    return frame;
  }
  SurfaceId AddBoard(Material material, std::span<const double> open = {}) {
    return renderer_->AddSurface(geometry::MakeGrid(60, 0.002), material, open);
  }
  static SurfaceDraw Place(SurfaceId board) { return {board, {{}, {-0.059, -0.059, -kDistance}}}; }
};

TEST_F(BoxTrainerTest, CornersAreDarker) {
  const std::vector<double> closed(geometry::MakeGrid(60, 0.002).positions.size(), 0.2);
  Frame frame = LidFrame();
  frame.surfaces = {Place(AddBoard(Material::kBoxWall, closed))};
  const int dark = Brightness(Draw(frame), kWidth / 2, kHeight / 2);
  frame.surfaces = {Place(AddBoard(Material::kBoxWall))};
  const int open = Brightness(Draw(frame), kWidth / 2, kHeight / 2);
  EXPECT_GT(dark, 0);
  EXPECT_LT(dark, 0.9 * open);
}

// The lamp stands straight above: what hangs over the board darkens what is under it, and no other place.
TEST_F(BoxTrainerTest, RodsAndRingsThrowShadowsStraightDown) {
  Frame frame = LidFrame();
  frame.surfaces = {Place(AddBoard(Material::kWhitePlastic))};
  const Image lit = Draw(frame);
  const auto at = [&](const Image& image, const Vec3& p_board) {
    const math::Vec2 pixel = CalcPixel(frame.camera, p_board, kWidth, kHeight);
    return Brightness(image, static_cast<int>(pixel.x), static_cast<int>(pixel.y));
  };
  const Vec3 middle{0, 0, -kDistance}, aside{0.03, 0, -kDistance};
  frame.shades = {{{-0.001, 0, -kDistance + 0.01}, {0.001, 0, -kDistance + 0.01}, 0.004}};
  const Image under_rod = Draw(frame);
  EXPECT_LT(at(under_rod, middle), at(lit, middle));
  EXPECT_EQ(at(under_rod, aside), at(lit, aside));
  frame.shades.clear();
  frame.ring_section = 0.002;
  frame.ring_shades = {{{0, 0, -kDistance + 0.006}, 0.015}};
  const Image under_ring = Draw(frame);
  EXPECT_EQ(at(under_ring, middle), at(lit, middle)) << "through its hole the light falls";
  EXPECT_LT(at(under_ring, {0.015, 0, -kDistance}), at(lit, {0.015, 0, -kDistance}));
}

// 10 mm apart, broader ones at every fifth; where they are finer than pixels they grey the board and make no pattern.
TEST_F(BoxTrainerTest, ABoardHasLinesAtItsTiles) {
  Frame frame = LidFrame();
  frame.surfaces = {Place(AddBoard(Material::kBoard))};
  const Image board = Draw(frame);
  const double focal = CalcFocalPixels(frame.camera, kHeight);
  // the grid's own origin lies 59 mm beside the middle: lines at 1 and 11 mm, the broad one at -9 mm
  const auto darkest_near = [&](double x) {
    int darkest = 3 * 255;
    for (int dx = -1; dx <= 1; ++dx)
      darkest = std::min(
          darkest,
          Brightness(board, static_cast<int>(0.5 * kWidth + x * focal / kDistance) + dx, kHeight / 2 + 5));
    return darkest;
  };
  const int between = darkest_near(0.006), fine = darkest_near(0.001), broad = darkest_near(-0.009);
  EXPECT_LT(fine, between - 10);
  EXPECT_LT(broad, fine);
  // from 0.9 m away a tile is little more than a pixel
  frame.surfaces = {{AddBoard(Material::kBoard), {{}, {-0.059, -0.059, -0.9}}}};
  const Image far = Draw(frame);
  int low = 3 * 255, high = 0;
  for (int x = -3; x <= 3; ++x) {
    low = std::min(low, Brightness(far, kWidth / 2 + x, kHeight / 2));
    high = std::max(high, Brightness(far, kWidth / 2 + x, kHeight / 2));
  }
  EXPECT_GT(low, 0);
  EXPECT_LT(high - low, 25);
}

TEST_F(RendererTest, ArrowPointsAlongItsSpan) {
  Frame frame = PlainFrame();
  frame.arrows = {{{0, 0, -kDistance}, {0.03, 0, 0}, 0.001}};
  const Blob right = FindBlob(Draw(frame));
  EXPECT_GT(right.count, 50);
  EXPECT_GT(right.x, 0.5 * kWidth + 10);
  frame.arrows = {{{0, 0, -kDistance}, {0, 0.03, 0}, 0.001}};
  EXPECT_LT(FindBlob(Draw(frame)).y, 0.5 * kHeight - 10);
  // nothing sensible to draw
  frame.arrows = {{{0, 0, -kDistance}, {0, 0, 0}, 0.001}, {{0, 0, -kDistance}, {NAN, 0, 0}, 0.001}};
  EXPECT_EQ(FindBlob(Draw(frame)).count, 0);
}

TEST_F(RendererTest, NoOrganHidesAnArrow) {
  Frame frame = PlainFrame();
  frame.arrows = {{{0, 0, -kDistance}, {0.005, 0, 0}, 0.001}};
  const Image bare = Draw(frame);
  frame.surfaces = {{AddBall(), {{}, {0, 0, -kDistance}}}};
  const Image inside = Draw(frame);
  const math::Vec2 pixel = CalcPixel(frame.camera, {0.002, 0, -kDistance}, kWidth, kHeight);
  const int x = static_cast<int>(std::lround(pixel.x)), y = static_cast<int>(std::lround(pixel.y));
  EXPECT_GT(Brightness(bare, x, y), 0);
  EXPECT_EQ(bare.At(x, y), inside.At(x, y));
}

TEST_F(RendererTest, WireframeShowsEdgesOnly) {
  Frame frame = PlainFrame();
  frame.surfaces = {
      {renderer_->AddSurface(MakeSphere({0, 0, -kDistance}, kRadius, 1), Material::kLiver), {}}};
  const int filled = FindBlob(Draw(frame)).count;
  frame.is_wireframe = true;
  const int edges = FindBlob(Draw(frame)).count;
  EXPECT_GT(edges, 0);
  EXPECT_LT(edges, filled / 2);
}

TEST_F(RendererTest, SmoothingSoftensTheStairsOfAnEdgeOnly) {
  Frame frame = PlainFrame();
  frame.surfaces = {{AddBall(Material::kSleeve), {{}, {0, 0, -kDistance}}}};
  const Image hard = Draw(frame);
  frame.has_smooth_edges = true;
  const Image soft = Draw(frame);
  EXPECT_EQ(hard.At(5, 5), soft.At(5, 5));
  EXPECT_NE(hard, soft);
  EXPECT_LT(CalcMeanDifference(hard, soft), 1.5);
}

/// A half of the picture, right of an edge through the middle that leans by so many pixels in one.
geometry::TriangleMesh MakeHalfPlane(double lean) {
  constexpr double kHalf = 0.1;  // m
  return {{{-kHalf * lean, -kHalf, 0}, {3 * kHalf, 0, 0}, {kHalf * lean, kHalf, 0}}, {{0, 1, 2}}};
}

// One that leans by a pixel in six has a step every six rows where it is not smoothed, and a blur of a pixel all round leaves half of it.
TEST_F(RendererTest, EdgesThatAreNearlyUprightHaveSmallSteps) {
  Frame frame = PlainFrame();
  frame.surfaces = {
      {renderer_->AddSurface(MakeHalfPlane(1.0 / 6.0), Material::kForce), {{}, {0, 0, -kDistance}}}};
  // how far the edge moves most from one row to the next, as light moves that is summed over a row [pixels]
  const auto find_step = [&] {
    const Image image = Draw(frame);
    double step = 0, before = 0;
    for (int y = kHeight / 2 - 18; y < kHeight / 2 + 18; ++y) {
      double light = 0;
      for (int x = kWidth / 2 - 12; x < kWidth / 2 + 12; ++x) light += Brightness(image, x, y);
      light /= Brightness(image, kWidth / 2 + 12, y);
      if (before > 0) step = std::max(step, std::abs(light - before));
      before = light;
    }
    return step;
  };
  EXPECT_GT(find_step(), 0.9);
  frame.has_smooth_edges = true;
  frame.quality = Quality::kLow;
  EXPECT_GT(find_step(), 0.5);
  frame.quality = Quality::kHigh;
  EXPECT_LT(find_step(), 0.4);
}

// A blur along an edge of 45 degrees mixes nothing with what lies beyond it: there the blur all round must be left.
TEST_F(RendererTest, SlantingEdgesAreAsSmoothAtEitherQuality) {
  Frame frame = PlainFrame();
  frame.surfaces = {{renderer_->AddSurface(MakeHalfPlane(1.0), Material::kForce), {{}, {0, 0, -kDistance}}}};
  // the greatest change from one pixel to the next, as a share of the whole
  const auto find_change = [&] {
    const Image image = Draw(frame);
    double change = 0;
    for (int y = kHeight / 2 - 18; y < kHeight / 2 + 18; ++y) {
      for (int x = kWidth / 2 - 30; x < kWidth / 2 + 30; ++x)
        change = std::max(
            change, std::abs(static_cast<double>(Brightness(image, x + 1, y) - Brightness(image, x, y))));
    }
    return change / Brightness(image, kWidth / 2 + 40, kHeight / 2);
  };
  const double hard = find_change();
  frame.has_smooth_edges = true;
  frame.quality = Quality::kLow;
  const double low = find_change();
  frame.quality = Quality::kHigh;
  EXPECT_LT(low, 0.8 * hard);
  EXPECT_LT(find_change(), 1.1 * low);
}

// With half the pixels along each side everything lies where it lay, and edges are as soft as that makes them.
TEST_F(RendererTest, FewerPixelsAreEnlargedToTheSamePicture) {
  Frame frame = PlainFrame();
  frame.surfaces = {{renderer_->AddSurface(MakeHalfPlane(0.05), Material::kForce), {{}, {0, 0, -kDistance}}}};
  frame.has_smooth_edges = true;
  frame.has_mask = true;
  const auto compare = [&](double resolution) {
    frame.resolution = 1;
    const Image fine = Draw(frame);
    frame.resolution = resolution;
    const Image coarse = Draw(frame);
    double all = 0;
    int sharper = 0;
    for (int y = 1; y < kHeight; ++y) {
      for (int x = 1; x < kWidth; ++x) {
        const double now = Brightness(coarse, x, y), before = Brightness(fine, x, y);
        all += std::abs(now - before);
        const bool is_middle = std::abs(x - kWidth / 2) < 30 && std::abs(y - kHeight / 2) < 18;
        sharper += is_middle && std::abs(now - Brightness(coarse, x - 1, y)) >
                                    0.75 * Brightness(fine, kWidth / 2 + 40, kHeight / 2);
      }
    }
    return std::pair{all / (kWidth * kHeight), sharper};
  };
  frame.quality = Quality::kLow;
  EXPECT_EQ(compare(1.0).first, 0);
  for (const bool is_smeared : {false, true}) {
    if (is_smeared) frame.blots = {{{0.1, 0.1}, 0.2, 0.8}};
    for (const Quality quality : {Quality::kLow, Quality::kHigh}) {
      frame.quality = quality;
      const auto [difference, sharper] = compare(0.5);
      EXPECT_GT(difference, 0.05) << "it was not drawn with fewer pixels";
      EXPECT_LT(difference, 4) << "of 765";
      EXPECT_EQ(sharper, 0);
    }
  }
  frame.resolution = 0;  // no fewer than the least
  EXPECT_GT(Brightness(Draw(frame), kWidth / 2 + 40, kHeight / 2), 50);
}

// As under GTK: its framebuffer is not 0, it leaves scissor and blending on, and wants no depth test back.
TEST_F(RendererTest, DrawsIntoTheBoundFramebufferWhateverStateTheToolkitLeft) {
  Frame frame;
  frame.surfaces = {{AddBall(), {{}, {0, 0, -kDistance}}}};
  const Image clean = Draw(frame);
  target_->Bind();
  GLint bound = 0, after = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
  glEnable(GL_SCISSOR_TEST);
  glScissor(0, 0, 3, 3);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ZERO, GL_ONE);
  glDepthMask(GL_FALSE);
  glColorMask(GL_FALSE, GL_TRUE, GL_FALSE, GL_TRUE);
  glDepthFunc(GL_NEVER);
  renderer_->Draw(frame, kWidth, kHeight);
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &after);
  EXPECT_EQ(bound, after);
  EXPECT_FALSE(glIsEnabled(GL_DEPTH_TEST));
  EXPECT_FALSE(glIsEnabled(GL_SCISSOR_TEST));
  EXPECT_FALSE(glIsEnabled(GL_CULL_FACE));
  EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
  Image image;
  target_->Read(image);
  EXPECT_EQ(clean, image);
}

TEST_F(RendererTest, DrawsNothingIntoNothing) {
  renderer_->Draw({}, 0, 0);
  EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST(Material, NamesRoundTrip) {
  for (int i = 0; i < static_cast<int>(Material::kCount); ++i) {
    const auto material = static_cast<Material>(i);
    EXPECT_EQ(FindMaterial(MaterialName(material)), material);
  }
  EXPECT_FALSE(FindMaterial("spleen").has_value());
}

}  // namespace
}  // namespace trocar::render
