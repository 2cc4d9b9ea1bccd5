// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_trocar.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::cli {
namespace {

std::vector<std::string> KeysOf(const nlohmann::ordered_json& object) {
  std::vector<std::string> keys;
  for (const auto& item : object.items()) keys.push_back(item.key());
  return keys;
}

TEST(AnatomyCheckCommand, IsSilentAboutTheBuiltInPatient) {
  const Printed run = RunTrocar({"anatomy", "check", kBuiltInPatient, "--json"});
  EXPECT_EQ(run.status, 0) << run.err << run.out;
  const auto json = nlohmann::ordered_json::parse(run.out);
  EXPECT_EQ(KeysOf(json), (std::vector<std::string>{"meshes", "findings"}));
  EXPECT_TRUE(json["findings"].empty()) << run.out;
  ASSERT_EQ(json["meshes"].size(), 2u);
  EXPECT_EQ(KeysOf(json["meshes"][0]), (std::vector<std::string>{"name", "triangles", "closed", "manifold",
                                                                 "self_intersections", "volume_ml"}));
  EXPECT_EQ(json["meshes"][0]["name"], "liver");
  EXPECT_EQ(json["meshes"][0]["triangles"], 5132);
  EXPECT_EQ(json["meshes"][0]["closed"], true);
  EXPECT_EQ(json["meshes"][0]["self_intersections"], 0);
  EXPECT_NEAR(json["meshes"][0]["volume_ml"].get<double>(), 1811.484, 0.001);
  const Printed table = RunTrocar({"anatomy", "check", kBuiltInPatient});
  EXPECT_EQ(table.status, 0);
  EXPECT_NE(table.out.find("No findings."), std::string::npos) << table.out;
}

TEST(AnatomyCheckCommand, NamesFindingsOfAFolderThatCannotBeOperatedOn) {
  test::TemporaryFolder folder;
  const auto copy = folder.Path() / "patient";
  std::filesystem::copy(kBuiltInPatient, copy);
  std::string text = *host::ReadFile(copy / "patient.json");
  const std::string from = "\"to\":\"common_bile_duct\"";
  ASSERT_NE(text.find(from), std::string::npos);
  text.replace(text.find(from), from.size(), "\"to\":\"duodenum\"");
  ASSERT_TRUE(host::WriteFile(copy / "patient.json", text).ok());
  const Printed run = RunTrocar({"anatomy", "check", copy.string(), "--json"});
  EXPECT_EQ(run.status, 1);
  const auto json = nlohmann::ordered_json::parse(run.out);
  ASSERT_EQ(json["findings"].size(), 1u) << run.out;
  EXPECT_EQ(KeysOf(json["findings"][0]), (std::vector<std::string>{"code", "where", "text"}));
  EXPECT_EQ(json["findings"][0]["code"], "L-TUBE-END");
  EXPECT_EQ(json["findings"][0]["where"], "cystic_duct/to");
  const Printed table = RunTrocar({"anatomy", "check", copy.string()});
  EXPECT_EQ(table.status, 1);
  EXPECT_NE(table.out.find("L-TUBE-END  cystic_duct/to"), std::string::npos) << table.out;
}

TEST(AnatomyCheckCommand, RefusesBadInputWithItsCode) {
  const Printed missing = RunTrocar({"anatomy", "check", "/nonexistent/patient"});
  EXPECT_EQ(missing.status, 1);
  EXPECT_NE(missing.err.find("E-IO-001"), std::string::npos) << missing.err;
  EXPECT_EQ(missing.out, "");
  const Printed usage = RunTrocar({"anatomy", "check"});
  EXPECT_EQ(usage.status, 2);
  EXPECT_NE(usage.err.find("E-CLI-001"), std::string::npos) << usage.err;
}

TEST(AnatomyCheckCommand, HelpHasAnExample) {
  const Printed run = RunTrocar({"anatomy", "check", "--help"});
  EXPECT_EQ(run.status, 0);
  EXPECT_NE(run.out.find("Example: trocar anatomy check"), std::string::npos);
}

}  // namespace
}  // namespace trocar::cli
