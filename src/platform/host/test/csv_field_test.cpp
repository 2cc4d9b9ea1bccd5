// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/csv_field.h"

#include <gtest/gtest.h>

#include <string>

namespace trocar::host {
namespace {

TEST(FormatCsvField, LeavesPlainTexts) {
  EXPECT_EQ(FormatCsvField(""), "");
  EXPECT_EQ(FormatCsvField("peg_transfer"), "peg_transfer");
  EXPECT_EQ(FormatCsvField("a - b = c"), "a - b = c");
  EXPECT_EQ(FormatCsvField("ves\u00edcula"), "ves\u00edcula");
}

TEST(FormatCsvField, QuotesWhatSeparates) {
  EXPECT_EQ(FormatCsvField("a,b"), "\"a,b\"");
  EXPECT_EQ(FormatCsvField("say \"no\""), "\"say \"\"no\"\"\"");
  EXPECT_EQ(FormatCsvField("a\nb"), "\"a\nb\"");
}

TEST(FormatCsvField, IsNoFormula) {
  for (const char* text : {"=1+1", "+1", "-1", "@SUM(A1)", "\t=1", " =1", "\n=1", "\t"}) {
    const std::string field = FormatCsvField(text);
    EXPECT_TRUE(field.starts_with("'") || field.starts_with("\"'")) << field;
  }
  EXPECT_EQ(FormatCsvField("=HYPERLINK(\"x\")"), "\"'=HYPERLINK(\"\"x\"\")\"");
  EXPECT_EQ(FormatCsvField("\r=1"), "\\x0D=1");
}

TEST(FormatCsvField, ShowsWhatSteersATerminal) {
  EXPECT_EQ(FormatCsvField("\x1b[2J"), "\\x1B[2J");
  EXPECT_EQ(FormatCsvField("\xff"), "\\xFF");
}

}  // namespace
}  // namespace trocar::host
