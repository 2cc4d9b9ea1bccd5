// SPDX-License-Identifier: Apache-2.0
#include "trocar/centre/attempt_filing.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>
#include <utility>

#include "trocar/host/file_lock.h"
#include "trocar/host/json_text.h"
#include "trocar/host/log.h"
#include "trocar/host/safe_file.h"
#include "trocar/store/keep_attempt.h"

namespace trocar::centre {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;

/// Of an attempt that is not measured yet: written as the spool writes attempts, so that erasing a person finds it.
constexpr const char* kNoteFolder = "unmeasured";
constexpr std::chrono::seconds kLook{2};  // between looks at the spool

fs::path NoteFolder(const store::Place& place) {
  return place.SpoolFolder() / kNoteFolder;
}

}  // namespace

struct AttemptFiling::Content {
  /// An attempt and whose it is, as it was when it began.
  struct Note {
    fs::path file;
    store::Attempt attempt;
    std::optional<host::FileLock> lock;  // other programs leave it alone
    bool is_written = false;             // what cannot be written is known to this program alone
  };
  struct Work {
    enum class Kind { kBegin, kEnd } kind = Kind::kBegin;
    fs::path recording;
    std::string person;
    StepName step;
  };

  Access access;
  int threads;
  std::function<void()> on_news;
  store::Courier courier;
  std::map<fs::path, Note> notes;  // of recordings; of the thread

  mutable std::mutex mutex;
  std::condition_variable changed;
  std::deque<Work> work;
  std::string person;
  FilingStatus status;
  std::optional<Error> away;  // why the courier waits
  std::vector<FiledAttempt> filed;
  std::atomic<bool> is_ending{false};
  std::thread thread;

  Content(Access taken, int count, std::function<void()> news)
      : access(std::move(taken)),
        threads(count),
        on_news(std::move(news)),
        courier(access.place, access.settings) {}

  void Add(Work one) {
    {
      const std::lock_guard lock(mutex);
      one.person = person;
      if (one.kind == Work::Kind::kEnd) ++status.measuring;
      work.push_back(std::move(one));
    }
    changed.notify_one();
  }

  void Fail(const Error& error) {
    host::Log(host::LogLevel::kWarning, error.Text());
    const std::lock_guard lock(mutex);
    status.failure = error;
  }

  /// Notes an attempt that has begun.
  void Begin(const Work& one) {
    Note note;
    note.attempt.trainee = one.person;
    note.attempt.recording = one.recording.string();
    nlohmann::json outcome = nlohmann::json::object();
    if (one.step.IsSet()) outcome["course"] = {{"course", one.step.course}, {"step", one.step.step}};
    note.attempt.outcome = host::FormatJson(outcome);
    std::error_code ignored;
    fs::create_directories(NoteFolder(access.place), ignored);  // what cannot be made cannot be locked
    fs::permissions(NoteFolder(access.place), fs::perms::owner_all, ignored);
    note.file = NoteFolder(access.place) / (one.recording.stem().string() + ".json");
    if (const base::Status written = Write(note); !written.ok()) Fail(written.error());
    notes.insert_or_assign(one.recording, std::move(note));
  }

  static base::Status Write(Note& note) {
    auto lock = host::FileLock::Take(fs::path(note.file).replace_extension(".lock"));
    if (!lock.ok()) return lock.error();
    const auto written = host::WriteFile(note.file, store::WriteAttemptJson(note.attempt));
    if (!written.ok()) return written;
    std::error_code ignored;
    fs::permissions(note.file, fs::perms::owner_read | fs::perms::owner_write, ignored);
    note.lock = std::move(*lock);
    note.is_written = true;
    return {};
  }

  void Forget(const fs::path& recording) {
    const auto found = notes.find(recording);
    if (found == notes.end()) return;
    std::error_code ignored;
    // without a lock it may be another program's
    if (found->second.is_written) fs::remove(found->second.file, ignored);
    notes.erase(found);
  }

  /// What other programs noted and did not come to: they were closed or killed.
  void AdoptNotes() {
    std::error_code failure;
    for (const auto& entry : fs::directory_iterator(NoteFolder(access.place), failure)) {
      if (entry.path().extension() != ".json") continue;
      auto lock = host::FileLock::Take(fs::path(entry.path()).replace_extension(".lock"));
      if (!lock.ok()) continue;  // that program still runs
      const auto text = host::ReadFile(entry.path());
      auto attempt = text.ok() ? store::ReadAttemptJson(*text, entry.path().filename().string())
                               : base::Result<store::Attempt>(text.error());
      if (!attempt.ok()) {
        host::Log(host::LogLevel::kWarning, attempt.error().Text());
        continue;
      }
      Work one{Work::Kind::kEnd, attempt->recording, attempt->trainee, FindStepName(*attempt)};
      notes.insert_or_assign(one.recording, Note{entry.path(), std::move(*attempt), std::move(*lock), true});
      const std::lock_guard guard(mutex);
      ++status.measuring;
      work.push_back(std::move(one));
    }
  }

