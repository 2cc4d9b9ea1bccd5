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
uniform sampler3D u_bumps;
uniform vec3 u_low, u_high;  // where it is deep, where it is shallow or seen edge-on
uniform vec3 u_gloss;        // wet, wet exponent, sheen
uniform float u_opacity;     // seen square on, where it is deep
uniform float u_bump_scale, u_bump;  // ripples of a liquid, creases of a sheet

void main() {
  float inverse_distance = inversesqrt(dot(v_position, v_position));
  vec3 to_eye = -inverse_distance * v_position;
  vec3 smooth_n = normalize(v_normal);
  vec3 slope = texture(u_bumps, v_rest.xyz * u_bump_scale).xyz * 2.0 - 1.0;
  vec3 n = normalize(smooth_n - u_bump * (slope - smooth_n * dot(smooth_n, slope)));
  vec3 l = normalize(to_eye + inverse_distance * u_light);
  vec3 h = normalize(l + to_eye);
  float light = CalcLight(inverse_distance, to_eye.z);
  float facing = abs(dot(n, to_eye)), rim = 1.0 - facing, deep = min(v_rest.w * v_rest.w, 1.0);
  vec3 albedo = mix(u_high, u_low, facing * deep);
  float point = u_gloss.x * exp2(u_gloss.y * (abs(dot(n, h)) - 1.0));
  float broad = exp2(0.08 * u_gloss.y * (abs(dot(n, h)) - 1.0));
  // what it mirrors: tissue all round, which is bright where the head light falls on it, on the lens's side
  vec3 mirrored = 2.0 * dot(n, to_eye) * n - to_eye;
  float lit = 0.25 + 0.75 * smoothstep(-0.2, 0.9, mirrored.z) + 0.5 * mirrored.y * mirrored.y;
  vec3 room = (0.03 + 0.60 * rim * rim * rim) * lit * kMirroredWall * (0.3 + 0.7 * min(light, 1.5));
  vec3 colour = albedo * (0.25 + 0.75 * facing) * (0.05 + light) + u_gloss.x * room;
  colour += (0.6 * point + u_gloss.z * broad) * min(light, 2.0);
  float opacity = clamp((u_opacity * (1.0 + 1.2 * rim * rim) + 0.8 * point + 0.6 * u_gloss.z * broad) * v_rest.w, 0.0, 1.0);
  o_colour = vec4(Finish(2.1 * colour, v_position, gl_FragCoord.xy), opacity);
}
)";

}  // namespace trocar::render
