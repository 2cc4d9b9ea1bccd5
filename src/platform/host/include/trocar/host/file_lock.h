// SPDX-License-Identifier: Apache-2.0
/// \file file_lock.h  One program at a time on a file or device.
#pragma once

#include <filesystem>
#include <utility>

#include "trocar/base/result.h"

namespace trocar::host {

/// Holds a lock file for as long as it lives; the system gives it back when the program dies.
class FileLock {
 public:
  /// Makes the lock file, and its folder, where they are missing.
  /// \return kFileInUse with the other program's process number, also where that program is this one;
  /// kFileUnwritable
  static base::Result<FileLock> Take(const std::filesystem::path& path);

  FileLock(FileLock&& other) noexcept
      : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}
  FileLock& operator=(FileLock&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  /// In a process that was forked: closes its copy, which would hold the lock after the one who took it has died.
  void LeaveToParent() noexcept;
  /// Removes the lock file.
  ~FileLock();

 private:
  FileLock(std::filesystem::path path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}

  std::filesystem::path path_;
  int descriptor_;
};

}  // namespace trocar::host
