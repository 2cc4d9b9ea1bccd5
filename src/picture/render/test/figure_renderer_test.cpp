// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/figure_renderer.h"

#include <gtest/gtest.h>

#include <optional>

#include "trocar/geometry/primitives.h"
#include "trocar/render/offscreen_context.h"
#include "trocar/render/offscreen_target.h"

namespace trocar::render {
namespace {

using math::Vec3;

constexpr int kWidth = 300, kHeight = 200;

class FigureDrawing : public testing::Test {
 protected:
  void SetUp() override {
    auto context = OffscreenContext::Make();
    ASSERT_TRUE(context.ok()) << context.error().Text();
    context_.emplace(std::move(*context));
    auto target = OffscreenTarget::Make(kWidth, kHeight);
    ASSERT_TRUE(target.ok()) << target.error().Text();
    target_.emplace(std::move(*target));
    auto renderer = FigureRenderer::Make();
    ASSERT_TRUE(renderer.ok()) << renderer.error().Text();
    renderer_.emplace(std::move(*renderer));
    options_.background = {0, 0, 0};
    options_.has_axes = false;
    camera_ = LookFrom(Viewpoint::kAnterior, {{-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}}, double(kWidth) / kHeight);
  }

  Image Draw(const std::vector<FigureSurface>& surfaces, const FigureMarks& marks = {}) {
    target_->Bind();
    renderer_->SetSurfaces(surfaces);
    renderer_->Draw(camera_, marks, options_, kWidth, kHeight);
    Image image;
    target_->Read(image);
    return image;
  }

  static FigureSurface MakeBall(const Vec3& centre, double radius, const SrgbColour& colour) {
    const auto mesh = geometry::MakeSphere(centre, radius, 3);
    return {mesh.triangles, mesh.positions, {colour}};
  }

  std::optional<OffscreenContext> context_;
  std::optional<OffscreenTarget> target_;
  std::optional<FigureRenderer> renderer_;
  FigureOptions options_;
  OrbitCamera camera_;
};

TEST_F(FigureDrawing, ColoursEachVertexAndFillsTheRightPixels) {
  auto ball = MakeBall({0, 0, 0}, 0.06, {1, 1, 1});
  ball.colours.clear();
  // the patient's left half red, the right half green
  for (const Vec3& p : ball.positions)
    ball.colours.push_back(p.x > 0 ? SrgbColour{1, 0, 0} : SrgbColour{0, 1, 0});
  const Image image = Draw({ball});
  std::size_t inside = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto hit = PickSurface(std::vector{ball}, CalcRay(camera_, x + 0.5, y + 0.5, kWidth, kHeight));
      const auto [r, g, b] = image.At(x, y);
      if (!hit) continue;
      ++inside;
      EXPECT_GT(int(r) + g, 40) << x << " " << y;
      if (x > kWidth / 2 + 8) {
        EXPECT_GT(r, g);
      }
      if (x < kWidth / 2 - 8) {
        EXPECT_GT(g, r);
      }
    }
  }
  EXPECT_GT(inside, 5000u);
  EXPECT_EQ(image.At(2, 2), (std::array<std::uint8_t, 3>{0, 0, 0}));
}

TEST_F(FigureDrawing, VeilLetsThroughWhatLiesBehind) {
  const auto red = MakeBall({0, 0, 0}, 0.02, {1, 0, 0});
  auto veil = MakeBall({0, 0, 0}, 0.07, {0, 0, 1});
  EXPECT_LT(Draw({red, veil}).At(kWidth / 2, kHeight / 2)[0], 40);
  veil.opacity = 0.3;
  const auto seen = Draw({veil, red}).At(kWidth / 2, kHeight / 2);
  EXPECT_GT(seen[0], 100);
  EXPECT_GT(seen[2], 30);
}

TEST_F(FigureDrawing, MarksAreHiddenUnlessOnTop) {
  const auto ball = MakeBall({0, 0, 0}, 0.05, {0, 0, 1});
  FigureMarks marks{{{{{-0.09, 0, -0.02}, {0.09, 0, -0.02}}, {1, 1, 1}, 3}},
                    {{{0, 0.04, -0.07}, {0, 1, 0}, 12}}};
  const Image hidden = Draw({ball}, marks);
  const int line_y = static_cast<int>(CalcPixel(camera_, {0, 0, -0.02}, kWidth, kHeight).y);
  const int outside_x = static_cast<int>(CalcPixel(camera_, {-0.08, 0, -0.02}, kWidth, kHeight).x);
  EXPECT_GT(hidden.At(outside_x, line_y)[0], 200);
  EXPECT_LT(hidden.At(kWidth / 2, line_y)[0], 100);
  marks.lines[0].is_on_top = marks.points[0].is_on_top = true;
  const Image on_top = Draw({ball}, marks);
  EXPECT_GT(on_top.At(kWidth / 2, line_y)[0], 200);
  const auto disc = CalcPixel(camera_, marks.points[0].position, kWidth, kHeight);
  EXPECT_GT(on_top.At(static_cast<int>(disc.x), static_cast<int>(disc.y))[1], 200);
  EXPECT_LT(on_top.At(static_cast<int>(disc.x) + 8, static_cast<int>(disc.y))[1], 100);
}

TEST_F(FigureDrawing, LineThatReachesBehindTheLensIsCut) {
  const FigureMarks marks{{{{{0, 0, -0.05}, {0, 0.3, 3}}, {1, 1, 1}, 3, true}}, {}};
  const Image image = Draw({}, marks);
  // it leaves the picture at the top and nowhere else
  bool is_at_top = false;
  for (int x = 0; x < kWidth; ++x) {
    is_at_top |= image.At(x, 0)[0] > 100;
    EXPECT_LT(image.At(x, kHeight - 1)[0], 50);
  }
  EXPECT_TRUE(is_at_top);
}

TEST_F(FigureDrawing, AxesStandInTheCornerAndTurnWithTheCamera) {
  options_.has_axes = true;
  const Image anterior = Draw({});
  Orbit(camera_, 60, 30, kHeight);
  const Image turned = Draw({});
  int lit = 0, changed = 0;
  for (int y = kHeight - 125; y < kHeight; ++y) {
    for (int x = 0; x < 125; ++x) {
      lit += anterior.At(x, y)[0] + anterior.At(x, y)[1] + anterior.At(x, y)[2] > 150;
      changed += anterior.At(x, y) != turned.At(x, y);
    }
  }
  EXPECT_GT(lit, 150);
  EXPECT_GT(changed, 100);
  EXPECT_EQ(anterior.At(200, 50), (std::array<std::uint8_t, 3>{0, 0, 0}));
}

TEST_F(FigureDrawing, SameFigureGivesTheSamePixelsAndNoFigureNone) {
  const auto ball = MakeBall({0, 0, 0}, 0.05, {0.4, 0.5, 0.6});
  const Image first = Draw({ball});
  const Image none = Draw({});
  EXPECT_EQ(first, Draw({ball}));
  EXPECT_EQ(none.At(kWidth / 2, kHeight / 2), (std::array<std::uint8_t, 3>{0, 0, 0}));
  target_->Bind();
  renderer_->Draw(camera_, {}, options_, 0, 10);  // nothing happens
}

}  // namespace
}  // namespace trocar::render
