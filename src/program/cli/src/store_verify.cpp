// SPDX-License-Identifier: Apache-2.0
// Attempts of a store, replayed until each is verified, refused or known to be neither.
#include <algorithm>
#include <string>
#include <utility>

#include "console.h"
#include "store_console.h"
#include "trocar/assessment/course.h"
#include "trocar/assessment/proficiency.h"
#include "trocar/base/state_hash.h"
#include "trocar/record/outcome.h"
#include "trocar/store/keep_attempt.h"

namespace trocar::cli {
namespace {

using nlohmann::ordered_json;
using store::Verification;
using store::WhyUnverified;

/// By the thresholds that the window judges by; nothing where there are none.
std::optional<bool> JudgeStored(const store::Attempt& attempt, const record::CourseStep& step) {
  const assessment::AttemptResult result{attempt.is_completed, {attempt.metrics}};
  if (step.IsSet()) {
    const auto course = assessment::FindCourse(step.course);
    if (!course.ok()) return std::nullopt;
    const auto found = assessment::FindStep(*course, step.step);
    return found.ok() ? std::optional(assessment::Judge(found->proficiency, result).is_passed) : std::nullopt;
  }
  const auto all = assessment::ListProficiencies();
  if (!all.ok()) return std::nullopt;
  for (const assessment::Proficiency& one : *all) {
    if (one.task == attempt.task && one.level == attempt.level)
      return assessment::Judge(one, result).is_passed;
  }
  return std::nullopt;
}

/// What a replay makes of a stored attempt.
base::Result<store::Attempt> ReplayStored(const store::Attempt& stored, int threads, const char* label) {
  store::Attempt attempt = stored;
  const auto cannot = [&](WhyUnverified why) {
    if (attempt.mark.state == Verification::kUnverified) attempt.mark.why = why;
    return attempt;
  };
  if (stored.recording.empty()) return cannot(WhyUnverified::kNoRecording);
  auto recording = record::ReadRecording(stored.recording);
  if (!recording.ok() || base::HashText(recording->file_id) != stored.recording_id ||
      recording->description.started != stored.started)
    return cannot(WhyUnverified::kNoRecording);
  const record::CourseStep step = record::FindCourseStep(stored.outcome);
  const bool is_part = step.IsSet() && recording->description.kind == record::Description::Kind::kOperation;
  auto replayed = ReplayHere(std::move(*recording), stored.recording, threads, label);
  if (!replayed.ok()) {
    if (replayed.error().code == base::ErrorCode::kCancelled) return replayed;
    return cannot(WhyUnverified::kNoRecording);
  }
  const bool is_refused = replayed->mark.state == Verification::kRefused;
  if (!replayed->mark.IsVerified() && !is_refused) return cannot(replayed->mark.why);
  // a step's own end is not the operation's
  if (is_part && !is_refused) return cannot(WhyUnverified::kSavedState);
  attempt.mark = replayed->mark;
  attempt.is_completed = replayed->is_completed;
  attempt.score = replayed->score;
  attempt.seconds = replayed->seconds;
  attempt.metrics = replayed->metrics;
  attempt.outcome = replayed->outcome;
  if (step.IsSet()) attempt.outcome = record::WithCourseStep(attempt.outcome, step);
  attempt.is_passed = JudgeStored(attempt, step);
  return attempt;
}

}  // namespace

base::Result<store::Attempt> ReplayHere(record::Recording recording, const std::string& file, int threads,
                                        const char* label) {
  store::ReplayChoice choice;
  choice.threads = threads;
  host::ProgressBar progress(label, 1.0);
  choice.progress = [&progress](double share) { return progress.Show(share), true; };
  auto attempt = store::ReplayAttempt(std::move(recording), file, choice);
  progress.Finish();
  return attempt;
}

base::Status ReplayAttempts(StoreSession& session, const ReplayArguments& arguments, bool is_json,
                            Outcome& outcome) {
  constexpr int kAtOnce = 100;
  std::size_t verified = 0, refused = 0, accepted = 0, left = 0;
  ordered_json rows = ordered_json::array();
  for (std::int64_t after = 0;;) {
    const auto page = ListUnverified(session.store, session.viewer, after, kAtOnce);
    if (!page.ok()) return page.error();
    if (page->empty()) break;
    for (const store::StoredAttempt& stored : *page) {
      after = stored.id;
      auto attempt = ReplayStored(stored.attempt, arguments.threads, "replaying");
      if (!attempt.ok()) return attempt.error();
      if (arguments.accepts && attempt->mark.state == Verification::kUnverified)
        attempt->mark.state = Verification::kAccepted;
      // each is kept at once: whoever ends this goes on here
      if (auto kept = UpdateAttempt(session.store, session.viewer, *attempt); !kept.ok()) {
        if (kept.error().code == base::ErrorCode::kStoreUnknown) continue;
        return kept;
      }
      const Verification state = attempt->mark.state;
      ++(attempt->mark.IsVerified()         ? verified
         : state == Verification::kRefused  ? refused
         : state == Verification::kAccepted ? accepted
                                            : left);
      if (is_json) {
        rows.push_back({{"id", stored.id},
                        {"state", store::VerificationName(state)},
                        {"why", store::WhyName(attempt->mark.why)}});
      } else if (!attempt->mark.IsVerified()) {
        host::Say("{1} {2}: {3}\n", Shown(attempt->started), Shown(attempt->task),
                  host::Translate(DescribeMark(attempt->mark)));
      }
    }
  }
  outcome.has_finding = refused > 0;
  if (is_json)
    PrintStoreJson({{"verified", verified},
                    {"refused", refused},
                    {"accepted", accepted},
                    {"not_verified", left},
                    {"attempts", std::move(rows)}});
  else
    host::Say("{1} attempts are verified, {2} refused, {3} count as accepted, {4} stay not verified\n",
              verified, refused, accepted, left);
  return {};
}

}  // namespace trocar::cli
