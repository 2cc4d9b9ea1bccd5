// SPDX-License-Identifier: Apache-2.0
#include "trocar/sound/player.h"

#include <gst/app/gstappsrc.h>
#include <gst/gst.h>

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

namespace trocar::sound {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBlock = kSampleRate / 100;             // samples that are made at a time: 10 ms
constexpr gint64 kCardBuffer = 40'000, kCardPeriod = 10'000;  // of the card: how late it may sound [us]

bool Exists(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

/// The card must not hold back a fifth of a second, as its usual buffer does.
void ShortenBuffer(GstBin*, GstBin*, GstElement* element, gpointer) {
  GObjectClass* type = G_OBJECT_GET_CLASS(element);
  if (g_object_class_find_property(type, "buffer-time") == nullptr) return;
  g_object_set(element, "buffer-time", kCardBuffer, "latency-time", kCardPeriod, nullptr);
}

}  // namespace

std::string FindSoundOutput(const fs::path& root) {
  if (const char* server = std::getenv("PULSE_SERVER"); server != nullptr && *server != '\0')
    return std::string("PulseAudio at ") + server;
  if (const char* runtime = std::getenv("XDG_RUNTIME_DIR"); runtime != nullptr && *runtime != '\0') {
    const fs::path folder = root / fs::path(runtime).relative_path();
    if (Exists(folder / "pulse/native") || Exists(folder / "pipewire-0")) return "PulseAudio or PipeWire";
  }
  // " 0 [PCH            ]: HDA-Intel - HDA Intel PCH", or "--- no soundcards ---"
  std::ifstream cards(root / "proc/asound/cards");
  std::string line;
  if (std::getline(cards, line) && line.find("]: ") != std::string::npos)
    return "ALSA: " + line.substr(line.find("]: ") + 3);
  return {};
}

struct Player::Content {
  std::mutex mutex;  // of all but the pipeline
  std::condition_variable changed;
  Synthesiser synthesiser;
  std::string why_silent;
  bool is_ending = false, has_ended = false;
  std::uint64_t made = 0;  // samples
  std::thread thread;

  void Fail(const std::string& why) {
    const std::lock_guard lock(mutex);
    why_silent = why;
    has_ended = true;
    changed.notify_all();
  }

  static void GiveBlock(GstAppSrc* source, guint, gpointer self);
  void Play(const std::string& output);
  void WaitOnBus(GstElement* pipeline);
};

/// Called by the pipeline's thread when it wants more.
void Player::Content::GiveBlock(GstAppSrc* source, guint, gpointer self) {
  Content& content = *static_cast<Content*>(self);
  std::array<float, kBlock> samples;
  std::uint64_t first = 0;
  {
    const std::lock_guard lock(content.mutex);
    content.synthesiser.Render(samples);
    first = std::exchange(content.made, content.made + kBlock);
  }
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, sizeof samples, nullptr);
  if (buffer == nullptr) return;
  gst_buffer_fill(buffer, 0, samples.data(), sizeof samples);
  GST_BUFFER_PTS(buffer) = gst_util_uint64_scale(first, GST_SECOND, kSampleRate);
  GST_BUFFER_DURATION(buffer) = gst_util_uint64_scale(kBlock, GST_SECOND, kSampleRate);
  gst_app_src_push_buffer(source, buffer);
}

void Player::Content::WaitOnBus(GstElement* pipeline) {
  GstBus* bus = gst_element_get_bus(pipeline);
  for (bool goes_on = true; goes_on;) {
    GstMessage* message = gst_bus_timed_pop_filtered(
        bus, 50 * GST_MSECOND, static_cast<GstMessageType>(GST_MESSAGE_ERROR | GST_MESSAGE_EOS));
    if (message != nullptr) {
      goes_on = false;
      if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
        GError* error = nullptr;
        gst_message_parse_error(message, &error, nullptr);
        Fail(std::string("no sound: ") + (error == nullptr ? "the sound card failed" : error->message) +
             "; trocar doctor says what takes sound here");
        g_clear_error(&error);
      } else {
        const std::lock_guard lock(mutex);
        has_ended = true;
        changed.notify_all();
      }
      gst_message_unref(message);
    }
    const std::lock_guard lock(mutex);
    goes_on = goes_on && !is_ending;
  }
  gst_object_unref(bus);
}

void Player::Content::Play(const std::string& output) {
  if (output == kSoundCard && FindSoundOutput().empty())
    return Fail("no sound: this computer has no sound card");
  GError* error = nullptr;
  if (gst_init_check(nullptr, nullptr, &error) == FALSE) {
    g_clear_error(&error);
    return Fail("no sound: GStreamer does not start; install libgstreamer1.0-0");
  }
  GstElement* pipeline = gst_parse_launch(
      ("appsrc name=source format=time ! audioconvert ! audioresample ! " + output).c_str(), &error);
  if (pipeline == nullptr || error != nullptr) {
    const std::string why = error == nullptr ? "unknown reason" : error->message;
    g_clear_error(&error);
    if (pipeline != nullptr) gst_object_unref(pipeline);
    return Fail("no sound: " + why +
                "; install gstreamer1.0-plugins-good, gstreamer1.0-pulseaudio and gstreamer1.0-alsa");
  }
  g_signal_connect(pipeline, "deep-element-added", G_CALLBACK(ShortenBuffer), nullptr);
  GstElement* source = gst_bin_get_by_name(GST_BIN(pipeline), "source");
  GstCaps* caps =
      gst_caps_new_simple("audio/x-raw", "format", G_TYPE_STRING, "F32LE", "rate", G_TYPE_INT, kSampleRate,
                          "channels", G_TYPE_INT, 1, "layout", G_TYPE_STRING, "interleaved", nullptr);
  g_object_set(source, "caps", caps, "max-bytes", guint64{2 * kBlock * sizeof(float)}, nullptr);
  gst_caps_unref(caps);
  GstAppSrcCallbacks callbacks{};
  callbacks.need_data = &Content::GiveBlock;
  gst_app_src_set_callbacks(GST_APP_SRC(source), &callbacks, this, nullptr);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);  // an error is a message on the bus
  WaitOnBus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(source);
  gst_object_unref(pipeline);
}

Player::Player(std::string output) : content_(std::make_unique<Content>()) {
  content_->thread =
      std::thread([content = content_.get(), output = std::move(output)] { content->Play(output); });
}

Player::~Player() {
  {
    const std::lock_guard lock(content_->mutex);
    content_->is_ending = true;
  }
  content_->thread.join();
}

void Player::SetState(const SoundState& state) {
  const std::lock_guard lock(content_->mutex);
  content_->synthesiser.SetState(state);
}

void Player::SetSettings(const SoundSettings& settings) {
  const std::lock_guard lock(content_->mutex);
  content_->synthesiser.SetSettings(settings);
}

void Player::Say(std::vector<float> samples) {
  const std::lock_guard lock(content_->mutex);
  content_->synthesiser.Say(std::move(samples));
}

std::string Player::WhySilent() const {
  const std::lock_guard lock(content_->mutex);
  return content_->why_silent;
}

bool Player::WaitForEnd(double seconds) {
  std::unique_lock lock(content_->mutex);
  return content_->changed.wait_for(lock, std::chrono::duration<double>(seconds),
                                    [this] { return content_->has_ended; });
}

}  // namespace trocar::sound
