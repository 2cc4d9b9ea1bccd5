// SPDX-License-Identifier: Apache-2.0
// Saved states beside a recording, closer together than its keyframes: they make seeking quick, and can be computed again
// at any time. The file may be deleted; docs/recording.md describes its bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "state_coder.h"

namespace trocar::record {

struct StateIndexSettings {
  std::filesystem::path path;   ///< empty: in memory, as where the file cannot be written
  std::uint64_t recording = 0;  ///< file id of the recording: an index of another one is replaced
  std::uint64_t model = 0;      ///< fingerprint of the recording's model: an index of another one is replaced
  /// Beyond it a file takes nothing more; of what is in memory every second state goes.
  std::uint64_t most_bytes = std::uint64_t{1} << 30;
};

/// All members may be called from any thread. What is damaged, or cannot be read, is not there.
class StateIndex {
 public:
  explicit StateIndex(StateIndexSettings settings);
  ~StateIndex();
  StateIndex(const StateIndex&) = delete;
  StateIndex& operator=(const StateIndex&) = delete;

  bool Has(std::uint64_t tick) const;
  /// The newest state at that tick or before it.
  std::optional<std::uint64_t> FindBefore(std::uint64_t tick) const;
  /// Of all states, ascending.
  std::vector<std::uint64_t> Ticks() const;
  /// Keeps a state; nothing where there is one of this tick, or no room.
  void Add(std::uint64_t tick, std::span<const std::byte> state);
  /// \return empty where there is none that is whole
  std::vector<std::byte> Read(std::uint64_t tick);
  /// Forgets a state that turned out to be none.
  void Drop(std::uint64_t tick);
  std::uint64_t Bytes() const;
  /// Whether the states outlive this.
  bool IsOnDisk() const { return descriptor_ >= 0 && is_writer_; }

 private:
  struct Entry {
    std::uint64_t tick = 0;
    std::uint64_t offset = 0;      // of its content in the file
    std::uint32_t size = 0;        // of its content [bytes]
    bool is_base = false;          // stands alone; the others are told apart from it
    std::vector<std::byte> bytes;  // its content, where it is in memory
  };
  void OpenFile();
  void ReadEntries(std::uint64_t file_size);
  void WriteHeader();
  bool Append(Entry& entry);
  void Erase(std::uint64_t tick);
  void Thin();
  std::vector<std::byte> ReadContent(const Entry& entry) const;
  std::shared_ptr<const StatePlanes> FindBase();
  std::vector<Entry>::const_iterator Find(std::uint64_t tick) const;

  StateIndexSettings settings_;
  mutable std::mutex mutex_;  // of what follows
  int descriptor_ = -1;
  bool is_writer_ = false;
  std::uint64_t end_ = 0;        // of what is whole in the file
  std::uint64_t in_memory_ = 0;  // [bytes]
  std::vector<Entry> entries_;   // ascending
  std::shared_ptr<const StatePlanes> base_;
};

}  // namespace trocar::record
