// SPDX-License-Identifier: Apache-2.0
#include "trocar/view/film_maker.h"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "trocar/files/scene_file.h"
#include "trocar/host/safe_file.h"
#include "trocar/render/image.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::view {
namespace {

class FilmMakerTest : public testing::Test {
 protected:
  void SetUp() override {
    auto scene = files::ReadScene(std::filesystem::path(TROCAR_SOURCE_DIR) / "scenes" / "demonstration.json");
    ASSERT_TRUE(scene.ok()) << scene.error().Text();
    auto made = simulation::Simulation::Make(std::make_shared<const scene::Scene>(std::move(*scene)));
    ASSERT_TRUE(made.ok());
    simulation_.emplace(std::move(*made));
    settings_.width = 324, settings_.height = 120;
    settings_.video = folder_.Path() / "film.webm";
  }
  /// One frame of these.
  render::Image Draw(std::vector<FilmMaker::Side> sides) {
    std::vector<const simulation::Simulation*> simulations(sides.size(), &*simulation_);
    auto film = FilmMaker::Make(settings_, simulations);
    EXPECT_TRUE(film.ok()) << film.error().Text();
    EXPECT_TRUE(film->AddFrame(sides).ok());
    EXPECT_EQ(film->FrameCount(), 1u);
    EXPECT_TRUE(film->SavePicture(folder_.Path() / "a.png").ok());
    EXPECT_TRUE(film->Finish().ok());
    EXPECT_GT(std::filesystem::file_size(settings_.video), 500u);
    return *render::ParsePng(*host::ReadFile(folder_.Path() / "a.png"), "a.png");
  }
  /// Pixels from column x0 to before x1 that differ.
  static int CountDifferent(const render::Image& a, const render::Image& b, int x0, int x1) {
    int count = 0;
    for (int y = 0; y < a.height; ++y) {
      for (int x = x0; x < x1; ++x) count += a.At(x, y) != b.At(x, y) ? 1 : 0;
    }
    return count;
  }
  test::TemporaryFolder folder_;
  std::optional<simulation::Simulation> simulation_;
  FilmSettings settings_;
};

TEST_F(FilmMakerTest, PutsTwoBesideEachOther) {
  const simulation::Snapshot& now = simulation_->GetSnapshot();
  const auto both = Draw({{&now, {}}, {&now, {}}});
  ASSERT_EQ(both.width, 324);
  for (int y = 0; y < both.height; ++y) {
    for (int x = 0; x < 160; ++x) ASSERT_EQ(both.At(x, y), both.At(x + 164, y)) << x << " " << y;
    EXPECT_EQ(both.At(161, y), (std::array<std::uint8_t, 3>{0, 0, 0}));
  }
}

TEST_F(FilmMakerTest, TrailsGhostsAndAnotherCameraShowInTheirPictureAlone) {
  const simulation::Snapshot& now = simulation_->GetSnapshot();
  const auto plain = Draw({{&now, {}}, {&now, {}}});
  const math::Vec3 ahead = now.X_world_laparoscope * math::Vec3{0, 0, -0.05};
  const math::Vec3 aside = now.X_world_laparoscope * math::Vec3{0.015, 0.01, -0.05};
  Overlay trails;
  trails.trails = MakePathTrails(std::array{ahead, aside}, {});
  const auto with_trails = Draw({{&now, trails}, {&now, {}}});
  EXPECT_GT(CountDifferent(plain, with_trails, 0, 160), 20);
  EXPECT_EQ(CountDifferent(plain, with_trails, 164, 324), 0);
  Overlay camera;
  camera.X_world_camera = now.X_world_laparoscope;
  camera.X_world_camera->translation = now.X_world_laparoscope * math::Vec3{0.02, 0, 0};
  const auto from_aside = Draw({{&now, {}}, {&now, camera}});
  EXPECT_EQ(CountDifferent(plain, from_aside, 0, 160), 0);
  EXPECT_GT(CountDifferent(plain, from_aside, 164, 324), 3000);
  simulation::Snapshot other = now;
  other.instruments[0].X_world_tool.translation = ahead;
  Overlay ghosts;
  ghosts.trails = MakeGhosts(other);
  EXPECT_GT(CountDifferent(plain, Draw({{&now, ghosts}, {&now, {}}}), 0, 160), 20);
}

TEST_F(FilmMakerTest, RefusesSizesThatCannotBe) {
  settings_.width = 20;
  const simulation::Simulation* two[] = {&*simulation_, &*simulation_};
  const auto film = FilmMaker::Make(settings_, two);
  ASSERT_FALSE(film.ok());
  EXPECT_EQ(film.error().code, base::ErrorCode::kUsage);
}

}  // namespace
}  // namespace trocar::view
