// SPDX-License-Identifier: Apache-2.0
/// \file stand_in_gate.h  The real gate lies further down the house; here a test sends what it likes to a stand-in.
#pragma once

#include "trocar/device/force_driver.h"

namespace trocar::haptics {

class ForceGate {
 public:
  static device::GatedForce Make(const math::Vec3& force) { return device::GatedForce(force); }
};

}  // namespace trocar::haptics
