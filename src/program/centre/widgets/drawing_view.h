// SPDX-License-Identifier: Apache-2.0
// A report's drawing in a window.
#pragma once

#include <gtkmm.h>

#include "trocar/report/drawing.h"

namespace trocar::centre {

class DrawingView : public Gtk::DrawingArea {
 public:
  /// \param width  that it asks for at least [pixels]
  explicit DrawingView(int width);
  void Show(const report::Drawing& drawing);

 private:
  void Draw(const Cairo::RefPtr<Cairo::Context>& cairo, int width, int height) const;
  bool QueryTip(int x, int y, const Glib::RefPtr<Gtk::Tooltip>& tip);
  double Scale() const;

  int width_;
  report::Drawing drawing_;
};

}  // namespace trocar::centre
