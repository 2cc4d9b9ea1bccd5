// SPDX-License-Identifier: Apache-2.0
/// \file contour_panel.h  The right side of the contour window: organs, the slice, the edge search, the
/// surface.
#pragma once

#include <gtkmm.h>

#include <functional>
#include <map>
#include <string>

#include "mesh_view.h"
#include "trocar/app/contour_editor.h"
#include "trocar/contours/mesh_job.h"

namespace trocar::app {

class ContourPanel : public Gtk::Box {
 public:
  ContourPanel();
  ~ContourPanel() override;

  /// \param editor  outlives the panel's use
  void SetEditor(ContourEditor* editor);
  /// Refreshes what the document and the editor say.
  void Refresh();
  /// A new surface of an organ.
  void SetMesh(int structure, contours::OrganMesh mesh);
  /// Why an organ has no surface.
  void SetMeshProblem(int structure, const std::string& problem);
  /// Forgets all surfaces: organs have been added or deleted.
  void ClearMeshes();
  void ShowJob(const contours::MeshJob::State& state);
  MeshView& View() { return view_; }
  const std::map<int, contours::OrganMesh>& Meshes() const { return meshes_; }

  sigc::signal<void()>& SignalEdited() { return signal_edited_; }
  sigc::signal<void(ContourAction)>& SignalAction() { return signal_action_; }
  sigc::signal<void()>& SignalCancelJob() { return signal_cancel_; }

 private:
  Gtk::Box& AddCard(const char* title, bool is_growing = false);
  void AddOrgans();
  void AddSlice();
  void AddEdges();
  void AddSurface();
  void RefreshOrgans();
  void RefreshSlice();
  void ShowSurfaces();
  void ShowMeshText();
  void NameOrgan(bool is_new);

  ContourEditor* editor_ = nullptr;
  bool is_showing_ = false;  // widgets are being set by us, not by the person
  Gtk::Box organs_{Gtk::Orientation::VERTICAL};
  std::string organs_shown_;
  Gtk::Popover name_popover_;
  Gtk::Entry name_entry_;
  bool is_naming_new_ = false;
  Gtk::Button add_{"Add"}, rename_{"Rename"}, delete_{"Delete"};
  Gtk::Label slice_title_, slice_text_, notes_;
  Gtk::Label reach_value_, skipped_value_, step_value_;
  Gtk::Scale reach_, skipped_, step_;
  MeshView view_;
  Gtk::Label mesh_text_;
  Gtk::ProgressBar progress_;
  Gtk::Button cancel_{"Cancel"};
  std::map<int, contours::OrganMesh> meshes_;
  std::map<int, std::string> problems_;
  std::size_t shown_surfaces_ = 0;
  sigc::signal<void()> signal_edited_, signal_cancel_;
  sigc::signal<void(ContourAction)> signal_action_;
};

}  // namespace trocar::app
