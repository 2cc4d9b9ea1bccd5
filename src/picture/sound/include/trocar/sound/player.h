// SPDX-License-Identifier: Apache-2.0
/// \file player.h  Plays the synthesiser through GStreamer.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "trocar/sound/synthesiser.h"

namespace trocar::sound {

/// Sound output of this computer: "PulseAudio or PipeWire", "ALSA: the card's name"; empty where there is none. Opens nothing:
/// libraries of sound complain on standard error where there is no card.
/// \param root  of the file system, for tests
std::string FindSoundOutput(const std::filesystem::path& root = "/");

/// GStreamer elements that play on whatever FindSoundOutput() found.
inline constexpr const char* kSoundCard = "autoaudiosink";

/// Plays in threads of its own; whoever calls never waits. Where nothing can be heard it is silent and says why.
class Player {
 public:
  /// \param output  GStreamer elements at the end of the pipeline; kSoundCard needs FindSoundOutput()
  explicit Player(std::string output = kSoundCard);
  Player(const Player&) = delete;
  Player& operator=(const Player&) = delete;
  ~Player();

  void SetState(const SoundState& state);
  void SetSettings(const SoundSettings& settings);
  void Say(std::vector<float> samples);

  /// Why nothing is heard and what would mend it; empty while it plays, or is about to.
  std::string WhySilent() const;
  /// Waits until no more samples are asked for or `seconds` have passed; for tests that write files.
  bool WaitForEnd(double seconds);

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::sound
