// SPDX-License-Identifier: Apache-2.0
#include "simulator_window.h"

#include <string>
#include <utility>

#include "picture_folder.h"
#include "play_screenshot.h"
#include "trocar/gui/labels.h"
#include "trocar/gui/over_card.h"
#include "trocar/gui/window_screenshot.h"
#include "trocar/host/translate.h"
#include "trocar/host/user_folder.h"
#include "trocar/presenter/guides.h"

namespace trocar::app {
namespace {

constexpr int kHintWidth = 80;           // [characters]
constexpr double kWorthAQuestion = 6.0;  // of an attempt [s]

}  // namespace

SimulatorWindow::SimulatorWindow(const presenter::Options& options, const host::Stopwatch& since_start,
                                 SimulatorServices services, Beginning beginning)
    : services_(std::move(services)),
      bar_(presenter::SimulatorCommands(), tips_,
           [this](const presenter::SimulatorCommand& command) { presenter_->Do(command.action.action); }),
      keys_(MakeKeyCardServices()),
      loading_best_([this] { best_loaded_.emit(); }) {
  set_title("Trocar");
  add_css_class("trocar");
  gui::FitToScreen(*this, options.width, options.height);
  set_titlebar(bar_);
  MakeContent();
  tips_.Adopt(panel_);
  hands_ = std::make_unique<HandEvents>(*this, picture_, panel_);
  presenter_ = std::make_unique<presenter::SimulatorPresenter>(
      options, since_start, static_cast<presenter::SimulatorScreen&>(*this), [this] { loaded_.emit(); },
      services_.hooks);
  MakeRoutes();
  MakeSound(options);
  panel_.set_sensitive(false);  // until there is something to set
  if (options.is_fullscreen) fullscreen();
  picture_.grab_focus();
  if (auto* branch = std::get_if<presenter::Branch>(&beginning)) {
    presenter_->TakeOver(std::move(*branch));
  } else if (const auto* start = std::get_if<centre::Start>(&beginning)) {
    presenter_->Open(*start);
  } else if (const auto* task = std::get_if<presenter::TaskRequest>(&beginning)) {
    presenter_->Open(*task);
  } else {
    presenter_->Start();
  }
  if (options.is_task_list) presenter_->OpenTaskList();
}

SimulatorWindow::~SimulatorWindow() {
  replay_.reset();
  if (rehearsal_ != nullptr) overlay_.remove_overlay(*rehearsal_);
  UseControl(nullptr);
}

void SimulatorWindow::MakeOverlay() {
  overlay_.set_child(picture_);
  gui::SetAccessibleName(picture_, host::Translate("Picture of the laparoscope"));
  overlay_.set_hexpand(true);
  overlay_.set_vexpand(true);
  badge_.add_css_class("badge");
  badge_.set_halign(Gtk::Align::START);
  badge_.set_valign(Gtk::Align::START);
  badge_.set_hexpand(true);
  hint_.add_css_class("hint");
  hint_.set_halign(Gtk::Align::CENTER);
  hint_.set_valign(Gtk::Align::END);
  progress_.add_css_class("badge");
  progress_.set_halign(Gtk::Align::END);
  progress_.set_valign(Gtk::Align::START);
  top_.set_valign(Gtk::Align::START);
  top_.Append(badge_);
  top_.Append(progress_);
  for (Gtk::Label* label : {&badge_, &progress_, &tutorial_, &hint_}) label->set_wrap(true);
  for (Gtk::Label* label : {&tutorial_, &hint_}) {
    label->set_max_width_chars(kHintWidth);
    label->set_justify(Gtk::Justification::CENTER);
  }
  tutorial_.add_css_class("hint");
  tutorial_.add_css_class("warning");
  tutorial_.set_halign(Gtk::Align::CENTER);
  tutorial_.set_valign(Gtk::Align::START);
  tutorial_.set_margin_top(56);
  tutorial_task_.set_label(host::TranslateWith("Start {1}", {presenter::TutorialTaskName()}));
  tutorial_task_.add_css_class("primary");
  tutorial_task_.set_halign(Gtk::Align::CENTER);
  tutorial_task_.set_valign(Gtk::Align::CENTER);
  tutorial_task_.set_visible(false);
  tutorial_task_.signal_clicked().connect([this] { presenter_->StartTutorialTask(); });
  overlay_.add_overlay(tutorial_task_);
  MakeQuestion();
  const std::initializer_list<Gtk::Widget*> labels = {&top_, &tutorial_, &hint_};
  const std::initializer_list<Gtk::Widget*> cards = {
      &home_, &help_, &chooser_, &patients_, &keys_, &opening_, &recordings_, &result_card_, &question_};
  for (Gtk::Widget* label : labels) {
    label->set_can_target(false);
    overlay_.add_overlay(*label);
  }
  overlay_.add_overlay(failure_card_);
  for (Gtk::Widget* card : cards) {
    card->set_visible(false);
    Gtk::ScrolledWindow& scroller = gui::AddOverCard(overlay_, *card);
    if (card == &help_) help_scroller_ = &scroller;
  }
}

/// Before an attempt is thrown away.
void SimulatorWindow::MakeQuestion() {
  question_.add_css_class("help");
  question_.set_halign(Gtk::Align::CENTER);
  question_.set_valign(Gtk::Align::CENTER);
  question_.set_spacing(12);
  asked_.add_css_class("key-text");
  auto* answers = Gtk::make_managed<Gtk::Box>();
  answers->set_spacing(8);
  answers->set_halign(Gtk::Align::END);
  auto* no = Gtk::make_managed<Gtk::Button>(host::Translate("No, go on"));
  no->add_css_class("primary");
  auto* yes = Gtk::make_managed<Gtk::Button>(host::Translate("Yes"));
  no->signal_clicked().connect([this] { presenter_->Answer(false); });
  yes->signal_clicked().connect([this] { presenter_->Answer(true); });
  answers->append(*yes);
  answers->append(*no);
  question_.append(asked_);
  question_.append(*answers);
}

void SimulatorWindow::MakeContent() {
  MakeOverlay();
  mode_.add_css_class("keys");
  mode_.set_wrap(true);  // in a narrow window two lines, never a part of one
  auto* left = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  left->append(overlay_);
  left->append(mode_);

  auto* middle = Gtk::make_managed<Gtk::Box>();
  middle->append(*left);
  middle->append(panel_);

  auto* status = Gtk::make_managed<Gtk::Box>();
  status->add_css_class("status");
  event_.set_halign(Gtk::Align::START);
  event_.set_hexpand(true);
  event_.set_wrap(true);
  event_.set_xalign(0);
  state_.add_css_class("numbers");
  status->append(event_);
  status->append(state_);

  haptics_.set_visible(false);
  haptics_.add_css_class("status");
  haptics_.set_halign(Gtk::Align::START);
  haptics_.set_wrap(true);

  auto* all = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  all->append(*middle);
  all->append(haptics_);
  all->append(film_bar_);
  all->append(*status);
  set_child(*all);
}

void SimulatorWindow::MakeRoutes() {
  hands_->SignalAction().connect([this](presenter::Action action) {
    tips_.End();
    presenter_->Do(action);
  });
  hands_->SignalTaken().connect([this] {
    tips_.End();
    if (!hands_->CanHoldPointer()) presenter_->SayPointerIsFree();
  });
  property_is_active().signal_changed().connect([this] { tips_.End(); });
  picture_.SignalDrawn().connect([this] { presenter_->CountPicture(); });
  picture_.SignalFailed().connect([this](const base::Error& error) { presenter_->Fail(error); });
  picture_.add_tick_callback(sigc::mem_fun(*this, &SimulatorWindow::OnFrame));
  home_.SignalChosen().connect([this](presenter::HomeChoice choice) { presenter_->Choose(choice); });
  home_.SignalPerson().connect([this](const std::string& text) { presenter_->BeSomebody(text); });
  loaded_.connect([this] { presenter_->FinishLoading(); });
  // other windows may keep the program alive: what nobody sees any more does not run on
  signal_close_request().connect(
      [this] {
        if (!presenter_->MayClose()) return true;
        is_open_ = false;
        presenter_->Close();
        if (rehearsal_ != nullptr) rehearsal_->Leave();
        return false;
      },
      false);
  chooser_.SignalChosen().connect(
      [this](const presenter::TaskRequest& request) { presenter_->Open(request); });
  chooser_.SignalClosed().connect([this] { presenter_->CloseTaskList(); });
  chooser_.SignalPatients().connect([this] { presenter_->OpenPatientList(); });
  patients_.SignalChosen().connect(
      [this](const std::filesystem::path& folder) { presenter_->ChoosePatient(folder); });
  patients_.SignalImages().connect([this] { presenter_->OpenRehearsal(); });
  patients_.SignalClosed().connect([this] { presenter_->ClosePatientList(); });
  keys_.SignalClosed().connect([this] {
    hands_->AskKey(nullptr);
    presenter_->CloseKeyList();
  });
  opening_.SignalCancelled().connect([this] { presenter_->CancelOpening(); });
  best_loaded_.connect([this] {
    // a store that is away is said where results are shown; here there are just none
    const auto best = loading_best_.Take();
    if (best.ok()) presenter_->ShowBest(*best);
    if (std::exchange(wants_best_again_, false)) RequestBest();
  });
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
  presenter::SessionControl& control = *presenter_->Control();
  view::Overlay overlay;
  overlay.X_world_camera = control.CalcView(*work.snapshot);
  if (presenter_->HasGuides())
    overlay.trails =
        presenter::MakeGuides(control.GetScene(), control.Surfaces(), control.Strands(), *work.snapshot);
  if (auto mark =
          presenter::MarkOperationStep(presenter_->NextOperationStep(), work.snapshot->X_world_laparoscope))
    overlay.trails.push_back(std::move(*mark));
  picture_.SetOverlay(std::move(overlay));
  picture_.queue_render();
  HearFrame(*work.snapshot);
  if (work.are_forces_due) {
    panel_.Presenter().ShowState(*work.snapshot);
  }
  if (work.are_times_due) {
    panel_.Presenter().ShowTimes(*work.snapshot, presenter_->Control()->Statistics(), presenter_->Stages(),
                                 presenter_->PictureRate());
  }
  if (work.run == presenter::UnattendedPlay::Step::kSave) {
    // outside of the frame, which holds the GLArea; a timeout, because frames that fill the time starve idle
    // callbacks
    Glib::signal_timeout().connect_once([this] { SavePlayScreenshot(*this, *presenter_); }, 0);
  }
  return true;
}

void SimulatorWindow::Show(const presenter::SimulatorPage& page) {
  if (get_title().raw() != page.title) {
    set_title(page.title);
    bar_.SetHeading(page.title);
  }
  bar_.Show([this](const presenter::SimulatorCommand& command) { return presenter_->FindButton(command); });
  if (picture_.GetOptions() != page.view) picture_.SetOptions(page.view);
  hands_->SetBindings(presenter_->Bindings());
  hands_->FollowPause();
  if (page.is_help_open) ShowHelp();
  help_.set_visible(page.is_help_open);
  FocusCard(page);
  if (page.is_key_list_open) keys_.Show(presenter_->Bindings(), presenter_->CanUndoKeys());
  keys_.set_visible(page.is_key_list_open);
  patients_.set_visible(page.is_patient_list_open);
  ShowRehearsal(page.is_rehearsal_open);
  opening_.Show(page.opening, page.opening_share);
  if (page.is_home_open) home_.Show(page.home);
  home_.set_visible(page.is_home_open);
  panel_.set_visible(page.is_panel_open && !page.is_rehearsal_open);
  asked_.set_text(page.question);
  question_.set_visible(!page.question.empty());
  mode_.set_text(page.mode);
  mode_.set_visible(!page.is_rehearsal_open);  // it speaks of hands
  gui::SetTextOrHide(progress_, page.progress);
  gui::SetTextOrHide(tutorial_, page.tutorial.empty() ? page.next_step : page.tutorial);
  tutorial_task_.set_visible(page.is_tutorial_done);
  chooser_.set_visible(page.is_task_list_open);
  recordings_.set_visible(page.is_recording_list_open);
  result_card_.set_visible(page.is_result_open);
  gui::SetTextOrHide(hint_, page.is_rehearsal_open ? "" : page.hint);
  gui::SetTextOrHide(badge_, page.badge);
  gui::SetTextOrHide(event_, page.event);
  gui::SetTextOrHide(state_, page.state);
  gui::SetTextOrHide(haptics_, page.haptics);
  gui::SetClass(event_, "warning", page.is_event_warning);
  if (!page.failure) return;
  failure_card_.Show(*page.failure);
  panel_.set_sensitive(false);
}

/// The way from images to an operation lies over the picture, and has the keyboard to itself.
void SimulatorWindow::ShowRehearsal(bool is_open) {
  if (rehearsal_ == nullptr && !is_open) return;
  if (rehearsal_ == nullptr) {
    rehearsal_ = std::make_unique<rehearsal::RehearsalView>(host::FindUserDataFolder() / "rehearsal",
                                                            presenter::FindPatientsFolder());
    rehearsal_->set_visible(false);
    overlay_.add_overlay(*rehearsal_);
    rehearsal_->SignalClosed().connect([this] { presenter_->CloseRehearsal(); });
    rehearsal_->SignalOperate().connect(
        [this](const std::filesystem::path& patient) { presenter_->OperateOn(patient); });
    hands_->SignalKey([this](guint key, Gdk::ModifierType state, bool is_down) {
      if (is_down) return rehearsal_->OnKey(key, state);
      rehearsal_->OnKeyReleased(key);
      return false;
    });
  }
  hands_->SetResting(is_open);
  if (rehearsal_->get_visible() == is_open) return;
  rehearsal_->set_visible(is_open);
  is_open ? rehearsal_->Open() : rehearsal_->Leave();
}

/// Whoever has only a keyboard gets into a card that opens.
void SimulatorWindow::FocusCard(const presenter::SimulatorPage& page) {
  Gtk::Widget* card = page.is_home_open           ? static_cast<Gtk::Widget*>(&home_)
                      : page.is_task_list_open    ? static_cast<Gtk::Widget*>(&chooser_)
                      : page.is_patient_list_open ? static_cast<Gtk::Widget*>(&patients_)
                      : page.is_key_list_open     ? static_cast<Gtk::Widget*>(&keys_)
                      : page.is_help_open         ? static_cast<Gtk::Widget*>(&help_)
                                                  : nullptr;
  if (card == focused_card_) return;
  focused_card_ = card;
  if (card == nullptr) {
    if (!page.is_rehearsal_open) picture_.grab_focus();
    return;
  }
  // once it is there to be focused
  Glib::signal_timeout().connect_once(
      [this, card] {
        if (card != focused_card_ || !card->get_visible()) return;
        if (card == &home_) {
          home_.FocusFirst();
        } else if (card == &help_) {
          help_scroller_->grab_focus();  // so that it scrolls with the keyboard, too
        } else {
          card->child_focus(Gtk::DirectionType::TAB_FORWARD);
        }
      },
      0);
}

void SimulatorWindow::UseControl(presenter::SessionControl* control) {
  device_page_.reset();
  picture_.SetSnapshot(nullptr);
  if (sound_ != nullptr) sound_->Rest();
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

void SimulatorWindow::RequestBest() {
  if (!services_.load_best) return;
  // what is being read may be of somebody else
  if (loading_best_.IsRunning()) {
    wants_best_again_ = true;
  } else {
    loading_best_.Start(services_.load_best());
  }
}

void SimulatorWindow::ShowHelp() {
  const presenter::KeyBindings& bindings = presenter_->Bindings();
  std::pair<presenter::KeyLayout, presenter::KeyBindings::Own> now{bindings.Layout(), bindings.GetOwn()};
  if (shown_help_ == now) return;
  shown_help_ = std::move(now);
  while (Gtk::Widget* child = help_.get_first_child()) help_.remove(*child);
  help_.append(*Gtk::make_managed<gui::HelpCard>(bindings.Help()));
}

KeyCardServices SimulatorWindow::MakeKeyCardServices() {
  KeyCardServices services;
  services.ask_key = [this](std::function<void(std::uint32_t)> told) { hands_->AskKey(std::move(told)); };
  services.change_key = [this](const std::string& id, std::uint32_t key) {
    return presenter_->ChangeKey(id, key);
  };
  services.change_button = [this](presenter::ButtonAct act, presenter::MouseButton button) {
    presenter_->ChangeButton(act, button);
  };
  services.restore = [this] { presenter_->RestoreKeys(); };
  services.undo = [this] { presenter_->UndoKeys(); };
  return services;
}

std::vector<std::string> SimulatorWindow::UseKeys(const std::map<std::string, device::HandAct>& keys) {
  return hands_->SetKeys(keys);
}

void SimulatorWindow::DoInWindow(presenter::Action action) {
  if (ChangeSound(action)) return;
  switch (action) {
    case presenter::Action::kToggleFullscreen:
      is_fullscreen() ? unfullscreen() : fullscreen();
      break;
    case presenter::Action::kReleasePointer:
      if (is_fullscreen()) unfullscreen();
      break;
    case presenter::Action::kSwitchPane:
      SwitchPane();
      break;
    case presenter::Action::kOpenDevices:
      OpenDevices();
      break;
    case presenter::Action::kOpenCentre:
      if (services_.open_centre) services_.open_centre();
      break;
    case presenter::Action::kSavePicture:
      // outside of the frame, which holds the GLArea
      Glib::signal_timeout().connect_once([this] { SavePicture(); }, 0);
      break;
    case presenter::Action::kSaveClip:
      SaveClip();
      break;
    case presenter::Action::kQuit:
      // never within a frame, which holds the GLArea
      Glib::signal_timeout().connect_once([this] { close(); }, 0);
      break;
    default:
      break;
  }
}

base::Result<presenter::Somebody> SimulatorWindow::BeSomebody(const std::optional<std::string>& text) {
  return services_.be_somebody ? services_.be_somebody(text) : presenter::Somebody{};
}

void SimulatorWindow::StartStep(const centre::StepName& step) {
  if (services_.start_step) services_.start_step(step);
}

void SimulatorWindow::OpenLastResult(const centre::NextAndLast::Result& result) {
  if (services_.open_result) services_.open_result(result);
}

void SimulatorWindow::OpenReplay(const std::filesystem::path& recording) {
  presenter::Options options = presenter_->GetOptions();
  options.replay = recording;
  options.replay_beside.clear();
  replay_ = std::make_unique<ReplayWindow>(options, [this](presenter::Branch branch) {
    // who takes over sees what is operated on, not the replay on top of it
    replay_->close();
    presenter_->TakeOver(std::move(branch));
    present();
    picture_.grab_focus();
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

std::vector<LayoutCheck::Page> SimulatorWindow::LayoutPages() {
  using presenter::Action;
  std::vector<LayoutCheck::Page> pages;
  const auto add = [&](const char* name, std::function<void()> open, std::function<bool()> is_there = {}) {
    pages.push_back({name, std::move(open), [this] { return this; }, std::move(is_there)});
  };
  const auto has_scene = [this] {
    return presenter_->Control() != nullptr && !presenter_->Page().is_home_open;
  };
  add("home", [this] { presenter_->OpenHome(); });
  add("tasks", [this] { presenter_->OpenTaskList(); });
  add("patients", [this] { presenter_->OpenPatientList(); });
  add("recordings", [this] { presenter_->OpenRecordingList(); });
  add("keys", [this] { presenter_->OpenKeyList(); });
  add("help", [this] {
    presenter_->CloseKeyList();
    presenter_->Do(Action::kToggleHelp);
  });
  add("rehearsal", [this] {
    presenter_->Do(Action::kToggleHelp);
    presenter_->OpenRehearsal();
  });
  add(
      "tutorial",
      [this] {
        presenter_->CloseRehearsal();
        presenter_->Choose(presenter::HomeChoice::kTutorial);
      },
      has_scene);
  add(
      "task",
      [this] {
        presenter_->StartTutorialTask();
        if (!presenter_->Page().is_panel_open) presenter_->Do(Action::kTogglePanel);
      },
      has_scene);
  add(
      "question",
      [this] {
        if (presenter_->Control()->IsPaused()) presenter_->Do(Action::kTogglePause);
      },
      [this] {
        // an attempt that is worth a question
        if (presenter_->Page().question.empty() && presenter_->Control()->Now().time > kWorthAQuestion)
          presenter_->Do(Action::kToggleTutorial);
        return !presenter_->Page().question.empty();
      });
  add("devices", [this] {
    presenter_->Answer(false);
    OpenDevices();
  });
  pages.back().window = [this]() -> Gtk::Window* { return device_page_.get(); };
  return pages;
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

void SimulatorWindow::SavePicture() {
  const auto file = MakePictureName(".png");
  const base::Status saved = file.ok() ? gui::SaveWidgetPicture(picture_, *file) : base::Status(file.error());
  presenter_->Tell(
      saved.ok() ? host::TranslateWith("Saved {1}", {file->string()}) : host::ShownText(saved.error()),
      !saved.ok());
}

void SimulatorWindow::SaveClip() {
  const auto recording = presenter_->Control()->Recording();
  if (!recording || recording->failure)
    return presenter_->Tell(host::Translate("This attempt is not recorded, so that there is no clip of it."),
                            true);
  const auto file = MakePictureName(".webm");
  if (!file.ok()) return presenter_->Tell(host::ShownText(file.error()), true);
  presenter::FilmRequest request;
  request.recording = recording->path;
  request.video = *file;
  request.last_seconds = presenter::kClipSeconds;
  film_bar_.Start(std::move(request));
}

/// A run without a person is silent.
void SimulatorWindow::MakeSound(const presenter::Options& options) {
  panel_.Add(sound_card_);
  if (!options.run.IsAttended()) return;
  const std::filesystem::path folder =
      options.settings.empty() ? host::FindConfigFolder() : options.settings.parent_path();
  sound_ = std::make_unique<presenter::WindowSound>(folder / "sound.json");
  sound_card_.Show(sound_->Settings(), sound_->Describe());
  sound_card_.SignalChanged().connect([this](const sound::SoundSettings& settings) {
    sound_->Set(settings);
    sound_card_.Show(sound_->Settings(), sound_->Describe());
  });
}

void SimulatorWindow::HearFrame(const simulation::Snapshot& snapshot) {
  if (sound_ == nullptr) return;
  presenter::SessionControl& control = *presenter_->Control();
  sound_->Hear(control.GetScene(), snapshot, control.LastInput(), !control.IsPaused());
  // what an instructor would say: what to do, or that something went wrong
  const presenter::SimulatorPage& page = presenter_->Page();
  sound_->Say(!page.tutorial.empty() ? page.tutorial : page.is_event_warning ? page.event : std::string());
}

/// \return whether the action is one of the sound's
bool SimulatorWindow::ChangeSound(presenter::Action action) {
  if (sound_ == nullptr) return false;
  switch (action) {
    case presenter::Action::kToggleSound:
      sound_->ToggleMute();
      break;
    case presenter::Action::kToggleSpeech:
      sound_->ToggleSpeech();
      break;
    case presenter::Action::kLouder:
      sound_->ChangeVolume(1);
      break;
    case presenter::Action::kQuieter:
      sound_->ChangeVolume(-1);
      break;
    default:
      return false;
  }
  sound_card_.Show(sound_->Settings(), sound_->Describe());
  presenter_->Tell(sound_->Describe());
  return true;
}

void SimulatorWindow::ChooseAndSaveResult() {
  gui::FileRequest request;
  request.title = host::Translate("Save the result");
  request.new_name = "result.html";
  request.kinds = {{host::Translate("Page (HTML)"), "*.html"}, {host::Translate("Data (JSON)"), "*.json"}};
  file_dialog_.Ask(*this, request,
                   [this](const std::filesystem::path& file) { presenter_->SaveResult(file); });
}

}  // namespace trocar::app
