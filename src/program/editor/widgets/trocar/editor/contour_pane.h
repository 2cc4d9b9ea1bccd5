// SPDX-License-Identifier: Apache-2.0
/// \file contour_pane.h  Slices, contours and panel as one widget, for the contour window and for others that show slices; what it shows
/// and does is the presenter's.
#pragma once

#include <gtkmm.h>

#include <array>
#include <functional>
#include <memory>
#include <optional>

#include "trocar/editor/contour_canvas.h"
#include "trocar/editor/contour_panel.h"
#include "trocar/editor/contour_presenter.h"
#include "trocar/editor/contour_slice_bar.h"
#include "trocar/editor/series_bar.h"
#include "trocar/gui/file_dialog.h"
#include "trocar/gui/help_card.h"
#include "trocar/gui/message_bars.h"
#include "trocar/gui/tips.h"
#include "trocar/host/translate.h"

namespace trocar::editor {

/// Services that the pane needs of the window that it stands in. All but `do_in_window` may be empty.
struct ContourPaneHost {
  std::function<void(const ContourPage&)> show;     ///< after the pane's own widgets
  std::function<void(ContourAction)> do_in_window;  ///< full screen, and the end
  std::function<bool(const images::ImageSeriesOptions&)>
      answers_sizes;             ///< whether somebody answers; empty: yes
  std::function<void()> opened;  ///< a series and its contours are there
};

class ContourPane : public Gtk::Box, private ContourScreen {
 public:
  ContourPane(const ContourOptions& options, gui::Tips& tips, ContourPaneHost host);
  ~ContourPane() override;

  /// Opens what the options name.
  void Start() { presenter_->Start(); }
  ContourPresenter& Presenter() { return *presenter_; }
  ContourCanvas& Canvas() { return canvas_; }
  ContourPanel& Panel() { return panel_; }
  gui::MessageBars& Bars() { return bars_; }
  SeriesBar& Sizes() { return series_bar_; }

  /// Slices can be looked through, and nothing is drawn: the panel goes.
  void SetReadOnly(bool is_read_only);
  /// Lays a map over the slices, a voxel a pixel, or none.
  void ShowOverlay(std::optional<images::LabelVolume> labels);

  /// \return whether the key was the pane's
  bool OnKey(guint key, Gdk::ModifierType state);
  void OnKeyReleased(guint key);

 private:
  void MakeContent();
  void MakeStatus(Gtk::Box& status);
  void MakeRoutes();

  // ContourScreen
  void Show(const ContourPage& page) override;
  void UseEditor(ContourEditor* editor) override;
  void FocusCanvas() override { canvas_.grab_focus(); }
  void ShowError(const base::Error& error) override { bars_.ShowError(error); }
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
  void DoInWindow(ContourAction action) override { host_.do_in_window(action); }

  gui::Tips& tips_;
  ContourPaneHost host_;
  Gtk::Overlay overlay_;
  ContourCanvas canvas_;
  ContourSliceBar slices_;
  ContourPanel panel_;
  gui::MessageBars bars_;
  SeriesBar series_bar_;
  gui::HelpCard help_card_{ContourHelp()};
  Gtk::Label hint_, place_, series_text_, state_;
  Gtk::ProgressBar busy_;
  Gtk::Button stop_{host::Translate("Stop")};
  gui::FileDialog file_dialog_;
  bool is_read_only_ = false;
  std::array<sigc::connection, static_cast<std::size_t>(ContourTimer::kCount)> timers_;
  sigc::connection told_;  // that a series is there
  Glib::Dispatcher loaded_, built_, progressed_, surfaces_changed_, grown_;
  std::unique_ptr<ContourPresenter> presenter_;
};

}  // namespace trocar::editor
