// SPDX-License-Identifier: Apache-2.0
/// \file level_horizon.h  The picture as an assistant holds the camera's head: with a level horizon.
#pragma once

#include "trocar/math/pose.h"

namespace trocar::presenter {

/// Turns a camera about its own axis until what stands upright in the world is upright in the picture. Looking straight down,
/// where nothing is, the patient's head is at the top; in between it goes over evenly.
///
/// \param X_world_camera  looks along -z, +y up in the picture
/// \return  the same place and direction of view
/// \note Real-time safe.
math::Pose LevelHorizon(const math::Pose& X_world_camera) noexcept;

}  // namespace trocar::presenter
