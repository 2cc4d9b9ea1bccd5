// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/simulator_presenter.h"

#include <algorithm>
#include <cstdio>
#include <span>
#include <utility>

#include "trocar/host/log.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/translate.h"

namespace trocar::presenter {
namespace {

constexpr double kForcePeriod = 0.1;   // between refreshes of the forces [s]
constexpr double kTimesPeriod = 0.25;  // between refreshes of the other numbers [s]

}  // namespace

SimulatorPresenter::SimulatorPresenter(const Options& options, const host::Stopwatch& since_start,
                                       SimulatorScreen& screen, std::function<void()> on_loaded,
                                       AttemptHooks hooks)
    : options_(options),
      hooks_(std::move(hooks)),
      since_start_(since_start),
      screen_(&screen),
      unattended_(options),
      loading_(std::move(on_loaded)) {
  if (options_.settings.empty()) return;
  LoadedWindowSettings loaded = LoadWindowSettings(options_.settings);
  settings_ = std::move(loaded.settings);
  UseBindings();
  // whoever names a patient means this one, and is asked again the next time
  if (options_.operation.patient.empty()) options_.operation.patient = settings_.patient;
  if (!loaded.complaint) return;
  host::Log(host::LogLevel::kWarning, loaded.complaint->Text());
  // shown with the first page: the screen is not ready yet
  page_.event = host::TranslateWith("The window's settings are the usual ones: {1}",
                                    {host::ShownText(*loaded.complaint)});
  page_.is_event_warning = true;
  page_.home.problem = loaded.complaint;
  options_.settings.clear();  // the file stays as it is, for whoever can mend it
}

// commands

bool SimulatorPresenter::Meets(SimulatorNeeds needs) const {
  const bool is_good = !page_.failure;
  switch (needs) {
    case SimulatorNeeds::kNothing:
      return true;
    case SimulatorNeeds::kNoFailure:
      return is_good;
    case SimulatorNeeds::kScene:
      return is_good && control_ != nullptr;
    case SimulatorNeeds::kScript:
      return is_good && control_ != nullptr && has_script_ && !IsExam();
    case SimulatorNeeds::kGuidance:
      return is_good && control_ != nullptr && !IsExam();
    case SimulatorNeeds::kHelp:
      return is_good && control_ != nullptr && IsGuided();
    case SimulatorNeeds::kHaptics:
      return is_good && control_ != nullptr && control_->Haptics() != nullptr;
  }
  return false;
}

bool SimulatorPresenter::IsEnabled(Action action) const {
  return Meets(FindNeeds(action));
}

bool SimulatorPresenter::IsChecked(Action action) const {
  const Handler* handler = gui::FindHandler(Handlers(), action);
  return handler != nullptr && handler->is_checked != nullptr && handler->is_checked(*this);
}

/// What is, not what was asked for.
bool SimulatorPresenter::IsForceOn() const {
  if (control_ == nullptr || control_->Haptics() == nullptr) return false;
  const session::HapticStatus& status = control_->Haptics()->Latest();
  return std::any_of(status.hands.begin(), status.hands.end(), [](const session::HapticHandStatus& hand) {
    return hand.state != haptics::ArmState::kUnarmed;
  });
}

gui::ButtonState SimulatorPresenter::FindButton(const SimulatorCommand& command) const {
  const Action action = command.action.action;
  gui::ButtonState state;
  state.is_enabled = Meets(command.needs);
  state.is_checked = IsChecked(action);
  state.is_shown = command.needs != SimulatorNeeds::kHaptics || !options_.haptics.empty() ||
                   (control_ != nullptr && control_->Haptics() != nullptr);
  state.label = command.button.label;
  if (action == Action::kTogglePause && control_ != nullptr && !control_->IsPaused()) state.label = "Pause";
  state.tip = gui::TipText(command.button.tip, bindings_.StrokesOf(command));
  return state;
}

void SimulatorPresenter::Do(Action action) {
  if (!IsEnabled(action)) return Refresh();
  if (MustAsk(action)) {
    asked_ = action;
    screen_->ReleasePointer();
    if (control_ != nullptr) control_->SetPaused(true);
    return Refresh();
  }
  // the window's frame asks once more as it closes
  may_leave_ = may_leave_ || (action == Action::kQuit && asked_ == action);
  asked_ = Action::kNone;
  const Handler* handler = gui::FindHandler(Handlers(), action);
  if (handler == nullptr) {
    screen_->DoInWindow(action);
  } else {
    handler->run(*this);
  }
  Refresh();
}

std::span<const SimulatorPresenter::Handler> SimulatorPresenter::Handlers() noexcept {
  using Self = SimulatorPresenter;
  static constexpr Handler kHandlers[] = {
      // the simulation
      {Action::kTogglePause, [](Self& self) { self.SetPaused(!self.control_->IsPaused()); }},
      {Action::kReset, [](Self& self) { self.Reset(); }},
      {Action::kFinish, [](Self& self) { self.Finish(); }},
      {Action::kToggleDemonstration,
       [](Self& self) { self.SetDemonstration(!self.control_->IsDemonstration()); },
       [](const Self& self) { return self.control_ != nullptr && self.control_->IsDemonstration(); }},
      // hands
      {Action::kNextTool, [](Self& self) { self.control_->StepTool(1); }},
      {Action::kPreviousTool, [](Self& self) { self.control_->StepTool(-1); }},
      {Action::kFreeze, [](Self& self) { self.control_->ToggleFreeze(); }},
      {Action::kAssistant, [](Self& self) { self.control_->StepAssistant(); }},
      {Action::kToggleCameraHolder,
       [](Self& self) { self.control_->SetCameraHolder(!self.control_->HasCameraHolder()); }},
      {Action::kChooseLeft, [](Self& self) { self.control_->ChooseHand(device::kLeftHand); }},
      {Action::kChooseRight, [](Self& self) { self.control_->ChooseHand(device::kRightHand); }},
      {Action::kSwitchHand, [](Self& self) { self.control_->SwitchHand(); }},
      {Action::kToggleForceFeedback, [](Self& self) { self.ToggleForceFeedback(); },
       [](const Self& self) { return self.IsForceOn(); }},
      {Action::kCheckPose, [](Self& self) { self.control_->Haptics()->BeginCheckPose(); }},
      {Action::kToggleFulcrum,
       [](Self& self) {
         self.settings_.is_fulcrum_mirrored = !self.settings_.is_fulcrum_mirrored;
         if (self.control_ != nullptr) self.control_->SetMirrorFulcrum(self.settings_.is_fulcrum_mirrored);
         self.KeepSettings();
       },
       [](const Self& self) { return self.settings_.is_fulcrum_mirrored; }},
      {Action::kToggleLeftHanded, [](Self& self) { self.ToggleLeftHanded(); },
       [](const Self& self) { return self.settings_.is_left_handed; }},
      {Action::kToggleDepthSnap,
       [](Self& self) {
         self.settings_.has_depth_snap = !self.settings_.has_depth_snap;
         if (self.control_ != nullptr) self.control_->SetDepthSnap(self.settings_.has_depth_snap);
         self.Announce(self.settings_.has_depth_snap
                           ? host::Translate("The wheel stops where the tip meets something.")
                           : host::Translate("The wheel goes on where the tip meets something."));
         self.KeepSettings();
       },
       [](const Self& self) { return self.settings_.has_depth_snap; }},
      {Action::kToggleSlowMotion,
       [](Self& self) { self.control_->SetSlowMotion(!self.control_->IsSlowMotion()); },
       [](const Self& self) { return self.control_ != nullptr && self.control_->IsSlowMotion(); }},
      // first meeting
      {Action::kOpenHome, [](Self& self) { self.OpenHome(); }},
      {Action::kToggleTutorial, [](Self& self) { self.ToggleTutorial(); },
       [](const Self& self) { return self.tutorial_.IsOn(); }},
      {Action::kToggleGuides,
       [](Self& self) {
         self.settings_.has_guides = !self.settings_.has_guides;
         self.KeepSettings();
       },
       [](const Self& self) { return self.settings_.has_guides; }},
      {Action::kTogglePanel,
       [](Self& self) {
         self.settings_.has_panel = !self.settings_.has_panel;
         self.KeepSettings();
       },
       [](const Self& self) { return self.settings_.has_panel; }},
      // the picture and what lies over it
      {Action::kToggleForces,
       [](Self& self) { self.page_.view.has_force_arrows = !self.page_.view.has_force_arrows; },
       [](const Self& self) { return self.page_.view.has_force_arrows; }},
      {Action::kToggleMask, [](Self& self) { self.page_.view.has_mask = !self.page_.view.has_mask; },
       [](const Self& self) { return self.page_.view.has_mask; }},
      {Action::kToggleHelp, [](Self& self) { self.page_.is_help_open = !self.page_.is_help_open; },
       [](const Self& self) { return self.page_.is_help_open; }},
      {Action::kToggleTaskList,
       [](Self& self) { self.page_.is_task_list_open ? self.CloseTaskList() : self.OpenTaskList(); }},
      {Action::kToggleRecordingList,
       [](Self& self) {
         self.page_.is_recording_list_open ? self.CloseRecordingList() : self.OpenRecordingList();
       }},
      {Action::kTogglePatientList,
       [](Self& self) {
         self.page_.is_patient_list_open ? self.ClosePatientList() : self.OpenPatientList();
       }},
      {Action::kToggleKeyList,
       [](Self& self) { self.page_.is_key_list_open ? self.CloseKeyList() : self.OpenKeyList(); }},
      {Action::kReleasePointer, [](Self& self) { self.ReleaseAll(); }},
  };
  return kHandlers;
}

void SimulatorPresenter::ToggleForceFeedback() {
  session::HapticLoop& haptics = *control_->Haptics();
  IsForceOn() ? haptics.Stop() : haptics.RequestArm();
}

/// Esc: no force, no pointer, no card over the picture, nothing that is prepared.
void SimulatorPresenter::ReleaseAll() {
  const bool is_free =
      preparing_ == nullptr && !screen_->IsPointerTaken() && !page_.is_help_open && !HasCard();
  if (preparing_ != nullptr) preparing_->is_cancelled = true;
  if (control_ != nullptr && control_->Haptics() != nullptr) control_->Haptics()->Stop();
  // one thing after the other: whoever has nothing else to leave leaves full screen
  if (is_free) screen_->DoInWindow(Action::kReleasePointer);
  screen_->ReleasePointer();
  screen_->FocusPicture();
  page_.is_help_open = false;
  CloseCards();
  if (control_ == nullptr && !loading_.IsRunning()) page_.is_home_open = true;  // there is nothing else
}

void SimulatorPresenter::SetPaused(bool is_paused) {
  control_->SetPaused(is_paused);
  Refresh();
}

void SimulatorPresenter::SetDemonstration(bool is_on) {
  screen_->ReleasePointer();
  control_->SetDemonstration(is_on);
  if (is_on) control_->SetPaused(false);
  if (is_on) is_attempt_over_ = false;  // it begins anew
  Refresh();
}

void SimulatorPresenter::Reset() {
  // a board on which one learned becomes an attempt
  if (is_practice_ && (!tutorial_.IsOn() || tutorial_.IsDone())) return StartTutorialTask();
  // a step that begins in the middle of an operation begins there again
  if (start_ && !start_->state.empty()) return Open(centre::Start(*start_));
  is_attempt_over_ = false;
  control_->Reset();
  Announce(host::Translate("Reset."));
}

// tasks

void SimulatorPresenter::OpenTaskList(TaskSection section) {
  if (page_.failure) return;
  auto page = LoadTaskPage(section, options_.operation.patient);
  if (!page.ok()) return Fail(page.error());
  page_.tasks = std::move(*page);
  if (!best_.empty()) AddBestResults(best_, page_.tasks);
  screen_->FillTaskList(page_.tasks);
  screen_->RequestBest();
  screen_->ReleasePointer();
  page_.is_help_open = false;
  CloseCards();
  page_.is_task_list_open = true;
  Refresh();
}

void SimulatorPresenter::ShowBest(const centre::HomeResults& results) {
  leads_ = results.leads;
  FindLeads();
  if (page_.is_home_open) Refresh();
  if (results.best == best_ && !best_.empty()) return;
  best_ = results.best;
  AddBestResults(best_, page_.tasks);
  if (page_.is_task_list_open) screen_->FillTaskList(page_.tasks);
}

void SimulatorPresenter::CloseTaskList() {
  page_.is_task_list_open = false;
  if (control_ == nullptr && !loading_.IsRunning()) page_.is_home_open = true;
  Refresh();
}

void SimulatorPresenter::OpenRecording(const std::filesystem::path& recording) {
  page_.is_recording_list_open = false;
  if (control_ != nullptr) control_->SetPaused(true);
  screen_->OpenReplay(recording);
  Refresh();
}

void SimulatorPresenter::OpenRecordingList() {
  if (page_.failure) return;
  screen_->FillRecordingList(options_.recordings.empty() ? record::FindRecordingFolder()
                                                         : options_.recordings);
  screen_->ReleasePointer();
  page_.is_help_open = false;
  CloseCards();
  page_.is_recording_list_open = true;
  Refresh();
}

void SimulatorPresenter::CloseRecordingList() {
  page_.is_recording_list_open = false;
  if (control_ == nullptr && !loading_.IsRunning()) page_.is_home_open = true;
  Refresh();
}

void SimulatorPresenter::CloseResult() {
  page_.is_result_open = false;
  Refresh();
}

void SimulatorPresenter::PlayAgain() {
  Do(Action::kReset);
  screen_->FocusPicture();
}

/// The recording ends here, and its page opens where a person made it.
void SimulatorPresenter::EndAttempt() {
  if (is_attempt_over_) return;
  is_attempt_over_ = true;
  const auto recording = control_->Recording();
  control_->EndAttempt();
  if (!recording || recording->failure || unattended_.IsOn() || control_->IsDemonstration()) return;
  page_.is_result_open = false;
  screen_->OpenAttempt(recording->path, start_ ? start_->exam : std::nullopt);
}

/// The whole is done, or the part that it was about, or the time of its level is over.
void SimulatorPresenter::EndOperation(const simulation::Snapshot& snapshot) {
  if (!control_->GetScene().operation || is_attempt_over_) return;
  const OperationEnd::Reason reason = operation_end_.See(snapshot);
  if (reason == OperationEnd::Reason::kNone) return;
  screen_->ReleasePointer();
  control_->SetPaused(true);
  Announce(Describe(reason), reason == OperationEnd::Reason::kTimeOver);
  EndAttempt();
}

bool SimulatorPresenter::IsGuided() const {
  if (IsExam()) return false;
  return control_ == nullptr || !control_->GetScene().operation ||
         control_->GetScene().operation->level.has_guidance;
}

void SimulatorPresenter::Finish() {
  if (is_attempt_over_) return;
  screen_->ReleasePointer();
  control_->SetPaused(true);
  Announce(IsExam() ? host::Translate("The exam is over.")
                    : host::Translate("The attempt is over. Reset begins another."));
  EndAttempt();
}

void SimulatorPresenter::ShowTask(const scene::TaskSnapshot& now) {
  error_log_.Add(now);
  if (!now.IsOver()) {
    // begun anew
    if (is_result_known_) CloseResult();
    is_result_known_ = false;
    return;
  }
  if (is_result_known_) return;
  is_result_known_ = true;
  result_ = MakeTaskResult(control_->GetScene(), now, error_log_.Errors());
  result_.is_demonstration = control_->IsDemonstration();
  if (const auto recording = control_->Recording(); recording && !recording->failure)
    result_.recording = recording->path.string();
  screen_->ReleasePointer();
  screen_->FillResult(result_);
  page_.is_result_open = true;
  EndAttempt();
  Refresh();
}

/// A recording that stopped, or soon will, is said once.
void SimulatorPresenter::ShowRecording() {
  const auto recording = control_->Recording();
  const bool has_stopped = recording && recording->failure;
  const bool is_low = recording && recording->is_space_low;
  if (has_stopped && !is_recording_stopped_)
    Announce(host::TranslateWith("This attempt is recorded no longer: {1}",
                                 {host::ShownText(*recording->failure)}),
             true);
  if (is_low && !is_space_low_ && !has_stopped)
    Announce(host::Translate("The disk is nearly full; the recording of this attempt will end soon."), true);
  is_recording_stopped_ = has_stopped;
  is_space_low_ = is_low;
}

void SimulatorPresenter::SaveResult(const std::filesystem::path& path) {
  const base::Status saved = host::WriteFile(
      path, path.extension() == ".json" ? FormatTaskResultJson(result_) : FormatTaskResultHtml(result_));
  if (!saved) host::Log(host::LogLevel::kError, saved.error().Text());
  Announce(saved ? host::TranslateWith("Saved {1}", {path.string()}) : host::ShownText(saved.error()));
}

// frames

SimulatorPresenter::FrameWork SimulatorPresenter::Advance(double now, double field_of_view, double pixels) {
  const double dt = last_frame_ > 0.0 ? now - last_frame_ : 0.0;
  last_frame_ = now;
  FrameWork work;
  if (control_ == nullptr && preparing_ != nullptr && now - last_times_ > kTimesPeriod) {
    last_times_ = now;
    Refresh();
  }
  if (control_ == nullptr || page_.failure) return work;
  control_->SetPicture(field_of_view, pixels);
  const simulation::Snapshot& snapshot = control_->Advance(dt);
  work.snapshot = &snapshot;
  attempt_seconds_ = snapshot.time;
  FollowTutorial(snapshot);
  stages_.Add(snapshot);
  ShowEvents(snapshot);
  if (control_->GetScene().task) {
    ShowTask(snapshot.task);
  } else {
    EndOperation(snapshot);
  }
  if (const std::string message = control_->TakeDeviceMessage(); !message.empty())
    Announce(message, page_.is_event_warning);
  work.are_forces_due = now - last_forces_ > kForcePeriod;
  work.are_times_due = now - last_times_ > kTimesPeriod;
  if (work.are_forces_due) {
    last_forces_ = now;
    ShowHaptics();
    Refresh();
  }
  if (work.are_times_due) {
    last_times_ = now;
    ShowRecording();
  }
  work.run = unattended_.Advance(snapshot.time, since_start_.Seconds());
  if (work.run == UnattendedPlay::Step::kGiveUp) Fail(unattended_.Complaint());
  return work;
}

void SimulatorPresenter::CountPicture() {
  frames_.Add(since_start_.Seconds());
  if (first_picture_ == 0.0) first_picture_ = since_start_.Seconds();
}

PlayReport SimulatorPresenter::MakeReport(int width, int height) const {
  PlayReport report;
  report.screenshot = options_.run.screenshot.filename().string();
  report.width = width, report.height = height;
  report.first_picture = first_picture_;
  if (control_ != nullptr) {
    report.statistics = control_->Statistics();
    if (control_->Haptics() != nullptr)
      report.haptics = session::FormatHapticsJson(control_->Haptics()->Latest());
  }
  report.pictures = frames_.Count();
  report.pictures_per_second = PictureRate();
  report.has_task_list = page_.is_task_list_open;
  if (page_.is_result_open) report.result = result_.verdict;
  return report;
}

// what is shown

void SimulatorPresenter::Fail(const base::Error& error) {
  if (page_.failure) return;
  page_.failure = error;
  host::Log(host::LogLevel::kError, error.Text());
  if (control_ != nullptr) control_->SetPaused(true);
  page_.is_task_list_open = page_.is_result_open = false;
  Announce(host::ShownText(error));
  // nobody is there to read the card
  if (unattended_.IsOn()) screen_->DoInWindow(Action::kQuit);
}

void SimulatorPresenter::SaveHapticRecord() {
  if (options_.haptic_record.empty() || control_ == nullptr) return;
  const base::Status saved =
      host::WriteFile(options_.haptic_record, control_->GetHapticRecord().FormatJson());
  if (saved) return;
  host::Log(host::LogLevel::kError, saved.error().Text());
  if (!page_.failure) page_.failure = saved.error();
}

void SimulatorPresenter::Announce(const std::string& text, bool is_warning) {
  page_.event = text;
  page_.is_event_warning = is_warning;
  Refresh();
}

void SimulatorPresenter::ShowEvents(const simulation::Snapshot& snapshot) {
  if (snapshot.event_count < seen_events_) seen_events_ = 0;
  if (snapshot.event_count == seen_events_) return;
  seen_events_ = snapshot.event_count;
  const scene::Event& newest = snapshot.events[(snapshot.event_count - 1) % snapshot.events.size()];
  Announce(DescribeEvent(newest, control_->GetScene()), IsWarning(newest));
}

void SimulatorPresenter::ShowHaptics() {
  session::HapticLoop* haptics = control_->Haptics();
  if (haptics != nullptr) page_.haptics = session::DescribeHaptics(haptics->Latest());
}

void SimulatorPresenter::Refresh() {
  const Situation situation = MakeSituation();
  page_.hint = page_.failure ? "" : HintText(situation);
  page_.badge = page_.failure ? "" : BadgeText(situation);
  page_.mode = page_.failure ? "" : ModeText(situation);
  page_.state = page_.failure ? host::Translate("Stopped") : StateText(situation);
  const gui::JobProgress::Value opening =
      preparing_ == nullptr ? gui::JobProgress::Value{} : preparing_->progress.Get();
  page_.opening = preparing_ == nullptr      ? ""
                  : preparing_->is_cancelled ? host::Translate("Giving it up …")
                                             : opening.what;
  page_.opening_share = opening.fraction;
  if (control_ != nullptr)
    page_.state +=
        host::TranslateWith("   ·   {1} pictures/s", {std::to_string(static_cast<int>(PictureRate() + 0.5))});
  RefreshFirstMeeting();
  screen_->Show(page_);
}

}  // namespace trocar::presenter
