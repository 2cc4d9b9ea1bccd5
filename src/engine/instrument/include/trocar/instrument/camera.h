// SPDX-License-Identifier: Apache-2.0
/// \file camera.h  The laparoscope's camera, and what is in its picture.
#pragma once

#include "trocar/math/pose.h"

namespace trocar::instrument {

struct Camera {
  math::Pose X_world_camera;  ///< looks along -z
  double field_of_view = 0;   ///< whole, diagonal [rad]
};

/// Whether a point lies in the round picture. What hides it is not asked.
/// \param field_of_view  across the round picture [rad]
/// \note Real-time safe.
bool IsInView(const math::Pose& X_world_camera, double field_of_view, const math::Vec3& p_world) noexcept;

}  // namespace trocar::instrument
