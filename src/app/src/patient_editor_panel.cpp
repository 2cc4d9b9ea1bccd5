// SPDX-License-Identifier: Apache-2.0
#include "patient_editor_panel.h"

#include <algorithm>
#include <cstdio>

namespace trocar::app {
namespace {

constexpr double kMmPerMetre = 1000.0;
constexpr int kListHeight = 150, kFindingsHeight = 150;  // pixels

/// Words of a name as a person reads them: "cystic duct".
std::string Spoken(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

Gtk::Label* MakeLabel(const Glib::ustring& text, const char* style, bool wraps = false) {
  auto* label = Gtk::make_managed<Gtk::Label>(text);
  label->add_css_class(style);
  label->set_xalign(0);
  label->set_hexpand(true);
  if (wraps) {
    label->set_wrap(true);
    label->set_max_width_chars(40);
  } else {
    label->set_ellipsize(Pango::EllipsizeMode::END);
  }
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

Gtk::ScrolledWindow* MakeScrolled(Gtk::Widget& content, int height) {
  auto* scrolled = Gtk::make_managed<Gtk::ScrolledWindow>();
  scrolled->set_policy(Gtk::PolicyType::NEVER, Gtk::PolicyType::AUTOMATIC);
  scrolled->set_min_content_height(height);
  scrolled->set_child(content);
  return scrolled;
}

void Clear(Gtk::ListBox& list) {
  while (auto* child = list.get_first_child()) list.remove(*child);
}

void SetNames(Gtk::DropDown& drop_down, const std::vector<Glib::ustring>& names, guint chosen) {
  drop_down.set_model(Gtk::StringList::create(names));
  drop_down.set_selected(chosen);
}

}  // namespace

PatientEditorPanel::PatientEditorPanel() : Gtk::Box(Gtk::Orientation::VERTICAL) {
  add_css_class("panel");
  set_spacing(8);
  set_margin(10);
  set_size_request(330, -1);
  set_hexpand(false);
  MakeTools();
  MakePaintCard();
  MakeTubeCard();
  MakeLandmarkCard();
  MakeLookCard();
  MakeFindingsCard();
}

Gtk::Box& PatientEditorPanel::AddCard(const char* title) {
  auto* card = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  card->add_css_class("card");
  card->set_spacing(5);
  card->append(*MakeLabel(title, "card-title"));
  append(*card);
  return *card;
}

void PatientEditorPanel::MakeTools() {
  auto* row = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::HORIZONTAL);
  row->add_css_class("linked");
  row->set_homogeneous(true);
  const struct {
    const char *name, *tooltip;
  } tools[] = {{"Look", "Turn and look (1)"},
               {"Regions", "Paint where the liver is held and where the gallbladder grows on it (2)"},
               {"Ducts", "Move, insert and delete points of ducts and arteries (3)"},
               {"Landmarks", "Move landmarks (4)"}};
  for (std::size_t i = 0; i < std::size(tools); ++i) {
    auto* button = Gtk::make_managed<Gtk::ToggleButton>(tools[i].name);
    button->set_tooltip_text(tools[i].tooltip);
    button->set_focus_on_click(false);
    if (!tools_.empty()) button->set_group(*tools_.front());
    button->signal_toggled().connect([this, button, i] {
      if (is_showing_ || editor_ == nullptr || !button->get_active()) return;
      editor_->tool = static_cast<EditorTool>(i);
      Announce();
    });
    tools_.push_back(button);
    row->append(*button);
  }
  append(*row);
}

void PatientEditorPanel::MakePaintCard() {
  paint_card_ = &AddCard("Region");
  paint_card_->append(regions_);
  regions_.property_selected().signal_changed().connect([this] {
    const guint chosen = regions_.get_selected();
    if (is_showing_ || editor_ == nullptr || chosen >= region_choices_.size()) return;
    editor_->region = region_choices_[chosen];
    Announce();
  });
  auto* row = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::HORIZONTAL);
  row->add_css_class("linked");
  row->set_homogeneous(true);
  erase_.set_group(add_);
  add_.set_active(true);
  add_.set_tooltip_text("Drag over the organ to add (Shift: erase)");
  erase_.set_tooltip_text("Drag over the organ to erase (E switches)");
  row->append(add_);
  row->append(erase_);
  erase_.signal_toggled().connect([this] {
    if (is_showing_ || editor_ == nullptr) return;
    editor_->is_erasing = erase_.get_active();
    Announce();
  });
  paint_card_->append(*row);
  paint_card_->append(*MakeLabel("Radius of the brush [mm], Ctrl+wheel", "name"));
  brush_.set_range(1, 40);
  brush_.set_draw_value(true);
  brush_.set_value_pos(Gtk::PositionType::RIGHT);
  brush_.set_digits(1);
  brush_.signal_value_changed().connect([this] {
    if (is_showing_ || editor_ == nullptr) return;
    editor_->brush_radius = brush_.get_value() / kMmPerMetre;
    Announce();
  });
  paint_card_->append(brush_);
}

void PatientEditorPanel::MakeTubeCard() {
  tube_card_ = &AddCard("Ducts and arteries");
  tubes_.set_selection_mode(Gtk::SelectionMode::SINGLE);
  tubes_.signal_row_selected().connect([this](Gtk::ListBoxRow* row) {
    if (is_showing_ || editor_ == nullptr || row == nullptr) return;
    editor_->ChooseTube(static_cast<std::uint32_t>(row->get_index()));
    Announce();
  });
  tube_card_->append(*MakeScrolled(tubes_, kListHeight));
  tube_facts_.set_xalign(0);
  tube_facts_.add_css_class("fine");
  tube_card_->append(tube_facts_);
  auto* ends = Gtk::make_managed<Gtk::Grid>();
  ends->set_column_spacing(8);
  ends->set_row_spacing(4);
  ends->attach(*MakeLabel("Begins at", "name"), 0, 0);
  ends->attach(from_, 1, 0);
  ends->attach(*MakeLabel("Ends at", "name"), 0, 1);
  ends->attach(to_, 1, 1);
  from_.set_hexpand(true);
  from_.property_selected().signal_changed().connect([this] { JoinChosen(anatomy::TubeEnd::kFrom, from_); });
  to_.property_selected().signal_changed().connect([this] { JoinChosen(anatomy::TubeEnd::kTo, to_); });
  tube_card_->append(*ends);
  tube_card_->append(*MakeLabel("Neighbours follow over [mm]", "name"));
  reach_.set_range(0, 40);
  reach_.set_draw_value(true);
  reach_.set_value_pos(Gtk::PositionType::RIGHT);
  reach_.set_digits(0);
  reach_.signal_value_changed().connect([this] {
    if (!is_showing_ && editor_ != nullptr) editor_->reach = reach_.get_value() / kMmPerMetre;
  });
  tube_card_->append(reach_);
  auto* row = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::HORIZONTAL);
  row->set_spacing(4);
  const auto act = [this, row](Gtk::Button& button, const char* tooltip, auto operation) {
    button.add_css_class("small");
    button.set_tooltip_text(tooltip);
    button.set_focus_on_click(false);
    button.signal_clicked().connect([this, operation] {
      if (editor_ == nullptr) return;
      Report(operation());
      Announce();
    });
    row->append(button);
  };
  act(insert_, "Halfway to the next point (Insert; or Shift+click on the duct)",
      [this] { return editor_->InsertPoint(); });
  act(delete_, "The chosen point (Delete)", [this] { return editor_->DeletePoint(); });
  act(remove_, "The whole duct or artery", [this]() -> core::Status {
    if (!editor_->Tube()) return core::Error{core::ErrorCode::kUsage, "choose a duct or artery first"};
    const auto tube = *editor_->Tube();
    auto status =
        editor_->Document().Edit("remove " + editor_->GetPatient().tubes[tube].name,
                                 [tube](anatomy::Patient& p) { return anatomy::RemoveTube(p, tube); });
    editor_->ChooseTube(std::nullopt);
    return status;
  });
  tube_card_->append(*row);
  auto* template_row = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::HORIZONTAL);
  template_row->set_spacing(6);
  missing_.set_hexpand(true);
  template_row->append(missing_);
  add_tube_.add_css_class("small");
  add_tube_.set_tooltip_text("Add a duct that the images did not show: placed by the landmarks");
  add_tube_.signal_clicked().connect([this] {
    const guint chosen = missing_.get_selected();
    if (editor_ == nullptr || chosen >= missing_names_.size()) return;
    const std::string name = missing_names_[chosen];
    const auto status = editor_->Document().Edit(
        "add " + name, [&name](anatomy::Patient& p) { return anatomy::AddTemplateTube(p, name); });
    if (status) editor_->ChooseTube(static_cast<std::uint32_t>(editor_->GetPatient().tubes.size() - 1));
    Report(status);
    Announce();
  });
  template_row->append(add_tube_);
  tube_card_->append(*template_row);
}

