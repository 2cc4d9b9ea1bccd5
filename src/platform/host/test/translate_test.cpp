// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/translate.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace trocar::host {
namespace {

TEST(Translate, LeavesAllAsItIsWithoutACatalogue) {
  UseLanguage({});
  EXPECT_EQ(Translate("a file cannot be read"), "a file cannot be read");
  EXPECT_EQ(Translate(""), "") << "gettext would give the catalogue's head";
  EXPECT_EQ(TranslatedMeaning(base::ErrorCode::kFileUnreadable), "");
}

TEST(Translate, LeavesTextsWithAZeroByteWhole) {
  const std::string text("\0<b>", 4);
  EXPECT_EQ(Translate(text), text);
  EXPECT_EQ(TranslateIn("mouse button", text), text);
  EXPECT_EQ(TranslateComposed(text), text);
}

TEST(Translate, FillsPlacesAndCounts) {
  UseLanguage({});
  EXPECT_EQ(TranslateWith("{1} of {2}", {"3", "4"}), "3 of 4");
  EXPECT_EQ(TranslateWith("hold {help}: {1} {3}", {"a"}), "hold {help}: a {3}") << "what has no value stays";
  EXPECT_EQ(TranslateCount("{1} clip", "{1} clips", 1), "1 clip");
  EXPECT_EQ(TranslateCount("{1} clip", "{1} clips", 3), "3 clips");
  EXPECT_EQ(TranslateIn("jaws", "open"), "open");
  EXPECT_EQ(LocalNumber("9.81 m"), "9.81 m");
  EXPECT_EQ(LocalCount(1234567), "1,234,567");
  EXPECT_EQ(TranslateComposed("Ring 3 to the right"), "Ring 3 to the right");
}

// Without a Spanish locale on the system, as in a container: the catalogue alone counts.
TEST(Translate, SpeaksSpanishWhereItIsAskedFor) {
  const std::filesystem::path folder = FindLocaleFolder();
  if (folder.empty()) GTEST_SKIP() << "this build has no catalogue: no msgfmt";
  for (const char* name : {"LC_ALL", "LC_MESSAGES", "LANG"}) ::unsetenv(name);
  ::setenv("LANGUAGE", "es", 1);
  UseLanguage(folder);
  EXPECT_EQ(Translate("a file cannot be read"), "un archivo no se puede leer");
  EXPECT_EQ(TranslatedMeaning(base::ErrorCode::kFileUnreadable), "un archivo no se puede leer");
  EXPECT_EQ(Translate("no such text"), "no such text");
  EXPECT_EQ(std::to_string(0.5), "0.500000") << "numbers in files keep their point";
}

TEST(Translate, TakesTheLanguageOfALocaleThatIsNotInstalled) {
  const std::filesystem::path folder = FindLocaleFolder();
  if (folder.empty()) GTEST_SKIP() << "this build has no catalogue: no msgfmt";
  for (const char* name : {"LC_ALL", "LC_MESSAGES", "LANGUAGE"}) ::unsetenv(name);
  ::setenv("LANG", "es_MX.UTF-8", 1);
  UseLanguage(folder);
  EXPECT_EQ(Translate("a file cannot be read"), "un archivo no se puede leer");
}

TEST(Translate, SaysNumbersAndComposedTextsInSpanish) {
  const std::filesystem::path folder = FindLocaleFolder();
  if (folder.empty()) GTEST_SKIP() << "this build has no catalogue: no msgfmt";
  ::setenv("LANGUAGE", "es", 1);
  UseLanguage(folder);
  EXPECT_EQ(TranslateCount("{1} clip", "{1} clips", 2), "2 clips");
  EXPECT_EQ(TranslateIn("jaws", "open"), "abiertas");
  EXPECT_EQ(TranslateIn("no such context", "open"), "open") << "without the context's mark";
  EXPECT_EQ(LocalNumber("9.81"), "9,81");
  EXPECT_EQ(LocalCount(1234), "1\u00a0234");
  EXPECT_EQ(TranslateComposed("Ring 3 to the right"), "Anillo 3 a la derecha");
  EXPECT_EQ(
      TranslateComposed("The tips trembled: 0.45 mm between 5 and 20 Hz, scripted experts have 0.1 mm."),
      "Las puntas temblaron: 0,45 mm entre 5 y 20 Hz; los expertos programados tienen 0,1 mm.");
  EXPECT_EQ(TranslateComposed("somebody's own words: {1}"), "somebody's own words: {1}");
}

}  // namespace
}  // namespace trocar::host
