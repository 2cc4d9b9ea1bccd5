// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/patient_editor_presenter.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "awaited_flags.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::editor {
namespace {

namespace fs = std::filesystem;

/// Keeps what it was given, as a window without widgets.
struct FakePatientScreen : PatientScreen {
  void Show(const PatientPage& shown) override { page = shown; }
  void UseEditor(PatientEditor* used) override { editor = used; }
  void ShowFigure(view::PatientFigure figure) override { surfaces = figure.surfaces.size(); }
  void ShowMarks(render::FigureMarks shown) override { marks = shown.lines.size(); }
  void ShowFindings(const anatomy::LintReport& report) override { reports.push_back(report.meshes.size()); }
  void LookAt(const math::Vec3& place, double) override { looked_at = place; }
  void Ask(gui::Question question) override { questions.push_back(std::move(question)); }
  void ChooseFolder(const std::string& name, std::function<void(fs::path)> act) override {
    asked_name = name;
    if (!folder.empty()) act(folder);
  }
  void StartTimer(PatientTimer timer, unsigned) override { timers.push_back(timer); }
  void Close() override { ++closes; }

  bool Answer(const std::string& label) {
    const auto answers = questions.back().answers;
    for (const gui::Answer& answer : answers) {
      if (answer.label == label) return answer.act(), true;
    }
    return false;
  }

  PatientPage page;
  PatientEditor* editor = nullptr;
  std::size_t surfaces = 0, marks = 0;
  std::vector<std::size_t> reports;
  std::optional<math::Vec3> looked_at;
  std::vector<gui::Question> questions;
  std::string asked_name;
  fs::path folder;
  std::vector<PatientTimer> timers;
  int closes = 0;
};

const fs::path kDelivered = fs::path(TROCAR_SOURCE_DIR) / "assets/patients/visible-human-male/patient";

class PatientPresenterTest : public testing::Test {
 protected:
  void SetUp() override {
    options_.patient = folder_.Path() / "patient";
    fs::copy(kDelivered, options_.patient, fs::copy_options::recursive);
  }
  void Begin() {
    presenter_.emplace(options_, screen_, PatientWakes{flags_.Raise(is_loaded_), flags_.Raise(is_checked_)});
    presenter_->Start();
  }
  void Load() {
    flags_.Await(is_loaded_);
    presenter_->FinishLoading();
  }
  void Open() {
    Begin();
    Load();
    ASSERT_NE(screen_.editor, nullptr);
  }
  /// Moves a landmark, as a drag does.
  void Edit() {
    screen_.editor->tool = EditorTool::kLandmarks;
    ASSERT_TRUE(presenter_->Press(std::nullopt, 0, false));
    presenter_->Drag(std::nullopt, screen_.editor->Grabbed() + math::Vec3{0.002, 0, 0});
    presenter_->Release();
  }
  bool IsTitleMarked() const { return screen_.page.title.starts_with("• "); }

