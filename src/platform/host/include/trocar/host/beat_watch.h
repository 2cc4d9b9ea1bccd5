// SPDX-License-Identifier: Apache-2.0
/// \file beat_watch.h  Whether another thread or process still runs, by a counter that it moves.
#pragma once

#include <algorithm>
#include <cstdint>

namespace trocar::host {

/// How long a counter has stood still, as seen by somebody who looks often. Of the time between two looks no more than
/// `longest_look` counts: where the machine did not let the watcher run, the watched one may not have run either.
/// \note Real-time safe.
class BeatWatch {
 public:
  /// \param longest_look  [ns], > 0
  explicit BeatWatch(std::int64_t longest_look) noexcept : longest_look_(longest_look) {}

  /// \param count  newest value of the counter
  /// \param now    [ns], never falling
  /// \return for which it has not changed [ns]
  std::int64_t Look(std::uint64_t count, std::int64_t now) noexcept {
    silence_ = count != last_count_ ? 0 : silence_ + std::min(now - last_look_, longest_look_);
    last_count_ = count;
    last_look_ = now;
    return silence_;
  }
  /// The silence until now was none.
  void Forget(std::int64_t now) noexcept {
    silence_ = 0;
    last_look_ = now;
  }

 private:
  std::int64_t longest_look_;  // [ns]
  std::uint64_t last_count_ = 0;
  std::int64_t last_look_ = 0, silence_ = 0;
};

}  // namespace trocar::host
