// SPDX-License-Identifier: Apache-2.0
#include "trocar/view/patient_figure.h"

#include <algorithm>
#include <numeric>

namespace trocar::view {

using anatomy::OrganRole;
using anatomy::RegionRole;
namespace {

using render::SrgbColour;

constexpr int kTubeSides = 14;
constexpr SrgbColour kAttachmentColour = {0.95, 0.93, 0.80}, kLandmarkColour = {1.0, 1.0, 1.0};

constexpr SrgbColour kOtherColour = {0.7, 0.7, 0.7};

}  // namespace

SrgbColour OrganColour(OrganRole organ) {
  if (organ == OrganRole::kLiver) return {0.66, 0.36, 0.31};
  return organ == OrganRole::kGallbladder ? SrgbColour{0.49, 0.62, 0.38} : kOtherColour;
}

SrgbColour RegionColour(RegionRole region) {
  switch (region) {
    case RegionRole::kDiaphragmaticFace:
      return {0.38, 0.57, 0.86};
    case RegionRole::kFalciform:
      return {0.97, 0.74, 0.26};
    case RegionRole::kCoronary:
      return {0.74, 0.47, 0.88};
    case RegionRole::kGallbladderBed:
      return {0.30, 0.80, 0.62};
    case RegionRole::kHeld:
    case RegionRole::kOther:
      break;
  }
  return kOtherColour;
}

SrgbColour TubeColour(const anatomy::Tube& tube) {
  if (tube.kind == anatomy::TubeKind::kArtery) return {0.88, 0.24, 0.22};
  return tube.role == anatomy::TubeRole::kCysticDuct ? SrgbColour{0.80, 0.86, 0.32}
                                                     : SrgbColour{0.58, 0.72, 0.26};
}

std::vector<SrgbColour> CalcOrganColours(const anatomy::Organ& organ, bool has_regions) {
  std::vector<SrgbColour> colours(organ.mesh.positions.size(), OrganColour(organ.role));
  if (!has_regions) return colours;
  std::vector<std::size_t> order(organ.regions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return organ.regions[a].vertices.size() > organ.regions[b].vertices.size();
  });
  for (const std::size_t i : order) {
    for (const auto v : organ.regions[i].vertices) {
      if (v < colours.size()) colours[v] = RegionColour(organ.regions[i].role);
    }
  }
  return colours;
}

PatientFigure MakePatientFigure(const anatomy::Patient& patient, const PatientFigureOptions& options) {
  PatientFigure figure;
  for (const anatomy::Organ& organ : patient.organs) {
    render::FigureSurface surface{organ.mesh.triangles, organ.mesh.positions,
                                  CalcOrganColours(organ, options.has_regions)};
    surface.has_edges = options.has_edges;
    if (organ.role == OrganRole::kLiver) surface.opacity = options.liver_opacity;
    surface.is_pickable = surface.opacity > 0;
    figure.surfaces.push_back(std::move(surface));
  }
  for (const anatomy::Tube& tube : patient.tubes) {
    auto skin = geometry::MakeTube(tube.line, kTubeSides);
    figure.surfaces.push_back({std::move(skin.triangles), std::move(skin.positions), {TubeColour(tube)}});
  }
  if (options.has_attachments) {
    for (const anatomy::Attachment& a : patient.attachments) {
      figure.marks.lines.push_back({{patient.organs[a.organ_a].mesh.positions[a.vertex_a],
                                     patient.organs[a.organ_b].mesh.positions[a.vertex_b]},
                                    kAttachmentColour,
                                    1});
    }
  }
  if (options.has_landmarks) {
    for (const anatomy::Landmark& landmark : patient.landmarks)
      figure.marks.points.push_back({landmark.position, kLandmarkColour, 9});
  }
  return figure;
}

}  // namespace trocar::view
