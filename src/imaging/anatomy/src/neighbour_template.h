// SPDX-License-Identifier: Apache-2.0
/// \file neighbour_template.h  Neighbours that a map does not show, placed by landmarks and the size of the body.
#pragma once

#include <vector>

#include "trocar/patient/patient.h"

namespace trocar::anatomy {

/// The neighbours that the patient lacks, but for ribs and small bowel, which are not drawn: closed tubes and balls. Lengths
/// along the body follow liver and gallbladder, widths the liver's size; they are laid so that they keep out of the
/// patient's organs and of the neighbours that are seen.
///
/// \param patient  with liver, gallbladder, fundus and infundibulum (TROCAR_ASSERT)
/// \param midline  x of the spine [m]
/// \return neighbours with is_seen = false
/// Source: proportions as in the phantom's body (phantom_tissue.cpp), drawn by eye after axial anatomy; tunables.
std::vector<patient::Neighbour> MakeTemplateNeighbours(const patient::Patient& patient, double midline);

}  // namespace trocar::anatomy
