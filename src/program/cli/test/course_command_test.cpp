// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "run_trocar.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::cli {
namespace {

/// A course of one easy step and one after it, with thresholds that the scripted expert meets.
const std::string kCourse =
    R"({"format": "trocar-course", "version": 1, "name": "Ours", "about": "A test.", "steps": [
  {"key": "tips", "name": "Tips to points", "goal": "Go there.", "briefing": "Look first.", "after_pass": "Well done.",
   "after_fail": "Go slower.", "task": "instrument_navigation", "consecutive_passes": 2,
   "own_thresholds": [{"metric": "rules_broken", "at_most": 0, "purpose": "safety", "source": "us"},
                      {"metric": "task_time", "at_most": 100, "purpose": "time", "source": "us"}]},
  {"key": "wire", "name": "Wire", "goal": "Go on.", "briefing": "Look.", "after_pass": "Good.", "after_fail": "Again.",
   "task": "wire_run", "prerequisites": ["tips"]}]})";

class CourseCommand : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(host::WriteFile(Path("ours.json"), kCourse).ok()); }
  std::string Path(const std::string& name) const { return (folder_.Path() / name).string(); }
  void Play(const std::string& surgeon, const std::string& name, const std::string& seed) {
    const Printed played = RunTrocar({"play", surgeon, "--task", "instrument_navigation", "--seed", seed,
                                      "--record", Path(name), "--json"});
    ASSERT_EQ(played.status, 0) << played.err;
  }
  test::TemporaryFolder folder_;
};

TEST_F(CourseCommand, JudgesRecordingsAndSaysHowFarSomebodyIs) {
  Play("expert", "one.trocar", "1");
  Play("expert", "two.trocar", "2");
  Play("presses_board", "bad.trocar", "3");
  const auto judge = [&](const char* step, const char* recording) {
    return RunTrocar(
        {"course", "judge", Path("ours.json"), step, Path(recording), "--attempts", Path("mine.json")});
  };
  const Printed bad = judge("tips", "bad.trocar");
  EXPECT_EQ(bad.status, 1);
  EXPECT_NE(bad.out.find("MISSED"), std::string::npos) << bad.out << bad.err;
  EXPECT_NE(bad.out.find("Go slower."), std::string::npos);
  const Printed locked = judge("wire", "one.trocar");
  EXPECT_EQ(locked.status, 1);
  EXPECT_NE(locked.err.find("E-CRS-004"), std::string::npos) << locked.err;
  const Printed good = judge("tips", "one.trocar");
  EXPECT_EQ(good.status, 0) << good.out << good.err;
  EXPECT_NE(good.out.find("Well done."), std::string::npos);
  EXPECT_NE(good.out.find("not certified assessment"), std::string::npos);
  const auto progress = [&] {
    const Printed printed =
        RunTrocar({"course", "progress", Path("ours.json"), "--attempts", Path("mine.json"), "--json"});
    EXPECT_EQ(printed.status, 0) << printed.err;
    return Json::parse(printed.out);
  };
  EXPECT_EQ(progress()["steps"][0]["state"], "open") << "one pass, and it takes two";
  EXPECT_EQ(judge("tips", "two.trocar").status, 0);
  const Json done = progress();
  EXPECT_EQ(done["steps"][0]["state"], "done");
  EXPECT_EQ(done["steps"][0]["attempts"], 3);
  EXPECT_EQ(done["steps"][1]["state"], "open");
  EXPECT_EQ(done["next"], "wire");
  const Printed words = RunTrocar({"course", "progress", Path("ours.json"), "--attempts", Path("mine.json")});
  EXPECT_NE(words.out.find("Next: Wire"), std::string::npos) << words.out;
  EXPECT_NE(words.out.find("CUSUM"), std::string::npos) << words.out;
  EXPECT_NE(words.out.find("6 attempts or more"), std::string::npos) << words.out;
}

TEST_F(CourseCommand, RefusesARecordingOfSomethingElse) {
  Play("expert", "one.trocar", "1");
  std::string other = kCourse;
  other.replace(other.find("\"consecutive_passes\""), 0, "\"level\": \"hard\", ");
  ASSERT_TRUE(host::WriteFile(Path("hard.json"), other).ok());
  const Printed judged = RunTrocar({"course", "judge", Path("hard.json"), "tips", Path("one.trocar")});
  EXPECT_EQ(judged.status, 1);
  EXPECT_NE(judged.err.find("E-CRS-001"), std::string::npos) << judged.err;
  EXPECT_NE(judged.err.find("hard"), std::string::npos) << judged.err;
}

TEST_F(CourseCommand, ChecksACourseAndSaysWhereItIsWrong) {
  EXPECT_EQ(RunTrocar({"course", "check", Path("ours.json")}).status, 0);
  std::string wrong = kCourse;
  wrong.replace(wrong.find("wire_run"), 8, "wire_jog");
  ASSERT_TRUE(host::WriteFile(Path("wrong.json"), wrong).ok());
  const Printed checked = RunTrocar({"course", "check", Path("wrong.json")});
  EXPECT_EQ(checked.status, 1);
  for (const char* part : {"E-CRS-001", "wrong.json", "steps[1]", "wire_run"})
    EXPECT_NE(checked.err.find(part), std::string::npos) << checked.err;
}

