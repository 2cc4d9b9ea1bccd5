// SPDX-License-Identifier: Apache-2.0
// What a file says of an attempt counts nowhere until a replay has come to the same.
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "store_test.h"
#include "trocar/files/find_scene.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/version.h"
#include "trocar/record/recorder.h"
#include "trocar/store/keep_attempt.h"
#include "trocar/store/maintenance.h"

namespace trocar::store {
namespace {

namespace fs = std::filesystem;

constexpr Verification kAll[] = {Verification::kUnverified, Verification::kVerified,
                                 Verification::kRecordedHere, Verification::kAccepted,
                                 Verification::kRefused};

TEST(VerificationMark, HasANameAndWordsForEachState) {
  for (const Verification state : kAll) {
    EXPECT_EQ(ParseVerification(VerificationName(state)), state);
    for (int i = 0; i <= static_cast<int>(WhyUnverified::kOtherEnding); ++i) {
      const auto why = static_cast<WhyUnverified>(i);
      EXPECT_EQ(ParseWhy(WhyName(why)), why);
      VerificationMark mark;
      mark.state = state, mark.why = why;
      const std::string words = DescribeMark(mark);
      EXPECT_EQ(words.empty(), mark.IsVerified());
      EXPECT_TRUE(words.empty() || words.starts_with("not verified") || words.starts_with("refused"))
          << words;
      EXPECT_TRUE(!mark.IsVerified() || mark.Counts());
    }
  }
  EXPECT_FALSE(ParseVerification("sure"));
  EXPECT_FALSE(ParseWhy("sure"));
}

class VerificationOver : public StoreTest {
 protected:
  Attempt Marked(int number, const std::string& trainee, Verification state) {
    Attempt attempt = MakeAttempt(number, trainee);
    attempt.mark.state = state;
    attempt.mark.why = attempt.mark.IsVerified() ? WhyUnverified::kNone : WhyUnverified::kNotYet;
    return attempt;
  }
  const MetricKey key_{"peg_transfer", "easy", "score", "", "", ""};
};
INSTANTIATE_OVER_DATABASES(VerificationOver);

TEST_P(VerificationOver, DecidesWhatCounts) {
  int number = 0;
  for (const Verification state : kAll) {
    const std::string who = Add(Role::kTrainee);
    const Attempt attempt = Marked(++number, who, state);
    EXPECT_TRUE(Get(AddAttempt(Open(), attempt)));
    EXPECT_EQ(Get(FindStanding(Open(), kOwner, who, key_)).has_value(), attempt.mark.Counts())
        << VerificationName(state);
    const Attempt more = Marked(100 + number, who, state);
    EXPECT_EQ(Get(AddAttempts(Open(), kOwner, {&more, 1})), 1);
    const auto standing = Get(FindStanding(Open(), kOwner, who, key_));
    EXPECT_EQ(standing ? standing->attempts : 0, attempt.mark.Counts() ? 2 : 0);
    EXPECT_EQ(Get(ListAttempts(Open(), kOwner, {who, "", ""})).attempts.at(0).attempt.mark.state, state);
  }
  EXPECT_EQ(Get(ListGroupValues(Open(), kOwner, "", key_)).size(), 3u);
  EXPECT_GOOD(Verify(Open()));
  // the control: standings that count what is not verified are found
  ASSERT_TRUE(Open().GetDatabase().Run("UPDATE attempt SET verification = 'unverified'").ok());
  EXPECT_CODE(Verify(Open()), kStoreDamaged);
}

TEST_P(VerificationOver, IsMadeUpForByAReplay) {
  const std::string who = Add(Role::kTrainee);
  for (int i = 1; i <= 3; ++i) {
    EXPECT_TRUE(Get(AddAttempt(Open(), Marked(i, who, Verification::kUnverified))));
    EXPECT_TRUE(Get(AddAttempt(Open(), Marked(10 + i, who, Verification::kVerified))));
  }
  std::int64_t after = 0;
  int listed = 0;
  while (true) {
    const auto page = Get(ListUnverified(Open(), kOwner, after, 2));
    if (page.empty()) break;
    for (const StoredAttempt& stored : page) {
      ++listed;
      after = stored.id;
      Attempt attempt = stored.attempt;
      EXPECT_EQ(attempt.metrics.size(), 5u);
      attempt.mark = {Verification::kVerified, WhyUnverified::kNone, "0.2.0", 5, ""};
      attempt.score = 77;
      std::erase_if(attempt.metrics, [](const auto& metric) { return metric.metric == "score"; });
      EXPECT_GOOD(UpdateAttempt(Open(), kOwner, attempt));
    }
  }
  EXPECT_EQ(listed, 3);
  EXPECT_EQ(Get(FindStanding(Open(), kOwner, who, key_))->attempts, 6);
  EXPECT_EQ(Get(FindStanding(Open(), kOwner, who, key_))->highest, 77);
  EXPECT_GOOD(Verify(Open()));
  EXPECT_CODE(UpdateAttempt(Open(), kOwner, Marked(99, who, Verification::kVerified)), kStoreUnknown);
  const Viewer trainee = Get(FindViewer(Open(), who));
  EXPECT_CODE(UpdateAttempt(Open(), trainee, Marked(1, who, Verification::kVerified)), kStoreRefused);
  EXPECT_CODE(ListUnverified(Open(), trainee, 0, 1), kStoreRefused);
}

TEST_P(VerificationOver, IsNotTakenFromAFileInTheSpool) {
  const std::string who = Add(Role::kTrainee);
  const Spool spool(place_);
  EXPECT_GOOD(spool.Keep(Marked(1, who, Verification::kVerified)));
  EXPECT_EQ(spool.Deliver(Open()).added, 1);
  // as somebody else would write it, with its sum
  int number = 1;
  const auto drop = [&](const std::string& text) {
    ASSERT_TRUE(host::WriteFile(place_.SpoolFolder() / ("x" + std::to_string(number) + ".json"), text).ok());
  };
  drop(WriteAttemptJson(Marked(++number, who, Verification::kVerified)));
  drop(WriteAttemptJson(Marked(++number, who, Verification::kRecordedHere), std::string(32, 'k')));
  EXPECT_EQ(spool.Deliver(Open()).added, 2);
  const auto page = Get(ListAttempts(Open(), kOwner, {who, "", ""}));
  ASSERT_EQ(page.attempts.size(), 3u);
  for (const StoredAttempt& stored : page.attempts) {
    const bool is_own = stored.attempt.recording_id == MakeAttempt(1, who).recording_id;
    EXPECT_EQ(stored.attempt.mark.IsVerified(), is_own);
    EXPECT_EQ(stored.attempt.mark.Counts(), is_own);
  }
}

TEST_P(VerificationOver, IsNotTakenFromAnImport) {
  const std::string who = Add(Role::kTrainee);
  int number = 0;
  for (const Verification state : kAll) EXPECT_TRUE(Get(AddAttempt(Open(), Marked(++number, who, state))));
  const fs::path file = folder_.Path() / "export.json", backup = folder_.Path() / "backup.sqlite";
  EXPECT_GOOD(ExportJson(Open(), kOwner, file));
  EXPECT_GOOD(BackUp(Open(), kOwner, backup));
  int store = 0;
  for (const fs::path& from : {file, backup}) {
    for (const Trust trust : {Trust::kNone, Trust::kAsItSays}) {
      auto other = Store::Open(MakePlace("import" + std::to_string(++store)));
      ASSERT_TRUE(other.ok());
      EXPECT_EQ(Get(Import(*other, kOwner, from, trust)).attempts, number);
      for (const StoredAttempt& stored : Get(ListAttempts(*other, kOwner, {who, "", ""})).attempts) {
        const std::string& id = stored.attempt.recording_id;
        for (int i = 0; i < number; ++i) {
          if (MakeAttempt(i + 1, who).recording_id != id) continue;
          const Verification was = kAll[i];
          EXPECT_EQ(stored.attempt.mark.state, trust == Trust::kAsItSays || was == Verification::kRefused
                                                   ? was
                                                   : Verification::kUnverified);
        }
      }
      EXPECT_GOOD(Verify(*other));
    }
  }
  // an export of before there were marks
  auto json = nlohmann::ordered_json::parse(ReadAll(file));
  for (auto& row : json["tables"]["attempt"]) {
    for (const char* field : {"verification", "verification_why", "verified_by", "verified_ms", "claim"})
      row.erase(field);
  }
  ASSERT_TRUE(host::WriteFile(folder_.Path() / "old.json", json.dump()).ok());
  auto other = Store::Open(MakePlace("import_old"));
  ASSERT_TRUE(other.ok());
  EXPECT_EQ(Get(Import(*other, kOwner, folder_.Path() / "old.json")).attempts, number);
  for (const StoredAttempt& stored : Get(ListAttempts(*other, kOwner, {who, "", ""})).attempts)
    EXPECT_EQ(stored.attempt.mark.state, Verification::kUnverified);
}

/// A recording of a delivered task in which nobody does anything.
class ReplayedAttempt : public testing::Test {
 protected:
  void SetUp() override {
    auto read = files::FindScene("instrument_navigation", {"easy", 3, ""});
    ASSERT_TRUE(read.ok()) << read.error().Text();
    const auto scene = std::make_shared<const scene::Scene>(std::move(*read));
    auto simulation = simulation::Simulation::Make(scene);
    ASSERT_TRUE(simulation.ok());
    record::Description description;
    description.kind = record::Description::Kind::kTask;
    description.name = "instrument_navigation", description.level = "easy", description.seed = 3;
    description.player = "a test";
    record::RecorderSettings settings;
    settings.waits = true;
    settings.hash_seconds = 0.25;
    auto recorder = record::Recorder::Start(File(), description, *simulation, settings);
    ASSERT_TRUE(recorder.ok()) << recorder.error().Text();
    for (int tick = 0; tick < 240; ++tick) {
      const scene::Input input = scene::CalcScriptInput(*scene, 0);
      simulation->Step(input);
      (*recorder)->Add(input, *simulation);
    }
    ASSERT_TRUE((*recorder)->Finish(*simulation).ok());
  }
  fs::path File() const { return folder_.Path() / "a.trocar"; }
  Attempt Replay(const std::function<void(record::Recording&)>& change = {}) {
    auto recording = record::ReadRecording(File());
    EXPECT_TRUE(recording.ok());
    if (change) change(*recording);
    return Get(ReplayAttempt(std::move(*recording), File()));
  }
  test::TemporaryFolder folder_;
};

TEST_F(ReplayedAttempt, IsVerifiedWhereTheFileSaysWhatComesOut) {
  const Attempt attempt = Replay();
  EXPECT_EQ(attempt.mark.state, Verification::kVerified);
  EXPECT_EQ(attempt.mark.program, host::VersionText());
  EXPECT_TRUE(attempt.mark.time_ms.has_value());
  EXPECT_FALSE(attempt.is_completed);
  EXPECT_GT(attempt.metrics.size(), 10u);
  // a program that was stopped wrote no ending: there is nothing to contradict
  EXPECT_EQ(Replay([](record::Recording& r) { r.ending.reset(); }).mark.state, Verification::kVerified);
}

TEST_F(ReplayedAttempt, IsRefusedWhereTheEndingIsMadeUp) {
  const std::string forged = R"({"seconds":2.0,"task":{"phase":"completed","score":99.0}})";
  const Attempt attempt = Replay([&](record::Recording& r) { r.ending->outcome = forged; });
  EXPECT_EQ(attempt.mark.state, Verification::kRefused);
  EXPECT_EQ(attempt.mark.why, WhyUnverified::kOtherEnding);
  EXPECT_EQ(attempt.mark.claim, forged);
  EXPECT_FALSE(attempt.is_completed);
  EXPECT_NE(attempt.score, 99.0);
  EXPECT_EQ(attempt.outcome.find("completed"), std::string::npos) << attempt.outcome;

  struct Case {
    const char* what;
    std::function<void(record::Recording&)> change;
    Verification state;
    WhyUnverified why;
  };
  const Case cases[] = {
      {"without inputs", [&](auto& r) { r.inputs.clear(), r.ending->outcome = forged; },
       Verification::kRefused, WhyUnverified::kDiverged},
      {"without inputs and hashes",
       [&](auto& r) { r.inputs.clear(), r.hashes.clear(), r.ending->ticks = 0, r.ending->outcome = forged; },
       Verification::kRefused, WhyUnverified::kDiverged},
      {"another last hash", [](auto& r) { ++r.ending->hash; }, Verification::kRefused,
       WhyUnverified::kDiverged},
      {"another end", [](auto& r) { ++r.ending->ticks; }, Verification::kRefused,
       WhyUnverified::kOtherEnding},
      {"another hash on the way", [](auto& r) { ++r.hashes.at(2).hash; }, Verification::kRefused,
       WhyUnverified::kDiverged},
      {"an ending that was left out", [](auto& r) { r.ending.reset(), r.is_ending_refused = true; },
       Verification::kRefused, WhyUnverified::kOtherEnding},
      {"fewer inputs", [](auto& r) { r.inputs.pop_back(); }, Verification::kRefused,
       WhyUnverified::kDiverged},
      {"another version", [&](auto& r) { r.description.program = "0.0.1", r.ending->outcome = forged; },
       Verification::kUnverified, WhyUnverified::kOtherVersion},
      {"another model", [](auto& r) { ++r.description.model; }, Verification::kUnverified,
       WhyUnverified::kCannotReplay},
      {"no such task", [](auto& r) { r.description.name = "no_such_task"; }, Verification::kUnverified,
       WhyUnverified::kCannotReplay},
  };
  for (const Case& one : cases) {
    const Attempt changed = Replay(one.change);
    EXPECT_EQ(VerificationName(changed.mark.state), VerificationName(one.state)) << one.what;
    EXPECT_EQ(WhyName(changed.mark.why), WhyName(one.why)) << one.what;
    EXPECT_FALSE(changed.mark.Counts()) << one.what;
  }
}

TEST_F(ReplayedAttempt, MayBeGivenUp) {
  auto recording = record::ReadRecording(File());
  ASSERT_TRUE(recording.ok());
  ReplayChoice choice;
  choice.progress = [](double) { return false; };
  EXPECT_CODE(ReplayAttempt(std::move(*recording), File(), choice), kCancelled);
}

}  // namespace
}  // namespace trocar::store
