// SPDX-License-Identifier: Apache-2.0
/// \file contour_run.h  Runs of the contour window that are not attended: scripts, screenshots, measurements.
#pragma once

#include <gtkmm.h>

#include <deque>
#include <vector>

#include "trocar/editor/contour_canvas.h"
#include "trocar/editor/contour_panel.h"
#include "trocar/editor/contour_presenter.h"
#include "trocar/editor/contour_script.h"
#include "trocar/editor/series_bar.h"
#include "trocar/gui/message_bars.h"
#include "trocar/host/clock.h"

namespace trocar::editor {

/// Drives a window frame by frame as its options say, prints a report and closes it.
class ContourRun {
 public:
  /// Of the window; they outlive the run.
  struct Parts {
    Gtk::Window& window;
    ContourPresenter& presenter;
    ContourCanvas& canvas;
    ContourPanel& panel;
    gui::MessageBars& bars;
    SeriesBar& series_bar;
  };

  ContourRun(const Parts& parts, const host::Stopwatch& since_start);
  ~ContourRun();

  /// Fills in the sizes that the script's first step says.
  /// \return whether it says them, or the run has ended
  bool AnswerSizes();

 private:
  bool OnFrame(double now);
  bool ReadScript();
  void RunScript();
  base::Status DoStep(const ScriptStep& step);
  void MeasureFrame(double now);
  void FinishMeasuring();
  void SaveScreenshot();
  void PrintReport() const;
  void After(unsigned milliseconds, void (ContourRun::*act)());

  Parts at_;
  host::Stopwatch since_start_;
  guint tick_;  // callback of the canvas
  sigc::connection timer_;
  std::deque<ScriptStep> script_;
  bool is_script_read_ = false, is_over_ = false;
  struct Measured {
    std::vector<double> fit, paint, frame;  // [s]
  };
  Measured measured_;
  int screenshot_tries_ = 0;
  double last_frame_ = 0, measure_begin_ = 0;  // of the frame clock [s]
  std::uint64_t last_paints_ = 0;
};

}  // namespace trocar::editor
