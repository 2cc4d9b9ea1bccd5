// SPDX-License-Identifier: Apache-2.0
#include "trocar/core/translate.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace trocar::core {
namespace {

TEST(Translate, LeavesAllAsItIsWithoutACatalogue) {
  UseLanguage({});
  EXPECT_EQ(Translate("a file cannot be read"), "a file cannot be read");
  EXPECT_EQ(Translate(""), "") << "gettext would give the catalogue's head";
  EXPECT_EQ(TranslatedMeaning(ErrorCode::kFileUnreadable), "");
}

// Without a Spanish locale on the system, as in a container: the catalogue alone counts.
TEST(Translate, SpeaksSpanishWhereItIsAskedFor) {
  const std::filesystem::path folder = FindLocaleFolder();
  if (folder.empty()) GTEST_SKIP() << "this build has no catalogue: no msgfmt";
  for (const char* name : {"LC_ALL", "LC_MESSAGES", "LANG"}) ::unsetenv(name);
  ::setenv("LANGUAGE", "es", 1);
  UseLanguage(folder);
  EXPECT_EQ(Translate("a file cannot be read"), "un archivo no se puede leer");
  EXPECT_EQ(TranslatedMeaning(ErrorCode::kFileUnreadable), "un archivo no se puede leer");
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

}  // namespace
}  // namespace trocar::core
