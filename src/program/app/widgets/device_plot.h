// SPDX-License-Identifier: Apache-2.0
/// \file device_plot.h  The last ten seconds of one hand: pan, tilt, turn, depth, jaw and force, a lane each.
#pragma once

#include <gtkmm.h>

#include <deque>

#include "trocar/presenter/device_presenter.h"

namespace trocar::app {

class DevicePlot : public Gtk::DrawingArea {
 public:
  DevicePlot();
  /// \param points, forces  live as long as the widget is drawn
  /// \param now             right edge [s]
  void Show(const std::deque<presenter::DeviceBench::Point>& points,
            const std::deque<presenter::ForcePoint>& forces, device::Channel hand, double now);

 private:
  void Draw(const Cairo::RefPtr<Cairo::Context>& cairo, int width, int height) const;

  const std::deque<presenter::DeviceBench::Point>* points_ = nullptr;
  const std::deque<presenter::ForcePoint>* forces_ = nullptr;
  device::Channel hand_ = device::kLeftHand;
  double now_ = 0;  // [s]
};

}  // namespace trocar::app
