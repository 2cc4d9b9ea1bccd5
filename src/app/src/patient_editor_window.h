// SPDX-License-Identifier: Apache-2.0
/// \file patient_editor_window.h  The patient editor: the patient in the middle, tools and findings beside
/// it.
#pragma once

#include <gtkmm.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "mesh_view.h"
#include "patient_editor_panel.h"
#include "trocar/app/options.h"

namespace trocar::app {

class PatientEditorWindow : public Gtk::ApplicationWindow {
 public:
  explicit PatientEditorWindow(const Options& options);
  ~PatientEditorWindow() override;

  /// What went wrong, if anything did: the program's exit status follows it.
  const std::optional<core::Error>& GetFailure() const { return failure_; }

 protected:
  bool on_close_request() override;

 private:
  void MakeHeader();
  void MakeContent();
  void ConnectView();
  bool OnKey(guint key, Gdk::ModifierType state);
  void Open();
  void Load(bool is_recovered);
  /// Everything that follows a change of the editor or the patient.
  void Refresh();
  void ShowFigure();
  void Check();
  void FinishCheck();
  void Save();
  void SaveAs();
  void SaveTo(const std::filesystem::path& folder);
  void Ask(const Glib::ustring& title, const Glib::ustring& text, const std::vector<Glib::ustring>& answers,
           std::function<void(int)> act);
  void Say(const Glib::ustring& text, bool is_warning = false);
  void Refuse(const core::Error& error);
  void LookAt(const std::string& where);
  void TakeScreenshot();

  Options options_;
  std::optional<core::Error> failure_;
  std::unique_ptr<PatientEditor> editor_;
  bool is_question_open_ = false, may_close_ = false, may_overwrite_ = false;
  std::optional<render::SurfaceHit> hover_;
  std::uint64_t shown_revision_ = 0;

  Gtk::HeaderBar header_;
  Gtk::Button undo_{"Undo"}, redo_{"Redo"}, save_{"Save"}, save_as_{"Save as…"};
  MeshView view_;
  PatientEditorPanel panel_;
  Gtk::Label status_, hint_;

  // the check runs beside the window: newest wins
  std::thread checker_;
  Glib::Dispatcher checked_;
  std::mutex mutex_;
  std::optional<anatomy::LintReport> report_;  // guarded by mutex_
  std::atomic<bool> is_checking_ = false;
  bool is_check_due_ = false;
  sigc::connection check_delay_, autosave_;
};

}  // namespace trocar::app
