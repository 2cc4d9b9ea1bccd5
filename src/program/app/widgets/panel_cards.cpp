// SPDX-License-Identifier: Apache-2.0
#include "panel_cards.h"

#include <string_view>

#include "trocar/gui/labels.h"
#include "trocar/host/translate.h"

namespace trocar::app {
namespace {

/// Columns of a slider's line [pixels].
constexpr int kNameWidth = 104, kValueWidth = 72;
/// Positions of a slider; finer than its pixels.
constexpr double kSliderStep = 1.0 / 400;
constexpr const char* kSolverGroup = "Solver";  // of SettingRows(): the solver is chosen there, too

Gtk::Label* MakeName(const std::string& text, int width) {
  auto* name = Gtk::make_managed<Gtk::Label>(text);
  gui::SetStyle(*name, "name");
  name->set_size_request(width, -1);
  return name;
}

void SetNames(Gtk::DropDown& list, const std::vector<std::string>& names) {
  list.set_model(Gtk::StringList::create({names.begin(), names.end()}));
}

}  // namespace

// the task

TaskCard::TaskCard() : gui::Card("Task") {
  set_visible(false);
  gui::SetStyle(name_, "name");
  for (Gtk::Label* label : {&about_, &next_, &errors_}) gui::SetStyle(*label, "fine");
  for (Gtk::Label* label : {&name_, &about_, &next_, &errors_}) gui::Wrap(*label);
  append(name_);
  append(about_);
  time_ = &AddLine("Time", "From the first movement; the task's limit after the stroke [min:s]");
  progress_ = &AddLine("Goals", "Done, of all");
  score_ = &AddLine("Score", "Training feedback, not certified assessment");
  append(next_);
  append(errors_);
}

void TaskCard::ShowScene(const presenter::ScenePage& page) {
  set_visible(page.has_task);
  name_.set_text(page.task_name);
  about_.set_text(page.task_about);
}

void TaskCard::Show(const presenter::TaskReadOut& page) {
  gui::SetText(*time_, page.time);
  gui::SetText(*progress_, page.progress);
  gui::SetText(*score_, page.score);
  gui::SetText(next_, page.next);
  gui::SetText(errors_, page.errors);
}

// hands

HandsCard::HandsCard() : gui::Card("Force on the instruments") {
  set_tooltip_text(host::Translate(
      "Force of the tissue on each instrument. The marks show where it becomes a warning and where tissue "
      "may tear: "
      "gallbladder 8 and 12 N, liver 3 and 6 N."));
  for (Row& row : rows_) {
    auto* words = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
    words->set_hexpand(true);
    words->set_valign(Gtk::Align::CENTER);
    gui::SetStyle(row.name, "hand");
    gui::SetStyle(row.contact, "fine");
    row.contact.set_text(host::Translate("free"));
    gui::SetStyle(row.force, "force", Gtk::Align::END);
    row.force.set_width_chars(7);
    row.force.set_text(presenter::FormatForce(0));
    words->append(row.name);
    words->append(row.contact);
    append(gui::MakeRow(0, {words, &row.force}));
    append(row.bar);
    if (&row != &rows_.back()) row.bar.set_margin_bottom(6);
  }
  rows_[instrument::kLeft].name.set_text(host::Translate("1  Left hand"));
  rows_[instrument::kRight].name.set_text(host::Translate("2  Right hand"));
}

void HandsCard::Show(const presenter::HandPages& page) {
  for (std::size_t hand = 0; hand < rows_.size(); ++hand) {
    Row& row = rows_[hand];
    gui::SetText(row.force, page[hand].force);
    gui::SetClass(row.force, "warning", page[hand].level == presenter::ForceLevel::kWarning);
    gui::SetClass(row.force, "danger", page[hand].level == presenter::ForceLevel::kDanger);
    gui::SetText(row.contact, (page[hand].is_chosen ? "▶ " : "") + page[hand].contact);
    row.bar.Show(page[hand].force_n, page[hand].thresholds);
    gui::SetClass(row.name, "chosen", page[hand].is_chosen);
  }
}

void HandsCard::ShowNames(const presenter::OperationPage& page) {
  for (std::size_t hand = 0; hand < rows_.size(); ++hand) gui::SetText(rows_[hand].name, page.hands[hand]);
}

// the operation

OperationCard::OperationCard(presenter::PanelPresenter& presenter) : gui::Card("Operation") {
  for (const instrument::Hand hand : {instrument::kLeft, instrument::kRight}) AddTray(presenter, hand);
  clips_ = &AddLine("Clips left", "In the clip applier that is in use");
  blood_ = &AddLine("Blood", "Lost so far, and what of it lies in the abdomen [mL]");
  bile_ = &AddLine("Bile", "Lost so far, and what of it lies in the abdomen [mL]");
  stones_ = &AddLine("Stones", "Out of the gallbladder through a hole in its wall");
  assistant_.set_model(
      Gtk::StringList::create({host::Translate("wait"), host::Translate("retract the fundus"),
                               host::Translate("relax"), host::Translate("release")}));
  assistant_.set_tooltip_text(
      host::Translate("Command to the assistant with the third grasper (U: the next one)"));
  assistant_.property_selected().signal_changed().connect([this, &presenter] {
    if (!is_showing_) presenter.CommandAssistant(assistant_.get_selected());
  });
  assistant_does_ = &AddLine("Assistant", "What the third hand does");
  append(assistant_);
}

void OperationCard::AddTray(presenter::PanelPresenter& presenter, instrument::Hand hand) {
  Gtk::DropDown& tray = trays_[static_cast<std::size_t>(hand)];
  tray.set_hexpand(true);
  tray.set_tooltip_text(
      host::Translate("Exchanges the tool through this trocar (X next, Z previous, for the chosen hand)"));
  tray.property_selected().signal_changed().connect([this, &presenter, &tray, hand] {
    if (!is_showing_) presenter.ChooseTool(hand, tray.get_selected());
  });
  append(gui::MakeRow(
      0, {MakeName(hand == instrument::kLeft ? host::Translate("Left tool") : host::Translate("Right tool"),
                   kNameWidth),
          &tray}));
}

void OperationCard::ShowScene(const presenter::ScenePage& page) {
  set_visible(page.has_tools);
  is_showing_ = true;
  for (std::size_t hand = 0; hand < trays_.size(); ++hand) SetNames(trays_[hand], page.trays[hand]);
  is_showing_ = false;
}

void OperationCard::Show(const presenter::OperationPage& page) {
  is_showing_ = true;
  for (std::size_t hand = 0; hand < trays_.size(); ++hand) {
    const auto asked = static_cast<guint>(page.asked[hand]);
    if (trays_[hand].get_selected() != asked) trays_[hand].set_selected(asked);
  }
  gui::SetText(*clips_, page.clips);
  gui::SetText(*blood_, page.blood);
  gui::SetText(*bile_, page.bile);
  gui::SetText(*stones_, page.stones);
  const auto command = static_cast<guint>(page.command);
  if (assistant_.get_selected() != command) assistant_.set_selected(command);
  gui::SetText(*assistant_does_, page.assistant);
  assistant_.set_visible(page.has_assistant);
  is_showing_ = false;
}

// settings

SettingsCards::SettingsCards(presenter::PanelPresenter& presenter) {
  std::string_view group;
  for (std::size_t i = 0; i < presenter::SettingRows().size(); ++i) {
    if (presenter::SettingRows()[i].group != group) {
      group = presenter::SettingRows()[i].group;
      AddCard(presenter, presenter::SettingRows()[i].group);
    }
    AddRow(presenter, i);
  }
}

void SettingsCards::AddCard(presenter::PanelPresenter& presenter, const char* group) {
  const bool is_first = cards_.empty();
  cards_.push_back(std::make_unique<gui::Card>(group));
  if (is_first) {
    defaults_.add_css_class("small");
    defaults_.set_tooltip_text(host::Translate("Puts every slider back to what the scene says"));
    defaults_.set_focus_on_click(false);
    defaults_.signal_clicked().connect([&presenter] { presenter.RestoreSettings(); });
    cards_.back()->SetTitleEnd(defaults_);
  }
  if (group == std::string_view(kSolverGroup)) AddSolver(presenter);
}

void SettingsCards::AddSolver(presenter::PanelPresenter& presenter) {
  std::vector<std::string> names;
  for (const presenter::SolverChoice& choice : presenter::SolverChoices())
    names.push_back(host::Translate(choice.label));
  SetNames(solver_, names);
  solver_.set_tooltip_text(
      host::Translate("Chebyshev: fast, the one to operate with. Relaxation: the paper's reference."));
  solver_.property_selected().signal_changed().connect([this, &presenter] {
    if (!is_showing_) presenter.ChooseSolver(solver_.get_selected());
  });
  cards_.back()->append(solver_);
}

void SettingsCards::AddRow(presenter::PanelPresenter& presenter, std::size_t place) {
  const presenter::SettingRow& setting = presenter::SettingRows()[place];
  rows_.push_back(std::make_unique<Row>());
  Row& row = *rows_.back();
  gui::SetStyle(row.value, "value", Gtk::Align::END);
  row.value.set_size_request(kValueWidth, -1);
  row.slider.set_adjustment(Gtk::Adjustment::create(0, 0, 1, kSliderStep, 10 * kSliderStep));
  row.slider.set_draw_value(false);
  row.slider.set_hexpand(true);
  row.slider.set_focus_on_click(false);
  row.slider.signal_value_changed().connect([this, &presenter, &row, place] {
    if (!is_showing_) presenter.SetSetting(place, row.slider.get_value());
  });
  Gtk::Box& line =
      gui::MakeRow(0, {MakeName(host::Translate(setting.label), kNameWidth), &row.slider, &row.value});
  line.set_tooltip_text(host::Translate(setting.tooltip));
  cards_.back()->append(line);
}

void SettingsCards::Show(const presenter::SettingsPage& page) {
  is_showing_ = true;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    rows_[i]->slider.set_value(page.rows[i].position);
    ShowValue(i, page.rows[i].value);
  }
  solver_.set_selected(static_cast<guint>(page.solver));
  is_showing_ = false;
}

