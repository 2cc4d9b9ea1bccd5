// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "run_trocar.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::cli {
namespace {

using testing::HasSubstr;

TEST(AnatomyExportCommand, WritesWhatItSays) {
  test::TemporaryFolder folder;
  const std::string out = (folder.Path() / "glb").string();
  const Printed run = RunTrocar({"anatomy", "export", kBuiltInPatient, "--format", "gltf", "-o", out});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.out, "Wrote " + out + "/patient.glb\n");
  EXPECT_TRUE(std::filesystem::exists(out + "/patient.glb"));
}

TEST(AnatomyExportCommand, RefusesBadInputWithItsCodeAndWritesNothing) {
  test::TemporaryFolder folder;
  const std::string out = (folder.Path() / "out").string();
  const auto run = [&](const std::string& patient, const std::string& format,
                       std::vector<std::string> more = {}) {
    std::vector<std::string> words = {"anatomy", "export", patient, "--format", format, "-o", out};
    words.insert(words.end(), more.begin(), more.end());
    return RunTrocar(words);
  };
  const Printed format = run(kBuiltInPatient, "dae");
  EXPECT_EQ(format.status, 2);
  EXPECT_THAT(format.err, HasSubstr("E-CLI-001"));
  EXPECT_THAT(format.err, HasSubstr("obj, ply, stl, gltf, vtk"));
  EXPECT_EQ(run(kBuiltInPatient, "ply", {"--ascii"}).status, 2);
  const Printed missing = run("/nonexistent", "obj");
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.err, HasSubstr("E-IO-001"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.Path()));
}

TEST(AnatomyExportCommand, HelpHasAnExample) {
  const Printed run = RunTrocar({"anatomy", "export", "--help"});
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.out, HasSubstr("Example: trocar anatomy export"));
}

}  // namespace
}  // namespace trocar::cli
