// SPDX-License-Identifier: Apache-2.0
// What surgery changes is seen, and where it has changed nothing no pixel differs.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "trocar/geometry/primitives.h"
#include "trocar/math/random.h"
#include "trocar/render/offscreen_context.h"
#include "trocar/render/offscreen_target.h"
#include "trocar/view/labels.h"
#include "trocar/view/laparoscope_view.h"

namespace trocar::view {
namespace {

using math::Vec3;
using render::Image;

constexpr int kWidth = 320, kHeight = 180;
constexpr int kTrayTools = 7;
constexpr std::uint32_t kDuctNodes = 12;

/// A ball as gallbladder, a straight duct below it, strands between the two; both tools off to the sides.
class OperationViewTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto ball = geometry::MakeSphere({0, 0, -0.10}, 0.015, 3);
    now_.positions = ball.positions;
    ball_count_ = static_cast<std::uint32_t>(ball.positions.size());
    surfaces_.push_back({"gallbladder", "gallbladder", 0, ball_count_, ball.triangles, {}});
    surfaces_.push_back(
        {"cystic_duct", "duct", ball_count_, kDuctNodes, {}, std::vector<double>(kDuctNodes, 0.002)});
    for (std::uint32_t i = 0; i < kDuctNodes; ++i)
      now_.positions.push_back({-0.022 + 0.004 * i, -0.028, -0.095});
    now_.gravity = {0, -9.81, 0};
    for (std::size_t hand = 0; hand < 2; ++hand) {
      auto& setup = scene_.instruments[hand];
      for (const char* name :
           {"grasper", "maryland", "hook", "scissors", "clip_applier", "suction_irrigator", "bag"})
        setup.tray.push_back(*instrument::FindTool(name));
      setup.tool = setup.tray[0];
      setup.p_world_port = {hand == 0 ? -0.06 : 0.06, 0.06, -0.02};
      auto& tool = now_.instruments[hand];
      tool.joints =
          instrument::FindJoints(setup.p_world_port, {hand == 0 ? -0.04 : 0.04, 0.03, -0.09}, 0, 0.5);
      tool.X_world_tool = instrument::CalcToolPose(setup.p_world_port, tool.joints);
    }
    auto context = render::OffscreenContext::Make();
    ASSERT_TRUE(context.ok()) << context.error().Text();
    context_.emplace(std::move(*context));
    auto target = render::OffscreenTarget::Make(kWidth, kHeight);
    ASSERT_TRUE(target.ok()) << target.error().Text();
    target_.emplace(std::move(*target));
  }

  void MakeView(std::span<const scene::StrandInfo> strands = {}, bool has_background = false) {
    auto view = LaparoscopeView::Make(scene_, surfaces_, now_, strands);
    ASSERT_TRUE(view.ok()) << view.error().Text();
    view_.emplace(std::move(*view));
    ViewOptions options;
    options.has_background = has_background;
    options.has_smooth_edges = false;
    options.has_automatic_exposure = false;  // these tests compare brightness
    view_->SetOptions(options);
  }

  Image Draw() {
    view_->Update(now_);
    target_->Bind();
    view_->Draw(kWidth, kHeight);
    Image image;
    target_->Read(image);
    return image;
  }

  /// Pixels that differ within `reach` [m] of where a point appears, and beyond.
  struct Change {
    int near = 0, far = 0;
    std::array<double, 3> mean{};  // colour after, of the near ones
  };
  Change CountChanges(const Image& a, const Image& b, const Vec3& p_world, double reach) {
    const auto centre = render::CalcPixel(view_->GetFrame().camera, p_world, kWidth, kHeight);
    const auto edge =
        render::CalcPixel(view_->GetFrame().camera, p_world + Vec3{reach, 0, 0}, kWidth, kHeight);
    Change change;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (a.At(x, y) == b.At(x, y)) continue;
        if (std::hypot(x - centre.x, y - centre.y) > edge.x - centre.x + 1.5) {
          ++change.far;
          continue;
        }
        ++change.near;
        const auto colour = b.At(x, y);
        for (std::size_t i = 0; i < 3; ++i) change.mean[i] += colour[i];
      }
    }
    for (double& sum : change.mean) sum /= std::max(1, change.near);
    return change;
  }

  Vec3 DuctNode(std::uint32_t i) const { return now_.positions[ball_count_ + i]; }

  scene::Scene scene_;
  simulation::Snapshot now_;
  std::uint32_t ball_count_ = 0;
  std::vector<scene::SurfaceInfo> surfaces_;
  std::optional<render::OffscreenContext> context_;
  std::optional<render::OffscreenTarget> target_;
  std::optional<LaparoscopeView> view_;
};

