// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/panel_presenter.h"

#include <gtest/gtest.h>

#include "trocar/presenter/scene_choice.h"

namespace trocar::presenter {
namespace {

/// Remembers what it was told, as a panel without widgets.
struct FakePanel : PanelScreen {
  void ShowScene(const ScenePage& page) override { scene = page; }
  void ShowHands(const HandPages& page) override { hands = page; }
  void ShowOperation(const OperationPage& page) override { operation = page; }
  void ShowTask(const TaskReadOut& page) override { task = page; }
  void ShowSettings(const SettingsPage& page) override { settings = page; }
  void ShowSetting(std::size_t row, const std::string& value) override { settings.rows[row].value = value; }
  void ShowMeasures(const MeasuresPage& page) override { measures = page; }

  ScenePage scene;
  HandPages hands;
  OperationPage operation;
  TaskReadOut task;
  SettingsPage settings;
  MeasuresPage measures;
};

class PanelPresenterTest : public testing::Test {
 protected:
  void Open(const char* task) {
    Options options;
    options.task = task;
    options.threads = 1;
    auto simulation = MakeChosenSimulation(options);
    ASSERT_TRUE(simulation.ok()) << simulation.error().Text();
    auto made = SessionControl::Make(std::move(simulation).value());
    ASSERT_TRUE(made.ok());
    control_ = std::move(made).value();
    presenter_.UseControl(control_.get());
  }

  FakePanel screen_;
  std::unique_ptr<SessionControl> control_;
  PanelPresenter presenter_{screen_};
};

TEST_F(PanelPresenterTest, ShowsATask) {
  Open("peg_transfer");
  EXPECT_TRUE(screen_.scene.has_task);
  EXPECT_FALSE(screen_.scene.task_name.empty());
  EXPECT_FALSE(screen_.scene.has_patient) << "a board with pegs";
  const simulation::Snapshot snapshot = control_->Advance(0);
  presenter_.ShowState(snapshot);
  EXPECT_TRUE(screen_.task.next.starts_with("Next: ")) << screen_.task.next;
  EXPECT_EQ(screen_.hands[instrument::kLeft].force, "0.0 N");
  EXPECT_EQ(screen_.hands[instrument::kLeft].level, ForceLevel::kCalm);
  EXPECT_TRUE(screen_.hands[instrument::kRight].is_chosen);
  EXPECT_FALSE(screen_.hands[instrument::kLeft].is_chosen);
  EXPECT_TRUE(screen_.operation.hands[instrument::kLeft].starts_with("1  Left "));
  EXPECT_EQ(screen_.operation.clips, "—");
}

TEST_F(PanelPresenterTest, ADemonstrationChoosesNoHand) {
  Open("peg_transfer");
  control_->SetDemonstration(true);
  presenter_.ShowState(control_->Advance(0));
  EXPECT_FALSE(screen_.hands[instrument::kRight].is_chosen);
}

TEST_F(PanelPresenterTest, SlidersMoveTheSettingsAndGoBack) {
  Open("peg_transfer");
  ASSERT_EQ(screen_.settings.rows.size(), SettingRows().size());
  const scene::LiveSettings before = control_->GetSettings();
  const std::string value = screen_.settings.rows[0].value;
  presenter_.SetSetting(0, 1.0);
  EXPECT_GT(control_->GetSettings().stiffness_scale, before.stiffness_scale);
  EXPECT_NE(screen_.settings.rows[0].value, value);
  presenter_.ChooseSolver(SolverChoices().size() - 1);
  EXPECT_EQ(control_->GetSettings().solver.kind, SolverChoices().back().kind);
  presenter_.RestoreSettings();
  EXPECT_EQ(control_->GetSettings().stiffness_scale, before.stiffness_scale);
  EXPECT_EQ(control_->GetSettings().solver.kind, before.solver.kind);
  EXPECT_EQ(screen_.settings.rows[0].value, value);
  presenter_.SetSetting(999, 1.0);
  presenter_.ChooseSolver(999);
  EXPECT_EQ(control_->GetSettings().solver.kind, before.solver.kind);
}

TEST_F(PanelPresenterTest, ShowsTimes) {
  simulation::Snapshot snapshot;
  snapshot.iterations = 7;
  session::RunnerStatistics statistics;
  statistics.ticks = 1200, statistics.late_ticks = 3;
  presenter_.ShowTimes(snapshot, statistics, StageMeter(), 59.7);
  EXPECT_EQ(screen_.measures.iterations, "7");
  EXPECT_EQ(screen_.measures.late, "3 of 1,200");
  EXPECT_EQ(screen_.measures.pictures, "60");
  EXPECT_EQ(screen_.measures.stages[0], "0.000");
}

TEST_F(PanelPresenterTest, DoesNothingWithoutAControl) {
  presenter_.UseControl(nullptr);
  presenter_.SetSetting(0, 1.0);
  presenter_.CommandAssistant(1);
  presenter_.ChooseTool(instrument::kLeft, 0);
  presenter_.ShowState({});
  EXPECT_TRUE(screen_.operation.clips.empty());
}

TEST(ScenePage, DescribesThePatient) {
  const auto scene = ReadChosenScene({});
  ASSERT_TRUE(scene.ok()) << scene.error().Text();
  const ScenePage page = MakeScenePage(*scene);
  EXPECT_TRUE(page.has_patient);
  EXPECT_NE(page.patient_organs.find("liver: "), std::string::npos);
  EXPECT_NE(page.patient_organs.find(" ducts and arteries"), std::string::npos);
  EXPECT_FALSE(page.patient_source.empty());
}

}  // namespace
}  // namespace trocar::presenter
