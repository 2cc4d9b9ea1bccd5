// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <sstream>

#include "run_trocar.h"
#include "trocar/bench/experiment.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::cli {
namespace {

using testing::HasSubstr;

/// Headings and tables' first lines of a document's generated part, numbers left out.
std::vector<std::string> FindStructure(const std::string& document) {
  const std::size_t begin = document.find(bench::kGeneratedBegin), end = document.find(bench::kGeneratedEnd);
  EXPECT_LT(begin, end);
  std::istringstream lines(document.substr(begin, end - begin));
  std::vector<std::string> structure;
  bool is_table = false;
  for (std::string line; std::getline(lines, line);) {
    const bool starts = line.starts_with("|") && !is_table;
    is_table = line.starts_with("|");
    if (!starts && !line.starts_with("## ")) continue;
    line = std::regex_replace(line, std::regex("[0-9]+"), "#");
    structure.push_back(std::regex_replace(line, std::regex("(\\| # points )+"), "| points "));
  }
  return structure;
}

// docs/replicability.md is generated: every experiment and every column stands there as the program writes it.
// Times differ from machine to machine and are not compared.
TEST(Reproduce, TheCommittedDocumentHasTheStructureThatTheProgramWrites) {
  const test::TemporaryFolder temporary;
  const std::filesystem::path& folder = temporary.Path();
  const auto committed = host::ReadFile(std::string(TROCAR_SOURCE_DIR) + "/docs/replicability.md");
  ASSERT_TRUE(committed);
  const std::string copy = (folder / "copy.md").string();
  ASSERT_TRUE(host::WriteFile(copy, *committed));
  const Printed run =
      RunTrocar({"reproduce", "all", "--quick", "--markdown", copy, "-o", (folder / "pages").string()});
  ASSERT_EQ(run.status, 0) << run.err;
  const auto written = host::ReadFile(copy);
  ASSERT_TRUE(written);
  const auto expected = FindStructure(*written);
  EXPECT_GE(expected.size(), 14u);
  EXPECT_EQ(FindStructure(*committed), expected)
      << "run: trocar reproduce all --markdown docs/replicability.md";
  for (const bench::ExperimentEntry& entry : bench::Experiments()) {
    for (const char* kind : {".html", ".json", ".svg"}) {
      EXPECT_TRUE(std::filesystem::exists(folder / "pages" / (std::string(entry.name) + kind))) << entry.name;
    }
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "pages" / "index.html"));
  for (const char* text : {"98.76", "not readable", "GPU, shared-coalesced"})
    EXPECT_THAT(run.out, HasSubstr(text));
}

TEST(Reproduce, AnUnknownExperimentIsAUsageError) {
  EXPECT_EQ(RunTrocar({"reproduce", "fig10"}).status, 2);
  const Printed missing = RunTrocar({"reproduce", "table1", "--markdown", "x.md"});
  EXPECT_EQ(missing.status, 2) << "only the whole document can be written";
}

}  // namespace
}  // namespace trocar::cli
