// SPDX-License-Identifier: Apache-2.0
#include "trocar/centre/centre_presenter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "recorded_attempt.h"
#include "trocar/host/safe_file.h"
#include "trocar/store/attempts.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::centre {
namespace {

/// Remembers what it was told, as a window without widgets.
struct FakeScreen : CentreScreen {
  void Show(const CentrePage& shown) override { page = shown; }
  void ShowError(const base::Error& error) override { errors.push_back(error); }
  void ShowNotice(const std::string& text) override { notices.push_back(text); }
  void StartAttempt(const Start& start) override { started = start; }
  void StartTask(const std::string& task, const std::string&) override { task_started = task; }
  void OpenReplay(const std::filesystem::path& recording, double time) override {
    replayed = recording;
    replayed_at = time;
  }
  void Close() override { is_closed = true; }

  CentrePage page;
  std::vector<base::Error> errors;
  std::vector<std::string> notices;
  std::optional<Start> started;
  std::string task_started;
  std::filesystem::path replayed;
  double replayed_at = -1;
  bool is_closed = false;
};

class Centre : public testing::Test {
 protected:
  void SetUp() override {
    access_.place = {folder_.Path() / "store.sqlite", folder_.Path() / "files"};
    recording_ = folder_.Path() / "attempt.trocar";
  }
  void Begin(AttemptFiling* filing = nullptr) {
    presenter_.emplace(access_, 1, screen_, filing, [] {});
  }
  void Record(std::uint64_t ticks) const {
    test::RecordAttempt(recording_, test::DescribeTask("instrument_navigation", "easy", 3),
                        {"novice", 3, ticks, {}});
  }
  /// Lets the presenter finish until a claim holds, for a minute at most.
  template <typename Claim>
  bool Until(Claim claim) {
    for (int i = 0; i < 3000; ++i) {
      presenter_->Finish();
      if (claim()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  }
  bool Settle() {
    return Until([this] { return !presenter_->IsBusy(); });
  }

  test::TemporaryFolder folder_;
  Access access_;
  std::filesystem::path recording_;
  FakeScreen screen_;
  std::optional<CentrePresenter> presenter_;
};

TEST_F(Centre, ReadsBesideTheWindow) {
  Begin();
  presenter_->Open(PageKind::kHistory);
  EXPECT_EQ(screen_.page.busy, "Reading the history");
  ASSERT_TRUE(Settle());
  EXPECT_TRUE(screen_.page.busy.empty());
  EXPECT_TRUE(screen_.errors.empty());
  EXPECT_TRUE(screen_.page.history.rows.empty());
  EXPECT_FALSE(presenter_->IsEnabled(CentreAction::kShowResult)) << "there is none yet";
}

TEST_F(Centre, SaysWhatToDoWhereTheStoreCannotBeRead) {
  ASSERT_TRUE(host::WriteFile(folder_.Path() / "no", "a file where the folder should be").ok());
  access_.place.url = folder_.Path() / "no" / "store.sqlite";
  Begin();
  presenter_->Open(PageKind::kHistory);
  ASSERT_TRUE(Settle());
  ASSERT_EQ(screen_.errors.size(), 1u);
  EXPECT_FALSE(screen_.errors[0].message.empty());
  // the map of a course needs no store
  presenter_->Open(PageKind::kCourses);
  ASSERT_TRUE(Settle());
  EXPECT_FALSE(screen_.page.courses.steps.empty());
  EXPECT_EQ(screen_.errors.size(), 2u);
}

TEST_F(Centre, BecomesSomebody) {
  Begin();
  presenter_->BeSomebody("Anna Berg");
  ASSERT_TRUE(Settle());
  EXPECT_EQ(screen_.page.who, "Anna Berg");
  EXPECT_TRUE(presenter_->GetAccess().person.starts_with("T-"));
  EXPECT_FALSE(presenter_->IsEnabled(CentreAction::kShowGroup)) << "a trainee sees no group";
  presenter_->BeSomebody("");
  ASSERT_TRUE(Settle());
  EXPECT_EQ(presenter_->GetAccess().person, "");
  EXPECT_TRUE(presenter_->IsEnabled(CentreAction::kShowGroup));
}

TEST_F(Centre, WhoIsNamedAtTheStartHasHisRole) {
  const auto pseudonym = FindPseudonym(access_, "Anna Berg");
  ASSERT_TRUE(pseudonym.ok());
  access_.person = *pseudonym;
  Begin();
  EXPECT_FALSE(presenter_->IsEnabled(CentreAction::kShowGroup)) << "before it is known";
  ASSERT_TRUE(Settle());
  EXPECT_FALSE(presenter_->IsEnabled(CentreAction::kShowGroup));
  EXPECT_EQ(screen_.page.who, "Anna Berg");
}

TEST_F(Centre, ShowsTheResultOfAnAttemptAndItsHistory) {
  AttemptFiling filing(access_, 1, [] {});
  Begin(&filing);
  filing.Begin(recording_);
  Record(900);
  filing.End(recording_);
  presenter_->ExpectResult(recording_);
  EXPECT_EQ(screen_.page.kind, PageKind::kResult);
  EXPECT_FALSE(screen_.page.result.has_value()) << "it is measured first";
  ASSERT_TRUE(Until([this] { return screen_.page.result.has_value() && !presenter_->IsBusy(); }));
  EXPECT_EQ(screen_.page.result->verdict, "Not completed");
  EXPECT_EQ(screen_.page.result->recording, recording_);

  presenter_->Jump(5);
  EXPECT_EQ(screen_.replayed, recording_);
  EXPECT_DOUBLE_EQ(screen_.replayed_at, 3) << "a little before, so that one sees how it came";
  presenter_->PlayAgain();
  EXPECT_EQ(screen_.task_started, "instrument_navigation");
  presenter_->SaveReport(folder_.Path() / "report.pdf");
  ASSERT_TRUE(Settle());
  EXPECT_TRUE(std::filesystem::exists(folder_.Path() / "report.pdf"));

  ASSERT_TRUE(Until([&] { return filing.Status().waiting == 0; }));
  presenter_->Open(PageKind::kHistory);
  ASSERT_TRUE(Settle());
  ASSERT_EQ(screen_.page.history.rows.size(), 1u);
  EXPECT_EQ(screen_.page.history.rows[0].tone, Tone::kCaution);
  presenter_->OpenResultOf(screen_.page.history.rows[0]);
  ASSERT_TRUE(Until([this] { return screen_.page.result.has_value() && !presenter_->IsBusy(); }));
  EXPECT_EQ(screen_.page.result->verdict, "Not completed");
}

// A result that was measured while it was played may be there before anybody asks for its page.
TEST_F(Centre, ShowsAResultThatWasThereBeforeItWasAskedFor) {
  AttemptFiling filing(access_, 1, [] {});
  Begin(&filing);
  filing.Begin(recording_);
  Record(300);
  filing.End(recording_);
  ASSERT_TRUE(Until([&] { return filing.Status().measuring == 0; }));
  presenter_->Finish();
  presenter_->ExpectResult(recording_);
  ASSERT_TRUE(screen_.page.result.has_value());
  EXPECT_EQ(screen_.page.result->recording, recording_);
}

TEST_F(Centre, StartsAStepOfACourse) {
  Begin();
  presenter_->Open(PageKind::kCourses);
  ASSERT_TRUE(Settle());
  presenter_->ChooseCourse("basic-skills");
  ASSERT_TRUE(Settle());
  presenter_->StartStep({"basic-skills", "instruments"});
  ASSERT_TRUE(Settle());
  ASSERT_TRUE(screen_.started.has_value());
  EXPECT_EQ(screen_.started->description.name, "instrument_navigation");
  EXPECT_EQ(screen_.started->step, (StepName{"basic-skills", "instruments"}));
  EXPECT_FALSE(screen_.started->exam.has_value());
}

// The expert operates for minutes up to the bed; the window says how far, and whoever does not want to wait goes on with something else.
TEST_F(Centre, AStepThatIsMadeReadyCanBeGivenUp) {
  ::setenv("TROCAR_CACHE_HOME", (folder_.Path() / "cache").c_str(), 1);
  Begin();
  EXPECT_FALSE(screen_.page.can_cancel);
  presenter_->StartStep({"cholecystectomy", "bed"});
  const bool is_told = Until([&] { return screen_.page.detail.find(" %") != std::string::npos; });
  EXPECT_TRUE(is_told);
  EXPECT_GE(screen_.page.progress, 0);
  EXPECT_TRUE(screen_.page.can_cancel);
  presenter_->CancelStep();
  EXPECT_EQ(screen_.page.busy, "Giving it up");
  EXPECT_FALSE(screen_.page.can_cancel);
  ASSERT_TRUE(Settle());
  ::unsetenv("TROCAR_CACHE_HOME");
  EXPECT_FALSE(screen_.started.has_value());
  EXPECT_TRUE(screen_.errors.empty()) << "nobody made a mistake";
  EXPECT_TRUE(screen_.page.busy.empty());
  // what cannot be given up offers no button
  presenter_->Open(PageKind::kCourses);
  EXPECT_FALSE(screen_.page.can_cancel);
  ASSERT_TRUE(Settle());
}

// The certificate is of who sat the exam, not of who stands at the computer when it is issued.
TEST_F(Centre, AnExamStaysWhoseItIs) {
  assessment::ExamSettings settings;
  settings.name = "Finals", settings.task = "instrument_navigation", settings.level = "normal";
  const auto sealed = assessment::SealExam(settings);
  ASSERT_TRUE(sealed.ok());
  const auto file = folder_.Path() / "finals.json";
  ASSERT_TRUE(assessment::WriteExam(file, *sealed).ok());
  Begin();
  presenter_->BeSomebody("Anna Berg");
  ASSERT_TRUE(Settle());
  presenter_->OpenExamFile(file);
  ASSERT_TRUE(Settle());
  EXPECT_EQ(screen_.page.exam.examinee_name, "Anna Berg");
  presenter_->StartExam();
  ASSERT_TRUE(Settle());
  ASSERT_TRUE(screen_.started && screen_.started->exam);
  const ExamSitting sitting = *screen_.started->exam;
  presenter_->BeSomebody("Bert Ahl");
  ASSERT_TRUE(Settle());
  presenter_->EndExam(sitting, recording_);
  ASSERT_TRUE(Settle());
  EXPECT_EQ(screen_.page.exam.examinee, sitting.examinee);
  EXPECT_EQ(screen_.page.exam.examinee_name, "Anna Berg");
  presenter_->BeSomebody("Carl Dahl");
  ASSERT_TRUE(Settle());
  EXPECT_EQ(screen_.page.exam.examinee, sitting.examinee) << "it is sat";
  EXPECT_TRUE(screen_.errors.empty());
}

TEST_F(Centre, WhoAsksTwiceGetsTheNewer) {
  Begin();
  presenter_->ChoosePerson("");
  presenter_->ChooseTask("peg_transfer");
  presenter_->ChooseTask("tissue_cutting");
  ASSERT_TRUE(Settle());
  EXPECT_EQ(screen_.page.history.query.task, "tissue_cutting");
  EXPECT_TRUE(screen_.errors.empty());
}

TEST(CentreCommands, EveryButtonHasItsLineOfHelp) {
  for (const CentreCommand& command : CentreCommands()) {
    if (command.button.side == gui::ButtonSide::kNone) continue;
    EXPECT_STRNE(command.help.meaning, "") << command.id;
    EXPECT_NE(command.keys[0].key, 0u) << command.id;
  }
}

}  // namespace
}  // namespace trocar::centre
