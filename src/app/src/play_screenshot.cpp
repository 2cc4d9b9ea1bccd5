// SPDX-License-Identifier: Apache-2.0
#include "play_screenshot.h"

#include <cstdio>

#include "window_screenshot.h"

namespace trocar::app {

void SavePlayScreenshot(Gtk::Window& window, SimulatorPresenter& presenter) {
  if (const auto status = SaveScreenshot(window, presenter.GetOptions().screenshot); !status)
    return presenter.Fail(status.error());
  std::printf("%s\n",
              FormatPlayReport(presenter.MakeReport(window.get_width(), window.get_height())).c_str());
  window.close();
}

}  // namespace trocar::app
