// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/patient_editor_presenter.h"

#include <utility>

#include "trocar/host/data_folder.h"
#include "trocar/host/log.h"
#include "trocar/host/translate.h"
#include "trocar/scene/scene.h"

namespace trocar::editor {
namespace {

constexpr unsigned kAutosavePeriod = 5000;  // [ms]
constexpr unsigned kCheckDelay = 400;       // after the last change [ms]
constexpr double kFindingSpan = 0.09;       // of what is shown around a finding [m]
constexpr double kTubeOpacity = 0.35;       // of the liver, so that ducts are seen [-]

/// Whether the folder belongs to what was delivered: it is never overwritten without a question.
bool IsDelivered(const std::filesystem::path& folder) {
  const auto data = host::FindDataFolder();
  if (!data) return false;
  std::error_code failure;
  const auto inside = std::filesystem::relative(folder, *data / "assets", failure);
  return !failure && !inside.empty() && *inside.begin() != "..";
}

std::optional<EditorTool> FindTool(PatientAction action) {
  switch (action) {
    case PatientAction::kLook:
      return EditorTool::kLook;
    case PatientAction::kPaint:
      return EditorTool::kPaint;
    case PatientAction::kTubes:
      return EditorTool::kTubes;
    case PatientAction::kLandmarks:
      return EditorTool::kLandmarks;
    default:
      return std::nullopt;
  }
}

}  // namespace

std::string HintText(EditorTool tool) {
  switch (tool) {
    case EditorTool::kLook:
      return host::Translate("Drag turns · right button moves · wheel zooms · 1 to 4 choose a tool");
    case EditorTool::kPaint:
      return host::Translate(
          "Drag over the organ paints · Shift erases · Ctrl+wheel: radius · beside the organ the drag turns");
    case EditorTool::kTubes:
      return host::Translate(
          "Click a duct, drag its points · wheel over a point: radius · Shift+click inserts · Delete "
          "removes");
    case EditorTool::kLandmarks:
      return host::Translate("Drag a landmark's disc in the plane of the view");
  }
  return "";
}

PatientEditorPresenter::PatientEditorPresenter(const PatientEditorOptions& options, PatientScreen& screen,
                                               PatientWakes wakes)
    : options_(options),
      screen_(&screen),
      loading_(std::move(wakes.on_loaded)),
      checking_(std::move(wakes.on_checked)) {}

// opening

void PatientEditorPresenter::Start() {
  if (!options_.run.IsAttended() || !anatomy::PatientDocument::HasAutosave(options_.patient))
    return Load(false);
  Ask({host::Translate("Unsaved changes were found"),
       {{host::Mark("Leave them"), [this] { Load(false); }},
        {host::Mark("Go on with them"), [this] { Load(true); }, true}},
       host::Translate("The editor ended before these changes were saved. Go on with them?")});
}

void PatientEditorPresenter::Load(bool is_recovered) {
  is_recovered_ = is_recovered;
  Announce(host::Translate("Opening the patient …"));
  loading_.Start([folder = options_.patient, is_recovered] {
    return anatomy::PatientDocument::Open(folder, is_recovered);
  });
}

void PatientEditorPresenter::FinishLoading() {
  auto document = loading_.Take();
  if (!document) return Fail(document.error());
  const auto data = host::FindDataFolder();
  if (!data) return Fail(data.error());
  const auto colours = view::ReadPatientColours(*data / view::kPatientColoursFile);
  if (!colours) return Fail(colours.error());
  editor_ = std::make_unique<PatientEditor>(std::move(document).value());
  editor_->look.colours = *colours;
  editor_->tool = options_.tool;
  const auto& tubes = editor_->GetPatient().tubes;
  for (std::uint32_t i = 0; i < tubes.size(); ++i) {
    if (tubes[i].role == roles::TubeRole::kCysticDuct) editor_->ChooseTube(i);
  }
  if (editor_->tool == EditorTool::kTubes) editor_->look.liver_opacity = kTubeOpacity;
  screen_->UseEditor(editor_.get());
  Refresh();
  Announce(host::TranslateWith(
      "Opened {1}{2}", {options_.patient.string(),
                        (is_recovered_ ? host::Translate(" with the changes that were not saved") : "")}));
  screen_->StartTimer(PatientTimer::kAutosave, kAutosavePeriod);
}

// commands

bool PatientEditorPresenter::Meets(PatientNeeds needs) const {
  const bool is_open = editor_ != nullptr;
  switch (needs) {
    case PatientNeeds::kNothing:
      return true;
    case PatientNeeds::kPatient:
      return is_open;
    case PatientNeeds::kUndo:
      return is_open && editor_->Document().CanUndo();
    case PatientNeeds::kRedo:
      return is_open && editor_->Document().CanRedo();
    case PatientNeeds::kUnsaved:
      return is_open && editor_->Document().IsDirty();
  }
  return false;
}

gui::ButtonState PatientEditorPresenter::FindButton(const PatientCommand& command) const {
  gui::ButtonState state;
  state.is_enabled = Meets(command.needs);
  state.label = command.button.label;
  std::string tip = command.button.tip;
  if (state.is_enabled && command.action == PatientAction::kUndo)
    tip += ": " + editor_->Document().UndoName();
  if (state.is_enabled && command.action == PatientAction::kRedo)
    tip += ": " + editor_->Document().RedoName();
  state.tip = gui::TipText(tip.c_str(), command.keys);
  return state;
}

void PatientEditorPresenter::Do(PatientAction action) {
  if (is_question_open_ || !IsEnabled(action)) return;
  Act(action);
  Refresh();
}

void PatientEditorPresenter::Act(PatientAction action) {
  const auto try_to = [this](const base::Status& status) {
    if (!status) Refuse(status.error());
  };
  switch (action) {
    case PatientAction::kUndo:
      return editor_->Undo();
    case PatientAction::kRedo:
      return editor_->Redo();
    case PatientAction::kSave:
      return Save();
    case PatientAction::kSaveAs:
      return SaveAs();
    case PatientAction::kDeletePoint:
      return try_to(editor_->DeletePoint());
    case PatientAction::kInsertPoint:
      return try_to(editor_->InsertPoint());
    case PatientAction::kToggleErase:
      editor_->is_erasing = !editor_->is_erasing;
      return;
    case PatientAction::kQuit:
      return screen_->Close();
    default:
      if (const auto tool = FindTool(action)) editor_->tool = *tool;
  }
}

// the pointer

bool PatientEditorPresenter::Press(const Surface& surface, const Point& point, bool is_other) {
  if (editor_ == nullptr) return false;
  const auto revision = editor_->Document().Revision();
  const bool is_taken = editor_->Press(surface, point, is_other);
  hover_ = surface;
  if (is_taken || editor_->Document().Revision() != revision) Refresh();
  return is_taken;
}

void PatientEditorPresenter::Drag(const Surface& surface, const math::Vec3& in_plane) {
  if (editor_ == nullptr) return;
  hover_ = surface;
  if (const auto status = editor_->Drag(surface, in_plane); !status) Refuse(status.error());
  ShowFigure();
}

void PatientEditorPresenter::Release() {
  if (editor_ == nullptr) return;
  editor_->Release();
  Refresh();
}

void PatientEditorPresenter::Hover(const Surface& surface) {
  if (editor_ == nullptr || editor_->tool != EditorTool::kPaint) return;
  hover_ = surface;
  screen_->ShowMarks(editor_->MakeFigure(hover_).marks);
}

void PatientEditorPresenter::Leave() {
  hover_.reset();
  if (editor_ != nullptr && editor_->tool == EditorTool::kPaint) ShowFigure();
}

bool PatientEditorPresenter::Wheel(const Point& point, bool is_wanted, double steps) {
  const bool is_meant = editor_ != nullptr && editor_->Wheel(point, is_wanted, steps);
  if (is_meant) Refresh();
  return is_meant;
}

// the check and the autosave

bool PatientEditorPresenter::OnTimer(PatientTimer timer) {
  if (editor_ == nullptr) return false;
  if (timer == PatientTimer::kCheck) {
    Check();
    return false;
  }
  if (const auto wrote = editor_->Document().Autosave(); !wrote) Refuse(wrote.error());
  return true;
}

void PatientEditorPresenter::Check() {
  is_check_due_ = checking_.IsRunning();
  if (is_check_due_) return;
  checking_.Start([patient = editor_->GetPatient()] { return anatomy::LintPatient(patient); });
}

void PatientEditorPresenter::FinishCheck() {
  screen_->ShowFindings(checking_.Take());
  if (is_check_due_) Check();
}

void PatientEditorPresenter::LookAt(const std::string& where) {
  if (editor_ == nullptr) return;
  if (const auto place = anatomy::FindWhere(editor_->GetPatient(), where))
    screen_->LookAt(*place, kFindingSpan);
}

// saving

void PatientEditorPresenter::Save() {
  const auto folder = editor_->Document().Folder();
  if (may_overwrite_ || !IsDelivered(folder)) return SaveTo(folder);
  const auto overwrite = [this, folder] {
    may_overwrite_ = true;
    SaveTo(folder);
  };
  Ask({host::Translate("Change the patient that came with Trocar?"),
       {{host::Mark("Cancel"), [] {}},
        {host::Mark("Change it"), overwrite},
        {host::Mark("Save as…"), [this] { SaveAs(); }, true}},
       host::Translate("Scenes, samples and other people's results use it as it was delivered.")});
}

void PatientEditorPresenter::SaveTo(const std::filesystem::path& folder) {
  if (const auto status = editor_->Document().Save(folder); !status) return Refuse(status.error());
  Announce(host::TranslateWith("Saved {1}", {folder.string()}));
  Refresh();
}

void PatientEditorPresenter::SaveAs() {
  screen_->ChooseFolder(editor_->Document().Folder().filename().string() + "-edited",
                        [this](const std::filesystem::path& folder) {
                          may_overwrite_ = false;
                          SaveTo(folder);
                        });
}

bool PatientEditorPresenter::OnClose() {
  const bool is_lossy = options_.run.IsAttended() && Meets(PatientNeeds::kUnsaved);
  if (may_close_ || !is_lossy) return false;
  if (is_question_open_) return true;
  const auto leave = [this] {
    editor_->Document().DiscardAutosave();
    may_close_ = true;
    screen_->Close();
  };
  const auto save = [this] {
    Save();
    if (!editor_->Document().IsDirty()) screen_->Close();
  };
  Ask({host::Translate("Save the changes?"),
       {{host::Mark("Cancel"), [] {}}, {host::Mark("Do not save"), leave}, {host::Mark("Save"), save, true}},
       host::Translate("Without saving they are lost.")});
  return true;
}

/// One question at a time; keys wait for its answer.
void PatientEditorPresenter::Ask(gui::Question question) {
  is_question_open_ = true;
  for (gui::Answer& answer : question.answers) {
    answer.act = [this, act = std::move(answer.act)] {
      is_question_open_ = false;
      act();
    };
  }
  screen_->Ask(std::move(question));
}

// what is shown

void PatientEditorPresenter::Announce(const std::string& text, bool is_warning) {
  page_.status = text;
  page_.is_status_warning = is_warning;
  screen_->Show(page_);
}

void PatientEditorPresenter::Refuse(const base::Error& error) {
  Announce(host::ShownText(error), true);
}

void PatientEditorPresenter::Fail(const base::Error& error) {
  failure_ = error;
  Refuse(error);
  if (options_.run.IsAttended()) return;
  host::Log(host::LogLevel::kError, error.Text());
  screen_->Close();
}

void PatientEditorPresenter::ShowFigure() {
  screen_->ShowFigure(editor_->MakeFigure(hover_));
}

/// Everything that follows a change of the editor or the patient.
void PatientEditorPresenter::Refresh() {
  if (editor_ == nullptr) return;
  auto& document = editor_->Document();
  page_.title =
      (document.IsDirty() ? "• " : "") + editor_->GetPatient().name + " – " + document.Folder().string();
  page_.hint = HintText(editor_->tool);
  screen_->Show(page_);
  ShowFigure();
  if (checked_revision_ == document.Revision()) return;
  checked_revision_ = document.Revision();
  screen_->StartTimer(PatientTimer::kCheck, kCheckDelay);
}

}  // namespace trocar::editor
