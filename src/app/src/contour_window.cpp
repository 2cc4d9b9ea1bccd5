// SPDX-License-Identifier: Apache-2.0
#include "contour_window.h"

#include <algorithm>
#include <utility>

#include "trocar/app/contour_read_outs.h"
#include "trocar/core/log.h"
#include "trocar/core/safe_file.h"

namespace trocar::app {
namespace {

constexpr int kWidth = 1280, kHeight = 800;
constexpr unsigned kMeshDelay = 60;       // after an edit until the surface is made anew [ms]
constexpr unsigned kAutosaveLook = 1000;  // between looks at how the autosave went [ms]

void SetText(Gtk::Label& label, const std::string& text) {
  if (label.get_text().raw() != text) label.set_text(text);
}

}  // namespace

ContourWindow::ContourWindow(const Options& options, const core::Stopwatch& since_start)
    : options_(options), since_start_(since_start), help_card_(ContourKeyHelpRows()) {
  set_title("Trocar: contours");
  add_css_class("trocar");
  set_default_size(kWidth, kHeight);
  MakeHeader();
  MakeContent();
  MakeKeys();
  MakeRoutes();
  ShowAll();
  contours::WorkspaceOptions workspace;
  workspace.images = options_.images;
  workspace.points = options_.points;
  workspace.reference = options_.reference;
  workspace.series = options_.series;
  StartLoading(std::move(workspace));
}

ContourWindow::~ContourWindow() {
  coarse_timer_.disconnect();
  autosave_timer_.disconnect();
  meshes_.reset();
  for (std::thread* thread : {&loader_, &builder_}) {
    if (thread->joinable()) thread->join();
  }
  canvas_.SetEditor(nullptr);
  slices_.SetEditor(nullptr);
  panel_.SetEditor(nullptr);
}

void ContourWindow::MakeHeader() {
  const auto set = [](Gtk::Button& button, const char* tooltip) {
    button.set_tooltip_text(tooltip);
    button.set_focus_on_click(false);
  };
  set(open_, "Open a file of contours (Ctrl+O)");
  set(save_, "Save the contours (Ctrl+S; Ctrl+Shift+S under another name)");
  set(undo_, "Undo (Ctrl+Z)");
  set(redo_, "Redo (Ctrl+Shift+Z)");
  set(points_mode_, "Each click sets a point");
  set(scissors_mode_, "The line follows the edge between clicks (S)");
  set(fit_, "The whole picture (F); the organ: Shift+F");
  set(reference_, "Borders of the reference labels (R)");
  set(ghosts_, "Contours of the neighbouring slices, faint (G)");
  set(help_, "All keys (F1)");
  set(build_, "Make a patient of the saved contours, as `trocar anatomy build` does (Ctrl+B)");
  build_.add_css_class("primary");
  ghosts_.set_active(true);
  auto* modes = Gtk::make_managed<Gtk::Box>();
  modes->add_css_class("linked");
  modes->append(points_mode_);
  modes->append(scissors_mode_);
  for (Gtk::Widget* widget : {static_cast<Gtk::Widget*>(&open_), static_cast<Gtk::Widget*>(&save_),
                              static_cast<Gtk::Widget*>(&undo_), static_cast<Gtk::Widget*>(&redo_),
                              static_cast<Gtk::Widget*>(modes)})
    header_.pack_start(*widget);
  for (Gtk::Widget* widget : {static_cast<Gtk::Widget*>(&build_), static_cast<Gtk::Widget*>(&help_),
                              static_cast<Gtk::Widget*>(&ghosts_), static_cast<Gtk::Widget*>(&reference_),
                              static_cast<Gtk::Widget*>(&fit_)})
    header_.pack_end(*widget);
  const auto act = [this](Gtk::Button& button, ContourAction action) {
    button.signal_clicked().connect([this, action] {
      if (!is_showing_) OnAction(action);
    });
  };
  act(open_, ContourAction::kOpen);
  act(save_, ContourAction::kSave);
  act(undo_, ContourAction::kUndo);
  act(redo_, ContourAction::kRedo);
  act(fit_, ContourAction::kFitView);
  act(build_, ContourAction::kBuild);
  const auto mode = [this](bool is_scissors) {
    if (is_showing_ || editor_ == nullptr) return;
    editor_->SetScissors(is_scissors);
    ShowAll();
  };
  points_mode_.signal_toggled().connect([mode] { mode(false); });
  scissors_mode_.signal_toggled().connect([mode] { mode(true); });
  reference_.signal_toggled().connect([this] {
    canvas_.Options().has_reference = reference_.get_active();
    canvas_.queue_draw();
  });
  ghosts_.signal_toggled().connect([this] {
    canvas_.Options().has_ghosts = ghosts_.get_active();
    canvas_.queue_draw();
  });
  help_.signal_toggled().connect([this] { help_card_.set_visible(help_.get_active()); });
  header_.set_show_title_buttons(true);
  set_titlebar(header_);
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
  status->add_css_class("status");
  status->set_spacing(18);
  series_text_.set_ellipsize(Pango::EllipsizeMode::END);
  series_text_.set_hexpand(true);
  series_text_.set_xalign(0);
  series_text_.add_css_class("fine");
  place_.add_css_class("numbers");
  busy_.set_valign(Gtk::Align::CENTER);
  busy_.set_visible(false);
  stop_build_.set_visible(false);
  stop_build_.add_css_class("small");
  stop_build_.set_tooltip_text("Give up the patient that is being built; nothing is written");
  for (Gtk::Widget* widget : {static_cast<Gtk::Widget*>(&series_text_), static_cast<Gtk::Widget*>(&place_),
                              static_cast<Gtk::Widget*>(&busy_), static_cast<Gtk::Widget*>(&stop_build_),
                              static_cast<Gtk::Widget*>(&state_)})
    status->append(*widget);
  auto* all = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  all->append(bars_);
  all->append(series_bar_);
  all->append(*middle);
  all->append(*status);
  set_child(*all);
}

void ContourWindow::MakeKeys() {
  const auto keys = Gtk::EventControllerKey::create();
  keys->set_propagation_phase(Gtk::PropagationPhase::CAPTURE);
  keys->signal_key_pressed().connect(
      [this](guint key, guint, Gdk::ModifierType state) {
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
        OnAction(action);
        return true;
      },
      false);
  keys->signal_key_released().connect([this](guint key, guint, Gdk::ModifierType) {
    if (key == GDK_KEY_space) canvas_.HoldSpace(false);
  });
  add_controller(keys);
}

void ContourWindow::MakeRoutes() {
  canvas_.SignalEdited().connect(sigc::mem_fun(*this, &ContourWindow::OnEdited));
  canvas_.SignalPointed().connect(sigc::mem_fun(*this, &ContourWindow::ShowPointer));
  canvas_.SignalStep().connect([this](int steps) {
    if (editor_ != nullptr) GoToSlice(workspace_->StepSlice(editor_->Slice(), steps));
  });
  canvas_.SignalWindow().connect([this] {
    const auto& window = canvas_.Options().window;
    Tell("Window " + std::to_string(static_cast<int>(window.width)) + ", level " +
         std::to_string(static_cast<int>(window.centre)) +
         "; edges are still sought in the suggested window");
  });
  canvas_.SignalFailed().connect(sigc::mem_fun(*this, &ContourWindow::Report));
  slices_.SignalSlice().connect(sigc::mem_fun(*this, &ContourWindow::GoToSlice));
  panel_.SignalEdited().connect(sigc::mem_fun(*this, &ContourWindow::OnEdited));
  panel_.SignalAction().connect(sigc::mem_fun(*this, &ContourWindow::OnAction));
  panel_.SignalCancelJob().connect([this] {
    if (meshes_ != nullptr) meshes_->Cancel();
  });
  panel_.View().SignalFailed().connect(sigc::mem_fun(*this, &ContourWindow::Report));
  series_bar_.SignalAnswered().connect([this](const images::ImageSeriesOptions& series) {
    auto options = loading_options_;
    options.series = series;
    StartLoading(std::move(options));
  });
  mesh_changed_.connect(sigc::mem_fun(*this, &ContourWindow::TakeMeshes));
  loaded_.connect(sigc::mem_fun(*this, &ContourWindow::FinishLoading));
  built_.connect(sigc::mem_fun(*this, &ContourWindow::FinishBuild));
  stop_build_.signal_clicked().connect(sigc::mem_fun(*this, &ContourWindow::StopBuild));
  progressed_.connect([this] {
    const std::lock_guard lock(progress_mutex_);
    busy_.set_fraction(progress_fraction_);
    SetText(state_, progress_what_);
  });
  signal_close_request().connect(sigc::mem_fun(*this, &ContourWindow::OnClose), false);
  if (!options_.screenshot.empty() || options_.is_measuring) {
    canvas_.add_tick_callback(sigc::mem_fun(*this, &ContourWindow::OnFrame));
  }
}

// opening

void ContourWindow::StartLoading(contours::WorkspaceOptions options) {
  if (loader_.joinable()) return;
  loading_options_ = std::move(options);
  busy_.set_visible(true);
  Tell("Opening the pictures ...");
  loader_ = std::thread([this] {
    loading_.emplace(
        contours::ContourWorkspace::Open(loading_options_, [this](std::string_view what, double fraction) {
          {
            const std::lock_guard lock(progress_mutex_);
            progress_what_ = what;
            progress_fraction_ = fraction;
          }
          progressed_.emit();
        }));
    loaded_.emit();
  });
}

void ContourWindow::FinishLoading() {
  loader_.join();
  busy_.set_visible(false);
  auto opened = std::move(*loading_);
  loading_.reset();
  Tell("");
  if (!opened.ok()) {
    SetText(state_, "");
    if (opened.error().code == core::ErrorCode::kImageSpacingUnknown && AskForSizes()) return;
    if (!options_.screenshot.empty() || options_.is_measuring) return Abandon(opened.error());
    // what was typed may be what is wrong
    if (has_asked_sizes_) series_bar_.Ask(loading_options_.series);
    return Report(opened.error());
  }
  canvas_.SetEditor(nullptr);
  slices_.SetEditor(nullptr);
  panel_.SetEditor(nullptr);
  meshes_.reset();
  autosave_.reset();
  prefetcher_.reset();
  workspace_ = std::make_unique<contours::ContourWorkspace>(std::move(*opened));
  // a run that nobody watches leaves no side file and asks nothing
  const bool is_watched = options_.screenshot.empty() && !options_.is_measuring;
  lock_.reset();
  if ((is_watched || options_.has_autosave) && TakeLock()) OfferRecovered();
  editor_ = std::make_unique<ContourEditor>(*workspace_);
  editor_->on_error = [this](const core::Error& error) {
    if (error.code == core::ErrorCode::kEditRefused) return Tell(error.message, true);
    Report(error);
  };
  editor_->on_event = [this](const std::string& text) { Tell(text); };
  prefetcher_ = std::make_unique<contours::SlicePrefetcher>(workspace_->Store());
  meshes_ = std::make_unique<contours::MeshJob>(workspace_->Fits(), [this] { mesh_changed_.emit(); });
  canvas_.SetEditor(editor_.get());
  slices_.SetEditor(editor_.get());
  panel_.SetEditor(editor_.get());
  reference_.set_sensitive(workspace_->HasReference());
  reference_.set_active(workspace_->HasReference() && options_.screenshot.empty());
  SetText(series_text_, SeriesText(workspace_->Series()));
  if (lock_) StartAutosave();
  shown_revision_ = workspace_->Document().Revision();
  RequestMeshes(true);
  canvas_.grab_focus();
  ShowAll();
  PrefetchNeighbours();
}

/// \return whether somebody, or the script, will answer
bool ContourWindow::AskForSizes() {
  series_bar_.Ask(loading_options_.series);
  has_asked_sizes_ = true;
  if (options_.screenshot.empty() && !options_.is_measuring) return true;
  if (!ReadScript()) return true;  // the run has ended
  if (script_.empty() || script_.front().verb != "sizes") return false;
  const std::vector<std::string> words = script_.front().words;
  script_.pop_front();
  series_bar_.Fill({words[0], words[1], {words[2], words[3], words[4]}});
  series_bar_.Answer();
  if (const std::string complaint = series_bar_.Complaint(); !complaint.empty())
    Abandon({core::ErrorCode::kScriptInvalid, complaint});
  return true;
}

std::filesystem::path ContourWindow::AutosaveFile() const {
  const auto& options = workspace_->Options();
  if (!options.points.empty()) return contours::AutosavePath(options.points);
  // nameless contours are kept by the place of their pictures
  std::string name = std::filesystem::absolute(options.images).lexically_normal().string();
  std::replace(name.begin(), name.end(), '/', '_');
  constexpr std::size_t kLongestName = 120;
  if (name.size() > kLongestName) name.erase(0, name.size() - kLongestName);
  return contours::AutosavePath(std::filesystem::path(Glib::get_user_data_dir()) / "trocar" / "contours" /
                                (name + ".json"));
}

bool ContourWindow::TakeLock() {
  lock_.reset();
  auto taken = core::FileLock::Take(AutosaveFile().string() + ".lock");
  if (taken.ok()) {
    lock_.emplace(std::move(*taken));
    return true;
  }
  if (taken.error().code != core::ErrorCode::kFileInUse) {
    Report(taken.error());
    return false;
  }
  core::Log(core::LogLevel::kWarning, taken.error().Text());
  bars_.Ask("These contours are open in another window: " + taken.error().message +
                ". Whichever saves last overwrites the other.",
            {{"Close this window", [this] { close(); }, true}, {"Go on without autosave", [] {}}});
  return false;
}

void ContourWindow::StartAutosave() {
  autosave_ = std::make_unique<contours::ContourAutosave>(AutosaveFile());
  if (workspace_->Document().IsDirty()) autosave_->Offer(workspace_->Document().Text());
  autosave_timer_.disconnect();
  autosave_timer_ = Glib::signal_timeout().connect(
      [this] {
        if (autosave_ == nullptr) return false;
        if (const auto status = autosave_->LastStatus(); !status.ok()) Report(status.error());
        ShowAll();
        return true;
      },
      kAutosaveLook);
}

void ContourWindow::OfferRecovered() {
  auto found = contours::FindAutosaved(AutosaveFile(), workspace_->SavedText());
  if (!found.ok()) return Report(found.error());
  if (!found->has_value()) return;
  const auto saved = workspace_->Document().Points();
  workspace_->Replace(std::move(**found));
  bars_.Ask("The last session ended without saving. What it had is shown; it is not in the file yet.",
            {{"Go on with it", [] {}, true}, {"Back to the file", [this, saved] {
                                                if (workspace_ == nullptr) return;
                                                workspace_->Replace(saved);
                                                workspace_->Document().MarkSaved();
                                                editor_->Choose({});
                                                editor_->ChooseStructure(0);
                                                if (autosave_ != nullptr) autosave_->Discard();
                                                OnEdited();
                                              }}});
}

// editing

void ContourWindow::Tell(const std::string& text, bool is_warning) {
  SetText(hint_, text);
  hint_.set_visible(!text.empty());
  if (is_warning) {
    hint_.add_css_class("warning");
  } else {
    hint_.remove_css_class("warning");
  }
}

void ContourWindow::Report(const core::Error& error) {
  core::Log(core::LogLevel::kError, error.Text());
  bars_.ShowError(error);
}

void ContourWindow::OnAction(ContourAction action) {
  switch (action) {
    case ContourAction::kOpen:
      return ChooseAndOpen();
    case ContourAction::kSave:
      if (workspace_ != nullptr) Save();
      return;
    case ContourAction::kSaveAs:
      if (workspace_ != nullptr) ChooseAndSave([] {});
      return;
    case ContourAction::kBuild:
      if (workspace_ != nullptr) ChooseAndBuild();
      return;
    case ContourAction::kToggleReference:
      if (reference_.get_sensitive()) reference_.set_active(!reference_.get_active());
      return;
    case ContourAction::kToggleGhosts:
      ghosts_.set_active(!ghosts_.get_active());
      return;
    case ContourAction::kToggleStages:
      canvas_.Options().has_points = !canvas_.Options().has_points;
      return canvas_.queue_draw();
    case ContourAction::kToggleFill:
      canvas_.Options().has_fill = !canvas_.Options().has_fill;
      return canvas_.queue_draw();
    case ContourAction::kToggleHelp:
      return help_.set_active(!help_.get_active());
    case ContourAction::kToggleFullscreen:
      if (is_fullscreen()) return unfullscreen();
      return fullscreen();
    case ContourAction::kQuit:
      return close();
    case ContourAction::kCancel:
      if (help_.get_active()) return help_.set_active(false);
      break;
    default:
      break;
  }
  if (editor_ == nullptr) return;
  const int slice = editor_->Slice();
  Tell("");
  editor_->Do(action);
  OnEdited();
  if (editor_->Slice() != slice) PrefetchNeighbours();
}

void ContourWindow::GoToSlice(int slice) {
  if (editor_ == nullptr || editor_->Slice() == slice) return;
  editor_->SetSlice(slice);
  Tell("");
  ShowAll();
  PrefetchNeighbours();
}

void ContourWindow::OnEdited() {
  if (workspace_ == nullptr) return;
  const std::uint64_t revision = workspace_->Document().Revision();
  if (revision != shown_revision_) {
    shown_revision_ = revision;
    if (hint_.has_css_class("warning")) Tell("");
    if (autosave_ != nullptr) autosave_->Offer(workspace_->Document().Text());
    if (!coarse_timer_.connected()) {
      // a drag makes many changes; each surface that is begun shows one of them
      coarse_timer_ = Glib::signal_timeout().connect(
          [this] {
            RequestMeshes(false);
            return false;
          },
          kMeshDelay);
    }
  }
  ShowAll();
}

void ContourWindow::ShowAll() {
  const bool has_document = workspace_ != nullptr;
  is_showing_ = true;
  points_mode_.set_active(has_document && !editor_->IsScissors());
  scissors_mode_.set_active(has_document && editor_->IsScissors());
  is_showing_ = false;
  for (Gtk::Widget* widget : {static_cast<Gtk::Widget*>(&save_), static_cast<Gtk::Widget*>(&fit_),
                              static_cast<Gtk::Widget*>(&points_mode_),
                              static_cast<Gtk::Widget*>(&scissors_mode_), static_cast<Gtk::Widget*>(&panel_)})
    widget->set_sensitive(has_document);
  build_.set_sensitive(has_document && !builder_.joinable());
  undo_.set_sensitive(has_document && workspace_->Document().CanUndo());
  redo_.set_sensitive(has_document && workspace_->Document().CanRedo());
  if (!has_document) return;
  const auto& document = workspace_->Document();
  undo_.set_tooltip_text(document.CanUndo() ? "Undo: " + document.UndoText() + " (Ctrl+Z)" : "Undo (Ctrl+Z)");
  redo_.set_tooltip_text(document.CanRedo() ? "Redo: " + document.RedoText() + " (Ctrl+Shift+Z)"
                                            : "Redo (Ctrl+Shift+Z)");
  const auto& file = workspace_->Options().points;
  const std::string name = file.empty() ? "new contours" : file.filename().string();
  set_title((document.IsDirty() ? "\u2022 " : "") + name);
  if (!builder_.joinable()) {
    std::string state = "Saved";
    if (document.IsDirty()) {
      state =
          autosave_ != nullptr && autosave_->WrittenCount() > 0 ? "Not saved \u00b7 autosaved" : "Not saved";
    } else if (file.empty()) {
      state = "New";
    }
    SetText(state_, state);
  }
  panel_.Refresh();
  ShowPointer();
  slices_.queue_draw();
  canvas_.queue_draw();
}

void ContourWindow::ShowPointer() {
  if (editor_ != nullptr) SetText(place_, PointerText(*editor_));
}

void ContourWindow::RequestMeshes(bool is_all) {
  if (meshes_ == nullptr) return;
  const auto& structures = workspace_->Document().Points().structures;
  // organs that came or went change all indices
  if (structures.size() != meshed_.size()) is_all = true;
  if (is_all) {
    meshes_->Cancel();
    panel_.ClearMeshes();
    meshed_.assign(structures.size(), {});
  }
  for (int s = 0; s < static_cast<int>(structures.size()); ++s) {
    auto request = workspace_->MakeMeshRequest(s);
    contours::Structure& before = meshed_[static_cast<std::size_t>(s)];
    const auto& now = request.content;
    if (!is_all && before.slices == now.slices && before.adaption == now.adaption && before.name == now.name)
      continue;
    before = now;
    // an organ nobody has begun needs no message
    if (workspace_->Document().ContouredSlices(s).empty()) {
      panel_.SetMeshProblem(s, "");
      continue;
    }
    meshes_->Request(std::move(request));
  }
}

void ContourWindow::TakeMeshes() {
  if (meshes_ == nullptr) return;
  for (auto& outcome : meshes_->Take()) {
    if (outcome.result.ok()) {
      panel_.SetMesh(outcome.structure, std::move(*outcome.result));
    } else if (outcome.result.error().code != core::ErrorCode::kCancelled) {
      panel_.SetMeshProblem(outcome.structure, outcome.result.error().message);
    }
  }
  panel_.ShowJob(meshes_->GetState());
}

void ContourWindow::PrefetchNeighbours() {
  std::vector<int> wanted;
  for (const int step : {1, -1, 2, -2, 3, -3})
    wanted.push_back(workspace_->StepSlice(editor_->Slice(), step));
  prefetcher_->Request(std::move(wanted));
}

}  // namespace trocar::app
