// SPDX-License-Identifier: Apache-2.0
/// \file patient_figure.h  A patient as a figure to look at: organs with their regions in colour, ducts,
/// arteries, landmarks and attachments.
#pragma once

#include <vector>

#include "trocar/patient/patient.h"
#include "trocar/render/figure.h"
#include "trocar/view/patient_colours.h"

namespace trocar::view {

struct PatientFigureOptions {
  bool has_regions = true;       ///< each in its colour
  bool has_landmarks = true;     ///< a disc each
  bool has_attachments = false;  ///< a line each
  bool has_edges = false;        ///< of the organs' triangles
  double liver_opacity = 1;      ///< [0, 1]
  PatientColours colours;
};

struct PatientFigure {
  std::vector<render::FigureSurface> surfaces;  ///< (organs + tubes) in the patient's order
  render::FigureMarks marks;                    ///< points: the landmarks, in the patient's order
};

PatientFigure MakePatientFigure(const patient::Patient& patient, const PatientFigureOptions& options = {});

}  // namespace trocar::view
