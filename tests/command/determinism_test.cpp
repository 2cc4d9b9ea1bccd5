// SPDX-License-Identifier: Apache-2.0
// The same scene, seed and ticks: the same bits, twice and with any number of threads.
#include <nlohmann/json.hpp>

#include "command_fixture.h"

namespace trocar {
namespace {

class Determinism : public Command {
 protected:
  static nlohmann::json Simulate(int ticks, int seed, int threads) {
    const auto result =
        Run({"simulate", Source("scenes/demonstration.json"), "--ticks", std::to_string(ticks), "--seed",
             std::to_string(seed), "--threads", std::to_string(threads), "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(result.out, nullptr, false);
  }
};

TEST_F(Determinism, SameHashTwiceAndWithOneTwoAndFourThreads) {
  const std::string hash = Simulate(240, 1, 1).at("hash");
  EXPECT_THAT(hash, testing::MatchesRegex("[0-9a-f]+"));
  EXPECT_EQ(hash.size(), 16u);
  for (const int threads : {1, 2, 4})
    EXPECT_EQ(Simulate(240, 1, threads).at("hash"), hash) << threads << " threads";
}

// Negative control: the hash is of the state, which moves.
TEST_F(Determinism, AnotherTickIsAnotherHash) {
  EXPECT_NE(Simulate(30, 1, 1).at("hash"), Simulate(31, 1, 1).at("hash"));
}

// what is recorded with buttons is played with them: the next tool in the right hand, pressed for a tenth of a second
TEST_F(Determinism, ADevicesButtonsReachTheOperation) {
  const auto play = [this](std::uint32_t buttons) {
    std::string text = "time_s";
    for (const char* hand : {"left", "right", "laparoscope"}) {
      for (const char* what : {"seen", "pan_rad", "tilt_rad", "spin_rad", "depth_m", "jaw_rad", "buttons"})
        text.append(",").append(hand).append("_").append(what);
    }
    text += '\n';
    for (int i = 0; i < 40; ++i) {
      text += std::to_string(0.01 * i) + ",0,0,0,0,0.1,0,0,1,0.1,0.1,0,0.12,0.5," +
              std::to_string(i >= 4 && i < 14 ? buttons : 0) + ",0,0,0,0,0.1,0,0\n";
    }
    Write("hands.csv", text);
    const auto result = Run({"simulate", Source("scenes/cholecystectomy.json"), "--ticks", "30", "--device",
                             "play:" + Path("hands.csv"), "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(result.out, nullptr, false).at("hash").get<std::string>();
  };
  EXPECT_NE(play(8), play(0));
}

TEST_F(Determinism, JsonHoldsWhatWasPromisedAndNothingElse) {
  const nlohmann::json json = Simulate(20, 1, 1);
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  EXPECT_THAT(keys, testing::UnorderedElementsAre("hash", "ticks", "residual", "stages", "tick_p99_ms",
                                                  "max_force_n"));
  EXPECT_EQ(json.at("ticks"), 20);
  EXPECT_EQ(json.at("stages").size(), 18u);
  for (const auto& stage : json.at("stages")) {
    EXPECT_GE(stage.at("p99_ms").get<double>(), stage.at("median_ms").get<double>()) << stage;
    EXPECT_TRUE(stage.at("name").is_string());
  }
}

}  // namespace
}  // namespace trocar
