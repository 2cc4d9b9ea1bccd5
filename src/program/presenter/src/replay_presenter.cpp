// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/replay_presenter.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <thread>
#include <utility>

#include "trocar/agent/surgeon.h"
#include "trocar/host/log.h"
#include "trocar/host/translate.h"
#include "trocar/report/attempt_report.h"

namespace trocar::presenter {
namespace {

constexpr std::array<double, 6> kSpeeds = {0.25, 0.5, 1, 2, 4, 8};
constexpr double kStep = 1, kFarStep = 10;  // [s]
constexpr double kLead = 2;                 // before a mark, so that one sees how it came [s]
constexpr double kTrail = 4;                // of the tips' ways that are shown [s]
/// A replay that stays further behind is waited for [s of the recording at speed 1].
constexpr double kMostBehind = 0.25;

/// "grasp_missed" -> "grasp missed"
std::string Words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string DescribeSide(const record::Recording& recording) {
  const record::Description& d = recording.description;
  std::string text = host::Translate(Words(std::filesystem::path(d.name).stem().string()));
  if (!d.level.empty()) text += ", " + host::Translate(d.level);
  text += host::TranslateWith(", variant {1}  ·  {2}",
                              {std::to_string(d.seed), host::TranslateComposed(d.player)});
  if (d.started.size() >= 16) text += "  ·  " + d.started.substr(0, 10) + " " + d.started.substr(11, 5);
  return text;
}

}  // namespace

std::string FormatClock(double seconds) {
  const auto tenths = static_cast<long long>(std::llround(10 * std::max(0.0, seconds)));
  char text[48];
  std::snprintf(text, sizeof text, "%lld:%02lld.%lld", tenths / 600, tenths / 10 % 60, tenths % 10);
  return host::LocalNumber(text);
}

std::vector<ReplayMark> ListMarks(const record::Recording& recording) {
  using Kind = ReplayMark::Kind;
  const double tick_seconds = recording.description.tick_seconds;
  std::vector<ReplayMark> marks;
  for (const record::EventMark& event : recording.events) {
    ReplayMark mark{static_cast<double>(event.tick) * tick_seconds, Kind::kEvent,
                    host::Translate(Words(event.kind))};
    if (event.is_error) mark.kind = Kind::kError;
    if (event.kind == record::kPhaseKind) {
      mark.kind = Kind::kPhase;
      mark.text = report::PhaseName(event.about);
    }
    marks.push_back(std::move(mark));
  }
  for (const record::TextMark& mark : recording.marks)
    marks.push_back({static_cast<double>(mark.tick) * tick_seconds, Kind::kRemark, mark.text});
  std::stable_sort(marks.begin(), marks.end(),
                   [](const ReplayMark& a, const ReplayMark& b) { return a.time < b.time; });
  return marks;
}

ReplayPresenter::ReplayPresenter(const Options& options, ReplayScreen& screen,
                                 std::function<void()> on_loaded)
    : options_(options), screen_(&screen), loading_(std::move(on_loaded)) {
  page_.view.has_force_arrows = true;
}

ReplayPresenter::~ReplayPresenter() {
  for (std::size_t side = 0; side < kSides; ++side) {
    if (sides_[side]) screen_->UseReplay(side, nullptr);
  }
}

// loading

int ReplayPresenter::Threads() const {
  return options_.threads > 0 ? options_.threads : ChooseThreads(std::thread::hardware_concurrency());
}

base::Result<ReplayPresenter::Side> ReplayPresenter::OpenSide(const std::filesystem::path& path,
                                                              int threads) {
  auto recording = record::ReadRecording(path);
  if (!recording.ok()) return recording.error();
  record::ReplaySettings settings;
  settings.threads = threads;
  settings.index = record::IndexPathOf(path);
  auto replay = record::Replay::Open(std::move(*recording), settings);
  if (!replay.ok()) return replay.error();
  Side side;
  side.path = path;
  const record::Recording& of = replay->GetRecording();
  const double tick_seconds = of.description.tick_seconds;
  side.first = static_cast<double>(of.FirstTick()) * tick_seconds;
  side.last = static_cast<double>(of.LastTick()) * tick_seconds;
  side.marks = ListMarks(of);
  const scene::Scene& scene = replay->GetSimulation().GetScene();
  side.path_of_tips = record::CalcTipPath(scene, of);
  const auto surgeons = agent::ListSurgeons();
  side.has_expert =
      !scene.script.keys.empty() || std::any_of(surgeons.begin(), surgeons.end(), [&](const auto& entry) {
        return std::string_view(entry.name) == "expert" && entry.suits(scene);
      });
  side.replay = std::make_unique<session::ReplayRunner>(std::move(*replay));
  return side;
}

void ReplayPresenter::Load(std::size_t side, const std::filesystem::path& path) {
  loading_side_ = side;
  loading_path_ = path;
  loading_.Start([path, threads = Threads()] { return OpenSide(path, threads); });
  Refresh();
}

void ReplayPresenter::Start() {
  Load(kOwn, options_.replay);
}

void ReplayPresenter::OpenBeside(const std::filesystem::path& recording) {
  page_.is_list_open = false;
  if (loading_.IsRunning() || !sides_[kOwn]) return Refresh();
  CloseBeside();
  Load(kBeside, recording);
}

void ReplayPresenter::FinishLoading() {
  auto opened = loading_.Take();
  if (!opened.ok()) {
    // what cannot be shown beside leaves what is shown
    if (loading_side_ == kBeside) return Say(host::ShownText(opened.error()), true);
    page_.failure = opened.error();
    host::Log(host::LogLevel::kError, opened.error().Text());
    return Refresh();
  }
  UseSide(loading_side_, std::move(*opened));
  if (loading_side_ == kOwn && options_.replay_at > 0) GoTo(options_.replay_at);
  if (loading_side_ == kOwn && !options_.replay_beside.empty()) return Load(kBeside, options_.replay_beside);
  Refresh();
}

void ReplayPresenter::UseSide(std::size_t side, Side opened) {
  sides_[side].emplace(std::move(opened));
  Side& now = *sides_[side];
  const record::Recording& recording = now.replay->GetRecording();
  page_.about[side] = DescribeSide(recording);
  screen_->UseReplay(side, now.replay.get());
  page_.end = std::max(page_.end, now.last);
  if (side == kOwn) {
    page_.title = host::TranslateWith("Trocar: replay of {1}", {now.path.filename().string()});
    page_.begin = page_.time = now.first;
    page_.end = now.last;
    screen_->ShowMarks(now.marks);
    if (!recording.damage.empty())
      Say(host::TranslateWith("The file is damaged ({1}): what comes after {2} is missing.",
                              {recording.damage, FormatClock(now.last)}),
          true);
  }
  Follow();
}

void ReplayPresenter::CloseBeside() {
  if (!sides_[kBeside]) return;
  screen_->UseReplay(kBeside, nullptr);
  sides_[kBeside].reset();
  page_.about[kBeside].clear();
  page_.end = sides_[kOwn]->last;
  page_.time = std::min(page_.time, page_.end);
}

// commands

double ReplayPresenter::Speed() const {
  return kSpeeds[speed_];
}

bool ReplayPresenter::Meets(ReplayNeeds needs) const {
  const bool has_replay = sides_[kOwn].has_value() && !page_.failure;
  switch (needs) {
    case ReplayNeeds::kNothing:
      return true;
    case ReplayNeeds::kReplay:
      return has_replay;
    case ReplayNeeds::kExpert:
      return has_replay && sides_[kOwn]->has_expert;
    case ReplayNeeds::kBeside:
      return has_replay && sides_[kBeside].has_value();
  }
  return false;
}

bool ReplayPresenter::IsEnabled(ReplayAction action) const {
  return Meets(FindNeeds(action));
}

gui::ButtonState ReplayPresenter::FindButton(const ReplayCommand& command) const {
  gui::ButtonState state;
  state.is_enabled = Meets(command.needs);
  state.label = command.button.label;
  state.tip = gui::TipText(command.button.tip, command.keys);
  switch (command.action) {
    case ReplayAction::kTogglePlay:
      if (is_playing_) state.label = "Pause";
      break;
    case ReplayAction::kToggleCamera:
      state.is_checked = camera_.has_value();
      break;
    case ReplayAction::kToggleForces:
      state.is_checked = page_.view.has_force_arrows;
      break;
    case ReplayAction::kToggleGhosts:
      state.is_checked = has_ghosts_;
      break;
    case ReplayAction::kToggleHelp:
      state.is_checked = page_.is_help_open;
      break;
    case ReplayAction::kTakeOver:
    case ReplayAction::kWhatIf:
      state.is_enabled = state.is_enabled && !is_branching_;
      break;
    default:
      break;
  }
  return state;
}

void ReplayPresenter::Do(ReplayAction action) {
  if (!IsEnabled(action)) return Refresh();
  if (!MoveInTime(action) && !ChangeView(action)) screen_->DoInWindow(action);
  Refresh();
}

bool ReplayPresenter::MoveInTime(ReplayAction action) {
  switch (action) {
    case ReplayAction::kTogglePlay:
      // at the end it begins anew
      if (!is_playing_ && page_.time >= page_.end) GoTo(page_.begin);
      is_playing_ = !is_playing_;
      return true;
    case ReplayAction::kSlower:
      if (speed_ > 0) --speed_;
      return true;
    case ReplayAction::kFaster:
      speed_ = std::min(speed_ + 1, kSpeeds.size() - 1);
      return true;
    case ReplayAction::kBack:
    case ReplayAction::kOn:
      GoTo(page_.time + (action == ReplayAction::kOn ? kStep : -kStep));
      return true;
    case ReplayAction::kBackFar:
    case ReplayAction::kOnFar:
      GoTo(page_.time + (action == ReplayAction::kOnFar ? kFarStep : -kFarStep));
      return true;
    case ReplayAction::kToBegin:
    case ReplayAction::kToEnd:
      GoTo(action == ReplayAction::kToEnd ? page_.end : page_.begin);
      return true;
    case ReplayAction::kPreviousMark:
    case ReplayAction::kNextMark:
      StepMark(action == ReplayAction::kNextMark ? 1 : -1);
      return true;
    case ReplayAction::kTakeOver:
    case ReplayAction::kWhatIf:
      AskForBranch(action == ReplayAction::kWhatIf);
      return true;
    default:
      return false;
  }
}

bool ReplayPresenter::ChangeView(ReplayAction action) {
  switch (action) {
    case ReplayAction::kToggleCamera:
      if (camera_) {
        camera_.reset();
      } else {
        camera_ = view::MakeFreeCamera(sides_[kOwn]->replay->Latest().X_world_laparoscope);
      }
      // from anywhere else the abdominal wall would hide everything, and there is no telescope
      page_.view.has_mask = page_.view.has_background = !camera_;
      return true;
    case ReplayAction::kToggleForces:
      page_.view.has_force_arrows = !page_.view.has_force_arrows;
      return true;
    case ReplayAction::kToggleGhosts:
      has_ghosts_ = !has_ghosts_;
      return true;
    case ReplayAction::kToggleList:
      page_.is_list_open = !page_.is_list_open;
      if (page_.is_list_open) {
        page_.is_help_open = false;
        screen_->FillRecordingList(options_.recordings.empty() ? record::FindRecordingFolder()
                                                               : options_.recordings);
      }
      return true;
    case ReplayAction::kCloseBeside:
      CloseBeside();
      return true;
    case ReplayAction::kToggleHelp:
      page_.is_help_open = !page_.is_help_open;
      return true;
    case ReplayAction::kCloseCards:
      page_.is_help_open = page_.is_list_open = false;
      return true;
    default:
      return false;
  }
}

void ReplayPresenter::GoTo(double time) {
  if (!Meets(ReplayNeeds::kReplay)) return;
  page_.time = std::clamp(time, page_.begin, page_.end);
  was_there_ = false;
  Follow();
}

void ReplayPresenter::GoToMark(const ReplayMark& mark) {
  GoTo(mark.time - kLead);
}

void ReplayPresenter::StepMark(int direction) {
  constexpr double kSame = 0.5;  // s; who goes back twice quickly means the one before
  std::optional<double> found;
  for (const ReplayMark& mark : sides_[kOwn]->marks) {
    if (mark.kind == ReplayMark::Kind::kEvent) continue;
    const double time = std::max(page_.begin, mark.time - kLead);
    if (direction > 0 && time > page_.time + 0.05) {
      found = time;
      break;
    }
    if (direction < 0 && time < page_.time - kSame) found = time;
  }
  if (found) GoTo(*found);
}

// other hands

void ReplayPresenter::AskForBranch(bool is_experts) {
  if (is_branching_) return;
  is_playing_ = false;
  is_branching_ = true;
  is_branch_experts_ = is_experts;
  session::ReplayRunner& replay = *sides_[kOwn]->replay;
  replay.AskForBranch(replay.Status().goal, Threads());
}

void ReplayPresenter::TakeBranch() {
  if (!is_branching_) return;
  const Side& own = *sides_[kOwn];
  const bool is_busy = own.replay->IsBranching();
  auto made = own.replay->TakeBranch();
  if (!made) {
    // whoever goes elsewhere meanwhile takes nothing over
    is_branching_ = is_busy;
    return;
  }
  is_branching_ = false;
  if (!made->ok()) return Say(host::ShownText(made->error()), true);
  const record::Recording& recording = own.replay->GetRecording();
  const std::uint64_t tick = (*made)->GetSnapshot().tick;
  Branch branch{std::move(**made), record::DescribeBranch(recording, own.path, tick), {}, is_branch_experts_};
  if (tick > recording.FirstTick()) {
    branch.last = recording.inputs[tick - recording.FirstTick() - 1];
  } else {
    branch.last = scene::CalcScriptInput(own.replay->GetScene(), 0);
  }
  screen_->TakeOver(std::move(branch));
}

// the free camera

void ReplayPresenter::Turn(double dx, double dy, int height) {
  if (camera_) render::Orbit(*camera_, dx, dy, height);
}
void ReplayPresenter::Pan(double dx, double dy, int height) {
  if (camera_) render::Pan(*camera_, dx, dy, height);
}
void ReplayPresenter::Zoom(double steps) {
  if (camera_) render::Zoom(*camera_, steps);
}

// frames

/// Whether each side is about where it was last sent to.
bool ReplayPresenter::KeepsUp() const {
  return std::all_of(sides_.begin(), sides_.end(), [&](const std::optional<Side>& side) {
    if (!side) return true;
    const session::ReplayStatus status = side->replay->Status();
    if (status.is_there || status.goal <= status.tick) return status.is_there || status.failure.has_value();
    const double behind = static_cast<double>(status.goal - status.tick) *
                          side->replay->GetRecording().description.tick_seconds;
    return behind < kMostBehind * std::max(1.0, Speed());
  });
}

/// Sends each side to where the playhead is.
void ReplayPresenter::Follow() {
  for (std::optional<Side>& side : sides_) {
    if (!side) continue;
    const double tick = std::floor(page_.time / side->replay->GetRecording().description.tick_seconds + 0.5);
    side->replay->SeekTo(static_cast<std::uint64_t>(std::max(0.0, tick)));
  }
}

std::array<ReplayPresenter::SideWork, ReplayPresenter::kSides> ReplayPresenter::Advance(double now) {
  const double dt = last_frame_ > 0 ? std::clamp(now - last_frame_, 0.0, 0.25) : 0.0;
  last_frame_ = now;
  std::array<SideWork, kSides> work;
  if (!Meets(ReplayNeeds::kReplay)) return work;
  if (is_playing_) {
    is_slow_ = !KeepsUp();
    if (!is_slow_) {
      page_.time = std::min(page_.end, page_.time + dt * Speed());
      Follow();
    }
    if (page_.time >= page_.end) is_playing_ = false;
  }
  TakeBranch();
  for (std::size_t side = 0; side < kSides; ++side) {
    if (sides_[side]) work[side].snapshot = &sides_[side]->replay->Latest();
  }
  for (std::size_t side = 0; side < kSides; ++side) {
    if (!sides_[side]) continue;
    view::Overlay& overlay = work[side].overlay;
    if (camera_) overlay.X_world_camera = view::PoseOf(*camera_);
    if (!has_ghosts_) continue;
    const double time = work[side].snapshot->time;
    const record::TipPath& path = sides_[side]->path_of_tips;
    overlay.trails = view::MakePathTrails(path.Between(instrument::kLeft, time - kTrail, time),
                                          path.Between(instrument::kRight, time - kTrail, time));
    if (const auto* other = work[1 - side].snapshot; other != nullptr) {
      const auto ghosts = view::MakeGhosts(*other);
      overlay.trails.insert(overlay.trails.end(), ghosts.begin(), ghosts.end());
    }
  }
  Refresh();
  return work;
}

// what is shown

void ReplayPresenter::Say(const std::string& text, bool is_warning) {
  page_.message = text;
  page_.is_warning = is_warning;
  host::Log(is_warning ? host::LogLevel::kWarning : host::LogLevel::kInfo, text);
  Refresh();
}

void ReplayPresenter::Refresh() {
  if (page_.failure) {
    page_.state = host::Translate("Stopped");
    return screen_->Show(page_);
  }
  if (!sides_[kOwn]) {
    page_.state = host::TranslateWith("Opening {1}", {loading_path_.filename().string()});
    return screen_->Show(page_);
  }
  const session::ReplayStatus status = sides_[kOwn]->replay->Status();
  page_.clock = FormatClock(page_.time) + " / " + FormatClock(page_.end);
  page_.seek_progress = status.is_there ? 1 : status.progress;
  page_.known_share = status.known_share;
  char speed[16];
  std::snprintf(speed, sizeof speed, "%g×", Speed());
  page_.state = (is_playing_ ? host::Translate("Playing") : host::Translate("Paused")) + "  ·  " +
                host::LocalNumber(speed);
  if (is_playing_ && is_slow_) page_.state += host::Translate("  ·  as fast as this computer can");
  if (!is_playing_ && !status.is_there) {
    page_.state +=
        host::TranslateWith("  ·  seeking, {1} %", {std::to_string(std::lround(100 * status.progress))});
  }
  if (loading_.IsRunning())
    page_.state += host::TranslateWith("  ·  opening {1}", {loading_path_.filename().string()});
  if (status.divergence && !has_diverged_) {
    has_diverged_ = true;
    page_.is_warning = true;
    page_.message = host::TranslateWith(
        "This replay is not the attempt from {1} on: its state differs from what was recorded.",
        {FormatClock(static_cast<double>(status.divergence->tick) *
                     sides_[kOwn]->replay->GetRecording().description.tick_seconds)});
    host::Log(host::LogLevel::kWarning, page_.message);
  }
  if (const std::string failure = status.failure ? host::ShownText(*status.failure) : "";
      page_.message != failure && status.failure) {
    page_.message = failure;
    page_.is_warning = true;
  }
  if (status.is_there && !was_there_ && !is_playing_)
    host::Log(host::LogLevel::kDebug, "the replay stands at " + FormatClock(page_.time));
  was_there_ = status.is_there;
  screen_->Show(page_);
}

}  // namespace trocar::presenter
