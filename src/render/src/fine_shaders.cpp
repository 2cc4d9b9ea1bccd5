// SPDX-License-Identifier: Apache-2.0
#include "fine_shaders.h"

namespace trocar::render {

const char* const kFineVertexHead = R"(#version 330 core
layout(location = 0) in vec3 a_position;  // in the camera's frame
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec4 a_albedo;    // and wetness
layout(location = 3) in vec3 a_passing;   // emission, opacity, how open it lies
uniform mat4 u_clip_from_camera;
out vec4 v_colour;
)";

const char* const kFineVertexShader = R"(
void main() {
  gl_Position = u_clip_from_camera * vec4(a_position, 1.0);
  float inverse_distance = inversesqrt(dot(a_position, a_position));
  vec3 to_eye = -inverse_distance * a_position;
  // the lamp is beside the lens: the light comes from where the eye is
  float facing = clamp(dot(a_normal, to_eye), 0.0, 1.0);
  float light = CalcLight(inverse_distance, to_eye.z);
  vec3 shade = mix(kStrandShade, vec3(1.0), a_passing.z * (0.5 + 0.5 * facing));
  float wet = a_albedo.a * facing * facing;
  wet *= wet;
  wet *= wet;
  wet *= wet;
  vec3 colour = a_albedo.rgb * (shade * (0.05 + light) + a_passing.x) + a_albedo.a * wet * min(light, 2.0);
  // the mask's centre is the picture's
  vec2 pixel = (1.0 + gl_Position.xy / gl_Position.w) * u_mask.xy;
  v_colour = WithBrightness(Finish(2.1 * colour, a_position, pixel));
  // a film is clearest where it is seen square on
  if (a_passing.y < 1.0) v_colour.a = min(1.0, a_passing.y * (1.3 - 0.5 * facing + 2.0 * a_albedo.a * wet));
}
)";

const char* const kFineFragmentShader = R"(#version 330 core
in vec4 v_colour;
out vec4 o_colour;
void main() { o_colour = v_colour; }
)";

const char* const kClearVertexShader = R"(#version 330 core
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec4 a_rest;  // rest position, share of the opacity
uniform mat4 u_camera_from_surface;
uniform mat3 u_rotation;
uniform mat4 u_clip_from_camera;
out vec3 v_position;
out vec3 v_normal;
out vec4 v_rest;

void main() {
  vec4 position = u_camera_from_surface * vec4(a_position, 1.0);
  v_position = position.xyz;
  v_normal = u_rotation * a_normal;
  v_rest = a_rest;
  gl_Position = u_clip_from_camera * position;
}
)";

const char* const kClearFragmentShader = R"(
uniform vec3 u_low, u_high;
uniform vec3 u_gloss;        // wet, wet exponent, sheen
uniform float u_opacity;     // seen square on

void main() {
  float inverse_distance = inversesqrt(dot(v_position, v_position));
  // faint ripples: a place on a puddle counts in its radius
  vec3 n = normalize(v_normal + 0.05 * vec3(sin(11.0 * v_rest.x + 3.0 * v_rest.y), sin(9.0 * v_rest.y - 5.0 * v_rest.x), 0.0));
  vec3 to_eye = -inverse_distance * v_position;
  vec3 l = normalize(to_eye + inverse_distance * u_light);
  vec3 h = normalize(l + to_eye);
  float light = CalcLight(inverse_distance, to_eye.z);
  float facing = abs(dot(n, to_eye)), rim = 1.0 - facing;
  vec3 albedo = mix(u_high, u_low, facing);
  float point = u_gloss.x * exp2(u_gloss.y * (abs(dot(n, h)) - 1.0));
  // what it mirrors: the warm wall all round
  vec3 mirrored = (0.015 + 0.30 * rim * rim * rim) * kMirroredWall * (0.3 + 0.7 * min(light, 1.5));
  vec3 colour = albedo * (0.25 + 0.75 * facing) * (0.05 + light) + mirrored + (0.6 * point + u_gloss.z * facing * facing) * min(light, 2.0);
  float opacity = clamp(u_opacity * (1.0 + 1.2 * rim * rim) * v_rest.w + 0.8 * point * v_rest.w, 0.0, 1.0);
  o_colour = vec4(Finish(2.1 * colour, v_position, gl_FragCoord.xy), opacity);
}
)";

}  // namespace trocar::render
