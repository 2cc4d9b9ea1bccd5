// SPDX-License-Identifier: Apache-2.0
/// \file simulator_presenter.h  Presenter of the simulator window, without a widget: loading, commands, frames, tasks.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "trocar/centre/course_page.h"
#include "trocar/gui/background_job.h"
#include "trocar/host/clock.h"
#include "trocar/presenter/branch.h"
#include "trocar/presenter/hints.h"
#include "trocar/presenter/home.h"
#include "trocar/presenter/key_bindings.h"
#include "trocar/presenter/operation_guide.h"
#include "trocar/presenter/operation_part.h"
#include "trocar/presenter/options.h"
#include "trocar/presenter/read_outs.h"
#include "trocar/presenter/scene_choice.h"
#include "trocar/presenter/session_control.h"
#include "trocar/presenter/simulator_commands.h"
#include "trocar/presenter/task_page.h"
#include "trocar/presenter/task_request.h"
#include "trocar/presenter/task_result.h"
#include "trocar/presenter/tutorial.h"
#include "trocar/presenter/unattended_play.h"
#include "trocar/presenter/window_settings.h"
#include "trocar/view/laparoscope_view.h"

namespace trocar::presenter {

/// All that the window says and shows, besides the picture and the panel.
struct SimulatorPage {
  std::string title = "Trocar";
  std::string hint, badge, state, event, haptics;
  std::string mode;      ///< what mouse and keys do now
  std::string progress;  ///< of the task or the operation: time, goals or phase, what comes next
  std::string tutorial;  ///< what is to be done now; empty: it is off
  std::string
      next_step;  ///< of an operation: what comes next, with tool and key; empty: no help is wanted or there is none
  bool is_tutorial_done = false;  ///< all its steps: its task can be begun as an attempt
  std::string question;           ///< before something is thrown away; empty: none
  HomePage home;
  TaskPage tasks;
  std::string opening;       ///< what is prepared beside the window; empty: nothing that takes long
  double opening_share = 0;  ///< of that [-]; never less than before while one thing is prepared
  bool is_home_open = false, is_panel_open = false, is_left_handed = false;
  bool is_event_warning = false;
  bool is_help_open = false, is_task_list_open = false, is_result_open = false;
  bool is_recording_list_open = false, is_patient_list_open = false, is_key_list_open = false;
  bool is_rehearsal_open = false;  ///< from images to an operation; its own presenter says what it shows
  view::ViewOptions view;
  std::optional<base::Error> failure;
};

/// Told of recordings that begin and that have ended, by the simulation's thread; either may be empty.
struct AttemptHooks {
  /// \param step  of a course, for which the attempt is made
  std::function<void(const std::filesystem::path&, const centre::StepName& step)> on_begin;
  std::function<void(const std::filesystem::path&)> on_end;
  /// Asked who measures an attempt that begins, of which part of an operation; may be empty.
  std::function<session::AttemptWatch(const std::filesystem::path&, const simulation::Simulation&,
                                      assessment::Milestone from, assessment::Milestone until)>
      watch;
};

/// Who operates: a name for the eye, and what attempts are kept under; the pseudonym is empty of nobody in particular.
struct Somebody {
  std::string name, pseudonym;
};

/// View interface that the presenter drives; a window implements it.
class SimulatorScreen {
 public:
  virtual ~SimulatorScreen() = default;
  /// Brings the widgets to what the page and the presenter's commands say.
  virtual void Show(const SimulatorPage& page) = 0;
  /// Sets the control that picture, panel and hands work on from now on. Null, passed before the old one is destroyed: nothing.
  virtual void UseControl(SessionControl* control) = 0;
  /// \return names of keys that can have no act
  virtual std::vector<std::string> UseKeys(const std::map<std::string, device::HandAct>& keys) = 0;
  virtual void FillTaskList(const TaskPage& page) = 0;
  /// Asks for the person's best results, beside the window; SimulatorPresenter::ShowBest is told them.
  virtual void RequestBest() = 0;
  /// Reads the list of patients anew, beside the window.
  virtual void FillPatientList(const std::filesystem::path& chosen) = 0;
  virtual void FillResult(const TaskResult& result) = 0;
  /// Reads the list of recordings anew, beside the window.
  virtual void FillRecordingList(const std::filesystem::path& folder) = 0;
  /// A window of its own plays a recording.
  virtual void OpenReplay(const std::filesystem::path& recording) = 0;
  /// An attempt that a person made is over, and is recorded: its page.
  /// \param exam  that was sat, or nothing
  virtual void OpenAttempt(const std::filesystem::path& recording,
                           const std::optional<centre::ExamSitting>& exam) = 0;
  virtual void ReleasePointer() = 0;
  virtual bool IsPointerTaken() const = 0;
  virtual void FocusPicture() = 0;
  /// Who operates; turns a name or pseudonym into that person first, where there is a text.
  virtual base::Result<Somebody> BeSomebody(const std::optional<std::string>& text) = 0;
  /// The training centre begins a step of a course.
  virtual void StartStep(const centre::StepName& step) = 0;
  /// The training centre shows what an attempt came to.
  virtual void OpenLastResult(const centre::NextAndLast::Result& result) = 0;
  /// Carries out an action of the window itself: full screen, panes, the page of devices, the end.
  virtual void DoInWindow(Action action) = 0;
};

class SimulatorPresenter {
 public:
  /// \param screen     outlives the presenter
  /// \param on_loaded  called by another thread when FinishLoading() is due
  SimulatorPresenter(const Options& options, const host::Stopwatch& since_start, SimulatorScreen& screen,
                     std::function<void()> on_loaded, AttemptHooks hooks = {});

