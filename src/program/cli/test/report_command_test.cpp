// SPDX-License-Identifier: Apache-2.0
// Reports, ratings and learning records from the command line, of an attempt that a scripted surgeon made.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "run_trocar.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::cli {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// Exit status of tools/check-schemas.
bool IsValid(const std::string& file) {
  return CheckSchemas("'" + file + "' >/dev/null 2>&1") == 0;
}
bool HasSchemas() {
  return CheckSchemas("--check >/dev/null 2>&1") == 0;
}

class ReportCommand : public testing::Test {
 protected:
  std::string File(const std::string& name) const { return (folder_.Path() / name).string(); }
  std::string Read(const std::string& name) const {
    const auto text = host::ReadFile(File(name));
    EXPECT_TRUE(text.ok()) << name;
    return text.ok() ? *text : "";
  }
  void Play(const std::string& surgeon, const std::string& name, std::vector<std::string> more = {}) {
    std::vector<std::string> words = {"play",   surgeon, "--task",   "instrument_navigation",
                                      "--seed", "3",     "--record", File(name)};
    words.insert(words.end(), more.begin(), more.end());
    const Printed run = RunTrocar(words);
    ASSERT_EQ(run.status, 0) << run.err;
  }

  test::TemporaryFolder folder_;
};

TEST_F(ReportCommand, WritesEveryKindOfARecording) {
  Play("presses_board", "a.trocar");
  for (const char* name : {"a.html", "a.pdf", "a.csv", "a.json"}) {
    const Printed run = RunTrocar({"report", File("a.trocar"), "-o", File(name), "--person", "T-7F3K2Q"});
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("The task was completed"));
  }
  const std::string page = Read("a.html");
  for (const char* words :
       {"T-7F3K2Q", "instrument", "Time line", "Path length", "Errors in the order", "training feedback"})
    EXPECT_THAT(page, HasSubstr(words));
  EXPECT_THAT(page, Not(HasSubstr("board_pressed")));
  EXPECT_EQ(Read("a.pdf").substr(0, 5), "%PDF-");
  EXPECT_THAT(Read("a.csv"), HasSubstr("path_length"));
  const json report = json::parse(Read("a.json"));
  EXPECT_EQ(report["attempt"]["person"], "T-7F3K2Q");
  EXPECT_FALSE(report["errors"].empty());
  if (HasSchemas()) {
    EXPECT_TRUE(IsValid(File("a.json")));
  }
}

TEST_F(ReportCommand, OfARunIsThatOfItsRecording) {
  Play("novice", "a.trocar", {"--report", File("live.json")});
  ASSERT_EQ(RunTrocar({"report", File("a.trocar"), "-o", File("replayed.json")}).status, 0);
  json live = json::parse(Read("live.json")), replayed = json::parse(Read("replayed.json"));
  EXPECT_EQ(live["attempt"]["as_recorded"], nullptr) << "no file says anything of it";
  EXPECT_EQ(replayed["attempt"]["as_recorded"], true);
  for (json* one : {&live, &replayed}) {
    (*one)["attempt"].erase("started");
    (*one)["attempt"].erase("recording");
    (*one)["attempt"].erase("as_recorded");
  }
  EXPECT_EQ(live, replayed);
}

TEST_F(ReportCommand, OfSeveralRecordingsIsTheTrainees) {
  Play("novice", "a.trocar");
  Play("expert", "b.trocar");
  const Printed run =
      RunTrocar({"report", File("a.trocar"), File("b.trocar"), "-o", File("t.html"), "--person", "T-1"});
  ASSERT_EQ(run.status, 0) << run.err;
  for (const char* words : {"Trainee T-1", "Learning curves", "Best attempts", "All attempts"})
    EXPECT_THAT(Read("t.html"), HasSubstr(words));
  EXPECT_EQ(RunTrocar({"report", File("a.trocar"), File("b.trocar"), "-o", File("t.csv")}).status, 2);
}

TEST_F(ReportCommand, ComparesWithAGroupOfFiveAndNotOfFour) {
  const std::string store = File("s.sqlite");
  const auto run = [&](std::vector<std::string> words) {
    words.insert(words.end(), {"--store", store});
    const Printed printed = RunTrocar(words);
    EXPECT_EQ(printed.status, 0) << printed.err;
    return printed.out.substr(0, printed.out.find('\n'));
  };
  run({"store", "group", "add", "evening <b>"});
  std::vector<std::string> people;
  for (int i = 0; i < 5; ++i) {
    people.push_back(run({"store", "trainee", "add"}));
    run({"store", "group", "join", "evening <b>", people.back()});
    const std::string name = std::to_string(i) + ".trocar";
    ASSERT_EQ(RunTrocar({"play", "intermediate", "--task", "instrument_navigation", "--seed",
                         std::to_string(i + 1), "--record", File(name)})
                  .status,
              0);
    run({"store", "add", File(name), "--trainee", people.back()});
    run({"report", File("0.trocar"), "-o", File("a.html"), "--group", "evening <b>"});
    const std::string page = Read("a.html");
    EXPECT_EQ(page.find("Middle half of the group") != std::string::npos, i == 4) << i;
    EXPECT_THAT(page, HasSubstr(i == 4 ? "Group &quot;evening &lt;b&gt;&quot;: 5 people"
                                       : "only " + std::to_string(i + 1) + " of its people"));
    for (const std::string& person : people) EXPECT_THAT(page, Not(HasSubstr(person)));
  }
  // who is not in the group learns nothing of it, and still has the report
  const std::string stranger = run({"store", "trainee", "add"});
  run({"report", File("0.trocar"), "-o", File("b.html"), "--group", "evening <b>", "--as", stranger});
  EXPECT_THAT(Read("b.html"), HasSubstr("is left out: only members"));
  EXPECT_THAT(
      RunTrocar({"report", File("0.trocar"), "-o", File("c.html"), "--group", "none", "--store", store}).err,
      HasSubstr("E-STO-008"));
  EXPECT_EQ(
      RunTrocar({"report", File("0.trocar"), File("1.trocar"), "-o", File("c.html"), "--group", "g"}).status,
      2);
}

