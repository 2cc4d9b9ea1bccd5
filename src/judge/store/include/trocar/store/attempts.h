// SPDX-License-Identifier: Apache-2.0
/// \file attempts.h  Attempts with their metrics, remarks, ratings and certificates; a trainee's history by pages; how
/// a value compares with a group.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/store/people.h"
#include "trocar/store/store.h"
#include "trocar/training/metric_value.h"

namespace trocar::store {

/// Whether what is kept of an attempt was computed by playing its recording again, or is what a file says.
enum class Verification : std::uint8_t {
  kUnverified,    ///< as a file says; it counts nowhere until it was replayed
  kVerified,      ///< replayed from the first tick: it is what came out
  kRecordedHere,  ///< the window recorded it here, and a replay measured it
  kAccepted,  ///< as a file says, and counts: kept by a version that did not ask, or let through by an administrator
  kRefused  ///< replayed, and its file says otherwise: what came out is kept, and counts nowhere
};
/// "unverified", "verified", "recorded_here", "accepted", "refused".
std::string_view VerificationName(Verification verification) noexcept;
std::optional<Verification> ParseVerification(std::string_view name) noexcept;

/// Why an attempt is not verified.
enum class WhyUnverified : std::uint8_t {
  kNone,
  kNotYet,        ///< nobody has replayed it
  kEarlier,       ///< kept by a version that did not ask
  kImported,      ///< came with a file of another store
  kNoRecording,   ///< there is no such recording on this computer, or another one has its name
  kOtherVersion,  ///< recorded by another version, and this one computes something else
  kSavedState,    ///< its recording begins from a saved state, of which nobody knows how it came about
  kCannotReplay,  ///< its scene or patient is missing, or not what it was
  kDiverged,      ///< refused: its states are not those that were recorded
  kOtherEnding    ///< refused: its file says that it ended otherwise
};
/// "", "not_yet", "earlier", ... as the databases and files hold it.
std::string_view WhyName(WhyUnverified why) noexcept;
std::optional<WhyUnverified> ParseWhy(std::string_view name) noexcept;

/// Verification of an attempt: its state, the reason, and the replay behind it.
struct VerificationMark {
  Verification state = Verification::kUnverified;
  WhyUnverified why = WhyUnverified::kNotYet;
  std::string program;                  ///< version that replayed it; empty: none did
  std::optional<std::int64_t> time_ms;  ///< when [ms since 1970 UTC]
  std::string claim;                    ///< of kRefused: the outcome that its file says

  /// Whether the attempt counts: in standings, places, courses and the bests.
  bool Counts() const { return state != Verification::kUnverified && state != Verification::kRefused; }
  bool IsVerified() const { return state == Verification::kVerified || state == Verification::kRecordedHere; }
};
/// For a person, untranslated; empty where it is verified: "not verified: nobody has replayed it".
std::string DescribeMark(const VerificationMark& mark);

/// One attempt. Its key is recording_id and started: the same attempt arrives once, however often it is sent.
struct Attempt {
  std::string recording_id;  ///< random id of the recording's file, 16 hexadecimal digits
  std::string started;       ///< wall clock with its offset: "2026-11-24T22:50:20+00:00"
  std::string trainee;       ///< pseudonym, or empty of nobody in particular
  std::string task;          ///< key of the task, operation or scene
  std::string level, patient;
  std::uint64_t seed = 0;
  double seconds = 0;  ///< length by ticks, which no change of the clock touches [s]
  bool is_completed = false;
  std::optional<bool> is_passed;  ///< nothing: the store judges by its thresholds, where it has any
  std::optional<double> score;    ///< of a task
  std::string outcome;            ///< JSON as record/outcome.h
  std::string recording;          ///< absolute path of its file, or empty
  std::string program;            ///< version
  std::vector<training::MetricValue> metrics;
  VerificationMark mark;

