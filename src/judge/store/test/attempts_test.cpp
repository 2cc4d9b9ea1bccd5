// SPDX-License-Identifier: Apache-2.0
// Attempts, standings, thresholds, ratings, courses.
#include "trocar/store/attempts.h"

#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "store_test.h"
#include "trocar/store/courses.h"
#include "trocar/store/keep_attempt.h"
#include "trocar/store/maintenance.h"

namespace trocar::store {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

class Attempts : public StoreTest {};
INSTANTIATE_OVER_DATABASES(Attempts);

TEST(ParseTime, CountsFrom1970InUtc) {
  EXPECT_EQ(Get(ParseTime("1970-01-01T00:00:00Z")), 0);
  EXPECT_EQ(Get(ParseTime("1970-01-01T01:30:00+01:30")), 0);
  EXPECT_EQ(Get(ParseTime("1969-12-31T19:00:00-05:00")), 0);
  EXPECT_EQ(Get(ParseTime("2038-01-19T03:14:08Z")), 2147483648000);  // one second beyond 31 bits
  EXPECT_EQ(Get(ParseTime("2024-02-29T12:00:00.250+00:00")), 1709208000250);
  EXPECT_EQ(Get(ParseTime("2016-12-31T23:59:60Z")), 1483228800000);  // a leap second is the next one's start
  for (const char* text :
       {"", "2026-11-24", "2026-11-24T22:50:20", "2026-13-01T00:00:00Z", "2026-02-30T00:00:00Z",
        "2026-11-24T24:00:00Z", "2026-11-24T22:50:20+25:00", "2026-11-24T22:50:20Zx", "2026-11-24 22:50:20Z",
        "x026-11-24T22:50:20Z", "2026-11-24T22:50:20+01"})
    EXPECT_FALSE(ParseTime(text).ok()) << text;
}

TEST_P(Attempts, AreKeptWhole) {
  Attempt attempt = MakeAttempt(1, Add(Role::kTrainee));
  attempt.seed = std::numeric_limits<std::uint64_t>::max();
  attempt.patient = "variant 12";
  attempt.seconds = 0.1 + 0.2;
  attempt.score = -1.0 / 3.0;
  attempt.is_passed = false;
  attempt.recording = "/home/x/a.trocar";
  attempt.metrics = {{"blood", "", "", 5e-324, ""},
                     {"path_length", "left", "clip", 1.7976931348623157e308, "hook"}};
  EXPECT_TRUE(Get(AddAttempt(Open(), attempt)));
  Reopen();
  const AttemptPage page = Get(ListAttempts(Open(), kOwner, {attempt.trainee, "", "peg_transfer"}));
  ASSERT_THAT(page.attempts, SizeIs(1));
  const Attempt read = Get(FindAttempt(Open(), kOwner, page.attempts[0].id)).attempt;
  Attempt expected = attempt;
  expected.metrics = {attempt.metrics[0],
                      attempt.metrics[1],
                      {"score", "", "", *attempt.score, ""},
                      {"seconds", "", "", attempt.seconds, ""}};
  EXPECT_EQ(WriteAttemptJson(read), WriteAttemptJson(expected));
}

TEST_P(Attempts, ArriveOnce) {
  Attempt attempt = MakeAttempt(1, Add(Role::kTrainee));
  EXPECT_TRUE(Get(AddAttempt(Open(), attempt)));
  attempt.score = 99;  // the first one stays
  EXPECT_FALSE(Get(AddAttempt(Open(), attempt)));
  EXPECT_EQ(Count("attempt"), 1);
  const auto standing =
      Get(FindStanding(Open(), kOwner, attempt.trainee, {"peg_transfer", "easy", "score", "", "", ""}));
  ASSERT_TRUE(standing.has_value());
  EXPECT_EQ(standing->attempts, 1);
  EXPECT_EQ(standing->latest, 1);
  attempt.started = "2026-01-01T00:00:01+01:00";  // the recording of another time is another attempt
  EXPECT_TRUE(Get(AddAttempt(Open(), attempt)));
}

TEST_P(Attempts, StayWhoseTheyAre) {
  const std::string one = Add(Role::kTrainee), other = Add(Role::kTrainee);
  const MetricKey key{"peg_transfer", "easy", "score", "", "", ""};
  EXPECT_TRUE(Get(AddAttempt(Open(), MakeAttempt(1, one))));
  EXPECT_FALSE(Get(AddAttempt(Open(), MakeAttempt(1, one)))) << "the control: again for the same";
  for (const std::string& who : {other, std::string()})
    EXPECT_CODE(AddAttempt(Open(), MakeAttempt(1, who)), kStoreInvalid);
  EXPECT_TRUE(Get(AddAttempt(Open(), MakeAttempt(2, ""))));
  EXPECT_CODE(AddAttempt(Open(), MakeAttempt(2, one)), kStoreInvalid);
  // through the spool it is held, and not called damaged
  const Spool spool(place_);
  EXPECT_GOOD(spool.Keep(MakeAttempt(1, other)));
  EXPECT_CODE(spool.Keep(MakeAttempt(1, one)), kStoreInvalid);
  const DeliveryReport report = spool.Deliver(Open());
  EXPECT_FALSE(report.failure);
  EXPECT_EQ(report.held, 1);
  EXPECT_EQ(report.damaged, 0);
  EXPECT_EQ(spool.CountHeld(), 1u);
  EXPECT_CODE(KeepAttempt(place_, MakeAttempt(1, other)), kStoreInvalid);
  EXPECT_EQ(spool.CountHeld(), 0u) << "whoever was told keeps it";
  EXPECT_EQ(Get(ListAttempts(Open(), kOwner, {one, "", ""})).attempts.size(), 1u);
  // an administrator gives it over, with what it counts
  EXPECT_CODE(MoveAttempt(Open(), Get(FindViewer(Open(), other)), MakeAttempt(1, "").recording_id,
                          MakeAttempt(1, "").started, other),
              kStoreRefused);
  EXPECT_GOOD(
      MoveAttempt(Open(), kOwner, MakeAttempt(1, "").recording_id, MakeAttempt(1, "").started, other));
  EXPECT_FALSE(Get(FindStanding(Open(), kOwner, one, key)).has_value());
  EXPECT_TRUE(Get(FindStanding(Open(), kOwner, other, key)).has_value());
  EXPECT_FALSE(Get(AddAttempt(Open(), MakeAttempt(1, other))));
  EXPECT_GOOD(Verify(Open()));
}

TEST_P(Attempts, ThatAreNotWholeAreRefused) {
  const Attempt good = MakeAttempt(1, Add(Role::kTrainee));
  const auto expect_refused = [&](const std::function<void(Attempt&)>& spoil) {
    Attempt attempt = good;
    spoil(attempt);
    EXPECT_CODE(AddAttempt(Open(), attempt), kStoreInvalid);
  };
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  expect_refused([](Attempt& a) { a.recording_id.clear(); });
  expect_refused([](Attempt& a) { a.task.clear(); });
  expect_refused([](Attempt& a) { a.started = "yesterday"; });
  expect_refused([](Attempt& a) { a.task = std::string(2000, 'x'); });
  expect_refused([&](Attempt& a) { a.seconds = nan; });
  expect_refused([&](Attempt& a) { a.score = infinite; });
  expect_refused([&](Attempt& a) { a.metrics[0].value = nan; });
  expect_refused([](Attempt& a) { a.metrics[0].metric.clear(); });
  expect_refused([](Attempt& a) { a.metrics.push_back(a.metrics[0]); });  // the same number twice
  Attempt unknown = good;
  unknown.trainee = "T-NOBODY";
  EXPECT_CODE(AddAttempt(Open(), unknown), kStoreUnknown);
  // nothing of them is left, not even half
  EXPECT_EQ(Count("attempt"), 0);
  EXPECT_EQ(Count("metric"), 0);
  EXPECT_EQ(Count("standing"), 0);
}

TEST_P(Attempts, ArePagedNewestFirst) {
  const std::string one = Add(Role::kTrainee), other = Add(Role::kTrainee);
  EXPECT_GOOD(AddGroup(Open(), kOwner, "evening"));
  EXPECT_GOOD(JoinGroup(Open(), kOwner, "evening", one));
  for (int i = 0; i < 30; ++i) {
    Attempt attempt = MakeAttempt(i, i % 3 == 0 ? other : one, i % 2 == 0 ? "peg_transfer" : "clipping");
    attempt.started = MakeAttempt(i / 4, "").started;  // four at the same moment
    EXPECT_TRUE(Get(AddAttempt(Open(), attempt)));
  }
  const auto read_all = [&](const AttemptFilter& filter) {
    std::vector<StoredAttempt> all;
    std::string page;
    do {
      const AttemptPage part = Get(ListAttempts(Open(), kOwner, filter, page, 7));
      EXPECT_LE(part.attempts.size(), 7u);
      all.insert(all.end(), part.attempts.begin(), part.attempts.end());
      page = part.next;
    } while (!page.empty());
    std::set<std::int64_t> ids;
    for (std::size_t i = 0; i < all.size(); ++i) {
      ids.insert(all[i].id);
      if (i == 0) continue;
      EXPECT_GE(*ParseTime(all[i - 1].attempt.started), *ParseTime(all[i].attempt.started));
    }
    EXPECT_EQ(ids.size(), all.size()) << "an attempt is on two pages";
    return all.size();
  };
  EXPECT_EQ(read_all({}), 30u);
  EXPECT_EQ(read_all({one, "", ""}), 20u);
  EXPECT_EQ(read_all({"", "evening", ""}), 20u);
  EXPECT_EQ(read_all({one, "", "clipping"}), 10u);
  // a group that is small among many people is read another way
  for (int i = 0; i < 210; ++i) Add(Role::kTrainee);
  EXPECT_EQ(read_all({"", "evening", ""}), 20u);
  EXPECT_CODE(ListAttempts(Open(), kOwner, {}, "1.x"), kUsage);
  EXPECT_CODE(ListAttempts(Open(), kOwner, {}, "", 0), kUsage);
}

TEST_P(Attempts, ArePassedByTheThresholds) {
  const std::string trainee = Add(Role::kTrainee);
  const auto passed = [&](int number, double seconds, bool is_completed = true) {
    Attempt attempt = MakeAttempt(number, trainee);
    attempt.seconds = seconds;
    attempt.is_completed = is_completed;
    EXPECT_TRUE(Get(AddAttempt(Open(), attempt)));
    return Get(ListAttempts(Open(), kOwner, {})).attempts.at(0).attempt.is_passed;
  };
  EXPECT_EQ(passed(1, 10), std::nullopt);
  EXPECT_GOOD(
      SetThreshold(Open(), kOwner, {{"peg_transfer", "easy", "seconds", "", "", ""}, 48, false, "FLS"}));
  EXPECT_GOOD(SetThreshold(Open(), kOwner, {{"peg_transfer", "easy", "score", "", "", ""}, 3, true, "ours"}));
  EXPECT_EQ(passed(2, 40), false);  // score 2
  EXPECT_EQ(passed(3, 48), true);
  EXPECT_EQ(passed(4, 48.5), false);
  EXPECT_EQ(passed(5, 40, false), false);
  EXPECT_GOOD(
      SetThreshold(Open(), kOwner, {{"peg_transfer", "easy", "undefined", "", "", ""}, 3, true, "ours"}));
  EXPECT_EQ(passed(6, 40), false) << "a metric that the attempt lacks is not passed";
  EXPECT_THAT(Get(ListThresholds(Open(), "peg_transfer", "easy")), SizeIs(3));
}

// Oracle: standings and percentiles against all attempts, counted one by one, whatever the order in which they arrive.
TEST_P(Attempts, CountInTheStandings) {
  std::vector<std::string> trainees;
  EXPECT_GOOD(AddGroup(Open(), kOwner, "all"));
  for (int i = 0; i < 6; ++i) {
    trainees.push_back(Add(Role::kTrainee));
    if (i < 5) EXPECT_GOOD(JoinGroup(Open(), kOwner, "all", trainees.back()));
  }
  std::vector<Attempt> attempts;
  std::mt19937 random(11);
  for (int i = 0; i < 120; ++i) {
    Attempt attempt =
        MakeAttempt(i, trainees[random() % trainees.size()], random() % 2 ? "peg_transfer" : "clipping");
    attempt.is_completed = random() % 5 != 0;
    attempt.score = static_cast<double>(random() % 10);
    attempts.push_back(attempt);
  }
  std::shuffle(attempts.begin(), attempts.end(), random);
  for (const Attempt& attempt : attempts) EXPECT_TRUE(Get(AddAttempt(Open(), attempt)));
  const MetricKey key{"peg_transfer", "easy", "score", "", "", ""};
  std::vector<double> latest_of_group;
  for (std::size_t t = 0; t < trainees.size(); ++t) {
    Standing expected;
    std::int64_t latest_ms = 0;
    for (const Attempt& a : attempts) {
      if (a.trainee != trainees[t] || a.task != key.task || !a.is_completed) continue;
      expected.lowest = expected.attempts == 0 ? *a.score : std::min(expected.lowest, *a.score);
      expected.highest = expected.attempts == 0 ? *a.score : std::max(expected.highest, *a.score);
      ++expected.attempts;
      if (*ParseTime(a.started) >= latest_ms) latest_ms = *ParseTime(a.started), expected.latest = *a.score;
    }
    const auto standing = Get(FindStanding(Open(), kOwner, trainees[t], key));
    ASSERT_TRUE(standing.has_value());
    EXPECT_EQ(standing->attempts, expected.attempts);
    EXPECT_EQ(standing->latest, expected.latest);
    EXPECT_EQ(standing->lowest, expected.lowest);
    EXPECT_EQ(standing->highest, expected.highest);
    if (t < 5) latest_of_group.push_back(expected.latest);
  }
  for (const double value : {-1.0, 3.0, 5.0, 20.0}) {
    const Percentile percentile = Get(CalcPercentile(Open(), kOwner, "all", key, value));
    EXPECT_EQ(percentile.trainees, 5);
    EXPECT_EQ(percentile.below, std::count_if(latest_of_group.begin(), latest_of_group.end(),
                                              [&](double other) { return other < value; }));
    EXPECT_EQ(percentile.equal, std::count(latest_of_group.begin(), latest_of_group.end(), value));
  }
  std::sort(latest_of_group.begin(), latest_of_group.end());
  EXPECT_EQ(Get(ListGroupValues(Open(), kOwner, "all", key)), latest_of_group);
  EXPECT_EQ(Get(CalcPercentile(Open(), kOwner, "", key, 100)).trainees, 6);
  EXPECT_CODE(CalcPercentile(Open(), kOwner, "all", {"peg_transfer", "easy", "score", "", "clip", ""}, 1),
              kStoreInvalid);
  EXPECT_GOOD(Verify(Open()));
  // a trainee sees how they compare with five, and not with four
  const Viewer trainee = Get(FindViewer(Open(), trainees[0]));
  EXPECT_GOOD(CalcPercentile(Open(), trainee, "all", key, 3));
  EXPECT_GOOD(LeaveGroup(Open(), kOwner, "all", trainees[4]));
  EXPECT_CODE(CalcPercentile(Open(), trainee, "all", key, 3), kStoreRefused);
  EXPECT_CODE(ListGroupValues(Open(), trainee, "all", key), kStoreRefused);
  // control: what was tampered with is found
  EXPECT_TRUE(
      Open().GetDatabase().Run("UPDATE standing SET lowest = lowest - 1 WHERE metric = 'score'").ok());
  EXPECT_CODE(Verify(Open()), kStoreDamaged);
}

// Oracle: many at once are what they are one by one.
TEST_P(Attempts, AreTheSameManyAtOnce) {
  std::vector<Attempt> attempts;
  const std::string one = Add(Role::kTrainee), other = Add(Role::kTrainee);
  for (int i = 0; i < 170; ++i) {
    attempts.push_back(MakeAttempt(i,
                                   i % 5 == 0   ? ""
                                   : i % 2 == 0 ? one
                                                : other,
                                   i % 3 == 0 ? "clipping" : "peg_transfer"));
    attempts.back().is_completed = i % 7 != 0;
  }
  attempts.push_back(attempts[3]);  // twice in the same call
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(Get(AddAttempt(Open(), attempts[static_cast<std::size_t>(i)])));
  EXPECT_EQ(Get(AddAttempts(Open(), kOwner, attempts)), 160);
  EXPECT_EQ(Get(AddAttempts(Open(), kOwner, attempts)), 0);
  auto slow = Store::Open(MakePlace("slow"));
  ASSERT_TRUE(slow.ok());
  for (const auto& person : {one, other}) EXPECT_GOOD(AddPerson(*slow, kOwner, Role::kTrainee, person));
  for (const Attempt& attempt : attempts) EXPECT_GOOD(AddAttempt(*slow, attempt));
  EXPECT_GOOD(Verify(Open()));
  for (const char* sql : {"SELECT task, level, metric, hand, person_id, attempts, latest, latest_ms, lowest, "
                          "highest FROM standing ORDER "
                          "BY 1, 2, 3, 4, 5",
                          "SELECT recording_id, metric.metric, hand, phase, tool, value FROM metric JOIN "
                          "attempt ON attempt.id = "
                          "attempt_id ORDER BY 1, 2, 3, 4, 5"}) {
    const auto fast_rows = Open().GetDatabase().Run(sql), slow_rows = slow->GetDatabase().Run(sql);
    ASSERT_TRUE(fast_rows.ok() && slow_rows.ok());
    ASSERT_EQ(fast_rows->rows.size(), slow_rows->rows.size());
    for (std::size_t i = 0; i < fast_rows->rows.size(); ++i)
      EXPECT_EQ(fast_rows->rows[i].values, slow_rows->rows[i].values);
  }
  attempts[100].recording_id = "new", attempts[100].trainee = "T-NOBODY";
  EXPECT_CODE(AddAttempts(Open(), kOwner, attempts), kStoreUnknown);
}

TEST(Percentile, CountsTheSameByHalf) {
  EXPECT_EQ((Percentile{3, 2, 10}).Percent(), 40);
  EXPECT_EQ(Percentile{}.Percent(), 0);
}

TEST_P(Attempts, CarryRemarksAndRatings) {
  const std::string trainee = Add(Role::kTrainee), rater = Add(Role::kInstructor);
  EXPECT_GOOD(AddGroup(Open(), kOwner, "g"));
  for (const std::string& person : {trainee, rater}) EXPECT_GOOD(JoinGroup(Open(), kOwner, "g", person));
  EXPECT_TRUE(Get(AddAttempt(Open(), MakeAttempt(1, trainee))));
  const std::int64_t id = Get(ListAttempts(Open(), kOwner, {})).attempts.at(0).id;
  const Viewer viewer = Get(FindViewer(Open(), rater));
  EXPECT_GOOD(AddRemark(Open(), viewer, id, 480, "look at the left hand"));
  EXPECT_GOOD(AddRemark(Open(), kOwner, id, 120, "well"));
  EXPECT_CODE(AddRemark(Open(), viewer, id, -1, "x"), kStoreInvalid);
  const auto remarks = Get(ListRemarks(Open(), kOwner, id));
  ASSERT_THAT(remarks, SizeIs(2));
  EXPECT_EQ(remarks[0].author, "");
  EXPECT_EQ(remarks[1].author, rater);
  EXPECT_EQ(remarks[1].tick, 480);
  EXPECT_GOOD(AddRating(Open(), viewer, id, {"GOALS", "tissue_handling", 3, ""}));
  EXPECT_GOOD(AddRating(Open(), viewer, id, {"GOALS", "tissue_handling", 4, ""}));
  EXPECT_GOOD(AddRating(Open(), viewer, id, {"OSATS", "flow_and_planning", 5, ""}));
  EXPECT_CODE(AddRating(Open(), viewer, id, {"OSATS", "autonomy", 5, ""}), kStoreInvalid);
  EXPECT_CODE(AddRating(Open(), viewer, id, {"GOALS", "efficiency", 6, ""}), kStoreInvalid);
  EXPECT_CODE(AddRating(Open(), kOwner, id, {"GOALS", "efficiency", 3, ""}), kStoreRefused);
  const auto ratings = Get(ListRatings(Open(), kOwner, id));
  ASSERT_THAT(ratings, SizeIs(2));
  EXPECT_EQ(ratings[0].value, 4);
  const Certificate certificate{"c-1", trainee, "signed"};
  EXPECT_GOOD(AddCertificate(Open(), kOwner, certificate));
  EXPECT_GOOD(AddCertificate(Open(), kOwner, certificate));
  EXPECT_CODE(AddCertificate(Open(), kOwner, {"c-1", trainee, "forged"}), kStoreInvalid);
  EXPECT_THAT(Get(ListCertificates(Open(), kOwner, trainee)), SizeIs(1));
}

TEST_P(Attempts, BelongToCoursesWithDates) {
  const std::string trainee = Add(Role::kTrainee);
  EXPECT_GOOD(AddGroup(Open(), kOwner, "g"));
  EXPECT_GOOD(JoinGroup(Open(), kOwner, "g", trainee));
  Course course{"basic",
                1,
                R"({"title": "Basic skills"})",
                {{"a", "peg_transfer", "easy"}, {"b", "clipping", "normal"}}};
  EXPECT_GOOD(AddCourse(Open(), kOwner, course));
  EXPECT_GOOD(AddCourse(Open(), kOwner, course));
  Course changed = course;
  changed.text = "{}";
  EXPECT_CODE(AddCourse(Open(), kOwner, changed), kStoreInvalid);
  changed.version = 2;
  EXPECT_GOOD(AddCourse(Open(), kOwner, changed));
  changed.version = 3, changed.steps[1].key = "a";
  EXPECT_CODE(AddCourse(Open(), kOwner, changed), kStoreInvalid);
  EXPECT_EQ(Get(FindCourse(Open(), "basic")).version, 2);
  EXPECT_EQ(Get(FindCourse(Open(), "basic", 1)).text, course.text);
  EXPECT_EQ(Get(FindCourse(Open(), "basic", 1)).steps.at(1).task, "clipping");
  EXPECT_CODE(FindCourse(Open(), "basic", 7), kStoreUnknown);
  EXPECT_THAT(Get(ListCourses(Open())), SizeIs(1));
  EXPECT_GOOD(AddAssignment(Open(), kOwner, {"basic", 1, "", "g", 9000, {{"a", 5000}}}));
  EXPECT_GOOD(AddAssignment(Open(), kOwner, {"basic", 2, trainee, "", 8000, {}}));
  EXPECT_GOOD(AddAssignment(Open(), kOwner, {"basic", 2, trainee, "", 7000, {}}));
  EXPECT_CODE(AddAssignment(Open(), kOwner, {"basic", 1, "", "g", {}, {{"z", 1}}}), kStoreInvalid);
  EXPECT_CODE(AddAssignment(Open(), kOwner, {"other", 1, "", "g", {}, {}}), kStoreUnknown);
  const auto assignments = Get(ListAssignments(Open(), kOwner, trainee));
  ASSERT_THAT(assignments, SizeIs(2));
  EXPECT_EQ(assignments[0].due_ms, 7000);
  EXPECT_EQ(assignments[0].trainee, trainee);
  EXPECT_EQ(assignments[1].group, "g");
  ASSERT_THAT(assignments[1].step_due, SizeIs(1)) << "a refused change must change nothing";
  EXPECT_EQ(assignments[1].step_due[0].due_ms, 5000);
}

}  // namespace
}  // namespace trocar::store
