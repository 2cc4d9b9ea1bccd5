// SPDX-License-Identifier: Apache-2.0
// Chunks into a storage. A storage that fails once is never trusted again: what can be told again goes to a new file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "chunk.h"
#include "trocar/base/result.h"
#include "trocar/record/storage.h"

namespace trocar::record {

class ChunkWriter {
 public:
  /// Opens the file and writes its header.
  static base::Result<ChunkWriter> Open(const std::filesystem::path& path, OpenStorage open);

  /// \param is_kept  goes to a new file, too, where the first one fails
  void Put(ChunkKind kind, std::uint64_t tick, std::span<const std::byte> content, bool is_kept = true);
  /// Writes what was put, and waits until it is safe. Where the file fails, all that is kept goes to a new one
  /// beside it, "NAME-2" and so on. \return the last error, where that fails as well; then nothing is written any more
  base::Status Sync();

  const std::filesystem::path& Path() const { return path_; }
  std::uint64_t FileId() const { return file_id_; }
  /// Whether something was put that Sync has not written yet.
  bool HasWaiting() const { return !waiting_.empty(); }
  std::uint64_t Bytes() const { return written_ + waiting_.size(); }
  /// How many files there have been.
  int FileCount() const { return file_count_; }
  Space GetSpace() const { return storage_->GetSpace(); }

 private:
  ChunkWriter(std::filesystem::path path, OpenStorage open, std::unique_ptr<Storage> storage);
  base::Status WriteWaiting();
  base::Status StartAnew();

  struct Kept {
    ChunkKind kind;
    std::uint64_t tick;
    std::vector<std::byte> content;
  };
  std::filesystem::path first_path_, path_;
  OpenStorage open_;
  std::unique_ptr<Storage> storage_;
  std::uint64_t file_id_ = 0, number_ = 0, written_ = 0;
  std::vector<std::byte> waiting_;
  std::vector<Kept> kept_;  // some megabytes in an hour
  int file_count_ = 1;
};

}  // namespace trocar::record
