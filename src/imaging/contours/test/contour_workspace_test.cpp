// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/contour_workspace.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "phantom_picture.h"
#include "trocar/contours/contour_autosave.h"
#include "trocar/host/safe_file.h"
#include "trocar/images/png_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::contours {

using math::Vec2;

namespace {

namespace fs = std::filesystem;

constexpr double kRadius = 30, kDrift = 1.5;  // of the shape [pixels], and its way from slice to slice

images::ColorImage DrawSlice(int slice) {
  const double cx = 60 + kDrift * (slice - 1);
  return DrawPhantom({.width = 120, .height = 110, .seed = static_cast<std::uint64_t>(slice)},
                     [cx](double x, double y) { return std::hypot(x - cx, y - 55) - kRadius; });
}

std::vector<Vec2> Circle(int slice, double radius, int n = 12) {
  return MakePolar({60 + kDrift * (slice - 1), 55}, n, [radius](double) { return radius; });
}

class Workspace : public testing::Test {
 protected:
  void SetUp() override {
    for (int slice = 1; slice <= 6; ++slice) {
      char name[32];
      std::snprintf(name, sizeof(name), "slice-%02d.png", slice);
      ASSERT_TRUE(images::WritePng(folder_.Path() / "slices" / name, DrawSlice(slice)).ok());
    }
    options_.images = folder_.Path() / "slices";
    options_.points = folder_.Path() / "points.json";
    options_.series.pixel_mm = 1.0;
    options_.series.slice_mm = 4.0;
    options_.series.axes = {"left", "posterior", "inferior"};
  }
  ContourWorkspace Open() {
    auto opened = ContourWorkspace::Open(options_);
    EXPECT_TRUE(opened.ok()) << opened.error().Text();
    return std::move(*opened);
  }
  test::TemporaryFolder folder_;
  WorkspaceOptions options_;
};

TEST_F(Workspace, BeginsAsTheSeriesLiesAndGoesOnFromTheFile) {
  auto workspace = Open();
  const ControlPoints& points = workspace.Document().Points();
  EXPECT_EQ(points.width, 120);
  EXPECT_EQ(points.first_slice, 1);
  EXPECT_EQ(points.last_slice, 6);
  EXPECT_EQ(points.pixel_mm, 1.0);
  EXPECT_EQ(points.axes[2], "inferior");
  ASSERT_EQ(points.structures.size(), 2u);
  ASSERT_TRUE(workspace.Document().SetContours(0, 2, {Circle(2, 28)}, {}, "set").ok());
  EXPECT_TRUE(workspace.Document().IsDirty());
  ASSERT_TRUE(workspace.Save(options_.points).ok());
  EXPECT_FALSE(workspace.Document().IsDirty());

  options_.series = {};  // the file knows what the pictures do not say
  auto again = Open();
  EXPECT_EQ(again.Document().Text(), workspace.Document().Text());
  EXPECT_EQ(again.SavedText(), workspace.Document().Text());
  EXPECT_EQ(again.StepSlice(2, 1), 3);
  EXPECT_EQ(again.StepSlice(100, 0), 6);
  EXPECT_EQ(again.StepSlice(6, 5), 6);
}

TEST_F(Workspace, PicturesOfAnotherSizeAreRefused) {
  auto workspace = Open();
  ControlPoints points = workspace.Document().Points();
  points.width = 200;
  ASSERT_TRUE(WriteControlPoints(options_.points, points).ok());
  const auto opened = ContourWorkspace::Open(options_);
  ASSERT_FALSE(opened.ok());
  EXPECT_EQ(opened.error().code, base::ErrorCode::kImageSizeDiffers);
}

TEST_F(Workspace, FitsAreComputedOnlyWhereSomethingChanged) {
  auto workspace = Open();
  auto& document = workspace.Document();
  ASSERT_TRUE(document.SetContours(0, 2, {Circle(2, 28), {{5, 5}, {15, 5}, {10, 14}}}, {}, "set").ok());
  ASSERT_TRUE(document.SetContours(0, 3, {Circle(3, 28)}, {}, "set").ok());
  const auto first = workspace.Fit(0, 2);
  ASSERT_TRUE(first.ok());
  ASSERT_TRUE(workspace.Fit(0, 3).ok());
  EXPECT_EQ(workspace.Fits()->ComputedCount(), 3u);
  ASSERT_TRUE(workspace.Fit(0, 2).ok());
  EXPECT_EQ(workspace.Fits()->ComputedCount(), 3u);
  ASSERT_TRUE(document.MovePoint({0, 2, false, 1}, 0, {6, 6}).ok());
  const auto moved = workspace.Fit(0, 2);
  ASSERT_TRUE(moved.ok());
  EXPECT_EQ(workspace.Fits()->ComputedCount(), 4u) << "only the contour whose point moved";
  EXPECT_EQ((*moved)->contours[0], (*first)->contours[0]);
  EXPECT_NE((*moved)->contours[1], (*first)->contours[1]);
  ASSERT_TRUE(document.SetAdaption(0, {.max_shift_px = 0}).ok());
  const auto still = workspace.Fit(0, 2);
  ASSERT_TRUE(still.ok());
  for (std::size_t i = 0; i < 12; ++i)
    EXPECT_EQ((*still)->contours[0]->adapted[i], document.At(0, 2).contours[0][i]);
}

TEST_F(Workspace, CarriesContoursAlongAndDoesNotOverwriteThem) {
  auto workspace = Open();
  auto& document = workspace.Document();
  EXPECT_FALSE(workspace.Propagate(0, 2, 3).ok()) << "nothing to carry";
  ASSERT_TRUE(document.SetContours(0, 1, {Circle(1, 29)}, {}, "set").ok());
  const auto carried = workspace.Propagate(0, 1, 5);
  ASSERT_TRUE(carried.ok()) << carried.error().Text();
  EXPECT_EQ(carried->slice, 5);
  double worst = 0;
  for (const Vec2& p : document.At(0, 5).contours[0]) {
    worst = std::max(worst, std::fabs(Norm(p - Vec2{60 + kDrift * 4, 55}) - kRadius));
  }
  EXPECT_LT(worst, 1.5) << "the shape has moved by 6 pixels";
  EXPECT_TRUE(document.At(0, 3).contours.empty()) << "slices on the way stay empty";
  const auto again = workspace.Propagate(0, 1, 5);
  ASSERT_FALSE(again.ok());
  EXPECT_EQ(again.error().code, base::ErrorCode::kEditRefused);
  EXPECT_TRUE(workspace.Propagate(0, 1, 5, true).ok());
}

TEST_F(Workspace, ScissorsFollowTheEdge) {
  auto workspace = Open();
  ASSERT_TRUE(workspace.FollowEdge(0, 1, {90, 55}).ok());
  ASSERT_TRUE(workspace.FollowEdge(0, 1, {60, 85}).ok());
  ASSERT_TRUE(workspace.FollowEdge(0, 1, {30, 55}).ok());
  const auto& open = workspace.Document().At(0, 1).open;
  ASSERT_GT(open.size(), 6u);
  EXPECT_LT(open.size(), 60u) << "few points, not every pixel";
  for (const Vec2& p : open) EXPECT_NEAR(Norm(p - Vec2{60, 55}), kRadius, 3.0);
}

TEST_F(Workspace, ReferenceBordersLieAroundTheLabels) {
  // 6 slices of 60 x 55 labels of twice the pixel, LPS: rows posterior, slices inferior
  std::string header =
      "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 60 55 6\n"
      "space directions: (2,0,0) (0,2,0) (0,0,-4)\nspace origin: (0,0,0)\nencoding: raw\n\n";
  std::string data(60 * 55 * 6, '\0');
  for (int k = 0; k < 6; ++k) {
    for (int y = 20; y < 30; ++y) {
      for (int x = 10; x < 40; ++x) data[static_cast<std::size_t>((k * 55 + y) * 60 + x)] = k == 2 ? 2 : 1;
    }
  }
  options_.reference = folder_.Path() / "labels.nrrd";
  ASSERT_TRUE(host::WriteFile(options_.reference, header + data).ok());
  auto workspace = Open();
  ASSERT_TRUE(workspace.HasReference());
  const auto lines = workspace.FindReference(1);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].label, 1);
  ASSERT_EQ(lines[0].lines.size(), 4u) << "a rectangle has four sides";
  for (const auto& line : lines[0].lines) {
    for (const Vec2& p : line) {
      EXPECT_TRUE(p.x == 19.5 || p.x == 79.5) << p.x;
      EXPECT_TRUE(p.y == 39.5 || p.y == 59.5) << p.y;
    }
  }
  EXPECT_EQ(workspace.FindReference(3)[0].label, 2);
  options_.series.axes = {"left", "anterior", "inferior"};
  EXPECT_EQ(ContourWorkspace::Open(options_).error().code, base::ErrorCode::kLabelsMismatch);
}

