// SPDX-License-Identifier: Apache-2.0
#include "replay_bar.h"

#include <algorithm>

namespace trocar::app {
namespace {

constexpr int kHeight = 46;     // [pixels]
constexpr double kMargin = 14;  // left and right of the bar [pixels]
constexpr double kTrack = 26;   // its middle, from the top [pixels]
constexpr double kTick = 7;     // half of a mark [pixels]
constexpr double kEventTick = 3;

struct Colour {
  double red, green, blue;
};
Colour ColourOf(presenter::ReplayMark::Kind kind) {
  switch (kind) {
    case presenter::ReplayMark::Kind::kError:
      return {1.00, 0.42, 0.37};
    case presenter::ReplayMark::Kind::kPhase:
      return {0.50, 0.82, 0.87};
    case presenter::ReplayMark::Kind::kRemark:
      return {1.00, 0.76, 0.30};
    case presenter::ReplayMark::Kind::kEvent:
      break;
  }
  return {0.55, 0.60, 0.65};
}

}  // namespace

ReplayBar::ReplayBar() {
  set_hexpand(true);
  set_content_height(kHeight);
  set_draw_func(sigc::mem_fun(*this, &ReplayBar::Draw));
  auto drag = Gtk::GestureDrag::create();
  drag->signal_drag_begin().connect([this](double x, double) {
    pressed_at_ = x;
    MoveTo(x);
  });
  drag->signal_drag_update().connect([this](double dx, double) { MoveTo(pressed_at_ + dx); });
  add_controller(drag);
}

void ReplayBar::MoveTo(double x) {
  const double share = std::clamp((x - kMargin) / std::max(1.0, get_width() - 2 * kMargin), 0.0, 1.0);
  signal_moved_.emit(begin_ + share * (end_ - begin_));
}

void ReplayBar::SetMarks(const std::vector<presenter::ReplayMark>& marks) {
  marks_ = marks;
  queue_draw();
}

void ReplayBar::Show(const presenter::ReplayPage& page) {
  if (begin_ == page.begin && end_ == page.end && time_ == page.time &&
      seek_progress_ == page.seek_progress && known_share_ == page.known_share)
    return;
  begin_ = page.begin, end_ = page.end, time_ = page.time;
  seek_progress_ = page.seek_progress, known_share_ = page.known_share;
  queue_draw();
}

double ReplayBar::ColumnOf(double time, int width) const {
  const double share = end_ > begin_ ? std::clamp((time - begin_) / (end_ - begin_), 0.0, 1.0) : 0.0;
  return kMargin + share * (width - 2 * kMargin);
}

void ReplayBar::Draw(const Cairo::RefPtr<Cairo::Context>& cairo, int width, int) const {
  cairo->set_source_rgb(0.106, 0.122, 0.141);
  cairo->paint();
  const double now = ColumnOf(time_, width);
  cairo->set_line_width(4);
  cairo->set_line_cap(Cairo::Context::LineCap::ROUND);
  const auto line = [&](double from, double to) {
    cairo->move_to(from, kTrack);
    cairo->line_to(to, kTrack);
    cairo->stroke();
  };
  cairo->set_source_rgb(0.20, 0.23, 0.27);
  line(kMargin, width - kMargin);
  cairo->set_source_rgb(0.17, 0.61, 0.69);
  line(kMargin, now);
  // events first: what matters lies over them
  cairo->set_line_cap(Cairo::Context::LineCap::BUTT);
  cairo->set_line_width(2);
  for (const bool is_event : {true, false}) {
    for (const presenter::ReplayMark& mark : marks_) {
      if ((mark.kind == presenter::ReplayMark::Kind::kEvent) != is_event) continue;
      const Colour colour = ColourOf(mark.kind);
      cairo->set_source_rgb(colour.red, colour.green, colour.blue);
      const double column = ColumnOf(mark.time, width), half = is_event ? kEventTick : kTick;
      cairo->move_to(column, kTrack - 12 - half);
      cairo->line_to(column, kTrack - 12 + half);
      cairo->stroke();
    }
  }
  cairo->set_source_rgb(0.93, 0.95, 0.97);
  cairo->arc(now, kTrack, 7, 0, 6.2832);
  cairo->fill();
  if (seek_progress_ < 1) {
    cairo->set_source_rgb(1.00, 0.76, 0.30);
    cairo->set_line_width(3);
    cairo->arc(now, kTrack, 10, -1.5708, -1.5708 + 6.2832 * std::max(0.05, seek_progress_));
    cairo->stroke();
  }
  // how much of it is at hand
  cairo->set_line_width(2);
  cairo->set_source_rgb(0.36, 0.42, 0.48);
  cairo->move_to(kMargin, kTrack + 13);
  cairo->line_to(kMargin + known_share_ * (width - 2 * kMargin), kTrack + 13);
  cairo->stroke();
}

}  // namespace trocar::app
