// SPDX-License-Identifier: Apache-2.0
/// \file force_bar.h  A bar for the force of one instrument, with marks where it becomes a warning and a
/// danger.
#pragma once

#include <gtkmm.h>

#include "trocar/presenter/read_outs.h"

namespace trocar::app {

class ForceBar : public Gtk::DrawingArea {
 public:
  ForceBar();
  void Show(double force, const presenter::ForceThresholds& thresholds);

 private:
  void Draw(const Cairo::RefPtr<Cairo::Context>& cairo, int width, int height) const;

  double force_ = 0;
  presenter::ForceThresholds thresholds_;
};

}  // namespace trocar::app