TEST_F(OperationViewTest, TheToolInUseIsDrawnAndAnExchangeShowsAtOnce) {
  MakeView();
  std::vector<Image> pictures;
  for (std::uint8_t tool = 0; tool < kTrayTools; ++tool) {
    now_.operation.tools[1] = tool;
    pictures.push_back(Draw());
    for (std::uint8_t other = 0; other < tool; ++other)
      EXPECT_FALSE(pictures[other] == pictures[tool]) << int{tool};
  }
  now_.operation.tools[1] = 0;
  EXPECT_EQ(Draw(), pictures[0]);
  now_.operation.tools[1] = 200;  // a place that the tray does not have shows its last tool
  EXPECT_EQ(Draw(), pictures.back());
}

TEST_F(OperationViewTest, AClipIsSeenBetweenTheJawsWhileThereIsOne) {
  now_.operation.tools[1] = 4;
  MakeView();
  now_.operation.clips_left[1] = 0;
  const Image empty = Draw();
  now_.operation.clips_left[1] = 1;
  const Change change = CountChanges(empty, Draw(), now_.instruments[1].X_world_tool.translation, 0.016);
  EXPECT_GT(change.near, 6);
  EXPECT_EQ(change.far, 0);
}

TEST_F(OperationViewTest, AClipLiesWhereItIsAndPressesTheDuctFlat) {
  MakeView();
  const Image bare = Draw();
  surgery::ClipSnapshot clip;
  // legs along y, closing what runs along x
  clip.X_world_clip = {
      math::RotationAbout({0, 1, 0}, 0.5 * M_PI) * math::RotationAbout({0, 0, 1}, 0.5 * M_PI), DuctNode(6)};
  clip.gap = 0.0002;
  now_.operation.clips = {clip, {}, {}};
  now_.operation.clip_count = 1;
  const Image clipped = Draw();
  const Change change = CountChanges(bare, clipped, DuctNode(6), 0.013);
  EXPECT_GT(change.near, 40);
  EXPECT_EQ(change.far, 0);
  now_.operation.clips[0].gap = 0.004;
  EXPECT_GT(CountChanges(clipped, Draw(), DuctNode(6), 0.009).near, 10) << "an open clip looks otherwise";
  now_.operation.clip_count = 0;
  EXPECT_EQ(Draw(), bare) << "and leaves nothing behind";
}

