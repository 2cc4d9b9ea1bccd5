// SPDX-License-Identifier: Apache-2.0
/// \file counted_functions.h  The C library's elementary functions, replaced in this program by ones that count their calls.
///
/// The program's definitions come before the C library's for every library that is loaded into it, so that calls from Bullet
/// or from the C++ library are counted as well. Each returns what the C library's own returns.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>

namespace trocar::banned_code {

/// Who has called what.
class CallTable {
 public:
  std::uint64_t Calls() const { return calls_; }
  /// Lines for each function and place: "240 times sin, from btRigidBody::... [libBulletDynamics.so]", and how it came there.
  /// \note Asks addr2line for what the symbols do not tell.
  std::string Text() const;

  /// \note Called by the counted functions; locks.
  void Add(const char* function, void* return_address) noexcept;

 private:
  /// Return addresses above a counted function, to name who called it.
  static constexpr int kMostFrames = 8;
  struct Caller {
    std::uint64_t calls = 0;
    std::array<void*, kMostFrames> frames{};
    int frame_count = 0;
  };
  std::mutex mutex_;
  std::uint64_t calls_ = 0;
  std::map<std::pair<const char*, void*>, Caller> callers_;  // by function and return address
};

/// While it lives, calls of any thread are added to the table; only one may live at a time.
class Counting {
 public:
  explicit Counting(CallTable& table) noexcept;
  ~Counting();
  Counting(const Counting&) = delete;
  Counting& operator=(const Counting&) = delete;
};

}  // namespace trocar::banned_code
