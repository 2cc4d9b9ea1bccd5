// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/list_card.h"

#include "trocar/gui/card.h"
#include "trocar/host/translate.h"

namespace trocar::gui {
namespace {

constexpr int kHeight = 520;                             // at most, of the rows [pixels]
constexpr int kPictureWidth = 112, kPictureHeight = 70;  // [pixels]

}  // namespace

ListCard::ListCard(int width) : Gtk::Box(Gtk::Orientation::VERTICAL) {
  add_css_class("help");
  set_halign(Gtk::Align::CENTER);
  set_valign(Gtk::Align::CENTER);
  set_spacing(8);
  rows_.set_spacing(4);
  auto* scroller = Gtk::make_managed<Gtk::ScrolledWindow>();
  scroller->set_policy(Gtk::PolicyType::NEVER, Gtk::PolicyType::AUTOMATIC);
  scroller->set_propagate_natural_height(true);
  scroller->set_max_content_height(kHeight);
  scroller->set_size_request(width, -1);
  scroller->set_child(rows_);
  append(*scroller);
}

void ListCard::ClearRows() {
  while (Gtk::Widget* child = rows_.get_first_child()) rows_.remove(*child);
}

void ListCard::AddTitle(const Glib::ustring& text) {
  auto* title = Gtk::make_managed<Gtk::Label>(text);
  title->add_css_class("card-title");
  title->set_xalign(0);
  rows_.append(*title);
}

void ListCard::AddRow(const std::string& name, const std::string& about,
                      std::initializer_list<Gtk::Widget*> beside) {
  auto* text = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  text->set_hexpand(true);
  text->append(*MakeLabel(name, "key"));
  if (!about.empty()) {
    Gtk::Label* line = MakeLabel(about, "fine");
    line->set_tooltip_text(about);
    text->append(*line);
  }
  Gtk::Box& row = MakeRow(8, {text});
  for (Gtk::Widget* widget : beside) {
    widget->set_valign(Gtk::Align::CENTER);
    row.append(*widget);
  }
  rows_.append(row);
}

void ListCard::AddPictureRow(const std::filesystem::path& picture, const std::string& name,
                             std::initializer_list<Gtk::Widget*> lines,
                             std::initializer_list<Gtk::Widget*> beside) {
  auto* image = Gtk::make_managed<Gtk::Picture>();
  if (!picture.empty()) image->set_filename(picture.string());
  image->set_alternative_text(name);
  image->set_can_shrink(true);
  image->set_size_request(kPictureWidth, kPictureHeight);
  image->set_halign(Gtk::Align::START);
  image->add_css_class("thumbnail");
  auto* text = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  text->set_hexpand(true);
  text->set_valign(Gtk::Align::CENTER);
  text->append(*MakeLabel(name, "key"));
  for (Gtk::Widget* line : lines) text->append(*line);
  Gtk::Box& row = MakeRow(12, {image, text});
  for (Gtk::Widget* widget : beside) {
    widget->set_valign(Gtk::Align::CENTER);
    row.append(*widget);
  }
  rows_.append(row);
}

void ListCard::AddFoot(std::initializer_list<Gtk::Widget*> widgets) {
  Gtk::Box& foot = MakeRow(8, widgets);
  auto* close = Gtk::make_managed<Gtk::Button>(host::Translate("Close"));
  close->set_hexpand(true);
  close->set_halign(Gtk::Align::END);
  close->signal_clicked().connect([this] { signal_closed_.emit(); });
  foot.append(*close);
  append(foot);
}

}  // namespace trocar::gui
