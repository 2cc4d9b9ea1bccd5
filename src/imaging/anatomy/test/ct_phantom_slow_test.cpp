// SPDX-License-Identifier: Apache-2.0
// The figures of growing on CT, on the phantom of the Visible Human's labels, in each contrast phase.
#include <gtest/gtest.h>

#include <filesystem>

#include "trocar/anatomy/ct_phantom.h"
#include "trocar/contours/growth_rehearsal.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;

TEST(GrowingUserSlow, ReachesTheFiguresOnTheVisibleHuman) {
  const fs::path reference = fs::path(TROCAR_SHARED_DIR) / "data/visible-human-male/reference/labels.nii.gz";
  if (!fs::exists(reference)) GTEST_SKIP() << reference.string() << " is not there; the label map is needed";
  auto labels = images::ReadLabelVolume(reference);
  ASSERT_TRUE(labels.ok()) << labels.error().Text();
  labels->names = VisibleHumanLabels();
  for (const auto phase :
       {images::CtPhase::kNone, images::CtPhase::kArterial, images::CtPhase::kPortalVenous}) {
    images::CtSettings settings;
    settings.phase = phase;
    const auto phantom = MakeCtPhantom(*labels, settings);
    ASSERT_TRUE(phantom.ok()) << phantom.error().Text();
    const test::TemporaryFolder folder;
    ASSERT_TRUE(WriteCtPhantom(folder.Path() / "ct", *phantom).ok());
    auto workspace = contours::ContourWorkspace::Open({folder.Path() / "ct" / "slices", {}, {}, {}});
    ASSERT_TRUE(workspace.ok()) << workspace.error().Text();
    const auto trials = contours::RehearseGrowth(*workspace, phantom->labels, {}, 1);
    ASSERT_TRUE(trials.ok()) << trials.error().Text();
    for (const contours::GrowthTrial& trial : *trials) {
      EXPECT_EQ(trial.refusal, "");
      EXPECT_GE(trial.dice_corrected, trial.organ == "liver" ? 0.95 : 0.85)
          << NameOf(phase) << " " << trial.organ;
    }
  }
}

}  // namespace
}  // namespace trocar::anatomy