TEST_F(OperationViewTest, StrandsAreSeenWhileTheyHold) {
  std::vector<scene::StrandInfo> strands;
  math::Random random(1);
  using Kind = scene::StrandInfo::Kind;
  for (const Kind kind : {Kind::kBed, Kind::kAdhesion, Kind::kTriangle, Kind::kPeritoneum}) {
    for (int i = 0; i < 25; ++i) {
      const auto row = static_cast<std::uint32_t>(now_.positions.size());
      now_.positions.push_back({random.Uniform(-0.01, 0.01), -0.012, -0.090});
      now_.positions.push_back({random.Uniform(-0.01, 0.01), -0.027, -0.092});
      strands.push_back({row, row + 1, kind});
    }
  }
  MakeView(strands);
  // drawn: what the bed's strands span is hidden under peritoneum at rest
  for (const scene::StrandInfo& strand : strands) now_.positions[strand.b].y -= 0.0025;
  now_.operation.strand_is_intact.assign(strands.size(), 0);
  const Image none = Draw();
  for (std::size_t kind = 0; kind < 4; ++kind) {
    std::fill(now_.operation.strand_is_intact.begin(), now_.operation.strand_is_intact.end(),
              std::uint8_t{0});
    for (std::size_t i = 0; i < 25; ++i) now_.operation.strand_is_intact[25 * kind + i] = 1;
    const Image some = Draw();
    const Change change = CountChanges(none, some, {0, -0.020, -0.091}, 0.020);
    EXPECT_GT(change.near, 60) << kind;
    EXPECT_EQ(change.far, 0) << kind;
    EXPECT_EQ(Draw(), some) << "the same snapshot, the same pixels";
    // one strand divided: it goes, and the others stay as they are
    now_.operation.strand_is_intact[25 * kind + 12] = 0;
    const int divided = CountChanges(some, Draw(), {0, -0.020, -0.091}, 0.020).near;
    EXPECT_GT(divided, 2) << kind;
    EXPECT_LT(divided, change.near / 3) << kind;
  }
}

TEST_F(OperationViewTest, HeatBlanchesAndThenChars) {
  MakeView();
  const Image raw = Draw();
  now_.operation.blanching.assign(now_.positions.size(), 0);
  now_.operation.charring.assign(now_.positions.size(), 0);
  EXPECT_EQ(Draw(), raw) << "no heat, no mark";
  const Vec3 spot{0, 0, -0.085};
  for (std::size_t i = 0; i < ball_count_; ++i)
    if (math::Distance(now_.positions[i], spot) < 0.007) now_.operation.blanching[i] = 1;
  const Image white = Draw();
  const Change blanched = CountChanges(raw, white, spot, 0.012);
  EXPECT_GT(blanched.near, 200);
  EXPECT_EQ(blanched.far, 0);
  now_.operation.charring = now_.operation.blanching;
  const Change charred = CountChanges(white, Draw(), spot, 0.012);
  EXPECT_GT(charred.near, 200);
  EXPECT_LT(charred.mean[0], 0.5 * blanched.mean[0]) << "char is dark";
  std::fill(now_.operation.blanching.begin(), now_.operation.blanching.end(), 0.0f);
  std::fill(now_.operation.charring.begin(), now_.operation.charring.end(), 0.0f);
  EXPECT_EQ(Draw(), raw) << "after a reset nothing is left";
}

TEST_F(OperationViewTest, TissueThatIsPulledTurnsWhite) {
  MakeView();
  const Image slack = Draw();
  // a hand's breadth of the wall is drawn out sideways, in the plane of the picture
  const Vec3 spot{0, 0, -0.085};
  const std::vector<Vec3> rest = now_.positions;
  for (std::size_t i = 0; i < ball_count_; ++i) {
    const Vec3 from = rest[i] - spot;
    if (math::Norm(from) < 0.006) now_.positions[i] = spot + 1.7 * from;
  }
  const Image pulled = Draw();
  const auto centre = render::CalcPixel(view_->GetFrame().camera, spot, kWidth, kHeight);
  // beside the highlight in the middle
  const auto brightness = [&](const Image& image) {
    double sum = 0;
    for (int i = 0; i < 16; ++i) {
      const auto [r, g, b] = image.At(static_cast<int>(centre.x + 7 * std::cos(i * M_PI / 8)),
                                      static_cast<int>(centre.y + 7 * std::sin(i * M_PI / 8)));
      sum += r + g + b;
    }
    return sum / 16;
  };
  EXPECT_GT(brightness(pulled), brightness(slack) + 15);
  now_.positions = rest;
  EXPECT_EQ(Draw(), slack) << "and it reddens again";
}

