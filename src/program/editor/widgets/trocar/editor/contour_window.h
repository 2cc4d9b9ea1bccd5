// SPDX-License-Identifier: Apache-2.0
/// \file contour_window.h  The contour window: its header bar and keys round a ContourPane.
#pragma once

#include <gtkmm.h>

#include <memory>
#include <optional>

#include "trocar/editor/contour_pane.h"
#include "trocar/gui/command_bar.h"
#include "trocar/host/clock.h"

namespace trocar::editor {

class ContourRun;

class ContourWindow : public Gtk::ApplicationWindow {
 public:
  ContourWindow(const ContourOptions& options, const host::Stopwatch& since_start);
  ~ContourWindow() override;

  /// Error that ended a run that is not attended (--screenshot, --measure), if any.
  const std::optional<base::Error>& GetFailure() { return pane_.Presenter().GetFailure(); }

 private:
  void MakeKeys();
  void Show(const ContourPage& page);
  void DoInWindow(ContourAction action);

  gui::Tips tips_;
  gui::CommandBar<ContourAction, ContourNeeds> bar_;
  std::unique_ptr<ContourRun> run_;  // null where a person watches
  ContourPane pane_;
};

}  // namespace trocar::editor