TEST_F(Workspace, PreviewOfACylinderHasItsVolume) {
  auto workspace = Open();
  auto& document = workspace.Document();
  SliceFits& fits = *workspace.Fits();
  for (const int slice : {1, 3, 6}) {
    ASSERT_TRUE(document.SetContours(0, slice, {Circle(slice, kRadius)}, {}, "set").ok());
  }
  for (const MeshLevel level : {MeshLevel::kCoarse, MeshLevel::kFine}) {
    const auto mesh = MakePreviewMesh(workspace.MakeMeshRequest(0), fits, level);
    ASSERT_TRUE(mesh.ok()) << mesh.error().Text();
    EXPECT_TRUE(mesh->is_closed);
    EXPECT_TRUE(mesh->is_manifold);
    EXPECT_LE(mesh->mesh.triangles.size(), 5132u) << "the liver's budget";
    // 5 gaps of 4 mm, and half a gap of caps that close as paraboloids: between the bare and the padded
    // column
    const double disc = M_PI * kRadius * kRadius / 1000;
    EXPECT_GT(mesh->volume_ml, 20 * disc);
    EXPECT_LT(mesh->volume_ml, 30 * disc);
  }
  int calls = 0;
  const auto stopped = MakePreviewMesh(workspace.MakeMeshRequest(0), fits, MeshLevel::kFine,
                                       [&](std::string_view, double) { return ++calls < 3; });
  ASSERT_FALSE(stopped.ok());
  EXPECT_EQ(stopped.error().code, base::ErrorCode::kCancelled);
  EXPECT_EQ(calls, 3);
  ASSERT_TRUE(document.ClearSlice(0, 1).ok());
  ASSERT_TRUE(document.ClearSlice(0, 3).ok());
  const auto one = MakePreviewMesh(workspace.MakeMeshRequest(0), fits, MeshLevel::kFine);
  ASSERT_FALSE(one.ok());
  EXPECT_EQ(one.error().code, base::ErrorCode::kContourTooShort);
}

