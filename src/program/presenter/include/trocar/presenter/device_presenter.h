// SPDX-License-Identifier: Apache-2.0
/// \file device_presenter.h  Presenter of the page of devices, without a widget: finding, trying and calibrating devices,
/// and which device holds the hands.
#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "trocar/presenter/device_bench.h"
#include "trocar/presenter/device_page_run.h"
#include "trocar/presenter/session_control.h"

namespace trocar::presenter {

/// Force of a haptic device at a time.
struct ForcePoint {
  double time = 0, force = 0;  // [s], [N]
};

/// All that the page says, besides list and plot.
struct DevicePageState {
  std::string spec;  ///< of the device to try
  std::string status, hint, result, haptics;
  bool is_status_warning = false;
  double progress = 0;       ///< of the measurement [-]
  bool can_measure = false;  ///< a device is open and nothing is being measured
  bool has_haptics = false, is_force_on = false;
};

/// View interface that the presenter drives; a page implements it.
class DeviceScreen {
 public:
  virtual ~DeviceScreen() = default;
  virtual void Show(const DevicePageState& state) = 0;
  /// A line each, in the order of ChooseFound().
  virtual void ShowFound(const std::vector<std::string>& devices) = 0;
  /// \param points, forces  live as long as the presenter
  /// \param now             right edge of the plot [s]
  virtual void ShowPlot(const std::deque<DeviceBench::Point>& points, const std::deque<ForcePoint>& forces,
                        device::Channel hand, double now) = 0;
};

class DevicePresenter {
 public:
  static constexpr double kMeasureSeconds = 12;    ///< of a calibration
  static constexpr double kUnattendedSeconds = 5;  ///< of a calibration, in a run that is not attended

  /// \param control  of the running operation, which a device may hold the hands of; or null: devices are only tried
  ///                 and calibrated. It and the screen outlive the presenter
  /// \param store    file of settings and calibrations
  DevicePresenter(const Options& options, std::filesystem::path store, SessionControl* control,
                  DeviceScreen& screen);

  /// Looks for devices, and tries the one that the options name.
  void Start();
  void Find();
  void ChooseFound(std::size_t place);
  void SetSpec(const std::string& spec) { state_.spec = spec; }
  void Test();
  /// Closes the device.
  void Stop();

  void ChooseHand(device::Channel hand) { hand_ = hand; }
  void Begin(CalibrationStep step);
  void SwapHands();

  /// The device holds the instruments from now on.
  /// \pre there is a control (TROCAR_ASSERT); the same for UseHaptics, CheckPose and SetForce
  void Use();
  void UseHaptics(const std::string& name);
  void CheckPose();
  /// Asks for force, or takes it away.
  void SetForce(bool is_on);

  /// Takes what has come in. \param now  since the page was opened [s]
  /// \return what a run that is not attended does now; kCalibrate and kGiveUp have been done
  DevicePageRun::Step Advance(double now);
  /// Report printed by a run that is not attended, as JSON.
  std::string MakeReport() const;
  void Fail(const base::Error& error) { failure_ = error; }
  /// Error of a run that is not attended, if any.
  const std::optional<base::Error>& GetFailure() const { return failure_; }

  bool HasControl() const { return control_ != nullptr; }
  const Options& GetOptions() const { return options_; }
  const DevicePageState& State() const { return state_; }

 private:
  void Say(const std::string& text, bool is_warning = false);
  void Say(const base::Status& status, const std::string& success);
  void TakeMeasurement(bool was_measuring);
  void TakeHaptics(double now);

  Options options_;
  std::filesystem::path store_;
  SessionControl* control_;
  DeviceScreen* screen_;
  DeviceBench bench_;
  DevicePageRun run_;
  DevicePageState state_;
  std::vector<device::FoundDevice> found_;
  std::deque<ForcePoint> forces_;
  device::Channel hand_ = device::kLeftHand;
  std::string said_;  // by the device
  std::optional<base::Error> failure_;
};

}  // namespace trocar::presenter
