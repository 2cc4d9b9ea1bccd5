// SPDX-License-Identifier: Apache-2.0
/// \file free_camera.h  A camera that circles what the laparoscope looks at.
#pragma once

#include "trocar/math/pose.h"
#include "trocar/render/orbit_camera.h"

namespace trocar::view {

/// Stands where the laparoscope is, and turns about the point that it looks at.
render::OrbitCamera MakeFreeCamera(const math::Pose& X_world_laparoscope);
/// Looks at the same point from another side.
render::OrbitCamera MakeFreeCamera(const math::Pose& X_world_laparoscope, render::Viewpoint viewpoint);
/// As Overlay::X_world_camera takes it.
math::Pose PoseOf(const render::OrbitCamera& camera);

}  // namespace trocar::view