TEST_F(OperationViewTest, TheSceneryBreathesAndTheOrgansOfTheModelDoNot) {
  MakeView({}, true);
  const auto read = [this](double time) {
    now_.time = time;
    view_->Update(now_);
    return view_->ReadMeshes();
  };
  const auto before = read(0), after = read(1.1);
  ASSERT_EQ(before.size(), after.size());
  double farthest = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    double moved = 0;
    for (std::size_t v = 0; v < before[i].mesh.positions.size(); ++v)
      moved = std::max(moved, math::Distance(before[i].mesh.positions[v], after[i].mesh.positions[v]));
    farthest = std::max(farthest, moved);
    if (before[i].label == MakeLabel(LabelClass::kGallbladder, 0) ||
        before[i].label == MakeLabel(LabelClass::kTissueModel, 0)) {
      EXPECT_EQ(moved, 0.0);
    }
  }
  EXPECT_GT(farthest, 0.0003);
  EXPECT_LT(farthest, 0.004);
}

TEST_F(OperationViewTest, ACutOrganShowsItsNewSurface) {
  now_.positions.resize(now_.positions.size() + 8);  // spare rows
  MakeView();
  const Image whole = Draw();
  now_.operation.topology.triangles = surfaces_[0].triangles;
  now_.operation.topology.first_triangle = {0};
  now_.operation.topology.triangle_count = {static_cast<std::uint32_t>(surfaces_[0].triangles.size())};
  now_.operation.topology.version = 1;
  EXPECT_EQ(Draw(), whole) << "the same triangles, the same picture";
  // a window in front
  std::vector<geometry::Triangle> kept;
  for (const auto& triangle : surfaces_[0].triangles)
    if (math::Distance(now_.positions[triangle[0]], {0, 0, -0.085}) > 0.006) kept.push_back(triangle);
  now_.operation.topology.triangles = kept;
  now_.operation.topology.triangle_count[0] = static_cast<std::uint32_t>(kept.size());
  now_.operation.topology.version = 2;
  const Change change = CountChanges(whole, Draw(), {0, 0, -0.085}, 0.012);
  EXPECT_GT(change.near, 100);
  EXPECT_EQ(change.far, 0);
  // and a patch over it, on a row that was spare
  const auto spare = static_cast<std::uint32_t>(now_.positions.size() - 1);
  now_.positions[spare] = {0, 0, -0.083};
  kept.push_back({spare, surfaces_[0].triangles[0][0], surfaces_[0].triangles[0][1]});
  now_.operation.topology.triangles = kept;
  now_.operation.topology.triangle_count[0] = static_cast<std::uint32_t>(kept.size());
  now_.operation.topology.version = 3;
  Draw();
  now_.operation.topology.triangles = surfaces_[0].triangles;
  now_.operation.topology.triangle_count[0] = static_cast<std::uint32_t>(surfaces_[0].triangles.size());
  now_.operation.topology.version = 0;
  EXPECT_EQ(Draw(), whole) << "reset";
}

TEST_F(OperationViewTest, ACutDuctEndsInTwoStumpsWithADarkLumen) {
  MakeView();
  const Image whole = Draw();
  for (std::uint32_t i = 0; i + 1 < kDuctNodes; ++i)
    if (i != 5)
      now_.operation.topology.tube_pieces.push_back({ball_count_ + i, ball_count_ + i + 1, 0.002, 0.002, 1});
  now_.operation.topology.tube_piece_count = now_.operation.topology.tube_pieces.size();
  now_.operation.topology.version = 1;
  const Vec3 gap = 0.5 * (DuctNode(5) + DuctNode(6));
  const Change change = CountChanges(whole, Draw(), gap, 0.014);
  EXPECT_GT(change.near, 20);
  EXPECT_EQ(change.far, 0) << "the rest of both pieces keeps its look";
  // a stump that looks at the lens shows its lumen
  for (std::uint32_t i = 0; i < 6; ++i) now_.positions[ball_count_ + i] = {-0.02, -0.028, -0.115 + 0.005 * i};
  const Image ends = Draw();
  const auto centre = render::CalcPixel(view_->GetFrame().camera, DuctNode(5), kWidth, kHeight);
  const auto brightness = [&ends](double x, double y) {
    const auto [r, g, b] = ends.At(static_cast<int>(x + 0.5), static_cast<int>(y + 0.5));
    return r + g + b;
  };
  EXPECT_LT(brightness(centre.x, centre.y), 150) << "dark";
  int rim = 0;
  for (int i = 0; i < 12; ++i)
    rim = std::max(
        rim, brightness(centre.x + 2.4 * std::cos(i * M_PI / 6), centre.y + 2.4 * std::sin(i * M_PI / 6)));
  EXPECT_GT(rim, brightness(centre.x, centre.y) + 100) << "in a light rim";
}

