// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/window_sound.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "trocar/host/json.h"
#include "trocar/host/json_text.h"
#include "trocar/host/log.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/translate.h"
#include "trocar/host/user_folder.h"

namespace trocar::presenter {
namespace {

constexpr const char* kSoundFormat = "trocar-sound-settings";
constexpr int kSoundVersion = 1;
constexpr double kVolumeStep = 0.1;

}  // namespace

LoadedSoundSettings LoadSoundSettings(const std::filesystem::path& file) {
  LoadedSoundSettings loaded;
  const auto document = host::JsonDocument::Read(file);
  if (!document) {
    if (document.error().code != base::ErrorCode::kFileMissing) loaded.complaint = document.error();
    return loaded;
  }
  const host::JsonView root = document->Root();
  root.AllowOnly({"format", "version", "volume", "muted", "speech"});
  if (root.Text("format") != kSoundFormat) root.Complain("is no file of the window's sound");
  root.Integer("version", {kSoundVersion, kSoundVersion});
  sound::SoundSettings settings;
  settings.volume = root.NumberOr("volume", settings.volume, {0, 1});
  settings.is_muted = root.BooleanOr("muted", settings.is_muted);
  settings.has_speech = root.BooleanOr("speech", settings.has_speech);
  if (const base::Status good = document->Check(); !good) {
    loaded.complaint = good.error();
  } else {
    loaded.settings = settings;
  }
  return loaded;
}

base::Status SaveSoundSettings(const std::filesystem::path& file, const sound::SoundSettings& settings) {
  const nlohmann::ordered_json json = {{"format", kSoundFormat},
                                       {"version", kSoundVersion},
                                       {"volume", settings.volume},
                                       {"muted", settings.is_muted},
                                       {"speech", settings.has_speech}};
  std::error_code ignored;
  ignored = host::MakeFolders(file.parent_path());
  return host::WriteFile(file, host::FormatJson(json, 2) + "\n");
}

WindowSound::WindowSound(std::filesystem::path file, const std::string& output)
    : file_(std::move(file)), player_(output) {
  if (!file_.empty()) {
    LoadedSoundSettings loaded = LoadSoundSettings(file_);
    settings_ = loaded.settings;
    if (loaded.complaint) {
      host::Log(host::LogLevel::kWarning, loaded.complaint->Text());
      file_.clear();  // it stays as it is, for whoever can mend it
    }
  }
  player_.SetSettings(settings_);
  if (std::string program = sound::FindSpeechProgram(); !program.empty()) {
    speaker_ = std::make_unique<sound::Speaker>(
        std::move(program), [this](std::vector<float> samples) { player_.Say(std::move(samples)); });
  }
}

void WindowSound::Hear(const scene::Scene& scene, const simulation::Snapshot& snapshot,
                       const scene::Input& input, bool is_running) {
  player_.SetState(ear_.Listen(scene, snapshot, input, is_running));
}

void WindowSound::Rest() {
  ear_ = {};
  player_.SetState({});
}

void WindowSound::Say(const std::string& text) {
  if (text == said_) return;
  said_ = text;
  if (text.empty() || !settings_.has_speech || settings_.is_muted || speaker_ == nullptr) return;
  speaker_->Say(text, host::Translate("en"));  // the catalogue's language
}

void WindowSound::Set(const sound::SoundSettings& settings) {
  if (settings == settings_) return;
  settings_ = settings;
  settings_.volume = std::clamp(settings.volume, 0.0, 1.0);
  player_.SetSettings(settings_);
  if (!settings_.has_speech) player_.Say({});
  if (file_.empty()) return;
  if (const base::Status saved = SaveSoundSettings(file_, settings_); !saved)
    host::Log(host::LogLevel::kWarning, saved.error().Text());
}

void WindowSound::ToggleMute() {
  sound::SoundSettings settings = settings_;
  settings.is_muted = !settings.is_muted;
  Set(settings);
}

void WindowSound::ToggleSpeech() {
  sound::SoundSettings settings = settings_;
  settings.has_speech = !settings.has_speech;
  Set(settings);
}

void WindowSound::ChangeVolume(int direction) {
  sound::SoundSettings settings = settings_;
  settings.is_muted = false;
  settings.volume = std::clamp(std::round(settings.volume / kVolumeStep + direction) * kVolumeStep, 0.0, 1.0);
  Set(settings);
}

std::string WindowSound::Describe() const {
  if (settings_.is_muted) return host::Translate("Sound off");
  std::string text = host::Translate("Sound ") + std::to_string(std::lround(100 * settings_.volume)) + " %";
  if (!settings_.has_speech) text += host::Translate(", no speech");
  const std::string why = player_.WhySilent();
  return why.empty() ? text : text + " (" + why + ")";
}

}  // namespace trocar::presenter
