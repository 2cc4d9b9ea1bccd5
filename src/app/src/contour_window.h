// SPDX-License-Identifier: Apache-2.0
/// \file contour_window.h  The contour window: canvas, slices, panel, files and background work put together.
#pragma once

#include <gtkmm.h>

#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

#include "contour_canvas.h"
#include "contour_panel.h"
#include "contour_slice_bar.h"
#include "help_card.h"
#include "message_bars.h"
#include "series_bar.h"
#include "trocar/anatomy/build_patient.h"
#include "trocar/app/contour_script.h"
#include "trocar/app/options.h"
#include "trocar/contours/contour_autosave.h"
#include "trocar/core/clock.h"
#include "trocar/core/file_lock.h"

namespace trocar::app {

class ContourWindow : public Gtk::ApplicationWindow {
 public:
  ContourWindow(const Options& options, const core::Stopwatch& since_start);
  ~ContourWindow() override;

  /// What ended a run that nobody watches (--screenshot, --measure), if anything did.
  const std::optional<core::Error>& GetFailure() const { return failure_; }

 private:
  void MakeHeader();
  void MakeContent();
  void MakeKeys();
  void MakeRoutes();

  // opening
  void StartLoading(contours::WorkspaceOptions options);
  void FinishLoading();
  bool AskForSizes();
  bool TakeLock();
  void OfferRecovered();
  void StartAutosave();

  // editing
  void OnAction(ContourAction action);
  void OnEdited();
  void GoToSlice(int slice);
  void ShowAll();
  void ShowPointer();
  void RequestMeshes(bool is_all);
  void TakeMeshes();
  void PrefetchNeighbours();
  void Tell(const std::string& text, bool is_warning = false);
  void Report(const core::Error& error);

  // files
  void ChooseAndOpen();
  bool Save();
  void ChooseAndSave(std::function<void()> then);
  void ChooseAndBuild();
  void StartBuild(const std::filesystem::path& folder);
  void StopBuild();
  void FinishBuild();
  bool OnClose();
  std::filesystem::path AutosaveFile() const;

  // runs that nobody watches
  bool ReadScript();
  void RunScript();
  core::Status RunWindowStep(const ScriptStep& step);
  bool OnFrame(const Glib::RefPtr<Gdk::FrameClock>& clock);
  void MeasureFrame(double now);
  void FinishMeasuring();
  void SaveScreenshot();
  void Abandon(const core::Error& error);

  Options options_;
  core::Stopwatch since_start_;
  std::optional<core::Error> failure_;

  Gtk::HeaderBar header_;
  Gtk::Button open_{"Open"}, save_{"Save"}, undo_{"Undo"}, redo_{"Redo"}, fit_{"Fit"},
      build_{"Build patient"};
  Gtk::ToggleButton points_mode_{"Points"}, scissors_mode_{"Scissors"}, reference_{"Reference"},
      ghosts_{"Neighbours"}, help_{"Help"};
  Gtk::Overlay overlay_;
  ContourCanvas canvas_;
  ContourSliceBar slices_;
  ContourPanel panel_;
  MessageBars bars_;
  SeriesBar series_bar_;
  bool has_asked_sizes_ = false;
  HelpCard help_card_;
  Gtk::Label hint_, place_, series_text_, state_;
  Gtk::ProgressBar busy_;
  Gtk::Button stop_build_{"Stop"};
  bool is_showing_ = false;  // buttons are being set by us

  // order matters: what computes goes before what it computes on
  std::unique_ptr<contours::ContourWorkspace> workspace_;
  std::unique_ptr<ContourEditor> editor_;
  std::optional<core::FileLock> lock_;  // of the side file, which belongs to one window
  std::unique_ptr<contours::ContourAutosave> autosave_;
  std::unique_ptr<contours::SlicePrefetcher> prefetcher_;
  std::unique_ptr<contours::MeshJob> meshes_;
  Glib::Dispatcher mesh_changed_;
  std::uint64_t shown_revision_ = 0;
  std::vector<contours::Structure> meshed_;  // what the last requests were made from
  sigc::connection coarse_timer_, autosave_timer_;

  std::thread loader_, builder_;
  Glib::Dispatcher loaded_, built_, progressed_;
  contours::WorkspaceOptions loading_options_;
  std::optional<core::Result<contours::ContourWorkspace>> loading_;
  std::optional<core::Result<anatomy::BuildReport>> building_;
  std::stop_source build_stop_;
  std::filesystem::path build_folder_;
  std::mutex progress_mutex_;  // guards the next two
  std::string progress_what_;
  double progress_fraction_ = 0;
  Glib::RefPtr<Gtk::FileChooserNative> chooser_;
  bool is_closing_ = false;

  std::deque<ScriptStep> script_;
  bool is_script_read_ = false, is_screenshot_due_ = false;
  struct Measured {
    std::vector<double> fit, paint, frame;  // [s]
  };
  Measured measured_;
  int screenshot_tries_ = 0;
  double last_frame_ = 0, measure_begin_ = 0;
  std::uint64_t last_paints_ = 0;
};

}  // namespace trocar::app
