// SPDX-License-Identifier: Apache-2.0
/// \file contour_window.h  The contour window's widgets; what they show and do is the presenter's.
#pragma once

#include <gtkmm.h>

#include <array>
#include <memory>
#include <optional>

#include "trocar/core/clock.h"
#include "trocar/core/translate.h"
#include "trocar/editor/contour_canvas.h"
#include "trocar/editor/contour_panel.h"
#include "trocar/editor/contour_presenter.h"
#include "trocar/editor/contour_slice_bar.h"
#include "trocar/editor/series_bar.h"
#include "trocar/gui/command_bar.h"
#include "trocar/gui/file_dialog.h"
#include "trocar/gui/help_card.h"
#include "trocar/gui/message_bars.h"

namespace trocar::editor {

class ContourRun;

class ContourWindow : public Gtk::ApplicationWindow, private ContourScreen {
 public:
  ContourWindow(const ContourOptions& options, const core::Stopwatch& since_start);
  ~ContourWindow() override;

  /// What ended a run that is not attended (--screenshot, --measure), if anything did.
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
  void Ask(gui::Question question) override { bars_.Ask(std::move(question)); }
  void ChooseFile(FileQuestion what, std::function<void(std::filesystem::path)> act) override;
  bool AskSizes(const images::ImageSeriesOptions& series) override;
  void ForgetSurfaces() override { panel_.Presenter().ClearMeshes(); }
  void ShowSurface(int structure, contours::OrganMesh mesh) override {
    panel_.Presenter().SetMesh(structure, std::move(mesh));
  }
  void ShowSurfaceProblem(int structure, const std::string& problem) override {
    panel_.Presenter().SetMeshProblem(structure, problem);
  }
  void ShowSurfaceJob(const contours::MeshJob::State& state) override { panel_.ShowJob(state); }
  void StartTimer(ContourTimer timer, unsigned milliseconds) override;
  void DoInWindow(ContourAction action) override;

  gui::Tips tips_;
  gui::CommandBar<ContourAction, ContourNeeds> bar_;
  Gtk::Overlay overlay_;
  ContourCanvas canvas_;
  ContourSliceBar slices_;
  ContourPanel panel_;
  gui::MessageBars bars_;
  SeriesBar series_bar_;
  gui::HelpCard help_card_{ContourHelp()};
  Gtk::Label hint_, place_, series_text_, state_;
  Gtk::ProgressBar busy_;
  Gtk::Button stop_build_{core::Translate("Stop")};
  gui::FileDialog file_dialog_;
  std::array<sigc::connection, static_cast<std::size_t>(ContourTimer::kCount)> timers_;
  Glib::Dispatcher loaded_, built_, progressed_, surfaces_changed_;
  std::unique_ptr<ContourPresenter> presenter_;
  std::unique_ptr<ContourRun> run_;  // null where a person watches
};

}  // namespace trocar::editor
