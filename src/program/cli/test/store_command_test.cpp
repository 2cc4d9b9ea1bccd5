// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "run_trocar.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/process.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::cli {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

class StoreCommand : public testing::Test {
 protected:
  /// `trocar store ...` on a store of the test's own.
  Printed Run(std::vector<std::string> words) {
    words.insert(words.begin(), "store");
    words.insert(words.end(), {"--store", (folder_.Path() / "s.sqlite").string()});
    return RunTrocar(words);
  }
  Json RunJson(std::vector<std::string> words) {
    words.push_back("--json");
    const Printed run = Run(words);
    EXPECT_EQ(run.status, 0) << run.err;
    return Json::parse(run.out, nullptr, false);
  }
  static std::string Word(const Printed& run) { return run.out.substr(0, run.out.find('\n')); }
  std::string Path(const std::string& name) { return folder_.Path() / name; }

  test::TemporaryFolder folder_;
};

TEST_F(StoreCommand, LeadsATraineeFromTheFirstAttemptToErasure) {
  const Printed added = Run({"trainee", "add", "--name", "Ada Lovelace"});
  ASSERT_EQ(added.status, 0) << added.err;
  const std::string ada = Word(added);
  EXPECT_THAT(Run({"trainee", "list"}).out, HasSubstr("Ada Lovelace"));
  EXPECT_EQ(Run({"group", "add", "evening"}).status, 0);
  EXPECT_EQ(Run({"group", "join", "evening", ada}).status, 0);

  const Printed played = RunTrocar(
      {"play", "expert", "--task", "instrument_navigation", "--seed", "3", "--record", Path("a.trocar")});
  ASSERT_EQ(played.status, 0) << played.err;
  for (int i = 0; i < 2; ++i) {  // the second time it is there already
    const Printed kept = Run({"add", Path("a.trocar"), "--trainee", ada});
    EXPECT_EQ(kept.status, 0) << kept.err;
    EXPECT_THAT(kept.out, HasSubstr("in the store"));
  }
  const Json attempts = RunJson({"attempts", "--trainee", ada, "--group", "evening"});
  ASSERT_EQ(attempts["attempts"].size(), 1u);
  EXPECT_EQ(attempts["attempts"][0]["task"], "instrument_navigation");
  EXPECT_EQ(attempts["attempts"][0]["completed"], true);
  EXPECT_THAT(Run({"attempts"}).out, HasSubstr("completed"));
  const Json compared = RunJson({"percentile", "--task", "instrument_navigation", "--level",
                                 attempts["attempts"][0]["level"], "--group", "evening", "--trainee", ada});
  EXPECT_EQ(compared["trainees"], 1);
  EXPECT_EQ(compared["percentile"], 50.0);

  EXPECT_EQ(RunJson({"info"})["attempts"], 1);
  EXPECT_EQ(Run({"verify"}).status, 0);
  EXPECT_EQ(Run({"backup", Path("b.sqlite")}).status, 0);
  EXPECT_EQ(Run({"verify", Path("b.sqlite")}).status, 0);
  EXPECT_EQ(Run({"export", Path("e.json")}).status, 0);
  EXPECT_EQ(Run({"export", Path("e.csv")}).status, 0);
  EXPECT_EQ(RunJson({"import", Path("e.json")})["known"], 1);
  EXPECT_EQ(Run({"retain", "--days", "400"}).status, 0);
  EXPECT_EQ(RunJson({"tidy"})["attempts"], 0);
  EXPECT_EQ(Run({"trainee", "export", ada, "-o", Path("ada")}).status, 0);
  EXPECT_TRUE(fs::exists(Path("ada/person.json")));

  EXPECT_EQ(Run({"trainee", "erase", ada}).status, 2) << "not without --yes";
  const Printed erased = Run({"trainee", "erase", ada, "--yes"});
  EXPECT_EQ(erased.status, 0) << erased.err;
  EXPECT_THAT(erased.out, HasSubstr("1 attempts, 1 recordings"));
  EXPECT_THAT(erased.out, HasSubstr(Path("b.sqlite")));
  EXPECT_FALSE(fs::exists(Path("a.trocar")));
  EXPECT_THAT(Run({"trainee", "list"}).out, Not(HasSubstr("Lovelace")));
}

