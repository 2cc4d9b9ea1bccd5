// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <regex>
#include <string>

#include "sample_reports.h"
#include "trocar/host/safe_file.h"
#include "trocar/report/trainee_report.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::report {
namespace {

using testing::HasSubstr;

/// What pdftotext reads; empty where it is not installed.
std::string ReadText(const std::string& pdf) {
  trocar::test::TemporaryFolder folder;
  const auto file = folder.Path() / "report.pdf", text = folder.Path() / "report.txt";
  if (!host::WriteFile(file, pdf).ok()) return "";
  const std::string command = "pdftotext -layout '" + file.string() + "' '" + text.string() + "' 2>/dev/null";
  if (std::system(command.c_str()) != 0) return "";
  const auto read = host::ReadFile(text);
  return read.ok() ? *read : "";
}

TEST(Pdf, SaysTheSameAsThePage) {
  const AttemptReport report = test::MakeOperationReport();
  const std::string pdf = FormatPdf(MakeDocument(report));
  // where lines are broken depends on the letters that are installed
  const std::string text = std::regex_replace(ReadText(pdf), std::regex("\\s+"), " ");
  if (text.empty()) GTEST_SKIP() << "pdftotext is not installed: tools/install-packages --test";
  for (const char* words :
       {"Cholecystectomy", "T-7F3K2Q", "24 November 2026, 22:50", "The operation was completed in 4 min.",
        "What to work on", "Lift and grasp, level easy", "The common bile duct was burnt",
        "Dissection of the hepatocystic triangle", "Path length",
        "training feedback, not certified assessment", "page 1 of"})
    EXPECT_THAT(text, HasSubstr(words));
}

TEST(Pdf, NumbersItsPages) {
  const std::string text = ReadText(FormatPdf(MakeDocument(test::MakeOperationReport())));
  if (text.empty()) GTEST_SKIP() << "pdftotext is not installed: tools/install-packages --test";
  std::smatch last;
  ASSERT_TRUE(std::regex_search(text, last, std::regex("page 1 of ([0-9]+)")));
  const int pages = std::stoi(last[1]);
  EXPECT_GE(pages, 3);
  EXPECT_THAT(text, HasSubstr("page " + std::to_string(pages) + " of " + std::to_string(pages)));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\f'), pages);
}

TEST(Pdf, IsTheSameEachTimeAndHasNoDateButItsOwn) {
  Document document = MakeDocument(test::MakeTaskReport());
  const std::string pdf = FormatPdf(document);
  EXPECT_EQ(pdf, FormatPdf(document));
  document.date = "2026-11-25T22:50:20+01:00";
  EXPECT_NE(pdf, FormatPdf(document));
  document.date.clear();
  EXPECT_EQ(FormatPdf(document), FormatPdf(document));
}

TEST(Pdf, LongTablesGoOnWithTheirHeading) {
  TraineeReport trainee;
  trainee.person = "T-1";
  for (int i = 0; i < 120; ++i)
    trainee.attempts.push_back(
        {"2026-11-24T22:50:20+01:00", "Peg transfer", "", "", "completed", true, {}, 80.0, 60, 0, 1});
  const std::string text = ReadText(FormatPdf(MakeDocument(trainee)));
  if (text.empty()) GTEST_SKIP() << "pdftotext is not installed: tools/install-packages --test";
  std::size_t heads = 0;
  for (std::size_t at = text.find("Outcome"); at != std::string::npos; at = text.find("Outcome", at + 1))
    ++heads;
  EXPECT_GE(heads, 3u);
}

}  // namespace
}  // namespace trocar::report
