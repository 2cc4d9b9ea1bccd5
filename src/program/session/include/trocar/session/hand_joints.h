// SPDX-License-Identifier: Apache-2.0
/// \file hand_joints.h  Conversion of the five joints between a device's sample and an instrument.
#pragma once

#include "trocar/device/hand_sample.h"
#include "trocar/instrument/trocar_kinematics.h"

namespace trocar::session {

/// \note Real-time safe, as the one below.
inline instrument::TrocarJoints JointsOf(const device::HandSample& sample) noexcept {
  return {sample.pan, sample.tilt, sample.spin, sample.depth, sample.jaw};
}

/// \return a sample of time 0 that is not valid yet
inline device::HandSample SampleOf(const instrument::TrocarJoints& joints) noexcept {
  device::HandSample sample;
  sample.pan = joints.pan;
  sample.tilt = joints.tilt;
  sample.spin = joints.spin;
  sample.depth = joints.depth;
  sample.jaw = joints.jaw;
  return sample;
}

}  // namespace trocar::session
