// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/replay_presenter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <set>
#include <thread>

#include "recorded_attempt.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/sound_commands.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::presenter {
namespace {

constexpr std::uint64_t kTicks = 1800;  // 15 s
constexpr double kTick = 1.0 / 120;

/// Remembers what it was told, as a window without widgets.
struct FakeScreen : ReplayScreen {
  void Show(const ReplayPage& shown) override { page = shown; }
  void UseReplay(std::size_t side, const session::ReplayRunner* used) override { replays[side] = used; }
  void ShowMarks(const std::vector<ReplayMark>& shown) override { marks = shown; }
  void FillRecordingList(const std::filesystem::path& folder) override { listed = folder; }
  void TakeOver(Branch taken) override { branch.emplace(std::move(taken)); }
  void DoInWindow(ReplayAction action) override { done.push_back(action); }

  ReplayPage page;
  std::array<const session::ReplayRunner*, 2> replays{};
  std::vector<ReplayMark> marks;
  std::filesystem::path listed;
  std::optional<Branch> branch;
  std::vector<ReplayAction> done;
};

class ReplayPresenterTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    Record("novice", "a.trocar", kTicks);
    Record("expert", "b.trocar", 1200);
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static std::filesystem::path File(const char* name) { return folder_->Path() / name; }

  static void Record(const char* surgeon, const char* file, std::uint64_t ticks) {
    test::RecordAttempt(File(file), test::DescribeTask("peg_transfer", "normal", 3, surgeon),
                        {surgeon, 3, ticks, [](std::uint64_t tick, record::Recorder& recorder) {
                           if (tick == 999) recorder.Mark("look here");
                         }});
  }

