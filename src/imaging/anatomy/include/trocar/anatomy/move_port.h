// SPDX-License-Identifier: Apache-2.0
/// \file move_port.h  A port of a patient is put elsewhere on the insufflated wall, as far as the rules of placing allow.
#pragma once

#include "trocar/base/result.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

/// The port at another place of the wall, with its new reason; the patient stays as it is. The rules are those of the proposal
/// (docs/patients.md): distances from the gallbladder's neck, from other ports, from ribs and the liver's edge. Where the proposal had to
/// break one, a place that breaks it no more than that is taken.
/// \param x, y  of the wall, to the left and cranial from the navel [m]
/// \return kEditRefused with the rule that the place would break
base::Result<patient::Port> MovePort(const patient::Patient& patient, patient::PortUse use, double x,
                                     double y);

}  // namespace trocar::anatomy
