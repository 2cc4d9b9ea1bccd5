// SPDX-License-Identifier: Apache-2.0
/// \file play_screenshot.h  The end of a run that is not attended: the window's picture, and a report.
#pragma once

#include <gtkmm.h>

#include "trocar/presenter/device_presenter.h"
#include "trocar/presenter/simulator_presenter.h"

namespace trocar::app {

/// Saves the window's picture where the options say, prints the report and closes the window. Never within a frame.
void SavePlayScreenshot(Gtk::Window& window, presenter::SimulatorPresenter& presenter);
/// As SavePlayScreenshot, for the page of devices, as soon as it has something to show.
/// \param tries  so far
void EndDeviceRun(Gtk::Window& window, presenter::DevicePresenter& presenter, int tries = 0);

}  // namespace trocar::app