TEST_F(ReportCommand, RefusesAnEndingAndARecordingThatAreNone) {
  EXPECT_EQ(RunTrocar({"report"}).status, 2);
  EXPECT_EQ(RunTrocar({"report", File("none.trocar"), "-o", File("a.doc")}).status, 2);
  EXPECT_EQ(RunTrocar({"report", File("none.trocar"), "-o", File("a.pdf")}).status, 1);
  EXPECT_EQ(RunTrocar({"play", "expert", "--task", "peg_transfer", "--report", File("a.doc")}).status, 2);
  const Printed dictionary = RunTrocar({"report", "--dictionary"});
  EXPECT_EQ(dictionary.status, 0);
  EXPECT_THAT(dictionary.out, HasSubstr("log_dimensionless_jerk,"));
}

TEST_F(ReportCommand, StatementsWaitInTheQueue) {
  Play("expert", "a.trocar");
  const Printed queued = RunTrocar({"xapi", "queue", File("a.trocar"), "--person", "T-1", "--home-page",
                                    "https://centre.example", "--queue", File("q")});
  ASSERT_EQ(queued.status, 0) << queued.err;
  const Printed list = RunTrocar({"xapi", "list", "--queue", File("q")});
  EXPECT_THAT(list.out, HasSubstr("verbs/completed"));
  EXPECT_THAT(list.out, Not(HasSubstr(folder_.Path().string())));
  const Printed away = RunTrocar(
      {"xapi", "deliver", "--endpoint", "http://127.0.0.1:9/xapi", "--give-up", "0", "--queue", File("q")});
  EXPECT_EQ(away.status, 1);
  EXPECT_THAT(away.err, HasSubstr("E-LRS-002"));
  EXPECT_THAT(RunTrocar({"xapi", "deliver", "--endpoint", "http://lrs.example/", "--queue", File("q")}).err,
              HasSubstr("E-LRS-001"));
  EXPECT_EQ(RunTrocar({"xapi", "erase", "T-1", "--queue", File("q")}).status, 0);
  EXPECT_EQ(RunTrocar({"xapi", "list", "--queue", File("q")}).out, "");
  EXPECT_EQ(RunTrocar({"xapi", "queue", File("a.trocar"), "--person", "T-1", "--home-page", "centre"}).status,
            2);
}

TEST_F(ReportCommand, RatingsAreEnteredAndCompared) {
  const auto enter = [&](const std::string& attempt, const std::string& rater, int points) {
    std::vector<std::string> words = {"rating",    "enter", "goals",
                                      "--attempt", attempt, "--rater",
                                      rater,       "-o",    File(rater + attempt + ".json")};
    for (const char* item :
         {"depth_perception", "bimanual_dexterity", "efficiency", "tissue_handling", "autonomy"}) {
      words.push_back(std::string(item) + "=" + std::to_string(points));
    }
    words.back().back() = static_cast<char>('1' + points % 5);
    return RunTrocar(words);
  };
  std::vector<std::string> compare = {"rating", "agreement", "--json"};
  for (const auto& [attempt, one, two] : {std::tuple{"a", 2, 2}, {"b", 4, 3}, {"c", 5, 5}, {"d", 1, 2}}) {
    for (const auto& [rater, points] : {std::pair{"I-1", one}, std::pair{"I-2", two}}) {
      const Printed run = enter(attempt, rater, points);
      ASSERT_EQ(run.status, 0) << run.err;
      compare.push_back(File(std::string(rater) + attempt + ".json"));
    }
  }
  if (HasSchemas()) {
    EXPECT_TRUE(IsValid(compare.back()));
  }
  const Printed run = RunTrocar(compare);
  ASSERT_EQ(run.status, 0) << run.err;
  const json agreement = json::parse(run.out);
  EXPECT_GT(agreement["of"]["sum"]["icc_2_1"]["value"], 0.6);
  compare.erase(compare.begin() + 2);
  EXPECT_THAT(RunTrocar(compare).out, HasSubstr("ICC(2,1)"));
  compare.pop_back();
  const Printed missing = RunTrocar(compare);
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.err, HasSubstr("E-RPT-001"));
  EXPECT_EQ(RunTrocar({"rating", "form", "osats", "-o", File("form.pdf")}).status, 0);
  EXPECT_THAT(RunTrocar({"rating", "form", "goals"}).out, HasSubstr("depth_perception=1..5"));
}

}  // namespace
}  // namespace trocar::cli