// Each output that shows an attempt; a new one joins this list.
TEST_F(StoreCommand, EachSaysWhetherAnAttemptIsVerified) {
  const std::string ada = Word(Run({"trainee", "add"}));
  const Printed played = RunTrocar(
      {"play", "expert", "--task", "instrument_navigation", "--seed", "3", "--record", Path("a.trocar")});
  ASSERT_EQ(played.status, 0) << played.err;
  ASSERT_EQ(Run({"add", Path("a.trocar"), "--trainee", ada, "--unverified"}).status, 0);
  int exports = 0;
  const auto read = [&](const std::vector<std::string>& words, const std::string& file) {
    const Printed run = Run(words);
    EXPECT_EQ(run.status, 0) << words[0] << ": " << run.err;
    return file.empty() ? run.out : host::ReadFile(file).ok() ? *host::ReadFile(file) : std::string();
  };
  const auto show = [&]() -> std::vector<std::pair<std::string, std::string>> {
    const std::string n = std::to_string(++exports);
    return {
        {"table", read({"attempts"}, "")},
        {"json", read({"attempts", "--json"}, "")},
        {"export", read({"export", Path(n + ".json")}, Path(n + ".json"))},
        {"csv", read({"export", Path(n + ".csv")}, Path(n + ".csv"))},
        {"person", read({"trainee", "export", ada, "-o", Path("p" + n)}, Path("p" + n + "/person.json"))}};
  };
  for (const auto& [where, text] : show())
    EXPECT_THAT(text, testing::AnyOf(HasSubstr("not verified"), HasSubstr("unverified"))) << where;
  const std::vector<std::string> percentile = {"percentile", "--task", "instrument_navigation", "--trainee",
                                               ada};
  EXPECT_EQ(Run(percentile).status, 1) << "what a file says compares with nobody";
  const Json replayed = RunJson({"verify", "--attempts"});
  EXPECT_EQ(replayed["verified"], 1);
  EXPECT_EQ(RunJson({"verify", "--attempts"})["verified"], 0) << "again does nothing";
  for (const auto& [where, text] : show()) {
    EXPECT_THAT(text, Not(testing::AnyOf(HasSubstr("not verified"), HasSubstr("unverified")))) << where;
    EXPECT_THAT(text, testing::AnyOf(HasSubstr("verified"), HasSubstr("replayed"))) << where;
  }
  EXPECT_EQ(RunJson({"attempts"})["attempts"][0]["counts"], true);
  // another store does not believe this one's file
  const std::string other = Path("other.sqlite");
  EXPECT_EQ(RunTrocar({"store", "import", Path("2.json"), "--store", other}).status, 0);
  EXPECT_THAT(RunTrocar({"store", "attempts", "--store", other}).out,
              HasSubstr("not verified: it came with a file"));
  EXPECT_EQ(RunTrocar({"store", "verify", "--attempts", "--store", other}).status, 0);
  EXPECT_THAT(RunTrocar({"store", "attempts", "--store", other}).out, Not(HasSubstr("not verified")));
}

TEST_F(StoreCommand, ShowsUnderARoleWhatTheRoleMaySee) {
  const std::string one = Word(Run({"trainee", "add", "--name", "Ada Lovelace"}));
  const std::string other = Word(Run({"trainee", "add"}));
  const Printed list = Run({"trainee", "list", "--as", one});
  EXPECT_THAT(list.out, HasSubstr(one));
  EXPECT_THAT(list.out, Not(HasSubstr(other)));
  EXPECT_THAT(list.out, Not(HasSubstr("Lovelace"))) << "names are the owner's";
  for (const auto& words :
       std::vector<std::vector<std::string>>{{"info"}, {"trainee", "add"}, {"backup"}, {"tidy"}}) {
    std::vector<std::string> asked = words;
    asked.insert(asked.end(), {"--as", one});
    const Printed run = Run(asked);
    EXPECT_EQ(run.status, 1);
    EXPECT_THAT(run.err, HasSubstr("E-STO-007"));
  }
}

