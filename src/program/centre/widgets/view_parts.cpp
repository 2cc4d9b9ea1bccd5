// SPDX-License-Identifier: Apache-2.0
#include "view_parts.h"

#include "drawing_view.h"

namespace trocar::centre {

Gtk::Label& MakeText(const std::string& text, const char* style) {
  auto* label = Gtk::make_managed<Gtk::Label>(text);
  label->add_css_class(style);
  label->set_xalign(0);
  label->set_halign(Gtk::Align::FILL);
  label->set_wrap(true);
  return *label;
}

Gtk::Label& MakeLine(const std::string& text, const char* style) {
  auto* label = Gtk::make_managed<Gtk::Label>(text);
  label->add_css_class(style);
  label->set_xalign(0);
  return *label;
}

Gtk::Button& MakeButton(const std::string& label, std::function<void()> act, const char* style) {
  auto* button = Gtk::make_managed<Gtk::Button>(label);
  if (style != nullptr) button->add_css_class(style);
  button->set_valign(Gtk::Align::CENTER);
  button->signal_clicked().connect(std::move(act));
  return *button;
}

Gtk::Box& MakeCard(const std::string& title) {
  auto* card = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  card->add_css_class("card");
  card->set_spacing(6);
  if (!title.empty()) card->append(MakeLine(title, "card-title"));
  return *card;
}

Gtk::ScrolledWindow& MakePage(Gtk::Widget& content) {
  auto* scroller = Gtk::make_managed<Gtk::ScrolledWindow>();
  scroller->set_policy(Gtk::PolicyType::AUTOMATIC, Gtk::PolicyType::AUTOMATIC);
  scroller->set_vexpand(true);
  scroller->set_hexpand(true);
  scroller->set_child(content);
  return *scroller;
}

void Clear(Gtk::Box& box) {
  while (Gtk::Widget* child = box.get_first_child()) box.remove(*child);
}

const char* StyleOf(Tone tone) {
  switch (tone) {
    case Tone::kPlain:
      break;
    case Tone::kGood:
      return "good";
    case Tone::kCaution:
      return "caution";
    case Tone::kBad:
      return "bad";
  }
  return "value";
}

Gtk::Widget& MakePlot(const report::Drawing& drawing, int width) {
  auto* plot = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  plot->append(MakeText(drawing.title, "fine"));
  auto* view = Gtk::make_managed<DrawingView>(width);
  view->Show(drawing);
  plot->append(*view);
  return *plot;
}

Table::Table(const std::vector<std::string>& head) {
  set_column_spacing(18);
  set_row_spacing(4);
  for (const std::string& name : head) AddText(name, "fine");
  EndRow();
}

void Table::Add(Gtk::Widget& widget) {
  attach(widget, column_++, row_);
}

void Table::AddText(const std::string& text, const char* style, bool is_wide) {
  Gtk::Label& label = is_wide ? MakeText(text, style) : MakeLine(text, style);
  label.set_hexpand(is_wide);
  label.set_valign(Gtk::Align::CENTER);
  Add(label);
}

void Table::EndRow() {
  ++row_;
  column_ = 0;
}

}  // namespace trocar::centre
