// SPDX-License-Identifier: Apache-2.0
#include "trocar/centre/attempt_filing.h"

#include <algorithm>
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
#include "trocar/host/real_time.h"
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
    std::shared_ptr<LiveAttempt> live;  // null: it was not measured while it was played
  };
  /// An attempt whose recording is to be measured.
  struct Waiting {
    fs::path recording;
    std::string person;
    StepName step;
    std::unique_ptr<Replaying> going_on;  // where it was given up for a newer one
  };

  Access access;
  int threads;
  std::function<void()> on_news;
  store::Courier courier;

  mutable std::mutex mutex;
  std::condition_variable changed, has_waiting;
  std::map<fs::path, Note> notes;  // of recordings
  std::deque<Work> work;           // of the clerk
  std::map<fs::path, std::shared_ptr<LiveAttempt>> followed;
  std::vector<Waiting> waiting;      // to be replayed; their names tell the time, the newest is taken first
  std::optional<fs::path> measured;  // that is being replayed
  std::string person;
  FilingStatus status;
  std::optional<Error> away;  // why the courier waits
  std::vector<FiledAttempt> filed;
  std::atomic<bool> is_ending{false};
  std::thread clerk, replayer;

  Content(Access taken, int count, std::function<void()> news)
      : access(std::move(taken)),
        threads(count),
        on_news(std::move(news)),
        courier(access.place, access.settings) {}

  void Add(Work one) {
    {
      const std::lock_guard lock(mutex);
      one.person = person;
      if (one.kind == Work::Kind::kEnd) {
        if (const auto found = followed.find(one.recording); found != followed.end()) {
          if (found->second->is_whole_) one.live = std::move(found->second);
          followed.erase(found);
        }
        BeginCounting();
      }
      work.push_back(std::move(one));
    }
    changed.notify_one();
  }

  /// \pre locked
  void BeginCounting() {
    if (status.measuring == 0) status.measured = 0;
    ++status.measuring;
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
    const std::lock_guard lock(mutex);
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
    const std::lock_guard lock(mutex);
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
      Waiting one{attempt->recording, attempt->trainee, FindStepName(*attempt), nullptr};
      const std::lock_guard guard(mutex);
      notes.insert_or_assign(one.recording, Note{entry.path(), std::move(*attempt), std::move(*lock), true});
      BeginCounting();
      waiting.push_back(std::move(one));
    }
    has_waiting.notify_one();
  }

  /// Sees what the courier came to.
  void Look() {
    const std::size_t spooled = store::Spool(access.place).CountWaiting();
    const auto why = courier.Failure();
    {
      const std::lock_guard lock(mutex);
      const bool is_same = spooled == status.waiting && why.has_value() == away.has_value();
      status.waiting = spooled;
      away = why;
      if (is_same) return;
    }
    on_news();
  }

  /// It counts for whoever began it. \return false: somebody erased the person meanwhile
  bool UseNote(const fs::path& recording, std::string& whose, StepName& step) {
    const std::lock_guard lock(mutex);
    const auto note = notes.find(recording);
    if (note == notes.end()) return true;
    whose = note->second.attempt.trainee;
    step = FindStepName(note->second.attempt);
    std::error_code failure;
    return !note->second.is_written || fs::exists(note->second.file, failure);
  }

  void Tell(FiledAttempt result) {
    Look();  // what waits is known before it counts as measured
    {
      const std::lock_guard lock(mutex);
      filed.push_back(std::move(result));
      --status.measuring;
      ++status.measured;
    }
    on_news();
  }

  void Uncount() {
    {
      const std::lock_guard lock(mutex);
      --status.measuring;
    }
    on_news();
  }

  /// Keeps what an attempt came to.
  void File(const fs::path& recording, const std::string& whose, const StepName& step,
            base::Result<JudgedAttempt> judged) {
    FiledAttempt result;
    result.recording = recording;
    std::optional<store::Attempt> attempt;
    if (judged.ok()) {
      attempt = judged->attempt;
      if (judged->is_demonstration) attempt.reset();
      result.judged = std::move(*judged);
    } else {
      result.failure = judged.error();
      auto described = DescribeRecording(recording, whose, step);
      if (described.ok()) attempt = std::move(*described);
      if (attempt) attempt->mark.why = store::WhyUnverified::kCannotReplay;
    }
    if (attempt) {
      if (const auto kept = courier.Keep(*attempt); !kept.ok()) {
        Fail(kept.error());
        result.failure = kept.error();
        return Tell(std::move(result));
      }
    }
    Forget(recording);
    Tell(std::move(result));
  }

  /// Of an attempt that has ended: files what was measured while it was played, or leaves it to the other thread.
  void End(Work one) {
    if (!UseNote(one.recording, one.person, one.step)) {
      Forget(one.recording);
      return Uncount();
    }
    std::error_code ignored;
    if (!fs::exists(one.recording, ignored)) {
      Forget(one.recording);
      FiledAttempt result;
      result.recording = one.recording;
      result.failure =
          Error{ErrorCode::kFileMissing,
                "there is no recording of this attempt: one that lasts less than a second is not kept"};
      return Tell(std::move(result));
    }
    if (one.live != nullptr) {
      auto judged = JudgePlayed(one.recording, one.live->fold_, {threads, one.step, one.person, {}});
      if (judged.ok()) return File(one.recording, one.person, one.step, std::move(judged));
      host::Log(host::LogLevel::kWarning, "its recording is measured: " + judged.error().Text());
    }
    {
      const std::lock_guard lock(mutex);
      waiting.push_back({one.recording, one.person, one.step, nullptr});
    }
    has_waiting.notify_one();
    on_news();
  }

  void RunClerk() {
    AdoptNotes();
    std::unique_lock lock(mutex);
    while (!is_ending.load() || !work.empty()) {
      if (work.empty()) {
        changed.wait_for(lock, kLook);
        lock.unlock();
        Look();
        lock.lock();
        continue;
      }
      Work one = std::move(work.front());
      work.pop_front();
      lock.unlock();
      // what was measured is filed however soon the program ends: it takes no time
      one.kind == Work::Kind::kBegin ? Begin(one) : End(std::move(one));
      lock.lock();
    }
  }

  /// The newest: recordings are named for their time.
  std::vector<Waiting>::iterator FindNewest() {
    return std::max_element(waiting.begin(), waiting.end(), [](const Waiting& a, const Waiting& b) {
      return a.recording.filename() < b.recording.filename();
    });
  }

  /// \return false: it gives way
  bool ShowProgress(const fs::path& recording, double share) {
    bool goes_on = !is_ending.load();
    {
      const std::lock_guard lock(mutex);
      status.progress = share;
      const auto newest = FindNewest();
      if (newest != waiting.end() && newest->recording.filename() > recording.filename()) goes_on = false;
    }
    on_news();
    return goes_on;
  }

  void Measure(Waiting one) {
    if (!UseNote(one.recording, one.person, one.step)) {
      Forget(one.recording);
      return Uncount();
    }
    const JudgeSettings settings{threads, one.step, one.person,
                                 [&](double share) { return ShowProgress(one.recording, share); }};
    auto judged = JudgeRecording(one.recording, settings, &one.going_on);
    if (!judged.ok() && judged.error().code == ErrorCode::kCancelled) {
      // the next program goes on with what this one had no time for
      if (is_ending.load()) return;
      const std::lock_guard lock(mutex);
      waiting.push_back(std::move(one));
      return;
    }
    if (judged.ok()) {
      // a program of this computer wrote the recording from the live simulation, from whatever state that began
      store::VerificationMark& mark = judged->attempt.mark;
      if (mark.IsVerified() || mark.why == store::WhyUnverified::kSavedState)
        mark.state = store::Verification::kRecordedHere, mark.why = store::WhyUnverified::kNone;
    }
    File(one.recording, one.person, one.step, std::move(judged));
  }

  void RunReplayer() {
    host::TakeIdleTimeOnly();
    std::unique_lock lock(mutex);
    while (!is_ending.load()) {
      const auto newest = FindNewest();
      if (newest == waiting.end()) {
        has_waiting.wait(lock);
        continue;
      }
      Waiting one = std::move(*newest);
      waiting.erase(newest);
      measured = one.recording;
      status.progress = 0;
      lock.unlock();
      Measure(std::move(one));
      lock.lock();
      measured.reset();
    }
  }
};

