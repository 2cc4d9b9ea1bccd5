// SPDX-License-Identifier: Apache-2.0
/// \file awaited_flags.h  What the threads of a presenter wake, for tests that wait for it.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>

namespace trocar::editor {

class AwaitedFlags {
 public:
  /// A call from any thread that raises the flag.
  std::function<void()> Raise(bool& flag) {
    return [this, &flag] {
      const std::lock_guard lock(mutex_);
      flag = true;
      changed_.notify_all();
    };
  }
  /// Waits for the flag, and lowers it.
  void Await(bool& flag) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return flag; });
    flag = false;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
};

}  // namespace trocar::editor
