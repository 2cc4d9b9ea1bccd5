// SPDX-License-Identifier: Apache-2.0
/// \file centre_presenter.h  Presenter of the training centre's window, without a widget: pages, their sources, who looks.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "trocar/centre/attempt_filing.h"
#include "trocar/centre/centre_commands.h"
#include "trocar/centre/course_page.h"
#include "trocar/centre/exam_page.h"
#include "trocar/centre/group_page.h"
#include "trocar/centre/history_page.h"
#include "trocar/centre/result_page.h"
#include "trocar/gui/background_job.h"

namespace trocar::centre {

enum class PageKind : std::uint8_t { kResult, kHistory, kCourses, kGroup, kExam };

/// All that the window says and shows.
struct CentrePage {
  PageKind kind = PageKind::kHistory;
  std::string who;                   ///< a person's name, for the header
  std::optional<ResultPage> result;  ///< nothing before an attempt was judged
  ReviewPage review;
  HistoryPage history;
  CoursePage courses;
  GroupPage group;
  ExamPage exam;
  std::string busy;         ///< what is being done; empty: nothing
  std::string detail;       ///< of that, how far it is; may be empty
  bool can_cancel = false;  ///< it can be given up
  double progress = -1;     ///< of that, 0 to 1; < 0: not known
  std::string notice;       ///< of what is being measured or waits for the store; empty: nothing
  bool is_help_open = false, is_who_open = false;
  std::uint64_t version = 0;  ///< another number: the shown page is another
};

/// View interface that the presenter drives; a window implements it.
class CentreScreen {
 public:
  virtual ~CentreScreen() = default;
  /// Brings the widgets to what the page and the presenter's commands say.
  virtual void Show(const CentrePage& page) = 0;
  /// A bar that stays until it is closed: code, and what to do.
  virtual void ShowError(const base::Error& error) = 0;
  virtual void ShowNotice(const std::string& text) = 0;
  /// Somebody begins an attempt, in the simulator's window.
  virtual void StartAttempt(const Start& start) = 0;
  /// Somebody begins a task at a level, in the simulator's window.
  virtual void StartTask(const std::string& task, const std::string& level) = 0;
  /// A window of its own plays a recording from a moment on [s].
  virtual void OpenReplay(const std::filesystem::path& recording, double time) = 0;
  virtual void Close() = 0;
};

class CentrePresenter {
 public:
  /// \param filing   nothing: no attempts come from this program. Else it outlives the presenter
  /// \param on_done  called by another thread when Finish() is due
  CentrePresenter(Access access, int threads, CentreScreen& screen, AttemptFiling* filing,
                  std::function<void()> on_done);
  ~CentrePresenter();

  /// Shows a page, and reads what it shows.
  void Open(PageKind kind);
  void Do(CentreAction action);
  bool IsEnabled(CentreAction action) const;
  gui::ButtonState FindButton(const CentreCommand& command) const;
  /// Takes over what is there of what was asked for, and the filing's news. Never waits.
  void Finish();

  /// Sets who works here from now on. \param text  name or pseudonym; empty: nobody in particular
  void BeSomebody(const std::string& text);
  const Access& GetAccess() const { return access_; }
  /// Draws a moment of a recording, on a thread beside the window's. \return the picture's file
  using DrawMoment = std::function<base::Result<std::filesystem::path>(
      const std::filesystem::path& recording, double time, const std::function<bool()>& goes_on)>;
  void SetDrawMoment(DrawMoment draw) { draw_moment_ = std::move(draw); }
  /// Told the pseudonym when somebody else works here.
  void SignalPerson(std::function<void(const std::string&)> on_person) { on_person_ = std::move(on_person); }

  // result
  /// An attempt has ended and is being measured: its page comes by itself.
  void ExpectResult(const std::filesystem::path& recording);
  void Jump(double time);  ///< into the replay, a little before [s]
  void PlayAgain();
  void PlayNext();
  void SaveReport(const std::filesystem::path& path);
  void AddRemark(double time, const std::string& text);
  void Rate(const ReviewPage::Form& form);

  // history
  void ChooseTask(const std::string& task);
  void ChoosePerson(const std::string& pseudonym);
  void GoToNextPage();
  void GoToFirstPage();
  void OpenResultOf(const HistoryPage::Row& row);
  void OpenReplayOf(const HistoryPage::Row& row);

  // courses, groups, exams
  void ChooseCourse(const std::string& course);
  void StartStep(const StepName& step);
  /// Gives up the step that is made ready; what was reached on the way is kept.
  void CancelStep();
  void ChooseGroup(const std::string& group);
  // what an instructor changes of groups
  void MakeGroup(const std::string& name);
  void JoinGroup(const std::string& who);
  void LeaveGroup(const std::string& pseudonym);
  void AssignCourse(const std::string& course, const std::string& due);
  void OpenExamFile(const std::filesystem::path& file);
  void SealExam(const std::string& name, const std::string& task, const std::string& level,
                const std::filesystem::path& file);
  void MakeKeys(const std::filesystem::path& file, const std::string& passphrase);
  void StartExam();
  /// The exam's recording has ended.
  void EndExam(const ExamSitting& sitting, const std::filesystem::path& recording);
  void IssueCertificate(const assessment::SigningKey& key, const std::filesystem::path& file);

  const CentrePage& Page() const { return page_; }
  bool IsBusy() const { return job_.IsRunning(); }

 private:
  /// Done by the window's thread with what the job's thread has found.
  using Apply = std::function<void()>;
  /// Shared with the job's thread; null: the work cannot be given up.
  using Flag = std::shared_ptr<std::atomic<bool>>;
  struct Request {
    std::string busy;
    std::function<Apply()> work;
    Flag is_cancelled;
  };
  void Ask(std::string busy, std::function<Apply()> work, Flag is_cancelled = nullptr);
  void Begin(Request request);
  void Read();
  void ReadHistory(const HistoryQuery& query);
  void ReadReview();
  void ShowMoment();
  void ReadExamChoices();
  void ChangeGroup(std::function<base::Status(const Access&)> change, const std::string& group,
                   const std::string& done);
  void ReadRole();
  void UseResult(const JudgedAttempt& judged);
  void SetExaminee();
  void FollowFiling();
  void ShowPending(const FilingStatus& status);
  void UseFiled(const FiledAttempt& filed, bool is_expected);
  void Fail(const base::Error& error);
  void Refresh(bool is_other);

  Access access_;
  int threads_;
  CentreScreen* screen_;
  AttemptFiling* filing_;
  CentrePage page_;
  store::Attempt shown_;  // of the result page
  std::filesystem::path expected_;
  std::deque<FiledAttempt> recent_;                                // the newest last
  std::map<std::filesystem::path, HistoryPage::Pending> pending_;  // that have been read
  bool is_trainee_ = false;                                        // who works here is one
  gui::JobProgress progress_;
  std::atomic<bool> is_given_up_{false}, is_done_{false};
  Flag is_cancelled_;  // of what runs
  std::deque<Request> waiting_;
  std::function<void(const std::string&)> on_person_;
  std::function<void()> on_done_;
  DrawMoment draw_moment_;
  gui::BackgroundJob<Apply> job_;
};

}  // namespace trocar::centre
