// SPDX-License-Identifier: Apache-2.0
// Of the simulator's presenter: what is opened, read and prepared beside the window, and given up again.
#include <cstdio>
#include <utility>

#include "trocar/host/log.h"
#include "trocar/host/translate.h"
#include "trocar/presenter/scene_choice.h"
#include "trocar/presenter/simulator_presenter.h"

namespace trocar::presenter {

void SimulatorPresenter::Start() {
  is_closed_ = false;
  const bool is_named = !options_.scene.empty() || !options_.task.empty() || options_.is_task_list ||
                        options_.is_demonstration || !options_.run.IsAttended();
  MeetAgain();
  if (!start_ && !is_named) return OpenHome();
  page_.home.problem.reset();
  preparing_ = std::make_shared<Preparing>();
  if (start_) {
    loading_.Start([options = options_, start = *start_]() -> base::Result<LoadedScene> {
      auto made = MakeStartedSimulation(options, start);
      if (!made) return made.error();
      return LoadedScene{std::move(*made), std::nullopt};
    });
  } else {
    loading_.Start([options = options_, preparing = preparing_] {
      return MakeChosenScene(options, [&preparing](const std::string& doing, double share) {
        preparing->progress.Set(doing, share);
        return !preparing->is_cancelled;
      });
    });
  }
  Refresh();
}

void SimulatorPresenter::CancelOpening() {
  if (preparing_ != nullptr) preparing_->is_cancelled = true;
  Refresh();
}

void SimulatorPresenter::FinishLoading() {
  auto loaded = loading_.Take();
  const bool is_cancelled = preparing_ != nullptr && preparing_->is_cancelled;
  preparing_.reset();
  if (page_.failure || is_closed_) return;
  if (is_cancelled) return GiveUpOpening();
  if (!loaded.ok()) return unattended_.IsOn() ? Fail(loaded.error()) : LeadOn(loaded.error());
  if (loaded->start) start_ = std::move(loaded->start);
  record::Description description =
      start_ ? start_->description : DescribeChosenScene(options_, loaded->simulation.GetScene());
  if (start_) description.player = (start_->exam ? "exam, " : "") + DescribeHands(options_);
  if (!Use(std::move(loaded->simulation), std::move(description))) return;
  operation_end_.Begin(control_->GetScene(), start_ ? start_->from : assessment::Milestone::kStart,
                       start_ ? start_->until : assessment::Milestone::kCompleted, control_->Now());
  KeepLast();
  if (start_) {
    page_.title = "Trocar: " + host::TranslateComposed(start_->title);
    if (!start_->state.empty()) GoOn();
    // a person begins when the hands are ready
    return Announce(host::TranslateWith("{1}. Start when your hands are ready.",
                                        {host::TranslateComposed(start_->title)}));
  }
  Announce(host::Translate("Ready."));
  if (options_.is_demonstration || unattended_.IsOn()) SetDemonstration(true);
  SetPaused(false);
}

/// What was asked for is not wanted any more; nobody made a mistake.
void SimulatorPresenter::GiveUpOpening() {
  options_.task.clear();
  options_.scene.clear();
  options_.operation.part.clear();
  start_.reset();
  LeaveTutorial();
  page_.home.problem.reset();
  OpenHome();
  Announce(host::Translate("Given up before it began."));
}

/// Shows a simulation, paused. \return false where something failed
bool SimulatorPresenter::Use(simulation::Simulation simulation, record::Description description) {
  auto control = SessionControl::Make(std::move(simulation), MakeSessionOptions(std::move(description)));
  if (!control) {
    Fail(control.error());
    return false;
  }
  control_ = std::move(control).value();
  has_script_ = control_->HasScript();
  control_->SetMirrorFulcrum(settings_.is_fulcrum_mirrored);
  control_->SetDepthSnap(settings_.has_depth_snap);
  if (control_->ServedPort() >= 0) {
    host::Log(host::LogLevel::kInfo,
              "OpenIGTLink: viewers may connect to localhost:" + std::to_string(control_->ServedPort()));
  }
  screen_->UseControl(control_.get());
  page_.title = "Trocar: " + host::Translate(control_->GetScene().name);
  return true;
}

/// The hands take the instruments in the middle of an operation, as whoever came so far has left them.
void SimulatorPresenter::GoOn() {
  const simulation::Snapshot& now = control_->Advance(0);
  scene::Input last;
  last.settings = control_->GetScene().settings;
  for (std::size_t hand = 0; hand < last.controls.size(); ++hand)
    last.controls[hand].tool = now.operation.tools[hand];
  if (now.operation.assistant.is_holding) last.assistant = scene::AssistantCommand::kRetract;
  const std::uint64_t events = now.event_count;
  control_->GoOnFrom(last);
  seen_events_ = events;
}

void SimulatorPresenter::TakeOver(Branch branch) {
  if (loading_.IsRunning() || page_.failure) return;
  is_closed_ = false;
  LeaveTutorial();
  Drop();
  start_.reset();
  const record::Description& from = branch.description;
  options_.task = from.kind == record::Description::Kind::kScene ? "" : from.name;
  options_.scene = from.kind == record::Description::Kind::kScene ? from.name : "";
  options_.operation = {from.patient, ""};
  options_.level = from.level.empty() ? scene::kNormalLevel : from.level;
  options_.seed = from.seed;
  options_.is_demonstration = false;
  record::Description description = from;
  description.player = DescribeHands(options_);
  const simulation::Snapshot& moment_of = branch.simulation.GetSnapshot();
  const std::uint64_t events = moment_of.event_count;
  operation_end_.Begin(branch.simulation.GetScene(), assessment::Milestone::kStart,
                       assessment::Milestone::kCompleted, moment_of);
  if (!Use(std::move(branch.simulation), std::move(description))) return;
  control_->GoOnFrom(branch.last);
  seen_events_ = events;
  char seconds[32];
  std::snprintf(seconds, sizeof seconds, "%.1f", static_cast<double>(from.branched_tick) * from.tick_seconds);
  const std::string moment = host::LocalNumber(seconds);
  if (branch.is_experts) {
    control_->LetExpertGoOn();
    SetPaused(false);
    Announce(host::TranslateWith("The expert goes on from {1} at {2} s.", {from.branched_from, moment}));
  } else {
    Announce(host::TranslateWith("Taken over from {1} at {2} s. Start when your hands are ready.",
                                 {from.branched_from, moment}));
  }
  screen_->FocusPicture();
  Refresh();
}

session::SessionOptions SimulatorPresenter::MakeSessionOptions(record::Description description) {
  session::SessionOptions options;
  options.device = options_.device;
  options.haptics = options_.haptics;
  if (options_.igtl_port >= 0) options.viewers.emplace().port = options_.igtl_port;
  device::LoadedStore loaded = device::LoadDeviceStore(device::FindDeviceStore());
  if (loaded.complaint) host::Log(host::LogLevel::kWarning, loaded.complaint->Text());
  options.store = std::move(loaded.store);
  for (const std::string& key : screen_->UseKeys(options.store.keys)) {
    host::Log(
        host::LogLevel::kWarning,
        "the key \"" + key + "\" of the device settings can have no act; docs/devices.md says which can");
  }
  if (options_.recordings.empty() || is_practice_) return options;
  options.keeping = {options_.recordings, std::move(description), {}, hooks_.on_end, {}};
  if (hooks_.on_begin) {
    options.keeping->on_begin = [begin = hooks_.on_begin, step = start_ ? start_->step : centre::StepName()](
                                    const std::filesystem::path& path) { begin(path, step); };
  }
  if (hooks_.watch) {
    // as a replay of it is judged: of a part that no course asks for, the whole recording counts
    const bool is_of_course = start_ && start_->step.IsSet();
    const auto from = is_of_course ? start_->from : assessment::Milestone::kStart;
    const auto until = is_of_course ? start_->until : assessment::Milestone::kCompleted;
    options.keeping->watch = [watch = hooks_.watch, from, until](const std::filesystem::path& path,
                                                                 const simulation::Simulation& simulation) {
      return watch(path, simulation, from, until);
    };
  }
  return options;
}

void SimulatorPresenter::Open(const TaskRequest& request) {
  if (loading_.IsRunning()) return;
  LeaveTutorial();
  Drop();
  options_.task = request.task;
  options_.scene = request.scene;
  options_.operation.part = request.part;
  options_.operation.patient = request.choice.patient_folder;
  options_.level = request.choice.level;
  options_.seed = request.choice.seed;
  options_.is_demonstration = false;
  start_.reset();
  screen_->FocusPicture();
  Start();
}

void SimulatorPresenter::Open(const centre::Start& start) {
  if (loading_.IsRunning()) return;
  LeaveTutorial();
  Drop();
  options_.task = start.description.name;
  options_.scene.clear();
  options_.operation = {};
  options_.level = start.description.level;
  options_.seed = start.description.seed;
  options_.is_demonstration = false;
  start_ = start;
  if (start.exam) page_.view.has_force_arrows = false;
  screen_->FocusPicture();
  Start();
}

bool SimulatorPresenter::MayClose() {
  if (!MustAsk(Action::kQuit)) return true;
  Do(Action::kQuit);
  return false;
}

void SimulatorPresenter::Close() {
  is_closed_ = true;
  if (preparing_ != nullptr) preparing_->is_cancelled = true;
  SaveHapticRecord();
  Drop();
}

/// Ends the scene that is shown.
void SimulatorPresenter::Drop() {
  screen_->ReleasePointer();
  screen_->UseControl(nullptr);
  control_.reset();
  stages_ = {};
  error_log_ = {};
  seen_events_ = 0;
  asked_ = Action::kNone;
  attempt_seconds_ = 0;
  is_result_known_ = is_attempt_over_ = false;
  CloseCards();
}

}  // namespace trocar::presenter
