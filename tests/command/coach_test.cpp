// SPDX-License-Identifier: Apache-2.0
// The coach and the study on the command line.
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "command_fixture.h"

namespace trocar {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class CoachCommand : public Command {
 protected:
  static int CheckSchema(const std::string& file) {
    const std::string tool = Source("tools/check-schemas");
    if (std::system(("'" + tool + "' --check").c_str()) != 0)
      return 0;  // its package is missing: tested elsewhere
    return std::system(("'" + tool + "' '" + file + "' > /dev/null").c_str());
  }
  std::string Record(const std::string& surgeon, const std::string& task) {
    const std::string file = Path(surgeon + ".trocar");
    const auto played = Run({"play", surgeon, "--task", task, "--seed", "11", "--record", file});
    EXPECT_EQ(played.status, 0) << played.err;
    return file;
  }
};

TEST_F(CoachCommand, NamesTheTremorAndItsNumbers) {
  const std::string file = Record("trembles", "instrument_navigation");
  const auto asked = Run({"coach", file, "--json"});
  ASSERT_EQ(asked.status, 0) << asked.err;
  const json said = json::parse(asked.out);
  ASSERT_FALSE(said.at("advice").empty());
  const json& first = said.at("advice")[0];
  EXPECT_EQ(first.at("rule"), "tremor");
  EXPECT_EQ(first.at("exercise"), "instrument_navigation");
  EXPECT_GE(first.at("deviation"), first.at("threshold"));
  EXPECT_TRUE(first.at("time_s").is_number());
  const auto words = Run({"coach", file});
  EXPECT_THAT(words.out, HasSubstr("1. The tips trembled"));
  EXPECT_THAT(words.out, HasSubstr("not certified assessment"));
}

TEST_F(CoachCommand, ReadsOtherRulesAndRefusesBadOnes) {
  const std::string file = Record("expert", "instrument_navigation");
  Write(
      "own.json",
      R"({"format": "trocar-coach-rules", "version": 1, "rules": [{"id": "slow", "topic": "time", "measure": "coach:time",
    "absolute": 1, "sentence": "Slow.", "sentence_alone": "Slow.", "threshold_sd": 0, "least": 1, "why": "w", "exercise": "peg_transfer",
    "practise": "p", "source": "s"}]})");
  Write("none.json", R"({"format": "trocar-validity", "version": 1, "tasks": []})");
  const auto asked =
      Run({"coach", file, "--rules", Path("own.json"), "--validity", Path("none.json"), "--json"});
  ASSERT_EQ(asked.status, 0) << asked.err;
  EXPECT_EQ(json::parse(asked.out).at("advice")[0].at("rule"), "slow");
  EXPECT_EQ(json::parse(asked.out).at("expert_set"), false);
  Write("bad.json", R"({"format": "trocar-coach-rules", "version": 1, "rules": [{"id": "a"}]})");
  ExpectError(Run({"coach", file, "--rules", Path("bad.json")}), "E-IO-005");
  ExpectError(Run({"coach", Path("nothing.trocar")}), "E-IO-001");
}

TEST_F(CoachCommand, AStudyIsWrittenInPiecesAndReadByTheCoach) {
  const std::vector<std::string> study = {
      "study",     "--task", "instrument_navigation", "--people", "3",
      "--repeats", "2",      "--levels-only",         "-o",       Path("study")};
  std::vector<std::string> piece = study;
  piece.insert(piece.end(), {"--most-seconds", "0.001"});
  const auto stopped = Run(piece);
  EXPECT_EQ(stopped.status, 1) << stopped.err;
  EXPECT_THAT(stopped.out, HasSubstr("the same command goes on"));
  const auto done = Run(study);
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("instrument_navigation"));
  EXPECT_EQ(CheckSchema(Path("study/validity.json")), 0);
  EXPECT_EQ(json::parse(Read(Path("study/findings.json"))).at("tasks")[0].at("attempts"), 18);
  EXPECT_THAT(Read(Path("study/study.html")), HasSubstr("<svg"));
  const std::string file = Record("trembles", "instrument_navigation");
  const auto asked = Run({"coach", file, "--validity", Path("study/validity.json"), "--json"});
  ASSERT_EQ(asked.status, 0) << asked.err;
  EXPECT_EQ(json::parse(asked.out).at("expert_set"), true);
  EXPECT_EQ(json::parse(asked.out).at("advice")[0].at("rule"), "tremor");
  ExpectError(Run({"study", "--task", "cholecystectomy", "-o", Path("other")}), "E-SCN-003");
}

TEST_F(CoachCommand, TheCriticalViewIsDrawnOfAnOperationAlone) {
  const std::string file = Path("operation.trocar");
  ASSERT_EQ(Run({"play", "expert", "--task", "cholecystectomy", "--seconds", "3", "--record", file}).status,
            0);
  const auto drawn =
      Run({"replay", file, "--critical-view", "-o", Path("view"), "--size", "320x180", "--json"});
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_EQ(json::parse(drawn.out).at("achieved"), false);
  EXPECT_TRUE(std::filesystem::exists(Path("view/front.png")));
  EXPECT_TRUE(std::filesystem::exists(Path("view/back.png")));
  ExpectError(Run({"replay", file, "--critical-view"}), "E-CLI-001", 2);
  ExpectError(
      Run({"replay", Record("expert", "instrument_navigation"), "--critical-view", "-o", Path("none")}),
      "E-CLI-001", 2);
}

}  // namespace
}  // namespace trocar
