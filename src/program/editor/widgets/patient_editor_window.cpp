// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/patient_editor_window.h"

#include <utility>

#include "trocar/editor/patient_editor_run.h"
#include "trocar/gui/labels.h"
#include "trocar/host/translate.h"

namespace trocar::editor {
namespace {

constexpr int kWidth = 1280, kHeight = 800;

bool Has(Gdk::ModifierType state, Gdk::ModifierType wanted) {
  return (state & wanted) != Gdk::ModifierType{};
}

}  // namespace

PatientEditorWindow::PatientEditorWindow(const PatientEditorOptions& options)
    : bar_(PatientCommands(), tips_,
           [this](const PatientCommand& command) { presenter_->Do(command.action); }) {
  set_title(host::Translate("Trocar: patient"));
  add_css_class("trocar");
  set_default_size(kWidth, kHeight);
  set_titlebar(bar_);
  MakeContent();
  tips_.Adopt(view_);
  tips_.Adopt(panel_);
  presenter_ = std::make_unique<PatientEditorPresenter>(
      options, static_cast<PatientScreen&>(*this),
      PatientWakes{[this] { loaded_.emit(); }, [this] { checked_.emit(); }});
  if (!options.run.IsAttended())
    run_ = std::make_unique<PatientEditorRun>(PatientEditorRun::Parts{*this, *presenter_, view_});
  MakeRoutes();
  ConnectView();
  // a question needs the window to stand on
  Glib::signal_timeout().connect_once(sigc::mem_fun(*this, &PatientEditorWindow::Begin), 0);
}

void PatientEditorWindow::Begin() {
  presenter_->Start();
}

PatientEditorWindow::~PatientEditorWindow() {
  for (sigc::connection& timer : timers_) timer.disconnect();
  run_.reset();
  panel_.SetEditor(nullptr);
}

void PatientEditorWindow::MakeContent() {
  auto* overlay = Gtk::make_managed<Gtk::Overlay>();
  overlay->set_child(view_);
  hint_.add_css_class("hint");
  hint_.set_halign(Gtk::Align::CENTER);
  hint_.set_valign(Gtk::Align::END);
  hint_.set_can_target(false);
  hint_.set_ellipsize(Pango::EllipsizeMode::END);
  overlay->add_overlay(hint_);
  overlay->set_hexpand(true);
  auto* scrolled = Gtk::make_managed<Gtk::ScrolledWindow>();
  scrolled->set_policy(Gtk::PolicyType::NEVER, Gtk::PolicyType::AUTOMATIC);
  scrolled->set_child(panel_);
  scrolled->set_hexpand(false);
  auto* middle = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::HORIZONTAL);
  middle->append(*overlay);
  middle->append(*scrolled);
  middle->set_vexpand(true);
  auto* bar = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::HORIZONTAL);
  bar->add_css_class("status");
  status_.set_xalign(0);
  status_.set_hexpand(true);
  status_.set_ellipsize(Pango::EllipsizeMode::END);
  bar->append(status_);
  auto* all = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  all->append(*middle);
  all->append(*bar);
  set_child(*all);
}

void PatientEditorWindow::MakeRoutes() {
  const auto keys = Gtk::EventControllerKey::create();
  keys->set_propagation_phase(Gtk::PropagationPhase::CAPTURE);
  keys->signal_key_pressed().connect(
      [this](guint key, guint, Gdk::ModifierType state) { return OnKey(key, state); }, false);
  add_controller(keys);
  panel_.SignalEdited().connect([this] { presenter_->OnEdited(); });
  panel_.SignalRefused().connect([this](const base::Error& error) { presenter_->Refuse(error); });
  panel_.SignalLookAt().connect([this](const std::string& where) { presenter_->LookAt(where); });
  view_.SignalFailed().connect([this](const base::Error& error) { presenter_->Fail(error); });
  loaded_.connect([this] { presenter_->FinishLoading(); });
  checked_.connect([this] { presenter_->FinishCheck(); });
  property_is_active().signal_changed().connect([this] { tips_.End(); });
  signal_close_request().connect([this] { return presenter_->OnClose(); }, false);
}

