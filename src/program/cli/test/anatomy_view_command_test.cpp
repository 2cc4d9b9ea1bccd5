// SPDX-License-Identifier: Apache-2.0
// trocar anatomy view, phantom and edit: what a person types and gets.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "run_trocar.h"
#include "trocar/host/safe_file.h"
#include "trocar/render/image.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::cli {
namespace {

using testing::HasSubstr;

std::size_t CountColour(const render::Image& image, bool (*is_wanted)(int, int, int)) {
  std::size_t count = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const auto [r, g, b] = image.At(x, y);
      count += is_wanted(r, g, b);
    }
  }
  return count;
}

TEST(AnatomyViewCommand, DrawsRegionsInTheirColours) {
  test::TemporaryFolder folder;
  const auto draw = [&](std::vector<std::string> more) {
    const std::string file = (folder.Path() / "view.png").string();
    std::vector<std::string> words = {"anatomy", "view", kBuiltInPatient, "--png", file,
                                      "--width", "300",  "--height",      "240"};
    words.insert(words.end(), more.begin(), more.end());
    const Printed run = RunTrocar(words);
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("Wrote " + file));
    auto image = render::ParsePng(*host::ReadFile(file), file);
    EXPECT_TRUE(image.ok());
    return std::move(image).value();
  };
  const auto is_blue = [](int r, int, int b) { return b > 110 && b > r + 40; };
  const render::Image plain = draw({}), regions = draw({"--regions"});
  EXPECT_EQ(regions.width, 300);
  // the axes' letters are blue, too
  EXPECT_LT(CountColour(plain, is_blue), 400u);
  EXPECT_GT(CountColour(regions, is_blue), 3000u);
  const render::Image all = draw({"--from", "all", "--focus", "gallbladder", "--liver-opacity", "0.2"});
  EXPECT_EQ(all.width, 900);
  EXPECT_EQ(all.height, 480);
}

TEST(AnatomyViewCommand, RefusesWhatItCannotShow) {
  test::TemporaryFolder folder;
  const std::string file = (folder.Path() / "view.png").string();
  const Printed side = RunTrocar({"anatomy", "view", kBuiltInPatient, "--png", file, "--from", "above"});
  EXPECT_EQ(side.status, 2);
  EXPECT_THAT(side.err, HasSubstr("umbilicus or all"));
  const Printed focus = RunTrocar({"anatomy", "view", kBuiltInPatient, "--png", file, "--focus", "spleen"});
  EXPECT_EQ(focus.status, 1);
  EXPECT_THAT(focus.err, HasSubstr("cystic_duct"));
  EXPECT_EQ(RunTrocar({"anatomy", "view", "/nonexistent", "--png", file}).status, 1);
  EXPECT_TRUE(std::filesystem::is_empty(folder.Path()));
}

TEST(AnatomyPhantomCommand, WritesEverythingItNames) {
  test::TemporaryFolder folder;
  const std::string out = (folder.Path() / "phantom").string();
  const Printed run = RunTrocar({"anatomy", "phantom", "--patient", kBuiltInPatient, "-o", out, "--pixel-mm",
                                 "4", "--slice-mm", "8", "--every", "2"});
  EXPECT_EQ(run.status, 0) << run.err;
  for (const char* name :
       {"slices/phantom-0001.png", "labels.nrrd", "control_points.json", "patient/patient.json"})
    EXPECT_TRUE(std::filesystem::exists(out + "/" + name)) << name;
  EXPECT_THAT(run.out, HasSubstr("Next: trocar anatomy build"));
  // never over what is there
  const Printed again = RunTrocar({"anatomy", "phantom", "--patient", kBuiltInPatient, "-o", out});
  EXPECT_EQ(again.status, 1);
  EXPECT_THAT(again.err, HasSubstr("no empty folder"));
  const Printed both =
      RunTrocar({"anatomy", "phantom", "--patient", kBuiltInPatient, "--set", "hydrops=1", "-o", out + "2"});
  EXPECT_EQ(both.status, 2);
  EXPECT_EQ(RunTrocar({"anatomy", "phantom", "--noise", "99", "-o", out + "2"}).status, 2);
  EXPECT_FALSE(std::filesystem::exists(out + "2"));
}

TEST(AnatomyEditCommand, HelpSaysWhereChangesAreKept) {
  const Printed run = RunTrocar({"anatomy", "edit", "--help"});
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.out, HasSubstr("PATIENT.autosave"));
  EXPECT_EQ(RunTrocar({"anatomy", "edit", kBuiltInPatient, "--tool", "saw"}).status, 2);
}

}  // namespace
}  // namespace trocar::cli