  /// Gives up what is being prepared.
  ~SimulatorPresenter() {
    if (preparing_ != nullptr) preparing_->is_cancelled = true;
  }
  SimulatorPresenter(const SimulatorPresenter&) = delete;
  SimulatorPresenter& operator=(const SimulatorPresenter&) = delete;

  /// Begins to read the scene that the options name.
  void Start();
  /// Takes over what has been read.
  void FinishLoading();
  /// Gives up what is being read or prepared.
  void CancelOpening();
  /// Gives up the scene that is shown and reads the one that was chosen; nothing while one is being read. Ends the tutorial.
  void Open(const TaskRequest& request);
  /// As above, with a step of a course or an exam.
  void Open(const centre::Start& start);

  /// Gives up the scene that is shown and goes on from a moment of a recording: paused, until the person's hands are ready;
  /// the expert begins at once. Nothing while a scene is being read.
  void TakeOver(Branch branch);
  /// Somebody closes the window by its frame. \return false: an attempt would end, and the person is asked first
  bool MayClose();
  /// The window has closed: nothing runs any more, and the attempt's recording ends.
  void Close();

  /// Pauses, and plays a recording in a window of its own.
  void OpenRecording(const std::filesystem::path& recording);

  /// Does what a key or a button asks for, where it is possible.
  void Do(Action action);
  bool IsEnabled(Action action) const;
  /// How the command's button looks now.
  gui::ButtonState FindButton(const SimulatorCommand& command) const;

  void OpenHome();
  void Choose(HomeChoice choice);
  /// Sets who operates from now on. \param text  name or pseudonym; empty: nobody in particular
  void BeSomebody(const std::string& text);
  /// To the question that is asked. \param is_yes  does what was asked for
  void Answer(bool is_yes);
  /// Begins the tutorial's task as an attempt; what the tutorial ends with.
  void StartTutorialTask();

  void OpenTaskList(TaskSection section = TaskSection::kAll);
  void CloseTaskList();
  /// Of the person who is there now.
  void ShowBest(const centre::HomeResults& results);

  /// Sets the patient of the next operation and those after it.
  /// \param folder  empty: the built-in one
  void ChoosePatient(const std::filesystem::path& folder);
  void OpenPatientList();
  void ClosePatientList();
  /// The way from images to an operation, in place of the picture.
  void OpenRehearsal();
  void CloseRehearsal();
  /// Begins the whole operation on a patient, who is chosen from now on.
  void OperateOn(const std::filesystem::path& patient);

  /// A hand was taken, and the display lets nobody hold the pointer.
  void SayPointerIsFree();

  // keys and buttons, each change of which can be undone
  const KeyBindings& Bindings() const { return bindings_; }
  void OpenKeyList();
  void CloseKeyList();
  /// \return why the key cannot be used
  base::Status ChangeKey(const std::string& id, std::uint32_t key);
  void ChangeButton(ButtonAct act, MouseButton button);
  void RestoreKeys();
  void UndoKeys();
  bool CanUndoKeys() const { return !former_bindings_.empty(); }

  void OpenRecordingList();
  void CloseRecordingList();
  void CloseResult();
  void PlayAgain();
  /// Writes the task's result: JSON or a page, by the file's ending.
  void SaveResult(const std::filesystem::path& path);

  /// Work of one frame: the snapshot to draw, and the read-outs that are due.
  struct FrameWork {
    const simulation::Snapshot* snapshot = nullptr;  ///< null: nothing runs
    bool are_forces_due = false, are_times_due = false;
    UnattendedPlay::Step run = UnattendedPlay::Step::kGoOn;
  };
  /// \param now  of the frame clock [s]
  /// \param field_of_view, pixels  as SessionControl::SetPicture
  FrameWork Advance(double now, double field_of_view, double pixels);
  /// A picture has been drawn.
  void CountPicture();
  double PictureRate() const { return frames_.Rate(since_start_.Seconds()); }
  const StageMeter& Stages() const { return stages_; }
  /// Report printed by a run that is not attended.
  PlayReport MakeReport(int width, int height) const;

