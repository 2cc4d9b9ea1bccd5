// SPDX-License-Identifier: Apache-2.0
/// \file device_page.h  The page for devices: what is found, a live plot, calibration, and which device holds the hands.
#pragma once

#include <gtkmm.h>

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "device_plot.h"
#include "trocar/app/device_bench.h"
#include "trocar/app/options.h"
#include "trocar/app/session_control.h"
#include "trocar/core/clock.h"

namespace trocar::app {

class DevicePage : public Gtk::ApplicationWindow {
 public:
  /// \param control  of the running operation, which a device may hold the hands of; outlives this; or nullptr: devices
  ///                 are only tried and calibrated
  DevicePage(const Options& options, SessionControl* control);

  /// What went wrong in a run that nobody watches.
  const std::optional<core::Error>& GetFailure() const { return failure_; }

 private:
  void MakeContent();
  Gtk::Widget& MakeFound();
  Gtk::Widget& MakeCalibration();
  Gtk::Widget& MakeUse();
  void FindDevices();
  void Test();
  void Begin(CalibrationStep step);
  void Use();
  void UseHaptics();
  bool OnTime();
  void ShowHaptics(double now);
  void RunUnattended(double now);
  void EndUnattended();
  void Say(const std::string& text, bool is_warning = false);
  device::Channel GetHand() const { return static_cast<device::Channel>(hand_.get_selected()); }

  Options options_;
  SessionControl* control_;
  DeviceBench bench_;
  core::Stopwatch since_start_;
  std::deque<ForcePoint> forces_;
  std::vector<device::FoundDevice> devices_;
  std::optional<core::Error> failure_;
  std::string said_;  // of the device
  bool has_begun_ = false, has_ended_ = false, is_showing_ = false;
  int screenshot_tries_ = 0;

  Gtk::ListBox found_;
  Gtk::Entry spec_;
  Gtk::Button find_{"Look again"}, test_{"Test"}, stop_{"Stop"};
  Gtk::DropDown hand_;
  Gtk::Button tip_{"Tip"}, trocar_{"Trocar"}, jaw_{"Jaw"}, swap_{"Swap hands"};
  Gtk::ProgressBar progress_;
  Gtk::Label hint_, result_, status_;
  Gtk::Button use_{"Hold the instruments"};
  Gtk::Entry haptic_name_;
  Gtk::Button use_haptics_{"Use"}, check_pose_{"Check pose"};
  Gtk::ToggleButton force_{"Force"};
  Gtk::Label haptics_;
  DevicePlot plot_;
  sigc::connection timer_;
};

}  // namespace trocar::app