/// Takes outcomes until `is_enough` or ten seconds have gone.
template <typename IsEnough>
std::vector<MeshOutcome> Collect(MeshJob& job, IsEnough is_enough) {
  std::vector<MeshOutcome> all;
  for (int i = 0; i < 1000 && !is_enough(all); ++i) {
    for (MeshOutcome& outcome : job.Take()) all.push_back(std::move(outcome));
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return all;
}

TEST_F(Workspace, MeshJobGivesCoarseThenFineAndTheNewestWins) {
  auto workspace = Open();
  auto& document = workspace.Document();
  for (const int slice : {1, 3, 6})
    ASSERT_TRUE(document.SetContours(0, slice, {Circle(slice, 20)}, {}, "set").ok());
  std::atomic<int> changes = 0;
  MeshJob job(workspace.Fits(), [&changes] { ++changes; });
  for (int i = 0; i < 20; ++i) job.Request(workspace.MakeMeshRequest(0));
  // the last request has other contours than those before
  ASSERT_TRUE(document.SetAdaption(0, {.max_shift_px = 0}).ok());
  for (const int slice : {1, 3, 6})
    ASSERT_TRUE(document.SetContours(0, slice, {Circle(slice, 10)}, {}, "set").ok());
  job.Request(workspace.MakeMeshRequest(0));
  const auto all = Collect(job, [](const auto& outcomes) {
    return !outcomes.empty() && outcomes.back().result.ok() &&
           outcomes.back().result.value().level == MeshLevel::kFine &&
           outcomes.back().result.value().volume_ml < 12;
  });
  ASSERT_FALSE(all.empty());
  ASSERT_TRUE(all.back().result.ok());
  EXPECT_EQ(all.back().result.value().level, MeshLevel::kFine);
  EXPECT_LT(all.back().result.value().volume_ml, 12) << "of the last request";
  EXPECT_GT(changes.load(), 2);
  const auto direct = MakePreviewMesh(workspace.MakeMeshRequest(0), *workspace.Fits(), MeshLevel::kFine);
  EXPECT_EQ(all.back().result.value().mesh, direct->mesh) << "the same bits as in this thread";
}

TEST_F(Workspace, MeshJobIsCancelledAndTellsProblems) {
  auto workspace = Open();
  auto& document = workspace.Document();
  ASSERT_TRUE(document.SetContours(0, 1, {Circle(1, 20)}, {}, "set").ok());
  MeshJob job(workspace.Fits(), [] {});
  job.Request(workspace.MakeMeshRequest(0));
  const auto all = Collect(job, [](const auto& outcomes) { return !outcomes.empty(); });
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].result.error().code, base::ErrorCode::kContourTooShort);
  for (const int slice : {3, 6})
    ASSERT_TRUE(document.SetContours(0, slice, {Circle(slice, 20)}, {}, "set").ok());
  for (int i = 0; i < 5; ++i) {
    job.Request(workspace.MakeMeshRequest(0));
    job.Cancel();
  }
  while (job.GetState().is_busy) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_TRUE(job.Take().empty());
}

