// SPDX-License-Identifier: Apache-2.0
#include "state_index.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "chunk.h"
#include "trocar/record/recording.h"

namespace trocar::record {
namespace {

constexpr std::string_view kIndexEnding = ".index";
constexpr std::array<char, 8> kIndexMagic{'T', 'R', 'O', 'C', 'I', 'D', 'X', '\n'};
/// A file of another format is replaced: all of it can be computed again.
constexpr std::uint32_t kIndexFormat = 1;
/// A disk that is fuller is left to what cannot be computed again.
constexpr std::uint64_t kLeastFree = std::uint64_t{1} << 30;
constexpr double kLeastFreeShare = 0.05;

struct IndexHeader {
  std::array<char, 8> magic = kIndexMagic;
  std::uint32_t format = kIndexFormat;
  std::uint32_t reserved = 0;
  std::uint64_t recording = 0, model = 0;
};
static_assert(sizeof(IndexHeader) == 32);

struct EntryHeader {
  std::uint32_t magic = 0x43525449;  // "ITRC"
  std::uint32_t size = 0;            // of the content [bytes]
  std::uint64_t tick = 0;
  std::uint32_t checksum = 0;  // CRC-32 of recording, this (being 0) and content, as of a chunk
  std::uint32_t is_base = 0;
};
static_assert(sizeof(EntryHeader) == 24);

std::uint32_t CalcChecksum(std::uint64_t recording, const EntryHeader& header,
                           std::span<const std::byte> content) {
  ChunkHeader chunk;
  chunk.magic = header.magic;
  chunk.tick = header.tick;
  chunk.number = header.is_base;
  chunk.size = header.size;
  return CalcChunkChecksum(recording, chunk, content);
}

bool ReadAt(int descriptor, std::uint64_t offset, void* data, std::size_t size) {
  auto* at = static_cast<std::byte*>(data);
  while (size > 0) {
    const ssize_t read = ::pread(descriptor, at, size, static_cast<off_t>(offset));
    if (read < 0 && errno == EINTR) continue;
    if (read <= 0) return false;
    at += read, offset += static_cast<std::uint64_t>(read), size -= static_cast<std::size_t>(read);
  }
  return true;
}

bool WriteAt(int descriptor, std::uint64_t offset, const void* data, std::size_t size) {
  const auto* at = static_cast<const std::byte*>(data);
  while (size > 0) {
    const ssize_t written = ::pwrite(descriptor, at, size, static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    at += written, offset += static_cast<std::uint64_t>(written), size -= static_cast<std::size_t>(written);
  }
  return true;
}

bool HasSpace(int descriptor) {
  struct statvfs info {};
  if (::fstatvfs(descriptor, &info) != 0) return true;  // a full disk is noticed when it is written to
  const double all = static_cast<double>(info.f_blocks) * static_cast<double>(info.f_frsize);
  const double free = static_cast<double>(info.f_bavail) * static_cast<double>(info.f_frsize);
  return free > std::min(static_cast<double>(kLeastFree), 0.5 * all) && free > kLeastFreeShare * all;
}

}  // namespace

std::filesystem::path IndexPathOf(const std::filesystem::path& recording) {
  return recording.string() + std::string(kIndexEnding);
}

void TrimIndexes(const std::filesystem::path& folder, std::uint64_t most_bytes) {
  namespace fs = std::filesystem;
  struct Index {
    fs::path path;
    fs::file_time_type time;
    std::uint64_t bytes;
  };
  std::vector<Index> indexes;
  std::error_code failure;
  for (fs::directory_iterator at(folder, failure), end; !failure && at != end; at.increment(failure)) {
    std::error_code ignored;
    const std::string name = at->path().filename().string();
    if (!name.ends_with(".trocar" + std::string(kIndexEnding)) || !at->is_regular_file(ignored)) continue;
    const auto time = at->last_write_time(ignored);
    const auto bytes = at->file_size(ignored);
    if (!ignored) indexes.push_back({at->path(), time, bytes});
  }
  std::sort(indexes.begin(), indexes.end(), [](const Index& a, const Index& b) { return a.time > b.time; });
  std::uint64_t all = 0;
  for (const Index& index : indexes) {
    all += index.bytes;
    if (all > most_bytes) fs::remove(index.path, failure);
  }
}

StateIndex::StateIndex(StateIndexSettings settings) : settings_(std::move(settings)) {
  if (!settings_.path.empty()) OpenFile();
}

StateIndex::~StateIndex() {
  if (descriptor_ >= 0) ::close(descriptor_);  // gives up the lock
}

void StateIndex::OpenFile() {
  descriptor_ = ::open(settings_.path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0644);
  is_writer_ = descriptor_ >= 0 && ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
  if (descriptor_ < 0) {
    // a folder in which nothing may be written can still be read
    descriptor_ = ::open(settings_.path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  }
  if (descriptor_ < 0) return;
  struct stat info {};
  if (::fstat(descriptor_, &info) != 0 || !S_ISREG(info.st_mode)) {
    ::close(descriptor_);
    descriptor_ = -1;
    is_writer_ = false;
    return;
  }
  IndexHeader header, wanted;
  wanted.recording = settings_.recording, wanted.model = settings_.model;
  if (ReadAt(descriptor_, 0, &header, sizeof header) && std::memcmp(&header, &wanted, sizeof header) == 0) {
    ReadEntries(static_cast<std::uint64_t>(info.st_size));
  } else if (is_writer_) {
    WriteHeader();
  }
  if (is_writer_ && ::ftruncate(descriptor_, static_cast<off_t>(end_)) != 0) is_writer_ = false;
}

void StateIndex::WriteHeader() {
  IndexHeader header;
  header.recording = settings_.recording, header.model = settings_.model;
  end_ = sizeof header;
  if (::ftruncate(descriptor_, 0) != 0 || !WriteAt(descriptor_, 0, &header, sizeof header))
    is_writer_ = false;
}

/// Up to the first entry that is none; their contents are checked when they are used.
void StateIndex::ReadEntries(std::uint64_t file_size) {
  end_ = sizeof(IndexHeader);
  EntryHeader header;
  while (end_ + sizeof header <= file_size && ReadAt(descriptor_, end_, &header, sizeof header)) {
    const std::uint64_t content = end_ + sizeof header;
    if (header.magic != EntryHeader{}.magic || header.size > kMostContent ||
        content + header.size > file_size)
      return;
    const auto place = Find(header.tick);
    const bool is_known = place != entries_.end() && place->tick == header.tick;
    if (!is_known) entries_.insert(place, Entry{header.tick, content, header.size, header.is_base == 1, {}});
    end_ = content + header.size;
  }
}

std::vector<StateIndex::Entry>::const_iterator StateIndex::Find(std::uint64_t tick) const {
  return std::lower_bound(entries_.begin(), entries_.end(), tick,
                          [](const Entry& entry, std::uint64_t at) { return entry.tick < at; });
}

bool StateIndex::Has(std::uint64_t tick) const {
  const std::lock_guard lock(mutex_);
  const auto place = Find(tick);
  return place != entries_.end() && place->tick == tick;
}

std::optional<std::uint64_t> StateIndex::FindBefore(std::uint64_t tick) const {
  const std::lock_guard lock(mutex_);
  const auto after = Find(tick + 1);
  if (after == entries_.begin()) return std::nullopt;
  return std::prev(after)->tick;
}

std::vector<std::uint64_t> StateIndex::Ticks() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::uint64_t> ticks;
  ticks.reserve(entries_.size());
  for (const Entry& entry : entries_) ticks.push_back(entry.tick);
  return ticks;
}

std::uint64_t StateIndex::Bytes() const {
  const std::lock_guard lock(mutex_);
  return end_ + in_memory_;
}

std::vector<std::byte> StateIndex::ReadContent(const Entry& entry) const {
  if (entry.offset == 0) return entry.bytes;
  EntryHeader header;
  std::vector<std::byte> bytes(entry.size);
  if (!ReadAt(descriptor_, entry.offset - sizeof header, &header, sizeof header) ||
      header.size != entry.size || header.tick != entry.tick ||
      !ReadAt(descriptor_, entry.offset, bytes.data(), bytes.size()) ||
      header.checksum != CalcChecksum(settings_.recording, header, bytes))
    return {};
  return bytes;
}

/// The one that stands alone, expanded once; null where there is none that is whole.
std::shared_ptr<const StatePlanes> StateIndex::FindBase() {
  if (base_ != nullptr) return base_;
  const auto place = std::find_if(entries_.begin(), entries_.end(), [](const Entry& e) { return e.is_base; });
  if (place == entries_.end()) return nullptr;
  const auto state = ExpandState(ReadContent(*place), nullptr);
  if (state.empty()) {
    // without it none of the others can be read
    entries_.clear();
    in_memory_ = 0;
    if (is_writer_) WriteHeader();
    return nullptr;
  }
  base_ = std::make_shared<const StatePlanes>(state);
  return base_;
}

void StateIndex::Drop(std::uint64_t tick) {
  const std::lock_guard lock(mutex_);
  Erase(tick);
}

void StateIndex::Erase(std::uint64_t tick) {
  const auto place = Find(tick);
  if (place == entries_.end() || place->tick != tick) return;
  in_memory_ -= place->bytes.size();
  entries_.erase(place);
}

std::vector<std::byte> StateIndex::Read(std::uint64_t tick) {
  std::vector<std::byte> bytes;
  std::shared_ptr<const StatePlanes> base;
  {
    const std::lock_guard lock(mutex_);
    base = FindBase();
    const auto place = Find(tick);
    if (place == entries_.end() || place->tick != tick) return {};
    bytes = ReadContent(*place);
    if (bytes.empty()) {
      Erase(tick);
      return {};
    }
  }
  return ExpandState(bytes, HasBase(bytes) ? base.get() : nullptr);
}

/// Writes an entry to the file. \return false where it belongs into memory
bool StateIndex::Append(Entry& entry) {
  if (!is_writer_) return false;
  EntryHeader header;
  header.size = entry.size, header.tick = entry.tick, header.is_base = entry.is_base ? 1 : 0;
  header.checksum = CalcChecksum(settings_.recording, header, entry.bytes);
  std::vector<std::byte> all(sizeof header + entry.bytes.size());
  std::memcpy(all.data(), &header, sizeof header);
  std::copy(entry.bytes.begin(), entry.bytes.end(), all.begin() + sizeof header);
  if (!WriteAt(descriptor_, end_, all.data(), all.size())) {
    is_writer_ = false;
    return false;
  }
  entry.offset = end_ + sizeof header;
  end_ += all.size();
  entry.bytes = {};
  return true;
}

/// Every second state that is in memory goes, but for the one that the others need.
void StateIndex::Thin() {
  bool is_odd = false;
  std::erase_if(entries_, [&](const Entry& entry) {
    if (entry.is_base || entry.offset != 0) return false;
    is_odd = !is_odd;
    if (is_odd) in_memory_ -= entry.bytes.size();
    return is_odd;
  });
}

void StateIndex::Add(std::uint64_t tick, std::span<const std::byte> state) {
  std::shared_ptr<const StatePlanes> base;
  {
    const std::lock_guard lock(mutex_);
    const auto place = Find(tick);
    if (place != entries_.end() && place->tick == tick) return;
    if (is_writer_ && (end_ > settings_.most_bytes || !HasSpace(descriptor_))) return;
    base = FindBase();
  }
  Entry entry;
  entry.tick = tick;
  entry.is_base = base == nullptr;
  entry.bytes = CompressState(state, base.get());
  entry.size = static_cast<std::uint32_t>(entry.bytes.size());
  const std::lock_guard lock(mutex_);
  const auto place = Find(tick);
  if (place != entries_.end() && place->tick == tick) return;
  // another thread may have brought the first one meanwhile
  if (entry.is_base && base_ != nullptr) return;
  if (entry.is_base) base_ = std::make_shared<const StatePlanes>(state);
  if (!Append(entry)) in_memory_ += entry.bytes.size();
  entries_.insert(place, std::move(entry));
  if (in_memory_ > settings_.most_bytes) Thin();
}

}  // namespace trocar::record
