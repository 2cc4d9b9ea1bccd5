// SPDX-License-Identifier: Apache-2.0
/// \file device_page_run.h  A run of the page of devices that is not attended: when it calibrates, and when its picture is
/// due.
#pragma once

#include <optional>

#include "trocar/presenter/device_bench.h"
#include "trocar/presenter/options.h"

namespace trocar::presenter {

class DevicePageRun {
 public:
  static constexpr double kLongest = 90;  ///< a test must not hang [s]

  enum class Step {
    kGoOn,
    kCalibrate,  ///< once: Calibration() begins
    kSave,       ///< once
    kGiveUp      ///< once: the device has said nothing
  };

  explicit DevicePageRun(const Options& options);

  bool IsOn() const { return is_on_; }
  /// Calibration to be measured; nothing where none was asked for.
  const std::optional<CalibrationStep>& Calibration() const { return calibration_; }
  /// \param elapsed   since the page was opened [s]
  /// \param is_read   the device has been read
  /// \param has_result  of a measurement
  Step Advance(double elapsed, bool is_read, bool has_result);

 private:
  std::optional<CalibrationStep> calibration_;
  double after_;  // [s]
  bool is_on_, is_begun_ = false, is_over_ = false;
};

}  // namespace trocar::presenter
