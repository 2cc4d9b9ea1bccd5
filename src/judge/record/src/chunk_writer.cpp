// SPDX-License-Identifier: Apache-2.0
#include "chunk_writer.h"

#include <random>
#include <string>
#include <system_error>
#include <utility>

namespace trocar::record {
namespace {

constexpr int kMostFiles = 4;  // a disk that fails this often is broken

std::uint64_t MakeFileId() {
  std::random_device device;
  return (static_cast<std::uint64_t>(device()) << 32) ^ device();
}

}  // namespace

ChunkWriter::ChunkWriter(std::filesystem::path path, OpenStorage open, std::unique_ptr<Storage> storage)
    : first_path_(path),
      path_(std::move(path)),
      open_(std::move(open)),
      storage_(std::move(storage)),
      file_id_(MakeFileId()),
      waiting_(MakeFileHeader(file_id_)) {}

base::Result<ChunkWriter> ChunkWriter::Open(const std::filesystem::path& path, OpenStorage open) {
  auto storage = open(path);
  if (!storage.ok()) return storage.error();
  return ChunkWriter(path, std::move(open), std::move(*storage));
}

void ChunkWriter::Put(ChunkKind kind, std::uint64_t tick, std::span<const std::byte> content, bool is_kept) {
  PutChunk(file_id_, number_++, kind, tick, content, waiting_);
  if (is_kept) kept_.push_back({kind, tick, {content.begin(), content.end()}});
}

base::Status ChunkWriter::WriteWaiting() {
  base::Status status = storage_->Append(waiting_);
  if (status.ok()) status = storage_->Sync();
  if (!status.ok()) return status;
  written_ += waiting_.size();
  waiting_.clear();
  return {};
}

base::Status ChunkWriter::StartAnew() {
  ++file_count_;
  const std::filesystem::path path =
      first_path_.parent_path() /
      (first_path_.stem().string() + "-" + std::to_string(file_count_) + first_path_.extension().string());
  auto storage = open_(path);
  if (!storage.ok()) return storage.error();  // also where somebody else has such a file
  storage_ = std::move(*storage);
  path_ = path;
  file_id_ = MakeFileId();
  number_ = written_ = 0;
  waiting_ = MakeFileHeader(file_id_);
  for (const Kept& chunk : kept_)
    PutChunk(file_id_, number_++, chunk.kind, chunk.tick, chunk.content, waiting_);
  const base::Status status = WriteWaiting();
  if (!status.ok()) {
    // a new file that could not be written either is only in the way
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
    path_ = first_path_;
  }
  return status;
}

base::Status ChunkWriter::Sync() {
  base::Status status = WriteWaiting();
  while (!status.ok() && file_count_ < kMostFiles) status = StartAnew();
  return status;
}

}  // namespace trocar::record
