// SPDX-License-Identifier: Apache-2.0
/// \file layout_control.cpp  A window in which a text is cut off, one ends in an ellipsis, and a button lies off the screen, and one
/// in which nothing is amiss: whether the walk over the widgets tells them apart.
#include <gtkmm.h>

#include <cstdio>
#include <string>

#include "trocar/gui/columns.h"
#include "trocar/gui/fold_row.h"
#include "trocar/gui/layout_walk.h"

namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr const char* kLong =
    "A text that is far longer than the place that it was given in this little window";

int Count(Gtk::Window& window, const char* what) {
  int count = 0;
  for (const trocar::gui::Misfit& one : trocar::gui::FindMisfits(window, kWidth, kHeight))
    count += one.what == what ? 1 : 0;
  return count;
}

class Bad : public Gtk::Window {
 public:
  Bad() {
    set_default_size(kWidth, kHeight);
    auto* ellipsis = Gtk::make_managed<Gtk::Label>(kLong);
    ellipsis->set_ellipsize(Pango::EllipsizeMode::END);
    auto* fixed = Gtk::make_managed<Gtk::Fixed>();
    fixed->set_overflow(Gtk::Overflow::HIDDEN);
    auto* off = Gtk::make_managed<Gtk::Button>("off");
    fixed->put(*off, kWidth - 20, 10);
    // the button is cut at the window's edge, and nothing scrolls
    auto* overlay = Gtk::make_managed<Gtk::Overlay>();
    overlay->set_size_request(100, 60);
    overlay->add_overlay(*fixed);
    auto* all = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
    all->append(*ellipsis);
    all->append(*overlay);
    set_child(*all);
  }
};

class Good : public Gtk::Window {
 public:
  Good() {
    set_default_size(kWidth, kHeight);
    auto* wrapped = Gtk::make_managed<Gtk::Label>(kLong);
    wrapped->set_wrap(true);
    auto* row = Gtk::make_managed<trocar::gui::FoldRow>();
    for (int i = 0; i < 9; ++i) {
      buttons_[i] = Gtk::make_managed<Gtk::Button>("button " + std::to_string(i));
      row->Append(*buttons_[i], i);
    }
    row_ = row;
    auto* columns = Gtk::make_managed<trocar::gui::Columns>(10);
    for (int i = 0; i < 3; ++i) {
      auto* box = Gtk::make_managed<Gtk::Label>("column");
      box->set_size_request(200, 20);
      columns->Append(*box);
      columns_[i] = box;
    }
    auto* scroller = Gtk::make_managed<Gtk::ScrolledWindow>();
    scroller->set_vexpand(true);
    auto* tall = Gtk::make_managed<Gtk::Label>("tall");
    tall->set_size_request(900, 900);
    scroller->set_child(*tall);
    auto* all = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
    all->append(*row);
    all->append(*wrapped);
    all->append(*columns);
    all->append(*scroller);
    set_child(*all);
  }
  bool Folds() const { return row_->IsFolded(*buttons_[8]) && !row_->IsFolded(*buttons_[0]); }
  bool Stacks() const {
    double x = 0, y = 0;
    return columns_[2]->translate_coordinates(*columns_[0], 0, 0, x, y) && y > 0;
  }

 private:
  trocar::gui::FoldRow* row_ = nullptr;
  Gtk::Button* buttons_[9] = {};
  Gtk::Label* columns_[3] = {};
};

}  // namespace

int main(int argc, char** argv) {
  const auto application = Gtk::Application::create("", Gio::Application::Flags::NON_UNIQUE);
  int status = 1;
  Bad* bad = nullptr;
  Good* good = nullptr;
  application->signal_activate().connect([&] {
    bad = new Bad, good = new Good;
    for (Gtk::Window* window : {static_cast<Gtk::Window*>(bad), static_cast<Gtk::Window*>(good)}) {
      application->add_window(*window);
      window->present();
    }
    Glib::signal_timeout().connect_once(
        [&] {
          const int cut = Count(*bad, "text cut off"), off = Count(*bad, "off the window");
          const auto amiss = trocar::gui::FindMisfits(*good, kWidth, kHeight);
          std::printf("bad: %d cut, %d off; good: %zu amiss of %zu widgets; folds %d, stacks %d\n", cut, off,
                      amiss.size(), trocar::gui::CountSeen(*good), good->Folds(), good->Stacks());
          for (const auto& one : amiss)
            std::printf("%s: %s %d\n", one.what.c_str(), one.widget.c_str(), one.excess);
          status = cut == 1 && off >= 1 && amiss.empty() && good->Folds() && good->Stacks() ? 0 : 1;
          application->quit();
        },
        1500);
  });
  application->run(argc, argv);
  delete bad;
  delete good;
  return status;
}
