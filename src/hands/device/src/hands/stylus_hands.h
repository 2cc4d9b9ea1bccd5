// SPDX-License-Identifier: Apache-2.0
/// \file stylus_hands.h  A haptic device as any other device: to try it, to record it, or to hold instruments with it,
/// without force.
#pragma once

#include <memory>

#include "trocar/device/driver.h"

namespace trocar::device {

class ForceDriver;

/// Hands of a haptic device's styluses. Nothing is ever sent but what the device's own driver sends where no force is asked
/// for: zero.
///
/// \param device  1 (right hand) or 2 channels (left, right), unconfigured (TROCAR_ASSERT)
/// \return a driver of kChannelCount channels
std::unique_ptr<Driver> MakeStylusHands(std::unique_ptr<ForceDriver> device);

}  // namespace trocar::device
