// SPDX-License-Identifier: Apache-2.0
/// \file patient_figure.h  A patient as a figure to look at: organs with their regions in colour, ducts,
/// arteries, landmarks and attachments.
#pragma once

#include <vector>

#include "trocar/anatomy/patient.h"
#include "trocar/render/figure.h"

namespace trocar::view {

struct PatientFigureOptions {
  bool has_regions = true;       ///< in the colours of RegionColour
  bool has_landmarks = true;     ///< a disc each
  bool has_attachments = false;  ///< a line each
  bool has_edges = false;        ///< of the organs' triangles
  double liver_opacity = 1;      ///< [0, 1]
};

struct PatientFigure {
  std::vector<render::FigureSurface> surfaces;  ///< (organs + tubes) in the patient's order
  render::FigureMarks marks;                    ///< points: the landmarks, in the patient's order
};

/// Colour of an organ's surface outside of its regions.
render::SrgbColour OrganColour(anatomy::OrganRole organ);
/// Colour of a region; another one for each role, grey for the rest.
render::SrgbColour RegionColour(anatomy::RegionRole region);
render::SrgbColour TubeColour(const anatomy::Tube& tube);

/// Colours of one organ's vertices: a vertex of several regions has the smallest one's.
std::vector<render::SrgbColour> CalcOrganColours(const anatomy::Organ& organ, bool has_regions);

PatientFigure MakePatientFigure(const anatomy::Patient& patient, const PatientFigureOptions& options = {});

}  // namespace trocar::view