void PatientEditorWindow::ConnectView() {
  view_.on_press = [this](const MeshPick& pick) {
    tips_.End();
    return presenter_->Press(pick.surface, pick.point, Has(pick.keys, Gdk::ModifierType::SHIFT_MASK));
  };
  view_.on_drag = [this](const MeshPick& pick) {
    if (presenter_->Editor() == nullptr) return;
    presenter_->Drag(pick.surface, view_.PointAtDepth(presenter_->Editor()->Grabbed(), pick.x, pick.y));
  };
  view_.on_release = [this](const MeshPick&) { presenter_->Release(); };
  view_.on_hover = [this](const MeshPick& pick) { presenter_->Hover(pick.surface); };
  view_.on_leave = [this] { presenter_->Leave(); };
  view_.on_wheel = [this](const MeshPick& pick, double steps) {
    return presenter_->Wheel(pick.point, Has(pick.keys, Gdk::ModifierType::CONTROL_MASK), steps);
  };
}

bool PatientEditorWindow::OnKey(guint key, Gdk::ModifierType state) {
  const PatientAction action = FindPatientAction(key, Has(state, Gdk::ModifierType::CONTROL_MASK),
                                                 Has(state, Gdk::ModifierType::SHIFT_MASK));
  if (action == PatientAction::kNone || !presenter_->IsEnabled(action)) return false;
  tips_.End();
  presenter_->Do(action);
  return true;
}

void PatientEditorWindow::Show(const PatientPage& page) {
  if (get_title().raw() != page.title) set_title(page.title);
  bar_.Show([this](const PatientCommand& command) { return presenter_->FindButton(command); });
  gui::SetTextOrHide(hint_, page.hint);
  gui::SetText(status_, page.status);
  gui::SetClass(status_, "warning", page.is_status_warning);
  panel_.Refresh();
}

void PatientEditorWindow::ShowFigure(view::PatientFigure figure) {
  view_.SetSurfaces(std::move(figure.surfaces));
  view_.SetMarks(std::move(figure.marks));
}

void PatientEditorWindow::Ask(gui::Question question) {
  auto* dialog = new Gtk::MessageDialog(*this, question.text, false, Gtk::MessageType::QUESTION,
                                        Gtk::ButtonsType::NONE, true);
  dialog->set_secondary_text(question.detail);
  dialog->add_css_class("trocar");
  for (std::size_t i = 0; i < question.answers.size(); ++i)
    dialog->add_button(question.answers[i].label, static_cast<int>(i));
  dialog->signal_response().connect([dialog, answers = std::move(question.answers)](int response) {
    dialog->hide();
    // closed without an answer: the first one
    answers[response < 0 ? 0 : static_cast<std::size_t>(response)].act();
    // not within its own signal
    Glib::signal_timeout().connect_once([dialog] { delete dialog; }, 0);
  });
  dialog->show();
}

void PatientEditorWindow::ChooseFolder(const std::string& name,
                                       std::function<void(std::filesystem::path)> act) {
  gui::FileRequest request;
  request.title = host::Translate("Save the patient's folder");
  request.new_name = name;
  file_dialog_.Ask(*this, request, std::move(act));
}

void PatientEditorWindow::StartTimer(PatientTimer timer, unsigned milliseconds) {
  sigc::connection& connection = timers_[static_cast<std::size_t>(timer)];
  connection.disconnect();
  connection =
      Glib::signal_timeout().connect([this, timer] { return presenter_->OnTimer(timer); }, milliseconds);
}

void PatientEditorWindow::Close() {
  // never within a frame
  Glib::signal_timeout().connect_once([this] { close(); }, 0);
}

}  // namespace trocar::editor
