// SPDX-License-Identifier: Apache-2.0
// A state in a file goes on in another process to the bits of one run.
#include <nlohmann/json.hpp>

#include "command_fixture.h"

namespace trocar {
namespace {

class StateFile : public Command {
 protected:
  static nlohmann::json RunJson(std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    const auto result = Run(std::move(arguments));
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(result.out, nullptr, false);
  }
};

TEST_F(StateFile, GoesOnAsOneRun) {
  const std::string scene = Source("scenes/cholecystectomy.json"), file = Path("half.state");
  RunJson({"simulate", scene, "--ticks", "70", "--save", file});
  EXPECT_THAT(List(), testing::ElementsAre("half.state"));
  const auto rest = RunJson({"simulate", scene, "--restore", file, "--ticks", "50", "--threads", "2"});
  EXPECT_EQ(rest.at("hash"), RunJson({"simulate", scene, "--ticks", "120"}).at("hash"));
  EXPECT_EQ(rest.at("ticks"), 120);
}

TEST_F(StateFile, TakesTheSurgeonAlong) {
  const std::string file = Path("play.state");
  const std::vector<std::string> play = {"play", "expert", "--task", "hook_dissection"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), play.begin(), play.end());
    return RunJson(std::move(more));
  };
  with({"--seconds", "4", "--save", file});
  EXPECT_EQ(with({"--restore", file}).at("hash"), with({}).at("hash"));
  ExpectError(Run({"play", "novice", "--task", "hook_dissection", "--restore", file}), "E-SIM-006");
  ExpectError(Run({"play", "expert", "--task", "hook_dissection", "--seed", "2", "--restore", file}),
              "E-SIM-006");
  // a state that stands after the last second is not taken for an attempt that ended
  ExpectError(Run({"play", "expert", "--task", "hook_dissection", "--restore", file, "--seconds", "1"}),
              "E-CLI-001", 2);
  ExpectError(Run({"play", "expert", "--task", "hook_dissection", "--restore", file, "-o", Path("out")}),
              "E-CLI-001", 2);
}

TEST_F(StateFile, RefusesWhatIsNoStateOfTheScene) {
  const std::string scene = Source("scenes/demonstration.json"), file = Path("one.state");
  RunJson({"simulate", scene, "--ticks", "5", "--save", file});
  ExpectError(Run({"simulate", Source("scenes/cholecystectomy.json"), "--ticks", "1", "--restore", file}),
              "E-SIM-006");
  ExpectError(Run({"simulate", scene, "--ticks", "1", "--restore", Path("none.state")}), "E-IO-001");
  const std::string whole = Read(file);
  Write("cut.state", whole.substr(0, whole.size() / 2));
  ExpectError(Run({"simulate", scene, "--ticks", "1", "--restore", Path("cut.state")}), "E-SIM-006");
  std::string flipped = whole;
  flipped[flipped.size() / 2] ^= 0x20;
  Write("flipped.state", flipped);
  ExpectError(Run({"simulate", scene, "--ticks", "1", "--restore", Path("flipped.state")}), "E-SIM-006");
}

}  // namespace
}  // namespace trocar
