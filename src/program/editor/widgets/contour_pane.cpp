// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_pane.h"

#include <utility>

#include "trocar/editor/contour_read_outs.h"
#include "trocar/gui/labels.h"
#include "trocar/host/translate.h"

namespace trocar::editor {
namespace {

struct ChooserText {
  const char *title, *accept, *name;  // an empty name: the file has to be there
};
constexpr ChooserText kChoosers[] = {{host::Mark("Open contours"), host::Mark("Open"), ""},
                                     {host::Mark("Save contours"), host::Mark("Save"), "control_points.json"},
                                     {host::Mark("Folder for the patient"), host::Mark("Build"), "patient"}};

/// Commands that draw nothing: what looks on does them, too.
bool IsLooking(ContourAction action) {
  switch (action) {
    case ContourAction::kNextSlice:
    case ContourAction::kPreviousSlice:
    case ContourAction::kStepForward:
    case ContourAction::kStepBack:
    case ContourAction::kFitView:
    case ContourAction::kZoomIn:
    case ContourAction::kZoomOut:
    case ContourAction::kMirror:
    case ContourAction::kToggleReference:
    case ContourAction::kToggleFullscreen:
    case ContourAction::kQuit:
      return true;
    default:
      return false;
  }
}

}  // namespace

ContourPane::ContourPane(const ContourOptions& options, gui::Tips& tips, ContourPaneHost host)
    : Gtk::Box(Gtk::Orientation::VERTICAL), tips_(tips), host_(std::move(host)) {
  MakeContent();
  tips_.Adopt(panel_);
  tips_.Adopt(slices_);
  presenter_ = std::make_unique<ContourPresenter>(
      options, Glib::get_user_data_dir(), static_cast<ContourScreen&>(*this),
      ContourWakes{[this] { loaded_.emit(); }, [this] { built_.emit(); }, [this] { progressed_.emit(); },
                   [this] { surfaces_changed_.emit(); }, [this] { grown_.emit(); }});
  MakeRoutes();
}

ContourPane::~ContourPane() {
  for (sigc::connection& timer : timers_) timer.disconnect();
  UseEditor(nullptr);
}

void ContourPane::SetReadOnly(bool is_read_only) {
  is_read_only_ = is_read_only;
  canvas_.SetReadOnly(is_read_only);
  panel_.set_visible(!is_read_only);
  hint_.set_visible(!is_read_only && !hint_.get_text().empty());
}

void ContourPane::ShowOverlay(std::optional<images::LabelVolume> labels) {
  if (presenter_->Workspace() == nullptr) return;
  const bool is_there = labels.has_value();
  presenter_->Workspace()->UseReference(std::move(labels));
  canvas_.ForgetReference();
  presenter_->SetPart("reference", is_there);
}

bool ContourPane::OnKey(guint key, Gdk::ModifierType state) {
  const auto has = [state](Gdk::ModifierType mask) { return (state & mask) != Gdk::ModifierType{}; };
  if (has(Gdk::ModifierType::ALT_MASK) || has(Gdk::ModifierType::SUPER_MASK)) return false;
  // a text that is being typed keeps its keys
  const auto* window = dynamic_cast<Gtk::Window*>(get_root());
  const bool is_typing = window != nullptr && dynamic_cast<const Gtk::Text*>(window->get_focus()) != nullptr;
  if (key == GDK_KEY_space && !is_typing && !is_read_only_) {
    canvas_.HoldSpace(true);
    return true;
  }
  const ContourAction action =
      FindContourAction(key, has(Gdk::ModifierType::CONTROL_MASK), has(Gdk::ModifierType::SHIFT_MASK));
  if (action == ContourAction::kNone || (is_typing && !WorksEverywhere(action))) return false;
  if (is_read_only_ && !IsLooking(action)) return false;
  tips_.End();
  presenter_->Do(action);
  return true;
}

void ContourPane::OnKeyReleased(guint key) {
  if (key == GDK_KEY_space) canvas_.HoldSpace(false);
}

void ContourPane::MakeContent() {
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
  append(bars_);
  append(series_bar_);
  append(*middle);
  append(*status);
}

void ContourPane::MakeStatus(Gtk::Box& status) {
  status.add_css_class("status");
  status.set_spacing(18);
  series_text_.set_ellipsize(Pango::EllipsizeMode::END);
  series_text_.set_hexpand(true);
  series_text_.set_xalign(0);
  series_text_.add_css_class("fine");
  place_.add_css_class("numbers");
  busy_.set_valign(Gtk::Align::CENTER);
  busy_.set_visible(false);
  stop_.set_visible(false);
  stop_.add_css_class("small");
  tips_.Set(stop_, host::Translate("Give up what is being made; nothing is changed or written"));
  for (Gtk::Widget* widget : {static_cast<Gtk::Widget*>(&series_text_), static_cast<Gtk::Widget*>(&place_),
                              static_cast<Gtk::Widget*>(&busy_), static_cast<Gtk::Widget*>(&stop_),
                              static_cast<Gtk::Widget*>(&state_)})
    status.append(*widget);
}

void ContourPane::MakeRoutes() {
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
    presenter_->ShowHint(host::TranslateWith(
        "Window {1}, level {2}; edges are still sought in the suggested window",
        {std::to_string(static_cast<int>(window.width)), std::to_string(static_cast<int>(window.centre))}));
  });
  canvas_.SignalFailed().connect([this](const base::Error& error) { presenter_->Report(error); });
  slices_.SignalSlice().connect([this](int slice) { presenter_->GoToSlice(slice); });
  panel_.SignalEdited().connect([this] { presenter_->OnEdited(); });
  panel_.SignalAction().connect([this](ContourAction action) { presenter_->Do(action); });
  panel_.SignalCancelJob().connect([this] { presenter_->CancelSurfaces(); });
  panel_.View().SignalFailed().connect([this](const base::Error& error) { presenter_->Report(error); });
  series_bar_.SignalAnswered().connect(
      [this](const images::ImageSeriesOptions& series) { presenter_->OpenWith(series); });
  loaded_.connect([this] { presenter_->FinishLoading(); });
  built_.connect([this] { presenter_->FinishBuild(); });
  grown_.connect([this] { presenter_->FinishGrowth(); });
  progressed_.connect([this] { presenter_->ShowProgress(); });
  surfaces_changed_.connect([this] { presenter_->TakeSurfaces(); });
  stop_.signal_clicked().connect([this] { presenter_->Stop(); });
}

