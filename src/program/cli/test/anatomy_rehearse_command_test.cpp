// SPDX-License-Identifier: Apache-2.0
// A simulated user on a coarse phantom: small enough for every run of the tests.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_trocar.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::cli {
namespace {

namespace fs = std::filesystem;

class RehearseCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    const Printed printed = RunTrocar(
        {"anatomy", "phantom", "--seed", "7", "--pixel-mm", "2", "--slice-mm", "4", "-o", PathOf("phantom")});
    ASSERT_EQ(printed.status, 0) << printed.err;
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static Printed Run(std::vector<std::string> words) {
    words.insert(words.begin(), "anatomy");
    for (const auto& [option, name] : {std::pair{"--images", "slices"},
                                       {"--reference", "labels.nrrd"},
                                       {"--control-points", "control_points.json"}}) {
      words.push_back(option);
      words.push_back(PathOf("phantom" / fs::path(name)));
    }
    return RunTrocar(words);
  }
  static std::string PathOf(const fs::path& name) { return (folder_->Path() / name).string(); }

  static inline test::TemporaryFolder* folder_ = nullptr;
};

TEST_F(RehearseCommand, MeasuresThatTheAdaptionHalvesTheError) {
  const Printed printed = Run({"rehearse", "--organ", "liver", "--every", "2", "--runs", "2", "--json",
                               "--overlays", PathOf("overlays")});
  ASSERT_EQ(printed.status, 0) << printed.err;
  const auto organs = nlohmann::json::parse(printed.out).at("organs");
  ASSERT_EQ(organs.size(), 1u);
  EXPECT_EQ(organs[0].at("name"), "liver");
  ASSERT_EQ(organs[0].at("runs").size(), 2u);
  EXPECT_NE(organs[0]["runs"][0].at("seed"), organs[0]["runs"][1].at("seed"));
  const double placed = organs[0].at("error_placed_mm").at("mean"),
               adapted = organs[0].at("error_adapted_mm").at("mean");
  EXPECT_NEAR(placed, 1.9, 0.3);
  EXPECT_LT(adapted, 0.5 * placed);
  EXPECT_GT(organs[0].at("dice_adapted").at("mean").get<double>(), 0.94);
  EXPECT_FALSE(fs::is_empty(PathOf("overlays")));
}

TEST_F(RehearseCommand, PrintsATableAndRefusesAnOrganThatIsNotThere) {
  const Printed table = Run({"rehearse", "--organ", "liver", "--every", "4", "--runs", "1"});
  EXPECT_EQ(table.status, 0) << table.err;
  EXPECT_NE(table.out.find("Dice placed"), std::string::npos);
  const Printed refused = Run({"rehearse", "--organ", "spleen"});
  EXPECT_NE(refused.status, 0);
  EXPECT_NE(refused.err.find("spleen"), std::string::npos) << refused.err;
}

TEST_F(RehearseCommand, LabelEdgesFindsTrueLabelsOnTheirEdges) {
  const Printed printed = Run({"label-edges", "--every", "2", "--most-slices", "1", "--json"});
  ASSERT_EQ(printed.status, 0) << printed.err;
  const auto edges = nlohmann::json::parse(printed.out);
  for (const auto& organ : edges.at("as_given")) {
    if (organ.at("name") != "liver") continue;
    EXPECT_GT(organ.at("places").get<int>(), 100);
    EXPECT_LT(organ.at("mean_mm").get<double>(), 1.5);
    EXPECT_LT(organ.at("median_mm").get<double>(), 1.0);
  }
  for (const double shift : edges.at("shift_mm")) EXPECT_LT(std::fabs(shift), 1.0);
}

}  // namespace
}  // namespace trocar::cli
