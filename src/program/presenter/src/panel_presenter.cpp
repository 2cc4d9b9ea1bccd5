// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/panel_presenter.h"

#include <algorithm>
#include <cstdio>

#include "trocar/host/translate.h"
#include "trocar/patient/patient.h"

namespace trocar::presenter {
namespace {

constexpr const char* kNothing = "—";

}  // namespace

ScenePage MakeScenePage(const scene::Scene& scene) {
  ScenePage page;
  page.has_task = scene.task.has_value();
  if (page.has_task) {
    page.task_name = host::Translate(scene.task->name);
    page.task_about = host::Translate(scene.task->about);
  }
  for (std::size_t hand = 0; hand < page.trays.size(); ++hand) {
    for (const instrument::Tool& tool : scene.instruments[hand].tray) {
      page.trays[hand].push_back(ToolName(tool));
    }
    page.has_tools = page.has_tools || page.trays[hand].size() > 1;
  }
  const patient::Patient& patient = scene.patient;
  page.has_patient = scene.HasPatient();
  page.patient_name = patient.name;
  page.patient_source = patient.provenance;
  for (std::size_t organ = 0; organ < patient.organs.size(); ++organ) {
    page.patient_organs +=
        (organ == 0 ? "" : "\n") +
        host::TranslateWith("{1}: {2} triangles", {OrganLabel(patient, static_cast<std::int32_t>(organ)),
                                                   FormatCount(patient.organs[organ].mesh.triangles.size())});
  }
  if (!patient.tubes.empty())
    page.patient_organs +=
        "\n" + host::TranslateWith("{1} ducts and arteries", {std::to_string(patient.tubes.size())});
  return page;
}

HandPages MakeHandPages(const scene::Scene& scene, const simulation::Snapshot& snapshot,
                        device::Channel chosen) {
  HandPages pages;
  for (std::size_t hand = 0; hand < pages.size(); ++hand) {
    const simulation::InstrumentSnapshot& instrument = snapshot.instruments[hand];
    HandPage& page = pages[hand];
    page.force_n = math::Norm(instrument.force);
    page.force = FormatForce(page.force_n);
    page.thresholds = FindForceThresholds(scene.patient.RoleOfOrgan(instrument.organ));
    page.level = JudgeForce(page.force_n, page.thresholds);
    page.contact = DescribeContact(instrument, scene.patient);
    // said in words, too: colours are not seen by everybody
    if (page.level == ForceLevel::kWarning) page.contact += host::Translate(": strong");
    if (page.level == ForceLevel::kDanger) page.contact += host::Translate(": may tear");
    page.is_chosen = static_cast<std::size_t>(chosen) == hand;
  }
  return pages;
}

OperationPage MakeOperationPage(const scene::Scene& scene, const scene::Input& input,
                                const simulation::Snapshot& snapshot) {
  OperationPage page;
  const auto& operation = snapshot.operation;
  for (std::size_t hand = 0; hand < page.hands.size(); ++hand) {
    page.asked[hand] = input.controls[hand].tool;
    const std::size_t place = operation.tools[hand];
    const auto& tray = scene.instruments[hand].tray;
    if (place < tray.size() && tray[place].clips > 0)
      page.clips +=
          (page.clips.empty() ? "" : host::Translate(" and ")) + std::to_string(operation.clips_left[hand]);
    page.hands[hand] =
        hand == instrument::kLeft
            ? host::TranslateWith("1  Left {1}", {ToolLabel(scene, snapshot, instrument::kLeft)})
            : host::TranslateWith("2  Right {1}", {ToolLabel(scene, snapshot, instrument::kRight)});
  }
  if (page.clips.empty()) page.clips = kNothing;
  page.blood = DescribeFluid(operation.flow.ledger, surgery::Fluid::kBlood);
  page.bile = DescribeFluid(operation.flow.ledger, surgery::Fluid::kBile);
  page.stones = DescribeStones(operation.stones);
  page.has_assistant = operation.assistant.is_there;
  page.command = input.assistant;
  page.assistant = page.has_assistant ? DescribeAssistant(input.assistant, operation.assistant.is_holding)
                                      : host::Translate("none in this scene");
  return page;
}

SettingsPage MakeSettingsPage(const scene::LiveSettings& settings) {
  SettingsPage page;
  for (const SettingRow& row : SettingRows())
    page.rows.push_back({PositionInForm(row, settings), FormatSetting(row, settings)});
  for (std::size_t i = 0; i < SolverChoices().size(); ++i) {
    if (SolverChoices()[i].kind == settings.solver.kind) page.solver = i;
  }
  return page;
}

MeasuresPage MakeMeasuresPage(const simulation::Snapshot& snapshot,
                              const session::RunnerStatistics& statistics, const StageMeter& stages,
                              double picture_rate) {
  MeasuresPage page;
  page.residual = FormatResidual(snapshot.residual);
  page.iterations = std::to_string(snapshot.iterations);
  page.tick = FormatMilliseconds(statistics.tick_median) + " / " + FormatMilliseconds(statistics.tick_p99);
  page.late =
      host::TranslateWith("{1} of {2}{3}", {FormatCount(statistics.late_ticks), FormatCount(statistics.ticks),
                                            (statistics.is_real_time ? host::Translate(", real-time") : "")});
  page.pictures = std::to_string(static_cast<int>(picture_rate + 0.5));
  page.time = FormatTime(snapshot.time);
  for (std::size_t stage = 0; stage < page.stages.size(); ++stage) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3f", 1e3 * stages.Seconds()[stage]);
    page.stages[stage] = host::LocalNumber(text);
  }
  return page;
}

