// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "run_trocar.h"

namespace trocar::cli {
namespace {

TEST(PlayCommand, ListsTasksAndSurgeons) {
  const Printed run = RunTrocar({"play", "--list"});
  EXPECT_EQ(run.status, 0) << run.err;
  for (const char* word : {"peg_transfer", "wire_run", "expert", "novice", "drops", "wire_touched"})
    EXPECT_NE(run.out.find(word), std::string::npos) << word << "\n" << run.out;
  std::istringstream lines(run.out);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 120u) << line;
}

TEST(PlayCommand, PrintsTheVerdictAsJsonAndTheSameAgain) {
  const Printed run =
      RunTrocar({"play", "expert", "--task", "instrument_navigation", "--seed", "3", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json json = Json::parse(run.out);
  for (const char* key : {"completed", "critical_view", "critical_errors", "errors", "blood_ml", "bile_ml",
                          "tick_p99_ms", "cut_tick_max_ms", "hash", "score", "time_s"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json["completed"], true);
  EXPECT_GT(json["tick_p99_ms"], 0.0);
  EXPECT_TRUE(json["errors"].empty()) << run.out;
  const Printed again =
      RunTrocar({"play", "expert", "--task", "instrument_navigation", "--seed", "3", "--json"});
  EXPECT_EQ(Json::parse(again.out)["hash"], json["hash"]);
}

TEST(PlayCommand, SaysWhatACarelessSurgeonDidWhereAndWhen) {
  const Printed run = RunTrocar({"play", "presses_board", "--task", "instrument_navigation", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json json = Json::parse(run.out);
  ASSERT_FALSE(json["errors"].empty());
  EXPECT_EQ(json["errors"][0]["error"], "board_pressed");
  EXPECT_EQ(json["errors"][0]["hand"], "left");
  EXPECT_GT(json["errors"][0]["time_s"], 0);
  EXPECT_EQ(json["errors"][0]["at_mm"].size(), 3u);
}

TEST(PlayCommand, AnOperationSaysWhatHasBecomeOfTheStones) {
  const Printed run =
      RunTrocar({"play", "burns_air", "--task", "cholecystectomy", "--seconds", "2", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json json = Json::parse(run.out);
  ASSERT_TRUE(json.contains("stones")) << run.out;
  EXPECT_GT(json["stones"]["all"], 0);
  EXPECT_EQ(json["stones"]["inside"], json["stones"]["all"]);
  EXPECT_EQ(json["stones"]["spilled_not_retrieved"], 0);
  EXPECT_EQ(json["bed_blood_ml"], 0.0);
  // stopped by the clock: nobody said that it was not safe to go on
  EXPECT_EQ(json["end"], "unfinished");
  EXPECT_EQ(json["bail_out"], "");
}

TEST(PlayCommand, RefusesWhatItDoesNotKnow) {
  EXPECT_EQ(RunTrocar({"play"}).status, 2);
  const Printed task = RunTrocar({"play", "expert", "--task", "pig_transfer"});
  EXPECT_EQ(task.status, 1);
  EXPECT_NE(task.err.find("known are"), std::string::npos) << task.err;
  const Printed surgeon = RunTrocar({"play", "nobody", "--task", "peg_transfer"});
  EXPECT_EQ(surgeon.status, 1);
  EXPECT_NE(surgeon.err.find("expert"), std::string::npos) << surgeon.err;
}

}  // namespace
}  // namespace trocar::cli
