// SPDX-License-Identifier: Apache-2.0
#include "trocar/store/keep_attempt.h"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>
#include <random>
#include <system_error>
#include <thread>
#include <utility>

#include "trocar/core/json.h"
#include "trocar/core/state_hash.h"

namespace trocar::store {

core::Result<Attempt> DescribeAttempt(const record::Recording& recording, const std::filesystem::path& path) {
  const record::Description& d = recording.description;
  Attempt attempt;
  attempt.recording_id = core::HashText(recording.file_id);
  attempt.started = d.started;
  attempt.task = d.name;
  attempt.level = d.level;
  attempt.patient = d.patient;
  attempt.seed = d.seed;
  attempt.seconds = recording.Seconds();
  attempt.program = d.program;
  std::error_code failure;
  const auto absolute = std::filesystem::absolute(path, failure);
  attempt.recording = failure ? path.string() : absolute.lexically_normal().string();
  if (const auto time = ParseTime(attempt.started); !time.ok())
    return core::Error{core::ErrorCode::kRecordingInvalid,
                       path.string() + ": it does not say when it started; record it again"};
  // without an ending the program was stopped: the attempt is kept, as not completed
  if (!recording.ending) return attempt;
  const auto parsed =
      core::ParseJson<nlohmann::json>(recording.ending->outcome, "the outcome", core::kSmallJson);
  if (!parsed.ok() || !parsed->is_object())
    return core::Error{
        core::ErrorCode::kRecordingInvalid,
        path.string() + ": its outcome cannot be read; trocar replay --verify computes it again"};
  const nlohmann::json& outcome = *parsed;
  attempt.outcome = recording.ending->outcome;
  if (const auto task = outcome.find("task"); task != outcome.end() && task->is_object()) {
    const auto phase = task->find("phase");
    attempt.is_completed = phase != task->end() && *phase == "completed";
    if (const auto score = task->find("score"); score != task->end() && score->is_number())
      attempt.score = score->get<double>();
  }
  if (const auto operation = outcome.find("operation");
      operation != outcome.end() && operation->is_object()) {
    const auto completed = operation->find("completed");
    attempt.is_completed = completed != operation->end() && *completed == true;
  }
  return attempt;
}

core::Result<KeepReport> KeepAttempt(const Place& place, const Attempt& attempt,
                                     const StoreSettings& settings) {
  const Spool spool(place);
  if (auto kept = spool.Keep(attempt); !kept.ok()) return kept.error();
  KeepReport report;
  auto store = Store::Open(place, settings);
  if (!store.ok()) {
    report.failure = store.error();
    return report;
  }
  report.rebuilt = store->Rebuilt();
  const DeliveryReport delivery = spool.Deliver(*store);
  report.failure = delivery.failure;
  if (report.failure) return report;
  // what this attempt came to is asked by its key: other programs may have delivered it
  const auto again = AddAttempt(*store, attempt);
  report.is_in_store = again.ok();
  if (!again.ok()) report.failure = again.error();
  return report;
}

struct Courier::Content {
  Place place;
  StoreSettings settings;
  double first_seconds, most_seconds;
  mutable std::mutex mutex;
  std::condition_variable changed;
  std::optional<core::Error> failure;
  bool has_work = true;  // of an earlier run
  bool is_ending = false;
  std::thread thread;

  /// \return whether nothing waits any more
  bool Try() {
    const Spool spool(place);
    std::optional<core::Error> why;
    if (spool.CountWaiting() > 0) {
      auto store = Store::Open(place, settings);
      why = store.ok() ? spool.Deliver(*store).failure : std::optional(store.error());
    }
    const std::lock_guard lock(mutex);
    failure = why;
    return !why;
  }

  void Run() {
    BackOff back_off(std::random_device{}(), first_seconds, most_seconds);
    std::unique_lock lock(mutex);
    while (!is_ending) {
      if (!has_work) {
        changed.wait(lock);
        continue;
      }
      has_work = false;
      lock.unlock();
      const bool is_done = Try();
      lock.lock();
      if (is_done) {
        back_off.Reset();
        continue;
      }
      const auto pause = std::chrono::duration<double>(back_off.Next());
      changed.wait_for(lock, pause, [this] { return is_ending; });
      has_work = true;
    }
  }
};

Courier::Courier(Place place, StoreSettings settings, double first_seconds, double most_seconds)
    : content_(std::make_unique<Content>()) {
  content_->place = std::move(place);
  content_->settings = settings;
  content_->first_seconds = first_seconds;
  content_->most_seconds = most_seconds;
  content_->thread = std::thread([content = content_.get()] { content->Run(); });
}

Courier::~Courier() {
  {
    const std::lock_guard lock(content_->mutex);
    content_->is_ending = true;
  }
  content_->changed.notify_all();
  content_->thread.join();
}

core::Status Courier::Keep(const Attempt& attempt) {
  if (auto kept = Spool(content_->place).Keep(attempt); !kept.ok()) return kept;
  {
    const std::lock_guard lock(content_->mutex);
    content_->has_work = true;
  }
  content_->changed.notify_all();
  return {};
}

std::optional<core::Error> Courier::Failure() const {
  const std::lock_guard lock(content_->mutex);
  return content_->failure;
}

}  // namespace trocar::store
