// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_panel_presenter.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "trocar/editor/contour_read_outs.h"
#include "trocar/editor/organ_colour.h"
#include "trocar/host/translate.h"

namespace trocar::editor {
namespace {

constexpr int kNewOrganTriangles = 1500;

std::string CountSlices(std::size_t count) {
  return host::TranslateCount("{1} slice", "{1} slices", count);
}

SliderPage InPixels(double pixels) {
  char text[32];
  std::snprintf(text, sizeof(text), "%g px", pixels);
  return {pixels, host::LocalNumber(text)};
}

}  // namespace

ContourPanelPage MakeContourPanelPage(ContourEditor& editor) {
  ContourPanelPage page;
  const auto& document = editor.Workspace().Document();
  const auto& structures = document.Points().structures;
  for (int s = 0; s < static_cast<int>(structures.size()); ++s) {
    page.organs.push_back({structures[s].name, CountSlices(document.ContouredSlices(s).size()),
                           OrganColour(structures[s].name, s), s == editor.Structure()});
  }
  page.slice_title = SliceTitle(editor);
  page.slice_text = SliceText(editor);
  page.notes = SliceNotes(editor);
  if (!structures.empty()) {
    const auto& adaption = structures[editor.Structure()].adaption;
    page.reach = InPixels(adaption.max_shift_px);
    page.skipped = InPixels(adaption.skipped_shift_px);
  }
  page.step = {static_cast<double>(editor.SliceStep()),
               CountSlices(static_cast<std::size_t>(editor.SliceStep()))};
  return page;
}

render::FigureSurface MakeOrganSurface(const contours::ControlPoints& points, int structure,
                                       const contours::OrganMesh& organ) {
  constexpr double kMmPerM = 1000.0;
  const auto directions = contours::AxisDirections(points);
  // a frame of the pictures that is left-handed in the body turns its triangles
  const auto& [a, b, c] = directions;
  const double handedness = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
                            a[2] * (b[0] * c[1] - b[1] * c[0]);
  render::FigureSurface surface;
  surface.triangles = organ.mesh.triangles;
  if (handedness < 0) {
    for (auto& t : surface.triangles) std::swap(t[1], t[2]);
  }
  for (const auto& p : organ.mesh.positions) {
    math::Vec3 world;
    for (int axis = 0; axis < 3; ++axis) {
      world[axis] =
          (p.x * directions[0][axis] + p.y * directions[1][axis] + p.z * directions[2][axis]) / kMmPerM;
    }
    surface.positions.push_back(world);
  }
  surface.colours = {OrganColour(points.structures[structure].name, structure)};
  return surface;
}

void ContourPanelPresenter::UseEditor(ContourEditor* editor) {
  editor_ = editor;
  ClearMeshes();
  Refresh();
}

void ContourPanelPresenter::Refresh() {
  if (editor_ != nullptr) screen_.Show(MakeContourPanelPage(*editor_));
}

/// Ends a command: a refusal is the editor's to say, and the window looks at the document anew.
void ContourPanelPresenter::Finish(const base::Status& status) {
  if (!status.ok() && editor_->on_error) editor_->on_error(status.error());
  screen_.OnEdited();
}

// organs

std::string ContourPanelPresenter::ChosenName() const {
  if (editor_ == nullptr) return {};
  const auto& structures = editor_->Workspace().Document().Points().structures;
  return structures.empty() ? "" : structures[editor_->Structure()].name;
}

void ContourPanelPresenter::AddOrgan(const std::string& name) {
  if (editor_ == nullptr) return;
  auto& document = editor_->Workspace().Document();
  const auto status = document.AddStructure(name, kNewOrganTriangles);
  if (status.ok()) editor_->ChooseStructure(static_cast<int>(document.Points().structures.size()) - 1);
  Finish(status);
}

void ContourPanelPresenter::RenameOrgan(const std::string& name) {
  if (editor_ == nullptr) return;
  Finish(editor_->Workspace().Document().RenameStructure(editor_->Structure(), name));
}

void ContourPanelPresenter::DeleteOrgan() {
  if (editor_ == nullptr) return;
  const auto status = editor_->Workspace().Document().DeleteStructure(editor_->Structure());
  editor_->ChooseStructure(0);
  editor_->Choose({});
  Finish(status);
}

void ContourPanelPresenter::ChooseOrgan(int structure) {
  if (editor_ == nullptr) return;
  editor_->ChooseStructure(structure);
  Finish({});
}

// sliders

void ContourPanelPresenter::SetAdaption(double Adaption::*field, double pixels) {
  if (editor_ == nullptr) return;
  auto& document = editor_->Workspace().Document();
  if (document.Points().structures.empty()) return;
  Adaption adaption = document.Points().structures[editor_->Structure()].adaption;
  adaption.*field = std::round(2 * pixels) / 2;
  Finish(document.SetAdaption(editor_->Structure(), adaption));
}

void ContourPanelPresenter::SetReach(double pixels) {
  SetAdaption(&Adaption::max_shift_px, pixels);
}

void ContourPanelPresenter::SetSkippedReach(double pixels) {
  SetAdaption(&Adaption::skipped_shift_px, pixels);
}

void ContourPanelPresenter::SetSliceStep(double slices) {
  if (editor_ == nullptr) return;
  editor_->SetSliceStep(static_cast<int>(std::lround(slices)));
  Finish({});
}

// surfaces

void ContourPanelPresenter::SetMesh(int structure, contours::OrganMesh mesh) {
  problems_.erase(structure);
  meshes_[structure] = std::move(mesh);
  ShowSurfaces();
}

void ContourPanelPresenter::SetMeshProblem(int structure, const std::string& problem) {
  meshes_.erase(structure);
  problems_[structure] = problem;
  ShowSurfaces();
}

void ContourPanelPresenter::ClearMeshes() {
  meshes_.clear();
  problems_.clear();
  ShowSurfaces();
}

void ContourPanelPresenter::ShowSurfaces() {
  std::vector<render::FigureSurface> surfaces;
  if (editor_ != nullptr) {
    const auto& points = editor_->Workspace().Document().Points();
    for (const auto& [structure, organ] : meshes_) {
      if (structure < static_cast<int>(points.structures.size()))
        surfaces.push_back(MakeOrganSurface(points, structure, organ));
    }
  }
  // a new organ may lie where the camera does not look
  const bool has_more = surfaces.size() > shown_surfaces_;
  shown_surfaces_ = surfaces.size();
  screen_.ShowSurfaces(std::move(surfaces), has_more);
  screen_.ShowSurfaceText(DescribeSurfaces());
}

std::string ContourPanelPresenter::DescribeSurfaces() const {
  std::string text;
  if (editor_ == nullptr) return text;
  const auto& structures = editor_->Workspace().Document().Points().structures;
  for (int s = 0; s < static_cast<int>(structures.size()); ++s) {
    const auto mesh = meshes_.find(s);
    const auto problem = problems_.find(s);
    if (mesh == meshes_.end() && (problem == problems_.end() || problem->second.empty())) continue;
    if (!text.empty()) text += "\n";
    text += mesh != meshes_.end() ? MeshText(structures[s].name, mesh->second) : problem->second;
  }
  return text;
}

}  // namespace trocar::editor
