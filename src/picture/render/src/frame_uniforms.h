// SPDX-License-Identifier: Apache-2.0
/// \file frame_uniforms.h  Uniforms that stay the same for a whole picture: light, smoke, shades, projection.
#pragma once

#include "shader_program.h"
#include "trocar/math/pose.h"
#include "trocar/render/frame.h"
#include "trocar/render/looks.h"

namespace trocar::render {

/// Sets them in one program, which becomes the current one.
/// \param exposure       of the camera [-]
/// \param width, height  of the picture [pixels]
void SetFrameUniforms(const Program& program, const Looks& looks, const Frame& frame,
                      const math::Pose& X_camera_world, double exposure, int width, int height);

}  // namespace trocar::render
