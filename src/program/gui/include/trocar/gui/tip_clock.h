// SPDX-License-Identifier: Apache-2.0
/// \file tip_clock.h  How long a tool-tip may stay: long enough to be read, and gone as soon as the person works.
#pragma once

namespace trocar::gui {

/// Of one widget. GTK keeps a tip for as long as the pointer rests on the widget, over whatever lies below it.
class TipClock {
 public:
  static constexpr double kLongest = 5;  ///< [s]

  /// The tip is asked for. \return whether it may be seen
  bool Ask(double now) {
    if (begin_ < 0) begin_ = now;
    return !is_over_ && now - begin_ < kLongest;
  }
  /// The person has begun to do something: no tip until the pointer has left. Nothing where none was asked for, so that
  /// a window that becomes active takes no tip from its first visit.
  void End() { is_over_ = begin_ >= 0; }
  /// The pointer has left: the next visit begins anew.
  void Leave() { *this = {}; }

 private:
  double begin_ = -1;  // of the visit [s]; < 0: none
  bool is_over_ = false;
};

}  // namespace trocar::gui