TEST_F(CourseCommand, ShowsCoursesAndSteps) {
  const Printed list = RunTrocar({"course", "list"});
  EXPECT_EQ(list.status, 0) << list.err;
  for (const char* course : {"basic-skills", "cholecystectomy"})
    EXPECT_NE(list.out.find(course), std::string::npos) << list.out;
  const Printed step = RunTrocar({"course", "show", "basic-skills", "peg-transfer"});
  EXPECT_EQ(step.status, 0) << step.err;
  EXPECT_NE(step.out.find("Time for the task: at most "), std::string::npos) << step.out;
  const Printed fls = RunTrocar({"levels", "show", "peg_transfer-fls"});
  EXPECT_NE(fls.out.find("at most 48 s"), std::string::npos) << fls.out << fls.err;
  const Printed none = RunTrocar({"course", "show", "basic-skills", "juggling"});
  EXPECT_NE(none.err.find("peg-transfer"), std::string::npos) << none.err;
}

TEST_F(CourseCommand, PreparesNothingWhereNoStepBeginsLater) {
  const Printed none = RunTrocar({"course", "prepare", Path("ours.json"), "-o", Path("parts")});
  EXPECT_EQ(none.status, 0) << none.err;
  EXPECT_NE(none.out.find("No step of ours begins in the middle of an operation"), std::string::npos)
      << none.out;
  EXPECT_FALSE(std::filesystem::exists(Path("parts")));
  const Printed level =
      RunTrocar({"course", "prepare", "cholecystectomy", "--level", "brutal", "-o", Path("parts")});
  EXPECT_EQ(level.status, 1);
  EXPECT_NE(level.err.find("hard"), std::string::npos) << level.err;
  const Printed unknown = RunTrocar({"course", "prepare", "juggling"});
  EXPECT_EQ(unknown.status, 1);
  EXPECT_NE(unknown.err.find("cholecystectomy"), std::string::npos) << unknown.err;
}

TEST_F(CourseCommand, LevelsComeFromTenExpertsAndNoFewer) {
  std::vector<std::string> words = {"levels", "from"};
  for (int seed = 1; seed <= 9; ++seed) {
    const std::string name = "expert-" + std::to_string(seed) + ".trocar";
    Play("expert", name, std::to_string(seed));
    words.push_back(Path(name));
  }
  const std::vector<std::string> options = {"--source", "a test", "-o", Path("levels.json")};
  std::vector<std::string> nine = words;
  nine.insert(nine.end(), options.begin(), options.end());
  const Printed few = RunTrocar(nine);
  EXPECT_EQ(few.status, 1);
  EXPECT_NE(few.err.find("E-CRS-003"), std::string::npos) << few.err;
  Play("expert", "expert-10.trocar", "10");
  words.push_back(Path("expert-10.trocar"));
  words.insert(words.end(), options.begin(), options.end());
  const Printed ten = RunTrocar(words);
  EXPECT_EQ(ten.status, 0) << ten.err;
  const Json json = Json::parse(*host::ReadFile(Path("levels.json")));
  EXPECT_EQ(json["task"], "instrument_navigation");
  EXPECT_EQ(json["experts"][0]["attempts"], 10);
  EXPECT_EQ(RunTrocar({"levels", "show", Path("levels.json")}).status, 0);
}

// The whole way of a part: the expert comes up to it, the state is kept, somebody goes on from it, and only the part is judged.
TEST(CourseStartWhole, PreparesThePartThatIsThenPlayedAndJudged) {
  test::TemporaryFolder folder;
  const auto path = [&](const char* name) { return (folder.Path() / name).string(); };
  const auto start = [&] {
    return RunTrocar({"course", "start", "cholecystectomy", "clip-and-cut", "--cache", path("cache")});
  };
  const Printed first = start();
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_EQ(first.out.find("kept from before"), std::string::npos);
  std::string state;
  for (const auto& entry : std::filesystem::directory_iterator(folder.Path() / "cache/starts"))
    state = entry.path().string();
  ASSERT_FALSE(state.empty());
  EXPECT_NE(start().out.find("kept from before"), std::string::npos);
  const Printed played = RunTrocar({"play", "expert", "--task", "cholecystectomy", "--restore", state,
                                    "--record", path("part.trocar"), "--json"});
  ASSERT_EQ(played.status, 0) << played.err;
  const Printed judged =
      RunTrocar({"course", "judge", "cholecystectomy", "clip-and-cut", path("part.trocar"), "--json"});
  ASSERT_EQ(judged.status, 0) << judged.out << judged.err;
  EXPECT_EQ(Json::parse(judged.out)["passed"], true);
  // the same recording does not begin where the next step does
  const Printed other = RunTrocar({"course", "judge", "cholecystectomy", "bed", path("part.trocar")});
  EXPECT_NE(other.err.find("E-CRS-001"), std::string::npos) << other.err;
}

}  // namespace
}  // namespace trocar::cli
