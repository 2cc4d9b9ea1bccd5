// SPDX-License-Identifier: Apache-2.0
/// \file newest_slot.h  Exchange between two threads where only the newest value counts.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace trocar::host {

/// One producer, one consumer, three buffers: neither ever waits for the other and no value is seen
/// half-written.
///
/// The producer fills Back() and calls Publish(); the consumer calls Update() and reads Front(). Values that
/// the consumer did not fetch in time are overwritten.
/// \note Real-time safe: no allocation (beyond what T does when it is filled), lock or throw.
template <typename T>
class NewestSlot {
 public:
  /// The buffer that the producer may write. Holds an older value, so that its memory can be used again.
  T& Back() noexcept { return buffers_[back_]; }

  /// Producer: makes Back() the newest value.
  void Publish() noexcept {
    back_ = middle_.exchange(static_cast<std::uint8_t>(back_ | kFresh), std::memory_order_acq_rel) & kIndex;
  }

  /// Consumer: fetches the newest value if there is one that it has not seen. Returns whether there was.
  bool Update() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    return true;
  }

  /// The value that the consumer fetched last; default-constructed before the first Update().
  const T& Front() const noexcept { return buffers_[front_]; }

 private:
  static constexpr std::uint8_t kIndex = 3;
  static constexpr std::uint8_t kFresh = 4;

  std::array<T, 3> buffers_{};
  std::uint8_t back_ = 0;
  std::uint8_t front_ = 1;
  alignas(64) std::atomic<std::uint8_t> middle_{2};
};

}  // namespace trocar::host