TEST_F(OperationViewTest, BloodRunsDripsAndWetsBelowALeak) {
  MakeView();
  const Image dry = Draw();
  surgery::LeakSnapshot& leak = now_.operation.flow.leaks[0];
  leak = {{0, 0.006, -0.0863}, {0, 0, 1}, surgery::Fluid::kBlood, 1e-6};
  EXPECT_EQ(Draw(), dry) << "not counted yet";
  now_.operation.flow.leak_count = 1;
  const Image bleeding = Draw();
  const Change change = CountChanges(dry, bleeding, leak.position, 0.060);
  EXPECT_GT(change.near, 100);
  EXPECT_GT(change.mean[0], 1.4 * change.mean[1]) << "red";
  leak.fluid = surgery::Fluid::kBile;
  const Change bile = CountChanges(dry, Draw(), leak.position, 0.060);
  EXPECT_GT(bile.mean[1], 1.3 * change.mean[1]) << "bile is yellow";
  leak.rate = 0;
  EXPECT_EQ(Draw(), dry) << "dry again";
}

TEST_F(OperationViewTest, FatIsRedWhereBloodRunsOverIt) {
  std::vector<scene::StrandInfo> strands;
  math::Random random(1);
  for (int i = 0; i < 25; ++i) {
    const auto row = static_cast<std::uint32_t>(now_.positions.size());
    now_.positions.push_back({random.Uniform(-0.01, 0.01), -0.034, -0.090});
    now_.positions.push_back({random.Uniform(-0.01, 0.01), -0.045, -0.092});
    strands.push_back({row, row + 1, scene::StrandInfo::Kind::kTriangle});
  }
  MakeView(strands);
  const Image dry = Draw();
  // below ball and duct: it wets nothing else; so slow that no more than two drops are seen at once
  surgery::LeakSnapshot& leak = now_.operation.flow.leaks[0];
  leak = {{0, -0.036, -0.088}, {0, 0, 1}, surgery::Fluid::kBlood, 2e-9};
  now_.operation.flow.leak_count = 1;
  const Change change = CountChanges(dry, Draw(), leak.position, 0.020);
  EXPECT_GT(change.near, 120);
  EXPECT_GT(change.mean[0], 1.3 * change.mean[1]);
  leak.rate = 0;
  EXPECT_EQ(Draw(), dry) << "dry again";
}

TEST_F(OperationViewTest, ThePoolGrowsWithWhatIsInIt) {
  MakeView();
  now_.gravity = {0, -5, -9};
  now_.operation.flow.p_world_pool = {0, -0.02, -0.115};
  const Image dry = Draw();
  int before = 0;
  for (const double volume : {0.5e-6, 4e-6, 20e-6}) {
    now_.operation.flow.ledger = {};
    now_.operation.flow.ledger.Leak(surgery::Fluid::kBlood, volume);
    const Change change = CountChanges(dry, Draw(), {0, -0.02, -0.10}, 0.2);
    EXPECT_GT(change.near, before + 30) << volume;
    EXPECT_GT(change.mean[0], 1.8 * change.mean[1]) << "blood is red";
    before = change.near;
  }
  now_.operation.flow.ledger.Aspirate(1);
  EXPECT_EQ(Draw(), dry);
}

