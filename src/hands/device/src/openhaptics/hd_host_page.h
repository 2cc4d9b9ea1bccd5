// SPDX-License-Identifier: Apache-2.0
/// \file hd_host_page.h  Memory that the process of the maker's library shares with the simulator and with all that watch it, and
/// how soon each calls the other, or the library, dead.
#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include "hands/force_mailbox.h"

namespace trocar::device {

/// In shared memory.
struct HdHostPage {
  ForceMailbox mailbox;
  /// Of the library's process, every millisecond while the library calls us in time.
  std::atomic<std::uint64_t> beats{0};
  /// The library's process itself; 0 until it runs.
  std::atomic<int> process{0};
  /// Its devices are at zero and given back: that it ends is no failure.
  std::atomic<bool> is_closed{false};
};

// both ends are this program's, from one build; neither destroys what the other may still read
static_assert(std::is_trivially_destructible_v<HdHostPage>);

namespace hd_host {

/// Requests: "open", the library's file and the names of the devices on lines of their own; "watch", the same, with page and pidfd
/// of the process that has opened them: should that fail, the devices are opened and sent zero, and a reply as to "open" comes;
/// "start"; "stop". Each is answered.
inline constexpr std::string_view kOpen = "open\n", kWatch = "watch\n", kStart = "start", kStop = "stop";
inline constexpr std::size_t kLongestRequest = 4096;

struct Reply {
  std::int32_t code = 0;    ///< base::ErrorCode
  std::uint32_t count = 0;  ///< of limits
  ForceLimits limits[ForceMailbox::kMaxDevices];
  char text[600] = {};  ///< of an error, ended by 0
};
static_assert(std::is_trivially_copyable_v<Reply>);

/// Of a process whose library stands still, and that has ended itself for it.
inline constexpr int kLibraryStands = 3;

}  // namespace hd_host

/// Between two looks at a beat, and the longest time between them that counts [ns].
inline constexpr std::int64_t kBeatLook = 1'000'000, kLongestBeatLook = 2'000'000;
/// Without a call of the library for so long its process ends itself, and the system closes the device [ns].
inline constexpr std::int64_t kLongestCallSilence = 12'000'000;
/// Without a beat for so long the process is ended from outside [ns]: it stands still as a whole.
inline constexpr std::int64_t kLongestBeatSilence = 15'000'000;

/// A spare that has not shown a beat for so long, when it is needed, is not waited for [ns].
inline constexpr std::int64_t kLongestSpareSilence = 5'000'000;

#ifdef TROCAR_WITHOUT_HOST_WATCH
inline constexpr bool kIsHostWatched = false;  // the negative control
#else
inline constexpr bool kIsHostWatched = true;
#endif

}  // namespace trocar::device