void PatientEditorPanel::MakeLandmarkCard() {
  landmark_card_ = &AddCard("Landmarks");
  landmarks_.signal_row_selected().connect([this](Gtk::ListBoxRow* row) {
    if (is_showing_ || editor_ == nullptr || row == nullptr) return;
    editor_->ChooseLandmark(static_cast<std::uint32_t>(row->get_index()));
    Announce();
  });
  landmark_card_->append(*MakeScrolled(landmarks_, kListHeight));
  landmark_card_->append(*MakeLabel(
      "Drag a disc in the picture. Fundus and infundibulum stay on the gallbladder.", "fine", true));
}

void PatientEditorPanel::MakeLookCard() {
  Gtk::Box& card = AddCard("Show");
  auto* row = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::HORIZONTAL);
  row->set_spacing(10);
  colours_.set_active(true);
  for (Gtk::CheckButton* each : {&colours_, &edges_, &strands_}) {
    row->append(*each);
    each->signal_toggled().connect([this] {
      if (is_showing_ || editor_ == nullptr) return;
      editor_->look.has_regions = colours_.get_active();
      editor_->look.has_edges = edges_.get_active();
      editor_->look.has_attachments = strands_.get_active();
      Announce();
    });
  }
  card.append(*row);
  card.append(*MakeLabel("Opacity of the liver", "name"));
  opacity_.set_range(0, 1);
  opacity_.set_value(1);
  opacity_.signal_value_changed().connect([this] {
    if (is_showing_ || editor_ == nullptr) return;
    editor_->look.liver_opacity = opacity_.get_value();
    Announce();
  });
  card.append(opacity_);
}

