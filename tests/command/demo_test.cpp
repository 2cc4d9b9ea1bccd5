// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "command_fixture.h"
#include "trocar/render/image.h"

namespace trocar {
namespace {

using testing::HasSubstr;
using testing::IsSupersetOf;

class Demo : public Command {
 protected:
  test::ProcessResult Play(const std::string& seconds) {
    return Run({"demo", "-o", Path("demo"), "--size", "192x108", "--seconds", seconds});
  }
};

TEST_F(Demo, WritesPicturesVideoMetricsAndReport) {
  const auto result = Play("0.5");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(List(), IsSupersetOf({"demo/demo.webm", "demo/metrics.json", "demo/report.html",
                                    "demo/picture_001.png", "demo/picture_006.png"}));
  EXPECT_THAT(Read(Path("demo/demo.webm")), testing::StartsWith("\x1a\x45\xdf\xa3"));  // EBML

  const auto picture = render::ParsePng(Read(Path("demo/picture_001.png")), "picture");
  ASSERT_TRUE(picture.ok());
  EXPECT_EQ(picture->width, 192);
  EXPECT_EQ(picture->height, 108);

  const auto metrics = nlohmann::json::parse(Read(Path("demo/metrics.json")));
  EXPECT_EQ(metrics.at("ticks"), 60);
  ASSERT_FALSE(metrics.at("metrics").empty());
  EXPECT_EQ(metrics.at("metrics")[0], (nlohmann::json{{"metric", "time"}, {"value", 0.5}, {"unit", "s"}}));
  EXPECT_TRUE(metrics.at("haptics").is_null());
  const std::string page = Read(Path("demo/report.html"));
  EXPECT_THAT(page, HasSubstr("No haptic device took part."));
  EXPECT_THAT(page, HasSubstr("data:image/png;base64,"));
  EXPECT_THAT(page, HasSubstr(metrics.at("state_hash").get<std::string>()));
}

// force stays off, because nobody asked for it, and the record says so
TEST_F(Demo, SaysWhatForceFeedbackDid) {
  const auto result =
      Run({"demo", "-o", Path("demo"), "--size", "64x36", "--seconds", "1.5", "--haptics", "simulated"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto haptics = nlohmann::json::parse(Read(Path("demo/metrics.json"))).at("haptics");
  EXPECT_GT(haptics.at("ticks"), 100);
  EXPECT_GT(haptics.at("rate"), 0.0);
  EXPECT_GT(haptics.at("period_max_us"), 0.0);
  for (const char* hand : {"left", "right"}) {
    EXPECT_EQ(haptics.at(hand).at("armed_s"), 0.0) << hand;
    EXPECT_EQ(haptics.at(hand).at("max_force"), 0.0) << hand;
    EXPECT_THAT(haptics.at(hand).at("not_armed_longest_code").get<std::string>(),
                testing::StartsWith("E-HAP-"));
    EXPECT_EQ(haptics.at(hand).at("times_lost"), 0) << hand;
  }
  const std::string page = Read(Path("demo/report.html"));
  EXPECT_THAT(page, HasSubstr("Force feedback"));
  EXPECT_THAT(page, HasSubstr("Worst tick"));
  EXPECT_THAT(page, HasSubstr("without force because"));
}

TEST_F(Demo, PlaysTheStateThatSimulateReaches) {
  ASSERT_EQ(Play("0.25").status, 0);
  const auto metrics = nlohmann::json::parse(Read(Path("demo/metrics.json")));
  const auto simulated = nlohmann::json::parse(
      Run({"simulate", Source("scenes/demonstration.json"), "--ticks", "30", "--json"}).out);
  EXPECT_EQ(metrics.at("state_hash"), simulated.at("hash"));
}

TEST_F(Demo, TakesAwayThePicturesOfAnEarlierRunAndKeepsOtherFiles) {
  Write("demo/picture_099.png", "old");
  Write("demo/notes.txt", "mine");
  ASSERT_EQ(Play("0.1").status, 0);
  EXPECT_FALSE(std::filesystem::exists(Path("demo/picture_099.png")));
  EXPECT_EQ(Read(Path("demo/notes.txt")), "mine");
}

}  // namespace
}  // namespace trocar
