// SPDX-License-Identifier: Apache-2.0
/// \file contour_canvas.h  The slice on the screen: draws by the painter, gives the pointer to the editor.
#pragma once

#include <gtkmm.h>

#include <functional>

#include "trocar/editor/contour_editor.h"
#include "trocar/editor/contour_painter.h"

namespace trocar::editor {

class ContourCanvas : public Gtk::DrawingArea {
 public:
  ContourCanvas();

  /// \param editor  outlives the canvas' use; null: nothing is drawn
  void SetEditor(ContourEditor* editor);
  PaintOptions& Options() { return options_; }
  const ContourPainter& Painter() const { return painter_; }

  /// The reference is another one now, or none.
  void ForgetReference() {
    painter_ = {};
    queue_draw();
  }

  /// Space moves the picture instead of drawing while it is held.
  void HoldSpace(bool is_held);
  /// Nothing is drawn or deleted: dragging moves the picture.
  void SetReadOnly(bool is_read_only);

  sigc::signal<void()>& SignalEdited() { return signal_edited_; }    ///< contours or choice may have changed
  sigc::signal<void()>& SignalPointed() { return signal_pointed_; }  ///< the pointer moved
  sigc::signal<void(int)>& SignalStep() { return signal_step_; }     ///< the wheel: so many slices on
  sigc::signal<void()>& SignalWindow() { return signal_window_; }    ///< the grey window was dragged
  sigc::signal<void(base::Error)>& SignalFailed() { return signal_failed_; }

  /// Time of the last drawing, and how many there were [s].
  double LastPaintSeconds() const { return last_paint_; }
  std::uint64_t PaintCount() const { return paints_; }

 private:
  void Draw(const Cairo::RefPtr<Cairo::Context>& cairo, int width, int height);
  void MakeGestures();
  void AddClicks();
  void AddDrags();
  void AddPanning();
  void AddWindowing();
  void AddPointer();
  void AddWheel();
  void BeginPan();
  void Pan(double dx, double dy);
  void EndPan();
  void Release();
  void Zoom(double notches);
  void Step(double notches);
  void UpdateCursor();

  ContourEditor* editor_ = nullptr;
  ContourPainter painter_;
  PaintOptions options_;
  bool is_space_held_ = false, is_read_only_ = false, is_panning_ = false, is_fitted_ = false,
       is_windowing_ = false;
  double pan_x_ = 0, pan_y_ = 0;
  double wheel_ = 0;  // fractions of a step, of smooth wheels
  images::DisplayWindow window_before_;
  double last_paint_ = 0;
  std::uint64_t paints_ = 0;
  std::string last_failure_;
  sigc::signal<void()> signal_edited_, signal_pointed_, signal_window_;
  sigc::signal<void(int)> signal_step_;
  sigc::signal<void(base::Error)> signal_failed_;
};

}  // namespace trocar::editor
