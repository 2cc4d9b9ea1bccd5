// SPDX-License-Identifier: Apache-2.0
#include "simulator_window.h"

#include <algorithm>
#include <cstdio>
#include <string>

#include "trocar/core/log.h"
#include "trocar/core/safe_file.h"
#include "trocar/device/device_spec.h"
#include "window_screenshot.h"

namespace trocar::app {
namespace {

constexpr int kWidth = 1280, kHeight = 800;
constexpr double kForcePeriod = 0.1;   // between refreshes of the forces [s]
constexpr double kTimesPeriod = 0.25;  // between refreshes of the other numbers [s]
constexpr const char* kDefaultScene = "demonstration.json";

core::Result<session::Simulation> Load(const Options& options) {
  std::filesystem::path path = options.scene;
  if (!options.task.empty()) {
    const core::Result<std::filesystem::path> task = session::FindTask(options.task);
    if (!task) return task.error();
    path = task.value();
  } else if (path.empty()) {
    const core::Result<std::filesystem::path> folder = session::FindDataFolder();
    if (!folder) return folder.error();
    path = folder.value() / "scenes" / kDefaultScene;
  }
  core::Result<session::Scene> scene = options.task.empty()
                                           ? session::ReadScene(path)
                                           : session::ReadTask(path, {options.level, options.seed, {}});
  if (!scene) return scene.error();
  const int threads =
      options.threads > 0 ? options.threads : ChooseThreads(std::thread::hardware_concurrency());
  return session::Simulation::Make(std::make_shared<const session::Scene>(std::move(scene).value()), threads);
}

void MakeMouseOnly(Gtk::Widget& widget) {
  widget.set_focus_on_click(false);
}

/// Makes `text` the label's text if it is not already; an empty text hides the label.
void SetText(Gtk::Label& label, const std::string& text) {
  if (label.get_text().raw() != text) label.set_text(text);
  if (label.get_visible() == text.empty()) label.set_visible(!text.empty());
}

}  // namespace

SimulatorWindow::SimulatorWindow(const Options& options, const core::Stopwatch& since_start)
    : options_(options), since_start_(since_start) {
  set_title("Trocar");
  add_css_class("trocar");
  set_default_size(kWidth, kHeight);
  MakeHeader();
  MakeContent();
  MakeTaskCards();

  hands_ = std::make_unique<HandEvents>(*this, picture_, panel_);
  hands_->SignalAction().connect(sigc::mem_fun(*this, &SimulatorWindow::OnAction));
  picture_.SignalDrawn().connect(sigc::mem_fun(*this, &SimulatorWindow::OnDrawn));
  picture_.SignalFailed().connect(sigc::mem_fun(*this, &SimulatorWindow::Fail));
  picture_.add_tick_callback(sigc::mem_fun(*this, &SimulatorWindow::OnFrame));
  loaded_.connect(sigc::mem_fun(*this, &SimulatorWindow::FinishLoading));
  panel_.set_sensitive(false);  // until there is something to set
  if (options_.is_fullscreen) fullscreen();
  ShowSituation();
  picture_.grab_focus();
  StartLoading();
  if (options_.is_task_list) OpenTaskList();
}

SimulatorWindow::~SimulatorWindow() {
  if (loader_.joinable()) loader_.join();
  picture_.SetSnapshot(nullptr);
  picture_.SetScene(nullptr, {}, {});
  panel_.SetControl(nullptr);
  hands_->SetControl(nullptr);
}

void SimulatorWindow::MakeHeader() {
  const auto button = [](Gtk::Button& widget, const char* tooltip) {
    widget.set_tooltip_text(tooltip);
    MakeMouseOnly(widget);
  };
  button(run_, "Start or pause the simulation (Space)");
  run_.add_css_class("primary");
  run_.set_size_request(84, -1);
  button(reset_, "Back to the beginning (R)");
  button(demonstration_, "The script of the scene moves both hands; press again to take over (P)");
  button(fulcrum_,
         "As in a real trocar: the mouse is the handle, so the tip goes the other way. Off: the tip follows "
         "the mouse (T)");
  button(forces_, "Arrows for the forces on the instruments (F)");
  button(mask_, "Round mask of the laparoscope (M)");
  button(fullscreen_, "Full screen and back (F11)");
  button(help_, "All keys (H or F1)");
  button(devices_, "Find, try and calibrate devices, and choose what holds the instruments");
  button(tasks_, "Choose a training task or an operation");
  button(quit_, "Leave the program (Ctrl+Q)");
  button(force_,
         "Force feedback of the haptic device: asks for it, or takes it away (Esc takes it away, too)");
  button(check_pose_, "Confirm which haptic device is which hand");
  for (Gtk::Widget* widget : {static_cast<Gtk::Widget*>(&force_), static_cast<Gtk::Widget*>(&check_pose_)})
    widget->set_visible(!options_.haptics.empty());
  forces_.set_active(true);
  mask_.set_active(true);
  for (Gtk::Widget* widget : {static_cast<Gtk::Widget*>(&tasks_), static_cast<Gtk::Widget*>(&run_),
                              static_cast<Gtk::Widget*>(&reset_), static_cast<Gtk::Widget*>(&demonstration_),
                              static_cast<Gtk::Widget*>(&fulcrum_), static_cast<Gtk::Widget*>(&check_pose_),
                              static_cast<Gtk::Widget*>(&force_)})
    header_.pack_start(*widget);
  for (Gtk::Widget* widget : {static_cast<Gtk::Widget*>(&quit_), static_cast<Gtk::Widget*>(&help_),
                              static_cast<Gtk::Widget*>(&fullscreen_), static_cast<Gtk::Widget*>(&mask_),
                              static_cast<Gtk::Widget*>(&forces_), static_cast<Gtk::Widget*>(&devices_)})
    header_.pack_end(*widget);

  const auto act = [this](Gtk::Button& widget, Action action) {
    widget.signal_clicked().connect([this, action] {
      if (!is_showing_) OnAction(action);
    });
  };
  act(run_, Action::kTogglePause);
  act(reset_, Action::kReset);
  act(fullscreen_, Action::kToggleFullscreen);
  act(quit_, Action::kQuit);
  demonstration_.signal_toggled().connect([this] {
    if (!is_showing_) SetDemonstration(demonstration_.get_active());
  });
  force_.signal_toggled().connect([this] {
    session::HapticLoop* haptics = control_ != nullptr ? control_->Haptics() : nullptr;
    if (is_showing_ || haptics == nullptr) return;
    force_.get_active() ? haptics->RequestArm() : haptics->Stop();
  });
  check_pose_.signal_clicked().connect([this] {
    if (control_ != nullptr && control_->Haptics() != nullptr) control_->Haptics()->BeginCheckPose();
  });
  tasks_.signal_clicked().connect(
      [this] { chooser_.get_visible() ? chooser_.set_visible(false) : OpenTaskList(); });
  devices_.signal_clicked().connect(sigc::mem_fun(*this, &SimulatorWindow::OpenDevices));
  const auto look = [this] {
    view::ViewOptions view = picture_.GetOptions();
    view.has_force_arrows = forces_.get_active();
    view.has_mask = mask_.get_active();
    picture_.SetOptions(view);
  };
  forces_.signal_toggled().connect(look);
  mask_.signal_toggled().connect(look);
  help_.signal_toggled().connect([this] { help_card_.set_visible(help_.get_active()); });
  fulcrum_.signal_toggled().connect([this] {
    if (control_ != nullptr) control_->SetMirrorFulcrum(fulcrum_.get_active());
    ShowSituation();
  });
  header_.set_show_title_buttons(true);
  set_titlebar(header_);
}

void SimulatorWindow::MakeContent() {
  overlay_.set_child(picture_);
  overlay_.set_hexpand(true);
  overlay_.set_vexpand(true);
  badge_.add_css_class("badge");
  badge_.set_halign(Gtk::Align::START);
  badge_.set_valign(Gtk::Align::START);
  hint_.add_css_class("hint");
  hint_.set_halign(Gtk::Align::CENTER);
  hint_.set_valign(Gtk::Align::END);
  failure_card_.add_css_class("failure");
  failure_card_.set_halign(Gtk::Align::CENTER);
  failure_card_.set_valign(Gtk::Align::CENTER);
  failure_card_.set_spacing(8);
  failure_card_.set_visible(false);
  help_card_.set_visible(false);
  for (Gtk::Widget* widget :
       {static_cast<Gtk::Widget*>(&badge_), static_cast<Gtk::Widget*>(&hint_),
        static_cast<Gtk::Widget*>(&failure_card_), static_cast<Gtk::Widget*>(&help_card_)})
    overlay_.add_overlay(*widget);
  for (Gtk::Label* label : {&badge_, &hint_}) label->set_can_target(false);

  auto* keys = Gtk::make_managed<Gtk::Label>(ShortHelp());
  keys->add_css_class("keys");
  keys->set_ellipsize(Pango::EllipsizeMode::END);
  auto* left = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  left->append(overlay_);
  left->append(*keys);

  auto* middle = Gtk::make_managed<Gtk::Box>();
  middle->append(*left);
  middle->append(panel_);

  auto* status = Gtk::make_managed<Gtk::Box>();
  status->add_css_class("status");
  event_.set_halign(Gtk::Align::START);
  event_.set_hexpand(true);
  event_.set_ellipsize(Pango::EllipsizeMode::END);
  state_.add_css_class("numbers");
  status->append(event_);
  status->append(state_);

  haptics_.set_visible(!options_.haptics.empty());
  haptics_.add_css_class("status");
  haptics_.set_halign(Gtk::Align::START);
  haptics_.set_ellipsize(Pango::EllipsizeMode::END);

  auto* all = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  all->append(*middle);
  all->append(haptics_);
  all->append(*status);
  set_child(*all);
}

void SimulatorWindow::StartLoading() {
  loader_ = std::thread([this] {
    simulation_.emplace(Load(options_));
    loaded_.emit();
  });
}

void SimulatorWindow::FinishLoading() {
  loader_.join();
  if (failure_) return;
  if (!simulation_->ok()) return Fail(simulation_->error());
  core::Result<std::unique_ptr<SessionControl>> control =
      SessionControl::Make(std::move(*simulation_).value());
  simulation_.reset();
  if (!control) return Fail(control.error());
  control_ = std::move(control).value();
  control_->SetMirrorFulcrum(fulcrum_.get_active());
  if (!UseDevices()) return;
  if (options_.igtl_port >= 0) {
    if (const core::Status served = control_->Serve(options_.igtl_port); !served) return Fail(served.error());
    core::Log(core::LogLevel::kInfo,
              "OpenIGTLink: viewers may connect to localhost:" + std::to_string(control_->ServedPort()));
  }
  panel_.SetControl(control_.get());
  panel_.set_sensitive(true);
  hands_->SetControl(control_.get());
  picture_.SetScene(&control_->GetScene(), control_->Surfaces(), control_->Strands());
  set_title("Trocar: " + control_->GetScene().name);
  demonstration_.set_sensitive(control_->HasScript());
  SetText(event_, "Ready.");
  if (options_.is_demonstration || !options_.screenshot.empty()) SetDemonstration(true);
  SetPaused(false);
}

/// What the options name, with the person's settings.
/// \return false, with the failure shown, where they name a device that cannot be
bool SimulatorWindow::UseDevices() {
  const device::LoadedStore loaded = device::LoadDeviceStore(device::FindDeviceStore());
  if (loaded.complaint) core::Log(core::LogLevel::kWarning, loaded.complaint->Text());
  for (const std::string& key : hands_->SetKeys(loaded.store.keys))
    core::Log(
        core::LogLevel::kWarning,
        "the key \"" + key + "\" of the device settings can have no act; docs/devices.md says which can");
  if (!options_.haptics.empty()) {
    const device::ButtonMap buttons = loaded.store.Buttons("haptics");
    if (const core::Status started = control_->UseHaptics(options_.haptics, buttons); !started) {
      Fail(started.error());
      return false;
    }
  }
  if (options_.device.empty()) return true;
  core::Result<std::unique_ptr<device::Driver>> driver =
      device::MakeDriver(options_.device, loaded.store, device::SystemClock());
  if (!driver) {
    Fail(driver.error());
    return false;
  }
  control_->UseDevice(std::move(driver).value(), device::FindButtons(options_.device, loaded.store));
  return true;
}

void SimulatorWindow::Fail(const core::Error& error) {
  if (failure_) return;
  failure_ = error;
  core::Log(core::LogLevel::kError, error.Text());
  if (control_ != nullptr) control_->SetPaused(true);
  if (!options_.screenshot.empty()) {
    // nobody is there to read the card
    Glib::signal_timeout().connect_once([this] { close(); }, 0);
    return;
  }
  const auto line = [this](const std::string& text, const char* style) {
    auto* label = Gtk::make_managed<Gtk::Label>(text);
    label->add_css_class(style);
    label->set_wrap(true);
    label->set_max_width_chars(64);
    label->set_selectable(true);
    label->set_focusable(false);
    label->set_xalign(0);
    failure_card_.append(*label);
  };
  line(std::string(core::CodeText(error.code)), "code");
  line(error.message, "text");
  line("`trocar doctor` checks graphics, display and data and says how to mend them.", "text");
  failure_card_.set_visible(true);
  hint_.set_visible(false);
  badge_.set_visible(false);
  for (Gtk::Widget* widget : {static_cast<Gtk::Widget*>(&run_), static_cast<Gtk::Widget*>(&reset_),
                              static_cast<Gtk::Widget*>(&demonstration_), static_cast<Gtk::Widget*>(&tasks_)})
    widget->set_sensitive(false);
  chooser_.set_visible(false);
  result_card_.set_visible(false);
  panel_.set_sensitive(false);
  SetText(event_, error.Text());
  ShowSituation();
}

bool SimulatorWindow::OnFrame(const Glib::RefPtr<Gdk::FrameClock>& clock) {
  const double now = 1e-6 * static_cast<double>(clock->get_frame_time());
  const double dt = last_frame_ > 0.0 ? now - last_frame_ : 0.0;
  last_frame_ = now;
  if (control_ == nullptr || failure_) return true;

  control_->SetPicture(picture_.FieldOfView(), picture_.CirclePixels());
  const session::Snapshot& snapshot = control_->Advance(dt);
  picture_.SetSnapshot(&snapshot);
  picture_.queue_render();
  stages_.Add(snapshot);
  ShowEvents(snapshot);
  if (control_->GetScene().task) FollowTask(snapshot.task);
  if (const std::string message = control_->TakeDeviceMessage(); !message.empty()) {
    SetText(event_, message);
    ShowSituation();
  }
  if (now - last_forces_ > kForcePeriod) {
    last_forces_ = now;
    panel_.ShowForces(snapshot);
    panel_.ShowOperation(snapshot);
    panel_.ShowTask(snapshot);
    ShowHaptics();
    ShowSituation();
  }
  if (now - last_times_ > kTimesPeriod) {
    last_times_ = now;
    const double rate = frames_.Rate(since_start_.Seconds());
    panel_.ShowTimes(snapshot, control_->Statistics(), stages_, rate);
  }
  SaveScreenshotWhenDue(snapshot);
  return true;
}

void SimulatorWindow::ShowHaptics() {
  session::HapticLoop* haptics = control_->Haptics();
  if (haptics == nullptr) return;
  for (Gtk::Widget* widget : {static_cast<Gtk::Widget*>(&force_), static_cast<Gtk::Widget*>(&check_pose_)})
    widget->set_visible(true);
  const session::HapticStatus& status = haptics->Latest();
  SetText(haptics_, session::DescribeHaptics(status));
  // the button shows what is, not what was wished
  is_showing_ = true;
  force_.set_active(std::any_of(
      status.hands.begin(), status.hands.end(),
      [](const session::HapticHandStatus& hand) { return hand.state != haptics::ArmState::kUnarmed; }));
  is_showing_ = false;
}

void SimulatorWindow::OpenDevices() {
  if (control_ == nullptr || failure_) return;
  device_page_ = std::make_unique<DevicePage>(options_, control_.get());
  device_page_->set_transient_for(*this);
  get_application()->add_window(*device_page_);
  device_page_->present();
}

void SimulatorWindow::SaveHapticRecord() {
  if (options_.haptic_record.empty() || control_ == nullptr) return;
  const core::Status saved =
      core::WriteFile(options_.haptic_record, control_->GetHapticRecord().FormatJson());
  if (saved) return;
  core::Log(core::LogLevel::kError, saved.error().Text());
  if (!failure_) failure_ = saved.error();
}

void SimulatorWindow::OnDrawn() {
  frames_.Add(since_start_.Seconds());
  if (first_picture_ == 0.0) first_picture_ = since_start_.Seconds();
}

void SimulatorWindow::ShowSituation() {
  Situation situation;
  situation.is_loaded = control_ != nullptr;
  if (control_ != nullptr) {
    situation.is_paused = control_->IsPaused();
    situation.is_demonstration = control_->IsDemonstration();
    situation.is_demonstration_over = control_->IsDemonstrationOver();
    situation.is_laparoscope_held = control_->IsLaparoscopeHeld();
    situation.has_camera_holder = control_->HasCameraHolder();
    situation.is_right_hand = control_->GetHand() == device::kRightHand;
    situation.is_fulcrum_mirrored = control_->IsFulcrumMirrored();
  }
  situation.is_pointer_taken = hands_ != nullptr && hands_->IsPointerTaken();
  SetText(hint_, failure_ ? "" : HintText(situation));
  SetText(badge_, failure_ ? "" : BadgeText(situation));
  std::string state = failure_ ? "Stopped" : StateText(situation);
  if (control_ != nullptr) {
    const double rate = frames_.Rate(since_start_.Seconds());
    state += "   ·   " + std::to_string(static_cast<int>(rate + 0.5)) + " pictures/s";
  }
  SetText(state_, state);
  is_showing_ = true;
  run_.set_label(situation.is_paused ? "Start" : "Pause");
  demonstration_.set_active(situation.is_demonstration);
  is_showing_ = false;
}

void SimulatorWindow::ShowEvents(const session::Snapshot& snapshot) {
  if (snapshot.event_count < seen_events_) seen_events_ = 0;
  if (snapshot.event_count == seen_events_) return;
  seen_events_ = snapshot.event_count;
  const session::Event& newest = snapshot.events[(snapshot.event_count - 1) % snapshot.events.size()];
  SetText(event_, DescribeEvent(newest, control_->GetScene()));
  if (IsWarning(newest.kind)) {
    event_.add_css_class("warning");
  } else {
    event_.remove_css_class("warning");
  }
}

void SimulatorWindow::SetPaused(bool is_paused) {
  if (control_ == nullptr || failure_) return;
  control_->SetPaused(is_paused);
  ShowSituation();
}

void SimulatorWindow::SetDemonstration(bool is_on) {
  if (control_ == nullptr || failure_) return;
  hands_->ReleasePointer();
  control_->SetDemonstration(is_on);
  if (is_on) SetPaused(false);
  ShowSituation();
}

void SimulatorWindow::Reset() {
  if (control_ == nullptr || failure_) return;
  control_->Reset();
  SetText(event_, "Reset.");
  event_.remove_css_class("warning");
  ShowSituation();
}

void SimulatorWindow::OnAction(Action action) {
  switch (action) {
    case Action::kTogglePause:
      if (control_ != nullptr) SetPaused(!control_->IsPaused());
      break;
    case Action::kNextTool:
    case Action::kPreviousTool:
      if (control_ != nullptr) control_->StepTool(action == Action::kNextTool ? 1 : -1);
      break;
    case Action::kFreeze:
      if (control_ != nullptr) control_->ToggleFreeze();
      break;
    case Action::kAssistant:
      if (control_ != nullptr) control_->StepAssistant();
      break;
    case Action::kToggleCameraHolder:
      if (control_ != nullptr) control_->SetCameraHolder(!control_->HasCameraHolder());
      break;
    case Action::kReset:
      Reset();
      break;
    case Action::kToggleDemonstration:
      if (control_ != nullptr) SetDemonstration(!control_->IsDemonstration());
      break;
    case Action::kToggleForces:
      forces_.set_active(!forces_.get_active());
      break;
    case Action::kToggleMask:
      mask_.set_active(!mask_.get_active());
      break;
    case Action::kToggleFulcrum:
      fulcrum_.set_active(!fulcrum_.get_active());
      break;
    case Action::kToggleHelp:
      help_.set_active(!help_.get_active());
      break;
    case Action::kToggleFullscreen:
      if (is_fullscreen()) {
        unfullscreen();
      } else {
        fullscreen();
      }
      break;
    case Action::kChooseLeft:
    case Action::kChooseRight:
    case Action::kSwitchHand:
      if (control_ == nullptr) break;
      if (action == Action::kSwitchHand) {
        control_->SwitchHand();
      } else {
        control_->ChooseHand(action == Action::kChooseLeft ? device::kLeftHand : device::kRightHand);
      }
      ShowSituation();
      break;
    case Action::kReleasePointer:
      if (control_ != nullptr && control_->Haptics() != nullptr) control_->Haptics()->Stop();
      picture_.grab_focus();
      help_.set_active(false);
      chooser_.set_visible(false);
      result_card_.set_visible(false);
      ShowSituation();
      break;
    case Action::kSwitchPane:
      if (get_focus() == &picture_) {
        panel_.child_focus(Gtk::DirectionType::TAB_FORWARD);
      } else {
        picture_.grab_focus();
      }
      break;
    case Action::kQuit:
      close();
      break;
    default:
      break;
  }
}

void SimulatorWindow::SaveScreenshotWhenDue(const session::Snapshot& snapshot) {
  if (options_.screenshot.empty() || is_screenshot_due_) return;
  // a simulation that does not get on must not hang a test
  const double limit = 60.0 + 20.0 * options_.screenshot_after;
  if (since_start_.Seconds() > limit) {
    return Fail(
        {core::ErrorCode::kUsage, "--after was not reached in " + std::to_string(static_cast<int>(limit)) +
                                      " s: the simulation is slower than real time here; ask for less"});
  }
  if (snapshot.time < options_.screenshot_after) return;
  is_screenshot_due_ = true;
  // outside of the frame, which holds the GLArea; a timeout, because frames that fill the time starve idle
  // callbacks
  Glib::signal_timeout().connect_once(sigc::mem_fun(*this, &SimulatorWindow::SaveScreenshot), 0);
}

void SimulatorWindow::SaveScreenshot() {
  if (const auto status = app::SaveScreenshot(*this, options_.screenshot); !status)
    return Fail(status.error());
  const session::RunnerStatistics statistics = control_->Statistics();
  const std::string haptics = control_->Haptics() != nullptr
                                  ? session::FormatHapticsJson(control_->Haptics()->Latest())
                                  : std::string();
  std::printf(
      "{\"screenshot\": \"%s\", \"width\": %d, \"height\": %d, \"first_picture_s\": %.3f, \"ticks\": %llu, "
      "\"late_ticks\": %llu, \"tick_median_ms\": %.3f, \"tick_p99_ms\": %.3f, \"real_time\": %s, "
      "\"pictures\": %llu, "
      "\"pictures_per_second\": %.1f, \"has_task_list\": %s, \"result\": \"%s\"%s%s}\n",
      options_.screenshot.filename().c_str(), get_width(), get_height(), first_picture_,
      static_cast<unsigned long long>(statistics.ticks),
      static_cast<unsigned long long>(statistics.late_ticks), 1e3 * statistics.tick_median,
      1e3 * statistics.tick_p99, statistics.is_real_time ? "true" : "false",
      static_cast<unsigned long long>(frames_.Count()), frames_.Rate(since_start_.Seconds()),
      chooser_.get_visible() ? "true" : "false", result_card_.get_visible() ? result_.verdict.c_str() : "",
      haptics.empty() ? "" : ", \"haptics\": ", haptics.c_str());
  close();
}

}  // namespace trocar::app
