// SPDX-License-Identifier: Apache-2.0
/// \file device_bench.h  Trying and calibrating a device from the window: what the device page does, without a widget.
#pragma once

#include <array>
#include <deque>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/device/device_spec.h"
#include "trocar/session/device_thread.h"

namespace trocar::presenter {

/// Measurement of a calibration.
enum class CalibrationStep {
  kTip,     ///< the tip stands still, the handle swings about it
  kTrocar,  ///< the shaft swings in its trocar
  kJaw      ///< jaws closed for the first half, open for the second
};
/// "tip", "trocar", "jaw"
std::string_view StepName(CalibrationStep step) noexcept;
/// Instruction to the person for this measurement.
std::string StepHint(CalibrationStep step, device::Channel hand);

/// One device under test, by the same life cycle as `trocar devices` and the simulation. Called from one thread.
class DeviceBench {
 public:
  static constexpr double kHistory = 10.0;  ///< that is kept for the plot [s]

  /// \param store  file of settings and calibrations
  explicit DeviceBench(std::filesystem::path store);

  /// Opens a device in place of the one before.
  /// \return kUsage, kDeviceSettings or kDeviceUnsupported; what the device itself says comes with Report()
  base::Status Open(const std::string& spec);
  void Close();
  bool IsOpen() const { return thread_ != nullptr; }
  const std::string& Spec() const { return spec_; }

  struct Point {
    double time = 0;  ///< [s]
    std::array<device::HandSample, device::kChannelCount> hands;
  };
  /// Takes what has come in. \param time  [s], not falling
  void Advance(double time);
  const session::DeviceReport& Report() const { return report_; }
  const std::deque<Point>& History() const { return history_; }

  /// Measures from now on for `seconds`.
  /// \return kDeviceState without a device, kUsage for the jaws of a laparoscope
  base::Status Begin(CalibrationStep step, device::Channel hand, double seconds);
  bool IsMeasuring() const { return end_ > begin_; }
  /// Share that is done [-].
  double Progress() const;
  /// Instruction to the person at this moment.
  std::string Hint() const;
  /// Of the last measurement: what came of it with its residual, or why it was refused and nothing changed.
  struct Result {
    bool is_kept = false;
    double residual = 0;  ///< RMS [m]; 0 for jaws
    std::string text;     ///< for a person
  };
  const Result& LastResult() const { return result_; }

  /// Which sensor is the left hand's and which is the right one's, exchanged and kept; the device is opened anew.
  /// \return kUsage where the device is no tracker, kFileUnwritable
  base::Status SwapHands();

 private:
  void Collect(double time);
  void Finish();
  base::Status KeepTracker(bool is_tip);
  base::Status KeepJaw();

  std::filesystem::path store_path_;
  std::string spec_;
  std::unique_ptr<session::DeviceThread> thread_;
  session::DeviceReport report_;
  std::deque<Point> history_;
  double now_ = 0;  // [s]

  CalibrationStep step_ = CalibrationStep::kTip;
  device::Channel hand_ = device::kLeftHand;
  double begin_ = 0, end_ = 0;  // of the measurement [s]; end_ <= begin_: none
  std::vector<math::Pose> poses_;
  std::vector<int> closed_, open_;
  Result result_;
};

}  // namespace trocar::presenter
