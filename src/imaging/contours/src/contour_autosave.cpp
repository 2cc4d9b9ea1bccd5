// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/contour_autosave.h"

#include <system_error>
#include <utility>

#include "trocar/host/safe_file.h"

namespace trocar::contours {

namespace fs = std::filesystem;

fs::path AutosavePath(const fs::path& points_file) {
  fs::path path = points_file;
  path += ".autosave";
  return path;
}

base::Result<std::optional<ControlPoints>> FindAutosaved(const fs::path& autosave_file,
                                                         const std::string& saved_text) {
  const auto text = host::ReadFile(autosave_file);
  if (!text.ok()) {
    if (text.error().code == base::ErrorCode::kFileMissing) return std::optional<ControlPoints>();
    return text.error();
  }
  if (*text == saved_text) return std::optional<ControlPoints>();
  auto points = ParseControlPoints(*text, autosave_file.string(), Completeness::kDraft);
  if (!points.ok()) {
    fs::path kept = autosave_file;
    kept += ".unreadable";
    std::error_code failure;
    fs::rename(autosave_file, kept, failure);
    return base::Error{points.error().code, points.error().message +
                                                " (autosaved contours of an earlier session; kept as " +
                                                (failure ? autosave_file : kept).string() + ")"};
  }
  return std::optional<ControlPoints>(std::move(*points));
}

ContourAutosave::ContourAutosave(fs::path autosave_file, Period period)
    : path_(std::move(autosave_file)), period_(period), thread_([this] { Run(); }) {}

ContourAutosave::~ContourAutosave() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void ContourAutosave::Offer(std::string text) {
  {
    const std::lock_guard lock(mutex_);
    waiting_ = std::move(text);
  }
  wake_.notify_all();
}

void ContourAutosave::Discard() {
  std::unique_lock lock(mutex_);
  waiting_.reset();
  // a write that has begun would bring the file back
  wake_.wait(lock, [this] { return !is_writing_; });
  std::error_code failure;
  fs::remove(path_, failure);
}

std::size_t ContourAutosave::WrittenCount() const {
  const std::lock_guard lock(mutex_);
  return written_;
}

base::Status ContourAutosave::LastStatus() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

void ContourAutosave::Run() {
  std::unique_lock lock(mutex_);
  auto next = std::chrono::steady_clock::now();
  while (true) {
    wake_.wait(lock, [this] { return waiting_.has_value() || is_ending_; });
    // changes that come within the period are written together
    wake_.wait_until(lock, next, [this] { return is_ending_; });
    if (waiting_) {
      const std::string text = std::move(*waiting_);
      waiting_.reset();
      is_writing_ = true;
      lock.unlock();
      auto status = host::WriteFile(path_, text);
      lock.lock();
      is_writing_ = false;
      written_ += status.ok();
      status_ = std::move(status);
      next = std::chrono::steady_clock::now() + period_;
      wake_.notify_all();
    }
    if (is_ending_ && !waiting_) return;
  }
}

}  // namespace trocar::contours
