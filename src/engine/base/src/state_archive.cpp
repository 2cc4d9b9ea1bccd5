// SPDX-License-Identifier: Apache-2.0
#include "trocar/base/state_archive.h"

#include <algorithm>

namespace trocar::base {
namespace {

/// Eight bytes at a time; the last word is filled with zeros and followed by the length.
void AddBytes(StateHash& hash, const void* data, std::size_t size) noexcept {
  const auto* bytes = static_cast<const unsigned char*>(data);
  std::size_t at = 0;
  for (; at + 8 <= size; at += 8) {
    std::uint64_t word;
    std::memcpy(&word, bytes + at, 8);
    hash.Add(word);
  }
  if (at < size) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes + at, size - at);
    hash.Add(word);
  }
}

}  // namespace

StateArchive StateArchive::ForSave(std::vector<std::byte>& bytes) {
  StateArchive archive(Mode::kSave);
  archive.target_ = &bytes;
  return archive;
}

StateArchive StateArchive::ForRestore(std::span<const std::byte> bytes) {
  StateArchive archive(Mode::kRestore);
  archive.source_ = bytes;
  return archive;
}

StateArchive StateArchive::ForHash(StateHash& hash) {
  StateArchive archive(Mode::kHash);
  archive.hash_ = &hash;
  return archive;
}

void StateArchive::Enter(std::string_view name) {
  if (!KeepsPaths()) return;
  path_ends_.push_back(path_.size());
  if (!path_.empty()) path_ += '/';
  path_ += name;
  is_leaf_ = true;
  if (trace_) field_hash_ = StateHash{};
}

void StateArchive::Leave() {
  if (!KeepsPaths()) return;
  if (trace_ && is_leaf_) trace_(path_, field_hash_.Value());
  is_leaf_ = false;
  path_.resize(path_ends_.back());
  path_ends_.pop_back();
}

void StateArchive::Fail(std::string reason) {
  if (ok()) failure_ = path_ + " " + std::move(reason);
}

void StateArchive::Bytes(void* data, std::size_t size) {
  if (!ok() || size == 0) return;
  switch (mode_) {
    case Mode::kSave: {
      const auto* bytes = static_cast<const std::byte*>(data);
      target_->insert(target_->end(), bytes, bytes + size);
      break;
    }
    case Mode::kRestore:
      if (size > source_.size() - read_) {
        Fail("ends before its last byte");
        return;
      }
      std::memcpy(data, source_.data() + read_, size);
      read_ += size;
      break;
    case Mode::kHash:
      AddBytes(*hash_, data, size);
      break;
  }
  if (trace_) AddBytes(field_hash_, data, size);
}

std::size_t StateArchive::Count(std::size_t now, std::size_t least_bytes_each) {
  std::uint64_t count = now;
  Bytes(&count, sizeof(count));
  if (!IsRestoring()) return now;
  if (!ok()) return now;
  if (count > (source_.size() - read_) / std::max<std::size_t>(1, least_bytes_each)) {
    Fail("claims more elements than there are bytes");
    return now;
  }
  return static_cast<std::size_t>(count);
}

}  // namespace trocar::base
