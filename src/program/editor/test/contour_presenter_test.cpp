// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_presenter.h"

#include <gtest/gtest.h>

#include "awaited_flags.h"
#include "disc_series.h"
#include "trocar/contours/overlay.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::editor {

using math::Vec2;

namespace {

/// Keeps what it was given, as a window without widgets.
struct FakeScreen : ContourScreen {
  void Show(const ContourPage& shown) override { page = shown; }
  void UseEditor(ContourEditor* used) override { editor = used; }
  void FocusCanvas() override {}
  void ShowError(const base::Error& error) override { errors.push_back(error.code); }
  void ShowNotice(const std::string& text) override { notices.push_back(text); }
  void Ask(gui::Question question) override { questions.push_back(std::move(question)); }
  void ChooseFile(FileQuestion what, std::function<void(std::filesystem::path)> act) override {
    asked_file = what;
    if (!file.empty()) act(file);
  }
  bool AskSizes(const images::ImageSeriesOptions&) override { return will_answer_sizes; }
  void ForgetSurfaces() override { ++forgotten; }
  void ShowSurface(int, contours::OrganMesh) override { ++surfaces; }
  void ShowSurfaceProblem(int, const std::string&) override {}
  void ShowSurfaceJob(const contours::MeshJob::State&) override {}
  void StartTimer(ContourTimer timer, unsigned) override { timers.push_back(timer); }
  void DoInWindow(ContourAction action) override { done.push_back(action); }

  bool Answer(const std::string& label) {
    for (const gui::Answer& answer : questions.back().answers) {
      if (answer.label == label) return answer.act(), true;
    }
    return false;
  }

  ContourPage page;
  ContourEditor* editor = nullptr;
  std::vector<base::ErrorCode> errors;
  std::vector<std::string> notices;
  std::vector<gui::Question> questions;
  std::optional<FileQuestion> asked_file;
  std::filesystem::path file;
  bool will_answer_sizes = false;
  int forgotten = 0, surfaces = 0;
  std::vector<ContourTimer> timers;
  std::vector<ContourAction> done;
};

class ContourPresenterTest : public testing::Test {
 protected:
  void SetUp() override {
    WriteDisc(folder_.Path() / "slices");
    options_.images = folder_.Path() / "slices";
    options_.series = DiscSeries();
  }

