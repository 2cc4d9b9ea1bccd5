// SPDX-License-Identifier: Apache-2.0
#include "trocar/report/xapi.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "sample_reports.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::report {
namespace {

using nlohmann::json;
const XapiSettings kSettings{"https://training.hospital.example", true};

/// Of a report that has what is needed.
std::vector<XapiStatement> Make(const AttemptReport& report, const XapiSettings& settings) {
  const auto statements = MakeStatements(report, settings);
  EXPECT_TRUE(statements.ok()) << statements.error().Text();
  return statements.ok() ? *statements : std::vector<XapiStatement>();
}

/// xAPI 1.0.3, part two, section 2: what a statement may hold, and how. Empty where it is one.
std::string FindFault(const json& statement) {
  const std::set<std::string> allowed = {"id",        "actor",   "verb",       "object",
                                         "result",    "context", "timestamp",  "stored",
                                         "authority", "version", "attachments"};
  const std::regex uuid("[0-9a-f]{8}-[0-9a-f]{4}-[1-5][0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}"),
      iri("[a-z][a-z0-9+.-]*:[^\\s<>\"{}|\\\\^`]+"), language("[a-z]{2,3}(-[A-Za-z0-9]+)*"),
      period("P(T(\\d+H)?(\\d+M)?(\\d+(\\.\\d+)?S)?)"),
      time("\\d{4}-\\d{2}-\\d{2}T\\d{2}:\\d{2}:\\d{2}(\\.\\d+)?(Z|[+-]\\d{2}:\\d{2})");
  const auto is = [](const json& value, const std::regex& form) {
    return value.is_string() && std::regex_match(value.get<std::string>(), form);
  };
  if (!statement.is_object()) return "is no object";
  for (const auto& [key, value] : statement.items()) {
    if (allowed.count(key) == 0) return "has \"" + key + "\"";
    if (value.is_null()) return "null in " + key;
  }
  if (!is(statement["id"], uuid)) return "id";
  const json& actor = statement.at("actor");
  if (actor.value("objectType", "") != "Agent" || actor.size() != 2) return "actor must have one identifier";
  if (!is(actor.at("account").at("homePage"), iri) || actor["account"].value("name", "").empty() ||
      actor["account"].size() != 2)
    return "account";
  if (!is(statement.at("verb").at("id"), iri)) return "verb";
  for (const auto& [tag, word] : statement["verb"].at("display").items()) {
    if (!std::regex_match(tag, language) || !word.is_string()) return "display";
  }
  if (!is(statement.at("object").at("id"), iri) ||
      statement["object"].value("objectType", "Activity") != "Activity")
    return "object";
  if (!is(statement["object"].at("definition").at("type"), iri)) return "activity type";
  if (statement.contains("result")) {
    const json& result = statement["result"];
    const std::set<std::string> of_result = {"score",    "success",  "completion",
                                             "response", "duration", "extensions"};
    for (const auto& [key, value] : result.items()) {
      if (of_result.count(key) == 0 || value.is_null()) return "result has " + key;
    }
    if (result.contains("duration") && !is(result["duration"], period)) return "duration";
    if (result.contains("score") && result["score"].contains("scaled")) {
      const double scaled = result["score"]["scaled"];
      if (scaled < -1 || scaled > 1) return "scaled";
    }
    const json extensions = result.value("extensions", json::object());
    for (const auto& [key, value] : extensions.items()) {
      if (!std::regex_match(key, iri)) return "extension " + key;
    }
  }
  if (!is(statement.at("context").at("registration"), uuid)) return "registration";
  if (!std::regex_match(statement["context"].value("language", "en"), language)) return "language";
  if (statement.contains("timestamp") && !is(statement["timestamp"], time)) return "timestamp";
  return "";
}

std::vector<json> Parse(const std::vector<XapiStatement>& statements) {
  std::vector<json> parsed;
  for (const XapiStatement& statement : statements) {
    parsed.push_back(json::parse(statement.json));
    EXPECT_EQ(parsed.back()["id"], statement.id);
  }
  return parsed;
}

TEST(XapiStatements, HoldToTheSpecification) {
  AttemptReport report = test::MakeTaskReport();
  for (const double score : {87.5, 130.0, -5.0}) {
    report.score = score;
    for (const char* key : {"object_transport", "my <odd> \"task\" ü"}) {
      report.facts.task_key = key;
      const auto statements = MakeStatements(report, kSettings);
      ASSERT_TRUE(statements.ok()) << statements.error().Text();
      for (const json& statement : Parse(*statements))
        EXPECT_EQ(FindFault(statement), "") << statement.dump(1);
    }
  }
  // the check can tell
  json broken = Parse(Make(report, kSettings))[1];
  broken["result"]["score"]["scaled"] = 1.3;
  EXPECT_EQ(FindFault(broken), "scaled");
}

TEST(XapiStatements, SayWhatBecameOfTheAttempt) {
  const auto verbs = [](const AttemptReport& report, std::optional<bool> is_passed) {
    std::vector<std::string> words;
    for (const json& statement : Parse(Make(report, {kSettings.home_page, is_passed})))
      words.push_back(statement["verb"]["display"]["en"]);
    return words;
  };
  AttemptReport report = test::MakeTaskReport();
  EXPECT_THAT(verbs(report, true), testing::ElementsAre("attempted", "completed", "scored", "passed"));
  EXPECT_THAT(verbs(report, {}), testing::ElementsAre("attempted", "completed", "scored"));
  report.is_completed = false;
  EXPECT_THAT(verbs(report, false), testing::ElementsAre("attempted", "terminated", "failed"));
}

TEST(XapiStatements, TellWhenItBeganAndEndedInUtc) {
  const auto parsed = Parse(Make(test::MakeTaskReport(), kSettings));
  EXPECT_EQ(parsed[0]["timestamp"], "2026-11-24T21:50:20Z");
  EXPECT_EQ(parsed[1]["timestamp"], "2026-11-24T21:51:50Z");
  EXPECT_EQ(parsed[1]["result"]["duration"], "PT90.00S");
  EXPECT_NEAR(parsed[2]["result"]["score"]["scaled"].get<double>(), 0.875, 1e-12);
}

TEST(XapiStatements, HaveTheSameIdForTheSameAttemptOnly) {
  AttemptReport report = test::MakeTaskReport();
  const auto first = Make(report, kSettings), again = Make(report, kSettings);
  std::set<std::string> ids;
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].id, again[i].id);
    EXPECT_EQ(first[i].json, again[i].json);
    EXPECT_TRUE(ids.insert(first[i].id).second);
  }
  report.facts.started = "2026-11-24T22:50:21+01:00";
  for (const XapiStatement& statement : Make(report, kSettings)) EXPECT_TRUE(ids.insert(statement.id).second);
}

