// SPDX-License-Identifier: Apache-2.0
/// \file camera_matrices.h  Poses and the camera's projection as the matrices that shaders take.
#pragma once

#include "shader_program.h"
#include "trocar/math/pose.h"
#include "trocar/render/frame.h"

namespace trocar::render {

/// A pose after scaling along the surface's own x, y, z [-].
Matrix4 MakeMatrix(const math::Pose& pose, const math::Vec3& scale = {1, 1, 1});

Matrix3 MakeRotation(const math::Quaternion& rotation);

/// Pixels per unit of tangent: the camera's angle spans the round picture.
/// \param height  of the picture [pixels]
double CalcFocalLength(const Camera& camera, int height);

/// From the camera's frame (looking along -z, y up) to clip space.
/// \param width, height  of the picture [pixels]
Matrix4 MakeProjection(const Camera& camera, int width, int height);

}  // namespace trocar::render