  void Begin() {
    presenter_.emplace(options_, folder_.Path() / "user", screen_,
                       ContourWakes{flags_.Raise(is_loaded_), flags_.Raise(is_built_), [] {}, [] {},
                                    flags_.Raise(is_grown_)});
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
  /// A closed triangle on the slice that is shown.
  void Draw() {
    ContourEditor& editor = *screen_.editor;
    for (const Vec2& p : {Vec2{60, 20}, Vec2{90, 50}, Vec2{60, 80}, Vec2{30, 50}})
      (void)presenter_->Workspace()->Document().AddPoint(editor.Structure(), editor.Slice(), p);
    editor.Do(ContourAction::kCloseContour);
    presenter_->OnEdited();
  }

  test::TemporaryFolder folder_;
  ContourOptions options_;
  FakeScreen screen_;
  AwaitedFlags flags_;
  bool is_loaded_ = false, is_built_ = false, is_grown_ = false;  // raised by flags_
  std::optional<ContourPresenter> presenter_;                     // ends before what it uses
};

TEST_F(ContourPresenterTest, OpensBesideTheWindow) {
  Begin();
  EXPECT_TRUE(screen_.page.is_busy);
  EXPECT_FALSE(screen_.page.is_document_open);
  EXPECT_FALSE(presenter_->IsEnabled(ContourAction::kSave));
  Load();
  EXPECT_TRUE(screen_.page.is_document_open);
  EXPECT_FALSE(screen_.page.is_busy);
  EXPECT_EQ(screen_.page.title, "new contours");
  EXPECT_EQ(screen_.page.state, "New");
  EXPECT_TRUE(presenter_->IsEnabled(ContourAction::kSave));
  EXPECT_FALSE(presenter_->IsEnabled(ContourAction::kToggleReference)) << "there is no label map";
}

TEST_F(ContourPresenterTest, AsksForSizesThatNobodySaid) {
  options_.series = {};
  screen_.will_answer_sizes = true;
  Begin();
  Load();
  EXPECT_EQ(screen_.editor, nullptr);
  EXPECT_TRUE(screen_.errors.empty());
  presenter_->OpenWith(DiscSeries());
  Load();
  EXPECT_NE(screen_.editor, nullptr);
}

TEST_F(ContourPresenterTest, EndsARunThatNobodyAnswers) {
  options_.series = {};
  options_.run.screenshot = "window.png";
  Begin();
  Load();
  ASSERT_TRUE(presenter_->GetFailure());
  EXPECT_EQ(presenter_->GetFailure()->code, base::ErrorCode::kImageSpacingUnknown);
  EXPECT_EQ(screen_.done, std::vector{ContourAction::kQuit});
}

TEST_F(ContourPresenterTest, AnEditIsUndoneAndBecomesOneSurfaceRequest) {
  Open();
  EXPECT_FALSE(presenter_->IsEnabled(ContourAction::kUndo));
  screen_.timers.clear();
  Draw();
  presenter_->OnEdited();
  EXPECT_EQ(screen_.timers, std::vector{ContourTimer::kSurfaces}) << "edits in a row share one";
  EXPECT_FALSE(presenter_->AreSurfacesDone());
  EXPECT_FALSE(presenter_->OnTimer(ContourTimer::kSurfaces));
  EXPECT_TRUE(presenter_->IsEnabled(ContourAction::kUndo));
  EXPECT_EQ(screen_.page.title, "\u2022 new contours");
  presenter_->Do(ContourAction::kUndo);
  EXPECT_TRUE(presenter_->IsEnabled(ContourAction::kRedo));
}

TEST_F(ContourPresenterTest, SavesUnderANameThatIsChosen) {
  Open();
  Draw();
  screen_.file = folder_.Path() / "points.json";
  presenter_->Do(ContourAction::kSave);
  EXPECT_EQ(screen_.asked_file, FileQuestion::kSaveContours);
  EXPECT_TRUE(host::ReadFile(screen_.file).ok());
  EXPECT_EQ(screen_.page.state, "Saved");
  EXPECT_EQ(screen_.page.title, "points.json");
  EXPECT_FALSE(presenter_->OnClose());
}

TEST_F(ContourPresenterTest, AsksBeforeWorkIsLost) {
  Open();
  Draw();
  EXPECT_TRUE(presenter_->OnClose());
  ASSERT_EQ(screen_.questions.size(), 1u);
  EXPECT_TRUE(screen_.Answer("Stay"));
  EXPECT_TRUE(screen_.done.empty());
  EXPECT_TRUE(presenter_->OnClose());
  EXPECT_TRUE(screen_.Answer("Close without saving"));
  EXPECT_EQ(screen_.done, std::vector{ContourAction::kQuit});
  EXPECT_FALSE(presenter_->OnClose());
}

TEST_F(ContourPresenterTest, OffersWhatALostWindowHad) {
  options_.points = folder_.Path() / "points.json";
  Open();
  Draw();
  presenter_.reset();  // without OnClose: the program was killed
  screen_ = {};
  Open();
  ASSERT_EQ(screen_.questions.size(), 1u);
  EXPECT_FALSE(presenter_->Workspace()->Document().ContouredSlices(0).empty());
  EXPECT_TRUE(screen_.Answer("Back to the file"));
  EXPECT_TRUE(presenter_->Workspace()->Document().ContouredSlices(0).empty());
}

TEST_F(ContourPresenterTest, TwoWindowsDoNotKeepOneSideFile) {
  options_.points = folder_.Path() / "points.json";
  Open();
  FakeScreen other_screen;
  ContourPresenter other(options_, folder_.Path() / "user", other_screen,
                         ContourWakes{flags_.Raise(is_loaded_), [] {}, [] {}, [] {}});
  other.Start();
  flags_.Await(is_loaded_);
  other.FinishLoading();
  ASSERT_EQ(other_screen.questions.size(), 1u);
  EXPECT_FALSE(other.SideFile().IsKeeping());
  EXPECT_TRUE(presenter_->SideFile().IsKeeping());
}

TEST_F(ContourPresenterTest, BuildsBesideTheWindowAndCanGiveUp) {
  options_.points = folder_.Path() / "points.json";
  Open();
  Draw();
  EXPECT_FALSE(presenter_->CanBuild()) << "not saved";
  presenter_->Do(ContourAction::kSave);
  ASSERT_TRUE(presenter_->CanBuild());
  presenter_->StartBuild(folder_.Path() / "patient");
  EXPECT_TRUE(screen_.page.is_building);
  EXPECT_FALSE(presenter_->IsEnabled(ContourAction::kBuild));
  EXPECT_TRUE(presenter_->OnClose()) << "the build is not lost without a question";
  presenter_->Stop();
  EXPECT_TRUE(screen_.page.is_stopping);
  flags_.Await(is_built_);
  presenter_->FinishBuild();
  EXPECT_FALSE(screen_.page.is_building);
  EXPECT_TRUE(presenter_->IsEnabled(ContourAction::kBuild));
}

/// The disc is a gallbladder of 7 mL.
class GrowingTest : public ContourPresenterTest {
 protected:
  void OpenDiscFor(int structure) {
    Open();
    screen_.editor->size = {120, 100};
    FitPicture(screen_.editor->view, screen_.editor->size, 120, 100);
    screen_.editor->ChooseStructure(structure);
  }
  void Click(const Vec2& pixel) {
    ContourEditor& editor = *screen_.editor;
    editor.Press(ToCanvas(editor.view, editor.size, pixel), false);
    presenter_->OnEdited();
  }
  void Finish() {
    flags_.Await(is_grown_);
    presenter_->FinishGrowth();
  }
  std::size_t Contoured() { return presenter_->Workspace()->Document().ContouredSlices(1).size(); }
};

TEST_F(GrowingTest, GrowsBesideTheWindowAsOneStep) {
  OpenDiscFor(1);
  presenter_->Do(ContourAction::kGrowMode);
  EXPECT_TRUE(screen_.editor->IsPointing());
  EXPECT_NE(screen_.page.hint.find("gallbladder"), std::string::npos) << screen_.page.hint;
  Click({60, 50});
  EXPECT_FALSE(screen_.editor->IsPointing()) << "one click, one organ";
  EXPECT_TRUE(screen_.page.is_growing);
  EXPECT_TRUE(screen_.page.is_busy);
  EXPECT_FALSE(presenter_->IsEnabled(ContourAction::kGrowMode));
  EXPECT_FALSE(presenter_->IsEnabled(ContourAction::kBuild));
  EXPECT_TRUE(screen_.editor->Here().open.empty()) << "the click has drawn a point";
  Finish();
  EXPECT_FALSE(screen_.page.is_growing);
  EXPECT_FALSE(screen_.page.is_busy);
  EXPECT_FALSE(screen_.page.is_hint_warning) << screen_.page.hint;
  EXPECT_NE(screen_.page.hint.find("mL"), std::string::npos) << screen_.page.hint;
  EXPECT_GE(Contoured(), 3u);
  presenter_->Do(ContourAction::kUndo);
  EXPECT_EQ(Contoured(), 0u);
  presenter_->Do(ContourAction::kRedo);
  EXPECT_GE(Contoured(), 3u);
}

TEST_F(GrowingTest, GrowsByKeysAlone) {
  OpenDiscFor(1);
  presenter_->Do(ContourAction::kGrowMode);
  presenter_->Do(ContourAction::kCloseContour);  // Enter: the middle of the picture
  ASSERT_TRUE(presenter_->IsGrowing());
  Finish();
  EXPECT_GE(Contoured(), 3u) << screen_.page.hint;
}

TEST_F(GrowingTest, SaysWhatIsWrongWithAClickAndWhatToDo) {
  OpenDiscFor(1);
  presenter_->Do(ContourAction::kGrowMode);
  Click({89, 50});  // the border
  Finish();
  EXPECT_TRUE(screen_.page.is_hint_warning);
  EXPECT_NE(screen_.page.hint.find("click"), std::string::npos) << screen_.page.hint;
  EXPECT_EQ(Contoured(), 0u);
  EXPECT_FALSE(presenter_->IsEnabled(ContourAction::kUndo));
  // an organ that does not grow
  ASSERT_TRUE(presenter_->Workspace()->Document().AddStructure("spleen", 100).ok());
  screen_.editor->ChooseStructure(2);
  presenter_->Do(ContourAction::kGrowMode);
  EXPECT_FALSE(screen_.editor->IsPointing());
  EXPECT_TRUE(screen_.page.is_hint_warning);
}

TEST_F(GrowingTest, EscapeGivesUpPointingAndGrowing) {
  OpenDiscFor(1);
  presenter_->Do(ContourAction::kGrowMode);
  presenter_->Do(ContourAction::kCancel);
  EXPECT_FALSE(screen_.editor->IsPointing());
  presenter_->Do(ContourAction::kGrowMode);
  Click({60, 50});
  ASSERT_TRUE(presenter_->IsGrowing());
  presenter_->Do(ContourAction::kCancel);
  EXPECT_TRUE(screen_.page.is_stopping);
  Finish();
  EXPECT_EQ(Contoured(), 0u);
  EXPECT_NE(screen_.page.hint.find("given up"), std::string::npos) << screen_.page.hint;
}

TEST_F(GrowingTest, WhatIsOpenedMeanwhileKeepsItsContours) {
  OpenDiscFor(1);
  presenter_->Do(ContourAction::kGrowMode);
  Click({60, 50});
  presenter_->OpenWith(DiscSeries());
  Load();
  Finish();
  EXPECT_EQ(Contoured(), 0u);
  EXPECT_FALSE(presenter_->Workspace()->Document().IsDirty());
}

TEST_F(ContourPresenterTest, ShowsPartsByName) {
  Open();
  EXPECT_TRUE(presenter_->SetPart("fill", false));
  EXPECT_FALSE(screen_.page.has_fill);
  EXPECT_TRUE(presenter_->SetPart("help", true));
  presenter_->Do(ContourAction::kCancel);
  EXPECT_FALSE(screen_.page.is_help_open) << "Esc closes the help first";
  EXPECT_FALSE(presenter_->SetPart("everything", true));
}

}  // namespace
}  // namespace trocar::editor
