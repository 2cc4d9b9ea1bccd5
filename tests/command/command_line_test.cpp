// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "command_fixture.h"
#include "trocar/base/error_codes.h"
#include "trocar/base/simd_choice.h"

namespace trocar {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class CommandLine : public Command {};

TEST_F(CommandLine, HelpNamesEverySubcommandAndExamples) {
  const auto result = Run({"--help"});
  EXPECT_EQ(result.status, 0);
  for (const char* word :
       {"window", "demo", "simulate", "anatomy", "bench", "doctor", "errors", "Examples", "Exit status"}) {
    EXPECT_THAT(result.out, HasSubstr(word));
  }
  for (const char* subcommand : {"window", "demo", "simulate", "anatomy", "bench", "doctor", "errors"}) {
    EXPECT_EQ(Run({subcommand, "--help"}).status, 0) << subcommand;
  }
}

TEST_F(CommandLine, VersionIsOneLine) {
  const auto result = Run({"--version"});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, testing::MatchesRegex("trocar [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST_F(CommandLine, WrongUsageIsStatusTwo) {
  const std::vector<std::vector<std::string>> wrong = {
      {},
      {"nonsense"},
      {"--nonsense"},
      {"anatomy"},
      {"simulate"},
      {"simulate", "scene.json"},
      {"simulate", "scene.json", "--ticks", "0"},
      {"simulate", "scene.json", "--ticks", "ten"},
      {"simulate", "scene.json", "--ticks", "10", "--threads", "0"},
      {"demo", "--size", "big"},
      {"demo", "--size", "1x1"},
      {"demo", "--seconds", "nan"},
      {"bench"},
      {"bench", "nonsense"},
  };
  for (const auto& arguments : wrong) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    ExpectError(Run(arguments), "E-CLI-001", 2);
  }
}

TEST_F(CommandLine, MisspeltSubcommandIsNamed) {
  EXPECT_THAT(Run({"simulat"}).err, HasSubstr("\"simulat\""));
}

// The page is the output of the command, and the command prints the table.
TEST_F(CommandLine, ErrorsAreThoseOfTheTableAndOfThePage) {
  const auto result = Run({"errors", "--markdown"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.out, Read(Source("docs/errors.md"))) << "run: trocar errors --markdown > docs/errors.md";
  const std::string table = Run({"errors"}).out;
  for (const base::ErrorEntry& entry : base::ErrorTable().subspan(1)) {
    EXPECT_THAT(table, HasSubstr(std::string(entry.text)));
  }
}

TEST_F(CommandLine, DoctorSaysOfEachCheckWhatItFoundAndMeans) {
  const auto result = Run({"doctor", "--json"});
  const auto json = nlohmann::json::parse(result.out);
  std::vector<std::string> names;
  bool is_missing = false;
  for (const auto& check : json.at("checks")) {
    names.push_back(check.at("name"));
    EXPECT_NE(check.at("found"), "") << check;
    EXPECT_NE(check.at("meaning"), "") << check;
    if (check.at("state") != "good") {
      EXPECT_TRUE(check.at("remedy") != "" || check.at("name") == "display") << check;
    }
    is_missing = is_missing || check.at("state") == "missing";
  }
  EXPECT_THAT(names, testing::IsSupersetOf({"data", "opengl", "video", "display", "window", "gpu",
                                            "real-time", "input", "serial", "3d-mouse", "sound"}));
  EXPECT_EQ(result.status, is_missing ? 1 : 0);
  EXPECT_THAT(Run({"doctor"}).out, HasSubstr("opengl"));
}

TEST_F(CommandLine, DoctorFindsThatTheDataIsGone) {
  const auto result = Run({"doctor", "--json"}, {"TROCAR_DATA_DIR=" + Path("")});
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(nlohmann::json::parse(result.out).at("checks").at(0).at("state"), "missing");
}

TEST_F(CommandLine, DoctorSaysWhichVectorInstructionsRun) {
  const auto ask = [](const std::vector<std::string>& environment) {
    const auto json = nlohmann::json::parse(Run({"doctor", "--json"}, environment).out);
    for (const auto& check : json.at("checks")) {
      if (check.at("name") == "processor") return check.at("found").get<std::string>();
    }
    return std::string();
  };
  EXPECT_THAT(ask({"TROCAR_SIMD=baseline"}), testing::StartsWith("baseline; "));
  EXPECT_THAT(ask({}), testing::EndsWith(std::string(base::SimdLevelName(base::FindWidestSimdLevel()))));
  const auto refused = Run({"doctor"}, {"TROCAR_SIMD=avx9"});
  ExpectError(refused, "E-CLI-001", 2);
  EXPECT_THAT(refused.err, HasSubstr("baseline"));
}

// No GL: the loader is told of no driver.
TEST_F(CommandLine, DoctorFindsThatThereIsNoOpenGl) {
  Write("empty.json", "{}");
  const auto result = Run({"doctor", "--json"}, {"__EGL_VENDOR_LIBRARY_FILENAMES=" + Path("empty.json")});
  EXPECT_EQ(result.status, 1);
  const auto json = nlohmann::json::parse(result.out);
  int looked = 0;
  for (const auto& check : json.at("checks")) {
    if (check.at("name") != "opengl") continue;
    ++looked;
    EXPECT_EQ(check.at("state"), "missing");
    EXPECT_THAT(std::string(check.at("remedy")), HasSubstr("libegl1"));
  }
  EXPECT_EQ(looked, 1);
}

TEST_F(CommandLine, BenchListsItsSuites) {
  const auto result = Run({"bench", "--list"});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, HasSubstr("tissue"));
  EXPECT_THAT(result.out, HasSubstr("collision"));
}

TEST_F(CommandLine, BenchCollisionPrintsCasesAndRatios) {
  const auto result = Run({"bench", "collision", "--repeats", "1", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json.at("suite"), "collision");
  EXPECT_THAT(std::string(json.at("machine")), HasSubstr("core"));
  ASSERT_FALSE(json.at("cases").empty());
  for (const auto& entry : json.at("cases")) {
    EXPECT_TRUE(entry.at("name").is_string() && entry.at("value").is_number() && entry.at("unit").is_string())
        << entry;
  }
  ASSERT_FALSE(json.at("ratios").empty());
  for (const auto& ratio : json.at("ratios")) EXPECT_GT(ratio.at("value").get<double>(), 0.0) << ratio;
}

}  // namespace
}  // namespace trocar
