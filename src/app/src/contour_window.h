// SPDX-License-Identifier: Apache-2.0
/// \file contour_window.h  The contour window's widgets; what they show and do is the presenter's.
#pragma once

#include <gtkmm.h>

#include <array>
#include <memory>
#include <optional>

#include "command_bar.h"
#include "contour_canvas.h"
#include "contour_panel.h"
#include "contour_slice_bar.h"
#include "help_card.h"
#include "message_bars.h"
#include "series_bar.h"
#include "trocar/app/contour_presenter.h"
#include "trocar/core/clock.h"

namespace trocar::app {

class ContourRun;

class ContourWindow : public Gtk::ApplicationWindow, private ContourScreen {
 public:
  ContourWindow(const Options& options, const core::Stopwatch& since_start);
  ~ContourWindow() override;

  /// What ended a run that nobody watches (--screenshot, --measure), if anything did.
  const std::optional<core::Error>& GetFailure() const { return presenter_->GetFailure(); }

 private:
  void MakeContent();
  void MakeStatus(Gtk::Box& status);
  void MakeKeys();
  void MakeRoutes();
  bool OnKey(guint key, Gdk::ModifierType state);

  // ContourScreen
  void Show(const ContourPage& page) override;
  void UseEditor(ContourEditor* editor) override;
  void FocusCanvas() override { canvas_.grab_focus(); }
  void ShowError(const core::Error& error) override { bars_.ShowError(error); }
  void ShowNotice(const std::string& text) override { bars_.ShowNotice(text); }
  void Ask(Question question) override { bars_.Ask(std::move(question)); }
  void ChooseFile(FileQuestion what, std::function<void(std::filesystem::path)> act) override;
  bool AskSizes(const images::ImageSeriesOptions& series) override;
  void ForgetSurfaces() override { panel_.ClearMeshes(); }
  void ShowSurface(int structure, contours::OrganMesh mesh) override {
    panel_.SetMesh(structure, std::move(mesh));
  }
  void ShowSurfaceProblem(int structure, const std::string& problem) override {
    panel_.SetMeshProblem(structure, problem);
  }
  void ShowSurfaceJob(const contours::MeshJob::State& state) override { panel_.ShowJob(state); }
  void StartTimer(ContourTimer timer, unsigned milliseconds) override;
  void DoInWindow(ContourAction action) override;

  Tips tips_;
  CommandBar<ContourAction, ContourNeeds> bar_;
  Gtk::Overlay overlay_;
  ContourCanvas canvas_;
  ContourSliceBar slices_;
  ContourPanel panel_;
  MessageBars bars_;
  SeriesBar series_bar_;
  HelpCard help_card_{ContourHelp()};
  Gtk::Label hint_, place_, series_text_, state_;
  Gtk::ProgressBar busy_;
  Gtk::Button stop_build_{"Stop"};
  Glib::RefPtr<Gtk::FileChooserNative> chooser_;
  std::array<sigc::connection, static_cast<std::size_t>(ContourTimer::kCount)> timers_;
  Glib::Dispatcher loaded_, built_, progressed_, surfaces_changed_;
  std::unique_ptr<ContourPresenter> presenter_;
  std::unique_ptr<ContourRun> run_;  // null where a person watches
};

}  // namespace trocar::app