TEST_F(OperationViewTest, ThePoolLiesInTheHollowsOfTheGround) {
  MakeView({}, true);
  now_.gravity = {0, 0, -9.81};
  now_.operation.flow.p_world_pool = {0, -0.02, -0.13};
  now_.operation.flow.ledger.Leak(surgery::Fluid::kBlood, 10e-6);
  view_->Update(now_);
  ASSERT_EQ(view_->GetFrame().puddles.size(), 1u);
  const double few = view_->GetFrame().puddles[0].centre.z;
  now_.operation.flow.ledger.Leak(surgery::Fluid::kBlood, 20e-6);
  view_->Update(now_);
  EXPECT_GT(view_->GetFrame().puddles[0].centre.z, few) << "more stands higher";
  const double some = view_->GetFrame().puddles[0].centre.z;
  now_.operation.flow.ledger.Leak(surgery::Fluid::kBlood, 2000e-6);
  view_->Update(now_);
  EXPECT_LT(view_->GetFrame().puddles[0].centre.z, some + 0.014)
      << "and never as high as the lens: it runs off";
}

TEST_F(OperationViewTest, StonesAreSeenOnceTheyAreOut) {
  MakeView();
  const Image clean = Draw();
  now_.operation.stones.assign(3, {});
  surgery::StoneSnapshot& stone = now_.operation.stones[1];
  stone = {{0.001, 0.004, -0.083}, 0.002, surgery::StonePlace::kInside, -1};
  EXPECT_EQ(Draw(), clean);
  for (const auto place : {surgery::StonePlace::kSpilled, surgery::StonePlace::kHeld}) {
    stone.place = place;
    const Change change = CountChanges(clean, Draw(), stone.position, 0.0024);
    EXPECT_GT(change.near, 20);
    EXPECT_EQ(change.far, 0);
    EXPECT_GT(change.mean[0], 1.15 * change.mean[2]) << "yellow-brown";
  }
  // another of another size in its place, as in another operation
  stone.radius = 0.004;
  EXPECT_GT(CountChanges(clean, Draw(), stone.position, 0.0048).near, 100);
  for (const auto place :
       {surgery::StonePlace::kInBag, surgery::StonePlace::kAspirated, surgery::StonePlace::kTakenOut}) {
    stone.place = place;
    EXPECT_EQ(Draw(), clean);
  }
}

TEST_F(OperationViewTest, WhereTheBedOozesTheTissueIsRed) {
  MakeView();
  const Image dry = Draw();
  now_.operation.flow.oozes[0] = {{0, 0.006, -0.0863}, 5e-10};
  EXPECT_EQ(Draw(), dry) << "not counted yet";
  now_.operation.flow.ooze_count = 1;
  const Image wet = Draw();
  const Change change = CountChanges(dry, wet, {0, 0.004, -0.0863}, 0.010);
  EXPECT_GT(change.near, 15);
  EXPECT_EQ(change.far, 0) << "a spot, no stream";
  const Change before = CountChanges(wet, dry, {0, 0.004, -0.0863}, 0.010);
  EXPECT_GT(change.mean[0] / change.mean[1], 1.1 * before.mean[0] / before.mean[1]);
}

TEST_F(OperationViewTest, SmokeVeilsThePictureAndClears) {
  MakeView();
  const Image clear = Draw();
  now_.operation.smoke = 0.3;
  const Image haze = Draw();
  now_.operation.smoke = 1.0;
  const Image thick = Draw();
  // how far the gallbladder's pixels are from grey
  const auto spread = [](const Image& image) {
    int sum = 0;
    for (int y = 70; y < 110; ++y) {
      for (int x = 140; x < 180; ++x) {
        const auto [r, g, b] = image.At(x, y);
        sum += std::max({r, g, b}) - std::min({r, g, b});
      }
    }
    return sum;
  };
  EXPECT_LT(spread(haze), 0.8 * spread(clear)) << "grey takes the colour";
  EXPECT_LT(spread(thick), 0.6 * spread(haze));
  now_.operation.smoke = 0;
  EXPECT_EQ(Draw(), clear);
}

