// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/card.h"

#include "trocar/host/translate.h"

namespace trocar::gui {
namespace {

constexpr int kNarrowest = 10;  // of a text that wraps: the panel gives the width [characters]

}  // namespace

Card::Card(const char* title, int spacing) : Gtk::Box(Gtk::Orientation::VERTICAL, spacing) {
  add_css_class("card");
  if (title == nullptr) return;
  title_.set_text(host::Translate(title));
  SetStyle(title_, "card-title");
  title_.set_hexpand(true);
  title_line_.append(title_);
  append(title_line_);
}

void Card::SetTitleEnd(Gtk::Widget& widget) {
  title_line_.append(widget);
}

Gtk::Label& Card::AddLine(const char* name, const char* tip) {
  auto* label = Gtk::make_managed<Gtk::Label>(host::Translate(name));
  SetStyle(*label, "name");
  label->set_hexpand(true);
  auto* value = Gtk::make_managed<Gtk::Label>("—");
  SetStyle(*value, "value", Gtk::Align::END);
  Gtk::Box& line = MakeRow(0, {label, value});
  line.set_tooltip_text(host::Translate(tip));
  append(line);
  return *value;
}

void SetStyle(Gtk::Label& label, const char* style, Gtk::Align align) {
  label.add_css_class(style);
  label.set_halign(align);
  label.set_xalign(align == Gtk::Align::END ? 1.0f : 0.0f);
}

void Wrap(Gtk::Label& label) {
  label.set_wrap(true);
  label.set_max_width_chars(kNarrowest);
  label.set_hexpand(true);
  label.set_halign(Gtk::Align::FILL);
  label.set_xalign(0);
}

Gtk::Label* MakeLabel(const std::string& text, const char* style) {
  auto* label = Gtk::make_managed<Gtk::Label>(text);
  label->add_css_class(style);
  label->set_xalign(0);
  label->set_hexpand(true);
  label->set_wrap(true);
  label->set_wrap_mode(Pango::WrapMode::WORD_CHAR);
  return label;
}

Gtk::Box& MakeRow(int spacing, std::initializer_list<Gtk::Widget*> widgets) {
  auto* row = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::HORIZONTAL, spacing);
  for (Gtk::Widget* widget : widgets) row->append(*widget);
  return *row;
}

}  // namespace trocar::gui
