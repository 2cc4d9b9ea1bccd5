// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/patient_cards.h"

#include <utility>

#include "trocar/gui/labels.h"
#include "trocar/host/translate.h"

namespace trocar::editor {
namespace {

constexpr int kCardSpacing = 5;
constexpr int kListHeight = 150;     // [pixels]
constexpr int kTextCharacters = 40;  // of a line of small print

Gtk::Label* MakeSmallPrint(const std::string& text) {
  auto* label = gui::MakeLabel(text, "fine");
  label->set_ellipsize(Pango::EllipsizeMode::NONE);
  label->set_wrap(true);
  label->set_max_width_chars(kTextCharacters);
  return label;
}

Gtk::Widget* MakeSwatch(const render::SrgbColour& colour) {
  auto* swatch = Gtk::make_managed<Gtk::DrawingArea>();
  swatch->set_content_width(12);
  swatch->set_content_height(12);
  swatch->set_valign(Gtk::Align::CENTER);
  swatch->set_draw_func([colour](const Cairo::RefPtr<Cairo::Context>& cairo, int width, int height) {
    cairo->set_source_rgb(colour[0], colour[1], colour[2]);
    cairo->rectangle(0, 0, width, height);
    cairo->fill();
  });
  return swatch;
}

Gtk::ScrolledWindow& MakeScrolled(Gtk::Widget& content) {
  auto* scrolled = Gtk::make_managed<Gtk::ScrolledWindow>();
  scrolled->set_policy(Gtk::PolicyType::NEVER, Gtk::PolicyType::AUTOMATIC);
  scrolled->set_min_content_height(kListHeight);
  scrolled->set_child(content);
  return *scrolled;
}

void Clear(Gtk::ListBox& list) {
  while (auto* child = list.get_first_child()) list.remove(*child);
}

void Select(Gtk::ListBox& list, const std::optional<std::uint32_t>& row) {
  if (row) {
    list.select_row(*list.get_row_at_index(static_cast<int>(*row)));
  } else {
    list.unselect_all();
  }
}

}  // namespace

ChoiceBox::ChoiceBox(std::function<void(std::size_t)> act) {
  property_selected().signal_changed().connect([this, act = std::move(act)] {
    if (!is_showing_ && get_selected() < shown_.size()) act(get_selected());
  });
}

void ChoiceBox::Show(const ChoicePage& page) {
  const Showing showing(is_showing_);
  if (page.names != shown_) {
    shown_ = page.names;
    set_model(Gtk::StringList::create({shown_.begin(), shown_.end()}));
  }
  set_selected(static_cast<guint>(page.chosen));
}

ValueSlider::ValueSlider(double low, double high, int digits, std::function<void(double)> act)
    : Gtk::Scale(Gtk::Orientation::HORIZONTAL) {
  set_range(low, high);
  set_draw_value(true);
  set_value_pos(Gtk::PositionType::RIGHT);
  set_digits(digits);
  signal_value_changed().connect([this, act = std::move(act)] {
    if (!is_showing_) act(get_value());
  });
}

void ValueSlider::Show(double value) {
  const Showing showing(is_showing_);
  set_value(value);
}

// painting

PaintCard::PaintCard(PatientPanelPresenter& presenter)
    : gui::Card("Region", kCardSpacing),
      regions_([&presenter](std::size_t place) { presenter.ChooseRegion(place); }),
      brush_(1, 40, 1, [&presenter](double radius) { presenter.SetBrush(radius); }) {
  append(regions_);
  erase_.set_group(paint_);
  paint_.set_active(true);
  paint_.set_tooltip_text(host::Translate("Drag over the organ to add (Shift: erase)"));
  erase_.set_tooltip_text(host::Translate("Drag over the organ to erase (E switches)"));
  erase_.signal_toggled().connect([this, &presenter] {
    if (!is_showing_) presenter.SetErasing(erase_.get_active());
  });
  Gtk::Box& row = gui::MakeRow(0, {&paint_, &erase_});
  row.add_css_class("linked");
  row.set_homogeneous(true);
  append(row);
  append(*gui::MakeLabel(host::Translate("Radius of the brush [mm], Ctrl+wheel"), "name"));
  append(brush_);
}

void PaintCard::Show(const PatientPanelPage& page) {
  set_visible(page.tool == EditorTool::kPaint);
  const Showing showing(is_showing_);
  regions_.Show(page.regions);
  (page.is_erasing ? erase_ : paint_).set_active(true);
  brush_.Show(page.brush_mm);
}

// ducts and arteries

TubeCard::TubeCard(PatientPanelPresenter& presenter)
    : gui::Card("Ducts and arteries", kCardSpacing),
      from_([&presenter](std::size_t place) { presenter.JoinTube(anatomy::TubeEnd::kFrom, place); }),
      to_([&presenter](std::size_t place) { presenter.JoinTube(anatomy::TubeEnd::kTo, place); }),
      missing_([](std::size_t) {}),
      reach_(0, 40, 0, [&presenter](double reach) { presenter.SetReach(reach); }) {
  tubes_.set_selection_mode(Gtk::SelectionMode::SINGLE);
  tubes_.signal_row_selected().connect([this, &presenter](Gtk::ListBoxRow* row) {
    if (!is_showing_ && row != nullptr) presenter.ChooseTube(static_cast<std::size_t>(row->get_index()));
  });
  append(MakeScrolled(tubes_));
  facts_.set_xalign(0);
  facts_.add_css_class("fine");
  append(facts_);
  AddEnds();
  append(*gui::MakeLabel(host::Translate("Neighbours follow over [mm]"), "name"));
  append(reach_);
  AddButtons(presenter);
}

void TubeCard::AddEnds() {
  auto* ends = Gtk::make_managed<Gtk::Grid>();
  ends->set_column_spacing(8);
  ends->set_row_spacing(4);
  ends->attach(*gui::MakeLabel(host::Translate("Begins at"), "name"), 0, 0);
  ends->attach(from_, 1, 0);
  ends->attach(*gui::MakeLabel(host::Translate("Ends at"), "name"), 0, 1);
  ends->attach(to_, 1, 1);
  from_.set_hexpand(true);
  append(*ends);
}

void TubeCard::AddButtons(PatientPanelPresenter& presenter) {
  const auto make = [](Gtk::Button& button, const std::string& tip, std::function<void()> act) {
    button.add_css_class("small");
    button.set_tooltip_text(tip);
    button.set_focus_on_click(false);
    button.signal_clicked().connect(std::move(act));
  };
  make(insert_, host::Translate("Halfway to the next point (Insert; or Shift+click on the duct)"),
       [&presenter] { presenter.InsertPoint(); });
  make(delete_, host::Translate("The chosen point (Delete)"), [&presenter] { presenter.DeletePoint(); });
  make(remove_, host::Translate("The whole duct or artery"), [&presenter] { presenter.RemoveTube(); });
  make(add_, host::Translate("Add a duct that the images did not show: placed by the landmarks"),
       [this, &presenter] { presenter.AddMissingTube(missing_.get_selected()); });
  append(gui::MakeRow(4, {&insert_, &delete_, &remove_}));
  missing_.set_hexpand(true);
  append(gui::MakeRow(6, {&missing_, &add_}));
}

Gtk::Widget& TubeCard::MakeRow(const PatientPanelPage::Tube& tube) {
  Gtk::Box& row = gui::MakeRow(8, {MakeSwatch(tube.colour), gui::MakeLabel(tube.name, "name")});
  if (tube.is_placed) {
    auto* placed = gui::MakeLabel(host::Translate("placed"), "fine");
    placed->set_hexpand(false);
    placed->set_tooltip_text(host::Translate("The images do not show it: it was placed by landmarks"));
    row.append(*placed);
  }
  return row;
}

void TubeCard::Show(const PatientPanelPage& page) {
  set_visible(page.tool == EditorTool::kTubes);
  const Showing showing(is_showing_);
  if (page.tubes != shown_) {
    shown_ = page.tubes;
    Clear(tubes_);
    for (const PatientPanelPage::Tube& tube : shown_) tubes_.append(MakeRow(tube));
  }
  Select(tubes_, page.tube);
  const bool has_tube = page.tube.has_value();
  for (Gtk::Widget* widget : {static_cast<Gtk::Widget*>(&from_), static_cast<Gtk::Widget*>(&to_),
                              static_cast<Gtk::Widget*>(&remove_)})
    widget->set_sensitive(has_tube);
  for (Gtk::Button* button : {&insert_, &delete_}) button->set_sensitive(page.has_tube_point);
  gui::SetText(facts_, page.tube_facts);
  if (has_tube) {
    from_.Show(page.from);
    to_.Show(page.to);
  }
  reach_.Show(page.reach_mm);
  missing_.Show(page.missing);
  missing_.set_sensitive(page.can_add);
  add_.set_sensitive(page.can_add);
}

// landmarks

LandmarkCard::LandmarkCard(PatientPanelPresenter& presenter) : gui::Card("Landmarks", kCardSpacing) {
  landmarks_.signal_row_selected().connect([this, &presenter](Gtk::ListBoxRow* row) {
    if (!is_showing_ && row != nullptr) presenter.ChooseLandmark(static_cast<std::size_t>(row->get_index()));
  });
  append(MakeScrolled(landmarks_));
  append(*MakeSmallPrint(
      host::Translate("Drag a disc in the picture. Fundus and infundibulum stay on the gallbladder.")));
}

void LandmarkCard::Show(const PatientPanelPage& page) {
  set_visible(page.tool == EditorTool::kLandmarks);
  const Showing showing(is_showing_);
  if (page.landmarks != shown_) {
    shown_ = page.landmarks;
    Clear(landmarks_);
    for (const PatientPanelPage::Landmark& landmark : shown_) {
      auto* place = gui::MakeLabel(landmark.place, "fine");
      place->set_hexpand(false);
      place->set_tooltip_text("LPS [mm]");
      landmarks_.append(gui::MakeRow(0, {gui::MakeLabel(landmark.name, "name"), place}));
    }
  }
  Select(landmarks_, page.landmark);
}

// looks

LookCard::LookCard(PatientPanelPresenter& presenter) : gui::Card("Show", kCardSpacing) {
  colours_.set_active(true);
  const auto act = [this, &presenter] {
    if (is_showing_) return;
    look_.has_regions = colours_.get_active();
    look_.has_edges = edges_.get_active();
    look_.has_attachments = strands_.get_active();
    look_.liver_opacity = opacity_.get_value();
    presenter.SetLook(look_);
  };
  for (Gtk::CheckButton* each : {&colours_, &edges_, &strands_}) each->signal_toggled().connect(act);
  append(gui::MakeRow(10, {&colours_, &edges_, &strands_}));
  append(*gui::MakeLabel(host::Translate("Opacity of the liver"), "name"));
  opacity_.set_range(0, 1);
  opacity_.set_value(1);
  opacity_.signal_value_changed().connect(act);
  append(opacity_);
}

void LookCard::Show(const PatientPanelPage& page) {
  const Showing showing(is_showing_);
  look_ = page.look;
  colours_.set_active(look_.has_regions);
  edges_.set_active(look_.has_edges);
  strands_.set_active(look_.has_attachments);
  opacity_.set_value(look_.liver_opacity);
}

// findings

FindingsCard::FindingsCard() : gui::Card("Check", kCardSpacing) {
  title_.set_xalign(0);
  title_.add_css_class("name");
  append(title_);
  findings_.signal_row_activated().connect([this](Gtk::ListBoxRow* row) {
    const auto place = static_cast<std::size_t>(row->get_index());
    if (place < wheres_.size()) signal_look_at_.emit(wheres_[place]);
  });
  Gtk::ScrolledWindow& scrolled = MakeScrolled(findings_);
  scrolled.set_vexpand(true);
  set_vexpand(true);
  append(scrolled);
}

void FindingsCard::Show(const FindingsPage& page) {
  Clear(findings_);
  wheres_.clear();
  for (const FindingsPage::Row& row : page.rows) {
    auto* box = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
    box->append(*gui::MakeLabel(row.title, "hand"));
    box->append(*MakeSmallPrint(row.text));
    box->set_tooltip_text(host::Translate("Click to look there"));
    findings_.append(*box);
    wheres_.push_back(row.where);
  }
  title_.set_text(page.title);
}

}  // namespace trocar::editor
