// SPDX-License-Identifier: Apache-2.0
/// \file contour_panel.h  The right side of the contour window: organs, the slice, the edge search, the surface.
#pragma once

#include <gtkmm.h>

#include <map>
#include <string>

#include "trocar/editor/contour_cards.h"
#include "trocar/editor/contour_panel_presenter.h"

namespace trocar::editor {

class ContourPanel : public Gtk::Box, private ContourPanelScreen {
 public:
  ContourPanel();

  /// \param editor  outlives the panel's use
  void SetEditor(ContourEditor* editor) { presenter_.UseEditor(editor); }
  /// Refreshes what the document and the editor say.
  void Refresh() { presenter_.Refresh(); }
  ContourPanelPresenter& Presenter() { return presenter_; }
  void ShowJob(const contours::MeshJob::State& state) { surface_.ShowJob(state); }
  MeshView& View() { return surface_.View(); }

  sigc::signal<void()>& SignalEdited() { return signal_edited_; }
  sigc::signal<void(ContourAction)>& SignalAction() { return slice_.SignalAction(); }
  sigc::signal<void()>& SignalCancelJob() { return surface_.SignalCancel(); }

 private:
  // ContourPanelScreen
  void Show(const ContourPanelPage& page) override;
  void ShowSurfaces(std::vector<render::FigureSurface> surfaces, bool is_fit_wanted) override;
  void ShowSurfaceText(const std::string& text) override { surface_.ShowText(text); }
  void OnEdited() override { signal_edited_.emit(); }

  ContourPanelPresenter presenter_{*this};
  OrganCard organs_{presenter_};
  SliceCard slice_;
  EdgeCard edges_{presenter_};
  SurfaceCard surface_;
  sigc::signal<void()> signal_edited_;
};

}  // namespace trocar::editor
