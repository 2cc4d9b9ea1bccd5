// SPDX-License-Identifier: Apache-2.0
/// \file state_fields.h  Joints as fields of a state.
#pragma once

#include "trocar/base/state_archive.h"
#include "trocar/instrument/trocar_kinematics.h"

namespace trocar::base {

template <>
inline constexpr bool kIsPlainState<instrument::TrocarJoints> = sizeof(instrument::TrocarJoints) ==
                                                                5 * sizeof(double);

}  // namespace trocar::base
