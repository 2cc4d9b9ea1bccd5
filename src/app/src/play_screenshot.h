// SPDX-License-Identifier: Apache-2.0
/// \file play_screenshot.h  The end of a run that nobody watches: the window's picture, and a report.
#pragma once

#include <gtkmm.h>

#include "trocar/app/simulator_presenter.h"

namespace trocar::app {

/// Saves the window's picture where the options say, prints the report and closes the window. Never within a frame.
void SavePlayScreenshot(Gtk::Window& window, SimulatorPresenter& presenter);

}  // namespace trocar::app
