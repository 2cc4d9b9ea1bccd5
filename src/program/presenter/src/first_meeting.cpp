// SPDX-License-Identifier: Apache-2.0
// Of the simulator's presenter: the home page, the tutorial, what a person has set, and what is asked before an attempt is
// thrown away.
#include <algorithm>
#include <cmath>
#include <system_error>
#include <utility>

#include "trocar/host/log.h"
#include "trocar/host/translate.h"
#include "trocar/presenter/guides.h"
#include "trocar/presenter/patient_list.h"
#include "trocar/presenter/read_outs.h"
#include "trocar/presenter/simulator_presenter.h"
#include "trocar/report/attempt_report.h"
#include "trocar/scene/procedure.h"

namespace trocar::presenter {
namespace {

/// A shorter attempt is not worth a question [s].
constexpr double kWorthAsking = 5.0;

std::string DescribeProgress(const scene::Scene& scene, const simulation::Snapshot& snapshot,
                             const OperationEnd& end) {
  constexpr const char* kBetween = "   ·   ";
  if (scene.task) {
    const TaskReadOut task = DescribeTask(*scene.task, snapshot.task);
    return task.time + kBetween + task.progress + kBetween + task.next;
  }
  std::string text = FormatTime(snapshot.time);
  if (!scene.operation) return text;
  if (std::isfinite(end.TimeLimit()))
    text = FormatTime(end.Elapsed(snapshot)) + " / " + FormatTime(end.TimeLimit());
  text += kBetween + report::PhaseName(std::string(
                         scene::PhaseName(scene.operation->procedure, snapshot.operation.procedure.phase)));
  for (const instrument::Hand hand : {instrument::kLeft, instrument::kRight})
    text += kBetween + ToolLabel(scene, snapshot, hand);
  return text;
}

}  // namespace

bool SimulatorPresenter::HasCard() const {
  return page_.is_task_list_open || page_.is_result_open || page_.is_recording_list_open ||
         page_.is_patient_list_open || page_.is_key_list_open || page_.is_rehearsal_open ||
         !page_.question.empty() || (page_.is_home_open && control_ != nullptr);
}

void SimulatorPresenter::CloseCards() {
  page_.is_task_list_open = page_.is_result_open = page_.is_recording_list_open = page_.is_home_open = false;
  page_.is_patient_list_open = page_.is_key_list_open = page_.is_rehearsal_open = false;
}

void SimulatorPresenter::OpenHome() {
  if (page_.failure) return;
  if (control_ != nullptr) control_->SetPaused(true);
  screen_->ReleasePointer();
  page_.is_help_open = false;
  CloseCards();
  page_.is_home_open = true;
  if (const auto who = screen_->BeSomebody({}); who.ok()) page_.home.who = who->name;
  screen_->RequestBest();
  Refresh();
}

/// Whoever operated here last is there again, unless the command line names somebody.
void SimulatorPresenter::MeetAgain() {
  if (settings_.person.empty() || !options_.trainee.empty()) return;
  if (const auto who = screen_->BeSomebody(settings_.person); !who.ok())
    host::Log(host::LogLevel::kWarning, who.error().Text());
}

/// The next step of the course and the last result, where they are known.
void SimulatorPresenter::FindLeads() {
  next_lead_.reset();
  result_lead_.reset();
  if (!leads_.next && !leads_.last) return;
  const auto tasks = LoadTaskPage(TaskSection::kAll, options_.operation.patient);
  const auto picture = [&](const std::string& task) -> std::filesystem::path {
    if (!tasks.ok()) return {};
    for (const TaskPage::Group& group : tasks->groups) {
      for (const TaskPage::Row& row : group.rows) {
        if (row.request.task == (task.empty() ? kOperationTask : task)) return row.picture;
      }
    }
    return {};
  };
  if (leads_.next)
    next_lead_ = HomeLead{host::TranslateWith("Next in {1}", {leads_.next->course}),
                          leads_.next->title + (leads_.next->due.empty() ? "" : "  ·  " + leads_.next->due),
                          picture(leads_.next->task)};
  if (leads_.last)
    result_lead_ = HomeLead{host::TranslateWith("Last result: {1}", {leads_.last->title}),
                            leads_.last->outcome, picture(leads_.last->task)};
}

/// What could not be opened is said on the home page, which leads on.
void SimulatorPresenter::LeadOn(const base::Error& error) {
  host::Log(host::LogLevel::kError, error.Text());
  options_.task.clear();
  options_.scene.clear();
  options_.operation.part.clear();
  start_.reset();
  LeaveTutorial();
  page_.home.problem = error;
  // a patient that has vanished is not asked for again; the home page says who is operated on now
  std::error_code ignored;
  const bool is_gone = !options_.operation.patient.empty() &&
                       !std::filesystem::exists(options_.operation.patient / "patient.json", ignored);
  if (is_gone) {
    options_.operation.patient.clear();
    settings_.patient.clear();
    KeepSettings();
  }
  OpenHome();
}

void SimulatorPresenter::Choose(HomeChoice choice) {
  if (loading_.IsRunning()) return;
  page_.home.problem.reset();
  TaskRequest request;
  switch (choice) {
    case HomeChoice::kContinue:
      if (control_ != nullptr) {
        page_.is_home_open = false;
        screen_->FocusPicture();
        return Refresh();
      }
      request.task = settings_.last_task;
      request.part = settings_.last_part;
      request.choice.patient_folder = options_.operation.patient;
      request.choice.level = settings_.last_level;
      request.choice.seed = settings_.last_seed;
      return request.task.empty() ? Refresh() : Open(request);
    case HomeChoice::kNextStep:
      return leads_.next ? screen_->StartStep(leads_.next->name) : Refresh();
    case HomeChoice::kLastResult:
      return leads_.last ? screen_->OpenLastResult(*leads_.last) : Refresh();
    case HomeChoice::kTutorial:
      // what is open may be an attempt, which is asked for
      if (control_ != nullptr && !tutorial_.IsOn()) return Do(Action::kToggleTutorial);
      return BeginTutorial();
    case HomeChoice::kBasicSkills:
      return OpenTaskList(TaskSection::kBasicSkills);
    case HomeChoice::kOperation:
      return OpenTaskList(TaskSection::kOperation);
    case HomeChoice::kPatients:
      return OpenPatientList();
    case HomeChoice::kKeys:
      return OpenKeyList();
    case HomeChoice::kResults:
      return Do(Action::kOpenCentre);
    case HomeChoice::kRecordings:
      return OpenRecordingList();
  }
}

void SimulatorPresenter::BeSomebody(const std::string& text) {
  const auto who = screen_->BeSomebody(text);
  page_.home.problem.reset();
  // they were somebody else's
  best_.clear();
  leads_ = {};
  FindLeads();
  if (who.ok()) {
    page_.home.who = who->name;
    settings_.person = who->pseudonym;
    KeepSettings();
    screen_->RequestBest();
  } else {
    page_.home.problem = who.error();
  }
  Refresh();
}

// settings

void SimulatorPresenter::KeepSettings() {
  if (options_.settings.empty()) return;
  const base::Status saved = SaveWindowSettings(options_.settings, settings_);
  if (saved) return;
  host::Log(host::LogLevel::kWarning, saved.error().Text());
  Announce(host::TranslateWith("The window's settings cannot be kept: {1}", {host::ShownText(saved.error())}),
           true);
  options_.settings.clear();  // said once
}

void SimulatorPresenter::KeepLast() {
  const bool is_part = start_ && !start_->step.IsSet() && !start_->exam;
  if ((start_ && !is_part) || options_.task.empty() || tutorial_.IsOn() || unattended_.IsOn()) return;
  settings_.last_task = options_.task;
  settings_.last_part = options_.operation.part;
  settings_.last_level = options_.level;
  settings_.last_seed = options_.seed;
  KeepSettings();
}

void SimulatorPresenter::ToggleLeftHanded() {
  settings_.is_left_handed = !settings_.is_left_handed;
  bindings_.SetLayout(settings_.is_left_handed ? KeyLayout::kLeftHanded : KeyLayout::kRightHanded);
  if (control_ != nullptr) control_->Device().ReleaseAll();
  Announce(settings_.is_left_handed
               ? bindings_.Fill(host::Translate(
                     "Left-handed: mouse buttons and letters have changed sides. {help} shows them."))
               : host::Translate("Right-handed."));
  KeepSettings();
}

// tutorial

void SimulatorPresenter::ToggleTutorial() {
  if (!tutorial_.IsOn()) return BeginTutorial();
  tutorial_.Leave();
  Announce(bindings_.Fill(host::Translate(
      "The tutorial goes on where you left it. What you do now is no attempt; {reset} begins one.")));
}

void SimulatorPresenter::BeginTutorial() {
  if (loading_.IsRunning()) return;
  TaskRequest request;
  request.task = kTutorialTask;
  request.choice.patient_folder = options_.operation.patient;
  Open(request);
  // the scene is read beside the window: whoever makes its session finds the tutorial on
  tutorial_.Begin(settings_.tutorial_step >= kTutorialSteps ? 0 : settings_.tutorial_step);
  is_practice_ = true;
  Refresh();
}

/// Whatever is opened from now on is an attempt.
void SimulatorPresenter::LeaveTutorial() {
  tutorial_.Leave();
  is_practice_ = false;
}

void SimulatorPresenter::StartTutorialTask() {
  TaskRequest request;
  request.task = kTutorialTask;
  request.choice.patient_folder = options_.operation.patient;
  Open(request);
}

void SimulatorPresenter::FollowTutorial(const simulation::Snapshot& snapshot) {
  if (!tutorial_.IsOn()) return;
  const TutorialSight sight{&snapshot,
                            &control_->GetInput(),
                            control_->GetHand(),
                            screen_->IsPointerTaken(),
                            control_->IsLaparoscopeHeld(),
                            control_->IsPaused()};
  if (!tutorial_.Observe(sight)) return;
  settings_.tutorial_step = tutorial_.Step();
  KeepSettings();
  Refresh();
}

OperationStep SimulatorPresenter::NextOperationStep() const {
  if (control_ == nullptr || !HasGuides() || tutorial_.IsOn() || control_->IsDemonstration() ||
      is_attempt_over_)
    return {};
  if (!control_->GetScene().operation || control_->GetScene().task) return {};
  return FindOperationStep(control_->GetScene(), control_->Strands(), control_->Now(),
                           operation_end_.Reached());
}

// questions

bool SimulatorPresenter::MustAsk(Action action) const {
  if (action != Action::kQuit && action != Action::kToggleDemonstration && action != Action::kToggleTutorial)
    return false;
  if (action == Action::kQuit && may_leave_) return false;
  if (asked_ == action || unattended_.IsOn() || control_ == nullptr || page_.failure) return false;
  return !control_->IsDemonstration() && !is_attempt_over_ && !is_practice_ &&
         attempt_seconds_ > kWorthAsking;
}

void SimulatorPresenter::Answer(bool is_yes) {
  const Action asked = asked_;
  if (is_yes && asked != Action::kNone) return Do(asked);
  asked_ = Action::kNone;
  screen_->FocusPicture();
  Refresh();
}

// what is shown

Situation SimulatorPresenter::MakeSituation() {
  Situation situation;
  situation.is_pointer_taken = screen_->IsPointerTaken();
  situation.bindings = &bindings_;
  situation.is_fulcrum_mirrored = settings_.is_fulcrum_mirrored;
  situation.is_loaded = control_ != nullptr;
  situation.is_loading = loading_.IsRunning();
  situation.device = options_.device;
  if (control_ == nullptr) return situation;
  situation.is_paused = control_->IsPaused();
  situation.is_demonstration = control_->IsDemonstration();
  situation.is_demonstration_over = control_->IsDemonstrationOver();
  situation.is_laparoscope_held = control_->IsLaparoscopeHeld();
  situation.is_camera_task = control_->IsCameraTask() && situation.is_laparoscope_held;
  situation.has_camera_holder = control_->HasCameraHolder();
  situation.is_right_hand = control_->GetHand() == device::kRightHand;
  situation.is_slow = control_->IsSlowMotion();
  const scene::Scene& scene = control_->GetScene();
  for (const scene::InstrumentSetup& setup : scene.instruments)
    situation.has_tools = situation.has_tools || setup.tray.size() > 1;
  const simulation::Snapshot& now = control_->Now();
  situation.left_jaws = DescribeJaws(scene, now, instrument::kLeft);
  situation.right_jaws = DescribeJaws(scene, now, instrument::kRight);
  return situation;
}

void SimulatorPresenter::RefreshFirstMeeting() {
  page_.is_left_handed = settings_.is_left_handed;
  page_.is_panel_open = settings_.has_panel && control_ != nullptr && !IsExam();
  page_.tutorial = page_.failure ? "" : tutorial_.Text(bindings_);
  page_.is_tutorial_done = !page_.tutorial.empty() && tutorial_.IsDone();
  const std::string_view next = page_.failure ? std::string_view() : NextOperationStep().text;
  page_.next_step = next.empty() ? "" : bindings_.Fill(host::Translate(next));
  page_.progress = control_ == nullptr || page_.failure
                       ? ""
                       : DescribeProgress(control_->GetScene(), control_->Now(), operation_end_);
  page_.question =
      asked_ == Action::kQuit
          ? host::Translate("Leave Trocar? The attempt ends here; what is recorded of it is kept.")
      : asked_ == Action::kToggleDemonstration
          ? host::Translate("Play the demonstration? It begins anew, and your attempt ends here.")
      : asked_ == Action::kToggleTutorial
          ? host::Translate("Begin the tutorial? Your attempt ends here; what is recorded of it is kept.")
          : "";
  if (!page_.is_home_open) return;
  page_.home = MakeHomePage(settings_, page_.home.who, page_.home.problem);
  page_.home.next = next_lead_;
  page_.home.result = result_lead_;
  page_.home.patient = ShortPatientName(options_.operation.patient);
  if (control_ != nullptr) {
    page_.home.last_title = host::Translate("Go on");
    page_.home.last = host::Translate("Back to what is open");
  }
  page_.hint.clear();
  page_.badge.clear();
}

}  // namespace trocar::presenter
