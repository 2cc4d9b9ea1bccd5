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
        {"play", "loses", "--task", "peg_transfer", "--seconds", "12", "--seed", "3", "--record", file});
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
  EXPECT_EQ(RunJson({"play", "loses", "--task", "peg_transfer", "--seconds", "12", "--seed", "3"}).at("hash"),
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
  EXPECT_THAT(info.at("player").get<std::string>(), testing::HasSubstr("loses"));
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
  // before the ring is lost: after it, nobody can finish the task
  const auto branch = Run({"replay", file, "--at", "3", "--surgeon", "expert", "--record", other});
  EXPECT_EQ(branch.status, 0) << branch.err;
  const json went = json::parse(branch.out, nullptr, false);
  EXPECT_EQ(went.at("outcome").at("task").at("phase"), "completed");
  const json verified = RunJson({"replay", other});
  EXPECT_EQ(verified.at("verified"), true);
  EXPECT_EQ(verified.at("hash"), went.at("hash"));
  const json info = RunJson({"record", "info", other});
  EXPECT_EQ(info.at("first_tick"), 360);
  EXPECT_EQ(info.at("branched").at("from"), "attempt.trocar");
  EXPECT_EQ(info.at("branched").at("tick"), 360);
  EXPECT_TRUE(RunJson({"record", "info", file}).at("branched").is_null());
  EXPECT_THAT(Run({"record", "info", other}).out, testing::HasSubstr("attempt.trocar at 3 s"));
}

TEST_F(RecordingCommand, AnyPartIsDrawn) {
  const std::string file = Record();
  const auto drawn =
      Run({"replay", file, "--from", "4", "--until", "5", "--size", "320x180", "-o", Path("video")});
  EXPECT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_THAT(List(), testing::IsSupersetOf({"video/demo.webm", "video/picture_001.png"}));
}

TEST_F(RecordingCommand, TwoAreDrawnBesideEachOther) {
  const std::string file = Record(), other = Path("other.trocar");
  RunJson({"play", "expert", "--task", "peg_transfer", "--seconds", "7", "--seed", "3", "--record", other});
  const auto drawn =
      Run({"replay", file, "--side-by-side", other, "--ghosts", "--no-forces", "--speed", "4", "--from", "4",
           "--until", "8", "--camera", "anterior", "--size", "480x200", "-o", Path("both")});
  EXPECT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_THAT(List(), testing::IsSupersetOf({"both/demo.webm", "both/picture_001.png"}));
  ExpectError(Run({"replay", file, "--side-by-side", other}), "E-CLI-001", 2);
  ExpectError(Run({"replay", file, "--speed", "0", "-o", Path("none")}), "E-CLI-001", 2);
  ExpectError(Run({"replay", file, "--camera", "moon", "-o", Path("none")}), "E-CLI-001", 2);
  ExpectError(Run({"replay", file, "--side-by-side", Path("none.trocar"), "-o", Path("none")}), "E-IO-001");
}

TEST_F(RecordingCommand, AnIndexIsMadeAndMayBeDeleted) {
  const std::string file = Record(), state = Path("a.state"), other = Path("b.state");
  EXPECT_EQ(Run({"replay", file, "--at", "7.5", "--save", state}).status, 0);
  const auto made = Run({"record", "index", file, "--seconds", "1"});
  EXPECT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.out, testing::HasSubstr("attempt.trocar.index holds 12 states"));
  EXPECT_EQ(Run({"replay", file, "--at", "7.5", "--save", other}).status, 0);
  EXPECT_EQ(Read(state), Read(other));
  std::filesystem::remove(file + ".index");
  EXPECT_EQ(RunJson({"replay", file}).at("verified"), true);
  EXPECT_FALSE(std::filesystem::exists(file + ".index")) << "the command line makes none by itself";
}

TEST_F(RecordingCommand, WhatCannotBeReplayedIsRefusedWithARemedy) {
  // its scene has changed since
  std::string scene = Read(Source("scenes/retraction.json"));
  const std::string patient = Source("assets/patients/visible-human-male/patient");
  const auto folder = Source("scenes/");
  std::filesystem::copy_file(folder + "retraction.script.json", Path("retraction.script.json"));
  Write("scene.json", scene);
  const std::string file = Path("scene.trocar");
  const auto simulated =
      Run({"simulate", Path("scene.json"), "--patient", patient, "--ticks", "30", "--record", file});
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  EXPECT_EQ(Run({"replay", file}).status, 0);
  json changed = json::parse(scene);
  changed["materials"][0]["young_modulus_pa"] = 9e5;
  Write("scene.json", changed.dump());
  const auto of_another = Run({"replay", file});
  ExpectError(of_another, "E-REC-001");
  EXPECT_THAT(of_another.err, testing::HasSubstr("put the old files back"));
  std::filesystem::remove(Path("scene.json"));
  ExpectError(Run({"replay", file}), "E-IO-001");
  // it is from the future
  std::string content = Read(file);
  std::string future = content;
  future[8] = 7;
  Write("future.trocar", future);
  const auto newer = Run({"replay", Path("future.trocar")});
  ExpectError(newer, "E-REC-001");
  EXPECT_THAT(newer.err, testing::HasSubstr("use the version that wrote it, or a newer one"));
  ExpectError(Run({"record", "info", Path("future.trocar")}), "E-REC-001");
  // it has no header
  Write("short.trocar", content.substr(0, 20));
  ExpectError(Run({"replay", Path("short.trocar")}), "E-REC-001");
  ExpectError(Run({"record", "repair", Path("short.trocar"), "-o", Path("mended.trocar")}), "E-REC-001");
}

TEST_F(RecordingCommand, ACutRecordingIsReplayedUpToThereAndSaysSo) {
  const std::string content = Read(Record());
  Write("cut.trocar", content.substr(0, content.size() / 2));
  const auto replayed = Run({"replay", Path("cut.trocar")});
  EXPECT_EQ(replayed.status, 0) << replayed.err;
  EXPECT_THAT(replayed.out, testing::AllOf(testing::StartsWith("VERIFIED"), testing::HasSubstr("no ending"),
                                           testing::HasSubstr("damaged")));
}

TEST_F(RecordingCommand, SaysWhatDoesNotGoTogether) {
  const std::string file = Record();
  ExpectError(Run({"replay", file, "--at", "3"}), "E-CLI-001", 2);
  ExpectError(Run({"replay", file, "--at", "99", "--surgeon", "expert"}), "E-CLI-001", 2);
  ExpectError(Run({"play", "novice", "--task", "peg_transfer", "--record", file}), "E-IO-003");
}

}  // namespace
}  // namespace trocar
