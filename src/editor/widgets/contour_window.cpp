// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_window.h"

#include <utility>

#include "trocar/core/translate.h"
#include "trocar/editor/contour_read_outs.h"
#include "trocar/editor/contour_run.h"
#include "trocar/gui/labels.h"

namespace trocar::editor {
namespace {

constexpr int kWidth = 1280, kHeight = 800;

struct ChooserText {
  const char *title, *accept, *name;  // an empty name: the file has to be there
};
constexpr ChooserText kChoosers[] = {{core::Mark("Open contours"), core::Mark("Open"), ""},
                                     {core::Mark("Save contours"), core::Mark("Save"), "control_points.json"},
                                     {core::Mark("Folder for the patient"), core::Mark("Build"), "patient"}};

}  // namespace

ContourWindow::ContourWindow(const ContourOptions& options, const core::Stopwatch& since_start)
    : bar_(ContourCommands(), tips_,
           [this](const ContourCommand& command) { presenter_->Do(command.action); }) {
  set_title(core::Translate("Trocar: contours"));
  add_css_class("trocar");
  set_default_size(kWidth, kHeight);
  set_titlebar(bar_);
  MakeContent();
  tips_.Adopt(panel_);
  tips_.Adopt(slices_);
  presenter_ = std::make_unique<ContourPresenter>(
      options, Glib::get_user_data_dir(), static_cast<ContourScreen&>(*this),
      ContourWakes{[this] { loaded_.emit(); }, [this] { built_.emit(); }, [this] { progressed_.emit(); },
                   [this] { surfaces_changed_.emit(); }});
  if (!options.IsAttended()) {
    run_ = std::make_unique<ContourRun>(
        ContourRun::Parts{*this, *presenter_, canvas_, panel_, bars_, series_bar_}, since_start);
  }
  MakeKeys();
  MakeRoutes();
  presenter_->Start();
}

ContourWindow::~ContourWindow() {
  for (sigc::connection& timer : timers_) timer.disconnect();
  run_.reset();
  UseEditor(nullptr);
}

void ContourWindow::MakeContent() {
  overlay_.set_child(canvas_);
  overlay_.set_hexpand(true);
  overlay_.set_vexpand(true);
  hint_.add_css_class("hint");
  hint_.set_halign(Gtk::Align::CENTER);
  hint_.set_valign(Gtk::Align::END);
  hint_.set_margin_bottom(34);
  hint_.set_can_target(false);
  hint_.set_wrap(true);
  hint_.set_max_width_chars(80);
  help_card_.set_visible(false);
  overlay_.add_overlay(hint_);
  overlay_.add_overlay(help_card_);
  auto* left = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  left->append(overlay_);
  left->append(slices_);
  auto* middle = Gtk::make_managed<Gtk::Box>();
  middle->append(*left);
  middle->append(panel_);
  auto* status = Gtk::make_managed<Gtk::Box>();
  MakeStatus(*status);
  auto* all = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  all->append(bars_);
  all->append(series_bar_);
  all->append(*middle);
  all->append(*status);
  set_child(*all);
}

void ContourWindow::MakeStatus(Gtk::Box& status) {
  status.add_css_class("status");
  status.set_spacing(18);
  series_text_.set_ellipsize(Pango::EllipsizeMode::END);
  series_text_.set_hexpand(true);
  series_text_.set_xalign(0);
  series_text_.add_css_class("fine");
  place_.add_css_class("numbers");
  busy_.set_valign(Gtk::Align::CENTER);
  busy_.set_visible(false);
  stop_build_.set_visible(false);
  stop_build_.add_css_class("small");
  tips_.Set(stop_build_, core::Translate("Give up the patient that is being built; nothing is written"));
  for (Gtk::Widget* widget : {static_cast<Gtk::Widget*>(&series_text_), static_cast<Gtk::Widget*>(&place_),
                              static_cast<Gtk::Widget*>(&busy_), static_cast<Gtk::Widget*>(&stop_build_),
                              static_cast<Gtk::Widget*>(&state_)})
    status.append(*widget);
}

void ContourWindow::MakeKeys() {
  const auto keys = Gtk::EventControllerKey::create();
  keys->set_propagation_phase(Gtk::PropagationPhase::CAPTURE);
  keys->signal_key_pressed().connect(
      [this](guint key, guint, Gdk::ModifierType state) { return OnKey(key, state); }, false);
  keys->signal_key_released().connect([this](guint key, guint, Gdk::ModifierType) {
    if (key == GDK_KEY_space) canvas_.HoldSpace(false);
  });
  add_controller(keys);
}

bool ContourWindow::OnKey(guint key, Gdk::ModifierType state) {
  const auto has = [state](Gdk::ModifierType mask) { return (state & mask) != Gdk::ModifierType{}; };
  if (has(Gdk::ModifierType::ALT_MASK) || has(Gdk::ModifierType::SUPER_MASK)) return false;
  // a text that is being typed keeps its keys
  const bool is_typing = dynamic_cast<Gtk::Text*>(get_focus()) != nullptr;
  if (key == GDK_KEY_space && !is_typing) {
    canvas_.HoldSpace(true);
    return true;
  }
  const ContourAction action =
      FindContourAction(key, has(Gdk::ModifierType::CONTROL_MASK), has(Gdk::ModifierType::SHIFT_MASK));
  if (action == ContourAction::kNone || (is_typing && !WorksEverywhere(action))) return false;
  tips_.End();
  presenter_->Do(action);
  return true;
}

void ContourWindow::MakeRoutes() {
  canvas_.SignalEdited().connect([this] {
    tips_.End();
    presenter_->OnEdited();
  });
  canvas_.SignalPointed().connect([this] {
    if (presenter_->Editor() != nullptr) gui::SetText(place_, PointerText(*presenter_->Editor()));
  });
  canvas_.SignalStep().connect([this](int steps) { presenter_->StepSlice(steps); });
  canvas_.SignalWindow().connect([this] {
    const auto& window = canvas_.Options().window;
    presenter_->ShowHint(core::TranslateWith(
        "Window {1}, level {2}; edges are still sought in the suggested window",
        {std::to_string(static_cast<int>(window.width)), std::to_string(static_cast<int>(window.centre))}));
  });
  canvas_.SignalFailed().connect([this](const core::Error& error) { presenter_->Report(error); });
  slices_.SignalSlice().connect([this](int slice) { presenter_->GoToSlice(slice); });
  panel_.SignalEdited().connect([this] { presenter_->OnEdited(); });
  panel_.SignalAction().connect([this](ContourAction action) { presenter_->Do(action); });
  panel_.SignalCancelJob().connect([this] { presenter_->CancelSurfaces(); });
  panel_.View().SignalFailed().connect([this](const core::Error& error) { presenter_->Report(error); });
  series_bar_.SignalAnswered().connect(
      [this](const images::ImageSeriesOptions& series) { presenter_->OpenWith(series); });
  loaded_.connect([this] { presenter_->FinishLoading(); });
  built_.connect([this] { presenter_->FinishBuild(); });
  progressed_.connect([this] { presenter_->ShowProgress(); });
  surfaces_changed_.connect([this] { presenter_->TakeSurfaces(); });
  stop_build_.signal_clicked().connect([this] { presenter_->StopBuild(); });
  property_is_active().signal_changed().connect([this] { tips_.End(); });
  signal_close_request().connect([this] { return presenter_->OnClose(); }, false);
}

void ContourWindow::Show(const ContourPage& page) {
  if (get_title().raw() != page.title) set_title(page.title);
  bar_.Show([this](const ContourCommand& command) { return presenter_->FindButton(command); });
  help_card_.set_visible(page.is_help_open);
  gui::SetTextOrHide(hint_, page.hint);
  gui::SetClass(hint_, "warning", page.is_hint_warning);
  gui::SetText(series_text_, page.series);
  gui::SetText(state_, page.state);
  busy_.set_visible(page.is_busy);
  busy_.set_fraction(page.fraction);
  stop_build_.set_visible(page.is_building);
  stop_build_.set_sensitive(!page.is_stopping);
  panel_.set_sensitive(page.is_document_open);
  PaintOptions& options = canvas_.Options();
  options.has_points = page.has_points;
  options.has_fill = page.has_fill;
  options.has_ghosts = page.has_ghosts;
  options.has_reference = page.has_reference;
  if (!page.is_document_open) return;
  panel_.Refresh();
  gui::SetText(place_, PointerText(*presenter_->Editor()));
  slices_.queue_draw();
  canvas_.queue_draw();
}

void ContourWindow::UseEditor(ContourEditor* editor) {
  canvas_.SetEditor(editor);
  slices_.SetEditor(editor);
  panel_.SetEditor(editor);
}

void ContourWindow::ChooseFile(FileQuestion what, std::function<void(std::filesystem::path)> act) {
  const ChooserText& text = kChoosers[static_cast<std::size_t>(what)];
  gui::FileRequest request;
  request.title = core::Translate(text.title), request.accept = core::Translate(text.accept);
  request.new_name = text.name;
  if (request.new_name.empty()) request.kinds = {{core::Translate("Contours (JSON)"), "*.json"}};
  file_dialog_.Ask(*this, request, std::move(act));
}

bool ContourWindow::AskSizes(const images::ImageSeriesOptions& series) {
  series_bar_.Ask(series);
  return run_ == nullptr || run_->AnswerSizes();
}

void ContourWindow::StartTimer(ContourTimer timer, unsigned milliseconds) {
  sigc::connection& connection = timers_[static_cast<std::size_t>(timer)];
  connection.disconnect();
  connection =
      Glib::signal_timeout().connect([this, timer] { return presenter_->OnTimer(timer); }, milliseconds);
}

void ContourWindow::DoInWindow(ContourAction action) {
  if (action == ContourAction::kToggleFullscreen) return is_fullscreen() ? unfullscreen() : fullscreen();
  // never within a frame
  if (action == ContourAction::kQuit) Glib::signal_timeout().connect_once([this] { close(); }, 0);
}

}  // namespace trocar::editor
