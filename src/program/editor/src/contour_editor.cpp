// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_editor.h"

#include <algorithm>
#include <utility>

#include "trocar/host/translate.h"

namespace trocar::editor {

using math::Vec2;

namespace {

using contours::ContourId;

constexpr double kZoomStep = 1.25;  // of a key
constexpr auto kRefused = base::ErrorCode::kEditRefused;
constexpr const char* kNoContour = host::Mark("choose a contour first: click one of its points");

}  // namespace

ContourEditor::ContourEditor(contours::ContourWorkspace& workspace) : workspace_(&workspace) {
  // begin where the work is
  const auto& structures = workspace.Document().Points().structures;
  for (int s = 0; s < static_cast<int>(structures.size()); ++s) {
    const auto slices = workspace.Document().ContouredSlices(s);
    if (slices.empty()) continue;
    structure_ = s;
    slice_ = slices[slices.size() / 2];
    return;
  }
  const auto& slices = workspace.Slices();
  slice_ = slices[slices.size() / 2];
}

void ContourEditor::SetSlice(int slice) {
  slice = workspace_->StepSlice(slice, 0);
  if (slice == slice_) return;
  Release();
  slice_ = slice;
  choice_.reset();
}

void ContourEditor::ChooseStructure(int structure) {
  const int count = static_cast<int>(workspace_->Document().Points().structures.size());
  structure = std::clamp(structure, 0, std::max(0, count - 1));
  if (structure == structure_) return;
  Release();
  structure_ = structure;
  choice_.reset();
}

void ContourEditor::SetSliceStep(int step) {
  slice_step_ = std::clamp(step, 1, 50);
}

void ContourEditor::SetPointing(bool is_on) {
  Release();
  is_pointing_ = is_on;
}

void ContourEditor::PointTo(const Vec2& place) {
  is_pointing_ = false;
  if (on_place) on_place(place);
}

void ContourEditor::EmitError(const base::Status& status) {
  if (!status.ok() && on_error) on_error(status.error());
}

void ContourEditor::EmitEvent(const std::string& text) {
  if (on_event) on_event(text);
}

std::optional<ContourChoice> ContourEditor::FindPoint(const Vec2& at) {
  const auto& here = Here();
  const auto fit = workspace_->Fit(structure_, slice_);
  std::optional<ContourChoice> found;
  double best = kReach;
  for (const bool is_hole : {false, true}) {
    const auto& polygons = is_hole ? here.holes : here.contours;
    for (std::size_t i = 0; i < polygons.size(); ++i) {
      const ContourId id{structure_, slice_, is_hole, static_cast<int>(i)};
      // a point is gripped where it was clicked or where it went
      std::vector<std::span<const Vec2>> stages = {polygons[i]};
      if (fit.ok()) stages.push_back((is_hole ? (*fit)->holes : (*fit)->contours)[i]->adapted);
      for (const auto& stage : stages) {
        if (const auto hit = HitPoint(view, size, stage, at, best)) {
          best = Norm(ToCanvas(view, size, stage[*hit]) - at);
          found = ContourChoice{id, *hit};
        }
      }
    }
  }
  return found;
}

bool ContourEditor::InsertOnCurve(const Vec2& at) {
  const auto fit = workspace_->Fit(structure_, slice_);
  if (!fit.ok()) return false;
  double best = kReach;
  std::optional<std::pair<ContourId, CurveHit>> found;
  for (const bool is_hole : {false, true}) {
    const auto& fits = is_hole ? (*fit)->holes : (*fit)->contours;
    for (std::size_t i = 0; i < fits.size(); ++i) {
      const auto hit = HitCurve(view, size, fits[i]->spline, at, best);
      if (!hit) continue;
      best = hit->distance;
      found = std::pair(ContourId{structure_, slice_, is_hole, static_cast<int>(i)}, *hit);
    }
  }
  if (!found) return false;
  const auto& [id, hit] = *found;
  const auto& fits = id.is_hole ? (*fit)->holes : (*fit)->contours;
  const auto& stages = *fits[id.index];
  const std::size_t before = FindInsertion(stages.spline, stages.adapted, hit.side);
  workspace_->Document().BeginGesture();
  const auto status = workspace_->Document().InsertPoint(id, before, hit.at);
  if (!status.ok()) {
    workspace_->Document().EndGesture();
    EmitError(status);
    return true;
  }
  choice_ = ContourChoice{id, before};
  is_dragging_ = true;
  grip_ = hit.at - ToPicture(view, size, at);
  return true;
}

void ContourEditor::Press(const Vec2& at, bool is_double) {
  Release();
  const Vec2 p = ToPicture(view, size, at);
  pointer_ = p;
  if (is_pointing_) return PointTo(p);
  auto& document = workspace_->Document();
  const auto& open = Here().open;
  if (!open.empty()) {
    // the second half of a double click has set its point already
    const bool is_at_first = open.size() >= 3 && Norm(ToCanvas(view, size, open.front()) - at) <= kReach;
    if (is_double || is_at_first) {
      CloseContour();
    } else if (is_scissors_) {
      EmitError(workspace_->FollowEdge(structure_, slice_, p));
    } else {
      EmitError(document.AddPoint(structure_, slice_, p));
    }
    return;
  }
  if (const auto found = FindPoint(at)) {
    choice_ = found;
    is_dragging_ = true;
    grip_ = document.Find(found->id)[*found->point] - p;
    // gripped at the place where the point went: it is clicked anew there
    if (Norm(ToCanvas(view, size, p + grip_) - at) > kReach) grip_ = {0, 0};
    document.BeginGesture();
    return;
  }
  if (InsertOnCurve(at)) return;
  choice_.reset();
  if (is_double) return;
  const auto& info = workspace_->Series();
  if (p.x < -0.5 || p.y < -0.5 || p.x > info.width - 0.5 || p.y > info.height - 0.5) return;
  EmitError(document.AddPoint(structure_, slice_, p));
}

void ContourEditor::Drag(const Vec2& at) {
  pointer_ = ToPicture(view, size, at);
  if (!is_dragging_ || !choice_ || !choice_->point) return;
  // where the move is not allowed the point stays behind, and follows again when it can
  (void)workspace_->Document().MovePoint(choice_->id, *choice_->point, *pointer_ + grip_);
}

void ContourEditor::Release() {
  if (!is_dragging_) return;
  is_dragging_ = false;
  workspace_->Document().EndGesture();
}

void ContourEditor::SecondaryPress(const Vec2& at) {
  Release();
  if (!Here().open.empty()) return DeleteChosen();
  if (const auto found = FindPoint(at)) {
    choice_ = found;
    DeleteChosen();
  }
}

void ContourEditor::Hover(const std::optional<Vec2>& at) {
  pointer_ = at ? std::optional(ToPicture(view, size, *at)) : std::nullopt;
}

std::vector<Vec2> ContourEditor::RubberLine() {
  const auto& open = Here().open;
  if (open.empty() || !pointer_) return {};
  if (!is_scissors_) return {open.back(), *pointer_};
  auto path = workspace_->FindScissorsPath(structure_, slice_, *pointer_);
  return path.ok() ? std::move(*path) : std::vector<Vec2>{open.back(), *pointer_};
}

void ContourEditor::CloseContour() {
  if (is_pointing_)
    return PointTo(pointer_.value_or(ToPicture(view, size, {0.5 * size.width, 0.5 * size.height})));
  auto& document = workspace_->Document();
  document.BeginGesture();
  // the edge is followed back to the first point too
  base::Status status;
  if (is_scissors_ && Here().open.size() >= 2) {
    status = workspace_->FollowEdge(structure_, slice_, Here().open.front());
  }
  if (status.ok()) status = document.CloseContour(structure_, slice_);
  if (!status.ok()) {
    document.CancelGesture();
    return EmitError(status);
  }
  document.EndGesture();
  choice_ = ContourChoice{{structure_, slice_, false, static_cast<int>(Here().contours.size()) - 1}, {}};
}

void ContourEditor::DeleteChosen() {
  auto& document = workspace_->Document();
  if (const auto& here = Here(); !here.open.empty()) {
    return EmitError(document.RemoveLastPoint(structure_, slice_));
  }
  if (!choice_) return EmitError(base::Error{kRefused, "choose a point first: click it"});
  if (!choice_->point) return EmitError(document.DeleteContour(choice_->id));
  // a contour of three points goes as a whole
  const bool is_last = document.Find(choice_->id).size() <= 3;
  EmitError(is_last ? document.DeleteContour(choice_->id)
                    : document.DeletePoint(choice_->id, *choice_->point));
  choice_.reset();
}

std::optional<int> ContourEditor::FindContoured(int direction) const {
  const auto slices = workspace_->Document().ContouredSlices(structure_);
  if (direction > 0) {
    const auto found = std::upper_bound(slices.begin(), slices.end(), slice_);
    return found == slices.end() ? std::nullopt : std::optional(*found);
  }
  const auto found = std::lower_bound(slices.begin(), slices.end(), slice_);
  return found == slices.begin() ? std::nullopt : std::optional(*(found - 1));
}

void ContourEditor::Propagate(int direction) {
  const int to = workspace_->StepSlice(slice_, direction * slice_step_);
  const auto carried = workspace_->Propagate(structure_, slice_, to);
  if (!carried.ok()) return EmitError(carried.error());
  SetSlice(to);
  const int percent = static_cast<int>(100 * carried->confidence + 0.5);
  EmitEvent(host::TranslateWith(
      "Carried {1} to slice {2}; the least certain point agrees to {3} %. Correct it where it is wrong.",
      {host::TranslateCount("{1} contour", "{1} contours", carried->contours), std::to_string(to),
       std::to_string(percent)}));
}

void ContourEditor::GoTo(const std::optional<contours::EditPlace>& place, const std::string& verb) {
  if (!place) return;
  choice_.reset();
  ChooseStructure(place->structure);
  // an undone organ may have gone
  structure_ = std::clamp(
      structure_, 0, std::max(0, static_cast<int>(workspace_->Document().Points().structures.size()) - 1));
  if (place->slice) SetSlice(*place->slice);
  EmitEvent(verb + ": " + host::TranslateComposed(place->what));
}

void ContourEditor::GoTo(const std::optional<int>& slice) {
  if (slice) SetSlice(*slice);
}

void ContourEditor::GoToContoured(bool is_last) {
  const auto contoured = workspace_->Document().ContouredSlices(structure_);
  if (!contoured.empty()) SetSlice(is_last ? contoured.back() : contoured.front());
}

/// Gives up pointing, the drag, the choice or the open contour, in this order.
void ContourEditor::Cancel() {
  auto& document = workspace_->Document();
  if (is_pointing_) {
    is_pointing_ = false;
  } else if (is_dragging_) {
    is_dragging_ = false;
    document.CancelGesture();
    choice_.reset();
  } else if (choice_) {
    choice_.reset();
  } else if (!Here().open.empty()) {
    EmitError(document.DropOpenContour(structure_, slice_));
    EmitEvent(host::Translate("The open contour was dropped; Ctrl+Z brings it back"));
  }
}

void ContourEditor::DeleteContour() {
  Release();
  if (!choice_) return EmitError(base::Error{kRefused, kNoContour});
  EmitError(workspace_->Document().DeleteContour(choice_->id));
  choice_.reset();
}

void ContourEditor::ClearSlice() {
  Release();
  choice_.reset();
  EmitError(workspace_->Document().ClearSlice(structure_, slice_));
}

void ContourEditor::ToggleHole() {
  Release();
  if (!Here().open.empty()) return EmitError(workspace_->Document().CloseContour(structure_, slice_, true));
  if (!choice_) return EmitError(base::Error{kRefused, kNoContour});
  EmitError(workspace_->Document().ToggleHole(choice_->id));
  choice_.reset();
}

void ContourEditor::ChooseNextOrgan() {
  const int count = static_cast<int>(workspace_->Document().Points().structures.size());
  if (count > 0) ChooseStructure((structure_ + 1) % count);
}

void ContourEditor::Undo() {
  Release();
  GoTo(workspace_->Document().Undo(), host::Translate("Undone"));
}

void ContourEditor::Redo() {
  Release();
  GoTo(workspace_->Document().Redo(), host::Translate("Done again"));
}

void ContourEditor::FitWhole() {
  FitPicture(view, size, workspace_->Series().width, workspace_->Series().height);
}

void ContourEditor::FitOrgan() {
  constexpr double kBorder = 12;  // [pixels of the picture]
  const auto& structures = workspace_->Document().Points().structures;
  if (structure_ >= static_cast<int>(structures.size())) return;
  Vec2 low{1e9, 1e9}, high{-1e9, -1e9};
  for (const auto& slice : structures[structure_].slices) {
    for (const auto& polygon : slice.contours) {
      for (const Vec2& p : polygon) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
      }
    }
  }
  if (low.x <= high.x) FitBox(view, size, low - Vec2{kBorder, kBorder}, high + Vec2{kBorder, kBorder});
}