TEST(XapiStatements, KnowThePseudonymAndNothingElseOfThePerson) {
  AttemptReport report = test::MakeTaskReport();
  report.facts.player = "Maria Lopez at the mouse";
  report.facts.recording = "maria.trocar";
  for (const XapiStatement& statement : Make(report, kSettings)) {
    EXPECT_THAT(statement.json, testing::HasSubstr("T-7F3K2Q"));
    EXPECT_THAT(statement.json, testing::Not(testing::HasSubstr("aria")));
  }
  report.facts.person.clear();
  EXPECT_EQ(MakeStatements(report, kSettings).error().code, base::ErrorCode::kUsage);
  report.facts.person = "T-1";
  EXPECT_EQ(MakeStatements(report, {"hospital", {}}).error().code, base::ErrorCode::kUsage);
}

TEST(XapiQueue, KeepsOneFileEachAndNothingTwice) {
  trocar::test::TemporaryFolder folder;
  XapiQueue queue(folder.Path() / "queue");
  const auto statements = Make(test::MakeTaskReport(), kSettings);
  for (int twice = 0; twice < 2; ++twice) {
    for (const XapiStatement& statement : statements) ASSERT_TRUE(queue.Add(statement).ok());
  }
  EXPECT_EQ(queue.List().size(), statements.size());
  // half a file of a program that was killed, and one that is none of ours
  std::ofstream(queue.Folder() / "half.json.part") << "{";
  std::ofstream(queue.Folder() / "half.json") << "{\"id\":";
  EXPECT_EQ(queue.List().size(), statements.size());
  ASSERT_TRUE(queue.Remove(statements[0].id).ok());
  ASSERT_TRUE(queue.Refuse(statements[1], "answer 400").ok());
  EXPECT_EQ(queue.List().size(), statements.size() - 2);
  EXPECT_EQ(queue.ListRefused().size(), 1u);
}

