// SPDX-License-Identifier: Apache-2.0
#include "trocar/centre/centre_presenter.h"

#include <algorithm>
#include <utility>

#include "trocar/assessment/judge_recording.h"
#include "trocar/host/log.h"
#include "trocar/host/translate.h"
#include "trocar/record/recording_list.h"

namespace trocar::centre {
namespace {

constexpr std::size_t kMostRecent = 3;  // results that nobody has asked for
constexpr double kLead = 2;             // before an error, so that one sees how it came [s]

PageKind KindOf(CentreAction action) {
  switch (action) {
    case CentreAction::kShowResult:
      return PageKind::kResult;
    case CentreAction::kShowCourses:
      return PageKind::kCourses;
    case CentreAction::kShowGroup:
      return PageKind::kGroup;
    case CentreAction::kShowExam:
      return PageKind::kExam;
    default:
      return PageKind::kHistory;
  }
}

}  // namespace

CentrePresenter::CentrePresenter(Access access, int threads, CentreScreen& screen, AttemptFiling* filing,
                                 std::function<void()> on_done)
    : access_(std::move(access)),
      threads_(threads),
      screen_(&screen),
      filing_(filing),
      on_done_(std::move(on_done)),
      job_([this] {
        is_done_.store(true);
        on_done_();
      }) {
  page_.history.query.person = access_.person;
  SetExaminee();
  if (!access_.person.empty()) ReadRole();
}

CentrePresenter::~CentrePresenter() {
  is_given_up_.store(true);
}

// what is done beside the window

void CentrePresenter::Ask(std::string busy, std::function<Apply()> work, Flag is_cancelled) {
  Request request{std::move(busy), std::move(work), std::move(is_cancelled)};
  if (!job_.IsRunning()) return Begin(std::move(request));
  // who asks twice for the same wants the newer
  std::erase_if(waiting_, [&](const Request& one) { return one.busy == request.busy; });
  waiting_.push_back(std::move(request));
}

void CentrePresenter::Begin(Request request) {
  page_.busy = request.busy;
  page_.detail.clear();
  page_.can_cancel = request.is_cancelled != nullptr;
  is_cancelled_ = std::move(request.is_cancelled);
  progress_.Set("", -1);
  job_.Start(std::move(request.work));
  Refresh(false);
}

void CentrePresenter::Finish() {
  if (!is_done_.exchange(false)) return FollowFiling();
  const Apply apply = job_.Take();
  page_.busy.clear();
  page_.detail.clear();
  page_.can_cancel = false;
  page_.progress = -1;
  if (!waiting_.empty()) {
    Request next = std::move(waiting_.front());
    waiting_.pop_front();
    Begin(std::move(next));
  }
  apply();
  Refresh(true);
}

void CentrePresenter::FollowFiling() {
  if (filing_ != nullptr) {
    const FilingStatus status = filing_->Status();
    page_.notice.clear();
    if (status.waiting > 0) {
      page_.notice = host::TranslateCount(
          "{1} attempt waits on this computer for the store and will arrive by itself",
          "{1} attempts wait on this computer for the store and will arrive by themselves", status.waiting);
      if (status.failure) page_.notice += ": " + host::ShownText(*status.failure);
    }
    ShowPending(status);
    for (FiledAttempt& filed : filing_->TakeFiled()) {
      const bool is_expected = filed.recording == expected_;
      // it may be there before the window that asks for it hears that the attempt is over
      if (!is_expected) recent_.push_back(filed);
      if (recent_.size() > kMostRecent) recent_.pop_front();
      // who reads another result goes on reading it
      if (!is_expected && page_.kind == PageKind::kResult) continue;
      UseFiled(filed, is_expected);
    }
    if (!expected_.empty() && !job_.IsRunning()) page_.progress = status.progress;
  }
  if (job_.IsRunning()) {
    const gui::JobProgress::Value now = progress_.Get();
    page_.progress = now.fraction;
    // what is given up tells no more
    page_.detail = is_cancelled_ != nullptr && is_cancelled_->load() ? "" : now.what;
  }
  Refresh(false);
}

/// What has ended and is not in the history yet.
void CentrePresenter::ShowPending(const FilingStatus& status) {
  if (status.measuring > 0) {
    const std::string measuring = host::TranslateWith(
        "Attempts are being measured, {1} of {2}: {3} %",
        {std::to_string(status.measured + 1), std::to_string(status.measured + status.measuring),
         std::to_string(static_cast<int>(100 * status.progress))});
    page_.notice = page_.notice.empty() ? measuring : measuring + "  ·  " + page_.notice;
  }
  std::vector<HistoryPage::Pending> pending;
  for (const PendingAttempt& one : status.pending) {
    auto known = pending_.find(one.recording);
    if (known == pending_.end()) {
      HistoryPage::Pending row;
      row.recording = one.recording;
      if (const auto summary = record::ReadSummary(one.recording); summary.ok()) {
        row.when = report::FormatDate(summary->description.started);
        row.task = TaskNameOf(assessment::TaskKeyOf(summary->description.name));
        if (!summary->description.level.empty())
          row.task += ", " + host::Translate(summary->description.level);
      } else {
        row.task = one.recording.filename().string();
      }
      known = pending_.emplace(one.recording, std::move(row)).first;
    }
    pending.push_back(known->second);
    pending.back().is_measured_now = one.progress >= 0;
  }
  const auto is_same = [](const HistoryPage::Pending& a, const HistoryPage::Pending& b) {
    return a.recording == b.recording && a.is_measured_now == b.is_measured_now;
  };
  const auto& shown = page_.history.pending;
  if (std::equal(shown.begin(), shown.end(), pending.begin(), pending.end(), is_same)) return;
  page_.history.pending = std::move(pending);
  if (page_.kind == PageKind::kHistory) ++page_.version;
}

void CentrePresenter::UseFiled(const FiledAttempt& filed, bool is_expected) {
  if (is_expected) expected_.clear();
  if (filed.judged) {
    UseResult(*filed.judged);
  } else if (filed.failure && is_expected) {
    page_.kind = PageKind::kHistory;
    Read();
    Fail(*filed.failure);
  }
}

void CentrePresenter::Fail(const base::Error& error) {
  host::Log(host::LogLevel::kWarning, error.Text());
  screen_->ShowError(error);
}

void CentrePresenter::Refresh(bool is_other) {
  if (is_other) ++page_.version;
  page_.who = page_.who.empty() ? NameOf(access_, access_.person) : page_.who;
  screen_->Show(page_);
}

// commands

bool CentrePresenter::IsEnabled(CentreAction action) const {
  for (const CentreCommand& command : CentreCommands()) {
    if (command.action != action) continue;
    switch (command.needs) {
      case CentreNeeds::kNothing:
        return true;
      case CentreNeeds::kResult:
        return page_.result.has_value() || !expected_.empty();
      case CentreNeeds::kInstructor:
        return !is_trainee_;
    }
  }
  return true;
}

gui::ButtonState CentrePresenter::FindButton(const CentreCommand& command) const {
  gui::ButtonState state;
  state.is_enabled = IsEnabled(command.action);
  state.label = command.button.label;
  state.tip = gui::TipText(command.button.tip, command.keys);
  switch (command.action) {
    case CentreAction::kShowResult:
    case CentreAction::kShowHistory:
    case CentreAction::kShowCourses:
    case CentreAction::kShowGroup:
    case CentreAction::kShowExam:
      state.is_checked = page_.kind == KindOf(command.action);
      break;
    case CentreAction::kWho:
      state.is_checked = page_.is_who_open;
      if (!access_.person.empty()) state.label = page_.who;
      break;
    case CentreAction::kToggleHelp:
      state.is_checked = page_.is_help_open;
      break;
    default:
      break;
  }
  return state;
}

void CentrePresenter::Do(CentreAction action) {
  if (!IsEnabled(action)) return Refresh(false);
  switch (action) {
    case CentreAction::kShowResult:
    case CentreAction::kShowHistory:
    case CentreAction::kShowCourses:
    case CentreAction::kShowGroup:
    case CentreAction::kShowExam:
      return Open(KindOf(action));
    case CentreAction::kReload:
      return Read();
    case CentreAction::kWho:
      page_.is_who_open = !page_.is_who_open;
      page_.is_help_open = false;
      return Refresh(false);
    case CentreAction::kToggleHelp:
      page_.is_help_open = !page_.is_help_open;
      page_.is_who_open = false;
      return Refresh(false);
    case CentreAction::kCloseCards:
      page_.is_help_open = page_.is_who_open = false;
      return Refresh(false);
    case CentreAction::kClose:
      return screen_->Close();
  }
}

void CentrePresenter::Open(PageKind kind) {
  page_.kind = kind;
  page_.is_help_open = page_.is_who_open = false;
  Refresh(true);
  Read();
}

/// Reads what the page shows.
void CentrePresenter::Read() {
  switch (page_.kind) {
    case PageKind::kResult:
      return ReadReview();
    case PageKind::kHistory:
      return ReadHistory(page_.history.query);
    case PageKind::kCourses:
      return ChooseCourse(page_.courses.course);
    case PageKind::kGroup:
      return ChooseGroup(page_.group.group);
    case PageKind::kExam:
      return ReadExamChoices();
  }
}

void CentrePresenter::BeSomebody(const std::string& text) {
  page_.is_who_open = false;
  struct Found {
    base::Result<std::string> pseudonym;
    bool is_trainee = false;
    std::string name;
  };
  Ask(host::Translate("Looking for you"), [this, access = access_, text]() -> Apply {
    auto found =
        std::make_shared<Found>(Found{FindPseudonym(access, text)});  // a function's content is copied
    if (found->pseudonym.ok()) {
      found->name = NameOf(access, *found->pseudonym);
      Access theirs = access;
      theirs.person = *found->pseudonym;
      const auto desk = OpenDesk(theirs);
      found->is_trainee = !text.empty() && (!desk.ok() || desk->viewer.role == store::Role::kTrainee);
    }
    return [this, found] {
      if (!found->pseudonym.ok()) return Fail(found->pseudonym.error());
      access_.person = *found->pseudonym;
      is_trainee_ = found->is_trainee;
      page_.who = found->name;
      // what was sat is certified to who sat it
      if (page_.exam.recording.empty()) SetExaminee();
      page_.history.query = {access_.person, page_.history.query.task, {}};
      if (filing_ != nullptr) filing_->SetPerson(access_.person);
      if (on_person_) on_person_(access_.person);
      if (page_.kind == PageKind::kGroup && is_trainee_) page_.kind = PageKind::kHistory;
      Read();
    };
  });
}

/// Groups are for instructors. Where the store is away, nobody is one.
void CentrePresenter::ReadRole() {
  is_trainee_ = true;
  Ask(host::Translate("Looking for you"), [this, access = access_]() -> Apply {
    const auto desk = OpenDesk(access);
    return [this, is_trainee = !desk.ok() || desk->viewer.role == store::Role::kTrainee] {
      is_trainee_ = is_trainee;
    };
  });
}

// result

void CentrePresenter::ExpectResult(const std::filesystem::path& recording) {
  expected_ = recording;
  page_.result.reset();
  page_.review = {};
  page_.kind = PageKind::kResult;
  Refresh(true);
  const auto known = std::find_if(recent_.begin(), recent_.end(),
                                  [&](const FiledAttempt& one) { return one.recording == recording; });
  if (known != recent_.end()) UseFiled(*known, true);
}

void CentrePresenter::UseResult(const JudgedAttempt& judged) {
  shown_ = judged.attempt;
  page_.result = MakeResultPage(judged, nullptr);
  page_.review = {};
  Refresh(true);
  // the person's best and what others have said come from the store
  Ask(host::Translate("Reading the store"), [this, access = access_, judged]() -> Apply {
    auto page = std::make_shared<ResultPage>(MakeResultPage(judged, &access));
    return [this, page, id = judged.attempt.recording_id] {
      if (shown_.recording_id == id) page_.result = *page;
      ReadReview();
      ShowMoment();
    };
  });
}

/// A picture beside what is to be done better first.
void CentrePresenter::ShowMoment() {
  if (!draw_moment_ || !page_.result || !page_.result->first_time || !page_.result->moment.empty()) return;
  Ask(host::Translate("Drawing the moment"),
      [this, draw = draw_moment_, recording = page_.result->recording,
       time = page_.result->begin + *page_.result->first_time, id = shown_.recording_id]() -> Apply {
        const auto drawn = draw(recording, time, [this] { return !is_given_up_.load(); });
        // a picture that cannot be drawn is no reason for a message: the button beside it opens the replay
        if (!drawn.ok()) host::Log(host::LogLevel::kWarning, drawn.error().Text());
        return [this, id, picture = drawn.ok() ? *drawn : std::filesystem::path()] {
          if (shown_.recording_id == id && page_.result) page_.result->moment = picture;
        };
      });
}

void CentrePresenter::ReadReview() {
  if (!page_.result || shown_.recording_id.empty()) return;
  Ask(host::Translate("Reading remarks"), [this, access = access_, shown = shown_]() -> Apply {
    auto review = std::make_shared<base::Result<ReviewPage>>(LoadReview(access, shown));
    return [this, review, id = shown.recording_id] {
      if (!review->ok()) return Fail(review->error());
      if (shown_.recording_id == id) page_.review = **review;
    };
  });
}

void CentrePresenter::Jump(double time) {
  if (page_.result)
    screen_->OpenReplay(page_.result->recording, page_.result->begin + std::max(0.0, time - kLead));
}

void CentrePresenter::PlayAgain() {
  if (!page_.result) return;
  if (page_.result->step.IsSet()) return StartStep(page_.result->step);
  screen_->StartTask(shown_.task, shown_.level);
}

void CentrePresenter::PlayNext() {
  if (!page_.result) return;
  if (page_.result->step.IsSet() || page_.result->advice.empty() || page_.result->advice[0].exercise.empty())
    return Open(PageKind::kCourses);
  screen_->StartTask(page_.result->advice[0].exercise, "normal");
}

void CentrePresenter::SaveReport(const std::filesystem::path& path) {
  if (!page_.result) return;
  Ask(host::Translate("Writing the report"), [this, report = page_.result->report, path]() -> Apply {
    return [this, path, saved = centre::SaveReport(report, path)] {
      saved.ok() ? screen_->ShowNotice(host::TranslateWith("Saved {1}", {path.string()}))
                 : Fail(saved.error());
    };
  });
}

void CentrePresenter::AddRemark(double time, const std::string& text) {
  if (text.empty()) return;
  Ask(host::Translate("Keeping the remark"),
      [this, access = access_, review = page_.review, time, text]() -> Apply {
        return [this, kept = KeepRemark(access, review, time, text)] {
          if (!kept.ok()) Fail(kept.error());
          ReadReview();
        };
      });
}

void CentrePresenter::Rate(const ReviewPage::Form& form) {
  Ask(host::Translate("Keeping the rating"),
      [this, access = access_, review = page_.review, form]() -> Apply {
        return [this, kept = KeepRating(access, review, form), name = form.name] {
          if (!kept.ok()) return Fail(kept.error());
          screen_->ShowNotice(host::TranslateWith("The {1} rating is kept.", {name}));
          ReadReview();
        };
      });
}

// history

void CentrePresenter::ReadHistory(const HistoryQuery& query) {
  page_.history.query = query;
  Ask(host::Translate("Reading the history"), [this, access = access_, query]() -> Apply {
    auto history = std::make_shared<base::Result<HistoryPage>>(LoadHistory(access, query));
    return [this, history] {
      if (!history->ok()) return Fail(history->error());
      std::swap((*history)->pending, page_.history.pending);  // those the filing knows, not the store
      page_.history = **history;
    };
  });
}

void CentrePresenter::ChooseTask(const std::string& task) {
  if (task == page_.history.query.task) return;
  ReadHistory({page_.history.query.person, task, {}});
}

void CentrePresenter::ChoosePerson(const std::string& pseudonym) {
  page_.kind = PageKind::kHistory;
  ReadHistory({pseudonym, page_.history.query.task, {}});
}

void CentrePresenter::GoToNextPage() {
  const HistoryPage& now = page_.history;
  if (!now.next.empty()) ReadHistory({now.query.person, now.query.task, now.next});
}

void CentrePresenter::GoToFirstPage() {
  ReadHistory({page_.history.query.person, page_.history.query.task, {}});
}

void CentrePresenter::OpenResultOf(const HistoryPage::Row& row) {
  if (row.recording.empty()) return;
  page_.kind = PageKind::kResult;
  page_.result.reset();
  page_.review = {};
  expected_ = row.recording;
  JudgeSettings settings;
  settings.threads = threads_;
  settings.person = row.attempt.trainee;
  settings.step = FindStepName(row.attempt);
  settings.progress = [this](double share) {
    progress_.Set("", share);
    on_done_();
    return !is_given_up_.load();
  };
  Ask(host::Translate("Playing the attempt again, to judge it"),
      [this, path = row.recording, settings]() -> Apply {
        auto judged = std::make_shared<base::Result<JudgedAttempt>>(JudgeRecording(path, settings));
        return [this, judged, path] {
          if (expected_ == path) expected_.clear();
          if (!judged->ok()) {
            page_.kind = PageKind::kHistory;
            return Fail(judged->error());
          }
          UseResult(**judged);
        };
      });
  Refresh(true);
}

void CentrePresenter::OpenReplayOf(const HistoryPage::Row& row) {
  if (!row.recording.empty()) screen_->OpenReplay(row.recording, 0);
}

// courses, groups, exams

void CentrePresenter::ChooseCourse(const std::string& course) {
  Ask(host::Translate("Reading the course"), [this, access = access_, course]() -> Apply {
    auto loaded = std::make_shared<base::Result<LoadedCourse>>(LoadCourse(access, course));
    return [this, loaded] {
      if (!loaded->ok()) return Fail(loaded->error());
      page_.courses = (*loaded)->page;
      if ((*loaded)->store_failure) Fail(*(*loaded)->store_failure);
    };
  });
}

void CentrePresenter::StartStep(const StepName& name) {
  auto is_cancelled = std::make_shared<std::atomic<bool>>(false);
  Ask(
      host::Translate("Making the step ready; where it begins in the middle of an operation the expert "
                      "operates up to there, once"),
      [this, name, is_cancelled]() -> Apply {
        auto start = std::make_shared<base::Result<Start>>(
            PrepareStart(name, [this, &is_cancelled](const assessment::PreparationProgress& now) {
              progress_.Set(DescribePreparation(now), now.share);
              on_done_();
              return !is_given_up_.load() && !is_cancelled->load();
            }));
        return [this, start, is_cancelled] {
          // nobody made a mistake
          if (is_cancelled->load()) return;
          if (!start->ok()) return Fail(start->error());
          screen_->StartAttempt(**start);
        };
      },
      is_cancelled);
}

void CentrePresenter::CancelStep() {
  if (!page_.can_cancel) return;
  is_cancelled_->store(true);
  page_.can_cancel = false;
  page_.busy = host::Translate("Giving it up");
  progress_.Set("", -1);
  Refresh(false);
}

void CentrePresenter::ChooseGroup(const std::string& group) {
  Ask(host::Translate("Reading the group"), [this, access = access_, group]() -> Apply {
    auto loaded = std::make_shared<base::Result<GroupPage>>(LoadGroup(access, group));
    return [this, loaded] {
      if (!loaded->ok()) return Fail(loaded->error());
      page_.group = **loaded;
    };
  });
}

/// Changes something in the store and reads the group again.
void CentrePresenter::ChangeGroup(std::function<base::Status(const Access&)> change, const std::string& group,
                                  const std::string& done) {
  Ask(host::Translate("Changing the group"),
      [this, access = access_, change = std::move(change), group, done]() -> Apply {
        return [this, group, done, changed = change(access)] {
          if (!changed.ok()) return Fail(changed.error());
          screen_->ShowNotice(done);
          ChooseGroup(group);
        };
      });
}

void CentrePresenter::MakeGroup(const std::string& name) {
  if (name.empty()) return;
  ChangeGroup([name](const Access& access) { return centre::MakeGroup(access, name); }, name,
              host::TranslateWith("The group \"{1}\" is there.", {name}));
}

void CentrePresenter::JoinGroup(const std::string& who) {
  const std::string group = page_.group.group;
  if (who.empty() || group.empty()) return;
  ChangeGroup([group, who](const Access& access) { return centre::JoinGroup(access, group, who); }, group,
              host::TranslateWith("{1} is in the group.", {who}));
}

void CentrePresenter::LeaveGroup(const std::string& pseudonym) {
  const std::string group = page_.group.group;
  ChangeGroup(
      [group, pseudonym](const Access& access) { return centre::LeaveGroup(access, group, pseudonym); },
      group, host::TranslateWith("{1} has left the group.", {NameOf(access_, pseudonym)}));
}

void CentrePresenter::AssignCourse(const std::string& course, const std::string& due) {
  const std::string group = page_.group.group;
  if (group.empty() || course.empty()) return;
  ChangeGroup(
      [group, course, due](const Access& access) { return centre::AssignCourse(access, group, course, due); },
      group, host::Translate("The course is assigned; members find it at Courses."));
}

void CentrePresenter::ReadExamChoices() {
  if (!page_.exam.choices.empty()) return;
  Ask(host::Translate("Reading the tasks"), [this]() -> Apply {
    auto choices = std::make_shared<base::Result<std::vector<ExamChoice>>>(ListExamChoices());
    return [this, choices] {
      if (!choices->ok()) return Fail(choices->error());
      page_.exam.choices = **choices;
    };
  });
}

void CentrePresenter::SealExam(const std::string& name, const std::string& task, const std::string& level,
                               const std::filesystem::path& file) {
  Ask(host::Translate("Sealing the exam"), [this, name, task, level, file]() -> Apply {
    auto sealed = std::make_shared<base::Result<ExamPage>>(SealExamFile(name, task, level, file));
    return [this, sealed, file] {
      if (!sealed->ok()) return Fail(sealed->error());
      std::swap((*sealed)->choices, page_.exam.choices);
      page_.exam = **sealed;
      SetExaminee();
      screen_->ShowNotice(host::TranslateWith(
          "Sealed. Keep {1} secret until the exam is over, and publish the file beside it before.",
          {file.filename().string()}));
    };
  });
}

void CentrePresenter::MakeKeys(const std::filesystem::path& file, const std::string& passphrase) {
  Ask(host::Translate("Making the keys"), [this, file, passphrase]() -> Apply {
    return [this, file, made = MakeCentreKeys(file, passphrase)] {
      made.ok() ? screen_->ShowNotice(host::TranslateWith(
                      "The keys are made. {1}.key signs certificates: keep it secret. Publish {1}.pub.",
                      {file.stem().string()}))
                : Fail(made.error());
    };
  });
}

void CentrePresenter::OpenExamFile(const std::filesystem::path& file) {
  page_.kind = PageKind::kExam;
  Ask(host::Translate("Opening the exam"), [this, file]() -> Apply {
    auto opened = std::make_shared<base::Result<ExamPage>>(OpenExam(file));
    return [this, opened] {
      if (!opened->ok()) return Fail(opened->error());
      std::swap((*opened)->choices, page_.exam.choices);
      page_.exam = **opened;
      SetExaminee();
    };
  });
}

/// Whoever works here sits the exam.
void CentrePresenter::SetExaminee() {
  page_.exam.examinee = access_.person;
  page_.exam.examinee_name = access_.person.empty() ? "" : NameOf(access_, access_.person);
}

void CentrePresenter::StartExam() {
  page_.exam.recording.clear();
  page_.exam.certificate.clear();
  page_.exam.finding.clear();
  Ask(host::Translate("Making the exam ready"), [this, page = page_.exam]() -> Apply {
    auto start = std::make_shared<base::Result<Start>>(PrepareExam(page));
    return [this, start] {
      if (!start->ok()) return Fail(start->error());
      screen_->StartAttempt(**start);
    };
  });
}

void CentrePresenter::EndExam(const ExamSitting& sitting, const std::filesystem::path& recording) {
  page_.kind = PageKind::kExam;
  Ask(host::Translate("Opening the exam"), [this, access = access_, sitting, recording]() -> Apply {
    auto opened = std::make_shared<base::Result<ExamPage>>(OpenExam(sitting.file));
    if (opened->ok()) {
      (*opened)->examinee = sitting.examinee;
      (*opened)->examinee_name = NameOf(access, sitting.examinee);
    }
    return [this, opened, recording] {
      if (!opened->ok()) return Fail(opened->error());
      page_.exam = **opened;
      page_.exam.recording = recording;
    };
  });
}

void CentrePresenter::IssueCertificate(const assessment::SigningKey& key, const std::filesystem::path& file) {
  Ask(host::Translate("Computing the exam again, to sign what it came to"),
      [this, access = access_, page = page_.exam, key, file]() -> Apply {
        auto issued = std::make_shared<base::Result<ExamPage>>(
            IssueExamCertificate(access, page, key, file, [this](double share) {
              progress_.Set("", share);
              on_done_();
              return !is_given_up_.load();
            }));
        return [this, issued] {
          if (!issued->ok()) return Fail(issued->error());
          page_.exam = **issued;
        };
      });
}

}  // namespace trocar::centre