void PatientEditorPanel::MakeFindingsCard() {
  Gtk::Box& card = AddCard("Check");
  findings_title_.set_xalign(0);
  findings_title_.add_css_class("name");
  card.append(findings_title_);
  findings_.signal_row_activated().connect([this](Gtk::ListBoxRow* row) {
    const auto index = static_cast<std::size_t>(row->get_index());
    if (index < wheres_.size()) signal_look_at_.emit(wheres_[index]);
  });
  auto* scrolled = MakeScrolled(findings_, kFindingsHeight);
  scrolled->set_vexpand(true);
  card.set_vexpand(true);
  card.append(*scrolled);
}

void PatientEditorPanel::SetEditor(PatientEditor* editor) {
  editor_ = editor;
  Refresh();
}

void PatientEditorPanel::Announce() {
  if (is_announced_) return;
  is_announced_ = true;
  // the lists are made anew, which must not happen within their own signals
  Glib::signal_timeout().connect_once(sigc::mem_fun(*this, &PatientEditorPanel::EmitChanged), 0);
}

void PatientEditorPanel::EmitChanged() {
  is_announced_ = false;
  signal_changed_.emit();
}

void PatientEditorPanel::Report(const core::Status& status) {
  if (!status) signal_refused_.emit(status.error());
}

void PatientEditorPanel::JoinChosen(anatomy::TubeEnd end, const Gtk::DropDown& names) {
  const guint chosen = names.get_selected();
  if (is_showing_ || editor_ == nullptr || !editor_->Tube() || chosen >= end_names_.size()) return;
  const auto tube = *editor_->Tube();
  const std::string name = end_names_[chosen];
  Report(editor_->Document().Edit("join " + editor_->GetPatient().tubes[tube].name, [&](anatomy::Patient& p) {
    return anatomy::JoinTubeEnd(p, tube, end, name);
  }));
  Announce();
}

void PatientEditorPanel::RefreshRegions() {
  region_choices_ = editor_->Regions();
  std::vector<Glib::ustring> names;
  guint chosen = 0;
  for (std::size_t i = 0; i < region_choices_.size(); ++i) {
    names.push_back(Spoken(region_choices_[i].organ) + ": " + Spoken(region_choices_[i].region));
    if (region_choices_[i] == editor_->region) chosen = static_cast<guint>(i);
  }
  SetNames(regions_, names, chosen);
  (editor_->is_erasing ? erase_ : add_).set_active(true);
  brush_.set_value(kMmPerMetre * editor_->brush_radius);
}

void PatientEditorPanel::RefreshTubes() {
  Clear(tubes_);
  const auto& tubes = editor_->GetPatient().tubes;
  for (std::size_t i = 0; i < tubes.size(); ++i) {
    auto* row = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::HORIZONTAL);
    row->set_spacing(8);
    row->append(*MakeSwatch(view::TubeColour(tubes[i])));
    row->append(*MakeLabel(Spoken(tubes[i].name), "name"));
    if (!tubes[i].is_seen) {
      auto* placed = MakeLabel("placed", "fine");
      placed->set_hexpand(false);
      placed->set_tooltip_text("The images do not show it: it was placed by landmarks");
      row->append(*placed);
    }
    tubes_.append(*row);
    if (editor_->Tube() == i) tubes_.select_row(*tubes_.get_row_at_index(static_cast<int>(i)));
  }
  missing_names_ = anatomy::FindMissingTubes(editor_->GetPatient());
  std::vector<Glib::ustring> names;
  for (const std::string& name : missing_names_) names.push_back(Spoken(name));
  if (names.empty()) names.push_back("no usual duct is missing");
  SetNames(missing_, names, 0);
  add_tube_.set_sensitive(!missing_names_.empty());
  missing_.set_sensitive(!missing_names_.empty());
  RefreshEnds();
}

