// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/patient_editor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "trocar/patient/patient.h"

namespace trocar::editor {
namespace {

using math::Vec3;

constexpr double kMinBrush = 0.001, kMaxBrush = 0.040;  // m
constexpr double kWheelStep = 1.12;                     // factor a step of the wheel
constexpr render::SrgbColour kChosen = {1.0, 0.86, 0.25}, kPoint = {0.95, 0.97, 1.0}, kBrush = {1, 1, 1},
                             kErase = {1.0, 0.45, 0.4};
constexpr std::array<std::string_view, 4> kToolNames = {"look", "paint", "tubes", "landmarks"};

/// Lifts a colour towards white, so that what is chosen stands out.
render::SrgbColour Lighter(const render::SrgbColour& colour) {
  render::SrgbColour light = colour;
  for (double& each : light) each += 0.45 * (1.0 - each);
  return light;
}

}  // namespace

std::optional<EditorTool> FindEditorTool(std::string_view name) noexcept {
  for (std::size_t i = 0; i < kToolNames.size(); ++i) {
    if (kToolNames[i] == name) return static_cast<EditorTool>(i);
  }
  return std::nullopt;
}

PatientEditor::PatientEditor(anatomy::PatientDocument document) : document_(std::move(document)) {
  for (const patient::Organ& organ : GetPatient().organs)
    neighbours_.push_back(geometry::FindVertexNeighbours(organ.mesh.triangles, organ.mesh.positions.size()));
  if (const std::vector<RegionChoice> regions = Regions(); !regions.empty()) region = regions.front();
}

std::vector<RegionChoice> PatientEditor::Regions() const {
  std::vector<RegionChoice> choices;
  for (const patient::Organ& organ : GetPatient().organs) {
    std::vector<std::string> names;
    if (organ.role == roles::OrganRole::kLiver)
      names = {patient::kDiaphragmaticFace, patient::kFalciform, patient::kCoronary,
               patient::kGallbladderBed};
    if (organ.role == roles::OrganRole::kGallbladder) names = {patient::kGallbladderBed};
    for (const patient::Region& each : organ.regions) {
      if (std::find(names.begin(), names.end(), each.name) == names.end()) names.push_back(each.name);
    }
    for (std::string& name : names) choices.push_back({organ.name, std::move(name)});
  }
  return choices;
}

void PatientEditor::ChooseTube(std::optional<std::uint32_t> tube) {
  if (tube && *tube >= GetPatient().tubes.size()) tube.reset();
  if (tube != tube_) point_.reset();
  tube_ = tube;
}
void PatientEditor::ChooseTubePoint(std::optional<std::uint32_t> point) {
  if (!tube_ || (point && *point >= GetPatient().tubes[*tube_].line.points.size())) point.reset();
  point_ = point;
}
void PatientEditor::ChooseLandmark(std::optional<std::uint32_t> landmark) {
  if (landmark && *landmark >= GetPatient().landmarks.size()) landmark.reset();
  landmark_ = landmark;
}

void PatientEditor::DropWhatIsGone() {
  if (tube_ && *tube_ >= GetPatient().tubes.size()) tube_.reset();
  ChooseTubePoint(point_);
  ChooseLandmark(landmark_);
}

view::PatientFigure PatientEditor::MakeFigure(const std::optional<render::SurfaceHit>& hover) const {
  view::PatientFigureOptions options = look;
  options.has_landmarks = false;
  view::PatientFigure figure = view::MakePatientFigure(GetPatient(), options);
  const std::size_t organs = GetPatient().organs.size();
  if (tool == EditorTool::kPaint) {
    // what is painted is not what hangs around it
    for (std::size_t i = 0; i < organs; ++i)
      figure.surfaces[i].is_pickable = GetPatient().organs[i].name == region.organ;
    for (std::size_t i = organs; i < figure.surfaces.size(); ++i) figure.surfaces[i].is_pickable = false;
    if (hover && hover->surface < organs) {
      const auto& surface = figure.surfaces[hover->surface];
      const auto& t = surface.triangles[hover->triangle];
      const Vec3 normal = math::Normalized(Cross(surface.positions[t[1]] - surface.positions[t[0]],
                                                 surface.positions[t[2]] - surface.positions[t[0]]));
      const Vec3 u = math::AnyPerpendicular(normal), v = Cross(normal, u);
      render::FigureLine ring{{}, is_erasing ? kErase : kBrush, 2, true};
      constexpr int kSides = 48;
      for (int i = 0; i <= kSides; ++i) {
        const double angle = 2 * M_PI * i / kSides;
        ring.points.push_back(hover->point + brush_radius * (std::cos(angle) * u + std::sin(angle) * v));
      }
      figure.marks.lines.push_back(std::move(ring));
    }
  }
  if (tool == EditorTool::kTubes && tube_) {
    const patient::Tube& tube = GetPatient().tubes[*tube_];
    figure.surfaces[organs + *tube_].colours = {Lighter(look.colours.Of(tube))};
    figure.marks.lines.push_back({tube.line.points, kChosen, 1.5, true});
    for (std::size_t i = 0; i < tube.line.points.size(); ++i) {
      const bool is_chosen = point_ == i;
      figure.marks.points.push_back(
          {tube.line.points[i], is_chosen ? kChosen : kPoint, is_chosen ? 13.0 : 9.0, true});
    }
  }
  if (tool == EditorTool::kLandmarks) {
    for (std::size_t i = 0; i < GetPatient().landmarks.size(); ++i) {
      const bool is_chosen = landmark_ == i;
      figure.marks.points.push_back(
          {GetPatient().landmarks[i].position, is_chosen ? kChosen : kPoint, is_chosen ? 15.0 : 11.0, true});
    }
  }
  return figure;
}

base::Status PatientEditor::Paint(const render::SurfaceHit& hit) {
  const int organ = GetPatient().FindOrgan(region.organ);
  if (organ < 0 || hit.surface != static_cast<std::size_t>(organ)) return {};
  const auto brush = anatomy::FindBrushVertices(GetPatient().organs[organ].mesh, neighbours_[organ],
                                                hit.vertex, hit.point, brush_radius);
  return document_.Edit("paint", [&](patient::Patient& patient) {
    return anatomy::PaintRegion(patient, region.organ, region.region, brush, !is_stroke_erasing_);
  });
}

bool PatientEditor::Press(const std::optional<render::SurfaceHit>& surface,
                          const std::optional<std::size_t>& point, bool is_other) {
  const std::size_t organs = GetPatient().organs.size();
  switch (tool) {
    case EditorTool::kLook:
      return false;
    case EditorTool::kPaint: {
      if (!surface || surface->surface >= organs ||
          GetPatient().organs[surface->surface].name != region.organ)
        return false;
      is_stroke_erasing_ = is_erasing != is_other;
      document_.BeginGroup((is_stroke_erasing_ ? "erase " : "paint ") + region.region);
      is_dragging_ = true;
      // its error is that of any later dab, too
      (void)Paint(*surface);
      return true;
    }
    case EditorTool::kTubes: {
      if (point && tube_ && !is_other) {
        ChooseTubePoint(static_cast<std::uint32_t>(*point));
        grabbed_ = GetPatient().tubes[*tube_].line.points[*point_];
        document_.BeginGroup("move a point of " + GetPatient().tubes[*tube_].name);
        return is_dragging_ = true;
      }
      if (!surface || surface->surface < organs) return false;
      ChooseTube(static_cast<std::uint32_t>(surface->surface - organs));
      if (is_other) {
        // a new point on the piece of the line that is nearest
        const auto& points = GetPatient().tubes[*tube_].line.points;
        std::uint32_t after = 0;
        const auto reach_of = [&](std::uint32_t i) {
          return Distance(points[i], surface->point) + Distance(points[i + 1], surface->point);
        };
        for (std::uint32_t i = 1; i + 1 < points.size(); ++i) {
          if (reach_of(i) < reach_of(after)) after = i;
        }
        ChooseTubePoint(after);
        (void)InsertPoint();
      }
      is_dragging_ = false;
      return true;
    }
    case EditorTool::kLandmarks:
      if (!point) return false;
      ChooseLandmark(static_cast<std::uint32_t>(*point));
      grabbed_ = GetPatient().landmarks[*landmark_].position;
      document_.BeginGroup("move " + GetPatient().landmarks[*landmark_].name);
      return is_dragging_ = true;
  }
  return false;
}

base::Status PatientEditor::Drag(const std::optional<render::SurfaceHit>& surface, const Vec3& in_plane) {
  if (!is_dragging_) return {};
  if (tool == EditorTool::kPaint) return surface ? Paint(*surface) : base::Status();
  if (tool == EditorTool::kTubes && tube_ && point_) {
    return document_.Edit("move", [&](patient::Patient& patient) {
      return anatomy::MoveTubePoint(patient, *tube_, *point_, in_plane, reach);
    });
  }
  if (tool == EditorTool::kLandmarks && landmark_) {
    const std::string name = GetPatient().landmarks[*landmark_].name;
    return document_.Edit(
        "move", [&](patient::Patient& patient) { return anatomy::PlaceLandmark(patient, name, in_plane); });
  }
  return {};
}

void PatientEditor::Release() {
  if (is_dragging_) document_.EndGroup();
  is_dragging_ = false;
}

bool PatientEditor::Wheel(const std::optional<std::size_t>& point, bool is_wanted, double steps) {
  const double factor = std::pow(kWheelStep, steps);
  if (tool == EditorTool::kPaint && is_wanted) {
    brush_radius = std::clamp(brush_radius * factor, kMinBrush, kMaxBrush);
    return true;
  }
  if (tool != EditorTool::kTubes || !tube_) return false;
  if (point) ChooseTubePoint(static_cast<std::uint32_t>(*point));
  if (!point_ || !(point || is_wanted)) return false;
  return document_
      .Edit("radius of " + GetPatient().tubes[*tube_].name,
            [&](patient::Patient& patient) {
              return anatomy::ScaleTubeRadius(patient, *tube_, *point_, factor, reach);
            })
      .ok();
}

base::Status PatientEditor::DeletePoint() {
  if (!tube_ || !point_)
    return base::Error{base::ErrorCode::kUsage, "choose a point of a duct or artery first: click on it"};
  auto status = document_.Edit(
      "delete a point of " + GetPatient().tubes[*tube_].name,
      [&](patient::Patient& patient) { return anatomy::DeleteTubePoint(patient, *tube_, *point_); });
  DropWhatIsGone();
  return status;
}

base::Status PatientEditor::InsertPoint() {
  if (!tube_ || !point_)
    return base::Error{base::ErrorCode::kUsage, "choose a point of a duct or artery first: click on it"};
  const auto& points = GetPatient().tubes[*tube_].line.points;
  const auto after = std::min<std::uint32_t>(*point_, static_cast<std::uint32_t>(points.size() - 2));
  const Vec3 middle = 0.5 * (points[after] + points[after + 1]);
  auto status = document_.Edit(
      "insert a point into " + GetPatient().tubes[*tube_].name,
      [&](patient::Patient& patient) { return anatomy::InsertTubePoint(patient, *tube_, after, middle); });
  if (status) point_ = after + 1;
  return status;
}

void PatientEditor::Undo() {
  Release();
  document_.Undo();
  DropWhatIsGone();
}

void PatientEditor::Redo() {
  Release();
  document_.Redo();
  DropWhatIsGone();
}

}  // namespace trocar::editor