// what is shown

void PanelPresenter::UseControl(SessionControl* control) {
  control_ = control;
  if (control_ == nullptr) return;
  screen_.ShowScene(MakeScenePage(control_->GetScene()));
  ShowSettings();
}

void PanelPresenter::ShowState(const simulation::Snapshot& snapshot) {
  if (control_ == nullptr) return;
  const scene::Scene& scene = control_->GetScene();
  screen_.ShowHands(MakeHandPages(scene, snapshot,
                                  control_->IsDemonstration() ? device::kLaparoscope : control_->GetHand()));
  screen_.ShowOperation(MakeOperationPage(scene, control_->GetInput(), snapshot));
  if (scene.task) screen_.ShowTask(DescribeTask(*scene.task, snapshot.task));
}

void PanelPresenter::ShowTimes(const simulation::Snapshot& snapshot,
                               const session::RunnerStatistics& statistics, const StageMeter& stages,
                               double picture_rate) {
  screen_.ShowMeasures(MakeMeasuresPage(snapshot, statistics, stages, picture_rate));
}

void PanelPresenter::ShowSettings() {
  screen_.ShowSettings(MakeSettingsPage(control_->GetSettings()));
}

// what a person does

void PanelPresenter::ChooseTool(instrument::Hand hand, std::size_t place) {
  if (control_ != nullptr) control_->ChooseTool(hand, place);
}

void PanelPresenter::CommandAssistant(std::size_t command) {
  constexpr std::size_t kCommands = 4;
  if (control_ != nullptr && command < kCommands)
    control_->CommandAssistant(static_cast<scene::AssistantCommand>(command));
}

void PanelPresenter::SetSetting(std::size_t row, double position) {
  if (control_ == nullptr || row >= SettingRows().size()) return;
  scene::LiveSettings settings = control_->GetSettings();
  SetFromForm(SettingRows()[row], position, settings);
  control_->SetSettings(settings);
  screen_.ShowSetting(row, FormatSetting(SettingRows()[row], control_->GetSettings()));
}

void PanelPresenter::ChooseSolver(std::size_t choice) {
  if (control_ == nullptr || choice >= SolverChoices().size()) return;
  scene::LiveSettings settings = control_->GetSettings();
  settings.solver.kind = SolverChoices()[choice].kind;
  control_->SetSettings(settings);
}

void PanelPresenter::RestoreSettings() {
  if (control_ == nullptr) return;
  control_->RestoreSettings();
  ShowSettings();
}

}  // namespace trocar::presenter
