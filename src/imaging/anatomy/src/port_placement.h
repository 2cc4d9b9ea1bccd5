// SPDX-License-Identifier: Apache-2.0
/// \file port_placement.h  Where the instruments of this body go in, how the table is tilted, and why.
/// Source of sites, tilt and rules of thumb: docs/patients.md names them.
#pragma once

#include <string>
#include <vector>

#include "body_shape.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

/// x of the spine: measured, else as usual from the fundus [m].
double FindMidline(const patient::Patient& patient, const BodyShape& body);

/// Sets ports and table. Where the map shows spine or vertebrae, or what lies behind the wall, the patient is moved so that its
/// origin is the navel on the insufflated wall, as everywhere; else it stays, and the ports are the usual ones.
/// \param patient  with fundus and infundibulum (TROCAR_ASSERT)
void PlacePorts(const BodyShape& body, patient::Patient& patient);

/// Bowel and stomach sink from between the ports and the gallbladder, as they do under gas: each column of the body is moved backwards as
/// a whole, which keeps all volumes.
/// \return sentences: what sank, and how far
std::vector<std::string> SinkUnderGas(patient::Patient& patient);

}  // namespace trocar::anatomy
