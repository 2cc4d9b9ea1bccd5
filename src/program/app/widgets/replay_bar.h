// SPDX-License-Identifier: Apache-2.0
/// \file replay_bar.h  The bar of a replay: where it stands, what happened when, and where seeking is quick.
#pragma once

#include <gtkmm.h>

#include <vector>

#include "trocar/presenter/replay_presenter.h"

namespace trocar::app {

class ReplayBar : public Gtk::DrawingArea {
 public:
  ReplayBar();

  void SetMarks(const std::vector<presenter::ReplayMark>& marks);
  void Show(const presenter::ReplayPage& page);

  /// A person went there [s].
  sigc::signal<void(double)>& SignalMoved() { return signal_moved_; }

 private:
  void Draw(const Cairo::RefPtr<Cairo::Context>& cairo, int width, int height) const;
  void MoveTo(double x);
  double ColumnOf(double time, int width) const;

  std::vector<presenter::ReplayMark> marks_;
  double begin_ = 0, end_ = 1, time_ = 0, seek_progress_ = 1, known_share_ = 0;
  double pressed_at_ = 0;
  sigc::signal<void(double)> signal_moved_;
};

}  // namespace trocar::app