TEST_F(OperationViewTest, TheAssistantsGrasperIsSeenWhenThereIsOne) {
  MakeView();
  const Image alone = Draw();
  now_.operation.assistant.X_world_tool = {math::RotationAbout({1, 0, 0}, -0.5 * M_PI), {-0.025, 0.0, -0.09}};
  EXPECT_EQ(Draw(), alone);
  now_.operation.assistant.is_there = true;
  EXPECT_GT(CountChanges(alone, Draw(), {-0.025, 0.015, -0.09}, 0.02).near, 100);
}

TEST_F(OperationViewTest, CurrentSparksAtTheElectrode) {
  now_.operation.tools[0] = 2;
  MakeView();
  const Image off = Draw();
  now_.operation.has_current[0] = true;
  const Change change = CountChanges(off, Draw(), now_.instruments[0].X_world_tool.translation, 0.010);
  EXPECT_GT(change.near, 5);
  EXPECT_EQ(change.far, 0);
}

TEST_F(OperationViewTest, WaterIsSeenWhileThePedalIsDown) {
  now_.operation.tools[0] = 5;
  scene_.operation.emplace();
  // towards the ball, 35 mm from its surface
  now_.instruments[0].X_world_tool = {math::RotationBetween({0, 0, -1}, {1, 0, 0}), {-0.050, 0.0, -0.10}};
  MakeView();
  const Image dry = Draw();
  now_.operation.is_rinsing[0] = true;
  const Image wet = Draw();
  EXPECT_GT(CountChanges(dry, wet, {-0.032, 0.0, -0.10}, 0.014).near, 60) << "no jet";
  EXPECT_GT(CountChanges(dry, wet, {-0.014, 0.0, -0.10}, 0.008).near, 30)
      << "no splash where it meets the ball";
  // it ends there: behind the ball nothing changes
  EXPECT_EQ(CountChanges(dry, wet, {0.025, 0.0, -0.10}, 0.008).near, 0);
  now_.operation.is_rinsing[0] = false;
  EXPECT_EQ(Draw(), dry);
}

TEST_F(OperationViewTest, SuctionDrawsFromThePoolThatItReaches) {
  now_.operation.tools[0] = 5;
  scene_.operation.emplace();
  now_.operation.flow.ledger.rinse_pooled = 5e-6;
  now_.operation.flow.p_world_pool = {-0.05, -0.03, -0.09};
  now_.instruments[0].X_world_tool.translation = {-0.05, -0.02, -0.09};
  MakeView();
  const Image still = Draw();
  now_.operation.is_aspirating[0] = true;
  EXPECT_GT(CountChanges(still, Draw(), {-0.05, -0.02, -0.09}, 0.010).near, 10);
  // in the air it draws nothing that is seen
  now_.operation.flow.p_world_pool = {0.05, -0.10, -0.09};
  const Image away = Draw();
  now_.operation.is_aspirating[0] = false;
  EXPECT_EQ(Draw(), away);
}

TEST_F(OperationViewTest, SteamRisesFromWetTissueAndNotFromChar) {
  now_.operation.tools[0] = 2;
  now_.operation.charring.assign(now_.positions.size(), 0.0f);
  now_.operation.blanching.assign(now_.positions.size(), 0.0f);
  now_.instruments[0].X_world_tool.translation = {0.0, 0.012, -0.085};
  now_.time = 3.0;
  MakeView();
  Draw();
  EXPECT_TRUE(view_->GetFrame().puffs.empty());
  now_.operation.has_current[0] = true;
  const Image wet = Draw();
  const auto puffs = view_->GetFrame().puffs;
  ASSERT_GE(puffs.size(), 8u);
  double highest = -1, lowest = 1;
  for (const render::Puff& puff : puffs) {
    highest = std::max(highest, puff.centre.y);
    lowest = std::min(lowest, puff.centre.y);
    EXPECT_GE(puff.opacity, 0.0);
    EXPECT_LE(puff.opacity, 0.5);
  }
  EXPECT_GT(highest, 0.020) << "gravity points along -y, so steam rises along +y";
  EXPECT_GT(lowest, 0.005);
  std::fill(now_.operation.charring.begin(), now_.operation.charring.end(), 1.0f);
  Draw();
  EXPECT_TRUE(view_->GetFrame().puffs.empty()) << "char is dry";
  // what steam covers is lighter, and the same moment has the same steam
  std::fill(now_.operation.charring.begin(), now_.operation.charring.end(), 0.0f);
  EXPECT_EQ(Draw(), wet);
}

