// SPDX-License-Identifier: Apache-2.0
/// \file device_page.h  The widgets of the page of devices; what they show and do is the presenter's.
#pragma once

#include <gtkmm.h>

#include <memory>
#include <optional>

#include "device_cards.h"
#include "device_plot.h"
#include "trocar/gui/tips.h"
#include "trocar/host/clock.h"
#include "trocar/presenter/device_presenter.h"

namespace trocar::app {

class DevicePage : public Gtk::ApplicationWindow, private presenter::DeviceScreen {
 public:
  /// \param control  of the running operation, which a device may hold the hands of; outlives this; or nullptr: devices
  ///                 are only tried and calibrated
  DevicePage(const presenter::Options& options, presenter::SessionControl* control);
  ~DevicePage() override;

  /// Error of a run that is not attended, if any.
  const std::optional<base::Error>& GetFailure() const { return presenter_.GetFailure(); }

 private:
  void MakeContent();
  bool OnTime();

  // DeviceScreen
  void Show(const presenter::DevicePageState& state) override;
  void ShowFound(const std::vector<std::string>& devices) override { found_.ShowFound(devices); }
  void ShowPlot(const std::deque<presenter::DeviceBench::Point>& points,
                const std::deque<presenter::ForcePoint>& forces, device::Channel hand, double now) override {
    plot_.Show(points, forces, hand, now);
  }

  presenter::DevicePresenter presenter_;
  host::Stopwatch since_start_;
  gui::Tips tips_;
  FoundCard found_{presenter_};
  CalibrationCard calibration_{presenter_};
  std::optional<UseCard> use_;  // where an operation runs
  DevicePlot plot_;
  Gtk::Label status_;
  sigc::connection timer_;
};

}  // namespace trocar::app
