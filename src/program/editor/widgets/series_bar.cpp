// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/series_bar.h"

#include <algorithm>
#include <vector>

#include "trocar/host/translate.h"

namespace trocar::editor {
namespace {

constexpr const char* kUnsaid = host::Mark("not said");

}  // namespace

SeriesBar::SeriesBar() : Gtk::Box(Gtk::Orientation::VERTICAL) {
  add_css_class("bar");
  add_css_class("question");
  set_spacing(6);
  set_visible(false);
  const auto add_text = [](Gtk::Box& box, const std::string& text, bool is_wrapped = false) {
    auto* label = Gtk::make_managed<Gtk::Label>(text);
    label->set_xalign(0);
    label->set_wrap(is_wrapped);
    box.append(*label);
  };
  add_text(*this,
           host::Translate("The files do not say how large the patient is or how it lies. Say what you know "
                           "of them; what they do say can stay empty."),
           true);
  auto* row = Gtk::make_managed<Gtk::Box>();
  row->set_spacing(8);
  const auto add_entry = [&](const std::string& name, Gtk::Entry& entry, const std::string& tooltip) {
    add_text(*row, name);
    entry.set_width_chars(7);
    entry.set_max_width_chars(7);
    entry.set_placeholder_text("mm");
    entry.set_tooltip_text(tooltip);
    entry.signal_activate().connect([this] { Answer(); });
    row->append(entry);
  };
  add_entry(host::Translate("Pixel"), pixel_,
            host::Translate("Side of a pixel [mm]; resolutions in pictures (dots an inch) are for printers"));
  add_entry(host::Translate("Slice distance"), slice_,
            host::Translate("From one slice number to the next [mm]"));
  std::vector<Glib::ustring> directions = {host::Translate(kUnsaid)};
  for (const char* direction : PatientDirections()) directions.emplace_back(host::Translate(direction));
  const char* const names[] = {host::Mark("Columns grow to"), host::Mark("rows to"),
                               host::Mark("slice numbers to")};
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    add_text(*row, host::Translate(names[i]));
    axes_[i].set_model(Gtk::StringList::create(directions));
    axes_[i].set_tooltip_text(host::Translate("Side of the patient, not of the picture"));
    row->append(axes_[i]);
  }
  auto* open = Gtk::make_managed<Gtk::Button>(host::Translate("Open"));
  open->add_css_class("primary");
  open->signal_clicked().connect([this] { Answer(); });
  row->append(*open);
  append(*row);
  complaint_.set_xalign(0);
  complaint_.set_wrap(true);
  complaint_.set_visible(false);
  append(complaint_);
}

void SeriesBar::Ask(const images::ImageSeriesOptions& series) {
  series_ = series;
  Fill(MakeSeriesForm(series));
  const bool is_again = series.pixel_mm || series.slice_mm || series.axes;
  complaint_.set_text(
      is_again ? host::Translate(
                     "What is left empty is not in the files either, or what is given contradicts them.")
               : "");
  complaint_.set_visible(is_again);
  set_visible(true);
  pixel_.grab_focus();
}

void SeriesBar::Fill(const SeriesForm& form) {
  pixel_.set_text(form.pixel_mm);
  slice_.set_text(form.slice_mm);
  const auto directions = PatientDirections();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto found = std::find(directions.begin(), directions.end(), form.axes[i]);
    axes_[i].set_selected(found == directions.end() ? 0 : static_cast<guint>(found - directions.begin()) + 1);
  }
}

void SeriesBar::Answer() {
  SeriesForm form{pixel_.get_text().raw(), slice_.get_text().raw(), {}};
  const auto directions = PatientDirections();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const guint chosen = axes_[i].get_selected();
    if (chosen >= 1 && chosen <= directions.size()) form.axes[i] = directions[chosen - 1];
  }
  const auto read = ReadSeriesForm(form, series_);
  complaint_.set_text(read.ok() ? "" : host::TranslateComposed(read.error().message));
  complaint_.set_visible(!read.ok());
  if (!read.ok()) return;
  set_visible(false);
  signal_answered_.emit(*read);
}

}  // namespace trocar::editor
