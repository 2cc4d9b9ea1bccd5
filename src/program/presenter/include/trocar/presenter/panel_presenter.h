// SPDX-License-Identifier: Apache-2.0
/// \file panel_presenter.h  Presenter of the simulator's panel, without a widget: read-outs and settings.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "trocar/presenter/read_outs.h"
#include "trocar/presenter/session_control.h"
#include "trocar/presenter/settings_form.h"

namespace trocar::presenter {

/// Content of the panel that stays the same while a scene is open.
struct ScenePage {
  bool has_task = false;
  std::string task_name, task_about;
  bool has_patient = false;
  std::string patient_name, patient_organs, patient_source;
  bool has_tools = false;  ///< some hand has several to choose from
  std::array<std::vector<std::string>, instrument::kHandCount> trays;
};

/// One hand's force, and what it meets.
struct HandPage {
  std::string force, contact;
  double force_n = 0;
  ForceThresholds thresholds;
  ForceLevel level = ForceLevel::kCalm;
  bool is_chosen = false;  ///< mouse and keys move it
};
using HandPages = std::array<HandPage, instrument::kHandCount>;

/// Tools, liquids and the assistant.
struct OperationPage {
  std::array<std::string, instrument::kHandCount> hands;    ///< "1  Left grasper"
  std::array<std::size_t, instrument::kHandCount> asked{};  ///< place in the tray; the exchange follows later
  std::string clips, blood, bile, stones, assistant;
  bool has_assistant = false;
  scene::AssistantCommand command{};
};

struct SettingsPage {
  struct Row {
    double position = 0;  ///< of the slider, 0 to 1
    std::string value;
  };
  std::vector<Row> rows;   ///< in the order of SettingRows()
  std::size_t solver = 0;  ///< of SolverChoices()
};

struct MeasuresPage {
  std::string residual, iterations, tick, late, pictures, time;
  std::array<std::string, simulation::kStageCount> stages;
};

/// View interface that the presenter drives; a panel implements it.
class PanelScreen {
 public:
  virtual ~PanelScreen() = default;
  virtual void ShowScene(const ScenePage& page) = 0;
  virtual void ShowHands(const HandPages& page) = 0;
  virtual void ShowOperation(const OperationPage& page) = 0;
  virtual void ShowTask(const TaskReadOut& page) = 0;
  virtual void ShowSettings(const SettingsPage& page) = 0;
  /// Only the value beside a slider that a person moves.
  virtual void ShowSetting(std::size_t row, const std::string& value) = 0;
  virtual void ShowMeasures(const MeasuresPage& page) = 0;
};

/// Nothing is done or shown without a control.
class PanelPresenter {
 public:
  /// \param screen  outlives the presenter
  explicit PanelPresenter(PanelScreen& screen) : screen_(screen) {}

  /// Shows its scene and takes the settings over.
  /// \param control  outlives its use here; or null
  void UseControl(SessionControl* control);

  /// Shows forces and contacts, tools, liquids and the assistant, and how the task goes.
  void ShowState(const simulation::Snapshot& snapshot);
  /// Shows solver and times.
  void ShowTimes(const simulation::Snapshot& snapshot, const session::RunnerStatistics& statistics,
                 const StageMeter& stages, double picture_rate);

  void ChooseTool(instrument::Hand hand, std::size_t place);
  void CommandAssistant(std::size_t command);
  void SetSetting(std::size_t row, double position);
  void ChooseSolver(std::size_t choice);
  /// Restores the settings of the scene.
  void RestoreSettings();

 private:
  void ShowSettings();

  PanelScreen& screen_;
  SessionControl* control_ = nullptr;
};

ScenePage MakeScenePage(const scene::Scene& scene);
/// \param chosen  hand that mouse and keys move; kLaparoscope: none
HandPages MakeHandPages(const scene::Scene& scene, const simulation::Snapshot& snapshot,
                        device::Channel chosen);
OperationPage MakeOperationPage(const scene::Scene& scene, const scene::Input& input,
                                const simulation::Snapshot& snapshot);
SettingsPage MakeSettingsPage(const scene::LiveSettings& settings);
MeasuresPage MakeMeasuresPage(const simulation::Snapshot& snapshot,
                              const session::RunnerStatistics& statistics, const StageMeter& stages,
                              double picture_rate);

}  // namespace trocar::presenter
