// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/error_log.h"

#include <algorithm>
#include <numeric>

#include "trocar/base/assert.h"
#include "trocar/math/state_fields.h"

namespace trocar::surgery {

std::string_view NameOf(Severity severity) noexcept {
  constexpr std::string_view kNames[] = {"minor", "major", "critical"};
  return kNames[static_cast<std::size_t>(severity)];
}

void VisitState(base::StateArchive& archive, ErrorEntry& entry) {
  archive.Field("error", entry.error.row);
  archive.Field("time", entry.time);
  archive.Field("place", entry.place);
  archive.Field("hand", entry.hand);
}

ErrorLog::ErrorLog(std::span<const ErrorRow> table)
    : table_(table), counts_(table.size(), 0), last_(table.size()) {
  entries_.reserve(kCapacity);
}

void ErrorLog::Add(const ErrorEntry& entry) noexcept {
  TROCAR_ASSERT(entry.error.row < table_.size());
  const std::size_t error = entry.error.row;
  const auto hand = static_cast<std::size_t>(std::clamp(entry.hand + 1, 0, static_cast<int>(kHands) - 1));
  const bool goes_on = last_[error][hand] > 0.0 && entry.time - last_[error][hand] < kPause;
  last_[error][hand] = std::max(entry.time, 1e-9);
  if (goes_on) return;
  ++counts_[error];
  if (entries_.size() < kCapacity) entries_.push_back(entry);
}

void ErrorLog::Clear() noexcept {
  entries_.clear();
  std::fill(counts_.begin(), counts_.end(), std::size_t{0});
  for (auto& hands : last_) hands.fill(0.0);
}

std::size_t ErrorLog::Count(ErrorId error) const noexcept {
  return error.row < counts_.size() ? counts_[error.row] : 0;
}

std::size_t ErrorLog::Count(Severity severity) const noexcept {
  std::size_t count = 0;
  for (std::size_t row = 0; row < table_.size(); ++row)
    count += table_[row].severity == severity ? counts_[row] : 0;
  return count;
}

std::size_t ErrorLog::Count() const noexcept {
  return std::accumulate(counts_.begin(), counts_.end(), std::size_t{0});
}

void ErrorLog::VisitState(base::StateArchive& archive) {
  archive.Field("entries", entries_);
  // the table gives how many there are: no length is written
  for (std::size_t& count : counts_) archive.Field("counts", count);
  for (auto& hands : last_) archive.Field("last", hands);
  const auto is_known = [this](const ErrorEntry& entry) { return entry.error.row < table_.size(); };
  if (archive.IsRestoring() &&
      (entries_.size() > kCapacity || !std::all_of(entries_.begin(), entries_.end(), is_known))) {
    Clear();
    archive.Fail("lists errors that there are not");
  }
}

}  // namespace trocar::surgery