TEST(XapiQueue, FailsWhereItCannotWrite) {
  XapiQueue queue("/proc/trocar-queue");
  EXPECT_EQ(queue.Add({"id", "{}"}).error().code, base::ErrorCode::kFileUnwritable);
}

TEST(XapiQueue, ForgetsAPerson) {
  trocar::test::TemporaryFolder folder;
  XapiQueue queue(folder.Path());
  AttemptReport report = test::MakeTaskReport();
  for (const char* person : {"T-ERASE", "T-KEEP"}) {
    report.facts.person = person;
    for (const XapiStatement& statement : Make(report, kSettings)) ASSERT_TRUE(queue.Add(statement).ok());
  }
  // which is first in the list depends on the clock of the disk
  report.facts.person = "T-ERASE";
  ASSERT_TRUE(queue.Refuse(Make(report, kSettings)[0], "no T-ERASE").ok());
  // files of others are no statements, and no reason to stop
  for (const char* strange : {"[]", "7", R"({"id": 7})", "{"})
    ASSERT_TRUE(host::WriteFile(folder.Path() / "strange.json", strange).ok() &&
                queue.Erase("T-NOBODY").left.empty() && queue.List().size() == 7u)
        << strange;
  std::filesystem::remove(folder.Path() / "strange.json");
  const auto erased = queue.Erase("T-ERASE");
  EXPECT_THAT(erased.left, testing::IsEmpty());
  EXPECT_EQ(erased.statements, 4u);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.Path())) {
    if (!entry.is_regular_file()) continue;
    const auto text = host::ReadFile(entry.path());
    ASSERT_TRUE(text.ok());
    EXPECT_EQ(text->find("T-ERASE"), std::string::npos) << entry.path();
  }
  EXPECT_EQ(queue.List().size(), 4u);
}

// What stands in the way of one file stops nothing, and is named.
TEST(XapiQueue, ForgetsAPersonBeyondWhatItCannotRead) {
  trocar::test::TemporaryFolder folder;
  XapiQueue queue(folder.Path());
  AttemptReport report = test::MakeTaskReport();
  report.facts.person = "T-ERASE";
  const auto statements = Make(report, kSettings);
  for (const XapiStatement& statement : statements) ASSERT_TRUE(queue.Add(statement).ok());
  ASSERT_TRUE(queue.Refuse(statements[0], "answer 400").ok());
  const auto write = [&](const char* name, const std::string& text) {
    ASSERT_TRUE(host::WriteFile(folder.Path() / name, text).ok());
  };
  const std::string large(std::size_t{2} << 20, ' ');
  write("0-large.json", large + "T-ERASE");
  write("refused/0-large.json", large);
  write("0-damaged.json", R"({"actor": {"account": {"name": "T-ERASE")");
  write("0-strange.json", R"({"actor": {"account": {"name": "T-OTHER"}}, "about": "T-ERASE"})");
  write("0-other.json", R"({"id": 7})");
  // of a program that was killed between the reason and the statement
  write("refused/lonely.txt", "answer 400 for T-ERASE");
  write("0.json.part", R"({"actor": {"account": {"name": "T-ERASE")");
  const auto erased = queue.Erase("T-ERASE");
  EXPECT_EQ(erased.statements, statements.size() + 1);
  using testing::HasSubstr;
  EXPECT_THAT(erased.left,
              testing::UnorderedElementsAre(HasSubstr((folder.Path() / "0-large.json").string()),
                                            HasSubstr((folder.Path() / "refused/0-large.json").string()),
                                            HasSubstr((folder.Path() / "0-damaged.json").string())));
  EXPECT_TRUE(queue.List().empty());
  EXPECT_FALSE(std::filesystem::exists(folder.Path() / "refused/lonely.txt"));
  EXPECT_FALSE(std::filesystem::exists(folder.Path() / "0.json.part"));
  EXPECT_TRUE(std::filesystem::exists(folder.Path() / "0-strange.json"));
}

}  // namespace
}  // namespace trocar::report
