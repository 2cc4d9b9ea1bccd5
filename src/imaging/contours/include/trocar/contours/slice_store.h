// SPDX-License-Identifier: Apache-2.0
/// \file slice_store.h  Slices of a series, decoded and made ready for edges once, within a limit of memory.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/contours/edge_field.h"
#include "trocar/images/image_stack.h"

namespace trocar::contours {

/// Gives the picture of a slice. Called from several threads at once.
using SliceReader = std::function<base::Result<images::ColorImage>(int slice)>;

/// Keeps what was used last. Thread-safe.
class SliceStore {
 public:
  /// \param memory_bytes  what is used least goes when pictures and fields take more; the newest stays
  explicit SliceStore(SliceReader reader, std::size_t memory_bytes = std::size_t{384} << 20);

  // shared: a thread that computes keeps its picture while the store moves on
  base::Result<std::shared_ptr<const images::ColorImage>> Picture(int slice);
  /// \param blur_px  of the field [pixels], > 0
  base::Result<std::shared_ptr<const EdgeField>> Field(int slice, double blur_px);

  std::size_t UsedBytes() const;

 private:
  struct Entry {
    int slice = 0;
    double blur_px = 0;  // 0: the picture
    std::shared_ptr<const images::ColorImage> picture;
    std::shared_ptr<const EdgeField> field;
    std::size_t bytes = 0;
  };
  const Entry* Find(int slice, double blur_px);
  void Keep(Entry entry);

  SliceReader reader_;
  std::size_t limit_;
  mutable std::mutex mutex_;  // guards what follows; never held while decoding
  std::list<Entry> entries_;  // last used first
  std::size_t used_ = 0;
};

/// Decodes slices that will be looked at next, on a thread of its own.
class SlicePrefetcher {
 public:
  explicit SlicePrefetcher(std::shared_ptr<SliceStore> store);
  ~SlicePrefetcher();
  SlicePrefetcher(const SlicePrefetcher&) = delete;
  SlicePrefetcher& operator=(const SlicePrefetcher&) = delete;

  /// In this order; what was asked for before and is not begun is dropped. Returns at once.
  void Request(std::vector<int> slices);

 private:
  void Run();

  std::shared_ptr<SliceStore> store_;  // shared with the window
  std::mutex mutex_;                   // guards what follows
  std::condition_variable wake_;
  std::vector<int> waiting_;  // next one last
  bool is_ending_ = false;
  std::thread thread_;
};

}  // namespace trocar::contours
