// SPDX-License-Identifier: Apache-2.0
/// \file patient_editor.h  Pointer handling of the patient editor, without a widget: the tools, what is
/// chosen, strokes and drags, and the figure that shows it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/anatomy/patient_document.h"
#include "trocar/anatomy/patient_edit.h"
#include "trocar/patient/patient.h"
#include "trocar/render/figure.h"
#include "trocar/view/patient_figure.h"

namespace trocar::editor {

enum class EditorTool { kLook, kPaint, kTubes, kLandmarks };

/// "look", "paint", "tubes", "landmarks".
/// \return nothing for another word
std::optional<EditorTool> FindEditorTool(std::string_view name) noexcept;

/// A region of an organ, by names.
struct RegionChoice {
  std::string organ, region;
  friend bool operator==(const RegionChoice&, const RegionChoice&) = default;
};

/// The document and what is chosen in it.
class PatientEditor {
 public:
  explicit PatientEditor(anatomy::PatientDocument document);

  anatomy::PatientDocument& Document() { return document_; }
  const patient::Patient& GetPatient() const { return document_.GetPatient(); }

  EditorTool tool = EditorTool::kLook;
  RegionChoice region{NameOf(roles::OrganRole::kLiver), patient::kDiaphragmaticFace};
  bool is_erasing = false;
  double brush_radius = 0.010;  ///< [m], 1 to 40 mm
  double reach = 0.012;         ///< how far along a tube neighbours follow a point that moves [m]
  view::PatientFigureOptions look;

  /// Regions that can be painted: the four of the liver, the bed of the gallbladder, and what the patient
  /// has.
  std::vector<RegionChoice> Regions() const;

  std::optional<std::uint32_t> Tube() const { return tube_; }
  std::optional<std::uint32_t> TubePoint() const { return point_; }
  std::optional<std::uint32_t> Landmark() const { return landmark_; }
  /// Chooses one that is there, or nothing.
  void ChooseTube(std::optional<std::uint32_t> tube);
  void ChooseTubePoint(std::optional<std::uint32_t> point);
  void ChooseLandmark(std::optional<std::uint32_t> landmark);

  /// The patient as it is, with what is chosen and the brush at `hover`.
  view::PatientFigure MakeFigure(const std::optional<render::SurfaceHit>& hover) const;

  /// The primary button goes down.
  /// \param is_other  a second meaning is asked for (Shift): the brush does the opposite, a tube gets a point
  /// where it was pressed
  /// \return whether a stroke or drag has begun; otherwise the view turns
  bool Press(const std::optional<render::SurfaceHit>& surface, const std::optional<std::size_t>& point,
             bool is_other);
  /// The pointer has moved.
  /// \param in_plane  under the pointer at the depth of Grabbed()
  base::Status Drag(const std::optional<render::SurfaceHit>& surface, const math::Vec3& in_plane);
  void Release();
  /// Place that is being dragged [m].
  math::Vec3 Grabbed() const { return grabbed_; }
  /// The wheel over a point, or with Ctrl: brush or tube grow or shrink.
  /// \return whether it meant something
  bool Wheel(const std::optional<std::size_t>& point, bool is_wanted, double steps);

  base::Status DeletePoint();
  base::Status InsertPoint();  ///< halfway to the next one
  void Undo();
  void Redo();

 private:
  base::Status Paint(const render::SurfaceHit& hit);
  void DropWhatIsGone();

  anatomy::PatientDocument document_;
  std::vector<geometry::Rows> neighbours_;  // (organs)
  std::optional<std::uint32_t> tube_, point_, landmark_;
  bool is_dragging_ = false, is_stroke_erasing_ = false;
  math::Vec3 grabbed_;
};

}  // namespace trocar::editor
