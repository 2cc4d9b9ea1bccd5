// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "run_trocar.h"
#include "trocar/anatomy/generate_patient.h"
#include "trocar/files/patient_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::cli {
namespace {

using testing::HasSubstr;

TEST(AnatomyCompleteCommand, WritesTheTenMostLikelyAndTheWorstPlausible) {
  test::TemporaryFolder folder;
  const auto patient = folder.Path() / "patient", ten = folder.Path() / "ten",
             worst = folder.Path() / "worst";
  ASSERT_TRUE(files::WritePatient(patient, *anatomy::GeneratePatient(3)).ok());
  const Printed run =
      RunTrocar({"anatomy", "complete", patient.string(), "--ten-likely", "-o", ten.string(), "--json"});
  ASSERT_EQ(run.err, "");
  const auto json = nlohmann::json::parse(run.out);
  ASSERT_EQ(json["variants"].size(), 10u);
  double before = 1.0;
  for (const auto& variant : json["variants"]) {
    EXPECT_LE(variant["probability"].get<double>(), before);
    before = variant["probability"];
    const auto read = files::ReadPatient(variant["output"].get<std::string>());
    ASSERT_TRUE(read.ok()) << read.error().Text();
    EXPECT_DOUBLE_EQ(std::get<double>(read->FindParameter("unseen_variant_probability")->value), before);
  }
  const Printed table = RunTrocar({"anatomy", "complete", patient.string(), "--worst", "-o", worst.string()});
  EXPECT_THAT(table.out, HasSubstr("moynihan_hump"));
  EXPECT_THAT(table.out, HasSubstr("Asghar 2023"));
  EXPECT_THAT(table.out, HasSubstr("people in a hundred are like this one"));
}

TEST(AnatomyCompleteCommand, RefusesWhatTheImagesShowAndTwoWays) {
  test::TemporaryFolder folder;
  const auto patient = folder.Path() / "patient", out = folder.Path() / "out";
  ASSERT_TRUE(files::WritePatient(patient, *anatomy::GeneratePatient(3)).ok());
  const auto with = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {"anatomy", "complete", patient.string(), "-o", out.string()};
    words.insert(words.end(), more.begin(), more.end());
    return RunTrocar(words);
  };
  EXPECT_THAT(with({"--set", "gallbladder_length=80"}).err, HasSubstr("seen in the images"));
  EXPECT_THAT(with({"--set", "gallbladder_lenght=80"}).err, HasSubstr("E-SCN-003"));
  EXPECT_EQ(with({"--worst", "--seed", "3"}).status, 2);
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace trocar::cli