void ContourEditor::Zoom(double factor) {
  const Vec2 at = pointer_ ? ToCanvas(view, size, *pointer_) : Vec2{0.5 * size.width, 0.5 * size.height};
  ZoomAt(view, size, at, factor);
}

void ContourEditor::ToggleMirror() {
  if (view.is_mirrored_x || view.is_mirrored_y) {
    view.is_mirrored_x = view.is_mirrored_y = false;
  } else {
    MirrorForRadiology(view, workspace_->Series().axes);
  }
}

bool ContourEditor::Do(ContourAction action) {
  using enum ContourAction;
  struct Row {
    ContourAction action;
    void (*act)(ContourEditor&);
  };
  static constexpr Row kRows[] = {
      {kNextSlice, [](ContourEditor& e) { e.SetSlice(e.workspace_->StepSlice(e.slice_, 1)); }},
      {kPreviousSlice, [](ContourEditor& e) { e.SetSlice(e.workspace_->StepSlice(e.slice_, -1)); }},
      {kStepForward, [](ContourEditor& e) { e.SetSlice(e.workspace_->StepSlice(e.slice_, e.slice_step_)); }},
      {kStepBack, [](ContourEditor& e) { e.SetSlice(e.workspace_->StepSlice(e.slice_, -e.slice_step_)); }},
      {kNextContoured, [](ContourEditor& e) { e.GoTo(e.FindContoured(1)); }},
      {kPreviousContoured, [](ContourEditor& e) { e.GoTo(e.FindContoured(-1)); }},
      {kFirstContoured, [](ContourEditor& e) { e.GoToContoured(false); }},
      {kLastContoured, [](ContourEditor& e) { e.GoToContoured(true); }},
      {kCloseContour, [](ContourEditor& e) { e.CloseContour(); }},
      {kCancel, [](ContourEditor& e) { e.Cancel(); }},
      {kDelete, [](ContourEditor& e) { e.Release(), e.DeleteChosen(); }},
      {kDeleteContour, [](ContourEditor& e) { e.DeleteContour(); }},
      {kClearSlice, [](ContourEditor& e) { e.ClearSlice(); }},
      {kToggleHole, [](ContourEditor& e) { e.ToggleHole(); }},
      {kNextOrgan, [](ContourEditor& e) { e.ChooseNextOrgan(); }},
      {kPropagateForward, [](ContourEditor& e) { e.Release(), e.Propagate(1); }},
      {kPropagateBack, [](ContourEditor& e) { e.Release(), e.Propagate(-1); }},
      {kToggleScissors, [](ContourEditor& e) { e.is_scissors_ = !e.is_scissors_; }},
      {kUndo, [](ContourEditor& e) { e.Undo(); }},
      {kRedo, [](ContourEditor& e) { e.Redo(); }},
      {kFitView, [](ContourEditor& e) { e.FitWhole(); }},
      {kFitOrgan, [](ContourEditor& e) { e.FitOrgan(); }},
      {kZoomIn, [](ContourEditor& e) { e.Zoom(kZoomStep); }},
      {kZoomOut, [](ContourEditor& e) { e.Zoom(1 / kZoomStep); }},
      {kMirror, [](ContourEditor& e) { e.ToggleMirror(); }},
  };
  for (const Row& row : kRows) {
    if (row.action != action) continue;
    row.act(*this);
    return true;
  }
  return false;
}

}  // namespace trocar::editor