void SettingsCards::ShowValue(std::size_t row, const std::string& value) {
  gui::SetText(rows_[row]->value, value);
}

// measures

MeasuresCard::MeasuresCard() : gui::Card("Measured") {
  residual_ = &AddLine(
      "Residual", "Largest force out of balance on any free node, as part of the largest force at work [-]");
  iterations_ = &AddLine("Iterations used", "Of the solver, in the last tick");
  tick_ = &AddLine("Tick, median / p99", "Time to compute one tick, over the last second [ms]");
  late_ = &AddLine(
      "Late ticks",
      "Ticks that began more than half a tick late since the start; \"real-time\" when the system lets the "
      "simulation run before everything else (trocar doctor)");
  pictures_ = &AddLine("Pictures a second", "Frames drawn over the last second [1/s]");
  time_ = &AddLine("Simulated time", "Since the last reset [min:s]");
}

void MeasuresCard::Show(const presenter::MeasuresPage& page) {
  gui::SetText(*residual_, page.residual);
  gui::SetText(*iterations_, page.iterations);
  gui::SetText(*tick_, page.tick);
  gui::SetText(*late_, page.late);
  gui::SetText(*pictures_, page.pictures);
  gui::SetText(*time_, page.time);
}

// the patient

PatientCard::PatientCard() : gui::Card("Patient") {
  gui::SetStyle(name_, "value");
  gui::SetStyle(organs_, "name");
  gui::SetStyle(source_, "fine");
  for (Gtk::Label* label : {&name_, &organs_, &source_}) {
    gui::Wrap(*label);
    label->set_wrap(false);
    label->set_ellipsize(Pango::EllipsizeMode::END);
    append(*label);
  }
}

void PatientCard::Show(const presenter::ScenePage& page) {
  set_visible(page.has_patient);
  name_.set_text(page.patient_name);
  organs_.set_text(page.patient_organs);
  source_.set_text(page.patient_source);
  set_tooltip_text(page.patient_name + "\n" + page.patient_organs + "\n" + page.patient_source);
}

// stages

StagesCard::StagesCard() : gui::Card("Stages of a tick [ms]", 1) {
  for (std::size_t stage = 0; stage < stages_.size(); ++stage) {
    auto* name = Gtk::make_managed<Gtk::Label>(presenter::StageLabel(static_cast<simulation::Stage>(stage)));
    gui::SetStyle(*name, "fine");
    name->set_hexpand(true);
    gui::SetStyle(stages_[stage], "stage", Gtk::Align::END);
    stages_[stage].set_text("—");
    append(gui::MakeRow(0, {name, &stages_[stage]}));
  }
}

void StagesCard::Show(const presenter::MeasuresPage& page) {
  for (std::size_t stage = 0; stage < stages_.size(); ++stage)
    gui::SetText(stages_[stage], page.stages[stage]);
}

}  // namespace trocar::app
