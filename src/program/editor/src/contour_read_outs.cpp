// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_read_outs.h"

#include <cmath>
#include <cstdio>
#include <map>
#include <span>

#include "trocar/host/translate.h"

namespace trocar::editor {
namespace {

template <typename... Values>
std::string Format(const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof(text), format, values...);
  return host::LocalNumber(text);
}

double ShoelaceArea(std::span<const math::Vec2> polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const math::Vec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    twice += a.x * b.y - b.x * a.y;
  }
  return 0.5 * std::fabs(twice);
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
  std::string title = host::TranslateWith("Slice {1}", {std::to_string(editor.Slice())});
  if (editor.Structure() < static_cast<int>(structures.size())) {
    title += " \u00b7 " + host::Translate(structures[editor.Structure()].name);
  }
  return title;
}

std::string SliceText(ContourEditor& editor) {
  if (editor.Workspace().Document().Points().structures.empty())
    return host::Translate("Add an organ to begin.");
  const auto& here = editor.Here();
  if (!here.open.empty()) {
    std::string text = host::TranslateCount("{1} point of an open contour", "{1} points of an open contour",
                                            here.open.size());
    if (here.open.size() >= 3) text += host::Translate("; Enter or a double click closes it");
    return text;
  }
  if (here.contours.empty())
    return host::Translate("No contour. Click points around the organ, or carry one here from a neighbour.");
  std::size_t points = 0;
  for (const auto* group : {&here.contours, &here.holes}) {
    for (const auto& polygon : *group) points += polygon.size();
  }
  std::string text = host::TranslateCount("{1} contour", "{1} contours", here.contours.size());
  if (!here.holes.empty()) text += ", " + host::TranslateCount("{1} hole", "{1} holes", here.holes.size());
  text += " \u00b7 " + host::TranslateCount("{1} point", "{1} points", points);
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
    text += host::TranslateCount("{1} place", "{1} places", sum.first) +
            Format(" (%.0f mm): ", sum.second * pixel_mm) +
            host::Translate(contours::FitProblemText(problem));
  }
  return text;
}

std::string PointerText(const ContourEditor& editor) {
  const auto& pointer = editor.Pointer();
  if (!pointer) return {};
  std::string text =
      host::TranslateWith("pixel {1}, {2}", {Format("%.1f", pointer->x), Format("%.1f", pointer->y)});
  if (const auto place = contours::FindPatientPlace(editor.Workspace().Series(), editor.Slice(), *pointer)) {
    text += host::TranslateWith(
        "   LPS {1}, {2}, {3} mm",
        {Format("%.1f", (*place)[0]), Format("%.1f", (*place)[1]), Format("%.1f", (*place)[2])});
  }
  return text;
}

std::string SeriesNotes(const images::ImageSeriesInfo& series) {
  std::string text;
  for (const std::string& note : series.notes)
    text += (text.empty() ? "" : " \u00b7 ") + host::TranslateComposed(note);
  return text;
}

std::string SeriesText(const images::ImageSeriesInfo& series) {
  std::string text =
      host::TranslateWith("{1}, {2} x {3} pixels of {4} mm, slices of {5} mm",
                          {series.format, std::to_string(series.width), std::to_string(series.height),
                           Format("%.4g", series.pixel_mm), Format("%.4g", series.slice_mm)});
  text += " \u00b7 " + host::TranslateWith("columns to {1}, rows to {2}, slices to {3}",
                                           {host::Translate(series.axes[0]), host::Translate(series.axes[1]),
                                            host::Translate(series.axes[2])});
  if (!series.file_frame.empty())
    text += " \u00b7 " + host::TranslateWith("file in {1}", {series.file_frame});
  if (const std::string notes = SeriesNotes(series); !notes.empty()) text += " \u00b7 " + notes;
  return text;
}

std::string MeshText(const std::string& name, const contours::OrganMesh& mesh) {
  return host::TranslateWith("{1}: {2} triangles, {3} mL",
                             {host::Translate(name), host::LocalCount(mesh.mesh.triangles.size()),
                              Format("%.0f", mesh.volume_ml)}) +
         (mesh.is_closed && mesh.is_manifold ? "" : host::Translate(", NOT CLOSED")) +
         Format(" \u00b7 %.1f mm", mesh.spacing_mm);
}

}  // namespace trocar::editor
