// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/unattended_play.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace trocar::presenter {
namespace {

Options MakeOptions() {
  Options options;
  options.run.screenshot = "window.png";
  options.run.screenshot_after = 2;
  return options;
}

TEST(UnattendedPlay, SavesOnceWhenItsTimeHasCome) {
  UnattendedPlay play(MakeOptions());
  EXPECT_EQ(play.Advance(1.9, 3), UnattendedPlay::Step::kGoOn);
  EXPECT_EQ(play.Advance(2.0, 3), UnattendedPlay::Step::kSave);
  EXPECT_EQ(play.Advance(2.1, 3), UnattendedPlay::Step::kGoOn);
}

TEST(UnattendedPlay, GivesUpOnASimulationThatDoesNotGetOn) {
  UnattendedPlay play(MakeOptions());
  EXPECT_EQ(play.Advance(0.1, 99), UnattendedPlay::Step::kGoOn);
  EXPECT_EQ(play.Advance(0.1, 101), UnattendedPlay::Step::kGiveUp);
  EXPECT_EQ(play.Complaint().code, base::ErrorCode::kUsage);
}

TEST(UnattendedPlay, NeverEndsAWindowThatSomebodyWatches) {
  UnattendedPlay play(Options{});
  EXPECT_FALSE(play.IsOn());
  EXPECT_EQ(play.Advance(1e6, 1e6), UnattendedPlay::Step::kGoOn);
}

TEST(FormatPlayReport, IsJson) {
  PlayReport report;
  report.screenshot = "window.png";
  report.pictures = 12;
  report.result = "Completed";
  auto json = nlohmann::json::parse(FormatPlayReport(report));
  EXPECT_EQ(json["pictures"], 12);
  EXPECT_EQ(json["result"], "Completed");
  EXPECT_FALSE(json.contains("haptics"));
  report.screenshot = report.result = "a\"}\n\xff";
  json = nlohmann::json::parse(FormatPlayReport(report));
  EXPECT_EQ(json["screenshot"], "a\"}\n\ufffd");
  report.haptics = "{\"rate\": 1000}";
  json = nlohmann::json::parse(FormatPlayReport(report));
  EXPECT_EQ(json["haptics"]["rate"], 1000);
}

}  // namespace
}  // namespace trocar::presenter