  test::TemporaryFolder folder_;
  PatientEditorOptions options_;
  FakePatientScreen screen_;
  AwaitedFlags flags_;
  bool is_loaded_ = false, is_checked_ = false;      // raised by flags_
  std::optional<PatientEditorPresenter> presenter_;  // ends before what it uses
};

TEST_F(PatientPresenterTest, OpensBesideTheWindow) {
  options_.tool = EditorTool::kTubes;
  Begin();
  EXPECT_EQ(screen_.editor, nullptr);
  EXPECT_FALSE(presenter_->IsEnabled(PatientAction::kSaveAs));
  EXPECT_TRUE(presenter_->IsEnabled(PatientAction::kQuit));
  presenter_->Do(PatientAction::kUndo);  // nothing to do it with
  Load();
  EXPECT_TRUE(presenter_->IsEnabled(PatientAction::kSaveAs));
  EXPECT_FALSE(presenter_->IsEnabled(PatientAction::kSave)) << "nothing has changed";
  EXPECT_TRUE(screen_.page.status.starts_with("Opened ")) << screen_.page.status;
  EXPECT_EQ(screen_.page.hint, HintText(EditorTool::kTubes));
  EXPECT_LT(screen_.editor->look.liver_opacity, 1) << "ducts lie behind the liver";
  EXPECT_GT(screen_.surfaces, 2u);
}

TEST_F(PatientPresenterTest, SaysWhatCannotBeOpened) {
  options_.patient = folder_.Path() / "nobody";
  Begin();
  Load();
  ASSERT_TRUE(presenter_->GetFailure());
  EXPECT_EQ(presenter_->GetFailure()->code, base::ErrorCode::kFileMissing);
  EXPECT_TRUE(screen_.page.is_status_warning);
  EXPECT_EQ(screen_.closes, 0) << "a person reads it";
  EXPECT_FALSE(presenter_->OnClose());
}

TEST_F(PatientPresenterTest, ClosesARunThatNobodyAttendsWhenItFails) {
  options_.patient = folder_.Path() / "nobody";
  options_.run.screenshot = "patient.png";
  Begin();
  Load();
  EXPECT_EQ(screen_.closes, 1);
}

TEST_F(PatientPresenterTest, AnEditIsUnsavedUndoneAndDoneAgain) {
  Open();
  EXPECT_FALSE(presenter_->IsEnabled(PatientAction::kUndo));
  Edit();
  EXPECT_TRUE(IsTitleMarked());
  EXPECT_TRUE(presenter_->IsEnabled(PatientAction::kSave));
  const PatientCommand& undo = *FindCommand(PatientCommands(), PatientAction::kUndo);
  EXPECT_TRUE(presenter_->FindButton(undo).tip.starts_with("Undo: move "));
  presenter_->Do(PatientAction::kUndo);
  EXPECT_FALSE(IsTitleMarked());
  EXPECT_FALSE(presenter_->IsEnabled(PatientAction::kSave));
  presenter_->Do(PatientAction::kRedo);
  EXPECT_TRUE(IsTitleMarked());
}

TEST_F(PatientPresenterTest, RefusesInWords) {
  Open();
  presenter_->Do(PatientAction::kTubes);
  EXPECT_EQ(screen_.editor->tool, EditorTool::kTubes);
  screen_.editor->ChooseTube(std::nullopt);
  presenter_->Do(PatientAction::kDeletePoint);
  EXPECT_TRUE(screen_.page.is_status_warning);
  EXPECT_NE(screen_.page.status.find("choose a point"), std::string::npos);
}

TEST_F(PatientPresenterTest, ChecksBesideTheWindowAfterTheLastEdit) {
  Open();
  EXPECT_EQ(screen_.timers, (std::vector{PatientTimer::kCheck, PatientTimer::kAutosave}));
  EXPECT_FALSE(presenter_->OnTimer(PatientTimer::kCheck));
  Edit();
  EXPECT_FALSE(presenter_->OnTimer(PatientTimer::kCheck)) << "while the first one runs";
  flags_.Await(is_checked_);
  presenter_->FinishCheck();
  flags_.Await(is_checked_);
  presenter_->FinishCheck();
  EXPECT_EQ(screen_.reports.size(), 2u);
  screen_.timers.clear();
  presenter_->Do(PatientAction::kPaint);
  EXPECT_TRUE(screen_.timers.empty()) << "another tool is no edit";
}

TEST_F(PatientPresenterTest, LooksAtWhatAFindingNames) {
  Open();
  presenter_->LookAt("gallbladder");
  EXPECT_TRUE(screen_.looked_at);
  screen_.looked_at.reset();
  presenter_->LookAt("no such organ");
  EXPECT_FALSE(screen_.looked_at);
}

TEST_F(PatientPresenterTest, OffersWhatALostWindowHad) {
  Open();
  Edit();
  const auto moved = screen_.editor->GetPatient().landmarks[0].position;
  EXPECT_TRUE(presenter_->OnTimer(PatientTimer::kAutosave)) << "again and again";
  presenter_.reset();  // without OnClose: the program was killed
  screen_ = {};
  Begin();
  ASSERT_EQ(screen_.questions.size(), 1u);
  EXPECT_EQ(screen_.questions.back().answers.front().label, "Leave them");
  presenter_->Do(PatientAction::kQuit);
  EXPECT_EQ(screen_.closes, 0) << "the question comes first";
  EXPECT_TRUE(screen_.Answer("Go on with them"));
  Load();
  EXPECT_LT(Distance(screen_.editor->GetPatient().landmarks[0].position, moved), 1e-6);
  EXPECT_TRUE(IsTitleMarked()) << "it is not in the folder yet";
}

TEST_F(PatientPresenterTest, SavesAndForgetsTheAutosave) {
  Open();
  Edit();
  EXPECT_TRUE(presenter_->OnTimer(PatientTimer::kAutosave));
  EXPECT_TRUE(fs::exists(anatomy::PatientDocument::AutosaveFolder(options_.patient)));
  presenter_->Do(PatientAction::kSave);
  EXPECT_TRUE(screen_.questions.empty());
  EXPECT_TRUE(screen_.page.status.starts_with("Saved ")) << screen_.page.status;
  EXPECT_FALSE(IsTitleMarked());
  EXPECT_FALSE(fs::exists(anatomy::PatientDocument::AutosaveFolder(options_.patient)));
  EXPECT_FALSE(presenter_->OnClose());
}

TEST_F(PatientPresenterTest, SavesUnderANameThatIsChosen) {
  Open();
  screen_.folder = folder_.Path() / "other";
  presenter_->Do(PatientAction::kSaveAs);
  EXPECT_EQ(screen_.asked_name, "patient-edited");
  EXPECT_TRUE(fs::exists(folder_.Path() / "other" / "patient.json"));
}

TEST_F(PatientPresenterTest, AsksBeforeADeliveredPatientIsOverwritten) {
  options_.patient = kDelivered;
  options_.run.screenshot = "patient.png";  // another run may have left an autosave there
  Open();
  Edit();
  presenter_->Do(PatientAction::kSave);
  ASSERT_EQ(screen_.questions.size(), 1u);
  EXPECT_TRUE(screen_.Answer("Cancel"));
  EXPECT_TRUE(IsTitleMarked()) << "nothing was written";
}

TEST_F(PatientPresenterTest, AsksBeforeWorkIsLost) {
  Open();
  Edit();
  EXPECT_TRUE(presenter_->OnClose());
  ASSERT_EQ(screen_.questions.size(), 1u);
  EXPECT_TRUE(presenter_->OnClose());
  EXPECT_EQ(screen_.questions.size(), 1u) << "one question at a time";
  EXPECT_TRUE(screen_.Answer("Cancel"));
  EXPECT_EQ(screen_.closes, 0);
  EXPECT_TRUE(presenter_->OnClose());
  EXPECT_TRUE(screen_.Answer("Do not save"));
  EXPECT_EQ(screen_.closes, 1);
  EXPECT_FALSE(presenter_->OnClose());
}

TEST_F(PatientPresenterTest, SavesAndCloses) {
  Open();
  Edit();
  EXPECT_TRUE(presenter_->OnClose());
  EXPECT_TRUE(screen_.Answer("Save"));
  EXPECT_EQ(screen_.closes, 1);
  EXPECT_FALSE(presenter_->OnClose());
}

TEST_F(PatientPresenterTest, TheBrushFollowsThePointer) {
  Open();
  const auto& mesh = screen_.editor->GetPatient().organs[0].mesh;
  const auto& corners = mesh.triangles[5];
  const render::SurfaceHit hit{0, 5, corners[0], mesh.positions[corners[0]], 0.1};
  presenter_->Hover(hit);
  EXPECT_EQ(screen_.marks, 0u) << "with the brush alone";
  presenter_->Do(PatientAction::kPaint);
  presenter_->Hover(hit);
  EXPECT_EQ(screen_.marks, 1u);
  const double radius = screen_.editor->brush_radius;
  EXPECT_TRUE(presenter_->Wheel(std::nullopt, true, 1));
  EXPECT_GT(screen_.editor->brush_radius, radius);
  presenter_->Leave();
}

}  // namespace
}  // namespace trocar::editor
