// SPDX-License-Identifier: Apache-2.0
/// \file checked_memory.h  Arrays that watch how a kernel uses them, for the host executor: bounds, reads of
/// what nobody wrote, and two threads at one place without a barrier between them.
#pragma once

#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "kernels/portable.h"

namespace trocar::tissue_cuda {

/// The kernel thread that runs now, and the errors found. One for a run of the executor; not for several threads.
struct Watch {
  ThreadIndex where{};
  std::uint32_t grid_epoch = 1;   ///< counts launches and grid barriers
  std::uint32_t block_epoch = 1;  ///< counts barriers of any kind, and blocks
  std::vector<std::string> errors;
  std::size_t error_count = 0;

  static constexpr std::size_t kMaxErrors = 20;  ///< kept as text; the count goes on
  void Report(const std::string& array, std::size_t i, const char* what) {
    ++error_count;
    if (errors.size() >= kMaxErrors) return;
    errors.push_back(array + "[" + std::to_string(i) + "]: " + what + ", block " +
                     std::to_string(where.block) + ", thread " + std::to_string(where.thread));
  }
};

/// Accesses to one element so far. Two accesses, one of them a write, are in order if one thread did both, if a
/// grid barrier lies between them, or in one block any barrier.
struct ElementHistory {
  struct Access {
    std::uint32_t grid_epoch = 0, block_epoch = 0, block = 0, thread = 0;
    bool is_atomic = false;
  };
  bool is_written = false;
  Access write, read;
  bool read_by_blocks = false;   ///< in read.grid_epoch by more than one block
  bool read_by_threads = false;  ///< in read.block_epoch by more than one thread
};

/// Contents and history of one array; a CheckedArray is a view of it.
template <typename T>
struct CheckedContents {
  std::string name;
  Watch* watch = nullptr;
  std::vector<T> values;
  std::vector<ElementHistory> history;
};

/// Stands in a kernel's Args or Shared where a raw pointer stands on the GPU.
template <typename T>
struct CheckedArray {
  CheckedContents<T>* contents = nullptr;
};

struct CheckedMemory {
  template <typename T>
  using Array = CheckedArray<T>;
};

namespace checked {

inline bool InOrder(const ElementHistory::Access& before, const Watch& watch) {
  const ThreadIndex& now = watch.where;
  if (before.grid_epoch < watch.grid_epoch) return true;
  if (before.block != now.block) return false;
  return before.thread == now.thread || before.block_epoch < watch.block_epoch;
}

inline ElementHistory::Access Now(const Watch& watch, bool is_atomic = false) {
  return {watch.grid_epoch, watch.block_epoch, watch.where.block, watch.where.thread, is_atomic};
}

/// A read may not meet another thread's write.
inline const char* NoteRead(ElementHistory& element, const Watch& watch) {
  if (!element.is_written) return "read before it was written";
  const char* error = InOrder(element.write, watch) ? nullptr : "read while another thread writes it";
  const bool same_grid_epoch = element.read.grid_epoch == watch.grid_epoch;
  const bool same_block = same_grid_epoch && element.read.block == watch.where.block;
  element.read_by_blocks = same_grid_epoch && (element.read_by_blocks || !same_block);
  element.read_by_threads = same_block && element.read.block_epoch == watch.block_epoch &&
                            (element.read_by_threads || element.read.thread != watch.where.thread);
  element.read = Now(watch);
  return error;
}

/// A write may meet neither; atomic operations may meet each other.
inline const char* NoteWrite(ElementHistory& element, const Watch& watch, bool is_atomic = false) {
  const char* error = nullptr;
  const bool both_atomic = is_atomic && element.write.is_atomic;
  if (element.is_written && !both_atomic && !InOrder(element.write, watch)) {
    error = "written while another thread writes it";
  }
  if (element.read.grid_epoch == watch.grid_epoch) {
    const bool in_order = !element.read_by_blocks && InOrder(element.read, watch) &&
                          !(element.read_by_threads && element.read.block_epoch == watch.block_epoch);
    if (!in_order) error = "written while another thread reads it";
  }
  element.is_written = true;
  element.write = Now(watch, is_atomic);
  return error;
}

}  // namespace checked

template <typename T>
T Load(const CheckedArray<T>& array, std::size_t i) {
  auto& contents = *array.contents;
  if (i >= contents.values.size()) {
    contents.watch->Report(contents.name, i, "read beyond its end");
    return T{};
  }
  if (const char* error = checked::NoteRead(contents.history[i], *contents.watch)) {
    contents.watch->Report(contents.name, i, error);
  }
  return contents.values[i];
}

template <typename T>
void Store(const CheckedArray<T>& array, std::size_t i, T value) {
  auto& contents = *array.contents;
  if (i >= contents.values.size()) {
    contents.watch->Report(contents.name, i, "written beyond its end");
    return;
  }
  if (const char* error = checked::NoteWrite(contents.history[i], *contents.watch)) {
    contents.watch->Report(contents.name, i, error);
  }
  contents.values[i] = value;
}

inline void AtomicMax(const CheckedArray<Key>& array, std::size_t i, Key value) {
  auto& contents = *array.contents;
  if (i >= contents.values.size()) {
    contents.watch->Report(contents.name, i, "written beyond its end");
    return;
  }
  if (!contents.history[i].is_written)
    contents.watch->Report(contents.name, i, "maximum of what nobody wrote");
  if (const char* error = checked::NoteWrite(contents.history[i], *contents.watch, true)) {
    contents.watch->Report(contents.name, i, error);
  }
  contents.values[i] = Larger(contents.values[i], value);
}

template <typename T>
bool Exists(const CheckedArray<T>& array) {
  return array.contents != nullptr;
}

/// Fills an array with bytes that are NaN as any floating-point number and a huge index as any whole one.
template <typename T>
void Poison(std::vector<T>& values) {
  if (!values.empty()) std::memset(static_cast<void*>(values.data()), 0xff, values.size() * sizeof(T));
}

/// Owns checked arrays of any type: global memory for a test, or one block's shared memory.
class CheckedHeap {
 public:
  using Memory = CheckedMemory;
  explicit CheckedHeap(Watch& watch, std::string prefix = "") : watch_(&watch), prefix_(std::move(prefix)) {}

  /// Poisoned, unwritten.
  template <typename T>
  CheckedArray<T> Array(std::size_t count) {
    return Array<T>(prefix_ + std::to_string(arrays_.size()), count);
  }
  template <typename T>
  CheckedArray<T> Array(std::string name, std::size_t count) {
    auto contents = std::make_shared<CheckedContents<T>>();
    contents->name = std::move(name);
    contents->watch = watch_;
    contents->values.resize(count);
    Poison(contents->values);
    contents->history.resize(count);
    arrays_.push_back(contents);
    return {contents.get()};
  }
  /// Copied from the host before the launch; nothing where `values` is empty.
  template <typename T>
  CheckedArray<T> Filled(std::string name, const std::vector<T>& values) {
    if (values.empty()) return {};
    CheckedArray<T> array = Array<T>(std::move(name), values.size());
    array.contents->values = values;
    for (ElementHistory& element : array.contents->history) element.is_written = true;
    return array;
  }

 private:
  Watch* watch_;
  std::string prefix_;
  std::vector<std::shared_ptr<void>> arrays_;  // shared: the only owner that forgets the element type
};

}  // namespace trocar::tissue_cuda
