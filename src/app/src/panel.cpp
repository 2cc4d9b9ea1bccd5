// SPDX-License-Identifier: Apache-2.0
#include "panel.h"

#include <algorithm>
#include <string_view>

namespace trocar::app {
namespace {

constexpr int kPanelWidth = 340;
/// Columns of a slider's line [pixels].
constexpr int kNameWidth = 104, kValueWidth = 72;
/// Positions of a slider; finer than its pixels.
constexpr double kSliderStep = 1.0 / 400;

void SetLabel(Gtk::Label& label, const char* style, Gtk::Align align = Gtk::Align::START) {
  label.add_css_class(style);
  label.set_halign(align);
  label.set_xalign(align == Gtk::Align::END ? 1.0f : 0.0f);
}

/// A label whose text changes often: no work where it does not.
void SetText(Gtk::Label& label, const std::string& text) {
  if (label.get_text().raw() != text) label.set_text(text);
}

void SetLevel(Gtk::Widget& widget, ForceLevel level) {
  const auto set = [&widget](const char* style, bool is_set) {
    if (is_set == widget.has_css_class(style)) return;
    if (is_set) {
      widget.add_css_class(style);
    } else {
      widget.remove_css_class(style);
    }
  };
  set("warning", level == ForceLevel::kWarning);
  set("danger", level == ForceLevel::kDanger);
}

}  // namespace

Panel::Panel() {
  set_policy(Gtk::PolicyType::NEVER, Gtk::PolicyType::AUTOMATIC);
  set_size_request(kPanelWidth, -1);
  set_hexpand(false);
  add_css_class("panel");
  cards_.set_spacing(7);
  cards_.set_margin(8);
  set_child(cards_);
  AddTask();
  AddHands();
  AddOperation();
  AddSettings();
  AddMeasures();
  AddPatient();
  AddStages();
}

void Panel::AddTask() {
  task_card_ = &AddCard("Task");
  task_card_->set_visible(false);
  SetLabel(task_name_, "name");
  for (Gtk::Label* label : {&task_about_, &task_next_, &task_errors_}) SetLabel(*label, "fine");
  for (Gtk::Label* label : {&task_name_, &task_about_, &task_next_, &task_errors_}) {
    label->set_wrap(true);
    label->set_max_width_chars(10);
    label->set_hexpand(true);
    label->set_xalign(0);
    label->set_halign(Gtk::Align::FILL);
  }
  task_card_->append(task_name_);
  task_card_->append(task_about_);
  task_time_ =
      &AddLine(*task_card_, "Time", "From the first movement; the task's limit after the stroke [min:s]");
  task_progress_ = &AddLine(*task_card_, "Goals", "Done, of all");
  task_score_ = &AddLine(*task_card_, "Score", "Training feedback, not certified assessment");
  task_card_->append(task_next_);
  task_card_->append(task_errors_);
}

void Panel::ShowTask(const simulation::Snapshot& snapshot) {
  if (control_ == nullptr || !control_->GetScene().task) return;
  const TaskReadOut text = DescribeTask(*control_->GetScene().task, snapshot.task);
  SetText(*task_time_, text.time);
  SetText(*task_progress_, text.progress);
  SetText(*task_score_, text.score);
  SetText(task_next_, text.next);
  SetText(task_errors_, text.errors);
}

void Panel::AddPatient() {
  patient_card_ = &AddCard("Patient");
  SetLabel(patient_name_, "value");
  SetLabel(patient_organs_, "name");
  SetLabel(patient_source_, "fine");
  for (Gtk::Label* label : {&patient_name_, &patient_organs_, &patient_source_}) {
    label->set_ellipsize(Pango::EllipsizeMode::END);
    label->set_max_width_chars(10);
    label->set_hexpand(true);
    label->set_halign(Gtk::Align::FILL);
    patient_card_->append(*label);
  }
}

Gtk::Box& Panel::AddCard(const char* title) {
  auto* card = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  card->add_css_class("card");
  card->set_spacing(2);
  auto* label = Gtk::make_managed<Gtk::Label>(title);
  SetLabel(*label, "card-title");
  card->append(*label);
  cards_.append(*card);
  return *card;
}

Gtk::Label& Panel::AddLine(Gtk::Box& card, const char* name, const char* tooltip) {
  auto* line = Gtk::make_managed<Gtk::Box>();
  auto* label = Gtk::make_managed<Gtk::Label>(name);
  SetLabel(*label, "name");
  label->set_hexpand(true);
  auto* value = Gtk::make_managed<Gtk::Label>("—");
  SetLabel(*value, "value", Gtk::Align::END);
  line->append(*label);
  line->append(*value);
  line->set_tooltip_text(tooltip);
  card.append(*line);
  return *value;
}

void Panel::AddHands() {
  Gtk::Box& card = AddCard("Force on the instruments");
  card.set_tooltip_text(
      "Force of the tissue on each instrument. The marks show where it becomes a warning and where tissue "
      "may tear: "
      "gallbladder 8 and 12 N, liver 3 and 6 N.");
  for (HandRow& row : hands_) {
    auto* line = Gtk::make_managed<Gtk::Box>();
    auto* words = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
    words->set_hexpand(true);
    words->set_valign(Gtk::Align::CENTER);
    SetLabel(row.name, "hand");
    SetLabel(row.contact, "fine");
    row.contact.set_text("free");
    SetLabel(row.force, "force", Gtk::Align::END);
    row.force.set_width_chars(7);
    row.force.set_text("0.0 N");
    words->append(row.name);
    words->append(row.contact);
    line->append(*words);
    line->append(row.force);
    card.append(*line);
    card.append(row.bar);
    if (&row != &hands_.back()) row.bar.set_margin_bottom(6);
  }
  hands_[scene::kLeft].name.set_text("1  Left hand");
  hands_[scene::kRight].name.set_text("2  Right hand");
}

void Panel::AddOperation() {
  operation_card_ = &AddCard("Operation");
  for (int hand = 0; hand < scene::kHandCount; ++hand) {
    auto* line = Gtk::make_managed<Gtk::Box>();
    auto* name = Gtk::make_managed<Gtk::Label>(hand == scene::kLeft ? "Left tool" : "Right tool");
    SetLabel(*name, "name");
    name->set_size_request(kNameWidth, -1);
    Gtk::DropDown& tray = trays_[static_cast<std::size_t>(hand)];
    tray.set_hexpand(true);
    tray.set_tooltip_text("Exchanges the tool through this trocar (X next, Z previous, for the chosen hand)");
    tray.property_selected().signal_changed().connect([this, hand] {
      if (control_ == nullptr || is_showing_) return;
      control_->ChooseTool(static_cast<scene::Hand>(hand),
                           trays_[static_cast<std::size_t>(hand)].get_selected());
    });
    line->append(*name);
    line->append(tray);
    operation_card_->append(*line);
  }
  clips_ = &AddLine(*operation_card_, "Clips left", "In the clip applier that is in use");
  blood_ = &AddLine(*operation_card_, "Blood", "Lost so far, and what of it lies in the abdomen [mL]");
  bile_ = &AddLine(*operation_card_, "Bile", "Lost so far, and what of it lies in the abdomen [mL]");
  stones_ = &AddLine(*operation_card_, "Stones", "Out of the gallbladder through a hole in its wall");
  assistant_.set_model(Gtk::StringList::create({"wait", "retract the fundus", "relax", "release"}));
  assistant_.set_tooltip_text("Command to the assistant with the third grasper (U: the next one)");
  assistant_.property_selected().signal_changed().connect([this] {
    if (control_ == nullptr || is_showing_ || assistant_.get_selected() > 3) return;
    control_->CommandAssistant(static_cast<scene::AssistantCommand>(assistant_.get_selected()));
  });
  assistant_does_ = &AddLine(*operation_card_, "Assistant", "What the third hand does");
  operation_card_->append(assistant_);
}

void Panel::ShowOperation(const simulation::Snapshot& snapshot) {
  if (control_ == nullptr) return;
  const scene::Scene& scene = control_->GetScene();
  const scene::Input& input = control_->GetInput();
  is_showing_ = true;
  std::string clips;
  for (std::size_t hand = 0; hand < trays_.size(); ++hand) {
    // what is wished: the exchange follows when the shaft is free
    const guint wanted = input.controls[hand].tool;
    if (trays_[hand].get_selected() != wanted) trays_[hand].set_selected(wanted);
    const std::size_t place = snapshot.operation.tools[hand];
    const auto& tray = scene.instruments[hand].tray;
    if (place < tray.size() && tray[place].clips > 0) {
      clips += (clips.empty() ? "" : " and ") + std::to_string(snapshot.operation.clips_left[hand]);
    }
    SetText(hands_[hand].name, (hand == scene::kLeft ? "1  Left " : "2  Right ") +
                                   ToolLabel(scene, snapshot, static_cast<scene::Hand>(hand)));
  }
  SetText(*clips_, clips.empty() ? "—" : clips);
  SetText(*blood_, DescribeFluid(snapshot.operation.fluids, surgery::Fluid::kBlood));
  SetText(*bile_, DescribeFluid(snapshot.operation.fluids, surgery::Fluid::kBile));
  SetText(*stones_, DescribeStones(snapshot.operation.stones));
  const auto command = static_cast<guint>(input.assistant);
  if (assistant_.get_selected() != command) assistant_.set_selected(command);
  SetText(*assistant_does_, snapshot.operation.has_assistant
                                ? DescribeAssistant(input.assistant, snapshot.operation.is_assistant_holding)
                                : "none in this scene");
  assistant_.set_visible(snapshot.operation.has_assistant);
  is_showing_ = false;
}

void Panel::AddSettings() {
  std::string_view group;
  Gtk::Box* card = nullptr;
  for (const SettingRow& row : SettingRows()) {
    if (row.group != group) {
      group = row.group;
      card = &AddCard(row.group);
      if (sliders_.empty()) AddDefaults(*card);
      if (group == "Solver") {
        std::vector<Glib::ustring> names;
        for (const SolverChoice& choice : SolverChoices()) names.emplace_back(choice.label);
        solver_.set_model(Gtk::StringList::create(names));
        solver_.set_tooltip_text(
            "Chebyshev: fast, the one to operate with. Relaxation: the paper's reference.");
        solver_.property_selected().signal_changed().connect([this] {
          if (control_ == nullptr || is_showing_ || solver_.get_selected() >= SolverChoices().size()) return;
          scene::LiveSettings settings = control_->GetSettings();
          settings.solver.kind = SolverChoices()[solver_.get_selected()].kind;
          control_->SetSettings(settings);
        });
        card->append(solver_);
      }
    }
    auto widgets = std::make_unique<SliderRow>();
    auto* line = Gtk::make_managed<Gtk::Box>();
    auto* name = Gtk::make_managed<Gtk::Label>(row.label);
    SetLabel(*name, "name");
    name->set_size_request(kNameWidth, -1);
    SetLabel(widgets->value, "value", Gtk::Align::END);
    widgets->value.set_size_request(kValueWidth, -1);
    Gtk::Scale& slider = widgets->slider;
    slider.set_adjustment(Gtk::Adjustment::create(0, 0, 1, kSliderStep, 10 * kSliderStep));
    slider.set_draw_value(false);
    slider.set_hexpand(true);
    slider.set_focus_on_click(false);
    line->append(*name);
    line->append(slider);
    line->append(widgets->value);
    line->set_tooltip_text(row.tooltip);
    SliderRow* shown = widgets.get();
    slider.signal_value_changed().connect([this, &row, shown] {
      if (control_ == nullptr || is_showing_) return;
      scene::LiveSettings settings = control_->GetSettings();
      SetFromForm(row, shown->slider.get_value(), settings);
      control_->SetSettings(settings);
      SetText(shown->value, FormatSetting(row, control_->GetSettings()));
    });
    card->append(*line);
    sliders_.push_back(std::move(widgets));
  }
}

void Panel::AddDefaults(Gtk::Box& card) {
  // beside the title of the first card
  auto* title = card.get_first_child();
  auto* line = Gtk::make_managed<Gtk::Box>();
  title->reference();
  card.remove(*title);
  line->append(*title);
  title->unreference();
  title->set_hexpand(true);
  defaults_.add_css_class("small");
  defaults_.set_tooltip_text("Puts every slider back to what the scene says");
  defaults_.set_focus_on_click(false);
  defaults_.signal_clicked().connect([this] {
    if (control_ == nullptr) return;
    control_->RestoreSettings();
    ShowSettings();
  });
  line->append(defaults_);
  card.append(*line);
}

void Panel::AddMeasures() {
  Gtk::Box& card = AddCard("Measured");
  residual_ =
      &AddLine(card, "Residual",
               "Largest force out of balance on any free node, as part of the largest force at work [-]");
  iterations_ = &AddLine(card, "Iterations used", "Of the solver, in the last tick");
  tick_ = &AddLine(card, "Tick, median / p99", "Time to compute one tick, over the last second [ms]");
  late_ = &AddLine(
      card, "Late ticks",
      "Ticks that began more than half a tick late since the start; \"real-time\" when the system lets the "
      "simulation run before everything else (trocar doctor)");
  frames_ = &AddLine(card, "Pictures a second", "Frames drawn over the last second [1/s]");
  time_ = &AddLine(card, "Simulated time", "Since the last reset [min:s]");
}

void Panel::AddStages() {
  Gtk::Box& table = AddCard("Stages of a tick [ms]");
  table.set_spacing(1);
  for (int stage = 0; stage < simulation::kStageCount; ++stage) {
    auto* line = Gtk::make_managed<Gtk::Box>();
    auto* name = Gtk::make_managed<Gtk::Label>(StageLabel(static_cast<simulation::Stage>(stage)));
    SetLabel(*name, "fine");
    name->set_hexpand(true);
    SetLabel(stages_[stage], "stage", Gtk::Align::END);
    stages_[stage].set_text("—");
    line->append(*name);
    line->append(stages_[stage]);
    table.append(*line);
  }
}

void Panel::SetControl(SessionControl* control) {
  control_ = control;
  if (control == nullptr) return;
  bool has_choice = false;
  is_showing_ = true;
  for (std::size_t hand = 0; hand < trays_.size(); ++hand) {
    std::vector<Glib::ustring> names;
    for (const instrument::Tool& tool : control->GetScene().instruments[hand].tray) {
      std::string name = tool.name;
      std::replace(name.begin(), name.end(), '_', ' ');
      names.emplace_back(name);
    }
    has_choice = has_choice || names.size() > 1;
    trays_[hand].set_model(Gtk::StringList::create(names));
  }
  is_showing_ = false;
  operation_card_->set_visible(has_choice);
  const auto& task = control->GetScene().task;
  task_card_->set_visible(task.has_value());
  patient_card_->set_visible(control->GetScene().HasPatient());
  if (task) {
    task_name_.set_text(task->name);
    task_about_.set_text(task->about);
  }
  const anatomy::Patient& patient = control->GetScene().patient;
  patient_name_.set_text(patient.name);
  std::string organs;
  for (std::size_t organ = 0; organ < patient.organs.size(); ++organ) {
    organs += (organ == 0 ? "" : "\n") + OrganLabel(patient, static_cast<std::int32_t>(organ)) + ": " +
              FormatCount(patient.organs[organ].mesh.triangles.size()) + " triangles";
  }
  if (!patient.tubes.empty()) organs += "\n" + std::to_string(patient.tubes.size()) + " ducts and arteries";
  patient_organs_.set_text(organs);
  patient_source_.set_text(patient.provenance);
  patient_card_->set_tooltip_text(patient.name + "\n" + organs + "\n" + patient.provenance);
  ShowSettings();
}

void Panel::ShowSettings() {
  if (control_ == nullptr) return;
  is_showing_ = true;
  const scene::LiveSettings& settings = control_->GetSettings();
  for (std::size_t i = 0; i < sliders_.size(); ++i) {
    const SettingRow& row = SettingRows()[i];
    sliders_[i]->slider.set_value(PositionInForm(row, settings));
    SetText(sliders_[i]->value, FormatSetting(row, settings));
  }
  for (std::size_t i = 0; i < SolverChoices().size(); ++i)
    if (SolverChoices()[i].kind == settings.solver.kind) solver_.set_selected(static_cast<guint>(i));
  is_showing_ = false;
}

void Panel::ShowForces(const simulation::Snapshot& snapshot) {
  if (control_ == nullptr) return;
  const anatomy::Patient& patient = control_->GetScene().patient;
  for (int hand = 0; hand < scene::kHandCount; ++hand) {
    HandRow& row = hands_[hand];
    const simulation::InstrumentSnapshot& instrument = snapshot.instruments[hand];
    const double force = math::Norm(instrument.force);
    const ForceThresholds thresholds = FindForceThresholds(patient.RoleOfOrgan(instrument.organ));
    SetText(row.force, FormatForce(force));
    SetLevel(row.force, JudgeForce(force, thresholds));
    SetText(row.contact, DescribeContact(instrument, patient));
    row.bar.Show(force, thresholds);
    const bool is_chosen = control_->GetHand() == hand && !control_->IsDemonstration();
    if (is_chosen != row.name.has_css_class("chosen")) {
      if (is_chosen) {
        row.name.add_css_class("chosen");
      } else {
        row.name.remove_css_class("chosen");
      }
    }
  }
}

void Panel::ShowTimes(const simulation::Snapshot& snapshot, const session::RunnerStatistics& statistics,
                      const StageMeter& stages, double frame_rate) {
  SetText(*residual_, FormatResidual(snapshot.residual));
  SetText(*iterations_, std::to_string(snapshot.iterations));
  SetText(*tick_,
          FormatMilliseconds(statistics.tick_median) + " / " + FormatMilliseconds(statistics.tick_p99));
  SetText(*late_, FormatCount(statistics.late_ticks) + " of " + FormatCount(statistics.ticks) +
                      (statistics.is_real_time ? ", real-time" : ""));
  SetText(*frames_, std::to_string(static_cast<int>(frame_rate + 0.5)));
  SetText(*time_, FormatTime(snapshot.time));
  for (int stage = 0; stage < simulation::kStageCount; ++stage) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3f", 1e3 * stages.Seconds()[stage]);
    SetText(stages_[stage], text);
  }
}

}  // namespace trocar::app