void ContourPane::Show(const ContourPage& page) {
  help_card_.set_visible(page.is_help_open);
  gui::SetTextOrHide(hint_, is_read_only_ ? "" : page.hint);
  gui::SetClass(hint_, "warning", page.is_hint_warning);
  gui::SetText(series_text_, page.series);
  gui::SetText(state_, page.state);
  busy_.set_visible(page.is_busy);
  busy_.set_fraction(page.fraction);
  stop_.set_visible(page.is_building || page.is_growing);
  stop_.set_sensitive(!page.is_stopping);
  panel_.set_sensitive(page.is_document_open);
  PaintOptions& options = canvas_.Options();
  options.has_points = page.has_points;
  options.has_fill = page.has_fill;
  options.has_ghosts = page.has_ghosts;
  options.has_reference = page.has_reference;
  if (page.is_document_open) {
    panel_.Refresh();
    gui::SetText(place_, PointerText(*presenter_->Editor()));
    slices_.queue_draw();
    canvas_.queue_draw();
  }
  if (host_.show) host_.show(page);
}

void ContourPane::UseEditor(ContourEditor* editor) {
  canvas_.SetEditor(editor);
  slices_.SetEditor(editor);
  panel_.SetEditor(editor);
  // once the presenter has done what it is at
  told_.disconnect();
  if (editor == nullptr || !host_.opened) return;
  told_ = Glib::signal_idle().connect([this] {
    host_.opened();
    return false;
  });
}

void ContourPane::ChooseFile(FileQuestion what, std::function<void(std::filesystem::path)> act) {
  const ChooserText& text = kChoosers[static_cast<std::size_t>(what)];
  gui::FileRequest request;
  request.title = host::Translate(text.title), request.accept = host::Translate(text.accept);
  request.new_name = text.name;
  if (request.new_name.empty()) request.kinds = {{host::Translate("Contours (JSON)"), "*.json"}};
  file_dialog_.Ask(static_cast<Gtk::Widget&>(*this), request, std::move(act));
}

bool ContourPane::AskSizes(const images::ImageSeriesOptions& series) {
  series_bar_.Ask(series);
  return !host_.answers_sizes || host_.answers_sizes(series);
}

void ContourPane::StartTimer(ContourTimer timer, unsigned milliseconds) {
  sigc::connection& connection = timers_[static_cast<std::size_t>(timer)];
  connection.disconnect();
  connection =
      Glib::signal_timeout().connect([this, timer] { return presenter_->OnTimer(timer); }, milliseconds);
}

}  // namespace trocar::editor
