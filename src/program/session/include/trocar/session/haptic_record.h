// SPDX-License-Identifier: Apache-2.0
/// \file haptic_record.h  Record of force feedback over a session: rate, periods and forces over time, and every change as
/// an event.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "trocar/session/haptic_loop.h"

namespace trocar::session {

enum class HapticEventKind : std::uint8_t {
  kArmed,       ///< force began to come up
  kUnarmed,     ///< force was taken away, with the reason
  kLost,        ///< the device is gone
  kBack,        ///< and is back
  kWarm,        ///< motors warm: force held back
  kCool,        ///< no longer
  kConfirmed,   ///< the check pose
  kUnwatched,   ///< the supervisor is gone
  kWatched,     ///< the supervisor is there
  kOverrun,     ///< the loop was so late that the force had to go
  kBadSamples,  ///< reports that are no good, jumps included, since the last sample
};
/// "armed", "unarmed", "lost", "back", "warm", "cool", "confirmed", "unwatched", "watched", "overrun", "bad_samples"
std::string_view HapticEventName(HapticEventKind kind) noexcept;

struct HapticEvent {
  double time = 0;  ///< [s]
  HapticEventKind kind = HapticEventKind::kArmed;
  int hand = -1;  ///< Hand, or -1: of the whole loop
  haptics::Fault reason = haptics::Fault::kNone;
  std::uint64_t count = 1;  ///< of overruns and bad reports
};

/// One hand's force feedback over a session.
struct HapticHandSummary {
  bool is_present = false;
  double armed_time = 0;  ///< with force, ramping included [s]
  /// Why there was no force for the longest time, and why there is none at the end; kNone where there was always force
  haptics::Fault longest_reason = haptics::Fault::kNone, last_reason = haptics::Fault::kNone;
  std::uint64_t clamped_ticks = 0;           ///< in which the force would have been larger than the device's
  double max_force = 0;                      ///< in the hand [N]
  double max_heat = 0;                       ///< 1 is what the motors bear for ever [-]
  std::uint64_t times_warm = 0;              ///< that the motors became warm
  std::uint64_t times_lost = 0;              ///< that the device was lost
  std::uint64_t bad_samples = 0, jumps = 0;  ///< reports that were dropped
};

/// The whole loop over a session.
struct HapticSummary {
  double seconds = 0;  ///< that were watched [s]
  std::uint64_t ticks = 0, late_ticks = 0, overruns = 0;
  double rate = 0, lowest_rate = 0;    ///< mean, and of the worst whole second [1/s]
  double period_max = 0, cpu_max = 0;  ///< of the worst tick [s]
  bool is_real_time = false, is_supervised = false;
  std::array<HapticHandSummary, instrument::kHandCount> hands;
};
/// One JSON object: times in seconds (_s) or microseconds (_us), forces in newtons, reasons by name and code.
std::string FormatSummaryJson(const HapticSummary& summary);
/// The summary for a person: pairs of a quantity and its value.
std::vector<std::array<std::string, 2>> DescribeSummary(const HapticSummary& summary);

/// Collects status after status. Memory stays bounded: when it is full every second sample goes, and events beyond
/// kMaxEvents are counted only.
class HapticRecord {
 public:
  static constexpr std::size_t kMaxSamples = 7200;
  static constexpr std::size_t kMaxEvents = 10'000;

  /// \param time    of the session [s], not falling
  /// \param status  the newest; the same one again changes nothing
  void Add(double time, const HapticStatus& status);

  std::size_t SampleCount() const { return samples_.size(); }
  const std::vector<HapticEvent>& Events() const { return events_; }
  std::uint64_t EventsLeftOut() const { return left_out_; }
  /// Of all that was added.
  HapticSummary CalcSummary() const;
  /// One JSON object: "samples" (times in seconds, periods in microseconds, forces in newtons, states by name), "events",
  /// "last" (as FormatHapticsJson) and "summary" (as FormatSummaryJson).
  std::string FormatJson() const;

 private:
  struct HandSample {
    haptics::ArmState state = haptics::ArmState::kUnarmed;
    float force = 0, heat = 0;
  };
  struct Sample {
    double time = 0;
    float rate = 0, period_p50 = 0, period_p999 = 0, period_max = 0, cpu_p999 = 0;
    std::array<HandSample, instrument::kHandCount> hands;
  };
  void Note(double time, HapticEventKind kind, int hand, haptics::Fault reason = haptics::Fault::kNone,
            std::uint64_t count = 1);
  void NoteHand(double time, int hand, const HapticHandStatus& before, const HapticHandStatus& now);

  void Sum(double time, const HapticStatus& status);

  HapticStatus first_, last_;
  bool has_last_ = false;
  double first_time_ = 0, last_time_ = 0;  // [s]
  HapticSummary summary_;                  // but what follows from first and last
  std::array<std::array<double, static_cast<std::size_t>(haptics::Fault::kCount)>, instrument::kHandCount>
      off_time_{};                  // by reason [s]
  double next_ = 0, period_ = 0.1;  // of the samples [s]
  std::vector<Sample> samples_;
  std::vector<HapticEvent> events_;
  std::uint64_t left_out_ = 0;
};

}  // namespace trocar::session
