// SPDX-License-Identifier: Apache-2.0
/// \file synthesiser.h  Tones of the electrosurgical unit, of the clip applier and of the patient's monitor, as samples. Knows no
/// sound card.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/sound/vital_signs.h"

namespace trocar::sound {

/// Tone of the electrosurgical unit: each current has its own pitch.
enum class EnergyTone : std::uint8_t { kNone, kCut, kCoagulation };
inline constexpr double kCutPitch = 660, kCoagulationPitch = 440;  ///< [Hz]

/// Sounds to be heard now.
struct SoundState {
  EnergyTone energy = EnergyTone::kNone;
  std::uint64_t clicks = 0;  ///< of clip appliers, since the start; each more is heard once
  bool has_pulse = false;    ///< the monitor is on
  VitalSigns signs;
};

/// Sound settings of a person.
struct SoundSettings {
  double volume = 0.5;    ///< 0 to 1 [-]
  bool is_muted = false;  ///< volume stays for later
  bool has_speech = true;

  friend bool operator==(const SoundSettings&, const SoundSettings&) = default;
};

inline constexpr int kSampleRate = 48000;  ///< [1/s]

/// One channel of samples from -1 to 1. All levels move in ramps, so that nothing but a clip applier clicks.
class Synthesiser {
 public:
  /// The sum of all voices at their loudest, and never more.
  static constexpr float kLoudest = 0.95F;

  void SetState(const SoundState& state) noexcept;
  void SetSettings(const SoundSettings& settings) noexcept { settings_ = settings; }
  /// Speaks in place of what was being spoken.
  /// \param samples  -1 to 1, kSampleRate
  void Say(std::vector<float> samples);
  bool IsSpeaking() const noexcept { return spoken_ < speech_.size(); }

  /// The next samples.
  /// \note Allocates nothing.
  void Render(std::span<float> samples) noexcept;

 private:
  double RenderEnergy() noexcept;
  double RenderClick() noexcept;
  double RenderPulse() noexcept;
  double RenderSpeech() noexcept;

  SoundState state_;
  SoundSettings settings_;
  double gain_ = 0;                             // moves towards the volume
  double energy_level_ = 0, energy_phase_ = 0;  // [-], [turns]
  double energy_pitch_ = kCutPitch;             // [Hz]
  std::uint64_t clicked_ = 0;                   // of SoundState::clicks
  bool knows_clicks_ = false;
  std::size_t click_sample_ = 0;             // since it began; 0: none sounds
  double beat_phase_ = 0, pulse_phase_ = 0;  // [turns]
  double pulse_pitch_ = 0;                   // of the beep that sounds [Hz]
  std::size_t pulse_sample_ = 0;             // since it began; 0: none sounds
  std::vector<float> speech_;
  std::size_t spoken_ = 0;
};

}  // namespace trocar::sound
