// SPDX-License-Identifier: Apache-2.0
/// \file camera.h  What a tick knows of the laparoscope's camera.
#pragma once

#include "trocar/math/pose.h"

namespace trocar::simulation {

/// The picture's camera.
struct Camera {
  math::Pose X_world_camera;  ///< looks along -z
  double field_of_view = 0;   ///< whole, diagonal [rad]
};

}  // namespace trocar::simulation