TEST(SliceStore, KeepsWhatWasUsedLastWithinItsMemory) {
  int reads = 0;
  SliceStore store(
      [&reads](int) -> base::Result<images::ColorImage> {
        ++reads;
        return images::ColorImage{10, 10, std::vector<std::uint8_t>(300)};
      },
      1000);
  for (const int slice : {1, 2, 3}) ASSERT_TRUE(store.Picture(slice).ok());
  ASSERT_TRUE(store.Picture(1).ok());
  EXPECT_EQ(reads, 3);
  EXPECT_EQ(store.UsedBytes(), 900u);
  ASSERT_TRUE(store.Picture(4).ok());  // 2 was used least
  ASSERT_TRUE(store.Picture(1).ok());
  EXPECT_EQ(reads, 4);
  ASSERT_TRUE(store.Picture(2).ok());
  EXPECT_EQ(reads, 5);
  EXPECT_LE(store.UsedBytes(), 1000u);
}

TEST(SliceStore, ErrorsArePassedOnAndNotKept) {
  bool is_broken = true;
  SliceStore store([&is_broken](int slice) -> base::Result<images::ColorImage> {
    if (is_broken) return base::Error{base::ErrorCode::kImageSliceMissing, std::to_string(slice)};
    return images::ColorImage{3, 3, std::vector<std::uint8_t>(27)};
  });
  EXPECT_EQ(store.Field(7, 1.5).error().code, base::ErrorCode::kImageSliceMissing);
  is_broken = false;
  EXPECT_TRUE(store.Field(7, 1.5).ok());
}

