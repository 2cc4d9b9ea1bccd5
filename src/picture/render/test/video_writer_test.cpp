// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/video_writer.h"

#include <gst/app/gstappsink.h>
#include <gst/gst.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "trocar_test/temporary_folder.h"

namespace trocar::render {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 101, kHeight = 66;  // odd, so that rows need padding

Image MakePlain(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  Image image{kWidth, kHeight, {}};
  for (int i = 0; i < kWidth * kHeight; ++i) image.pixels.insert(image.pixels.end(), {r, g, b});
  return image;
}

struct DecodedFrame {
  int width, height;
  std::array<std::uint8_t, 3> middle;
  double time;
};

/// Oracle: GStreamer's own demuxer and decoder.
std::vector<DecodedFrame> Decode(const fs::path& path) {
  gst_init(nullptr, nullptr);
  GstElement* pipeline = gst_parse_launch(
      "filesrc name=file ! matroskademux ! vp8dec ! videoconvert ! video/x-raw,format=RGB ! appsink "
      "name=sink sync=false",
      nullptr);
  GstElement* file = gst_bin_get_by_name(GST_BIN(pipeline), "file");
  g_object_set(file, "location", path.c_str(), nullptr);
  gst_object_unref(file);
  GstElement* sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  std::vector<DecodedFrame> frames;
  while (GstSample* sample = gst_app_sink_try_pull_sample(GST_APP_SINK(sink), 20 * GST_SECOND)) {
    DecodedFrame frame{};
    const GstStructure* format = gst_caps_get_structure(gst_sample_get_caps(sample), 0);
    gst_structure_get_int(format, "width", &frame.width);
    gst_structure_get_int(format, "height", &frame.height);
    GstBuffer* buffer = gst_sample_get_buffer(sample);
    const std::size_t stride = (3u * static_cast<std::size_t>(frame.width) + 3u) & ~std::size_t{3};
    gst_buffer_extract(
        buffer,
        stride * static_cast<std::size_t>(frame.height / 2) + 3u * static_cast<std::size_t>(frame.width / 2),
        frame.middle.data(), 3);
    frame.time = static_cast<double>(GST_BUFFER_PTS(buffer)) / static_cast<double>(GST_SECOND);
    frames.push_back(frame);
    gst_sample_unref(sample);
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(sink);
  gst_object_unref(pipeline);
  return frames;
}

TEST(VideoWriter, FileHoldsEveryFrameInOrder) {
  const test::TemporaryFolder folder;
  const fs::path path = folder.Path() / "new" / "it's a video.webm";
  auto writer = VideoWriter::Make(path, {kWidth, kHeight, 25, 2'000'000});
  ASSERT_TRUE(writer.ok()) << writer.error().Text();
  for (int i = 0; i < 12; ++i) {
    const auto grey = static_cast<std::uint8_t>(40 + 15 * i);
    ASSERT_TRUE(writer->AddFrame(MakePlain(grey, grey, grey)).ok());
  }
  EXPECT_FALSE(fs::exists(path));
  ASSERT_TRUE(writer->Finish().ok());
  const auto frames = Decode(path);
  ASSERT_EQ(frames.size(), 12u);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].width, kWidth);
    EXPECT_EQ(frames[i].height, kHeight);
    EXPECT_NEAR(frames[i].middle[1], 40 + 15 * static_cast<int>(i), 12);
    EXPECT_NEAR(frames[i].time, static_cast<double>(i) / 25, 0.002);
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(path.parent_path()), fs::directory_iterator()), 1);
}

TEST(VideoWriter, LeavesNothingWhenItIsNotFinished) {
  const test::TemporaryFolder folder;
  {
    auto writer = VideoWriter::Make(folder.Path() / "a.webm", {kWidth, kHeight, 25, 2'000'000});
    ASSERT_TRUE(writer.ok()) << writer.error().Text();
    ASSERT_TRUE(writer->AddFrame(MakePlain(9, 9, 9)).ok());
  }
  EXPECT_TRUE(fs::is_empty(folder.Path()));
}

TEST(VideoWriter, RefusesAWrongSizeAnEmptyVideoAndASecondEnd) {
  const test::TemporaryFolder folder;
  auto writer = VideoWriter::Make(folder.Path() / "a.webm", {kWidth, kHeight, 25, 2'000'000});
  ASSERT_TRUE(writer.ok()) << writer.error().Text();
  EXPECT_EQ(writer->Finish().error().code, base::ErrorCode::kVideoFailed);
  Image small = MakePlain(1, 2, 3);
  small.width -= 1;
  EXPECT_EQ(writer->AddFrame(small).error().code, base::ErrorCode::kVideoFailed);
  ASSERT_TRUE(writer->AddFrame(MakePlain(1, 2, 3)).ok());
  ASSERT_TRUE(writer->Finish().ok());
  EXPECT_EQ(writer->Finish().error().code, base::ErrorCode::kVideoFailed);
  EXPECT_EQ(writer->AddFrame(MakePlain(1, 2, 3)).error().code, base::ErrorCode::kVideoFailed);
}

TEST(VideoWriter, RefusesAFolderThatIsAFileAndSettingsOutOfRange) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.Path() / "plain") << "x";
  EXPECT_EQ(VideoWriter::Make(folder.Path() / "plain" / "a.webm", {kWidth, kHeight, 25}).error().code,
            base::ErrorCode::kVideoFailed);
  EXPECT_EQ(VideoWriter::Make(folder.Path() / "a.webm", {0, kHeight, 25}).error().code,
            base::ErrorCode::kVideoFailed);
  EXPECT_EQ(VideoWriter::Make(folder.Path() / "a.webm", {kWidth, kHeight, 0}).error().code,
            base::ErrorCode::kVideoFailed);
  EXPECT_FALSE(fs::exists(folder.Path() / "a.webm"));
}

/// In a process of its own: prints the error's text.
/// \return 0, or 1 when there was none
int MakeWithoutPlugins() {
  const test::TemporaryFolder folder;
  ::setenv("GST_PLUGIN_SYSTEM_PATH_1_0", folder.Path().c_str(), 1);
  ::setenv("GST_PLUGIN_PATH_1_0", folder.Path().c_str(), 1);
  ::setenv("GST_REGISTRY_1_0", (folder.Path() / "registry.bin").c_str(), 1);
  const auto writer = VideoWriter::Make(folder.Path() / "a.webm", {kWidth, kHeight, 25});
  if (!writer.ok()) std::fputs(writer.error().Text().c_str(), stderr);
  return writer.ok() ? 1 : 0;
}

TEST(VideoWriterDeathTest, MissingPluginNamesItsPackage) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(std::exit(MakeWithoutPlugins()), testing::ExitedWithCode(0),
              "E-VID-001.*install gstreamer1.0-plugins");
}

}  // namespace
}  // namespace trocar::render
