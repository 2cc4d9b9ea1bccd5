// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/video_writer.h"

#include <gst/app/gstappsrc.h>
#include <gst/gst.h>
#include <unistd.h>

#include <system_error>
#include <utility>

namespace trocar::render {
namespace {

namespace fs = std::filesystem;

constexpr GstClockTime kPatience = 60 * GST_SECOND;  // for the encoder's last frames
constexpr GstClockTime kPollInterval = 10 * GST_MSECOND;
constexpr guint64 kMaxQueuedBytes = 16u << 20;  // about six frames of 1280 x 720

base::Error Failed(const fs::path& path, const std::string& why) {
  return {base::ErrorCode::kVideoFailed, path.string() + ": " + why};
}

/// Element of the pipeline and the Debian package that brings it.
struct Plugin {
  const char* element;
  const char* package;
};
constexpr Plugin kPlugins[] = {{"appsrc", "gstreamer1.0-plugins-base"},
                               {"videoconvert", "gstreamer1.0-plugins-base"},
                               {"vp8enc", "gstreamer1.0-plugins-good"},
                               {"webmmux", "gstreamer1.0-plugins-good"},
                               {"filesink", "libgstreamer1.0-0"}};

}  // namespace

struct VideoWriter::Content {
  fs::path path, part;
  VideoSettings settings;
  GstElement* pipeline = nullptr;
  GstElement* source = nullptr;
  GstElement* sink = nullptr;
  std::uint64_t frames = 0;
  bool is_ended = false;     // the last byte is on disk
  bool is_finished = false;  // and the file has its name

  Content() = default;
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;
  ~Content() {
    Close();
    std::error_code ignored;
    if (!part.empty() && !is_finished) fs::remove(part, ignored);
  }

  void Close() {
    if (pipeline == nullptr) return;
    gst_element_set_state(pipeline, GST_STATE_NULL);
    gst_object_unref(source);
    gst_object_unref(sink);
    gst_object_unref(pipeline);
    pipeline = source = sink = nullptr;
  }

  /// Waits for an error (returned as text) or the end of the stream (sets is_ended).
  std::string PopError(GstClockTime timeout) {
    GstBus* bus = gst_element_get_bus(pipeline);
    GstMessage* message = gst_bus_timed_pop_filtered(
        bus, timeout, static_cast<GstMessageType>(GST_MESSAGE_ERROR | GST_MESSAGE_EOS));
    gst_object_unref(bus);
    if (message == nullptr) return {};
    std::string text;
    is_ended = GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS;
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
      GError* error = nullptr;
      gst_message_parse_error(message, &error, nullptr);
      text = error == nullptr ? "the encoder failed" : error->message;
      g_clear_error(&error);
    }
    gst_message_unref(message);
    return text;
  }
};

VideoWriter::VideoWriter(std::unique_ptr<Content> content) : content_(std::move(content)) {}
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;
VideoWriter::~VideoWriter() = default;

