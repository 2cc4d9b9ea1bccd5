// SPDX-License-Identifier: Apache-2.0
/// \file tips.h  Tool-tips that go by themselves.
#pragma once

#include <gtkmm.h>

#include <memory>
#include <string>
#include <vector>

#include "trocar/gui/tip_clock.h"
#include "trocar/host/clock.h"

namespace trocar::gui {

/// Of one window, whose widgets have them as long as it is there.
class Tips {
 public:
  ~Tips();

  /// The widget's tip from now on.
  void Set(Gtk::Widget& widget, const std::string& text);
  /// Takes over all tips of a widget and what is in it.
  void Adopt(Gtk::Widget& root);
  /// Closes what is open until the pointer has left: the person works.
  void End();

 private:
  struct Tip {
    Gtk::Widget* widget;
    std::string text;
    TipClock clock;
    sigc::connection timer;
  };
  bool Query(Tip& tip, const Glib::RefPtr<Gtk::Tooltip>& tooltip);

  host::Stopwatch since_start_;
  std::vector<std::unique_ptr<Tip>> tips_;
};

}  // namespace trocar::gui
