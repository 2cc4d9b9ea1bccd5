// SPDX-License-Identifier: Apache-2.0
/// \file surround_patient.h  Surroundings that an assembled patient gets round its organs, whichever images it comes from.
#pragma once

#include "body_shape.h"
#include "trocar/anatomy/build_patient.h"

namespace trocar::anatomy {

/// Template neighbours for those that are not there, ports, table, and what sinks under the gas; in the patient and in what the report
/// says of it.
/// \param body    nothing in it: all that is placed by the body is placed as usual
/// \param report  with an assembled patient; its neighbours are those that were seen
void SurroundPatient(const BodyShape& body, BuildReport& report);

}  // namespace trocar::anatomy
