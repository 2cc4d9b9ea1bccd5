// SPDX-License-Identifier: Apache-2.0
#include "simulator_window.h"

#include <string>
#include <utility>

#include "play_screenshot.h"
#include "trocar/gui/labels.h"

namespace trocar::app {
namespace {

constexpr int kWidth = 1280, kHeight = 800;

}  // namespace

SimulatorWindow::SimulatorWindow(const Options& options, const core::Stopwatch& since_start,
                                 SimulatorServices services, Beginning beginning)
    : services_(std::move(services)),
      bar_(SimulatorCommands(), tips_,
           [this](const SimulatorCommand& command) { presenter_->Do(command.action.action); }) {
  set_title("Trocar");
  add_css_class("trocar");
  set_default_size(kWidth, kHeight);
  set_titlebar(bar_);
  MakeContent();
  tips_.Adopt(panel_);
  hands_ = std::make_unique<HandEvents>(*this, picture_, panel_);
  presenter_ = std::make_unique<SimulatorPresenter>(
      options, since_start, static_cast<SimulatorScreen&>(*this), [this] { loaded_.emit(); },
      services_.hooks);
  MakeRoutes();
  panel_.set_sensitive(false);  // until there is something to set
  if (options.is_fullscreen) fullscreen();
  picture_.grab_focus();
  if (auto* branch = std::get_if<Branch>(&beginning)) {
    presenter_->TakeOver(std::move(*branch));
  } else if (const auto* start = std::get_if<centre::Start>(&beginning)) {
    presenter_->Open(*start);
  } else if (const auto* task = std::get_if<TaskRequest>(&beginning)) {
    presenter_->Open(*task);
  } else {
    presenter_->Start();
  }
  if (options.is_task_list) presenter_->OpenTaskList();
}

SimulatorWindow::~SimulatorWindow() {
  replay_.reset();
  UseControl(nullptr);
}

void SimulatorWindow::MakeOverlay() {
  overlay_.set_child(picture_);
  overlay_.set_hexpand(true);
  overlay_.set_vexpand(true);
  badge_.add_css_class("badge");
  badge_.set_halign(Gtk::Align::START);
  badge_.set_valign(Gtk::Align::START);
  hint_.add_css_class("hint");
  hint_.set_halign(Gtk::Align::CENTER);
  hint_.set_valign(Gtk::Align::END);
  for (Gtk::Label* label : {&badge_, &hint_}) label->set_can_target(false);
  for (Gtk::Widget* card :
       {static_cast<Gtk::Widget*>(&help_card_), static_cast<Gtk::Widget*>(&chooser_),
        static_cast<Gtk::Widget*>(&recordings_), static_cast<Gtk::Widget*>(&result_card_)})
    card->set_visible(false);
  for (Gtk::Widget* widget :
       {static_cast<Gtk::Widget*>(&badge_), static_cast<Gtk::Widget*>(&hint_),
        static_cast<Gtk::Widget*>(&failure_card_), static_cast<Gtk::Widget*>(&help_card_),
        static_cast<Gtk::Widget*>(&chooser_), static_cast<Gtk::Widget*>(&recordings_),
        static_cast<Gtk::Widget*>(&result_card_)})
    overlay_.add_overlay(*widget);
}

void SimulatorWindow::MakeContent() {
  MakeOverlay();
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

  haptics_.set_visible(false);
  haptics_.add_css_class("status");
  haptics_.set_halign(Gtk::Align::START);
  haptics_.set_ellipsize(Pango::EllipsizeMode::END);

  auto* all = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  all->append(*middle);
  all->append(haptics_);
  all->append(*status);
  set_child(*all);
}

void SimulatorWindow::MakeRoutes() {
  hands_->SignalAction().connect([this](Action action) {
    tips_.End();
    presenter_->Do(action);
  });
  hands_->SignalTaken().connect([this] { tips_.End(); });
  property_is_active().signal_changed().connect([this] { tips_.End(); });
  picture_.SignalDrawn().connect([this] { presenter_->CountPicture(); });
  picture_.SignalFailed().connect([this](const core::Error& error) { presenter_->Fail(error); });
  picture_.add_tick_callback(sigc::mem_fun(*this, &SimulatorWindow::OnFrame));
  loaded_.connect([this] { presenter_->FinishLoading(); });
  // other windows may keep the program alive: what nobody sees any more does not run on
  signal_close_request().connect(
      [this] {
        presenter_->Close();
        return false;
      },
      false);
  chooser_.SignalChosen().connect([this](const TaskRequest& request) { presenter_->Open(request); });
  chooser_.SignalClosed().connect([this] { presenter_->CloseTaskList(); });
  recordings_.SignalChosen().connect(
      [this](const std::filesystem::path& path) { presenter_->OpenRecording(path); });
  recordings_.SignalClosed().connect([this] { presenter_->CloseRecordingList(); });
  result_card_.SignalAgain().connect([this] { presenter_->PlayAgain(); });
  result_card_.SignalOther().connect([this] { presenter_->OpenTaskList(); });
  result_card_.SignalSave().connect([this] { ChooseAndSaveResult(); });
  result_card_.SignalClosed().connect([this] { presenter_->CloseResult(); });
}

bool SimulatorWindow::OnFrame(const Glib::RefPtr<Gdk::FrameClock>& clock) {
  const auto work = presenter_->Advance(1e-6 * static_cast<double>(clock->get_frame_time()),
                                        picture_.FieldOfView(), picture_.CirclePixels());
  if (work.snapshot == nullptr) return true;
  picture_.SetSnapshot(work.snapshot);
  picture_.queue_render();
  if (work.are_forces_due) {
    panel_.Presenter().ShowState(*work.snapshot);
  }
  if (work.are_times_due) {
    panel_.Presenter().ShowTimes(*work.snapshot, presenter_->Control()->Statistics(), presenter_->Stages(),
                                 presenter_->PictureRate());
  }
  if (work.run == UnattendedPlay::Step::kSave) {
    // outside of the frame, which holds the GLArea; a timeout, because frames that fill the time starve idle
    // callbacks
    Glib::signal_timeout().connect_once([this] { SavePlayScreenshot(*this, *presenter_); }, 0);
  }
  return true;
}

void SimulatorWindow::Show(const SimulatorPage& page) {
  if (get_title().raw() != page.title) set_title(page.title);
  bar_.Show([this](const SimulatorCommand& command) { return presenter_->FindButton(command); });
  if (picture_.GetOptions() != page.view) picture_.SetOptions(page.view);
  help_card_.set_visible(page.is_help_open);
  chooser_.set_visible(page.is_task_list_open);
  recordings_.set_visible(page.is_recording_list_open);
  result_card_.set_visible(page.is_result_open);
  gui::SetTextOrHide(hint_, page.hint);
  gui::SetTextOrHide(badge_, page.badge);
  gui::SetTextOrHide(event_, page.event);
  gui::SetTextOrHide(state_, page.state);
  gui::SetTextOrHide(haptics_, page.haptics);
  gui::SetClass(event_, "warning", page.is_event_warning);
  if (!page.failure) return;
  failure_card_.Show(*page.failure);
  panel_.set_sensitive(false);
}

void SimulatorWindow::UseControl(SessionControl* control) {
  device_page_.reset();
  picture_.SetSnapshot(nullptr);
  if (control != nullptr) {
    picture_.SetScene(&control->GetScene(), control->Surfaces(), control->Strands());
  } else {
    picture_.SetScene(nullptr, {}, {});
  }
  panel_.Presenter().UseControl(control);
  panel_.set_sensitive(control != nullptr);
  hands_->SetControl(control);
  tips_.Adopt(panel_);  // the patient's is another one
}

core::Status SimulatorWindow::FillTaskList() {
  const core::Status filled = chooser_.Load();
  tips_.Adopt(chooser_);
  return filled;
}

std::vector<std::string> SimulatorWindow::UseKeys(const std::map<std::string, device::HandAct>& keys) {
  return hands_->SetKeys(keys);
}

void SimulatorWindow::DoInWindow(Action action) {
  switch (action) {
    case Action::kToggleFullscreen:
      is_fullscreen() ? unfullscreen() : fullscreen();
      break;
    case Action::kSwitchPane:
      SwitchPane();
      break;
    case Action::kOpenDevices:
      OpenDevices();
      break;
    case Action::kOpenCentre:
      if (services_.open_centre) services_.open_centre();
      break;
    case Action::kQuit:
      // never within a frame, which holds the GLArea
      Glib::signal_timeout().connect_once([this] { close(); }, 0);
      break;
    default:
      break;
  }
}

void SimulatorWindow::OpenReplay(const std::filesystem::path& recording) {
  Options options = presenter_->GetOptions();
  options.replay = recording;
  options.replay_beside.clear();
  replay_ = std::make_unique<ReplayWindow>(options, [this](Branch branch) {
    presenter_->TakeOver(std::move(branch));
    present();
  });
  replay_->set_transient_for(*this);
  get_application()->add_window(*replay_);
  replay_->present();
}

void SimulatorWindow::OpenAttempt(const std::filesystem::path& recording,
                                  const std::optional<centre::ExamSitting>& exam) {
  // outside of the frame, which holds the GLArea: a window opens
  Glib::signal_timeout().connect_once(
      [this, recording, exam] {
        if (services_.open_attempt) services_.open_attempt(recording, exam);
      },
      0);
}

void SimulatorWindow::SwitchPane() {
  if (get_focus() == &picture_) {
    panel_.child_focus(Gtk::DirectionType::TAB_FORWARD);
  } else {
    picture_.grab_focus();
  }
}

void SimulatorWindow::OpenDevices() {
  device_page_ = std::make_unique<DevicePage>(presenter_->GetOptions(), presenter_->Control());
  device_page_->set_transient_for(*this);
  get_application()->add_window(*device_page_);
  device_page_->present();
}

void SimulatorWindow::ChooseAndSaveResult() {
  gui::FileRequest request;
  request.title = "Save the result";
  request.new_name = "result.html";
  request.kinds = {{"Page (HTML)", "*.html"}, {"Data (JSON)", "*.json"}};
  file_dialog_.Ask(*this, request,
                   [this](const std::filesystem::path& file) { presenter_->SaveResult(file); });
}

}  // namespace trocar::app