  bool CountsAsCompleted() const { return is_completed && mark.Counts(); }
};

struct StoredAttempt {
  std::int64_t id = 0;
  Attempt attempt;  ///< metrics only of FindAttempt
};

/// Milliseconds since 1970 UTC of "2026-11-24T22:50:20+01:00" (RFC 3339; fractions of seconds are allowed).
/// \return kStoreInvalid
base::Result<std::int64_t> ParseTime(std::string_view text);

/// Stores an attempt, and what it changes in the standings. Whoever can open the store may add attempts.
/// \return whether it is new; kStoreUnknown where its trainee is; kStoreInvalid where it is there as somebody else's; kStoreInvalid where it lacks its key or a number is not finite
base::Result<bool> AddAttempt(Store& store, const Attempt& attempt);

/// Gives an attempt to another person, with what it counts. Nothing where the store has no such attempt.
/// \return kStoreUnknown where the trainee is
base::Status MoveAttempt(Store& store, const Viewer& viewer, std::string_view recording_id,
                         std::string_view started, std::string_view trainee);
/// Replaces the stored result of an attempt by that of its replay, and counts the standings again.
/// \param attempt  with its key; its trainee, remarks and ratings stay
/// \return kStoreUnknown where it is gone
base::Status UpdateAttempt(Store& store, const Viewer& viewer, const Attempt& attempt);
/// Attempts that no replay has verified, the oldest first.
/// \param after  id behind which to go on
base::Result<std::vector<StoredAttempt>> ListUnverified(Store& store, const Viewer& viewer,
                                                        std::int64_t after, int limit);

/// Stores many at once, much faster than one by one: for what comes from elsewhere. They are not judged by thresholds.
/// \return how many are new; all are stored, or none
base::Result<std::int64_t> AddAttempts(Store& store, const Viewer& viewer, std::span<const Attempt> attempts);

/// Which attempts.
struct AttemptFilter {
  std::string trainee;  ///< pseudonym; empty: of everyone whom the viewer may see
  std::string group;    ///< name; empty: any
  std::string task;     ///< empty: any
};

/// One page of attempts, the newest first.
struct AttemptPage {
  std::vector<StoredAttempt> attempts;
  std::string next;  ///< where the next page begins, for `page`; empty after the last
};

/// \param page   empty: the newest; else AttemptPage::next
/// \param limit  1 to 1000
base::Result<AttemptPage> ListAttempts(Store& store, const Viewer& viewer, const AttemptFilter& filter,
                                       const std::string& page = {}, int limit = 20);
/// With its metrics. \return kStoreUnknown
base::Result<StoredAttempt> FindAttempt(Store& store, const Viewer& viewer, std::int64_t id);

/// A remark of an instructor at a moment of an attempt.
struct Remark {
  std::int64_t tick = 0;
  std::string text;
  std::string author;  ///< pseudonym; empty: the owner
};
base::Status AddRemark(Store& store, const Viewer& viewer, std::int64_t attempt, std::int64_t tick,
                       std::string_view text);
base::Result<std::vector<Remark>> ListRemarks(Store& store, const Viewer& viewer, std::int64_t attempt);

/// One item of a rating form. GOALS (Vassiliou 2005) and OSATS (Martin 1997) give 1 to 5.
struct Rating {
  std::string form;  ///< "GOALS" or "OSATS"
  std::string item;
  int value = 0;
  std::string rater;  ///< pseudonym
};
/// Replaces what this rater gave this item before. \return kStoreRefused where the viewer is no person of the store
base::Status AddRating(Store& store, const Viewer& viewer, std::int64_t attempt, const Rating& rating);
base::Result<std::vector<Rating>> ListRatings(Store& store, const Viewer& viewer, std::int64_t attempt);

/// The signed text of an exam.
struct Certificate {
  std::string key;      ///< unique
  std::string trainee;  ///< pseudonym, or empty
  std::string text;
};
/// Again with the same text does nothing. \return kStoreInvalid where the key is there with another
base::Status AddCertificate(Store& store, const Viewer& viewer, const Certificate& certificate);
base::Result<std::vector<Certificate>> ListCertificates(Store& store, const Viewer& viewer,
                                                        std::string_view trainee);

/// Of which number.
struct MetricKey {
  std::string task, level;
  std::string metric, hand, phase,
      tool;  ///< as training::MetricValue; "score" and "seconds" are of every attempt
};

/// A trainee's completed attempts in one number, of whole attempts: MetricKey's phase and tool are empty (kStoreInvalid else).
struct Standing {
  std::int64_t attempts = 0;
  double latest = 0, lowest = 0, highest = 0;
};
/// \return nothing where there is no completed attempt
base::Result<std::optional<Standing>> FindStanding(Store& store, const Viewer& viewer,
                                                   std::string_view trainee, const MetricKey& key);

/// Which of a trainee's attempts counts in a group.
enum class Counted : std::uint8_t { kLatest, kLowest, kHighest };

/// Trainees see how they compare only with groups of at least so many.
inline constexpr std::int64_t kFewestTrainees = 5;

/// How a value compares: each trainee counts once, so that those who try often do not decide.
struct Percentile {
  std::int64_t below = 0, equal = 0, trainees = 0;

  /// Share of the trainees below, those with the same value by half, in percent; 0 without trainees.
  /// Source: percentile rank, Roscoe 1975.
  double Percent() const {
    return trainees == 0 ? 0
                         : 100.0 * (static_cast<double>(below) + 0.5 * static_cast<double>(equal)) /
                               static_cast<double>(trainees);
  }
};
/// \param group  name; empty: all trainees, which only administrators see
/// \return kStoreRefused also where a trainee asks about so few that values would show whose they are (kFewestTrainees)
base::Result<Percentile> CalcPercentile(Store& store, const Viewer& viewer, std::string_view group,
                                        const MetricKey& key, double value,
                                        Counted counted = Counted::kLatest);
/// The values of a group's trainees, ascending, without whose they are.
base::Result<std::vector<double>> ListGroupValues(Store& store, const Viewer& viewer, std::string_view group,
                                                  const MetricKey& key, Counted counted = Counted::kLatest);

}  // namespace trocar::store
