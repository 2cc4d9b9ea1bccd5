// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_cards.h"

#include <cmath>
#include <cstdio>

#include "trocar/gui/labels.h"
#include "trocar/host/translate.h"

namespace trocar::editor {
namespace {

constexpr int kCardSpacing = 4, kRowSpacing = 6;
constexpr int kNameWidth = 66, kValueWidth = 58;  // of a slider's row [pixels]

std::string HexColour(const render::SrgbColour& c) {
  char text[8];
  const auto byte = [](double v) { return static_cast<int>(std::lround(255 * v)); };
  std::snprintf(text, sizeof(text), "#%02x%02x%02x", byte(c[0]), byte(c[1]), byte(c[2]));
  return text;
}

void MakeSmall(Gtk::Button& button, const std::string& tip) {
  button.add_css_class("small");
  button.set_focus_on_click(false);
  button.set_tooltip_text(tip);
}

void SetWrapped(Gtk::Label& label, const char* style) {
  gui::SetStyle(label, style);
  gui::Wrap(label);
}

}  // namespace

// organs

OrganCard::OrganCard(ContourPanelPresenter& presenter)
    : gui::Card("Organs", kCardSpacing), presenter_(presenter) {
  organs_.set_spacing(3);
  append(organs_);
  MakeSmall(add_, host::Translate("Add an organ"));
  MakeSmall(rename_, host::Translate("Rename the chosen organ"));
  MakeSmall(delete_, host::Translate("Delete the chosen organ with its contours (Ctrl+Z brings it back)"));
  Gtk::Box& row = gui::MakeRow(kRowSpacing, {&add_, &rename_, &delete_});
  append(row);
  name_popover_.set_parent(row);
  name_entry_.set_placeholder_text(host::Translate("name, then Enter"));
  name_popover_.set_child(name_entry_);
  add_.signal_clicked().connect([this] { AskName(true); });
  rename_.signal_clicked().connect([this] { AskName(false); });
  delete_.signal_clicked().connect([this] { presenter_.DeleteOrgan(); });
  name_entry_.signal_activate().connect([this] { TakeName(); });
}

OrganCard::~OrganCard() {
  name_popover_.unparent();
}

void OrganCard::AskName(bool is_new) {
  if (!is_new && shown_.empty()) return;
  is_naming_new_ = is_new;
  name_entry_.set_text(is_new ? "" : presenter_.ChosenName());
  name_popover_.popup();
  name_entry_.grab_focus();
}

void OrganCard::TakeName() {
  const std::string name = name_entry_.get_text().raw();
  name_popover_.popdown();
  is_naming_new_ ? presenter_.AddOrgan(name) : presenter_.RenameOrgan(name);
}

Gtk::Widget& OrganCard::MakeRow(const ContourPanelPage::Organ& organ, int structure) {
  auto* button = Gtk::make_managed<Gtk::ToggleButton>();
  button->add_css_class("organ");
  button->set_focus_on_click(false);
  button->set_active(organ.is_chosen);
  auto* swatch = Gtk::make_managed<Gtk::Label>();
  swatch->set_markup("<span foreground=\"" + HexColour(organ.colour) + "\">\u25cf</span>");
  auto* name = Gtk::make_managed<Gtk::Label>(host::Translate(organ.name));
  name->set_ellipsize(Pango::EllipsizeMode::END);
  name->set_hexpand(true);
  name->set_xalign(0);
  auto* slices = Gtk::make_managed<Gtk::Label>(organ.slices);
  slices->add_css_class("fine");
  button->set_child(gui::MakeRow(8, {swatch, name, slices}));
  button->signal_clicked().connect([this, structure] {
    shown_.clear();  // a click on the chosen one has released its button
    presenter_.ChooseOrgan(structure);
  });
  return *button;
}

void OrganCard::Show(const std::vector<ContourPanelPage::Organ>& organs) {
  for (Gtk::Button* button : {&rename_, &delete_}) button->set_sensitive(!organs.empty());
  // rows are made anew only when something in them changes
  if (organs == shown_) return;
  shown_ = organs;
  while (Gtk::Widget* child = organs_.get_first_child()) organs_.remove(*child);
  for (std::size_t s = 0; s < organs.size(); ++s) organs_.append(MakeRow(organs[s], static_cast<int>(s)));
}

// the slice

SliceCard::SliceCard() : gui::Card(nullptr, kCardSpacing) {
  SetWrapped(title_, "card-title");
  SetWrapped(text_, "name");
  SetWrapped(notes_, "note");
  for (Gtk::Label* label : {&title_, &text_, &notes_}) append(*label);
  struct Entry {
    const char *text, *tip;
    ContourAction action;
  };
  constexpr Entry kEntries[] = {
      {host::Mark("\u25c2 Carry"), host::Mark("Carry the contours to the slice before (Shift+P)"),
       ContourAction::kPropagateBack},
      {host::Mark("Carry \u25b8"), host::Mark("Carry the contours to the next slice (P)"),
       ContourAction::kPropagateForward},
      {host::Mark("Hole"), host::Mark("The chosen contour is a hole (H)"), ContourAction::kToggleHole},
      {host::Mark("Clear"), host::Mark("Remove all contours of this organ from the slice (Ctrl+Delete)"),
       ContourAction::kClearSlice}};
  Gtk::Box& row = gui::MakeRow(kRowSpacing, {});
  for (const Entry& entry : kEntries) {
    auto* button = Gtk::make_managed<Gtk::Button>(host::Translate(entry.text));
    MakeSmall(*button, host::Translate(entry.tip));
    button->signal_clicked().connect([this, action = entry.action] { signal_action_.emit(action); });
    row.append(*button);
  }
  append(row);
}

void SliceCard::Show(const ContourPanelPage& page) {
  gui::SetTextOrHide(title_, page.slice_title);
  gui::SetTextOrHide(text_, page.slice_text);
  gui::SetTextOrHide(notes_, page.notes);
}

// sliders

EdgeCard::EdgeCard(ContourPanelPresenter& presenter) : gui::Card("Edge search and steps", kCardSpacing) {
  constexpr double kMost = ContourPanelPresenter::kMostReach;
  Add(reach_, host::Mark("Reach"),
      host::Mark("How far a clicked point may move to an edge; 0 leaves points where they were clicked"), 0,
      kMost, 0.5, [&presenter](double value) { presenter.SetReach(value); });
  Add(skipped_, host::Mark("Skipped"),
      host::Mark(
          "How far the edges of slices that you skip may move the contour between yours when the patient is "
          "built; 0 keeps the shape in between"),
      0, kMost, 0.5, [&presenter](double value) { presenter.SetSkippedReach(value); });
  Add(step_, host::Mark("Step"), host::Mark("Slices that Page Up, Page Down and Carry go at once"), 1, 20, 1,
      [&presenter](double value) { presenter.SetSliceStep(value); });
}

void EdgeCard::Add(Row& row, const char* name, const char* tip, double low, double high, double step,
                   std::function<void(double)> act) {
  auto* label = Gtk::make_managed<Gtk::Label>(host::Translate(name));
  label->add_css_class("name");
  label->set_size_request(kNameWidth, -1);
  label->set_xalign(0);
  row.scale.set_range(low, high);
  row.scale.set_increments(step, step);
  row.scale.set_draw_value(false);
  row.scale.set_hexpand(true);
  row.scale.set_tooltip_text(host::Translate(tip));
  row.value.add_css_class("value");
  row.value.set_size_request(kValueWidth, -1);
  row.value.set_xalign(1);
  row.scale.signal_value_changed().connect([this, &row, act = std::move(act)] {
    if (!is_showing_) act(row.scale.get_value());
  });
  append(gui::MakeRow(kRowSpacing, {label, &row.scale, &row.value}));
}

void EdgeCard::Show(const ContourPanelPage& page) {
  is_showing_ = true;
  const auto show = [](Row& row, const SliderPage& slider, bool is_enabled) {
    row.scale.set_sensitive(is_enabled);
    if (!is_enabled) return;
    row.scale.set_value(slider.value);
    gui::SetTextOrHide(row.value, slider.text);
  };
  show(reach_, page.reach, !page.organs.empty());
  show(skipped_, page.skipped, !page.organs.empty());
  show(step_, page.step, true);
  is_showing_ = false;
}

// surfaces

SurfaceCard::SurfaceCard() : gui::Card("Surface (preview)", kCardSpacing) {
  set_vexpand(true);
  view_.set_vexpand(true);
  view_.set_hexpand(true);
  append(view_);
  SetWrapped(text_, "stage");
  text_.set_tooltip_text(
      host::Translate("A preview; the last number is the distance of the lattice it was made on. Build "
                      "patient makes the finer one"));
  append(text_);
  progress_.set_hexpand(true);
  progress_.set_valign(Gtk::Align::CENTER);
  MakeSmall(cancel_,
            host::Translate("Give up the surfaces that are being made; the next change makes them again"));
  cancel_.signal_clicked().connect([this] { signal_cancel_.emit(); });
  append(gui::MakeRow(8, {&progress_, &cancel_}));
  ShowJob({});
}

void SurfaceCard::ShowText(const std::string& text) {
  gui::SetTextOrHide(text_, text);
}

void SurfaceCard::ShowJob(const contours::MeshJob::State& state) {
  progress_.set_fraction(state.is_busy ? state.fraction : 0);
  progress_.set_opacity(state.is_busy ? 1 : 0);
  cancel_.set_opacity(state.is_busy ? 1 : 0);
  cancel_.set_sensitive(state.is_busy);
}

}  // namespace trocar::editor