void PatientEditorPanel::RefreshEnds() {
  const bool has_tube = editor_->Tube().has_value();
  for (Gtk::Widget* widget : {static_cast<Gtk::Widget*>(&from_), static_cast<Gtk::Widget*>(&to_),
                              static_cast<Gtk::Widget*>(&remove_)})
    widget->set_sensitive(has_tube);
  insert_.set_sensitive(editor_->TubePoint().has_value());
  delete_.set_sensitive(editor_->TubePoint().has_value());
  reach_.set_value(kMmPerMetre * editor_->reach);
  if (!has_tube) {
    tube_facts_.set_text("Choose a duct here or in the picture.");
    return;
  }
  const anatomy::Patient& patient = editor_->GetPatient();
  const anatomy::Tube& tube = patient.tubes[*editor_->Tube()];
  end_names_ = {""};
  std::vector<Glib::ustring> names = {"leaves the scene"};
  const auto add = [&](const std::string& name) {
    if (name == tube.name) return;
    end_names_.push_back(name);
    names.push_back(Spoken(name));
  };
  for (const anatomy::Organ& organ : patient.organs) add(organ.name);
  for (const anatomy::Tube& other : patient.tubes) add(other.name);
  const auto index_of = [&](const std::string& name) {
    return static_cast<guint>(std::find(end_names_.begin(), end_names_.end(), name) - end_names_.begin());
  };
  SetNames(from_, names, index_of(tube.from));
  SetNames(to_, names, index_of(tube.to));
  char text[160];
  const auto [thin, thick] = std::minmax_element(tube.line.radii.begin(), tube.line.radii.end());
  std::snprintf(text, sizeof(text), "%.1f mm long, radius %.2f to %.2f mm, %zu points",
                kMmPerMetre * geometry::CalcLength(tube.line), kMmPerMetre * *thin, kMmPerMetre * *thick,
                tube.line.points.size());
  tube_facts_.set_text(text);
}

void PatientEditorPanel::RefreshLandmarks() {
  Clear(landmarks_);
  const auto& landmarks = editor_->GetPatient().landmarks;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    auto* row = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::HORIZONTAL);
    row->append(*MakeLabel(Spoken(landmarks[i].name), "name"));
    // as the files give it
    const auto& p = landmarks[i].position;
    char text[96];
    std::snprintf(text, sizeof(text), "%.1f  %.1f  %.1f", kMmPerMetre * p.x, -kMmPerMetre * p.z,
                  kMmPerMetre * p.y);
    auto* place = MakeLabel(text, "fine");
    place->set_hexpand(false);
    place->set_tooltip_text("LPS [mm]");
    row->append(*place);
    landmarks_.append(*row);
    if (editor_->Landmark() == i) landmarks_.select_row(*landmarks_.get_row_at_index(static_cast<int>(i)));
  }
}

void PatientEditorPanel::Refresh() {
  if (editor_ == nullptr) return;
  is_showing_ = true;
  tools_[static_cast<std::size_t>(editor_->tool)]->set_active(true);
  paint_card_->set_visible(editor_->tool == EditorTool::kPaint);
  tube_card_->set_visible(editor_->tool == EditorTool::kTubes);
  landmark_card_->set_visible(editor_->tool == EditorTool::kLandmarks);
  colours_.set_active(editor_->look.has_regions);
  edges_.set_active(editor_->look.has_edges);
  strands_.set_active(editor_->look.has_attachments);
  opacity_.set_value(editor_->look.liver_opacity);
  if (editor_->tool == EditorTool::kPaint) RefreshRegions();
  if (editor_->tool == EditorTool::kTubes) RefreshTubes();
  if (editor_->tool == EditorTool::kLandmarks) RefreshLandmarks();
  is_showing_ = false;
}

void PatientEditorPanel::ShowFindings(const anatomy::LintReport& report) {
  Clear(findings_);
  wheres_.clear();
  for (const anatomy::LintFinding& finding : report.findings) {
    auto* box = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
    box->append(*MakeLabel(finding.code + "  " + finding.where, "hand"));
    box->append(*MakeLabel(finding.text, "fine", true));
    box->set_tooltip_text("Click to look there");
    findings_.append(*box);
    wheres_.push_back(finding.where);
  }
  findings_title_.set_text(report.findings.empty()
                               ? "No findings: this patient can be operated on."
                               : std::to_string(report.findings.size()) +
                                     (report.findings.size() == 1 ? " finding" : " findings") +
                                     "; click one to look at it");
}

}  // namespace trocar::app
