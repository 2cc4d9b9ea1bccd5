// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/device_page_run.h"

namespace trocar::presenter {

DevicePageRun::DevicePageRun(const Options& options)
    : after_(options.run.screenshot_after), is_on_(options.is_device_page && !options.run.IsAttended()) {
  for (const CalibrationStep step :
       {CalibrationStep::kTip, CalibrationStep::kTrocar, CalibrationStep::kJaw}) {
    if (StepName(step) == options.calibrate) calibration_ = step;
  }
}

DevicePageRun::Step DevicePageRun::Advance(double elapsed, bool is_read, bool has_result) {
  if (!is_on_ || is_over_) return Step::kGoOn;
  if (elapsed > kLongest) {
    is_over_ = true;
    return Step::kGiveUp;
  }
  if (!is_read) return Step::kGoOn;
  if (calibration_ && !is_begun_) {
    is_begun_ = true;
    return Step::kCalibrate;
  }
  is_over_ = elapsed > after_ && (!calibration_ || has_result);
  return is_over_ ? Step::kSave : Step::kGoOn;
}

}  // namespace trocar::presenter
