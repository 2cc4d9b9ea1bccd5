// SPDX-License-Identifier: Apache-2.0
#include "trocar/view/laparoscope_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "trocar/geometry/primitives.h"
#include "trocar/render/offscreen_context.h"
#include "trocar/render/offscreen_target.h"

namespace trocar::view {
namespace {

using math::Vec3;
using render::Image;

constexpr int kWidth = 320, kHeight = 180;

/// A ball as gallbladder and a straight duct, seen from the origin along -z; both tools off to the sides.
class LaparoscopeViewTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto ball = geometry::MakeSphere({0, 0, -0.10}, 0.015, 3);
    snapshot_.positions = ball.positions;
    surfaces_.push_back({"gallbladder",
                         "gallbladder",
                         0,
                         static_cast<std::uint32_t>(ball.positions.size()),
                         ball.triangles,
                         {}});
    scene::SurfaceInfo duct{
        "cystic_duct", "duct", surfaces_[0].node_count, 8, {}, std::vector<double>(8, 0.002)};
    for (int i = 0; i < 8; ++i) snapshot_.positions.push_back({0.02 + 0.003 * i, -0.02, -0.10});
    surfaces_.push_back(duct);
    for (std::size_t hand = 0; hand < 2; ++hand) {
      scene_.instruments[hand].tool = *instrument::FindTool("grasper");
      scene_.instruments[hand].p_world_port = {hand == 0 ? -0.06 : 0.06, 0.06, -0.02};
      PlaceTip(hand, {hand == 0 ? -0.04 : 0.04, 0.03, -0.09});
    }
    auto context = render::OffscreenContext::Make();
    ASSERT_TRUE(context.ok()) << context.error().Text();
    context_.emplace(std::move(*context));
    auto target = render::OffscreenTarget::Make(kWidth, kHeight);
    ASSERT_TRUE(target.ok()) << target.error().Text();
    target_.emplace(std::move(*target));
    auto view = LaparoscopeView::Make(scene_, surfaces_, snapshot_);
    ASSERT_TRUE(view.ok()) << view.error().Text();
    view_.emplace(std::move(*view));
  }

  void PlaceTip(std::size_t hand, const Vec3& tip) {
    auto& now = snapshot_.instruments[hand];
    now.joints = instrument::FindJoints(scene_.instruments[hand].p_world_port, tip, 0, 0.5);
    now.X_world_tool = instrument::CalcToolPose(scene_.instruments[hand].p_world_port, now.joints);
  }

  Image Draw() {
    view_->Update(snapshot_);
    target_->Bind();
    view_->Draw(kWidth, kHeight);
    Image image;
    target_->Read(image);
    return image;
  }

  /// Share of pixels that differ within `reach` of where a point appears, and beyond.
  struct Change {
    int near = 0, far = 0;
  };
  Change CountChanges(const Image& a, const Image& b, const Vec3& p_world, double reach) {
    const auto pixel = render::CalcPixel(view_->GetFrame().camera, p_world, kWidth, kHeight);
    Change change;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (a.At(x, y) == b.At(x, y)) continue;
        (std::hypot(x - pixel.x, y - pixel.y) < reach ? change.near : change.far) += 1;
      }
    }
    return change;
  }

  scene::Scene scene_;
  simulation::Snapshot snapshot_;
  std::vector<scene::SurfaceInfo> surfaces_;
  std::optional<render::OffscreenContext> context_;
  std::optional<render::OffscreenTarget> target_;
  std::optional<LaparoscopeView> view_;
};

TEST_F(LaparoscopeViewTest, TheSameSnapshotGivesTheSamePixels) {
  EXPECT_EQ(Draw(), Draw());
}

TEST_F(LaparoscopeViewTest, ShowsNoVoidInsideTheCircle) {
  ViewOptions options;
  options.has_smooth_edges = false;
  view_->SetOptions(options);
  const Image image = Draw();
  const double radius = 0.5 * render::kMaskDiameter * kHeight;
  int lit = 0, all = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (std::hypot(x + 0.5 - 0.5 * kWidth, y + 0.5 - 0.5 * kHeight) > radius - 6) continue;
      const auto [r, g, b] = image.At(x, y);
      ++all;
      lit += r + g + b > 24;
    }
  }
  EXPECT_EQ(lit, all);
}