AttemptFiling::AttemptFiling(Access access, int threads, std::function<void()> on_news)
    : content_(std::make_unique<Content>(std::move(access), threads, std::move(on_news))) {
  content_->person = content_->access.person;
  content_->clerk = std::thread([content = content_.get()] { content->RunClerk(); });
  content_->replayer = std::thread([content = content_.get()] { content->RunReplayer(); });
}

AttemptFiling::~AttemptFiling() {
  {
    const std::lock_guard lock(content_->mutex);
    content_->is_ending.store(true);
  }
  content_->changed.notify_all();
  content_->has_waiting.notify_all();
  content_->clerk.join();
  content_->replayer.join();
}

void AttemptFiling::SetPerson(const std::string& pseudonym) {
  const std::lock_guard lock(content_->mutex);
  content_->person = pseudonym;
}

void AttemptFiling::Begin(const fs::path& recording, const StepName& step) {
  content_->Add({Content::Work::Kind::kBegin, recording, {}, step, nullptr});
}

std::shared_ptr<LiveAttempt> AttemptFiling::Follow(const fs::path& recording,
                                                   const simulation::Simulation& simulation,
                                                   assessment::Milestone from, assessment::Milestone until) {
  auto live = std::make_shared<LiveAttempt>(assessment::AttemptFold(simulation, from, until));
  const std::lock_guard lock(content_->mutex);
  content_->followed.insert_or_assign(recording, live);
  return live;
}

void AttemptFiling::End(const fs::path& recording) {
  content_->Add({Content::Work::Kind::kEnd, recording, {}, {}, nullptr});
}

FilingStatus AttemptFiling::Status() const {
  const std::lock_guard lock(content_->mutex);
  FilingStatus status = content_->status;
  if (content_->measured) {
    const auto note = content_->notes.find(*content_->measured);
    status.pending.push_back({*content_->measured,
                              note == content_->notes.end() ? "" : note->second.attempt.trainee,
                              status.progress});
  }
  for (const Content::Waiting& one : content_->waiting)
    status.pending.push_back({one.recording, one.person, -1});
  std::sort(status.pending.begin() + (content_->measured ? 1 : 0), status.pending.end(),
            [](const PendingAttempt& a, const PendingAttempt& b) {
              return a.recording.filename() > b.recording.filename();
            });
  if (content_->away) status.failure = content_->away;
  return status;
}

std::vector<FiledAttempt> AttemptFiling::TakeFiled() {
  const std::lock_guard lock(content_->mutex);
  return std::exchange(content_->filed, {});
}

}  // namespace trocar::centre