TEST_F(OperationViewTest, TissueThatAToolPressesTurnsWhite) {
  surfaces_[0].look = "liver";  // dark red: what whitens is seen
  MakeView();
  ViewOptions options = view_->GetOptions();
  options.has_force_arrows = false;
  view_->SetOptions(options);
  auto& tool = now_.instruments[0];
  tool.X_world_tool = {math::RotationBetween({0, 0, 1}, {0, 1, 0}), {0.0, 0.004, -0.0845}};
  const Image before = Draw();
  // of the pixels that changed: how much greener and bluer they became, which red tissue does as it turns white
  const auto whiter = [&](const Image& image) {
    double sum = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const auto [r0, g0, b0] = before.At(x, y);
        const auto [r, g, b] = image.At(x, y);
        sum += (g + b) - (g0 + b0);
      }
    }
    return sum;
  };
  tool.organ = 0;
  tool.is_touching = true;
  tool.force = {0, 0, 1.5};
  const Image pressed = Draw();
  EXPECT_GT(whiter(pressed), 2000);
  EXPECT_GT(CountChanges(before, pressed, {0.0, 0.004, -0.085}, 0.013).near, 100);
  EXPECT_EQ(CountChanges(before, pressed, {0.0, 0.004, -0.085}, 0.016).far, 0) << "only round the tip";
  // a feather's weight is not seen
  tool.force = {0, 0, 0.05};
  EXPECT_EQ(Draw(), before);
  // jaws that hold: by their pinch, whatever the pull
  tool.is_grasping = true;
  tool.pinch = 5.0;
  EXPECT_GT(whiter(Draw()), 2000);
  tool.pinch = 0.1;
  EXPECT_EQ(Draw(), before);
  tool.organ = -1;
  tool.pinch = 5.0;
  EXPECT_EQ(Draw(), before);
}

TEST_F(OperationViewTest, TheLensIsSmearedByTissueUntilItIsWiped) {
  MakeView();
  now_.laparoscope.depth = 0.15;
  now_.X_world_laparoscope.translation = {0, 0, 0};
  now_.time = 1.0;
  const Image clear = Draw();
  ASSERT_TRUE(view_->GetFrame().blots.empty());
  // the lens into the ball, which begins 85 mm ahead, and back to where it was
  now_.X_world_laparoscope.translation = {0, 0, -0.081};
  now_.time = 2.0;
  Draw();
  ASSERT_FALSE(view_->GetFrame().blots.empty());
  now_.X_world_laparoscope.translation = {0, 0, 0};
  now_.time = 3.0;
  const Image smeared = Draw();
  EXPECT_GT(CountChanges(clear, smeared, {0, 0, -0.10}, 0.05).near, 500);
  // it is a lens's: from elsewhere nothing is smeared
  const std::size_t blots = view_->GetFrame().blots.size();
  now_.X_world_laparoscope.translation = {0, 0, -0.081};
  now_.time = 4.0;
  Draw();
  EXPECT_GT(view_->GetFrame().blots.size(), blots) << "another touch adds to it";
  // drawn back into the trocar it is wiped
  now_.laparoscope.depth = 0.01;
  now_.X_world_laparoscope.translation = {0, 0, 0};
  now_.time = 5.0;
  EXPECT_EQ(Draw(), clear);
  // and a leap back in time begins clean
  now_.laparoscope.depth = 0.15;
  now_.X_world_laparoscope.translation = {0, 0, -0.081};
  now_.time = 6.0;
  Draw();
  ASSERT_FALSE(view_->GetFrame().blots.empty());
  now_.X_world_laparoscope.translation = {0, 0, 0};
  now_.time = 0.5;
  EXPECT_EQ(Draw(), clear);
}

}  // namespace
}  // namespace trocar::view
