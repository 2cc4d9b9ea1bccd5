// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/program.h"

#include <gtest/gtest.h>

#include "trocar/host/safe_file.h"

namespace trocar::host {
namespace {

TEST(Program, KnowsItselfAndWhatLiesBesideIt) {
  EXPECT_EQ(FindProgram().filename(), "host_tests");
  EXPECT_EQ(FindProgram().parent_path(), FindProgramFolder());
  EXPECT_EQ(FindCompanionProgram("trocar-nobody"), FindProgramFolder() / "trocar-nobody");
}

TEST(Program, TakesTheInstalledCompanionFirst) {
  const std::filesystem::path installed =
      FindProgramFolder().parent_path() / "libexec/trocar/trocar-program-test";
  ASSERT_TRUE(WriteFile(installed, "").ok());
  EXPECT_EQ(FindCompanionProgram("trocar-program-test"), installed);
  std::filesystem::remove(installed);
  // only what this test made
  std::error_code not_empty;
  std::filesystem::remove(installed.parent_path(), not_empty);
  std::filesystem::remove(installed.parent_path().parent_path(), not_empty);
  EXPECT_EQ(FindCompanionProgram("trocar-program-test"), FindProgramFolder() / "trocar-program-test");
}

}  // namespace
}  // namespace trocar::host