class Autosave : public testing::Test {
 protected:
  static ControlPoints MakePoints(int count) {
    ControlPoints points;
    points.name = "autosave";
    points.image_pattern = "{slice}.png";
    points.first_slice = 1, points.last_slice = 9;
    points.width = points.height = 1000;
    points.axes = {"left", "posterior", "superior"};
    Structure liver{.name = "liver", .triangle_budget = 1000};
    SliceContours slice{1, {}, {}, {}};
    for (int i = 0; i < count; ++i) slice.open.push_back({i % 900 + 0.5, i / 900 + 0.25});
    if (count > 0) liver.slices = {slice};
    points.structures = {liver};
    return points;
  }
  test::TemporaryFolder folder_;
  fs::path file_ = AutosavePath(folder_.Path() / "points.json");
};

TEST_F(Autosave, IsWrittenFoundAndDiscarded) {
  EXPECT_EQ(file_.filename(), "points.json.autosave");
  const std::string text = FormatControlPoints(MakePoints(7));
  EXPECT_FALSE(FindAutosaved(file_, "")->has_value());
  {
    ContourAutosave autosave(file_, ContourAutosave::Period(1));
    autosave.Offer("out of date");
    autosave.Offer(text);
  }
  const auto found = FindAutosaved(file_, "other text");
  ASSERT_TRUE(found.ok());
  ASSERT_TRUE(found->has_value());
  EXPECT_EQ(FormatControlPoints(**found), text);
  EXPECT_FALSE(FindAutosaved(file_, text)->has_value()) << "the file says the same";
  ContourAutosave autosave(file_);
  autosave.Offer(text);
  autosave.Discard();
  EXPECT_FALSE(fs::exists(file_));
}

TEST_F(Autosave, ChangesWithinAPeriodAreWrittenTogether) {
  ContourAutosave autosave(file_, std::chrono::milliseconds(200));
  for (int i = 0; i < 50; ++i) autosave.Offer(std::to_string(i));
  for (int i = 0; i < 500 && autosave.WrittenCount() < 1; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  autosave.Offer("last");
  for (int i = 0; i < 500 && *host::ReadFile(file_) != "last"; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(*host::ReadFile(file_), "last");
  EXPECT_LE(autosave.WrittenCount(), 3u);
  EXPECT_TRUE(autosave.LastStatus().ok());
}

TEST_F(Autosave, WhatCannotBeReadIsKeptAside) {
  ASSERT_TRUE(host::WriteFile(file_, "{\"format\": 3}").ok());
  const auto found = FindAutosaved(file_, "");
  ASSERT_FALSE(found.ok());
  EXPECT_FALSE(fs::exists(file_));
  EXPECT_TRUE(fs::exists(fs::path(file_.string() + ".unreadable")));
}

TEST_F(Autosave, AFolderThatCannotBeWrittenIsAStatus) {
  ASSERT_TRUE(host::WriteFile(folder_.Path() / "file", "x").ok());
  ContourAutosave autosave(folder_.Path() / "file" / "points.json.autosave", ContourAutosave::Period(1));
  autosave.Offer("text");
  for (int i = 0; i < 500 && autosave.LastStatus().ok(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ASSERT_FALSE(autosave.LastStatus().ok());
  EXPECT_EQ(autosave.LastStatus().error().code, base::ErrorCode::kFileUnwritable);
}

// a program that is killed while it saves leaves a whole document, whatever the moment
TEST_F(Autosave, KilledInTheMiddleOfASaveLeavesAWholeDocument) {
  // texts of very different length, made before the fork: the child only writes
  const std::string texts[] = {FormatControlPoints(MakePoints(9000)), FormatControlPoints(MakePoints(10))};
  ASSERT_TRUE(host::WriteFile(file_, texts[1]).ok());
  for (int round = 0; round < 25; ++round) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      for (int i = 0;; ++i) (void)host::WriteFile(file_, texts[i % 2]).ok();
    }
    std::this_thread::sleep_for(std::chrono::microseconds(1500 + 700 * round));
    ::kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
    const auto text = host::ReadFile(file_);
    ASSERT_TRUE(text.ok());
    ASSERT_TRUE(*text == texts[0] || *text == texts[1]) << "round " << round;
    const auto found = FindAutosaved(file_, "");
    ASSERT_TRUE(found.ok() && found->has_value());
  }
}

}  // namespace
}  // namespace trocar::contours
