// SPDX-License-Identifier: Apache-2.0
/// \file plain_tool_tip.cpp  A window whose button has GTK's own tool-tip: the control of tool_tip_check.
#include <gtkmm.h>

namespace {

class PlainWindow : public Gtk::Window {
 public:
  PlainWindow() {
    set_default_size(1000, 600);
    button_.set_tooltip_text("A tool-tip that stays");
    header_.pack_start(button_);
    set_titlebar(header_);
  }

 private:
  Gtk::HeaderBar header_;
  Gtk::Button button_{"A button"};
};

}  // namespace

int main() {
  return Gtk::Application::create("", Gio::Application::Flags::NON_UNIQUE)
      ->make_window_and_run<PlainWindow>(0, nullptr);
}
