// SPDX-License-Identifier: Apache-2.0
#include "trocar/instrument/camera.h"

#include <cmath>

#include "trocar/math/elementary.h"

namespace trocar::instrument {

bool IsInView(const math::Pose& X_world_camera, double field_of_view, const math::Vec3& p_world) noexcept {
  const math::Vec3 p = math::Inverse(X_world_camera) * p_world;
  return -p.z > 0 && -p.z >= math::Cos(0.5 * field_of_view) * math::Norm(p);
}

}  // namespace trocar::instrument
