// SPDX-License-Identifier: Apache-2.0
/// \file storage.h  Where the bytes of a recording go. Tests put one in its place that fails or loses its power.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>

#include "trocar/base/result.h"

namespace trocar::record {

/// Of the disk that a file lies on [bytes].
struct Space {
  std::uint64_t free = 0, all = 0;
};

/// A file that grows at its end.
class Storage {
 public:
  virtual ~Storage() = default;
  /// \return kFileUnwritable; then nothing is known of the end of the file
  virtual base::Status Append(std::span<const std::byte> bytes) = 0;
  /// Makes what was appended so far survive a power cut.
  /// \return kFileUnwritable; then nothing that was appended since the last Sync can be trusted
  virtual base::Status Sync() = 0;
  virtual Space GetSpace() const = 0;
};

using OpenStorage = std::function<base::Result<std::unique_ptr<Storage>>(const std::filesystem::path&)>;

/// A new file of the file system, whose name survives a power cut once the first Sync has returned.
/// \return kFileUnwritable, also where there is such a file already
base::Result<std::unique_ptr<Storage>> MakeFile(const std::filesystem::path& path);

}  // namespace trocar::record
