// SPDX-License-Identifier: Apache-2.0
#include "play_screenshot.h"

#include <cstdio>

#include "trocar/gui/window_screenshot.h"
#include "trocar/host/log.h"

namespace trocar::app {
namespace {

constexpr int kMostTries = 50;
constexpr unsigned kRetry = 100;  // [ms]

}  // namespace

void SavePlayScreenshot(Gtk::Window& window, presenter::SimulatorPresenter& presenter) {
  if (const auto status = gui::SaveScreenshot(window, presenter.GetOptions().run.screenshot); !status)
    return presenter.Fail(status.error());
  std::printf(
      "%s\n",
      presenter::FormatPlayReport(presenter.MakeReport(window.get_width(), window.get_height())).c_str());
  window.close();
}

void EndDeviceRun(Gtk::Window& window, presenter::DevicePresenter& presenter, int tries) {
  const base::Status saved = gui::SaveScreenshot(window, presenter.GetOptions().run.screenshot);
  // a window that is being laid out anew has nothing to show for a moment
  if (!saved && tries < kMostTries) {
    Glib::signal_timeout().connect_once(
        [&window, &presenter, tries] { EndDeviceRun(window, presenter, tries + 1); }, kRetry);
    return;
  }
  if (!saved) presenter.Fail(saved.error());
  if (presenter.GetFailure()) host::Log(host::LogLevel::kError, presenter.GetFailure()->Text());
  std::printf("%s\n", presenter.MakeReport().c_str());
  Glib::signal_timeout().connect_once([&window] { window.close(); }, 0);
}

}  // namespace trocar::app
