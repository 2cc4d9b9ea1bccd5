// SPDX-License-Identifier: Apache-2.0
#include "trocar/view/patient_figure.h"

#include <algorithm>
#include <numeric>

#include "trocar/patient/patient.h"

namespace trocar::view {

using render::SrgbColour;
using roles::OrganRole;
namespace {

constexpr int kTubeSides = 14;

/// Colours of one organ's vertices: a vertex of several regions has the smallest one's.
std::vector<SrgbColour> CalcOrganColours(const patient::Organ& organ, const PatientFigureOptions& options) {
  std::vector<SrgbColour> colours(organ.mesh.positions.size(), options.colours.Of(organ.role));
  if (!options.has_regions) return colours;
  std::vector<std::size_t> order(organ.regions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return organ.regions[a].vertices.size() > organ.regions[b].vertices.size();
  });
  for (const std::size_t i : order) {
    for (const auto v : organ.regions[i].vertices) {
      if (v < colours.size()) colours[v] = options.colours.Of(organ.regions[i].role);
    }
  }
  return colours;
}

}  // namespace

PatientFigure MakePatientFigure(const patient::Patient& patient, const PatientFigureOptions& options) {
  PatientFigure figure;
  for (const patient::Organ& organ : patient.organs) {
    render::FigureSurface surface{organ.mesh.triangles, organ.mesh.positions,
                                  CalcOrganColours(organ, options)};
    surface.has_edges = options.has_edges;
    if (organ.role == OrganRole::kLiver) surface.opacity = options.liver_opacity;
    surface.is_pickable = surface.opacity > 0;
    figure.surfaces.push_back(std::move(surface));
  }
  for (const patient::Tube& tube : patient.tubes) {
    auto skin = geometry::MakeTube(tube.line, kTubeSides);
    figure.surfaces.push_back(
        {std::move(skin.triangles), std::move(skin.positions), {options.colours.Of(tube)}});
  }
  if (options.has_attachments) {
    for (const patient::Attachment& a : patient.attachments) {
      figure.marks.lines.push_back({{patient.organs[a.organ_a].mesh.positions[a.vertex_a],
                                     patient.organs[a.organ_b].mesh.positions[a.vertex_b]},
                                    options.colours.attachment,
                                    1});
    }
  }
  if (options.has_landmarks) {
    for (const patient::Landmark& landmark : patient.landmarks)
      figure.marks.points.push_back({landmark.position, options.colours.landmark, 9});
  }
  return figure;
}

}  // namespace trocar::view