  /// Says what the window has done by itself.
  void Tell(const std::string& text, bool is_warning = false) { Announce(text, is_warning); }
  /// Stops the simulation and says so; the first failure stays.
  void Fail(const base::Error& error);
  const std::optional<base::Error>& GetFailure() const { return page_.failure; }
  /// Writes what --haptic-record asks for; call it once the window has closed.
  void SaveHapticRecord();

  SessionControl* Control() { return control_.get(); }
  const Options& GetOptions() const { return options_; }
  const SimulatorPage& Page() const { return page_; }
  bool HasGuides() const { return settings_.has_guides && IsGuided(); }
  /// What comes next in the operation that is shown; nothing where it is none, or without guides.
  OperationStep NextOperationStep() const;

 private:
  bool Meets(SimulatorNeeds needs) const;
  bool IsChecked(Action action) const;
  bool IsForceOn() const;
  /// Session for a simulation: devices as the options name them, with the person's settings of them.
  session::SessionOptions MakeSessionOptions(record::Description description);
  bool Use(simulation::Simulation simulation, record::Description description);
  void GoOn();
  void Finish();
  void EndAttempt();
  void EndOperation(const simulation::Snapshot& snapshot);
  bool IsExam() const { return start_ && start_->exam; }
  /// Whether help may be shown: neither in an exam nor at a level without it.
  bool IsGuided() const;
  void GiveUpOpening();
  void UseBindings();
  void KeepBindings(KeyBindings::Own former);
  void Drop();
  void Refresh();
  Situation MakeSituation();
  void RefreshFirstMeeting();
  void FindLeads();
  void MeetAgain();
  void FollowTutorial(const simulation::Snapshot& snapshot);
  void ToggleTutorial();
  void BeginTutorial();
  void LeaveTutorial();
  bool MustAsk(Action action) const;
  void CloseCards();
  bool HasCard() const;
  void LeadOn(const base::Error& error);
  void KeepLast();
  void KeepSettings();
  void ToggleLeftHanded();
  void Announce(const std::string& text, bool is_warning = false);
  void ShowEvents(const simulation::Snapshot& snapshot);
  void ShowHaptics();
  void ShowTask(const scene::TaskSnapshot& now);
  void ShowRecording();
  void SetPaused(bool is_paused);
  void SetDemonstration(bool is_on);
  void Reset();
  void ReleaseAll();
  void ToggleForceFeedback();
  using Handler = gui::CommandHandler<SimulatorPresenter, Action>;
  /// Handlers of the actions that the presenter carries out itself; the window does the rest.
  static std::span<const Handler> Handlers() noexcept;

  Options options_;
  AttemptHooks hooks_;
  std::optional<centre::Start> start_;  // that was opened in place of what the options name
  host::Stopwatch since_start_;
  SimulatorScreen* screen_;
  SimulatorPage page_;
  UnattendedPlay unattended_;
  WindowSettings settings_;
  KeyBindings bindings_;
  std::vector<KeyBindings::Own> former_bindings_;  // the newest last
  centre::BestResults best_;
  centre::NextAndLast leads_;
  std::optional<HomeLead> next_lead_, result_lead_;  // of them
  OperationEnd operation_end_;
  Tutorial tutorial_;
  Action asked_ = Action::kNone;  // that waits for an answer
  bool may_leave_ = false;        // it was asked and answered whether to leave
  double attempt_seconds_ = 0;    // of the newest snapshot
  bool has_script_ = false, is_closed_ = false;
  std::unique_ptr<SessionControl> control_;  // null while loading
  StageMeter stages_;
  FrameMeter frames_;
  TaskErrorLog error_log_;
  TaskResult result_;                                         // of the task that is over
  bool is_recording_stopped_ = false, is_space_low_ = false;  // they have been said
  bool is_result_known_ = false;                              // it has been shown
  bool is_attempt_over_ = false;
  bool is_practice_ = false;  // the scene was opened by the tutorial: nothing of it is kept
  std::uint64_t seen_events_ = 0;
  double first_picture_ = 0;                                  // since the start of the program [s]
  double last_frame_ = 0, last_forces_ = 0, last_times_ = 0;  // of the frame clock [s]
  /// Shared with the thread that reads and prepares.
  struct Preparing {
    gui::JobProgress progress;
    std::atomic<bool> is_cancelled = false;
  };
  std::shared_ptr<Preparing> preparing_;  // null where nothing is being read
  gui::BackgroundJob<base::Result<LoadedScene>> loading_;
};

}  // namespace trocar::presenter
