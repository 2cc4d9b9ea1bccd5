// SPDX-License-Identifier: Apache-2.0
#include "replay_window.h"

#include <limits>
#include <string>
#include <utility>

#include "picture_folder.h"
#include "trocar/gui/card.h"
#include "trocar/gui/labels.h"
#include "trocar/gui/over_card.h"
#include "trocar/gui/window_screenshot.h"
#include "trocar/host/translate.h"

namespace trocar::app {
namespace {

constexpr int kListWidth = 250;  // [pixels]

const char* StyleOf(presenter::ReplayMark::Kind kind) {
  switch (kind) {
    case presenter::ReplayMark::Kind::kError:
      return "error";
    case presenter::ReplayMark::Kind::kPhase:
      return "phase";
    default:
      return "remark";
  }
}

}  // namespace

ReplayWindow::ReplayWindow(const presenter::Options& options,
                           std::function<void(presenter::Branch)> take_over)
    : bar_(presenter::ReplayCommands(), tips_,
           [this](const presenter::ReplayCommand& command) { presenter_->Do(command.action); }),
      take_over_(std::move(take_over)),
      recording_(options.replay) {
  set_title(host::Translate("Trocar: replay"));
  add_css_class("trocar");
  gui::FitToScreen(*this, options.width, options.height);
  set_titlebar(bar_);
  MakeContent();
  presenter_ = std::make_unique<presenter::ReplayPresenter>(
      options, static_cast<presenter::ReplayScreen&>(*this), [this] { loaded_.emit(); });
  MakeRoutes();
  presenter_->Start();
}

ReplayWindow::~ReplayWindow() {
  presenter_.reset();
}

void ReplayWindow::MakeSide(std::size_t side) {
  Side& now = sides_[side];
  now.overlay.set_child(now.picture);
  now.overlay.set_hexpand(true);
  now.overlay.set_vexpand(true);
  now.about.add_css_class("badge");
  now.about.set_halign(Gtk::Align::START);
  now.about.set_valign(Gtk::Align::START);
  now.about.set_wrap(true);
  now.about.set_can_target(false);
  now.overlay.add_overlay(now.about);
  for (const unsigned button : {1u, 3u}) {
    auto drag = Gtk::GestureDrag::create();
    drag->set_button(button);
    drag->signal_drag_begin().connect([&now](double, double) { now.last_x = now.last_y = 0; });
    drag->signal_drag_update().connect([this, &now, button](double x, double y) {
      const double dx = x - now.last_x, dy = y - now.last_y;
      now.last_x = x, now.last_y = y;
      const int height = now.picture.get_height();
      button == 1 ? presenter_->Turn(dx, dy, height) : presenter_->Pan(dx, dy, height);
    });
    now.picture.add_controller(drag);
  }
  auto wheel = Gtk::EventControllerScroll::create();
  wheel->set_flags(Gtk::EventControllerScroll::Flags::VERTICAL);
  wheel->signal_scroll().connect(
      [this](double, double dy) {
        presenter_->Zoom(-dy);
        return true;
      },
      false);
  now.picture.add_controller(wheel);
}

void ReplayWindow::MakeContent() {
  auto* pictures = Gtk::make_managed<Gtk::Box>();
  pictures->set_spacing(3);
  pictures->set_homogeneous(true);
  for (std::size_t side = 0; side < sides_.size(); ++side) {
    MakeSide(side);
    pictures->append(sides_[side].overlay);
  }
  sides_[presenter::ReplayPresenter::kBeside].overlay.set_visible(false);
  overlay_.set_child(*pictures);
  help_card_.set_visible(false);
  chooser_.set_visible(false);
  overlay_.add_overlay(failure_card_);
  for (Gtk::Widget* card : {static_cast<Gtk::Widget*>(&help_card_), static_cast<Gtk::Widget*>(&chooser_)})
    gui::AddOverCard(overlay_, *card);

  mark_list_.set_selection_mode(Gtk::SelectionMode::NONE);
  auto* scroller = Gtk::make_managed<Gtk::ScrolledWindow>();
  scroller->set_policy(Gtk::PolicyType::NEVER, Gtk::PolicyType::AUTOMATIC);
  scroller->set_vexpand(true);
  scroller->set_child(mark_list_);
  auto* panel = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  panel->add_css_class("panel");
  panel->set_size_request(kListWidth, -1);
  panel->set_hexpand(false);  // though its rows do
  auto* title = gui::MakeLabel(host::Translate("Errors, phases and remarks"), "card-title");
  title->set_margin(8);
  panel->append(*title);
  panel->append(*scroller);

  auto* middle = Gtk::make_managed<Gtk::Box>();
  overlay_.set_hexpand(true);
  overlay_.set_vexpand(true);
  middle->append(overlay_);
  middle->append(*panel);

  clock_.add_css_class("value");
  clock_.set_margin_start(12);
  clock_.set_margin_end(8);
  auto* line = Gtk::make_managed<Gtk::Box>();
  line->append(clock_);
  line->append(time_bar_);

  message_.set_halign(Gtk::Align::START);
  message_.set_hexpand(true);
  message_.set_wrap(true);
  state_.add_css_class("numbers");
  auto* status = Gtk::make_managed<Gtk::Box>();
  status->add_css_class("status");
  status->append(message_);
  status->append(state_);

  auto* all = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  all->append(*middle);
  all->append(*line);
  all->append(film_bar_);
  all->append(*status);
  set_child(*all);
}

void ReplayWindow::MakeRoutes() {
  auto keys = Gtk::EventControllerKey::create();
  keys->set_propagation_phase(Gtk::PropagationPhase::CAPTURE);
  keys->signal_key_pressed().connect(sigc::mem_fun(*this, &ReplayWindow::OnKey), false);
  add_controller(keys);
  property_is_active().signal_changed().connect([this] { tips_.End(); });
  loaded_.connect([this] { presenter_->FinishLoading(); });
  time_bar_.SignalMoved().connect([this](double time) { presenter_->GoTo(time); });
  mark_list_.signal_row_activated().connect([this](Gtk::ListBoxRow* row) {
    const auto index = static_cast<std::size_t>(row->get_index());
    if (index < marks_.size()) presenter_->GoToMark(marks_[index]);
  });
  chooser_.SignalChosen().connect(
      [this](const std::filesystem::path& path) { presenter_->OpenBeside(path); });
  chooser_.SignalClosed().connect([this] { presenter_->Do(presenter::ReplayAction::kCloseCards); });
  sides_[presenter::ReplayPresenter::kOwn].picture.add_tick_callback(
      sigc::mem_fun(*this, &ReplayWindow::OnFrame));
  for (Side& side : sides_) {
    side.picture.SignalFailed().connect([this](const base::Error& error) { failure_card_.Show(error); });
  }
}

bool ReplayWindow::OnKey(guint keyval, guint, Gdk::ModifierType state) {
  using Gdk::ModifierType;
  if ((state & (ModifierType::ALT_MASK | ModifierType::SUPER_MASK)) != ModifierType{}) return false;
  const bool control = (state & ModifierType::CONTROL_MASK) != ModifierType{};
  // '+' needs Shift on some keyboards, and on others none
  const presenter::ReplayCommand* command = FindCommand(presenter::ReplayCommands(), keyval, control, false);
  if (command == nullptr) return false;
  tips_.End();
  presenter_->Do(command->action);
  return true;
}

bool ReplayWindow::OnFrame(const Glib::RefPtr<Gdk::FrameClock>& clock) {
  auto work = presenter_->Advance(1e-6 * static_cast<double>(clock->get_frame_time()));
  for (std::size_t side = 0; side < sides_.size(); ++side) {
    if (work[side].snapshot == nullptr) continue;
    sides_[side].picture.SetSnapshot(work[side].snapshot);
    sides_[side].picture.SetOverlay(std::move(work[side].overlay));
    sides_[side].picture.queue_render();
  }
  return true;
}

void ReplayWindow::Show(const presenter::ReplayPage& page) {
  if (get_title().raw() != page.title) {
    set_title(page.title);
    bar_.SetHeading(page.title);
  }
  bar_.Show([this](const presenter::ReplayCommand& command) { return presenter_->FindButton(command); });
  for (std::size_t side = 0; side < sides_.size(); ++side) {
    if (sides_[side].picture.GetOptions() != page.view) sides_[side].picture.SetOptions(page.view);
    gui::SetTextOrHide(sides_[side].about, page.about[side]);
  }
  help_card_.set_visible(page.is_help_open);
  chooser_.set_visible(page.is_list_open);
  gui::SetText(clock_, page.clock);
  gui::SetText(state_, page.state);
  gui::SetTextOrHide(message_, page.message);
  gui::SetClass(message_, "warning", page.is_warning);
  time_bar_.Show(page);
  if (page.failure) failure_card_.Show(*page.failure);
}

void ReplayWindow::UseReplay(std::size_t side, const session::ReplayRunner* replay) {
  Side& now = sides_[side];
  now.picture.SetSnapshot(nullptr);
  if (replay != nullptr) {
    now.picture.SetScene(&replay->GetScene(), replay->Surfaces(), replay->Strands());
  } else {
    now.picture.SetScene(nullptr, {}, {});
  }
  if (side == presenter::ReplayPresenter::kBeside) now.overlay.set_visible(replay != nullptr);
}

void ReplayWindow::ShowMarks(const std::vector<presenter::ReplayMark>& marks) {
  time_bar_.SetMarks(marks);
  while (Gtk::Widget* row = mark_list_.get_first_child()) mark_list_.remove(*row);
  marks_.clear();
  for (const presenter::ReplayMark& mark : marks) {
    if (mark.kind == presenter::ReplayMark::Kind::kEvent) continue;
    auto* time = Gtk::make_managed<Gtk::Label>(presenter::FormatClock(mark.time));
    time->add_css_class("value");
    auto* text = gui::MakeLabel(mark.text, StyleOf(mark.kind));
    text->set_tooltip_text(mark.text);
    mark_list_.append(gui::MakeRow(8, {time, text}));
    marks_.push_back(mark);
  }
}

void ReplayWindow::TakeOver(presenter::Branch branch) {
  // outside of the frame, which holds the GLArea: a window opens
  auto shared = std::make_shared<presenter::Branch>(std::move(branch));
  Glib::signal_timeout().connect_once([this, shared] { take_over_(std::move(*shared)); }, 0);
}

void ReplayWindow::DoInWindow(presenter::ReplayAction action) {
  switch (action) {
    case presenter::ReplayAction::kToggleFullscreen:
      is_fullscreen() ? unfullscreen() : fullscreen();
      break;
    case presenter::ReplayAction::kSavePicture:
      // outside of the frame, which holds the GLArea
      Glib::signal_timeout().connect_once([this] { SavePicture(); }, 0);
      break;
    case presenter::ReplayAction::kSaveClip:
      if (const auto file = MakePictureName(".webm"); file.ok()) {
        StartFilm(presenter_->Time(), presenter::kClipSeconds, *file);
      } else {
        presenter_->Tell(host::ShownText(file.error()), true);
      }
      break;
    case presenter::ReplayAction::kSaveVideo:
      file_dialog_.Ask(*this,
                       {host::Translate("Save the video"),
                        "",
                        recording_.stem().string() + ".webm",
                        {{host::Translate("Video (WebM)"), "*.webm"}}},
                       [this](const std::filesystem::path& file) {
                         StartFilm(std::numeric_limits<double>::infinity(), 0, file);
                       });
      break;
    case presenter::ReplayAction::kClose:
      // never within a frame, which holds the GLArea
      Glib::signal_timeout().connect_once([this] { close(); }, 0);
      break;
    default:
      break;
  }
}

void ReplayWindow::SavePicture() {
  const auto file = MakePictureName(".png");
  const base::Status saved =
      file.ok() ? gui::SaveWidgetPicture(sides_[presenter::ReplayPresenter::kOwn].picture, *file)
                : base::Status(file.error());
  presenter_->Tell(
      saved.ok() ? host::TranslateWith("Saved {1}", {file->string()}) : host::ShownText(saved.error()),
      !saved.ok());
}

void ReplayWindow::StartFilm(double until, double last_seconds, const std::filesystem::path& video) {
  presenter::FilmRequest request;
  request.recording = recording_;
  request.video = video;
  request.until = until;
  request.last_seconds = last_seconds;
  film_bar_.Start(std::move(request));
}

}  // namespace trocar::app
