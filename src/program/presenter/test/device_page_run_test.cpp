// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/device_page_run.h"

#include <gtest/gtest.h>

namespace trocar::presenter {
namespace {

using Step = DevicePageRun::Step;

Options MakeOptions(const char* calibrate = "") {
  Options options;
  options.is_device_page = true;
  options.calibrate = calibrate;
  options.run.screenshot = "devices.png";
  options.run.screenshot_after = 2;
  return options;
}

TEST(DevicePageRun, WaitsForTheDeviceAndSavesOnce) {
  DevicePageRun run(MakeOptions());
  EXPECT_EQ(run.Advance(5, false, false), Step::kGoOn);
  EXPECT_EQ(run.Advance(6, true, false), Step::kSave);
  EXPECT_EQ(run.Advance(7, true, false), Step::kGoOn);
}

TEST(DevicePageRun, CalibratesFirst) {
  DevicePageRun run(MakeOptions("trocar"));
  EXPECT_EQ(run.Calibration(), CalibrationStep::kTrocar);
  EXPECT_EQ(run.Advance(0.1, false, false), Step::kGoOn);
  EXPECT_EQ(run.Advance(0.2, true, false), Step::kCalibrate);
  EXPECT_EQ(run.Advance(5, true, false), Step::kGoOn) << "it has not ended";
  EXPECT_EQ(run.Advance(6, true, true), Step::kSave);
}

TEST(DevicePageRun, GivesUpOnADeviceThatSaysNothing) {
  DevicePageRun run(MakeOptions());
  EXPECT_EQ(run.Advance(DevicePageRun::kLongest + 1, false, false), Step::kGiveUp);
  EXPECT_EQ(run.Advance(DevicePageRun::kLongest + 2, false, false), Step::kGoOn);
}

TEST(DevicePageRun, NeverEndsAPageThatSomebodyAttends) {
  Options options;
  options.is_device_page = true;
  DevicePageRun run(options);
  EXPECT_FALSE(run.IsOn());
  EXPECT_EQ(run.Advance(1e6, true, true), Step::kGoOn);
}

}  // namespace
}  // namespace trocar::presenter
