// SPDX-License-Identifier: Apache-2.0
#include "trocar/view/demo.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "trocar/files/scene_file.h"
#include "trocar/host/safe_file.h"
#include "trocar/render/image.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::view {
namespace {

namespace fs = std::filesystem;

class DemoTest : public testing::Test {
 protected:
  void SetUp() override {
    auto scene = files::ReadScene(fs::path(TROCAR_SOURCE_DIR) / "scenes" / "demonstration.json");
    ASSERT_TRUE(scene.ok()) << scene.error().Text();
    scene_ = std::make_shared<const scene::Scene>(std::move(*scene));
    options_.output_folder = folder_.Path();
    options_.width = 320;
    options_.height = 180;
    options_.duration = 0.2;
  }

  std::shared_ptr<const scene::Scene> scene_;
  test::TemporaryFolder folder_;
  DemoOptions options_;
};

TEST_F(DemoTest, WritesVideoAndPicturesAndCallsForEveryTick) {
  options_.picture_times = {0.0, 0.1, 0.2, 7.0};  // the last lies beyond the end
  std::uint64_t ticks = 0;
  double done = 0;
  options_.on_tick = [&](const simulation::Snapshot& snapshot) { EXPECT_EQ(snapshot.tick, ++ticks); };
  options_.on_progress = [&](double share) { done = share; };
  const auto report = PlayDemonstration(scene_, options_);
  ASSERT_TRUE(report.ok()) << report.error().Text();
  EXPECT_EQ(report->frames, 7u);  // 0.2 s at 30 a second, both ends
  EXPECT_EQ(report->ticks, 24u);
  EXPECT_EQ(ticks, 24u);
  EXPECT_DOUBLE_EQ(done, 1.0);
  EXPECT_GT(fs::file_size(report->video), 1000u);
  ASSERT_EQ(report->pictures.size(), 3u);
  for (const DemoPicture& picture : report->pictures) {
    const auto bytes = host::ReadFile(picture.path);
    ASSERT_TRUE(bytes.ok());
    const auto image = render::ParsePng(*bytes, "picture");
    ASSERT_TRUE(image.ok());
    EXPECT_EQ(image->width, 320);
    EXPECT_EQ(image->height, 180);
  }
}

TEST_F(DemoTest, PlaysTheSameTwice) {
  options_.has_video = false;
  options_.picture_times = {0.2};
  const auto first = PlayDemonstration(scene_, options_);
  ASSERT_TRUE(first.ok()) << first.error().Text();
  const auto picture = host::ReadFile(first->pictures.at(0).path);
  options_.threads = 2;
  const auto second = PlayDemonstration(scene_, options_);
  ASSERT_TRUE(second.ok()) << second.error().Text();
  EXPECT_EQ(first->state_hash, second->state_hash);
  EXPECT_EQ(*picture, *host::ReadFile(second->pictures.at(0).path));
  EXPECT_FALSE(fs::exists(folder_.Path() / "demo.webm"));
}

// Pictures, the command line and the window must play one and the same surgery.
TEST_F(DemoTest, PlaysWhatTheSimulationAlonePlays) {
  options_.has_video = false;
  const auto report = PlayDemonstration(scene_, options_);
  ASSERT_TRUE(report.ok()) << report.error().Text();
  auto simulation = simulation::Simulation::Make(scene_);
  ASSERT_TRUE(simulation.ok());
  for (std::uint64_t tick = 0; tick < report->ticks; ++tick) {
    simulation->Step(scene::CalcScriptInput(*scene_, simulation->GetSnapshot().time));
  }
  EXPECT_EQ(report->state_hash, simulation->Hash());
}

/// The script a little aside, until a tick.
struct Aside : simulation::InputSource {
  Aside(const scene::Scene& played, std::uint64_t end) : scene(played), end_tick(end) {}
  scene::Input For(std::uint64_t tick, const simulation::Snapshot& before) override {
    EXPECT_EQ(tick, ++last);
    EXPECT_EQ(before.tick + 1, tick);
    scene::Input input = scene::CalcScriptInput(scene, before.time);
    input.hands[0].pan += 0.05;
    return input;
  }
  bool IsAtEnd() const override { return last >= end_tick; }
  const scene::Scene& scene;
  std::uint64_t end_tick, last = 0;
};

TEST_F(DemoTest, PlaysAnySourceAndEndsWithItWhereItIsAskedTo) {
  options_.has_video = false;
  const auto script = PlayDemonstration(scene_, options_);
  ASSERT_TRUE(script.ok()) << script.error().Text();
  for (const bool is_until_end : {false, true}) {
    Aside source(*scene_, 9);
    options_.source = &source;
    options_.is_until_end = is_until_end;
    std::uint64_t seen = 0;
    options_.after_step = [&](simulation::Simulation&, const scene::Input& input) {
      const double time = static_cast<double>(seen++) * scene_->tick_seconds;
      EXPECT_NEAR(input.hands[0].pan, scene::CalcScriptInput(*scene_, time).hands[0].pan + 0.05, 1e-6);
    };
    const auto report = PlayDemonstration(scene_, options_);
    ASSERT_TRUE(report.ok()) << report.error().Text();
    EXPECT_NE(report->state_hash, script->state_hash);
    EXPECT_EQ(report->ticks, source.last);
    EXPECT_EQ(report->ticks, seen);
    if (is_until_end) {
      EXPECT_LT(report->ticks, 20u);
    } else {
      EXPECT_EQ(report->ticks, script->ticks);
    }
  }
}

TEST_F(DemoTest, RefusesOptionsOutOfRange) {
  const auto expect_usage = [&](DemoOptions options) {
    const auto report = PlayDemonstration(scene_, options);
    ASSERT_FALSE(report.ok());
    EXPECT_EQ(report.error().code, base::ErrorCode::kUsage);
  };
  DemoOptions wrong = options_;
  wrong.duration = -1;
  expect_usage(wrong);
  wrong = options_;
  wrong.duration = NAN;
  expect_usage(wrong);
  wrong = options_;
  wrong.width = 0;
  expect_usage(wrong);
  wrong = options_;
  wrong.frames_per_second = 0;
  expect_usage(wrong);
  wrong = options_;
  wrong.threads = 0;
  expect_usage(wrong);
}

TEST_F(DemoTest, WithoutScriptAndDurationSaysSo) {
  scene::Scene bare = *scene_;
  bare.script.keys.clear();
  options_.duration = 0;
  const auto report = PlayDemonstration(std::make_shared<const scene::Scene>(bare), options_);
  ASSERT_FALSE(report.ok());
  EXPECT_EQ(report.error().code, base::ErrorCode::kScriptInvalid);
}

TEST_F(DemoTest, AFolderThatIsAFileLeavesNothing) {
  std::ofstream(folder_.Path() / "plain") << "x";
  options_.output_folder = folder_.Path() / "plain";
  const auto report = PlayDemonstration(scene_, options_);
  ASSERT_FALSE(report.ok());
  EXPECT_EQ(report.error().code, base::ErrorCode::kVideoFailed);
}

}  // namespace
}  // namespace trocar::view
