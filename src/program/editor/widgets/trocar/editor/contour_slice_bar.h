// SPDX-License-Identifier: Apache-2.0
/// \file contour_slice_bar.h  The slider of slices: which have contours, of which organ, and where one is.
#pragma once

#include <gtkmm.h>

#include "trocar/editor/contour_editor.h"

namespace trocar::editor {

class ContourSliceBar : public Gtk::DrawingArea {
 public:
  ContourSliceBar();
  /// \param editor  outlives the bar's use
  void SetEditor(ContourEditor* editor);
  /// A slice was clicked or dragged to.
  sigc::signal<void(int)>& SignalSlice() { return signal_slice_; }

 private:
  void Draw(const Cairo::RefPtr<Cairo::Context>& cairo, int width, int height);
  void Go(double x);
  double PlaceOf(int slice, int width) const;

  ContourEditor* editor_ = nullptr;
  sigc::signal<void(int)> signal_slice_;
};

}  // namespace trocar::editor
