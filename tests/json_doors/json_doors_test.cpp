// SPDX-License-Identifier: Apache-2.0
// Whoever takes JSON from outside is found by reading the sources, and gets the same hostile documents.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "bounded_child.h"
#include "doors.h"
#include "find_doors.h"
#include "hostile_documents.h"
#include "trocar/host/printable.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::json_doors {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::filesystem::path kRepository = TROCAR_SOURCE_DIR;
/// Of the processor, beside a door's own time: work that grows faster than the text comes to minutes, a slow or busy machine to less.
constexpr double kMostSecondsPerMegabyte = 1.0;

/// The reader itself, and what reads back only what this program has just written.
const std::map<std::string, std::string> kNoDoors = {
    {"src/platform/host/src/json.cpp JsonDocument::Parse", "the reader"},
    {"src/platform/host/src/json.cpp JsonDocument::Read", "the reader"},
    {"src/platform/host/src/json.cpp ParseJson", "the reader"},
    {"src/platform/host/src/json.cpp ParseJsonEvents", "the reader"},
    {"src/program/cli/src/own_json.h ParseOwnJson", "text of another module of this run"},
    {"src/judge/training/src/metric_definition.cpp DefinitionsDocument", "text that is compiled in"}};

std::set<std::string> FindAllDoors() {
  std::set<std::string> doors;
  for (const char* folder : {"src", "python"}) {
    for (const auto& [name, text] : ReadSources(kRepository, folder)) doors.merge(FindDoors(name, text));
  }
  return doors;
}

TEST(JsonDoors, NothingButTheReaderParsesJson) {
  for (const char* folder : {"src", "python", "samples", "fuzz"}) {
    for (const auto& [name, text] : ReadSources(kRepository, folder)) {
      if (name == "src/platform/host/src/json.cpp") continue;
      for (const std::string& parser : FindOwnParsers(name, text))
        ADD_FAILURE() << parser << "\n  host::ParseJson and host::JsonDocument read within limits";
    }
  }
}

TEST(JsonDoors, WhoParsesAloneIsNoticed) {
  for (const char* line :
       {"auto a = json::parse(text);", "nlohmann::ordered_json::parse(text, nullptr, false)",
        "json::accept(text)", "nlohmann::json::sax_parse(stream, &reader);",
        "const auto v = json::from_cbor(bytes);", "stream >> json;", "in >> (a_json);", "\"{}\"_json",
        "return basic_json::parse(x);"})
    EXPECT_THAT(FindOwnParsers("f", line), ElementsAre("f:1: " + std::string(line)));
  for (const char* line : {"host::ParseJson<json>(text)", "// as json::parse does", "std::cout << json;",
                           "json::parse_error", "json::exception"})
    EXPECT_THAT(FindOwnParsers("f", line), IsEmpty()) << "the control: " << line;
}

TEST(JsonDoors, EachOfTheSourcesIsFed) {
  const std::set<std::string> found = FindAllDoors();
  std::set<std::string> fed;
  for (const Door& door : Doors()) fed.insert(door.functions.begin(), door.functions.end());
  for (const std::string& door : found) {
    EXPECT_TRUE(fed.contains(door) || kNoDoors.contains(door))
        << door << " reads JSON: tests/json_doors/doors.cpp must hand the hostile documents to it";
  }
  for (const std::string& door : fed) EXPECT_THAT(found, Contains(door)) << "it is no door any more";
  EXPECT_GT(found.size(), 40u);
}

TEST(JsonDoors, ANewOneIsFound) {
  const std::string source =
      "/// Reads.\ncore::Result<A> ReadA(const fs::path& path) {\n  const auto a =\n      "
      "host::JsonDocument::Read(path);\n"
      "}\n\nstd::optional<B> Folder::FindB(int b) const {\n  auto json = host::ParseJson<ordered_json>(text, "
      "name);\n}\n"
      "int C() {\n  return 1;  // not JsonDocument::Parse(a)\n}\n";
  EXPECT_THAT(FindDoors("f", source), ElementsAre("f Folder::FindB", "f ReadA"));
}

std::string ReadSample(const Door& door) {
  if (door.sample.empty() || door.sample[0] == '{' || door.sample[0] == '[') return door.sample;
  const auto text = host::ReadFile(kRepository / door.sample);
  EXPECT_TRUE(text.ok()) << text.error().Text();
  return text.ok() ? *text : std::string();
}

/// Hands each document to a door, in a process of its own.
ChildReport FeedAll(const Door& door, const std::vector<HostileDocument>& documents) {
  const test::TemporaryFolder folder;
  Feed feed;
  ChildLimits limits;
  limits.memory_bytes = door.memory_bytes;
  const auto hand_in = [&](std::size_t i) {
    if (!feed) feed = door.open(folder.Path());
    return feed(documents[i].text);
  };
  return RunInChild(documents.size(), hand_in, limits);
}

