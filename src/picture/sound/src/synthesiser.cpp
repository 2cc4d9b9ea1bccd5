// SPDX-License-Identifier: Apache-2.0
#include "trocar/sound/synthesiser.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace trocar::sound {
namespace {

constexpr double kStep = 1.0 / kSampleRate;  // [s]
constexpr double kTurn = 2 * std::numbers::pi;

// loudest samples of the voices; their sum is kLoudest
constexpr double kEnergyLevel = 0.20, kClickLevel = 0.25, kPulseLevel = 0.20, kSpeechLevel = 0.30;
static_assert(kEnergyLevel + kClickLevel + kPulseLevel + kSpeechLevel < double(Synthesiser::kLoudest) + 1e-6);

constexpr double kEnergyRamp = 0.008, kGainRamp = 0.02;  // from nothing to full [s]
constexpr double kSecondHarmonic = 0.2;                  // share of it in the energy's tone
constexpr double kPulseSeconds = 0.09, kPulseRamp = 0.012;
constexpr double kClickPitch = 2200, kClickDecay = 0.005, kClickSeconds = 0.05;  // [Hz], [s], [s]

double MoveTowards(double value, double goal, double step) noexcept {
  return value < goal ? std::min(goal, value + step) : std::max(goal, value - step);
}

/// 0 to 1 and back without a corner at either end.
double RaisedCosine(double time, double length, double ramp) noexcept {
  const double from_end = std::min({time, length - time, ramp});
  return from_end <= 0 ? 0 : 0.5 * (1 - std::cos(std::numbers::pi * from_end / ramp));
}

double Advance(double& phase, double frequency) noexcept {
  phase += frequency * kStep;
  phase -= std::floor(phase);
  return phase;
}

}  // namespace

void Synthesiser::SetState(const SoundState& state) noexcept {
  // of clips that were closed before anybody listened, or before the scene began anew, nothing is heard
  if (!knows_clicks_ || state.clicks < clicked_) clicked_ = state.clicks;
  knows_clicks_ = true;
  state_ = state;
}

void Synthesiser::Say(std::vector<float> samples) {
  speech_ = std::move(samples);
  spoken_ = 0;
}

double Synthesiser::RenderEnergy() noexcept {
  const bool is_on = state_.energy != EnergyTone::kNone;
  if (is_on) energy_pitch_ = state_.energy == EnergyTone::kCut ? kCutPitch : kCoagulationPitch;
  energy_level_ = MoveTowards(energy_level_, is_on ? 1 : 0, kStep / kEnergyRamp);
  if (energy_level_ == 0) return energy_phase_ = 0;
  const double angle = kTurn * Advance(energy_phase_, energy_pitch_);
  return kEnergyLevel * energy_level_ * (std::sin(angle) + kSecondHarmonic * std::sin(2 * angle)) /
         (1 + kSecondHarmonic);
}

double Synthesiser::RenderClick() noexcept {
  if (click_sample_ == 0) {
    if (clicked_ == state_.clicks) return 0;
    ++clicked_;
  }
  const double time = static_cast<double>(click_sample_++) * kStep;
  if (time >= kClickSeconds) {
    click_sample_ = 0;
    return 0;
  }
  return kClickLevel * std::exp(-time / kClickDecay) * std::sin(kTurn * kClickPitch * time);
}

double Synthesiser::RenderPulse() noexcept {
  const double before = beat_phase_;
  if (state_.has_pulse && Advance(beat_phase_, state_.signs.heart_rate / 60) < before && pulse_sample_ == 0) {
    pulse_sample_ = 1;
    pulse_phase_ = 0;
    pulse_pitch_ = CalcPulsePitch(state_.signs.saturation);
  }
  if (pulse_sample_ == 0) return 0;
  const double time = static_cast<double>(pulse_sample_++) * kStep;
  if (time >= kPulseSeconds) {
    pulse_sample_ = 0;
    return 0;
  }
  return kPulseLevel * RaisedCosine(time, kPulseSeconds, kPulseRamp) *
         std::sin(kTurn * Advance(pulse_phase_, pulse_pitch_));
}

double Synthesiser::RenderSpeech() noexcept {
  if (!IsSpeaking()) return 0;
  return kSpeechLevel * std::clamp(static_cast<double>(speech_[spoken_++]), -1.0, 1.0);
}

void Synthesiser::Render(std::span<float> samples) noexcept {
  const double volume = settings_.is_muted ? 0 : std::clamp(settings_.volume, 0.0, 1.0);
  for (float& sample : samples) {
    gain_ = MoveTowards(gain_, volume, kStep / kGainRamp);
    sample = static_cast<float>(gain_ * (RenderEnergy() + RenderClick() + RenderPulse() + RenderSpeech()));
  }
}

}  // namespace trocar::sound