TEST_F(LaparoscopeViewTest, MovedNodesMoveTheOrganOnly) {
  ViewOptions options;
  options.has_background = false;
  options.quality = render::Quality::kLow;  // a highlight's glow reaches beyond what moves
  view_->SetOptions(options);
  const Image before = Draw();
  for (std::size_t i = 0; i < surfaces_[0].node_count; ++i) snapshot_.positions[i] += Vec3{0, 0.004, 0};
  const Change change = CountChanges(before, Draw(), {0, 0.002, -0.10}, 45);
  EXPECT_GT(change.near, 500);
  EXPECT_EQ(change.far, 0);
}

TEST_F(LaparoscopeViewTest, TheSkinOfADuctFollowsItsCentreLine) {
  ViewOptions options;
  options.has_background = false;
  options.quality = render::Quality::kLow;  // a highlight's glow reaches beyond what moves
  view_->SetOptions(options);
  const Image before = Draw();
  for (std::size_t i = surfaces_[1].first_node; i < snapshot_.positions.size(); ++i)
    snapshot_.positions[i] += Vec3{0, -0.008, 0};
  const Change change = CountChanges(before, Draw(), {0.03, -0.024, -0.10}, 30);
  EXPECT_GT(change.near, 50);
  EXPECT_EQ(change.far, 0);
}

TEST_F(LaparoscopeViewTest, AToolAppearsAtItsTip) {
  ViewOptions options;
  options.has_background = false;
  view_->SetOptions(options);
  PlaceTip(0, {-0.03, 0.02, -0.10});
  const Image before = Draw();
  snapshot_.instruments[0].joints.jaw = 1.0;
  const auto hinge = snapshot_.instruments[0].X_world_tool * instrument::JawHinge(scene_.instruments[0].tool);
  const Change change = CountChanges(before, Draw(), hinge, 60);
  EXPECT_GT(change.near, 20) << "the jaws did not open";
  EXPECT_EQ(change.far, 0);
}

TEST_F(LaparoscopeViewTest, ForceShowsAnArrowThatCanBeSwitchedOff) {
  EXPECT_TRUE(view_->GetFrame().arrows.empty());
  snapshot_.instruments[1].force = {0, 2, 0};
  view_->Update(snapshot_);
  ASSERT_EQ(view_->GetFrame().arrows.size(), 1u);
  const render::Arrow arrow = view_->GetFrame().arrows[0];
  // on the shaft, so that it does not hide what the tip works on
  const math::Pose& X_world_tool = snapshot_.instruments[1].X_world_tool;
  EXPECT_GT(math::Distance(arrow.p_world_tail, X_world_tool.translation), 0.02);
  const Vec3 p_tool_tail = math::Inverse(X_world_tool) * arrow.p_world_tail;
  EXPECT_LT(std::hypot(p_tool_tail.x, p_tool_tail.y), 1e-9);
  EXPECT_NEAR(arrow.span.y, 2 * ViewOptions{}.arrow_scale, 1e-12);
  ViewOptions options;
  options.has_force_arrows = false;
  view_->SetOptions(options);
  Draw();
  EXPECT_TRUE(view_->GetFrame().arrows.empty());
}

TEST_F(LaparoscopeViewTest, AStainBlursWhatLiesBehindItAndNoLabel) {
  ViewOptions options;
  options.has_automatic_exposure = false;
  options.quality = render::Quality::kLow;  // without glow, which carries light farther
  view_->SetOptions(options);
  const Image clean = Draw();
  render::GeometryPicture labels, stained_labels;
  ASSERT_TRUE(view_->DrawGeometry(kWidth, kHeight, labels).ok());
  options.stains = {{{0, 0}, 0.08, 0.5}};
  view_->SetOptions(options);
  const Image stained = Draw();
  ASSERT_TRUE(view_->DrawGeometry(kWidth, kHeight, stained_labels).ok());
  // the ball lies in the picture's middle
  const Change change = CountChanges(clean, stained, {0, 0, -0.10}, 0.08 * 1.5 * kHeight);
  EXPECT_GT(change.near, 50);
  EXPECT_EQ(change.far, 0);
  EXPECT_EQ(labels.labels, stained_labels.labels);
  options.stains.clear();
  view_->SetOptions(options);
  EXPECT_EQ(Draw(), clean);
}

