// SPDX-License-Identifier: Apache-2.0
// Files that only their owner may read.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "trocar/base/result.h"
#include "trocar/store/store.h"

namespace trocar::store {

/// Whether an error of the system says that a disk, a quota or a file can take no more.
bool IsFull(int why) noexcept;

/// A folder that only its owner may enter; made where it is missing, with those above it. \return kFileUnwritable, kStoreFull
base::Status MakePrivateFolder(const std::filesystem::path& folder);

/// Writes a file of mode 0600 in one piece: a reader sees the old one or the new one, and it survives a power cut after this returns.
/// \return kFileUnwritable
base::Status WritePrivateFile(const std::filesystem::path& path, std::string_view content);

/// As WritePrivateFile, where there is no such file yet: of several programs the first one's content stays.
base::Status MakePrivateFileOnce(const std::filesystem::path& path, std::string_view content);

/// A file of mode 0600 that grows, and takes its name once it is whole.
class PrivateFileWriter {
 public:
  static base::Result<PrivateFileWriter> Start(const std::filesystem::path& path);
  PrivateFileWriter(PrivateFileWriter&& other) noexcept;
  PrivateFileWriter& operator=(PrivateFileWriter&&) = delete;
  /// Without Finish nothing is left.
  ~PrivateFileWriter();

  base::Status Append(std::string_view text);
  base::Status Finish();
  /// Leaves a file that is there as it is.
  base::Status FinishOnce();

 private:
  PrivateFileWriter(std::filesystem::path path, std::string partial, int file);
  base::Status Write();

  std::filesystem::path path_;
  std::string partial_, buffer_;
  int file_;
};

/// Erases what programs that were killed left half written in a folder: names and pseudonyms are in it.
base::Status EraseRemnants(const std::filesystem::path& folder);

/// As above, in all folders of a store.
base::Status EraseRemnants(const Place& place);

/// Syncs a folder's entries. \return kFileUnwritable
base::Status SyncFolder(const std::filesystem::path& folder);

/// Overwrites a file's bytes with zeros, syncs, and removes it; one that is gone is no error. A disk may keep copies that no program reaches.
base::Status EraseFile(const std::filesystem::path& path);

}  // namespace trocar::store
