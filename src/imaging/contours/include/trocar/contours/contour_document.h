// SPDX-License-Identifier: Apache-2.0
/// \file contour_document.h  Contours while a person draws them: commands, undo and redo, no window.
/// Source: "General algorithms for laparoscopic surgical simulators", section 3.1.1, first step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/contours/control_points.h"

namespace trocar::contours {

/// Names one closed contour.
struct ContourId {
  int structure = 0;  ///< index into ControlPoints::structures
  int slice = 0;      ///< number of the slice
  bool is_hole = false;
  int index = 0;  ///< among the contours, or among the holes

  friend bool operator==(const ContourId&, const ContourId&) = default;
};

/// Where an undone or redone step took place, so that the person can be shown it.
struct EditPlace {
  int structure = -1;  ///< -1: none
  std::optional<int> slice;
  std::string what;  ///< "move a point"
};

/// Control points that can be edited.
///
/// Every command either does what it says or returns kEditRefused with the reason and changes nothing. A done
/// command can be undone exactly: the document then has the same bytes (Text) as before. Points are kept to
/// 0.01 pixel, as the file keeps them, and inside the picture.
class ContourDocument {
 public:
  /// \param history_bytes  steps beyond this much memory are forgotten, oldest first; the newest stays
  explicit ContourDocument(ControlPoints points, std::size_t history_bytes = 64u << 20);

  const ControlPoints& Points() const { return points_; }
  /// Contours of a structure in a slice; empty where there are none.
  const SliceContours& At(int structure, int slice) const;
  /// Points of a contour; empty when there is no such contour.
  std::span<const math::Vec2> Find(const ContourId& id) const;
  /// Slices of a structure with a closed contour, ascending.
  std::vector<int> ContouredSlices(int structure) const;
  /// The file's text; ParseControlPoints with kDraft reads it back unchanged.
  std::string Text() const { return FormatControlPoints(points_); }

  // the contour that is being drawn: one a structure and slice
  base::Status AddPoint(int structure, int slice, const math::Vec2& p);
  /// Appends the points of a path, as intelligent scissors find it.
  base::Status AddPath(int structure, int slice, std::span<const math::Vec2> path);
  base::Status CloseContour(int structure, int slice, bool is_hole = false);
  /// Takes back the newest point of the open contour.
  base::Status RemoveLastPoint(int structure, int slice);
  base::Status DropOpenContour(int structure, int slice);

  // closed contours
  base::Status MovePoint(const ContourId& id, std::size_t point, const math::Vec2& to);
  /// \param before  index that the new point gets, 0 to size
  base::Status InsertPoint(const ContourId& id, std::size_t before, const math::Vec2& p);
  /// Refused where three different points would not remain.
  base::Status DeletePoint(const ContourId& id, std::size_t point);
  /// A slice without any contour loses its holes too.
  base::Status DeleteContour(const ContourId& id);
  /// Makes a contour a hole and a hole a contour.
  base::Status ToggleHole(const ContourId& id);
  /// Replaces all closed contours and holes of a slice, as propagation does; the open one stays.
  base::Status SetContours(int structure, int slice, std::vector<std::vector<math::Vec2>> contours,
                           std::vector<std::vector<math::Vec2>> holes, std::string_view what);
  base::Status ClearSlice(int structure, int slice);

  // organs
  base::Status AddStructure(const std::string& name, int triangle_budget);
  base::Status RenameStructure(int structure, const std::string& name);
  base::Status DeleteStructure(int structure);
  base::Status SetAdaption(int structure, const EdgeAdaptionSettings& adaption);

  /// Everything until EndGesture becomes one step: a drag.
  void BeginGesture();
  void EndGesture();
  /// Takes back what the gesture did.
  void CancelGesture();

  bool CanUndo() const { return !done_.empty() && !is_gesture_; }
  bool CanRedo() const { return !undone_.empty() && !is_gesture_; }
  /// \return the place; nothing when there is nothing to undo
  std::optional<EditPlace> Undo();
  std::optional<EditPlace> Redo();
  /// Description of the edit that would be undone or redone; empty when there is none.
  std::string UndoText() const { return CanUndo() ? done_.back().place.what : std::string(); }
  std::string RedoText() const { return CanRedo() ? undone_.back().place.what : std::string(); }

  /// Grows with every change, undone ones too.
  std::uint64_t Revision() const { return revision_; }
  /// True when the contours differ from those last saved.
  bool IsDirty() const { return state_ != saved_state_; }
  void MarkSaved() { saved_state_ = state_; }
  /// For contours that were recovered: they are in no file.
  void MarkUnsaved() { saved_state_ = kNeverSaved; }
  std::size_t HistoryBytes() const { return history_bytes_; }

 private:
  struct SliceEdit {
    int structure, slice;
    SliceContours before, after;
  };
  struct HeaderEdit {  // everything of a structure but its slices
    int structure;
    Structure before, after;
  };
  struct StructureEdit {  // comes or goes
    int index;
    bool is_added;
    Structure structure;
  };
  using Edit = std::variant<SliceEdit, HeaderEdit, StructureEdit>;
  struct Step {
    EditPlace place;
    std::vector<Edit> edits;
    std::uint64_t state_before = 0, state_after = 0;
    std::size_t bytes = 0;
  };
  static constexpr std::uint64_t kNeverSaved = ~std::uint64_t{0};

  base::Status CheckStructure(int structure) const;
  base::Status CheckPlace(int structure, int slice) const;
  base::Status CheckContour(const ContourId& id) const;
  base::Result<math::Vec2> Keep(const math::Vec2& p) const;
  /// Checks the new content of a slice, then does and records it.
  base::Status EditSlice(int structure, int slice, SliceContours after, std::string_view what);
  void Record(Edit edit, EditPlace place);
  void Push(Step step);
  void Apply(const Edit& edit, bool is_forward);
  void PutSlice(int structure, int slice, const SliceContours& content);

  ControlPoints points_;
  std::deque<Step> done_, undone_;
  std::size_t history_limit_, history_bytes_ = 0;
  bool is_gesture_ = false;
  Step gesture_;
  std::uint64_t revision_ = 0;
  std::uint64_t state_ = 0, next_state_ = 1, saved_state_ = 0;
};

}  // namespace trocar::contours
