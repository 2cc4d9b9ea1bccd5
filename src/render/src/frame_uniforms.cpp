// SPDX-License-Identifier: Apache-2.0
#include "frame_uniforms.h"

#include <algorithm>
#include <cmath>

#include "camera_matrices.h"
#include "single_precision.h"

namespace trocar::render {
namespace {

using math::Vec3;

void SetShades(const Program& program, const std::vector<Shade>& shades, const math::Pose& X_camera_world) {
  std::array<float, 4 * kMaxShades> first{};
  std::array<float, 3 * kMaxShades> second{};
  const std::size_t count = std::min(shades.size(), kMaxShades);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 a = X_camera_world * shades[i].a;
    Vec3 b = X_camera_world * shades[i].b;
    if (a == b) b.z += 1e-6;  // the shader divides by the length
    for (std::size_t k = 0; k < 3; ++k) {
      first[4 * i + k] = ToFloat(a[static_cast<int>(k)]);
      second[3 * i + k] = ToFloat(b[static_cast<int>(k)]);
    }
    first[4 * i + 3] = ToFloat(shades[i].radius);
  }
  glUniform4fv(program.Find("u_shade_a"), kMaxShades, first.data());
  glUniform3fv(program.Find("u_shade_b"), kMaxShades, second.data());
  program.Set("u_shade_count", static_cast<int>(count));
}

}  // namespace

void SetFrameUniforms(const Program& program, const Looks& looks, const Frame& frame,
                      const math::Pose& X_camera_world, int width, int height) {
  glUseProgram(program.name);
  program.Set("u_clip_from_camera", MakeProjection(frame.camera, width, height));
  program.Set("u_light", ToFloat(looks.light_offset));
  program.Set("u_power", ToFloat(std::max(0.0, frame.light_power)));
  program.Set("u_smoke", std::array<float, 2>{ToFloat(looks.smoke * std::clamp(frame.smoke, 0.0, 1.0)),
                                              ToFloat(std::fmod(0.6 * frame.time, 200.0 * M_PI))});
  program.Set("u_mask", Colour{ToFloat(0.5 * width), ToFloat(0.5 * height),
                               frame.has_mask ? ToFloat(0.5 * kMaskDiameter * height) : 0.0f});
  SetShades(program, frame.shades, X_camera_world);
}

}  // namespace trocar::render