TEST_F(LaparoscopeViewTest, WornToolsAreScratchedAndNothingElseChanges) {
  ViewOptions options;
  options.has_background = false;
  options.has_automatic_exposure = false;
  options.quality = render::Quality::kLow;
  PlaceTip(0, {0.01, -0.01, -0.08});  // its shaft comes through the picture's middle
  options.tool_wear = 0;
  view_->SetOptions(options);
  const Image fresh = Draw();
  options.tool_wear = 1.6;
  view_->SetOptions(options);
  const Image worn = Draw();
  EXPECT_NE(fresh, worn);
  render::GeometryPicture labels;
  ASSERT_TRUE(view_->DrawGeometry(kWidth, kHeight, labels).ok());
  const auto is_tool = [&](int x, int y) {
    return labels.labels[static_cast<std::size_t>(y * kWidth + x)] != 0;
  };
  for (int y = 1; y + 1 < kHeight; ++y) {
    for (int x = 1; x + 1 < kWidth; ++x) {
      if (fresh.At(x, y) == worn.At(x, y)) continue;
      // edges are smoothed with their neighbours
      bool is_near_tool = false;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) is_near_tool |= is_tool(x + dx, y + dy);
      }
      ASSERT_TRUE(is_near_tool) << x << " " << y;
    }
  }
}

TEST_F(LaparoscopeViewTest, CameraFollowsTheLaparoscope) {
  snapshot_.X_world_laparoscope = {math::RotationAbout({0, 1, 0}, 0.2), {0.01, 0, 0}};
  view_->Update(snapshot_);
  EXPECT_EQ(view_->GetFrame().camera.X_world_camera, snapshot_.X_world_laparoscope);
  EXPECT_EQ(view_->GetFrame().camera.field_of_view, scene_.laparoscope.field_of_view);
}

TEST_F(LaparoscopeViewTest, AnOrganOfWhichNothingIsKnownIsDrawn) {
  const Image known = Draw();
  surfaces_[0].name = surfaces_[0].look = "spleen";
  auto view = LaparoscopeView::Make(scene_, surfaces_, snapshot_);
  ASSERT_TRUE(view.ok()) << view.error().Text();
  view_.emplace(std::move(*view));
  EXPECT_GT(CountChanges(known, Draw(), {0, 0, -0.10}, 40).near, 500) << "there, covered with serosa";
}

// The lamp in the lid of a box trainer knows what hangs over the board: a bar is a rod along its longest edge.
TEST_F(LaparoscopeViewTest, ThingsThatMoveThrowShadowsInABox) {
  scene::SceneObject board, bar;
  board.colour = scene::ObjectColour::kGrey;
  board.body.shapes = {{rigid::RigidShape::Kind::kBox, {0.08, 0.06, 0.005}, {}}};
  board.body.X_world_body.translation = {0, 0, -0.15};
  bar.body.shapes = {{rigid::RigidShape::Kind::kBox, {0.004, 0.020, 0.006}, {}}};
  bar.body.mass = 0.003;
  scene_.objects = {board, bar};
  snapshot_.objects.resize(2);
  snapshot_.objects[0].X_world_object = board.body.X_world_body;
  snapshot_.objects[1].X_world_object = {math::RotationAbout({0, 0, 1}, M_PI / 2), {0.01, 0.02, -0.13}};
  auto view = LaparoscopeView::Make(scene_, surfaces_, snapshot_);
  ASSERT_TRUE(view.ok()) << view.error().Text();
  view_.emplace(std::move(*view));
  const render::Frame& frame = view_->GetFrame();
  ASSERT_EQ(frame.shades.size(), 3u) << "of two tools and the bar";
  const render::Shade& shade = frame.shades.back();
  EXPECT_NEAR(shade.radius, 0.005, 1e-12);
  EXPECT_NEAR(math::Distance(shade.a, shade.b), 2 * (0.020 - 0.005), 1e-12);
  EXPECT_NEAR(std::abs(shade.a.x - shade.b.x), 2 * (0.020 - 0.005), 1e-12) << "turned with it";
  EXPECT_NEAR(math::Distance(0.5 * (shade.a + shade.b), {0.01, 0.02, -0.13}), 0.0, 1e-12);
  EXPECT_GT(frame.overhead.power, 0.0);
}

TEST_F(LaparoscopeViewTest, UnknownMaterialIsNamed) {
  surfaces_[1].look = "granite";
  const auto view = LaparoscopeView::Make(scene_, surfaces_, snapshot_);
  ASSERT_FALSE(view.ok());
  EXPECT_EQ(view.error().code, base::ErrorCode::kUnknownName);
  EXPECT_NE(view.error().message.find("granite"), std::string::npos);
}

}  // namespace
}  // namespace trocar::view
