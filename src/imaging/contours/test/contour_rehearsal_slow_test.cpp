// SPDX-License-Identifier: Apache-2.0
// The simulated user on the Visible Human, and where its reference lies (docs/decisions/0010).
#include "trocar/contours/contour_rehearsal.h"
#include "trocar/contours/label_edges.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace trocar::contours {
namespace {

namespace fs = std::filesystem;

const fs::path kData = fs::path(TROCAR_SHARED_DIR) / "data/visible-human-male";
const fs::path kPoints =
    fs::path(TROCAR_SOURCE_DIR) / "assets/patients/visible-human-male/control_points.json";

class VisibleHumanRehearsalSlow : public testing::Test {
 protected:
  void SetUp() override {
    for (const fs::path& path : {kData / "slices", kData / "reference/labels.nii.gz"}) {
      if (!fs::exists(path)) GTEST_SKIP() << path.string() << " is not there; the photographs are needed";
    }
  }
};

TEST_F(VisibleHumanRehearsalSlow, ReachesItsOverlap) {
  RehearsalOptions options;
  options.control_points = kPoints;
  options.images = kData / "slices";
  options.reference = kData / "reference/labels.nii.gz";
  options.runs = 2;
  const auto organs = RehearseContours(options);
  ASSERT_TRUE(organs.ok()) << organs.error().Text();
  ASSERT_EQ(organs->size(), 2u);
  for (const OrganRehearsal& organ : *organs) {
    for (const RehearsalRun& run : organ.runs) {
      EXPECT_GE(run.dice_adapted, organ.name == "liver" ? 0.93 : 0.80) << organ.name << run.seed;
      EXPECT_NEAR(run.error_placed_mm, 1.85, 0.35) << organ.name << run.seed;
    }
  }
}

// Two estimates that know nothing of each other, the visible edges and the contours drawn by eye, say that the
// reference lies beside the pictures as a whole, and that it is too uneven to show a halved error even then.
TEST_F(VisibleHumanRehearsalSlow, ReferenceLiesBesideThePictures) {
  LabelEdgeOptions options;
  options.control_points = kPoints;
  options.images = kData / "slices";
  options.reference = kData / "reference/labels.nii.gz";
  const auto edges = MeasureLabelEdges(options);
  ASSERT_TRUE(edges.ok()) << edges.error().Text();
  EXPECT_NEAR(edges->shift_mm[1], 3.7, 0.6);
  ASSERT_EQ(edges->as_given.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_GT(edges->as_given[i].mean_mm, 0.95);
    EXPECT_GT(edges->shifted[i].mean_mm, 0.95);
    // the contours that a person drew know nothing of the shift, and gain by it
    EXPECT_LT(edges->shifted[i].drawn_mm, edges->as_given[i].drawn_mm - 0.4);
  }
}

}  // namespace
}  // namespace trocar::contours
