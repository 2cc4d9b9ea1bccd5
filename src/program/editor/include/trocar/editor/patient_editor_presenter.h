// SPDX-License-Identifier: Apache-2.0
/// \file patient_editor_presenter.h  Presenter of the patient editor's window, without a widget: opening, the pointer,
/// commands, the check beside it, autosave, saving.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "trocar/anatomy/patient_lint.h"
#include "trocar/editor/patient_commands.h"
#include "trocar/editor/patient_editor.h"
#include "trocar/editor/patient_editor_options.h"
#include "trocar/gui/background_job.h"
#include "trocar/gui/question.h"
#include "trocar/host/translate.h"

namespace trocar::editor {

/// All that the window says, besides view and panel.
struct PatientPage {
  std::string title = host::Translate("Trocar: patient");
  std::string hint, status;
  bool is_status_warning = false;
};

enum class PatientTimer {
  kCheck,     ///< once: the patient is looked at after an edit
  kAutosave,  ///< again and again
  kCount
};

/// View interface that the presenter drives; a window implements it.
class PatientScreen {
 public:
  virtual ~PatientScreen() = default;
  /// Brings all widgets to what the page, the editor and the presenter's commands say.
  virtual void Show(const PatientPage& page) = 0;
  /// Sets the editor that the panel works on from now on.
  virtual void UseEditor(PatientEditor* editor) = 0;
  virtual void ShowFigure(view::PatientFigure figure) = 0;
  /// Shows the figure's marks alone, where only the brush has moved.
  virtual void ShowMarks(render::FigureMarks marks) = 0;
  virtual void ShowFindings(const anatomy::LintReport& report) = 0;
  /// \param span  of what is shown around the place [m]
  virtual void LookAt(const math::Vec3& p_world, double span) = 0;
  /// The first answer is what closing the question means.
  virtual void Ask(gui::Question question) = 0;
  /// Asks for a folder to write.
  virtual void ChooseFolder(const std::string& name, std::function<void(std::filesystem::path)> act) = 0;
  /// OnTimer() is called after that time.
  virtual void StartTimer(PatientTimer timer, unsigned milliseconds) = 0;
  virtual void Close() = 0;
};

/// How the threads of the presenter wake the window's thread; called by them.
struct PatientWakes {
  std::function<void()> on_loaded, on_checked;
};

class PatientEditorPresenter {
 public:
  using Surface = std::optional<render::SurfaceHit>;
  using Point = std::optional<std::size_t>;

  /// \param screen  outlives the presenter
  PatientEditorPresenter(const PatientEditorOptions& options, PatientScreen& screen, PatientWakes wakes);

  /// Opens the patient; where changes were left unsaved, asks first.
  void Start();

  // the presenter's threads and timers say so
  void FinishLoading();
  void FinishCheck();
  /// \return whether the timer goes on
  bool OnTimer(PatientTimer timer);

  /// Does what a key or a button asks for, where it is possible.
  void Do(PatientAction action);
  bool IsEnabled(PatientAction action) const { return Meets(FindNeeds(action)); }
  gui::ButtonState FindButton(const PatientCommand& command) const;

  // the pointer over the view, as PatientEditor has it
  /// \return whether the press and its drag belong to the editor
  bool Press(const Surface& surface, const Point& point, bool is_other);
  /// \param in_plane  under the pointer at the depth of PatientEditor::Grabbed()
  void Drag(const Surface& surface, const math::Vec3& in_plane);
  void Release();
  void Hover(const Surface& surface);
  void Leave();
  /// \return whether it meant something
  bool Wheel(const Point& point, bool is_wanted, double steps);

  /// The panel has changed the editor.
  void OnEdited() { Refresh(); }
  /// Looks at what a finding names.
  void LookAt(const std::string& where);
  /// Shows why something cannot be.
  void Refuse(const base::Error& error);
  /// Nothing can be shown; a run that is not attended ends.
  void Fail(const base::Error& error);

  /// \return whether the window stays open, because a question has been asked
  bool OnClose();

  /// Fatal error, if any.
  const std::optional<base::Error>& GetFailure() const { return failure_; }
  PatientEditor* Editor() { return editor_.get(); }
  const PatientEditorOptions& GetOptions() const { return options_; }
  const PatientPage& Page() const { return page_; }

 private:
  bool Meets(PatientNeeds needs) const;
  void Load(bool is_recovered);
  void Act(PatientAction action);
  void Check();
  void Save();
  void SaveTo(const std::filesystem::path& folder);
  void SaveAs();
  void Ask(gui::Question question);
  void Announce(const std::string& text, bool is_warning = false);
  void ShowFigure();
  void Refresh();

  PatientEditorOptions options_;
  PatientScreen* screen_;
  PatientPage page_;
  std::optional<base::Error> failure_;
  std::unique_ptr<PatientEditor> editor_;
  Surface hover_;
  bool is_recovered_ = false, is_question_open_ = false, may_close_ = false;
  bool may_overwrite_ = false;  // what was delivered
  bool is_check_due_ = false;
  std::optional<std::uint64_t> checked_revision_;  // the newest that is, or will be, checked

  gui::BackgroundJob<base::Result<anatomy::PatientDocument>> loading_;
  gui::BackgroundJob<anatomy::LintReport> checking_;
};

/// Instructions for the pointer with a tool.
std::string HintText(EditorTool tool);

}  // namespace trocar::editor