TEST_F(StoreCommand, SaysWhatIsWrongWithItsCode) {
  EXPECT_THAT(Run({"attempts", "--trainee", "T-NOBODY"}).err, HasSubstr("E-STO-008"));
  EXPECT_THAT(Run({"attempts", "--page", "x"}).err, HasSubstr("E-CLI-001"));
  EXPECT_THAT(Run({"verify", Path("none.sqlite")}).err, HasSubstr("E-IO-001"));
  EXPECT_THAT(RunTrocar({"store", "info", "--store", "postgresql://x:secret@/y?host=/nowhere"}).err,
              testing::AllOf(HasSubstr("E-STO-003"), Not(HasSubstr("secret"))));
  // a store that only is looked at is not made
  test::TemporaryFolder empty;
  EXPECT_EQ(RunTrocar({"store", "verify", "--store", empty.Path() / "s.sqlite"}).status, 1);
  EXPECT_TRUE(fs::is_empty(empty.Path()));
}

TEST_F(StoreCommand, KeepsAttemptsWhileTheStoreIsAway) {
  const Printed played =
      RunTrocar({"play", "expert", "--task", "instrument_navigation", "--record", Path("a.trocar")});
  ASSERT_EQ(played.status, 0) << played.err;
  ::setenv("TROCAR_DATA_HOME", Path("data").c_str(), 1);
  const Printed kept =
      RunTrocar({"store", "add", Path("a.trocar"), "--store", "postgresql://nobody@/none?host=/nowhere"});
  ::unsetenv("TROCAR_DATA_HOME");
  EXPECT_EQ(kept.status, 1);
  EXPECT_THAT(kept.out, HasSubstr("waits in the spool"));
  EXPECT_THAT(kept.err, HasSubstr("E-STO-003"));
  // a stranger's attempt is held until they are known
  EXPECT_EQ(Run({"add", Path("a.trocar"), "--trainee", "T-LATER"}).status, 1);
  EXPECT_EQ(RunJson({"info"})["held"], 1);
  EXPECT_EQ(Run({"trainee", "add", "--pseudonym", "T-LATER"}).status, 0);
  EXPECT_EQ(RunJson({"deliver", "--held"})["added"], 1);
}

TEST_F(StoreCommand, WritesFilesThatTheirSchemasAccept) {
  const std::string check = std::string(TROCAR_SOURCE_DIR) + "/tools/check-schemas";
  if (test::RunProcess({check, "--check"}).status == 3) GTEST_SKIP() << "python3-jsonschema is not installed";
  const std::string ada = Word(Run({"trainee", "add", "--name", "Ada \\ \"Lovelace\""}));
  const Printed played =
      RunTrocar({"play", "expert", "--task", "instrument_navigation", "--record", Path("a.trocar")});
  ASSERT_EQ(played.status, 0) << played.err;
  EXPECT_EQ(Run({"add", Path("a.trocar"), "--trainee", ada}).status, 0);
  EXPECT_EQ(Run({"export", Path("e.json")}).status, 0);
  EXPECT_EQ(Run({"trainee", "export", ada, "-o", Path("ada")}).status, 0);
  const fs::path journal = Path("s.sqlite.files/journal");
  const std::string attempt = fs::directory_iterator(journal)->path();
  for (const std::string& file :
       {Path("e.json"), Path("ada/person.json"), attempt, Path("s.sqlite.files/names.json")}) {
    const auto checked = test::RunProcess({check, file});
    EXPECT_EQ(checked.status, 0) << checked.out << checked.err;
  }
}

}  // namespace
}  // namespace trocar::cli
