// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_presenter.h"

#include <utility>
#include <vector>

#include "trocar/base/assert.h"
#include "trocar/editor/contour_read_outs.h"
#include "trocar/host/log.h"
#include "trocar/host/translate.h"

namespace trocar::editor {
namespace {

constexpr unsigned kSurfaceDelay = 60;    // after an edit until the surface is made anew [ms]
constexpr unsigned kAutosaveLook = 1000;  // between looks at how the autosave went [ms]

}  // namespace

ContourPresenter::ContourPresenter(const ContourOptions& options, std::filesystem::path user_folder,
                                   ContourScreen& screen, ContourWakes wakes)
    : options_(options),
      user_folder_(std::move(user_folder)),
      screen_(&screen),
      wakes_(std::move(wakes)),
      loading_(wakes_.on_loaded),
      building_(wakes_.on_built),
      growing_(wakes_.on_grown) {}

ContourPresenter::~ContourPresenter() {
  growth_stop_.request_stop();
  surfaces_.reset();
}

// opening

void ContourPresenter::Start() {
  contours::WorkspaceOptions workspace;
  workspace.images = options_.images;
  workspace.points = options_.points;
  workspace.reference = options_.reference;
  workspace.series = options_.series;
  Refresh();
  Open(std::move(workspace));
}

void ContourPresenter::Open(contours::WorkspaceOptions options) {
  if (loading_.IsRunning()) return;
  loading_options_ = std::move(options);
  page_.is_busy = true;
  ShowHint(host::Translate("Opening the pictures ..."));
  loading_.Start([this, options = loading_options_] {
    return contours::ContourWorkspace::Open(options, [this](std::string_view what, double fraction) {
      progress_.Set(what, fraction);
      wakes_.on_progress();
    });
  });
}

void ContourPresenter::OpenWith(const images::ImageSeriesOptions& series) {
  auto options = loading_options_;
  options.series = series;
  Open(std::move(options));
}

void ContourPresenter::FinishLoading() {
  auto opened = loading_.Take();
  page_.is_busy = false;
  page_.state.clear();
  ShowHint("");
  if (!opened.ok()) return OpeningFailed(opened.error());
  UseWorkspace(std::move(*opened));
}

void ContourPresenter::OpeningFailed(const base::Error& error) {
  if (error.code == base::ErrorCode::kImageSpacingUnknown) {
    has_asked_sizes_ = true;
    if (screen_->AskSizes(loading_options_.series)) return;
  }
  if (!options_.IsAttended()) return Abandon(error);
  // what was typed may be what is wrong
  if (has_asked_sizes_) (void)screen_->AskSizes(loading_options_.series);
  Report(error);
}

/// Ends the contours that are shown.
void ContourPresenter::Drop() {
  growth_stop_.request_stop();
  is_growth_void_ = growing_.IsRunning();
  screen_->UseEditor(nullptr);
  surfaces_.reset();
  prefetcher_.reset();
  side_file_.Release();
  editor_.reset();
}

void ContourPresenter::UseWorkspace(contours::ContourWorkspace workspace) {
  Drop();
  workspace_ = std::make_unique<contours::ContourWorkspace>(std::move(workspace));
  // a run that is not attended leaves no side file and asks nothing
  const bool is_kept = (options_.IsAttended() || options_.has_autosave) && TakeSideFile();
  if (is_kept) OfferRecovered();
  editor_ = std::make_unique<ContourEditor>(*workspace_);
  editor_->on_error = [this](const base::Error& error) {
    if (error.code == base::ErrorCode::kEditRefused)
      return ShowHint(host::TranslateComposed(error.message), true);
    Report(error);
  };
  editor_->on_event = [this](const std::string& text) { ShowHint(text); };
  editor_->on_place = [this](const math::Vec2& place) { StartGrowth(place); };
  prefetcher_ = std::make_unique<contours::SlicePrefetcher>(workspace_->Store());
  surfaces_ = std::make_unique<SurfaceUpdates>(*workspace_, wakes_.on_surfaces);
  screen_->UseEditor(editor_.get());
  page_.has_reference = workspace_->HasReference() && options_.run.IsAttended();
  page_.series = SeriesText(workspace_->Series());
  if (const std::string notes = SeriesNotes(workspace_->Series()); !notes.empty()) ShowHint(notes);
  if (is_kept) StartAutosave();
  shown_revision_ = workspace_->Document().Revision();
  RequestSurfaces(true);
  screen_->FocusCanvas();
  Refresh();
  PrefetchNeighbours();
}

// the side file

bool ContourPresenter::TakeSideFile() {
  const auto taken = side_file_.Take(FindSideFile(workspace_->Options(), user_folder_));
  if (taken.ok()) return true;
  if (taken.error().code != base::ErrorCode::kFileInUse) {
    Report(taken.error());
    return false;
  }
  host::Log(host::LogLevel::kWarning, taken.error().Text());
  screen_->Ask(
      {host::TranslateWith(
           "These contours are open in another window: {1}. Whichever saves last overwrites the other.",
           {host::TranslateComposed(taken.error().message)}),
       {{host::Mark("Close this window"), [this] { screen_->DoInWindow(ContourAction::kQuit); }, true},
        {host::Mark("Go on without autosave"), [] {}}}});
  return false;
}

void ContourPresenter::StartAutosave() {
  side_file_.Start();
  if (workspace_->Document().IsDirty()) side_file_.Offer(workspace_->Document().Text());
  screen_->StartTimer(ContourTimer::kAutosave, kAutosaveLook);
}

void ContourPresenter::OfferRecovered() {
  auto found = side_file_.FindLeft(workspace_->SavedText());
  if (!found.ok()) return Report(found.error());
  if (!found->has_value()) return;
  const auto saved = workspace_->Document().Points();
  workspace_->Replace(std::move(**found));
  const auto back = [this, saved] {
    if (editor_ == nullptr) return;
    workspace_->Replace(saved);
    workspace_->Document().MarkSaved();
    editor_->Choose({});
    editor_->ChooseStructure(0);
    side_file_.Discard();
    OnEdited();
  };
  screen_->Ask(
      {host::Translate(
           "The last session ended without saving. What it had is shown; it is not in the file yet."),
       {{host::Mark("Go on with it"), [] {}, true}, {host::Mark("Back to the file"), back}}});
}

bool ContourPresenter::OnTimer(ContourTimer timer) {
  if (timer == ContourTimer::kSurfaces) {
    are_surfaces_due_ = false;
    RequestSurfaces(false);
    return false;
  }
  if (!side_file_.IsKeeping()) return false;
  if (const auto status = side_file_.LastStatus(); !status.ok()) Report(status.error());
  Refresh();
  return true;
}

// commands

bool ContourPresenter::Meets(ContourNeeds needs) const {
  const bool is_open = editor_ != nullptr;
  switch (needs) {
    case ContourNeeds::kNothing:
      return true;
    case ContourNeeds::kDocument:
      return is_open;
    case ContourNeeds::kUndo:
      return is_open && workspace_->Document().CanUndo();
    case ContourNeeds::kRedo:
      return is_open && workspace_->Document().CanRedo();
    case ContourNeeds::kReference:
      return is_open && workspace_->HasReference();
    case ContourNeeds::kNoBuild:
      return is_open && !building_.IsRunning() && !growing_.IsRunning();
  }
  return false;
}

bool ContourPresenter::IsChecked(ContourAction action) const {
  const Handler* handler = gui::FindHandler(Handlers(), action);
  return handler != nullptr && handler->is_checked != nullptr && handler->is_checked(*this);
}

gui::ButtonState ContourPresenter::FindButton(const ContourCommand& command) const {
  gui::ButtonState state;
  state.is_enabled = Meets(command.needs);
  state.is_checked = IsChecked(command.action);
  state.label = command.button.label;
  std::string tip = command.button.tip;
  if (state.is_enabled && command.action == ContourAction::kUndo)
    tip += ": " + workspace_->Document().UndoText();
  if (state.is_enabled && command.action == ContourAction::kRedo)
    tip += ": " + workspace_->Document().RedoText();
  state.tip = gui::TipText(tip.c_str(), command.keys);
  return state;
}

void ContourPresenter::Do(ContourAction action) {
  if (action == ContourAction::kBuild && building_.IsRunning())
    return ShowHint(host::Translate("A patient is being built already"), true);
  // a command that the editor refuses says so itself
  const ContourNeeds needs = FindNeeds(action);
  const bool is_editors = needs == ContourNeeds::kUndo || needs == ContourNeeds::kRedo;
  if (!Meets(needs) && !(is_editors && editor_ != nullptr)) return Refresh();
  // Esc closes the help first, then ends growing, and is the editor's otherwise
  const bool is_mine = action != ContourAction::kCancel || page_.is_help_open;
  if (!is_mine && growing_.IsRunning()) return Stop();
  if (const Handler* handler = gui::FindHandler(Handlers(), action); handler != nullptr && is_mine) {
    handler->run(*this);
    return Refresh();
  }
  if (editor_ == nullptr) return;
  const int slice = editor_->Slice();
  ShowHint("");
  editor_->Do(action);
  OnEdited();
  if (editor_->Slice() != slice) PrefetchNeighbours();
}

std::span<const ContourPresenter::Handler> ContourPresenter::Handlers() noexcept {
  using Self = ContourPresenter;
  static constexpr Handler kHandlers[] = {
      // files
      {ContourAction::kOpen, [](Self& self) { self.ChooseAndOpen(); }},
      {ContourAction::kSave, [](Self& self) { self.Save(); }},
      {ContourAction::kSaveAs, [](Self& self) { self.SaveAs([] {}); }},
      {ContourAction::kBuild, [](Self& self) { self.ChooseAndBuild(); }},
      // the picture and what lies over it
      {ContourAction::kToggleReference,
       [](Self& self) { self.page_.has_reference = !self.page_.has_reference; },
       [](const Self& self) { return self.page_.has_reference; }},
      {ContourAction::kToggleGhosts, [](Self& self) { self.page_.has_ghosts = !self.page_.has_ghosts; },
       [](const Self& self) { return self.page_.has_ghosts; }},
      {ContourAction::kToggleStages, [](Self& self) { self.page_.has_points = !self.page_.has_points; }},
      {ContourAction::kToggleFill, [](Self& self) { self.page_.has_fill = !self.page_.has_fill; }},
      {ContourAction::kToggleHelp, [](Self& self) { self.page_.is_help_open = !self.page_.is_help_open; },
       [](const Self& self) { return self.page_.is_help_open; }},
      {ContourAction::kCancel, [](Self& self) { self.page_.is_help_open = false; }},
      {ContourAction::kPointsMode, [](Self& self) { self.editor_->SetScissors(false); },
       [](const Self& self) { return self.editor_ != nullptr && !self.editor_->IsScissors(); }},
      {ContourAction::kScissorsMode, [](Self& self) { self.editor_->SetScissors(true); },
       [](const Self& self) { return self.editor_ != nullptr && self.editor_->IsScissors(); }},
      {ContourAction::kGrowMode, [](Self& self) { self.ToggleGrowMode(); },
       [](const Self& self) {
         return self.editor_ != nullptr && (self.editor_->IsPointing() || self.IsGrowing());
       }},
      // the window's own
      {ContourAction::kToggleFullscreen,
       [](Self& self) { self.screen_->DoInWindow(ContourAction::kToggleFullscreen); }},
      {ContourAction::kQuit, [](Self& self) { self.screen_->DoInWindow(ContourAction::kQuit); }},
  };
  return kHandlers;
}

bool ContourPresenter::SetPart(std::string_view part, bool is_on) {
  if (part == "reference") {
    page_.has_reference = is_on;
  } else if (part == "ghosts") {
    page_.has_ghosts = is_on;
  } else if (part == "points") {
    page_.has_points = is_on;
  } else if (part == "fill") {
    page_.has_fill = is_on;
  } else if (part == "help") {
    page_.is_help_open = is_on;
  } else {
    return false;
  }
  Refresh();
  return true;
}

void ContourPresenter::GoToSlice(int slice) {
  if (editor_ == nullptr || editor_->Slice() == slice) return;
  editor_->SetSlice(slice);
  ShowHint("");
  PrefetchNeighbours();
}

void ContourPresenter::StepSlice(int steps) {
  if (editor_ != nullptr) GoToSlice(workspace_->StepSlice(editor_->Slice(), steps));
}

void ContourPresenter::OnEdited() {
  if (workspace_ == nullptr) return;
  const std::uint64_t revision = workspace_->Document().Revision();
  if (revision != shown_revision_) {
    shown_revision_ = revision;
    if (page_.is_hint_warning) ShowHint("");
    side_file_.Offer(workspace_->Document().Text());
    // a drag makes many changes; each surface that is begun shows one of them
    if (!are_surfaces_due_) screen_->StartTimer(ContourTimer::kSurfaces, kSurfaceDelay);
    are_surfaces_due_ = true;
  }
  Refresh();
}

// files

void ContourPresenter::ChooseAndOpen() {
  screen_->ChooseFile(FileQuestion::kOpenContours, [this](const std::filesystem::path& file) {
    auto options = workspace_ != nullptr ? workspace_->Options() : loading_options_;
    options.points = file;
    const auto open = [this, options] { Open(options); };
    if (workspace_ == nullptr || !workspace_->Document().IsDirty()) return open();
    const auto save_first = [this, open] {
      workspace_->Options().points.empty() ? SaveAs(open) : Save() ? open() : void();
    };
    const auto discard = [this, open] {
      side_file_.Discard();
      open();
    };
    screen_->Ask({host::Translate("The contours that are open are not saved."),
                  {{host::Mark("Save, then open"), save_first, true},
                   {host::Mark("Open without saving"), discard},
                   {host::Mark("Stay"), [] {}}}});
  });
}

bool ContourPresenter::Save() {
  const auto file = workspace_->Options().points;
  if (file.empty()) {
    SaveAs([] {});
    return false;
  }
  if (const auto status = workspace_->Save(file); !status.ok()) {
    Report(status.error());
    return false;
  }
  side_file_.Discard();
  ShowHint(host::TranslateWith("Saved {1}", {file.filename().string()}));
  return true;
}

void ContourPresenter::SaveAs(std::function<void()> then) {
  screen_->ChooseFile(FileQuestion::kSaveContours,
                      [this, then = std::move(then)](const std::filesystem::path& file) {
                        if (const auto status = workspace_->Save(file); !status.ok())
                          return Report(status.error());
                        // the side file goes with the name
                        side_file_.Discard();
                        side_file_.Release();
                        if (TakeSideFile()) StartAutosave();
                        ShowHint(host::TranslateWith("Saved {1}", {file.filename().string()}));
                        then();
                      });
}

void ContourPresenter::ChooseAndBuild() {
  // the build reads the file, so that it can be repeated from the command line
  if (workspace_->Options().points.empty()) return SaveAs([this] { ChooseAndBuild(); });
  if (workspace_->Document().IsDirty() && !Save()) return;
  screen_->ChooseFile(FileQuestion::kPatientFolder,
                      [this](const std::filesystem::path& folder) { StartBuild(folder); });
}

bool ContourPresenter::CanBuild() const {
  return editor_ != nullptr && !building_.IsRunning() && !workspace_->Options().points.empty() &&
         !workspace_->Document().IsDirty();
}

void ContourPresenter::StartBuild(const std::filesystem::path& folder) {
  TROCAR_ASSERT(CanBuild());
  build_folder_ = folder;
  anatomy::BuildOptions options;
  options.control_points = workspace_->Options().points;
  options.images = workspace_->Options().images;
  options.dicom_series = workspace_->Options().series.series;
  options.output = folder;
  if (!workspace_->Options().reference.empty()) options.reference = workspace_->Options().reference;
  build_stop_ = {};
  options.stop = build_stop_.get_token();
  page_.is_busy = page_.is_building = true;
  page_.is_stopping = false;
  building_.Start([this, options] {
    return anatomy::BuildPatient(options, [this](std::string_view what, double fraction) {
      progress_.Set(what, fraction);
      wakes_.on_progress();
    });
  });
  Refresh();
}

void ContourPresenter::Stop() {
  (page_.is_growing ? growth_stop_ : build_stop_).request_stop();
  page_.is_stopping = true;
  Refresh();
}

void ContourPresenter::FinishBuild() {
  const auto report = building_.Take();
  page_.is_busy = page_.is_building = false;
  if (!report.ok() && report.error().code == base::ErrorCode::kCancelled) {
    ShowHint(host::Translate("The patient was given up; nothing was written"));
  } else if (!report.ok()) {
    Report(report.error());
  } else {
    std::string text = host::TranslateWith("Wrote the patient {1}:", {build_folder_.string()});
    for (const auto& organ : report->organs) {
      text += host::TranslateWith(" {1} {2} triangles, {3} mL;",
                                  {organ.name, std::to_string(organ.triangles),
                                   std::to_string(static_cast<int>(organ.volume_ml + 0.5))});
    }
    text.back() = '.';
    screen_->ShowNotice(host::TranslateWith("{1} Check it with: trocar anatomy check", {text}));
  }
  Refresh();
}

// growing

void ContourPresenter::ToggleGrowMode() {
  editor_->SetPointing(!editor_->IsPointing());
  if (!editor_->IsPointing()) return ShowHint("");
  const auto& structures = workspace_->Document().Points().structures;
  const std::string organ = structures.empty() ? std::string() : structures[editor_->Structure()].name;
  if (!contours::CanGrow(organ)) {
    editor_->SetPointing(false);
    return ShowHint(
        host::Translate(
            "Liver and gallbladder can grow from a click; choose one of them in the list of organs"),
        true);
  }
  ShowHint(host::TranslateWith(
      "Click into the middle of the {1}, away from its border and from vessels; Esc gives up",
      {host::Translate(organ)}));
}

void ContourPresenter::StartGrowth(const math::Vec2& place) {
  if (growing_.IsRunning()) return;
  growth_stop_ = {};
  is_growth_void_ = false;
  page_.is_busy = page_.is_growing = true;
  page_.is_stopping = false;
  page_.fraction = 0;
  growing_.Start([this, stop = growth_stop_.get_token(),
                  request = workspace_->MakeGrowthRequest(editor_->Structure(), editor_->Slice(), place)] {
    return contours::GrowOrgan(request, stop, [this](std::string_view what, double fraction) {
      progress_.Set(what, fraction);
      wakes_.on_progress();
    });
  });
  ShowHint(host::Translate("The organ grows ... Esc gives it up"));
}

void ContourPresenter::FinishGrowth() {
  const auto grown = growing_.Take();
  page_.is_busy = page_.is_growing = false;
  if (is_growth_void_) return Refresh();
  const base::Status status =
      grown.ok() ? contours::ApplyGrowth(workspace_->Document(), *grown) : base::Status(grown.error());
  if (!status.ok() && status.error().code == base::ErrorCode::kCancelled) {
    ShowHint(host::Translate("Growing was given up; nothing has changed"));
  } else if (!status.ok()) {
    editor_->on_error(status.error());
  } else {
    editor_->Choose({});
    OnEdited();
    ShowHint(host::TranslateWith(
        "The {1} grew: {2} mL, {3}. Look through them, and drag the points that lie wrong; Ctrl+Z takes it "
        "back.",
        {host::Translate(grown->name), std::to_string(static_cast<int>(grown->volume_ml + 0.5)),
         host::TranslateCount("{1} slice", "{1} slices", grown->slices.size())}));
  }
  Refresh();
}

void ContourPresenter::ShowProgress() {
  if (!page_.is_busy) return;
  const gui::JobProgress::Value value = progress_.Get();
  page_.fraction = value.fraction;
  page_.state = value.what;
  screen_->Show(page_);
}

// closing

void ContourPresenter::CloseAnyway() {
  is_closing_ = true;
  screen_->DoInWindow(ContourAction::kQuit);
}

bool ContourPresenter::OnClose() {
  if (is_closing_) {
    side_file_.Discard();
    return false;
  }
  const bool is_lossy = options_.IsAttended() && workspace_ != nullptr && workspace_->Document().IsDirty();
  if (is_lossy) {
    const auto leave = [this] { CloseAnyway(); };
    const auto save = [this, leave] {
      workspace_->Options().points.empty() ? SaveAs(leave) : Save() ? leave() : void();
    };
    screen_->Ask({host::Translate("The contours are not saved."),
                  {{host::Mark("Save and close"), save, true},
                   {host::Mark("Close without saving"), leave},
                   {host::Mark("Stay"), [] {}}}});
    return true;
  }
  if (building_.IsRunning()) {
    const auto give_up = [this] {
      build_stop_.request_stop();
      CloseAnyway();
    };
    screen_->Ask({host::Translate("The patient is still being built."),
                  {{host::Mark("Wait"), [] {}, true},
                   {host::Mark("Give it up and close"), give_up},
                   {host::Mark("Close when it is done"), [this] { CloseAnyway(); }}}});
    return true;
  }
  side_file_.Discard();
  return false;
}

void ContourPresenter::Abandon(const base::Error& error) {
  if (failure_) return;
  failure_ = error;
  host::Log(host::LogLevel::kError, error.Text());
  screen_->DoInWindow(ContourAction::kQuit);
}

// surfaces and pictures

void ContourPresenter::RequestSurfaces(bool is_all) {
  if (surfaces_ == nullptr) return;
  const SurfaceUpdates::Change change = surfaces_->Request(is_all);
  if (change.is_everything_new) screen_->ForgetSurfaces();
  // an organ nobody has begun needs no message
  for (const int structure : change.without) screen_->ShowSurfaceProblem(structure, "");
}

void ContourPresenter::TakeSurfaces() {
  if (surfaces_ == nullptr) return;
  for (auto& outcome : surfaces_->Take()) {
    if (outcome.result.ok()) {
      screen_->ShowSurface(outcome.structure, std::move(*outcome.result));
    } else if (outcome.result.error().code != base::ErrorCode::kCancelled) {
      screen_->ShowSurfaceProblem(outcome.structure, host::TranslateComposed(outcome.result.error().message));
    }
  }
  screen_->ShowSurfaceJob(surfaces_->GetState());
}

void ContourPresenter::CancelSurfaces() {
  if (surfaces_ != nullptr) surfaces_->Cancel();
}

bool ContourPresenter::AreSurfacesDone() const {
  return !are_surfaces_due_ && (surfaces_ == nullptr || !surfaces_->GetState().is_busy);
}

void ContourPresenter::PrefetchNeighbours() {
  std::vector<int> wanted;
  for (const int step : {1, -1, 2, -2, 3, -3})
    wanted.push_back(workspace_->StepSlice(editor_->Slice(), step));
  prefetcher_->Request(std::move(wanted));
}

// what is shown

void ContourPresenter::ShowHint(const std::string& text, bool is_warning) {
  page_.hint = text;
  page_.is_hint_warning = is_warning;
  Refresh();
}

void ContourPresenter::Report(const base::Error& error) {
  host::Log(host::LogLevel::kError, error.Text());
  screen_->ShowError(error);
}

std::string ContourPresenter::DescribeState() const {
  if (workspace_->Document().IsDirty())
    return side_file_.WrittenCount() > 0 ? host::Translate("Not saved \u00b7 autosaved")
                                         : host::Translate("Not saved");
  return workspace_->Options().points.empty() ? host::Translate("New") : host::Translate("Saved");
}

void ContourPresenter::Refresh() {
  page_.is_document_open = editor_ != nullptr;
  if (editor_ != nullptr) {
    const auto& file = workspace_->Options().points;
    const std::string name = file.empty() ? host::Translate("new contours") : file.filename().string();
    page_.title = (workspace_->Document().IsDirty() ? "\u2022 " : "") + name;
    if (!page_.is_busy) page_.state = DescribeState();
  }
  screen_->Show(page_);
}

}  // namespace trocar::editor
