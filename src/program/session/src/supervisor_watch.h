// SPDX-License-Identifier: Apache-2.0
/// \file supervisor_watch.h  When the supervisor writes zero, by what it has seen of the simulator's beat: no clock, no file.
#pragma once

#include <algorithm>
#include <cstdint>

#include "trocar/session/supervisor_link.h"

namespace trocar::session {

class SupervisorWatch {
 public:
  static constexpr auto kSilence = static_cast<std::int64_t>(1e9 * SupervisorLink::kLongestSilence);  // [ns]
  static constexpr std::int64_t kAgain = 4'000'000;  // between two zero frames [ns]
  static constexpr std::int64_t kRound =
      2'000'000;                                 // longest sleep, within which it shows that it lives [ns]
  static constexpr std::int64_t kNap = 100'000;  // shortest [ns]

  /// \param beats  of the simulator so far; watching begins with the first
  /// \param now    [ns]
  /// \return whether zero is to be written now
  bool Look(std::uint64_t beats, std::int64_t now) noexcept {
    if (beats != beats_) {
      beats_ = beats;
      is_tripped_ = false;
      due_ = now + kSilence;
    }
    if (beats_ == 0 || now < due_) return false;
    if (!is_tripped_) ++trips_;
    is_tripped_ = true;
    due_ = now + kAgain;
    return true;
  }
  /// How often the beat has stopped.
  std::uint64_t CountTrips() const noexcept { return trips_; }
  /// Until something is due, but no longer than a round: the wait of an answer that is in time costs no processor [ns].
  std::int64_t CalcSleep(std::int64_t now) const noexcept {
    return beats_ == 0 ? kRound : std::clamp(due_ - now, kNap, kRound);
  }

 private:
  std::uint64_t beats_ = 0, trips_ = 0;
  std::int64_t due_ = 0;  // next zero [ns]
  bool is_tripped_ = false;
};

}  // namespace trocar::session