base::Result<VideoWriter> VideoWriter::Make(const fs::path& path, const VideoSettings& settings) {
  if (settings.width < 16 || settings.width > 4096 || settings.height < 16 || settings.height > 4096 ||
      settings.frames_per_second < 1 || settings.frames_per_second > 240 || settings.bits_per_second < 1) {
    return Failed(path, "a size of 16 to 4096 pixels a side and 1 to 240 frames a second are needed");
  }
  GError* init_error = nullptr;
  if (gst_init_check(nullptr, nullptr, &init_error) == FALSE) {
    const std::string why = init_error == nullptr ? "unknown reason" : init_error->message;
    g_clear_error(&init_error);
    return Failed(path, "GStreamer does not start: " + why + "; install libgstreamer1.0-0");
  }
  for (const Plugin& plugin : kPlugins) {
    GstElementFactory* factory = gst_element_factory_find(plugin.element);
    if (factory == nullptr) {
      return Failed(path, std::string("GStreamer has no element ") + plugin.element + "; install " +
                              plugin.package + " (apt-get install " + plugin.package + ")");
    }
    gst_object_unref(factory);
  }

  auto content = std::make_unique<Content>();
  content->path = path;
  content->settings = settings;
  std::error_code folder_error;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), folder_error);
  if (folder_error) return Failed(path, "its folder cannot be made: " + folder_error.message());
  content->part = path;
  content->part += ".part" + std::to_string(::getpid());

  // names and numbers go in as properties, never as text of the description, so that a quote in a path is
  // harmless
  GError* parse_error = nullptr;
  content->pipeline = gst_parse_launch(
      "appsrc name=source format=time block=false max-bytes=0 ! videoconvert ! "
      "vp8enc name=encoder deadline=1 cpu-used=8 threads=2 end-usage=vbr keyframe-max-dist=60 ! "
      "webmmux ! filesink name=sink",
      &parse_error);
  if (content->pipeline == nullptr || parse_error != nullptr) {
    const std::string why = parse_error == nullptr ? "unknown reason" : parse_error->message;
    g_clear_error(&parse_error);
    if (content->pipeline != nullptr) gst_object_unref(std::exchange(content->pipeline, nullptr));
    return Failed(path,
                  "the GStreamer pipeline cannot be made: " + why + "; install gstreamer1.0-plugins-good");
  }
  content->source = gst_bin_get_by_name(GST_BIN(content->pipeline), "source");
  content->sink = gst_bin_get_by_name(GST_BIN(content->pipeline), "sink");
  GstElement* encoder = gst_bin_get_by_name(GST_BIN(content->pipeline), "encoder");
  g_object_set(encoder, "target-bitrate", settings.bits_per_second, nullptr);
  gst_object_unref(encoder);
  g_object_set(content->sink, "location", content->part.c_str(), nullptr);
  GstCaps* caps = gst_caps_new_simple("video/x-raw", "format", G_TYPE_STRING, "RGB", "width", G_TYPE_INT,
                                      settings.width, "height", G_TYPE_INT, settings.height, "framerate",
                                      GST_TYPE_FRACTION, settings.frames_per_second, 1, nullptr);
  g_object_set(content->source, "caps", caps, nullptr);
  gst_caps_unref(caps);
  if (gst_element_set_state(content->pipeline, GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE) {
    const std::string why = content->PopError(GST_SECOND);
    return Failed(path,
                  (why.empty() ? "the pipeline does not start" : why) + "; check the folder and its rights");
  }
  return VideoWriter(std::move(content));
}

base::Status VideoWriter::AddFrame(const Image& image) {
  Content& c = *content_;
  if (c.pipeline == nullptr) return Failed(c.path, "the video was finished before this frame");
  if (image.width != c.settings.width || image.height != c.settings.height) {
    return Failed(c.path, "a frame has " + std::to_string(image.width) + " x " +
                              std::to_string(image.height) + " pixels instead of " +
                              std::to_string(c.settings.width) + " x " + std::to_string(c.settings.height));
  }
  // not appsrc's own blocking: that would wait for ever behind an encoder that failed
  while (gst_app_src_get_current_level_bytes(GST_APP_SRC(c.source)) > kMaxQueuedBytes) {
    const std::string why = c.PopError(kPollInterval);
    if (!why.empty()) return Failed(c.path, why + "; check the folder and the space left");
  }
  // GStreamer expects rows that start at multiples of four bytes
  const std::size_t row = 3 * static_cast<std::size_t>(image.width), stride = (row + 3) & ~std::size_t{3};
  GstBuffer* buffer =
      gst_buffer_new_allocate(nullptr, stride * static_cast<std::size_t>(image.height), nullptr);
  if (buffer == nullptr) return Failed(c.path, "no memory for a frame");
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
    gst_buffer_fill(buffer, y * stride, image.pixels.data() + y * row, row);
  }
  const auto rate = static_cast<std::uint64_t>(c.settings.frames_per_second);
  GST_BUFFER_PTS(buffer) = gst_util_uint64_scale(c.frames, GST_SECOND, rate);
  GST_BUFFER_DURATION(buffer) =
      gst_util_uint64_scale(c.frames + 1, GST_SECOND, rate) - GST_BUFFER_PTS(buffer);
  const bool is_taken = gst_app_src_push_buffer(GST_APP_SRC(c.source), buffer) == GST_FLOW_OK;
  const std::string why = c.PopError(0);
  if (!is_taken || !why.empty()) return Failed(c.path, why.empty() ? "the encoder takes no frame" : why);
  ++c.frames;
  return {};
}

base::Status VideoWriter::Finish() {
  Content& c = *content_;
  if (c.pipeline == nullptr) return Failed(c.path, "the video was finished before");
  if (c.frames == 0) return Failed(c.path, "the video has no frame");
  gst_app_src_end_of_stream(GST_APP_SRC(c.source));
  const std::string why = c.PopError(kPatience);
  c.Close();
  if (why.empty() && !c.is_ended)
    return Failed(c.path, "the encoder did not end within 60 s; the machine is overloaded");
  if (!why.empty()) return Failed(c.path, why + "; check the folder and the space left");
  std::error_code rename_error;
  fs::rename(c.part, c.path, rename_error);
  if (rename_error) return Failed(c.path, rename_error.message() + "; check the folder and its rights");
  c.is_finished = true;
  return {};
}

}  // namespace trocar::render