  /// Sees what the courier came to.
  void Look() {
    const std::size_t waiting = store::Spool(access.place).CountWaiting();
    const auto why = courier.Failure();
    {
      const std::lock_guard lock(mutex);
      const bool is_same = waiting == status.waiting && why.has_value() == away.has_value();
      status.waiting = waiting;
      away = why;
      if (is_same) return;
    }
    on_news();
  }

  bool Show(double share) {
    {
      const std::lock_guard lock(mutex);
      status.progress = share;
    }
    on_news();
    return !is_ending.load();
  }

  /// Measures an attempt and gives it to the courier.
  void End(Work one) {
    // it counts for whoever began it
    if (const auto note = notes.find(one.recording); note != notes.end()) {
      one.person = note->second.attempt.trainee;
      one.step = FindStepName(note->second.attempt);
      // somebody erased the person meanwhile
      std::error_code failure;
      if (note->second.is_written && !fs::exists(note->second.file, failure)) return Forget(one.recording);
    }
    std::error_code ignored;
    FiledAttempt result;
    result.recording = one.recording;
    if (!fs::exists(one.recording, ignored)) {
      Forget(one.recording);
      result.failure =
          Error{ErrorCode::kFileMissing,
                "there is no recording of this attempt: one that lasts less than a second is not kept"};
      const std::lock_guard lock(mutex);
      filed.push_back(std::move(result));
      return;
    }
    auto judged = JudgeRecording(
        one.recording, {threads, one.step, one.person, [this](double share) { return Show(share); }});
    std::optional<store::Attempt> attempt;
    if (judged.ok()) {
      attempt = judged->attempt;
      // this program wrote the recording from the live simulation, from whatever state that began
      store::VerificationMark& mark = attempt->mark;
      if (mark.IsVerified() || mark.why == store::WhyUnverified::kSavedState)
        mark.state = store::Verification::kRecordedHere, mark.why = store::WhyUnverified::kNone;
      judged->attempt.mark = mark;
      if (judged->is_demonstration) attempt.reset();
      result.judged = std::move(*judged);
    } else {
      // the next program goes on with what this one had no time for
      if (is_ending.load()) return;
      result.failure = judged.error();
      auto described = DescribeRecording(one.recording, one.person, one.step);
      if (described.ok()) attempt = std::move(*described);
      if (attempt) attempt->mark.why = store::WhyUnverified::kCannotReplay;
    }
    if (attempt) {
      if (const auto kept = courier.Keep(*attempt); !kept.ok()) {
        Fail(kept.error());
        result.failure = kept.error();
      } else {
        Forget(one.recording);
      }
    } else {
      Forget(one.recording);
    }
    const std::lock_guard lock(mutex);
    filed.push_back(std::move(result));
  }

  void Run() {
    AdoptNotes();
    std::unique_lock lock(mutex);
    while (!is_ending.load()) {
      if (work.empty()) {
        changed.wait_for(lock, kLook);
        lock.unlock();
        Look();
        lock.lock();
        if (work.empty()) continue;
      }
      Work one = std::move(work.front());
      work.pop_front();
      status.progress = 0;
      const bool is_end = one.kind == Work::Kind::kEnd;
      lock.unlock();
      is_end ? End(std::move(one)) : Begin(one);
      if (is_end) Look();  // what waits is known before it counts as measured
      lock.lock();
      if (is_end) --status.measuring;
      lock.unlock();
      on_news();
      lock.lock();
    }
    // notes of what has begun are written, however soon the program ends
    for (const Work& one : work) {
      if (one.kind == Work::Kind::kBegin) {
        lock.unlock();
        Begin(one);
        lock.lock();
      }
    }
  }
};

AttemptFiling::AttemptFiling(Access access, int threads, std::function<void()> on_news)
    : content_(std::make_unique<Content>(std::move(access), threads, std::move(on_news))) {
  content_->person = content_->access.person;
  content_->thread = std::thread([content = content_.get()] { content->Run(); });
}

AttemptFiling::~AttemptFiling() {
  {
    const std::lock_guard lock(content_->mutex);
    content_->is_ending.store(true);
  }
  content_->changed.notify_all();
  content_->thread.join();
}

void AttemptFiling::SetPerson(const std::string& pseudonym) {
  const std::lock_guard lock(content_->mutex);
  content_->person = pseudonym;
}

void AttemptFiling::Begin(const fs::path& recording, const StepName& step) {
  content_->Add({Content::Work::Kind::kBegin, recording, {}, step});
}

void AttemptFiling::End(const fs::path& recording) {
  content_->Add({Content::Work::Kind::kEnd, recording, {}, {}});
}

FilingStatus AttemptFiling::Status() const {
  const std::lock_guard lock(content_->mutex);
  FilingStatus status = content_->status;
  if (content_->away) status.failure = content_->away;
  return status;
}

std::vector<FiledAttempt> AttemptFiling::TakeFiled() {
  const std::lock_guard lock(content_->mutex);
  return std::exchange(content_->filed, {});
}

}  // namespace trocar::centre
