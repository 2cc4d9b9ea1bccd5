// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/console.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "trocar/host/text_table.h"
#include "trocar/host/translate.h"

namespace trocar::host {
namespace {

class Console : public testing::Test {
 protected:
  /// \return false where this build has no catalogue
  static bool SpeakSpanish() {
    const std::filesystem::path folder = FindLocaleFolder();
    if (folder.empty()) return false;
    ::setenv("LANGUAGE", "es", 1);
    ::setenv("LC_ALL", "C.UTF-8", 1);
    UseLanguage(folder);
    return true;
  }
  void TearDown() override {
    ::setenv("LANGUAGE", "en", 1);
    UseLanguage(FindLocaleFolder());
  }
};

TEST_F(Console, SaysEnglishAsItStands) {
  UseLanguage({});
  testing::internal::CaptureStdout();
  Say("\n  {1} of {2} runs are done; {3} failed\n", std::size_t{3}, 4, std::string("none"));
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "\n  3 of 4 runs are done; none failed\n");
  EXPECT_EQ(SaidText("\n", {}), "\n");
  EXPECT_EQ(SaidText("", {}), "");
  EXPECT_EQ(ShownNumber(9.8125, 3), "9.81");
  EXPECT_EQ(ShownFixed(1.25, 1, true), "+1.2");
  EXPECT_EQ(ShownNumber(std::nan("")), "not a number");
}

TEST_F(Console, SaysSpanishWithItsDecimalMark) {
  if (!SpeakSpanish()) GTEST_SKIP() << "this build has no catalogue: no msgfmt";
  // the lines round a pattern are no part of what is looked up
  EXPECT_EQ(SaidText("\nWrote {1}\n", {"a.html"}), "\nEscrito: a.html\n");
  EXPECT_EQ(ShownNumber(9.8125, 3), "9,81");
  EXPECT_EQ(ShownFixed(-0.5, 2), "-0,50");
  EXPECT_EQ(ShownNumber(std::nan("")), "no es un número");
}

TEST_F(Console, TranslatesHeadingsAndKeepsNumbersAtTheRight) {
  if (!SpeakSpanish()) GTEST_SKIP() << "this build has no catalogue: no msgfmt";
  EXPECT_EQ(FormatShownTable({{"organ", "volume [mL]"}, {"hook", "1.5"}, {"x", "120,25"}}),
            "órgano  volumen [mL]\n"
            "hook             1,5\n"
            "x             120,25\n");
  EXPECT_EQ(FormatFields({{"state", "hook"}, {"seed", "7"}}), "estado   hook\nsemilla     7\n");
}

TEST_F(Console, WrapsAtColumnsNotAtBytes) {
  EXPECT_EQ(WrapText("visión crítica de seguridad", 17, "  "), "  visión crítica\n  de seguridad\n");
  EXPECT_EQ(WrapText("", 10, ""), "");
  EXPECT_EQ(WrapText("a\nVERIFIED: b", 40, ""), "a\\x0AVERIFIED: b\n") << "no line of a text's own";
}

TEST_F(Console, KeepsATextWithinItsLine) {
  const std::string hostile = "a\nVERIFIED\x1b[2J";
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Print(hostile);
  PrintLine(hostile);
  PrintLine();
  PrintErrorLine(hostile);
  PrintLines("two\nlines\n");
  const std::string shown = "a\\x0AVERIFIED\\x1B[2J";
  EXPECT_EQ(testing::internal::GetCapturedStdout(), shown + shown + "\n\ntwo\nlines\n");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), shown + "\n");
}

}  // namespace
}  // namespace trocar::host
