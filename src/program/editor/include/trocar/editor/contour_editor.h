// SPDX-License-Identifier: Apache-2.0
/// \file contour_editor.h  Editing of contours by hand: pointer and commands become edits of the document.
/// No widget.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trocar/contours/contour_workspace.h"
#include "trocar/editor/canvas_view.h"
#include "trocar/editor/contour_commands.h"

namespace trocar::editor {

/// A contour, and one of its points or none.
struct ContourChoice {
  contours::ContourId id;
  std::optional<std::size_t> point;

  friend bool operator==(const ContourChoice&, const ContourChoice&) = default;
};

class ContourEditor {
 public:
  static constexpr double kReach = 9;  ///< how near the pointer must come to a point or curve [pixels]

  /// \param workspace  outlives the editor
  explicit ContourEditor(contours::ContourWorkspace& workspace);

  contours::ContourWorkspace& Workspace() { return *workspace_; }
  const contours::ContourWorkspace& Workspace() const { return *workspace_; }

  // what is looked at and worked on
  int Slice() const { return slice_; }
  void SetSlice(int slice);
  int Structure() const { return structure_; }
  /// \param structure  clamped to those there are
  void ChooseStructure(int structure);
  const std::optional<ContourChoice>& Choice() const { return choice_; }
  void Choose(std::optional<ContourChoice> choice) { choice_ = choice; }
  bool IsScissors() const { return is_scissors_; }
  void SetScissors(bool is_on) { is_scissors_ = is_on; }
  /// The next press points into the organ, and draws nothing; pressing or Cancel ends it.
  bool IsPointing() const { return is_pointing_; }
  void SetPointing(bool is_on);
  /// Slices that page keys and propagation go at once, 1 to 50.
  int SliceStep() const { return slice_step_; }
  void SetSliceStep(int step);
  const contours::SliceContours& Here() const { return workspace_->Document().At(structure_, slice_); }

  CanvasView view;
  CanvasSize size;

  // the pointer, on the canvas [pixels of the window]
  void Press(const math::Vec2& at, bool is_double);
  void Drag(const math::Vec2& at);
  void Release();
  /// The right button: deletes the point under the pointer, or the last one of the open contour.
  void SecondaryPress(const math::Vec2& at);
  void Hover(const std::optional<math::Vec2>& at);
  bool IsDragging() const { return is_dragging_; }
  /// Place of the pointer [pixels of the picture]; nothing when it is elsewhere.
  const std::optional<math::Vec2>& Pointer() const { return pointer_; }
  /// Fit of the slice that is shown; the quick one while a point of it is dragged.
  base::Result<std::shared_ptr<const contours::SliceFit>> Fit() {
    return workspace_->Fit(structure_, slice_,
                           is_dragging_ ? contours::FitEffort::kQuick : contours::FitEffort::kWhole);
  }
  /// From the open contour's last point to the pointer, as a click would add it; empty when nothing is open.
  std::vector<math::Vec2> RubberLine();

  /// Does what needs no window.
  /// \return false when the action is the window's affair
  bool Do(ContourAction action);

  /// A command was refused or failed; never called without something that a person should read.
  std::function<void(const base::Error&)> on_error;
  /// A command did something worth a line: "Carried 2 contours to slice 481".
  std::function<void(const std::string&)> on_event;
  /// The organ has been pointed into [pixels of the picture].
  std::function<void(const math::Vec2&)> on_place;

  /// A slice away from this one with closed contours, in the direction given; nothing when there is none.
  std::optional<int> FindContoured(int direction) const;

 private:
  void EmitError(const base::Status& status);
  void EmitEvent(const std::string& text);
  void GoTo(const std::optional<contours::EditPlace>& place, const std::string& verb);
  void GoTo(const std::optional<int>& slice);
  void GoToContoured(bool is_last);
  void PointTo(const math::Vec2& place);
  void CloseContour();
  void Cancel();
  void DeleteChosen();
  void DeleteContour();
  void ClearSlice();
  void ToggleHole();
  void ChooseNextOrgan();
  void Propagate(int direction);
  void Undo();
  void Redo();
  void FitWhole();
  void FitOrgan();
  void Zoom(double factor);
  void ToggleMirror();
  std::optional<ContourChoice> FindPoint(const math::Vec2& at);
  bool InsertOnCurve(const math::Vec2& at);

  contours::ContourWorkspace* workspace_;
  int structure_ = 0, slice_ = 0, slice_step_ = 1;
  bool is_scissors_ = false, is_dragging_ = false, is_pointing_ = false;
  math::Vec2 grip_;  // from the pointer to the dragged point [pixels of the picture]
  std::optional<ContourChoice> choice_;
  std::optional<math::Vec2> pointer_;
};

}  // namespace trocar::editor
