// SPDX-License-Identifier: Apache-2.0
#include "trocar/centre/centre_window.h"

#include <utility>

#include "course_view.h"
#include "exam_view.h"
#include "group_view.h"
#include "history_view.h"
#include "result_view.h"
#include "trocar/gui/card.h"
#include "trocar/gui/labels.h"
#include "trocar/gui/over_card.h"
#include "trocar/host/translate.h"
#include "view_parts.h"

namespace trocar::centre {
namespace {

constexpr int kWidth = 1280, kHeight = 800, kWhoWidth = 420, kBarWidth = 180;  // [pixels]

}  // namespace

CentreWindow::CentreWindow(const Access& access, int threads, AttemptFiling* filing, CentreServices services)
    : services_(std::move(services)),
      bar_(CentreCommands(), tips_, [this](const CentreCommand& command) { presenter_->Do(command.action); }),
      result_(std::make_unique<ResultView>()),
      history_(std::make_unique<HistoryView>()),
      courses_(std::make_unique<CourseView>()),
      group_(std::make_unique<GroupView>()),
      exam_(std::make_unique<ExamView>()) {
  set_title(host::Translate("Trocar: training centre"));
  add_css_class("trocar");
  gui::FitToScreen(*this, kWidth, kHeight);
  set_titlebar(bar_);
  MakeContent();
  MakeWho();
  presenter_ = std::make_unique<CentrePresenter>(access, threads, static_cast<CentreScreen&>(*this), filing,
                                                 [this] { news_.emit(); });
  presenter_->SetDrawMoment(services_.draw_moment);
  result_->Use(*presenter_);
  history_->Use(*presenter_);
  courses_->Use(*presenter_);
  group_->Use(*presenter_);
  exam_->Use(*presenter_);
  MakeRoutes();
}

CentreWindow::~CentreWindow() {
  presenter_.reset();
}

void CentreWindow::MakeContent() {
  stack_.add(*result_, "result");
  stack_.add(*history_, "history");
  stack_.add(*courses_, "courses");
  stack_.add(*group_, "group");
  stack_.add(*exam_, "exam");
  stack_.set_vexpand(true);
  overlay_.set_child(stack_);
  help_card_.set_visible(false);
  gui::AddOverCard(overlay_, help_card_);
  who_card_.set_visible(false);
  gui::AddOverCard(overlay_, who_card_);

  notice_.add_css_class("waiting");
  notice_.set_xalign(0);
  notice_.set_wrap(true);
  notice_.set_visible(false);
  busy_.set_halign(Gtk::Align::START);
  busy_.set_hexpand(true);
  busy_.set_wrap(true);
  busy_.set_xalign(0);
  progress_.set_size_request(kBarWidth, -1);
  progress_.set_valign(Gtk::Align::CENTER);
  auto* status = Gtk::make_managed<Gtk::Box>();
  status->add_css_class("status");
  status->set_spacing(10);
  status->append(spinner_);
  status->append(busy_);
  status->append(progress_);
  cancel_.set_label(host::Translate("Cancel"));
  cancel_.set_valign(Gtk::Align::CENTER);
  cancel_.set_visible(false);
  cancel_.signal_clicked().connect([this] { presenter_->CancelStep(); });
  status->append(cancel_);

  auto* all = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  all->append(bars_);
  all->append(notice_);
  all->append(overlay_);
  all->append(*status);
  set_child(*all);
}

void CentreWindow::MakeWho() {
  who_card_.add_css_class("help");
  who_card_.set_halign(Gtk::Align::CENTER);
  who_card_.set_valign(Gtk::Align::CENTER);
  who_card_.set_spacing(8);
  who_card_.set_visible(false);
  who_card_.set_size_request(kWhoWidth, -1);
  who_card_.append(MakeLine(host::Translate("Who are you?"), "page-title"));
  who_card_.append(
      MakeText(host::Translate("A name or a pseudonym, or nothing. Attempts from now on are kept under a "
                               "pseudonym; your name stays in a protected file on this computer."),
               "value"));
  who_.set_placeholder_text(host::Translate("nobody in particular"));
  const auto be = [this] { presenter_->BeSomebody(who_.get_text().raw()); };
  who_.signal_activate().connect(be);
  who_card_.append(who_);
  Gtk::Box& row = gui::MakeRow(8, {});
  row.append(MakeButton(host::Translate("That is me"), be, "primary"));
  row.append(MakeButton(host::Translate("Cancel"), [this] { presenter_->Do(CentreAction::kCloseCards); }));
  who_card_.append(row);
}

void CentreWindow::MakeRoutes() {
  auto keys = Gtk::EventControllerKey::create();
  keys->set_propagation_phase(Gtk::PropagationPhase::CAPTURE);
  keys->signal_key_pressed().connect(sigc::mem_fun(*this, &CentreWindow::OnKey), false);
  add_controller(keys);
  property_is_active().signal_changed().connect([this] { tips_.End(); });
  news_.connect([this] { presenter_->Finish(); });
  signal_close_request().connect(
      [this] {
        is_open_ = false;
        return false;
      },
      false);
}

bool CentreWindow::OnKey(guint keyval, guint, Gdk::ModifierType state) {
  using Gdk::ModifierType;
  if ((state & (ModifierType::ALT_MASK | ModifierType::SUPER_MASK)) != ModifierType{}) return false;
  const bool control = (state & ModifierType::CONTROL_MASK) != ModifierType{};
  const bool shift = (state & ModifierType::SHIFT_MASK) != ModifierType{};
  const CentreCommand* command = FindCommand(CentreCommands(), keyval, control, shift);
  if (command == nullptr) return false;
  tips_.End();
  presenter_->Do(command->action);
  return true;
}

void CentreWindow::Show(const CentrePage& page) {
  if (presenter_ == nullptr) return;
  bar_.Show([this](const CentreCommand& command) { return presenter_->FindButton(command); });
  help_card_.set_visible(page.is_help_open);
  const bool opens_who = page.is_who_open && !who_card_.get_visible();
  who_card_.set_visible(page.is_who_open);
  if (opens_who) who_.grab_focus();
  gui::SetTextOrHide(notice_, page.notice);
  const bool is_busy = !page.busy.empty() || (page.kind == PageKind::kResult && !page.result);
  spinner_.set_spinning(is_busy);
  spinner_.set_visible(is_busy);
  gui::SetText(busy_, !page.busy.empty() ? page.busy + (page.detail.empty() ? " …" : ": " + page.detail)
                      : is_busy          ? host::Translate("Measuring the attempt …")
                                         : page.who);
  progress_.set_visible(is_busy && page.progress >= 0);
  if (page.progress >= 0) progress_.set_fraction(page.progress);
  cancel_.set_visible(page.can_cancel);
  if (page.version == shown_version_) return;
  shown_version_ = page.version;
  switch (page.kind) {
    case PageKind::kResult:
      result_->Show(page);
      return stack_.set_visible_child(*result_);
    case PageKind::kHistory:
      history_->Show(page);
      return stack_.set_visible_child(*history_);
    case PageKind::kCourses:
      courses_->Show(page);
      return stack_.set_visible_child(*courses_);
    case PageKind::kGroup:
      group_->Show(page);
      return stack_.set_visible_child(*group_);
    case PageKind::kExam:
      exam_->Show(page);
      return stack_.set_visible_child(*exam_);
  }
}

void CentreWindow::StartAttempt(const Start& start) {
  if (services_.start) services_.start(start);
}

void CentreWindow::StartTask(const std::string& task, const std::string& level) {
  if (services_.start_task) services_.start_task(task, level);
}

void CentreWindow::OpenReplay(const std::filesystem::path& recording, double time) {
  if (services_.replay) services_.replay(recording, time);
}

void CentreWindow::Close() {
  // never within the handler of a button that goes with the window
  Glib::signal_timeout().connect_once([this] { close(); }, 0);
}

}  // namespace trocar::centre
