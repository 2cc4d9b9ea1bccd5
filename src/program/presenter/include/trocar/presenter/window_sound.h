// SPDX-License-Identifier: Apache-2.0
/// \file window_sound.h  Sounds of the window and their volume, without a widget.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "trocar/base/result.h"
#include "trocar/sound/ear.h"
#include "trocar/sound/player.h"
#include "trocar/sound/speech.h"

namespace trocar::presenter {

struct LoadedSoundSettings {
  sound::SoundSettings settings;         ///< the usual ones where the file is missing or broken
  std::optional<base::Error> complaint;  ///< of a file that is there and cannot be used; it is kept
};
LoadedSoundSettings LoadSoundSettings(const std::filesystem::path& file);
/// \return the file's error
base::Status SaveSoundSettings(const std::filesystem::path& file, const sound::SoundSettings& settings);

/// Plays beside the window, which never waits for it. Without a sound card it is silent.
class WindowSound {
 public:
  /// \param file    where the settings are kept ("sound.json" beside window.json); empty: nowhere
  /// \param output  as sound::Player
  explicit WindowSound(std::filesystem::path file, const std::string& output = sound::kSoundCard);

  /// Plays the sounds of the state that is shown; called once a frame.
  void Hear(const scene::Scene& scene, const simulation::Snapshot& snapshot, const scene::Input& input,
            bool is_running);
  /// Nothing is shown.
  void Rest();
  /// Speaks a text that is not the one of before; nothing where speech is off or the words are empty.
  void Say(const std::string& text);

  const sound::SoundSettings& Settings() const { return settings_; }
  /// Acts at once and is kept.
  void Set(const sound::SoundSettings& settings);
  void ToggleMute();
  void ToggleSpeech();
  /// By a tenth, and no longer mute. \param direction  1 or -1
  void ChangeVolume(int direction);
  /// "Sound 60 %", "Sound off", "Sound 60 % (no sound: this computer has no sound card)"
  std::string Describe() const;

 private:
  std::filesystem::path file_;
  sound::SoundSettings settings_;
  sound::Ear ear_;
  sound::Player player_;
  std::unique_ptr<sound::Speaker> speaker_;  // null without espeak-ng; it ends before the player
  std::string said_;
};

}  // namespace trocar::presenter
