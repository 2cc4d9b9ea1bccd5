// SPDX-License-Identifier: Apache-2.0
/// \file main.cpp  trocar-window: the simulator's window, the page of devices, or one of the editors, as a program of its
/// own.
#include <gtkmm.h>

#include <cstdio>
#include <cstdlib>
#include <functional>

#include "device_page.h"
#include "replay_window.h"
#include "simulator_window.h"
#include "trocar/app/options.h"
#include "trocar/core/log.h"
#include "trocar/core/partial_path.h"
#include "trocar/editor/contour_window.h"
#include "trocar/editor/patient_editor_window.h"
#include "trocar/gui/composition.h"
#include "trocar/gui/look.h"
#include "trocar/scene/scene.h"

namespace trocar::app {
namespace {

/// The window that the command line asks for. It opens with the application and ends with it.
class Program {
 public:
  explicit Program(const CommandLine& command) : command_(command) {}

  int Run() {
    const auto application = Gtk::Application::create("", Gio::Application::Flags::NON_UNIQUE);
    application->signal_activate().connect([&] {
      ApplyLook();
      Open();
      application->add_window(*window_);
      window_->present();
    });
    const int status = application->run();
    if (finish_) finish_();
    const bool is_good = status == 0 && !(has_failed_ && has_failed_());
    if (taken_over_ != nullptr) taken_over_->SaveHapticRecord();
    taken_over_.reset();
    window_.reset();
    return is_good ? EXIT_SUCCESS : EXIT_FAILURE;
  }

 private:
  static void ApplyLook() {
    if (const auto data = scene::FindDataFolder(); data.ok()) {
      gui::ApplyLook(*data);
    } else {
      core::Log(core::LogLevel::kWarning, data.error().Text());
    }
  }

  void Open() {
    const Options& options = command_.options;
    if (!command_.contours.images.empty()) {
      Use(std::make_unique<editor::ContourWindow>(command_.contours, since_start_));
    } else if (options.is_device_page) {
      Use(std::make_unique<DevicePage>(options, nullptr));
    } else if (!command_.patient_editor.patient.empty()) {
      Use(std::make_unique<editor::PatientEditorWindow>(command_.patient_editor));
    } else if (!options.replay.empty()) {
      Use(std::make_unique<ReplayWindow>(options, [this](Branch branch) { TakeOver(std::move(branch)); }));
    } else {
      auto window = std::make_unique<SimulatorWindow>(options, since_start_);
      finish_ = [simulator = window.get()] { simulator->SaveHapticRecord(); };
      Use(std::move(window));
    }
  }

  /// Somebody goes on from a moment of the replay, in a window beside it.
  void TakeOver(Branch branch) {
    taken_over_ = std::make_unique<SimulatorWindow>(command_.options, since_start_, std::move(branch));
    window_->get_application()->add_window(*taken_over_);
    taken_over_->present();
  }

  template <typename Window>
  void Use(std::unique_ptr<Window> window) {
    has_failed_ = [shown = window.get()] { return shown->GetFailure().has_value(); };
    window_ = std::move(window);
  }

  core::Stopwatch since_start_;
  CommandLine command_;
  std::unique_ptr<Gtk::ApplicationWindow> window_;
  std::unique_ptr<SimulatorWindow> taken_over_;
  std::function<void()> finish_;      // once the window has closed
  std::function<bool()> has_failed_;  // asked after that
};

}  // namespace
}  // namespace trocar::app

int main(int argc, char** argv) {
  using namespace trocar;
  const core::Result<app::CommandLine> command = app::ParseCommandLine(argc, argv);
  if (!command) {
    std::fprintf(stderr, "%s\n", command.error().Text().c_str());
    return 2;
  }
  if (command->is_text_only) {
    std::fputs(command->text.c_str(), stdout);
    return EXIT_SUCCESS;
  }
  app::Program program(*command);
  if (!gtk_init_check()) {
    const core::Error error{core::ErrorCode::kNoDisplay,
                            "no display can be opened: start from a desktop session or set DISPLAY "
                            "or WAYLAND_DISPLAY; without one, "
                            "`trocar simulate` runs the same scene headless"};
    std::fprintf(stderr, "%s\n", error.Text().c_str());
    return EXIT_FAILURE;
  }
  core::RemovePartialPathsOnSignals();
  gui::ChooseComposition();
  return program.Run();
}
