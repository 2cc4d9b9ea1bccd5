// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_read_outs.h"

#include <cmath>
#include <cstdio>
#include <map>
#include <span>

namespace trocar::editor {
namespace {

template <typename... Values>
std::string Format(const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

std::string Count(std::size_t count, const char* noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

double ShoelaceArea(std::span<const Vec2> polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    twice += a.x * b.y - b.x * a.y;
  }
  return 0.5 * std::fabs(twice);
}

std::string Thousands(std::size_t value) {
  std::string text = std::to_string(value);
  for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, ",");
  return text;
}

}  // namespace

double CalcArea(const contours::SliceFit& fit, double pixel_mm) {
  double area = 0;
  for (const auto& contour : fit.contours) area += ShoelaceArea(contour->spline);
  for (const auto& hole : fit.holes) area -= ShoelaceArea(hole->spline);
  return area * pixel_mm * pixel_mm;
}

std::string SliceTitle(const ContourEditor& editor) {
  const auto& structures = editor.Workspace().Document().Points().structures;
  std::string title = "Slice " + std::to_string(editor.Slice());
  if (editor.Structure() < static_cast<int>(structures.size())) {
    title += " \u00b7 " + structures[editor.Structure()].name;
  }
  return title;
}

std::string SliceText(ContourEditor& editor) {
  if (editor.Workspace().Document().Points().structures.empty()) return "Add an organ to begin.";
  const auto& here = editor.Here();
  if (!here.open.empty()) {
    return Count(here.open.size(), "point") + " of an open contour" +
           (here.open.size() < 3 ? "" : "; Enter or a double click closes it");
  }
  if (here.contours.empty())
    return "No contour. Click points around the organ, or carry one here from a neighbour.";
  std::size_t points = 0;
  for (const auto* group : {&here.contours, &here.holes}) {
    for (const auto& polygon : *group) points += polygon.size();
  }
  std::string text = Count(here.contours.size(), "contour");
  if (!here.holes.empty()) text += ", " + Count(here.holes.size(), "hole");
  text += " \u00b7 " + Count(points, "point");
  const auto fit = editor.Fit();
  constexpr double kSquareMmPerSquareCm = 100.0;
  if (fit.ok()) {
    text += Format(" \u00b7 %.1f cm\u00b2",
                   CalcArea(**fit, editor.Workspace().Series().pixel_mm) / kSquareMmPerSquareCm);
  }
  return text;
}

std::string SliceNotes(ContourEditor& editor) {
  const auto fit = editor.Fit();
  if (!fit.ok()) return {};
  std::map<contours::FitProblem, std::pair<std::size_t, double>> problems;  // how many, and their length
  for (const auto* group : {&(*fit)->contours, &(*fit)->holes}) {
    for (const auto& contour : *group) {
      for (const auto& note : contour->notes) {
        auto& [count, length] = problems[note.problem];
        ++count;
        length += note.length_px;
      }
    }
  }
  std::string text;
  const double pixel_mm = editor.Workspace().Series().pixel_mm;
  for (const auto& [problem, sum] : problems) {
    if (!text.empty()) text += "\n";
    text += Count(sum.first, "place") + Format(" (%.0f mm): ", sum.second * pixel_mm) +
            std::string(contours::FitProblemText(problem));
  }
  return text;
}

std::string PointerText(const ContourEditor& editor) {
  const auto& pointer = editor.Pointer();
  if (!pointer) return {};
  std::string text = Format("pixel %.1f, %.1f", pointer->x, pointer->y);
  if (const auto place = contours::FindPatientPlace(editor.Workspace().Series(), editor.Slice(), *pointer)) {
    text += Format("   LPS %.1f, %.1f, %.1f mm", (*place)[0], (*place)[1], (*place)[2]);
  }
  return text;
}

std::string SeriesText(const images::ImageSeriesInfo& series) {
  return Format("%s, %d x %d pixels of %.4g mm, slices of %.4g mm \u00b7 ", series.format.c_str(),
                series.width, series.height, series.pixel_mm, series.slice_mm) +
         "columns to " + series.axes[0] + ", rows to " + series.axes[1] + ", slices to " + series.axes[2] +
         (series.file_frame.empty() ? "" : " \u00b7 file in " + series.file_frame);
}

std::string MeshText(const std::string& name, const contours::OrganMesh& mesh) {
  return name + ": " + Thousands(mesh.mesh.triangles.size()) + Format(" triangles, %.0f mL", mesh.volume_ml) +
         (mesh.is_closed && mesh.is_manifold ? "" : ", NOT CLOSED") +
         Format(" \u00b7 %.1f mm", mesh.spacing_mm);
}

}  // namespace trocar::editor
