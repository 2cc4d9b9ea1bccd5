// SPDX-License-Identifier: Apache-2.0
// Recordings on the command line: written, looked at, verified, drawn, gone on from.
#include <nlohmann/json.hpp>

#include "command_fixture.h"

namespace trocar {
namespace {

using nlohmann::json;

class RecordingCommand : public Command {
 protected:
  static json RunJson(std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    const auto result = Run(std::move(arguments));
    EXPECT_EQ(result.status, 0) << result.err;
    return json::parse(result.out, nullptr, false);
  }
  std::string Record() {
    const std::string file = Path("attempt.trocar");
    played_ = RunJson(
        {"play", "novice", "--task", "peg_transfer", "--seconds", "12", "--seed", "3", "--record", file});
    return file;
  }
  json played_;
};

TEST_F(RecordingCommand, ATaskIsVerifiedByReplayingIt) {
  const std::string file = Record();
  const json verified = RunJson({"replay", file, "--verify", "--threads", "2"});
  EXPECT_EQ(verified.at("verified"), true);
  EXPECT_EQ(verified.at("hash"), played_.at("hash"));
  EXPECT_EQ(verified.at("finished"), true);
  EXPECT_EQ(verified.at("outcome").at("task").at("score"), played_.at("score"));
  EXPECT_GE(verified.at("hashes"), 12);
  const auto said = Run({"replay", file});
  EXPECT_EQ(said.status, 0);
  EXPECT_THAT(said.out, testing::StartsWith("VERIFIED: "));
  // recording changes nothing
  EXPECT_EQ(
      RunJson({"play", "novice", "--task", "peg_transfer", "--seconds", "12", "--seed", "3"}).at("hash"),
      played_.at("hash"));
}

TEST_F(RecordingCommand, AnOperationIsVerifiedFromAnyFolder) {
  const std::string file = Path("operation.trocar");
  const json played =
      RunJson({"play", "expert", "--task", "cholecystectomy", "--seconds", "9", "--record", file});
  const json verified = RunJson({"replay", file});
  EXPECT_EQ(verified.at("verified"), true);
  EXPECT_EQ(verified.at("hash"), played.at("hash"));
}

TEST_F(RecordingCommand, InfoSaysWhatItIs) {
  const std::string file = Record();
  const json info = RunJson({"record", "info", file});
  EXPECT_EQ(info.at("of"), "peg_transfer");
  EXPECT_EQ(info.at("seed"), 3);
  EXPECT_THAT(info.at("player").get<std::string>(), testing::HasSubstr("novice"));
  EXPECT_NEAR(info.at("seconds").get<double>(), 12, 0.1);
  EXPECT_EQ(info.at("finished"), true);
  EXPECT_TRUE(info.at("damage").is_null());
  EXPECT_GE(info.at("hashes"), 12);
  EXPECT_FALSE(info.at("events").empty());
  const auto text = Run({"record", "info", file});
  EXPECT_THAT(text.out, testing::AllOf(testing::HasSubstr("peg_transfer"), testing::HasSubstr("finished")));
  EXPECT_EQ(Run({"record", "verify", file}).status, 0);
}

TEST_F(RecordingCommand, DamageIsFoundAndCutOff) {
  std::string content = Read(Record());
  content[content.size() * 3 / 4] ^= 4;
  Write("damaged.trocar", content);
  const auto verified = Run({"record", "verify", Path("damaged.trocar")});
  EXPECT_EQ(verified.status, 1);
  EXPECT_THAT(verified.out, testing::HasSubstr("damaged"));
  EXPECT_EQ(Run({"record", "repair", Path("damaged.trocar"), "-o", Path("mended.trocar")}).status, 0);
  const json mended = RunJson({"replay", Path("mended.trocar")});
  EXPECT_EQ(mended.at("verified"), true);
  EXPECT_EQ(mended.at("finished"), false);
  EXPECT_GT(mended.at("ticks"), 100);
  ExpectError(Run({"replay", Path("none.trocar")}), "E-IO-001");
  Write("text.trocar", "this is a text, and no recording at all");
  ExpectError(Run({"replay", Path("text.trocar")}), "E-REC-001");
}

TEST_F(RecordingCommand, AStateOfTheMiddleGoesOn) {
  const std::string file = Path("scene.trocar"), state = Path("middle.state");
  const std::string scene = Source("scenes/demonstration.json");
  const json whole = RunJson({"simulate", scene, "--ticks", "150", "--record", file});
  const auto saved = Run({"replay", file, "--at", "0.75", "--save", state});
  EXPECT_EQ(saved.status, 0) << saved.err;
  EXPECT_EQ(RunJson({"simulate", scene, "--restore", state, "--ticks", "60"}).at("hash"), whole.at("hash"));
}

TEST_F(RecordingCommand, SomebodyElseGoesOnAndIsRecordedToo) {
  const std::string file = Record(), other = Path("other.trocar");
  const auto branch = Run({"replay", file, "--at", "6", "--surgeon", "expert", "--record", other});
  EXPECT_EQ(branch.status, 0) << branch.err;
  const json went = json::parse(branch.out, nullptr, false);
  EXPECT_EQ(went.at("outcome").at("task").at("phase"), "completed");
  const json verified = RunJson({"replay", other});
  EXPECT_EQ(verified.at("verified"), true);
  EXPECT_EQ(verified.at("hash"), went.at("hash"));
  EXPECT_EQ(RunJson({"record", "info", other}).at("first_tick"), 720);
}

TEST_F(RecordingCommand, AnyPartIsDrawn) {
  const std::string file = Record();
  const auto drawn =
      Run({"replay", file, "--from", "4", "--until", "5", "--size", "320x180", "-o", Path("video")});
  EXPECT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_THAT(List(), testing::IsSupersetOf({"video/demo.webm", "video/picture_001.png"}));
}

TEST_F(RecordingCommand, SaysWhatDoesNotGoTogether) {
  const std::string file = Record();
  ExpectError(Run({"replay", file, "--at", "3"}), "E-CLI-001", 2);
  ExpectError(Run({"replay", file, "--at", "99", "--surgeon", "expert"}), "E-CLI-001", 2);
  ExpectError(Run({"play", "novice", "--task", "peg_transfer", "--record", file}), "E-IO-003");
}

}  // namespace
}  // namespace trocar
