// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "run_trocar.h"
#include "trocar/cli/run_command.h"
#include "trocar/files/patient_file.h"
#include "trocar/patient/patient.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::cli {
namespace {

namespace fs = std::filesystem;

int RunWords(std::vector<std::string> words) {
  words.insert(words.begin(), "trocar");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  return RunCommand(static_cast<int>(argv.size()), argv.data());
}

class AnatomyCommand : public testing::Test {
 protected:
  test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.Path() / "patient";
};

TEST_F(AnatomyCommand, GenerateWritesAPatientThatListsItsParameters) {
  ASSERT_EQ(RunWords({"anatomy", "generate", "--seed", "11", "--set", "cystic_duct_length=36.5", "--set",
                      "phrygian_cap=no", "-o", folder_.string()}),
            0);
  const auto patient = files::ReadPatient(folder_);
  ASSERT_TRUE(patient.ok()) << patient.error().Text();
  ASSERT_NE(patient->FindParameter("cystic_duct_length"), nullptr);
  EXPECT_EQ(std::get<double>(patient->FindParameter("cystic_duct_length")->value), 36.5);
  EXPECT_EQ(patient->FindParameter("cystic_duct_length")->source, "set by the user");
}

TEST_F(AnatomyCommand, GenerateMakesAndCountsSeveralPatients) {
  const Printed printed =
      RunTrocar({"anatomy", "generate", "--seed", "3", "--count", "2", "-o", folder_.string()});
  EXPECT_EQ(printed.status, 0) << printed.err;
  for (const char* name : {"seed-3", "seed-4"}) EXPECT_TRUE(files::ReadPatient(folder_ / name).ok()) << name;
  EXPECT_NE(printed.out.find("linter: silent for every patient"), std::string::npos) << printed.out;
  EXPECT_NE(printed.out.find("moynihan_hump"), std::string::npos);
  // a summary needs no folder
  EXPECT_EQ(RunTrocar({"anatomy", "generate", "--seed", "3", "--summary"}).status, 0);
  EXPECT_EQ(RunTrocar({"anatomy", "generate", "--count", "0", "--summary"}).status, 2);
}

TEST_F(AnatomyCommand, GenerateRefusesBadSettingsAndWritesNothing) {
  const std::string out = folder_.string();
  EXPECT_EQ(RunWords({"anatomy", "generate"}), 2) << "no folder";
  EXPECT_EQ(RunWords({"anatomy", "generate", "-o", out, "--seed", "minus"}), 2);
  EXPECT_EQ(RunWords({"anatomy", "generate", "-o", out, "--set", "hydrops"}), 2);
  EXPECT_EQ(RunWords({"anatomy", "generate", "-o", out, "--set", "hydrops=7"}), 2);
  EXPECT_EQ(RunWords({"anatomy", "generate", "-o", out, "--set", "no_such_thing=1"}), 1);
  EXPECT_FALSE(fs::exists(folder_));
  EXPECT_EQ(RunWords({"anatomy", "generate", "--list"}), 0);
}

}  // namespace
}  // namespace trocar::cli
