// SPDX-License-Identifier: Apache-2.0
#include "trocar/store/keep_attempt.h"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <random>
#include <system_error>
#include <thread>
#include <utility>

#include "attempt_rows.h"
#include "sql.h"
#include "trocar/base/state_hash.h"
#include "trocar/host/log.h"
#include "trocar/host/version.h"
#include "trocar/record/outcome.h"
#include "trocar/record/replay.h"
#include "trocar/record/trace.h"
#include "trocar/training/attempt_metrics.h"

namespace trocar::store {

base::Result<Attempt> DescribeAttempt(const record::Recording& recording, const std::filesystem::path& path) {
  const record::Description& d = recording.description;
  Attempt attempt;
  attempt.recording_id = base::HashText(recording.file_id);
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
    return base::Error{base::ErrorCode::kRecordingInvalid,
                       path.string() + ": it does not say when it started; record it again"};
  // without an ending the program was stopped: the attempt is kept, as not completed
  if (!recording.ending) return attempt;
  const auto outcome = record::ReadOutcome(recording.ending->outcome);
  if (!outcome)
    return base::Error{
        base::ErrorCode::kRecordingInvalid,
        path.string() + ": its outcome cannot be read; trocar replay --verify computes it again"};
  attempt.outcome = recording.ending->outcome;
  attempt.is_completed = outcome->is_completed;
  attempt.score = outcome->score;
  return attempt;
}

base::Result<Attempt> ReplayAttempt(record::Recording recording, const std::filesystem::path& path,
                                    const ReplayChoice& choice) {
  auto described = DescribeAttempt(recording, path);
  if (!described.ok()) return described;
  Attempt attempt = std::move(*described);
  VerificationMark& mark = attempt.mark;
  const bool is_of_this_version = record::IsOfThisProgram(recording.description);
  const bool is_from_state = recording.FirstTick() > 0;
  const bool has_other_ending = recording.is_ending_refused;
  mark.program = host::VersionText();
  mark.time_ms = NowMilliseconds();
  auto replay = record::Replay::Open(std::move(recording), choice.threads);
  if (!replay.ok()) {
    mark.why = is_of_this_version ? WhyUnverified::kCannotReplay : WhyUnverified::kOtherVersion;
    host::Log(host::LogLevel::kWarning, replay.error().Text());
    return attempt;
  }
  record::TraceBuilder builder(replay->GetSimulation());
  const auto played = replay->Verify(
      choice.progress,
      [&](const simulation::Snapshot& now, const scene::Input& input) { builder.Add(now, input.controls); });
  if (!played.ok()) {
    if (played.error().code == base::ErrorCode::kCancelled) return played.error();
    mark.why = WhyUnverified::kCannotReplay;
    host::Log(host::LogLevel::kWarning, played.error().Text());
    return attempt;
  }
  if (!played->IsVerified() && !is_of_this_version) {
    mark.why = WhyUnverified::kOtherVersion;
    return attempt;
  }
  const auto& ending = replay->GetRecording().ending;
  if (!played->IsVerified() && ending) mark.claim = ending->outcome;
  attempt.outcome = played->outcome;
  if (played->divergence) {
    // whose states these are, nobody knows: nothing is measured
    mark.state = Verification::kRefused, mark.why = WhyUnverified::kDiverged;
    attempt.is_completed = false;
    attempt.score.reset();
    return attempt;
  }
  const training::AttemptTrace trace = builder.Calc();
  attempt.is_completed = trace.outcome.is_completed;
  attempt.score = trace.outcome.score;
  if (auto metrics = training::CalcAttemptMetrics(trace); metrics.ok())
    attempt.metrics = std::move(metrics->values);
  else
    host::Log(host::LogLevel::kWarning, "kept without metrics: " + metrics.error().Text());
  if (!played->is_outcome_same || has_other_ending)
    mark.state = Verification::kRefused, mark.why = WhyUnverified::kOtherEnding;
  else if (is_from_state)
    mark.why = WhyUnverified::kSavedState;
  else
    mark.state = Verification::kVerified, mark.why = WhyUnverified::kNone;
  return attempt;
}

base::Result<KeepReport> KeepAttempt(const Place& place, const Attempt& attempt,
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
  if (!again.ok()) {
    const auto is_anothers = IsAnothers(store->GetDatabase(), attempt);
    if (is_anothers.ok() && *is_anothers) {
      // whoever gives it hears at once that it is not kept
      if (auto gone = spool.TakeBack(attempt); !gone.ok()) return gone.error();
      return again.error();
    }
  }
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
  std::optional<base::Error> failure;
  bool has_work = true;  // of an earlier run
  bool is_ending = false;
  std::thread thread;

  /// \return whether nothing waits any more
  bool Try() {
    const Spool spool(place);
    std::optional<base::Error> why;
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

base::Status Courier::Keep(const Attempt& attempt) {
  if (auto kept = Spool(content_->place).Keep(attempt); !kept.ok()) return kept;
  {
    const std::lock_guard lock(content_->mutex);
    content_->has_work = true;
  }
  content_->changed.notify_all();
  return {};
}

std::optional<base::Error> Courier::Failure() const {
  const std::lock_guard lock(content_->mutex);
  return content_->failure;
}

}  // namespace trocar::store
