// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/slice_store.h"

#include <algorithm>

namespace trocar::contours {

SliceStore::SliceStore(SliceReader reader, std::size_t memory_bytes)
    : reader_(std::move(reader)), limit_(memory_bytes) {}

const SliceStore::Entry* SliceStore::Find(int slice, double blur_px) {
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.slice == slice && entry.blur_px == blur_px;
  });
  if (found == entries_.end()) return nullptr;
  entries_.splice(entries_.begin(), entries_, found);
  return &entries_.front();
}

void SliceStore::Keep(Entry entry) {
  if (Find(entry.slice, entry.blur_px) != nullptr) return;
  used_ += entry.bytes;
  entries_.push_front(std::move(entry));
  while (used_ > limit_ && entries_.size() > 1) {
    used_ -= entries_.back().bytes;
    entries_.pop_back();
  }
}

base::Result<std::shared_ptr<const images::ColorImage>> SliceStore::Picture(int slice) {
  {
    const std::lock_guard lock(mutex_);
    if (const Entry* entry = Find(slice, 0)) return entry->picture;
  }
  auto read = reader_(slice);
  if (!read.ok()) return read.error();
  auto picture = std::make_shared<const images::ColorImage>(std::move(*read));
  const std::lock_guard lock(mutex_);
  Keep({slice, 0, picture, nullptr, picture->samples.size()});
  return picture;
}

base::Result<std::shared_ptr<const EdgeField>> SliceStore::Field(int slice, double blur_px) {
  {
    const std::lock_guard lock(mutex_);
    if (const Entry* entry = Find(slice, blur_px)) return entry->field;
  }
  const auto picture = Picture(slice);
  if (!picture.ok()) return picture.error();
  auto field = std::make_shared<const EdgeField>(**picture, blur_px);
  const std::lock_guard lock(mutex_);
  Keep({slice, blur_px, nullptr, field,
        static_cast<std::size_t>(field->Width()) * field->Height() * sizeof(Colour)});
  return field;
}

std::size_t SliceStore::UsedBytes() const {
  const std::lock_guard lock(mutex_);
  return used_;
}

SlicePrefetcher::SlicePrefetcher(std::shared_ptr<SliceStore> store)
    : store_(std::move(store)), thread_([this] { Run(); }) {}

SlicePrefetcher::~SlicePrefetcher() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void SlicePrefetcher::Request(std::vector<int> slices) {
  std::reverse(slices.begin(), slices.end());
  {
    const std::lock_guard lock(mutex_);
    waiting_ = std::move(slices);
  }
  wake_.notify_all();
}

void SlicePrefetcher::Run() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return is_ending_ || !waiting_.empty(); });
    if (is_ending_) return;
    const int slice = waiting_.back();
    waiting_.pop_back();
    lock.unlock();
    // who looks at a slice that cannot be read is told so then
    (void)store_->Picture(slice).ok();
    lock.lock();
  }
}

}  // namespace trocar::contours
