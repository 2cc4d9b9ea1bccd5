// SPDX-License-Identifier: Apache-2.0
/// \file contour_panel_presenter.h  Presenter of the contour window's panel, without a widget: organs, the slice,
/// the edge search, the surfaces.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "trocar/contours/mesh_job.h"
#include "trocar/editor/contour_editor.h"
#include "trocar/render/figure.h"

namespace trocar::editor {

/// A slider, and what stands beside it.
struct SliderPage {
  double value = 0;
  std::string text;

  friend bool operator==(const SliderPage&, const SliderPage&) = default;
};

struct ContourPanelPage {
  struct Organ {
    std::string name, slices;  ///< "liver", "12 slices"
    render::SrgbColour colour{};
    bool is_chosen = false;

    friend bool operator==(const Organ&, const Organ&) = default;
  };
  std::vector<Organ> organs;
  std::string slice_title, slice_text, notes;
  SliderPage reach, skipped,
      step;  ///< how far points go to an edge, and skipped slices' edges [pixels]; slices
};

/// View interface that the presenter drives; a panel implements it.
class ContourPanelScreen {
 public:
  virtual ~ContourPanelScreen() = default;
  virtual void Show(const ContourPanelPage& page) = 0;
  /// \param is_fit_wanted  something lies where the camera may not look
  virtual void ShowSurfaces(std::vector<render::FigureSurface> surfaces, bool is_fit_wanted) = 0;
  /// \param text  of all surfaces, a line each
  virtual void ShowSurfaceText(const std::string& text) = 0;
  /// Contours, or what is chosen, may have changed.
  virtual void OnEdited() = 0;
};

class ContourPanelPresenter {
 public:
  static constexpr double kMostReach = 30;  ///< [pixels], as the file allows

  /// \param screen  outlives the presenter
  explicit ContourPanelPresenter(ContourPanelScreen& screen) : screen_(screen) {}

  /// \param editor  outlives its use here; null: nothing is shown
  void UseEditor(ContourEditor* editor);
  /// Shows what the document and the editor say.
  void Refresh();

  // organs; what cannot be goes to the editor's on_error
  /// Name of the chosen organ; empty without one.
  std::string ChosenName() const;
  void AddOrgan(const std::string& name);
  void RenameOrgan(const std::string& name);
  void DeleteOrgan();
  void ChooseOrgan(int structure);

  // sliders; the first two of the chosen organ, in half pixels
  void SetReach(double pixels);
  void SetSkippedReach(double pixels);
  void SetSliceStep(double slices);

  // surfaces
  void SetMesh(int structure, contours::OrganMesh mesh);
  /// Why an organ has no surface; may be empty.
  void SetMeshProblem(int structure, const std::string& problem);
  /// Forgets all surfaces: organs have been added or deleted.
  void ClearMeshes();
  const std::map<int, contours::OrganMesh>& Meshes() const { return meshes_; }

 private:
  using Adaption = contours::EdgeAdaptionSettings;

  void Finish(const base::Status& status);
  void SetAdaption(double Adaption::*field, double pixels);
  void ShowSurfaces();
  std::string DescribeSurfaces() const;

  ContourPanelScreen& screen_;
  ContourEditor* editor_ = nullptr;
  std::map<int, contours::OrganMesh> meshes_;
  std::map<int, std::string> problems_;
  std::size_t shown_surfaces_ = 0;
};

/// Page of the panel.
ContourPanelPage MakeContourPanelPage(ContourEditor& editor);
/// An organ's surface in the world, from the frame of the pictures.
render::FigureSurface MakeOrganSurface(const contours::ControlPoints& points, int structure,
                                       const contours::OrganMesh& organ);

}  // namespace trocar::editor
