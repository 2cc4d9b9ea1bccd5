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

/// The lamp in the lid, the rings that it finds in its way, and what metal mirrors in such a box.
void SetOverhead(const Program& program, const Looks& looks, const Frame& frame,
                 const math::Pose& X_camera_world) {
  const Vec3 up = math::Rotate(X_camera_world.rotation, frame.overhead.up);
  const bool is_on = frame.overhead.power > 0.0;
  glUniform4f(program.Find("u_overhead"), ToFloat(up.x), ToFloat(up.y), ToFloat(up.z),
              ToFloat(std::max(0.0, frame.overhead.power)));
  std::array<float, 4 * kMaxRingShades> rings{};
  const std::size_t count = is_on ? std::min(frame.ring_shades.size(), kMaxRingShades) : 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 centre = X_camera_world * frame.ring_shades[i].centre;
    for (int k = 0; k < 3; ++k) rings[4 * i + static_cast<std::size_t>(k)] = ToFloat(centre[k]);
    rings[4 * i + 3] = ToFloat(frame.ring_shades[i].radius);
  }
  glUniform4fv(program.Find("u_ring"), kMaxRingShades, rings.data());
  program.Set("u_ring_count", static_cast<int>(count));
  program.Set("u_ring_section", ToFloat(std::max(1e-4, frame.ring_section)));
  const auto& room =
      looks.effects[static_cast<std::size_t>(is_on ? Effect::kMirroredBox : Effect::kMirroredTissue)];
  program.Set("u_room", Colour{ToFloat(room[0]), ToFloat(room[1]), ToFloat(room[2])});
}

}  // namespace

void SetFrameUniforms(const Program& program, const Looks& looks, const Frame& frame,
                      const math::Pose& X_camera_world, double exposure, int width, int height) {
  glUseProgram(program.name);
  program.Set("u_clip_from_camera", MakeProjection(frame.camera, width, height));
  program.Set("u_light", ToFloat(looks.light_offset));
  program.Set("u_power", ToFloat(std::max(0.0, frame.light_power)));
  program.Set("u_smoke", std::array<float, 2>{ToFloat(looks.smoke * std::clamp(frame.smoke, 0.0, 1.0)),
                                              ToFloat(std::fmod(0.6 * frame.time, 200.0 * M_PI))});
  program.Set("u_mask", Colour{ToFloat(0.5 * width), ToFloat(0.5 * height),
                               frame.has_mask ? ToFloat(0.5 * kMaskDiameter * height) : 0.0f});
  program.Set("u_exposure", ToFloat(exposure));
  SetShades(program, frame.shades, X_camera_world);
  SetOverhead(program, looks, frame, X_camera_world);
}

}  // namespace trocar::render
