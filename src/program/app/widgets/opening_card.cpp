// SPDX-License-Identifier: Apache-2.0
#include "opening_card.h"

#include "trocar/gui/labels.h"
#include "trocar/host/translate.h"

namespace trocar::app {
namespace {

constexpr int kWidth = 560;  // [pixels]

}  // namespace

OpeningCard::OpeningCard() : Gtk::Box(Gtk::Orientation::VERTICAL) {
  add_css_class("help");
  set_halign(Gtk::Align::CENTER);
  set_valign(Gtk::Align::CENTER);
  set_spacing(10);
  set_size_request(kWidth, -1);
  doing_.add_css_class("key-text");
  doing_.set_xalign(0);
  doing_.set_wrap(true);
  doing_.set_max_width_chars(60);
  gui::SetAccessibleName(progress_, host::Translate("The operation is prepared"));
  auto* note = Gtk::make_managed<Gtk::Label>(host::Translate("This is done once and kept."));
  note->add_css_class("name");
  note->set_xalign(0);
  auto* cancel = Gtk::make_managed<Gtk::Button>(host::Translate("Cancel"));
  cancel->set_halign(Gtk::Align::END);
  cancel->signal_clicked().connect([this] { signal_cancelled_.emit(); });
  append(doing_);
  append(progress_);
  append(*note);
  append(*cancel);
}

void OpeningCard::Show(const std::string& doing, double share) {
  gui::SetText(doing_, doing);
  if (!doing.empty()) progress_.set_fraction(share);
  if (get_visible() == doing.empty()) set_visible(!doing.empty());
}

}  // namespace trocar::app
