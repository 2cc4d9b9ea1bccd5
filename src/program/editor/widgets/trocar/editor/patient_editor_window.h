// SPDX-License-Identifier: Apache-2.0
/// \file patient_editor_window.h  The patient editor's widgets; what they show and do is the presenter's.
#pragma once

#include <gtkmm.h>

#include <array>
#include <memory>
#include <optional>

#include "trocar/editor/mesh_view.h"
#include "trocar/editor/patient_editor_panel.h"
#include "trocar/editor/patient_editor_presenter.h"
#include "trocar/gui/command_bar.h"
#include "trocar/gui/file_dialog.h"
#include "trocar/gui/tips.h"

namespace trocar::editor {

class PatientEditorRun;

class PatientEditorWindow : public Gtk::ApplicationWindow, private PatientScreen {
 public:
  explicit PatientEditorWindow(const PatientEditorOptions& options);
  ~PatientEditorWindow() override;

  /// Error of the window, if any: the program's exit status follows it.
  const std::optional<base::Error>& GetFailure() const { return presenter_->GetFailure(); }

 private:
  void Begin();
  void MakeContent();
  void MakeRoutes();
  void ConnectView();
  bool OnKey(guint key, Gdk::ModifierType state);

  // PatientScreen
  void Show(const PatientPage& page) override;
  void UseEditor(PatientEditor* editor) override { panel_.SetEditor(editor); }
  void ShowFigure(view::PatientFigure figure) override;
  void ShowMarks(render::FigureMarks marks) override { view_.SetMarks(std::move(marks)); }
  void ShowFindings(const anatomy::LintReport& report) override { panel_.ShowFindings(report); }
  void LookAt(const math::Vec3& p_world, double span) override { view_.LookAt(p_world, span); }
  void Ask(gui::Question question) override;
  void ChooseFolder(const std::string& name, std::function<void(std::filesystem::path)> act) override;
  void StartTimer(PatientTimer timer, unsigned milliseconds) override;
  void Close() override;

  gui::Tips tips_;
  gui::CommandBar<PatientAction, PatientNeeds> bar_;
  MeshView view_;
  PatientEditorPanel panel_;
  Gtk::Label status_, hint_;
  gui::FileDialog file_dialog_;
  std::array<sigc::connection, static_cast<std::size_t>(PatientTimer::kCount)> timers_;
  Glib::Dispatcher loaded_, checked_;
  std::unique_ptr<PatientEditorPresenter> presenter_;
  std::unique_ptr<PatientEditorRun> run_;  // null where a person is there
};

}  // namespace trocar::editor