/// What is wrong with a report of documents.
std::string FindFault(const Door& door, const std::vector<HostileDocument>& documents,
                      const ChildReport& report) {
  std::string faults;
  for (std::size_t i = 0; i < report.pieces.size(); ++i) {
    const PieceReport& piece = report.pieces[i];
    const std::string at = "  " + documents[i].name + ": ";
    if (!piece.is_done) {
      faults += at + report.death + "\n";
      break;
    }
    const double most_seconds =
        door.most_seconds + kMostSecondsPerMegabyte * 1e-6 * static_cast<double>(documents[i].text.size());
    if (piece.cpu_seconds > most_seconds) faults += at + std::to_string(piece.cpu_seconds) + " s\n";
    if (!documents[i].is_json && !piece.is_refused && !door.takes_any_text) faults += at + "was taken\n";
    if (host::Printable(piece.message, 1000) != piece.message)
      faults += at + "its message is not fit to print: " + host::Printable(piece.message) + "\n";
  }
  return faults;
}

class EachDoor : public testing::TestWithParam<std::size_t> {};

TEST_P(EachDoor, TurnsAwayTheHundredHostileDocuments) {
  static const std::vector<HostileDocument> documents = MakeHostileDocuments();
  ASSERT_GE(documents.size(), 100u);
  const Door& door = Doors()[GetParam()];
  EXPECT_EQ(FindFault(door, documents, FeedAll(door, documents)), "") << door.name;
}

// the control: what is turned away above is not turned away because nothing is ever taken
TEST_P(EachDoor, TakesItsOwnText) {
  const Door& door = Doors()[GetParam()];
  if (door.sample.empty() || door.is_silent) return;
  const ChildReport report = FeedAll(door, {{"its own text", ReadSample(door), true}});
  EXPECT_TRUE(report.pieces[0].is_done) << report.death;
  EXPECT_EQ(report.pieces[0].message, "") << door.name;
}

TEST_P(EachDoor, OutlivesItsOwnTextChanged) {
  const Door& door = Doors()[GetParam()];
  if (door.sample.empty()) return;
  std::vector<HostileDocument> documents = MutateSample(ReadSample(door), door.most_mutations);
  ASSERT_GT(documents.size(), 10u);
  const ChildReport report = FeedAll(door, documents);
  EXPECT_EQ(FindFault(door, documents, report), "") << door.name;
}

INSTANTIATE_TEST_SUITE_P(All, EachDoor, testing::Range<std::size_t>(0, Doors().size()), [](const auto& info) {
  std::string name = Doors()[info.param].name;
  for (char& c : name) c = c == ' ' || c == ',' ? '_' : c;
  return name;
});

// the controls: a door of the library's parser alone, and one that never ends
TEST(JsonDoors, OneWithoutLimitsIsNoticed) {
  const Door door{"careless", {}, [](const std::filesystem::path&) -> Feed {
                    return [](const std::string& text) -> std::string {
                      const auto json = nlohmann::json::parse(text, nullptr, false);
                      return json.is_discarded() ? "no JSON"
                                                 : std::to_string(json.dump(2).size()).substr(0, 0);
                    };
                  }};
  const std::vector<HostileDocument> documents = {
      {"good", "{}", true},
      {"deep", std::string(1'000'000, '[') + std::string(1'000'000, ']')},
      {"after", "{}", true}};
  const ChildReport report = FeedAll(door, documents);
  EXPECT_TRUE(report.pieces[0].is_done);
  EXPECT_FALSE(report.pieces[1].is_done);
  EXPECT_THAT(FindFault(door, documents, report), HasSubstr("deep: ended "));
  const std::vector<HostileDocument> twice = {{"twice", R"({"a": 1, "a": 2})"}};
  EXPECT_THAT(FindFault(door, twice, FeedAll(door, twice)), HasSubstr("was taken"));
}

TEST(JsonDoors, OneThatTakesTimeOrMemoryIsNoticed) {
  const auto spin = [](std::size_t) -> std::string {
    for (volatile int i = 0;; i = i + 1) {
    }
  };
  ChildLimits limits;
  limits.seconds = 1;
  EXPECT_THAT(RunInChild(1, spin, limits).death, HasSubstr("ended by Alarm clock"));
  const auto throwing = [](std::size_t) -> std::string { throw std::runtime_error("no"); };
  EXPECT_THAT(RunInChild(1, throwing).death, HasSubstr("threw no"));
}

}  // namespace
}  // namespace trocar::json_doors
