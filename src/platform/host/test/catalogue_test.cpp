// SPDX-License-Identifier: Apache-2.0
#include "catalogue.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>

#include "trocar/host/safe_file.h"
#include "trocar/host/translate.h"

namespace trocar::host {
namespace {

namespace fs = std::filesystem;

using Entries = std::vector<std::pair<std::string, std::string>>;

/// As msgfmt lays it out: two tables of lengths and offsets, then the texts.
std::string MakeMo(const Entries& entries) {
  const auto count = static_cast<std::uint32_t>(entries.size());
  std::string tables, texts;
  const std::size_t head = 28, start = head + 16 * entries.size();
  const auto add = [](std::string& into, std::size_t number) {
    const auto value = static_cast<std::uint32_t>(number);
    char bytes[4];
    std::memcpy(bytes, &value, sizeof bytes);
    into.append(bytes, sizeof bytes);
  };
  for (const bool is_original : {true, false}) {
    for (const auto& [original, translation] : entries) {
      const std::string& text = is_original ? original : translation;
      add(tables, text.size());
      add(tables, start + texts.size());
      texts += text + '\0';
    }
  }
  std::string bytes;
  for (const std::size_t number : {std::size_t{0x950412de}, std::size_t{0}, std::size_t{count}, head,
                                   head + 8 * entries.size(), std::size_t{0}, std::size_t{0}})
    add(bytes, number);
  return bytes + tables + texts;
}

class Catalogue : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(file_.parent_path()); }
  void TearDown() override { fs::remove_all(file_.parent_path()); }

  std::vector<CataloguePattern> Read(const std::string& bytes) {
    EXPECT_TRUE(WriteFile(file_, bytes).ok());
    return ReadPatterns(file_);
  }

  fs::path file_ = fs::temp_directory_path() / ("trocar-catalogue-" + std::to_string(::getpid())) / "a.mo";
};

const Entries kEntries = {
    {"plain", "llano"},
    {"cannot write {1}: check the folder", "no se puede escribir {1}: compruebe la carpeta"},
    {"cannot write {1}", "no se puede escribir {1}"},
    {"{1}: {2}", "{1}: {2}"},
    {"Hold {button:open} now", "Mantenga {button:open}"}};

TEST_F(Catalogue, HasThePatternsWithTheLongestFirst) {
  const auto patterns = Read(MakeMo(kEntries));
  ASSERT_EQ(patterns.size(), 2u) << "neither plain texts nor those that fit everything";
  EXPECT_EQ(patterns[0].fixed, (std::vector<std::string>{"cannot write ", ": check the folder"}));
  EXPECT_EQ(patterns[1].translation, "no se puede escribir {1}");
}

TEST_F(Catalogue, FindsWhatStoodInThePlaces) {
  const auto patterns = Read(MakeMo(kEntries));
  const auto places = MatchPattern(patterns[0], "cannot write a: b: check the folder");
  ASSERT_TRUE(places.has_value());
  EXPECT_EQ(FillPattern(patterns[0].translation, *places), "no se puede escribir a: b: compruebe la carpeta");
  EXPECT_FALSE(MatchPattern(patterns[0], "cannot write a").has_value());
  EXPECT_FALSE(MatchPattern(patterns[0], "").has_value());
}

TEST_F(Catalogue, RejectsTruncated) {
  const std::string whole = MakeMo(kEntries);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    for (const CataloguePattern& pattern : Read(whole.substr(0, length)))
      EXPECT_EQ(pattern.fixed.size(), pattern.places.size() + 1) << length;
  }
  std::string damaged = whole;
  damaged[8] = damaged[9] = '\x7f';  // more entries than there are
  EXPECT_LE(Read(damaged).size(), damaged.size() / 8);
  EXPECT_TRUE(ReadPatterns(file_.parent_path() / "none.mo").empty());
}

}  // namespace
}  // namespace trocar::host
