// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/film_job.h"

#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include "recorded_attempt.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::presenter {
namespace {

namespace fs = std::filesystem;

TEST(NamePicture, NeverNamesAFileThatIsThere) {
  const test::TemporaryFolder folder;
  const auto now = std::chrono::system_clock::now();
  const fs::path first = NamePicture(folder.Path(), now, ".png");
  EXPECT_EQ(first.filename().string().rfind("trocar-20", 0), 0u);
  std::ofstream(first) << "x";
  const fs::path second = NamePicture(folder.Path(), now, ".png");
  EXPECT_NE(first, second);
  std::ofstream(second) << "x";
  EXPECT_EQ(NamePicture(folder.Path(), now, ".png").filename().string(), first.stem().string() + "-3.png");
  EXPECT_EQ(PictureFolder("/home/a/Pictures"), fs::path("/home/a/Pictures/Trocar"));
}

class FilmJobTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    test::RecordAttempt(File("attempt.trocar"), test::DescribeTask("peg_transfer", "normal", 3, "expert"),
                        {.surgeon = "expert", .ticks = 600, .after_tick = {}});
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static fs::path File(const char* name) { return folder_->Path() / name; }
  static FilmRequest Request(const char* video) {
    FilmRequest request;
    request.recording = File("attempt.trocar");
    request.video = File(video);
    request.width = 160, request.height = 90;
    return request;
  }

  static test::TemporaryFolder* folder_;
  gui::JobProgress progress_;
  std::atomic<bool> is_cancelled_ = false;
};
test::TemporaryFolder* FilmJobTest::folder_ = nullptr;

// 600 ticks are 5 s.
TEST_F(FilmJobTest, ClipHoldsTheLastSecondsAtThirtyPicturesASecond) {
  FilmRequest request = Request("clip.webm");
  request.last_seconds = 2;
  const auto film = MakeFilm(request, progress_, is_cancelled_);
  ASSERT_TRUE(film.ok()) << film.error().Text();
  EXPECT_NEAR(film->from, 3, 1e-9);
  EXPECT_NEAR(film->until, 5, 1e-9);
  EXPECT_EQ(film->frames, 60u);
  EXPECT_EQ(progress_.Get().fraction, 1);
  EXPECT_GT(fs::file_size(request.video), 1000u);
  // EBML, what every WebM file begins with
  std::string magic(4, ' ');
  std::ifstream(request.video, std::ios::binary).read(magic.data(), 4);
  EXPECT_EQ(magic, "\x1a\x45\xdf\xa3");
}

TEST_F(FilmJobTest, LongerThanTheRecordingIsTheWholeOfIt) {
  FilmRequest request = Request("whole.webm");
  request.last_seconds = kClipSeconds;
  request.until = 0.5;
  const auto film = MakeFilm(request, progress_, is_cancelled_);
  ASSERT_TRUE(film.ok()) << film.error().Text();
  EXPECT_EQ(film->from, 0);
  EXPECT_EQ(film->frames, 15u);
}

TEST_F(FilmJobTest, CancelLeavesNothing) {
  const FilmRequest request = Request("cancelled.webm");
  std::thread impatient([this] {
    while (progress_.Get().what != "Drawing") std::this_thread::sleep_for(std::chrono::milliseconds(1));
    is_cancelled_ = true;
  });
  const auto film = MakeFilm(request, progress_, is_cancelled_);
  impatient.join();
  ASSERT_FALSE(film.ok());
  EXPECT_EQ(film.error().code, base::ErrorCode::kCancelled);
  EXPECT_LT(progress_.Get().fraction, 1);
  for (const auto& entry : fs::directory_iterator(folder_->Path()))
    EXPECT_EQ(entry.path().string().find("cancelled"), std::string::npos) << entry.path();
}

TEST_F(FilmJobTest, RefusesAMissingRecordingAnEmptyPartAndAFolderThatIsAFile) {
  FilmRequest request = Request("a.webm");
  request.recording = File("none.trocar");
  EXPECT_EQ(MakeFilm(request, progress_, is_cancelled_).error().code, base::ErrorCode::kFileMissing);
  request = Request("a.webm");
  request.from = 60;
  EXPECT_EQ(MakeFilm(request, progress_, is_cancelled_).error().code, base::ErrorCode::kUsage);
  request = Request("attempt.trocar/a.webm");
  EXPECT_EQ(MakeFilm(request, progress_, is_cancelled_).error().code, base::ErrorCode::kVideoFailed);
}

}  // namespace
}  // namespace trocar::presenter