  void Open(const char* file) {
    Options options;
    options.replay = File(file);
    options.threads = 1;
    options.recordings = folder_->Path();
    presenter_.emplace(options, screen_, [this] { loaded_.set_value(); });
    presenter_->Start();
    Load();
  }
  void Load() {
    loaded_.get_future().wait();
    loaded_ = {};
    presenter_->FinishLoading();
  }
  /// Draws frames of 1/60 s until a claim holds, for at most twenty seconds.
  template <typename Claim>
  bool Frames(Claim claim) {
    for (int i = 0; i < 4000; ++i) {
      work_ = presenter_->Advance(now_ += 1.0 / 60);
      if (claim()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }
  bool StandsAt(double time) {
    const auto tick = static_cast<std::uint64_t>(time / kTick + 0.5);
    return Frames([&] { return work_[0].snapshot->tick == tick && screen_.page.seek_progress == 1; });
  }

  static test::TemporaryFolder* folder_;
  FakeScreen screen_;
  std::promise<void> loaded_;
  std::optional<ReplayPresenter> presenter_;  // ends before what it uses
  std::array<ReplayPresenter::SideWork, 2> work_;
  double now_ = 100;
};
test::TemporaryFolder* ReplayPresenterTest::folder_ = nullptr;

TEST_F(ReplayPresenterTest, OpensARecordingAndSaysWhatItIs) {
  Open("a.trocar");
  EXPECT_NE(screen_.replays[0], nullptr);
  EXPECT_EQ(screen_.replays[1], nullptr);
  EXPECT_EQ(screen_.page.title, "Trocar: replay of a.trocar");
  EXPECT_THAT(screen_.page.about[0], testing::HasSubstr("peg transfer, normal, variant 3  ·  novice"));
  EXPECT_EQ(screen_.page.clock, "0:00.0 / 0:15.0");
  EXPECT_DOUBLE_EQ(screen_.page.end, 15);
  EXPECT_FALSE(presenter_->IsPlaying());
  EXPECT_TRUE(presenter_->IsEnabled(ReplayAction::kWhatIf));
  EXPECT_FALSE(presenter_->IsEnabled(ReplayAction::kCloseBeside));
  EXPECT_FALSE(screen_.marks.empty());
}

TEST_F(ReplayPresenterTest, PlaysAtItsSpeedAndStopsAtTheEnd) {
  Open("a.trocar");
  for (int i = 0; i < 9; ++i) presenter_->Do(ReplayAction::kFaster);
  EXPECT_DOUBLE_EQ(presenter_->Speed(), 8);
  for (int i = 0; i < 9; ++i) presenter_->Do(ReplayAction::kSlower);
  EXPECT_DOUBLE_EQ(presenter_->Speed(), 0.25);
  presenter_->Do(ReplayAction::kTogglePlay);
  ASSERT_TRUE(Frames([&] { return presenter_->Time() > 0.2; }));
  EXPECT_LE(presenter_->Time(), 0.25 * (now_ - 100) + 1e-9) << "a quarter as fast";
  for (int i = 0; i < 5; ++i) presenter_->Do(ReplayAction::kFaster);
  ASSERT_TRUE(Frames([&] { return !presenter_->IsPlaying(); }));
  EXPECT_DOUBLE_EQ(presenter_->Time(), 15);
  EXPECT_TRUE(StandsAt(15));
  // and anew from the beginning
  presenter_->Do(ReplayAction::kTogglePlay);
  EXPECT_LT(presenter_->Time(), 1);
}

TEST_F(ReplayPresenterTest, GoesToAnyMomentAndTheNewestWishWins) {
  Open("a.trocar");
  for (const double time : {9.0, 2.5, 14.0, 0.1, 7.25}) presenter_->GoTo(time);
  EXPECT_TRUE(StandsAt(7.25));
  presenter_->Do(ReplayAction::kBack);
  EXPECT_TRUE(StandsAt(6.25));
  presenter_->Do(ReplayAction::kOnFar);
  EXPECT_DOUBLE_EQ(presenter_->Time(), 15) << "not beyond the end";
  presenter_->Do(ReplayAction::kToBegin);
  EXPECT_TRUE(StandsAt(0));
  presenter_->GoTo(-5);
  EXPECT_DOUBLE_EQ(presenter_->Time(), 0);
}

TEST_F(ReplayPresenterTest, JumpsToALittleBeforeMarks) {
  Open("a.trocar");
  const auto remark = std::find_if(screen_.marks.begin(), screen_.marks.end(), [](const ReplayMark& mark) {
    return mark.kind == ReplayMark::Kind::kRemark;
  });
  ASSERT_NE(remark, screen_.marks.end());
  EXPECT_EQ(remark->text, "look here");
  EXPECT_NEAR(remark->time, 1000 * kTick, 1e-9);
  presenter_->GoToMark(*remark);
  EXPECT_NEAR(presenter_->Time(), 1000 * kTick - 2, 1e-9);
  presenter_->Do(ReplayAction::kToEnd);
  double before = 15;
  std::set<double> places;
  for (int i = 0; i < 100; ++i) {
    presenter_->Do(ReplayAction::kPreviousMark);
    EXPECT_LE(presenter_->Time(), before);
    before = presenter_->Time();
    places.insert(before);
  }
  EXPECT_TRUE(places.contains(remark->time - 2));
  presenter_->Do(ReplayAction::kToBegin);
  presenter_->Do(ReplayAction::kNextMark);
  EXPECT_GT(presenter_->Time(), 0);
}

TEST_F(ReplayPresenterTest, SomebodyTakesOverWhereItStands) {
  Open("a.trocar");
  presenter_->GoTo(6);
  ASSERT_TRUE(StandsAt(6));
  presenter_->Do(ReplayAction::kTogglePlay);
  presenter_->Do(ReplayAction::kTakeOver);
  EXPECT_FALSE(presenter_->IsPlaying());
  ASSERT_TRUE(Frames([&] { return screen_.branch.has_value(); }));
  const std::uint64_t tick = screen_.branch->simulation.GetSnapshot().tick;
  EXPECT_NEAR(static_cast<double>(tick), 720, 10);
  EXPECT_FALSE(screen_.branch->is_experts);
  const record::Description& d = screen_.branch->description;
  EXPECT_EQ(d.branched_from, "a.trocar");
  EXPECT_EQ(d.branched_tick, tick);
  EXPECT_NE(d.branched_id, 0u);
  EXPECT_EQ(screen_.branch->last, screen_.replays[0]->GetRecording().inputs[tick - 1]);
  screen_.branch.reset();
  presenter_->GoTo(3);
  presenter_->Do(ReplayAction::kWhatIf);
  ASSERT_TRUE(Frames([&] { return screen_.branch.has_value(); }));
  EXPECT_TRUE(screen_.branch->is_experts);
  EXPECT_EQ(screen_.branch->simulation.GetSnapshot().tick, 360u);
}

TEST_F(ReplayPresenterTest, ShowsAnotherOneBesideItAtTheSameSecond) {
  Open("a.trocar");
  presenter_->Do(ReplayAction::kToggleList);
  EXPECT_TRUE(screen_.page.is_list_open);
  EXPECT_EQ(screen_.listed, folder_->Path());
  presenter_->OpenBeside(File("b.trocar"));
  Load();
  EXPECT_NE(screen_.replays[1], nullptr);
  EXPECT_THAT(screen_.page.about[1], testing::HasSubstr("expert"));
  EXPECT_FALSE(screen_.page.is_list_open);
  presenter_->GoTo(5);
  ASSERT_TRUE(StandsAt(5));
  ASSERT_TRUE(Frames([&] { return work_[1].snapshot->tick == 600u; }));
  // the shorter one stays at its end
  presenter_->GoTo(12);
  ASSERT_TRUE(StandsAt(12));
  ASSERT_TRUE(Frames([&] { return work_[1].snapshot->tick == 1200u; }));
  // its tools are ghosts in the other's picture
  presenter_->Do(ReplayAction::kToggleGhosts);
  work_ = presenter_->Advance(now_ += 0.02);
  EXPECT_GT(work_[0].overlay.trails.size(), 2u);
  EXPECT_GT(work_[1].overlay.trails.size(), 2u);
  presenter_->Do(ReplayAction::kCloseBeside);
  EXPECT_EQ(screen_.replays[1], nullptr);
  work_ = presenter_->Advance(now_ += 0.02);
  EXPECT_EQ(work_[1].snapshot, nullptr);
  EXPECT_EQ(work_[0].overlay.trails.size(), 2u) << "the ways of its own tips";
}

TEST_F(ReplayPresenterTest, TurnsAFreeCamera) {
  Open("a.trocar");
  work_ = presenter_->Advance(now_ += 0.02);
  EXPECT_FALSE(work_[0].overlay.X_world_camera);
  presenter_->Turn(50, 0, 400);  // nothing to turn
  presenter_->Do(ReplayAction::kToggleCamera);
  work_ = presenter_->Advance(now_ += 0.02);
  ASSERT_TRUE(work_[0].overlay.X_world_camera);
  EXPECT_NEAR(math::Distance(work_[0].overlay.X_world_camera->translation,
                             work_[0].snapshot->X_world_laparoscope.translation),
              0, 1e-9)
      << "from where the laparoscope is";
  EXPECT_FALSE(screen_.page.view.has_mask);
  const auto before = *work_[0].overlay.X_world_camera;
  presenter_->Turn(80, 20, 400);
  presenter_->Zoom(-3);
  work_ = presenter_->Advance(now_ += 0.02);
  EXPECT_GT(math::Distance(work_[0].overlay.X_world_camera->translation, before.translation), 0.01);
  presenter_->Do(ReplayAction::kToggleCamera);
  work_ = presenter_->Advance(now_ += 0.02);
  EXPECT_FALSE(work_[0].overlay.X_world_camera);
  EXPECT_TRUE(screen_.page.view.has_mask);
}

TEST_F(ReplayPresenterTest, SaysWhatCannotBeOpened) {
  ASSERT_TRUE(host::WriteFile(File("text.trocar"), "no recording").ok());
  Open("text.trocar");
  ASSERT_TRUE(screen_.page.failure);
  EXPECT_EQ(screen_.page.failure->code, base::ErrorCode::kRecordingInvalid);
  EXPECT_FALSE(presenter_->IsEnabled(ReplayAction::kTogglePlay));
  presenter_->Do(ReplayAction::kTogglePlay);
  presenter_->Advance(now_);
  presenter_.reset();
  // beside, it leaves what is shown
  Open("a.trocar");
  presenter_->OpenBeside(File("text.trocar"));
  Load();
  EXPECT_FALSE(screen_.page.failure);
  EXPECT_TRUE(screen_.page.is_warning);
  EXPECT_THAT(screen_.page.message, testing::StartsWith("E-REC-001"));
}

TEST_F(ReplayPresenterTest, PlaysWhatIsWholeOfADamagedFileAndSaysSo) {
  const std::string whole = *host::ReadFile(File("a.trocar"));
  ASSERT_TRUE(host::WriteFile(File("cut.trocar"), whole.substr(0, whole.size() / 2)).ok());
  Open("cut.trocar");
  EXPECT_FALSE(screen_.page.failure);
  EXPECT_TRUE(screen_.page.is_warning);
  EXPECT_THAT(screen_.page.message, testing::HasSubstr("damaged"));
  EXPECT_LT(screen_.page.end, 14);
  presenter_->Do(ReplayAction::kToEnd);
  EXPECT_TRUE(StandsAt(screen_.page.end));
}

TEST(ReplayCommands, AreSound) {
  test::ExpectSoundCommands(ReplayCommands());
  test::ExpectWholeHelp(ReplayCommands(), ReplayHelp());
  std::set<ReplayAction> reached{ReplayAction::kNone};
  for (const ReplayCommand& command : ReplayCommands()) reached.insert(command.action);
  EXPECT_EQ(reached.size(), static_cast<std::size_t>(ReplayAction::kClose) + 1);
}

TEST(FormatClock, CountsMinutesSecondsAndTenths) {
  EXPECT_EQ(FormatClock(0), "0:00.0");
  EXPECT_EQ(FormatClock(-3), "0:00.0");
  EXPECT_EQ(FormatClock(65.26), "1:05.3");
  EXPECT_EQ(FormatClock(59.97), "1:00.0");
  EXPECT_EQ(FormatClock(3600), "60:00.0");
}

}  // namespace
}  // namespace trocar::presenter
