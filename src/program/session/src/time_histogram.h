// SPDX-License-Identifier: Apache-2.0
/// \file time_histogram.h  Percentiles of many short times in fixed memory.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>

namespace trocar::session {

/// One bin a microsecond up to 4 ms; longer times fall into the last bin, and the longest is kept. One thread adds and
/// clears; others may look, and see what was there a moment ago.
class TimeHistogram {
 public:
  /// \param time  [ns]
  /// \note Real-time safe.
  void Add(std::int64_t time) noexcept {
    const std::int64_t bin = std::clamp<std::int64_t>(time / 1000, 0, kBins - 1);
    bins_[static_cast<std::size_t>(bin)].fetch_add(1, std::memory_order_relaxed);
    count_.fetch_add(1, std::memory_order_relaxed);
    if (time > longest_.load(std::memory_order_relaxed)) longest_.store(time, std::memory_order_relaxed);
  }
  void Clear() noexcept {
    for (auto& bin : bins_) bin.store(0, std::memory_order_relaxed);
    count_.store(0, std::memory_order_relaxed);
    longest_.store(0, std::memory_order_relaxed);
  }

  std::uint64_t Count() const noexcept { return count_.load(std::memory_order_relaxed); }
  /// [s]
  double Longest() const noexcept {
    return 1e-9 * static_cast<double>(longest_.load(std::memory_order_relaxed));
  }
  /// Upper end of the bin in which the percentile lies [s]; beyond the bins the longest time; 0 without times.
  double CalcPercentile(double fraction) const noexcept {
    if (Count() == 0) return 0.0;
    const double wanted = fraction * static_cast<double>(Count());
    std::uint64_t seen = 0;
    for (std::size_t bin = 0; bin + 1 < kBins; ++bin) {
      seen += bins_[bin].load(std::memory_order_relaxed);
      if (static_cast<double>(seen) >= wanted)
        return std::min(1e-6 * static_cast<double>(bin + 1), Longest());
    }
    return Longest();
  }

 private:
  static constexpr std::int64_t kBins = 4096;
  std::array<std::atomic<std::uint32_t>, kBins> bins_{};
  std::atomic<std::uint64_t> count_{0};
  std::atomic<std::int64_t> longest_{0};  // [ns]
};

}  // namespace trocar::session
