// SPDX-License-Identifier: Apache-2.0
/// \file main.cpp  trocar-window: the simulator window as a program of its own.
#include <gtkmm.h>

#include <cstdio>
#include <cstdlib>

#include "composition.h"
#include "contour_window.h"
#include "device_page.h"
#include "look.h"
#include "patient_editor_window.h"
#include "simulator_window.h"
#include "trocar/app/options.h"
#include "trocar/core/partial_path.h"

int main(int argc, char** argv) {
  const trocar::core::Stopwatch since_start;
  const trocar::core::Result<trocar::app::CommandLine> command = trocar::app::ParseCommandLine(argc, argv);
  if (!command) {
    std::fprintf(stderr, "%s\n", command.error().Text().c_str());
    return 2;
  }
  if (command->is_text_only) {
    std::fputs(command->text.c_str(), stdout);
    return EXIT_SUCCESS;
  }
  if (!gtk_init_check()) {
    const trocar::core::Error error{trocar::core::ErrorCode::kNoDisplay,
                                    "no display can be opened: start from a desktop session or set DISPLAY "
                                    "or WAYLAND_DISPLAY; without one, "
                                    "`trocar simulate` runs the same scene headless"};
    std::fprintf(stderr, "%s\n", error.Text().c_str());
    return EXIT_FAILURE;
  }
  trocar::core::RemovePartialPathsOnSignals();
  trocar::app::ChooseComposition();
  const auto application = Gtk::Application::create("", Gio::Application::Flags::NON_UNIQUE);
  std::unique_ptr<trocar::app::SimulatorWindow> simulator;
  std::unique_ptr<trocar::app::ContourWindow> contours;
  std::unique_ptr<trocar::app::PatientEditorWindow> patient_editor;
  std::unique_ptr<trocar::app::DevicePage> devices;
  const auto show = [&](Gtk::ApplicationWindow& window) {
    application->add_window(window);
    window.present();
  };
  application->signal_activate().connect([&] {
    trocar::app::ApplyLook();
    if (!command->options.images.empty()) {
      contours = std::make_unique<trocar::app::ContourWindow>(command->options, since_start);
      show(*contours);
    } else if (command->options.is_device_page) {
      devices = std::make_unique<trocar::app::DevicePage>(command->options, nullptr);
      show(*devices);
    } else if (!command->options.patient.empty()) {
      patient_editor = std::make_unique<trocar::app::PatientEditorWindow>(command->options);
      show(*patient_editor);
    } else {
      simulator = std::make_unique<trocar::app::SimulatorWindow>(command->options, since_start);
      show(*simulator);
    }
  });
  const int status = application->run();
  if (simulator != nullptr) simulator->SaveHapticRecord();
  const auto has_failed = [](const auto& window) {
    return window != nullptr && window->GetFailure().has_value();
  };
  const bool is_good = status == 0 && !has_failed(devices) && !has_failed(simulator) &&
                       !has_failed(contours) && !has_failed(patient_editor);
  devices.reset();
  simulator.reset();
  contours.reset();
  patient_editor.reset();
  return is_good ? EXIT_SUCCESS : EXIT_FAILURE;
}
