// SPDX-License-Identifier: Apache-2.0
#include "fine_shaders.h"

namespace trocar::render {

// A ribbon that faces the eye. The normal that it passes on is that of a round thread.
const char* const kFibreVertexShader = R"(#version 330 core
layout(location = 0) in vec3 a_place;   // along 0 to 1, across -1 or 1
layout(location = 1) in vec3 i_a;       // ends, world
layout(location = 2) in vec3 i_b;
layout(location = 3) in vec4 i_shape;   // half width, wave, seed 0 to 1, emission
layout(location = 4) in vec4 i_colour;  // albedo, wetness
layout(location = 5) in float i_opacity;
uniform mat4 u_camera_from_surface;
uniform mat4 u_clip_from_camera;
uniform float u_least;                  // half width that is still seen, as a share of the distance
out vec3 v_position;
out vec3 v_normal;
out vec4 v_rest;                        // nothing, how open it lies
out vec4 v_albedo;
out vec2 v_passing;                     // emission, opacity

void main() {
  vec3 a = (u_camera_from_surface * vec4(i_a, 1.0)).xyz, b = (u_camera_from_surface * vec4(i_b, 1.0)).xyz;
  float t = a_place.x, seed = 6.2831853 * i_shape.z;
  vec3 chord = b - a;
  vec3 along = chord * inversesqrt(dot(chord, chord) + 1e-12);
  vec3 u = normalize(cross(along, vec3(0.36, 0.48, 0.80)) + vec3(1e-6)), w = cross(along, u);
  // two waves that vanish at the ends
  float p = seed + (5.0 + 4.0 * fract(7.13 * i_shape.z)) * t, q = 2.3 * seed + 8.0 * t;
  float bell = i_shape.y * 4.0 * t * (1.0 - t);
  vec3 centre = a + t * chord + bell * (sin(p) * u + 0.7 * sin(q) * w);
  vec3 tangent = chord + bell * 6.0 * (cos(p) * u + 0.7 * cos(q) * w);
  vec3 to_eye = normalize(-centre);
  vec3 across = cross(tangent, to_eye);
  across *= inversesqrt(dot(across, across) + 1e-16);
  // broader where it takes root
  float root = 2.0 * t - 1.0;
  float half_width = max(i_shape.x * (0.62 + 0.38 * root * root), -u_least * centre.z);
  vec3 position = centre + a_place.y * half_width * across;
  v_position = position;
  v_normal = 0.85 * a_place.y * across + 0.53 * to_eye;
  v_rest = vec4(0.0, 0.0, 0.0, 1.0);
  v_albedo = i_colour;
  v_passing = vec2(i_shape.w, i_opacity);
  gl_Position = u_clip_from_camera * vec4(position, 1.0);
}
)";

// A dome that faces the eye.
const char* const kBlobVertexShader = R"(#version 330 core
layout(location = 0) in vec3 a_place;   // on a half ball of radius 1, z towards the eye
layout(location = 1) in vec3 i_a;       // centre, world
layout(location = 3) in vec4 i_shape;   // radius, nothing, seed 0 to 1, emission
layout(location = 4) in vec4 i_colour;
layout(location = 5) in float i_opacity;
uniform mat4 u_camera_from_surface;
uniform mat4 u_clip_from_camera;
uniform float u_least;
out vec3 v_position;
out vec3 v_normal;
out vec4 v_rest;
out vec4 v_albedo;
out vec2 v_passing;                     // emission, opacity

void main() {
  vec3 centre = (u_camera_from_surface * vec4(i_a, 1.0)).xyz;
  vec3 to_eye = normalize(-centre);
  float turn = 6.2831853 * i_shape.z;
  vec3 s = normalize(cross(to_eye, vec3(sin(turn), cos(turn), 0.01))), t = cross(to_eye, s);
  float radius = max(i_shape.x, -u_least * centre.z), slim = 0.80 + 0.35 * fract(11.7 * i_shape.z);
  // lumpy: no two alike
  float angle = atan(a_place.y, a_place.x + 1e-6);
  float lump = 1.0 + 0.13 * sin(2.0 * angle + 3.0 * turn) + 0.10 * sin(3.0 * angle + 7.0 * turn);
  vec3 local = a_place * vec3(lump * slim, lump / slim, 1.0);
  vec3 position = centre + radius * (local.x * s + local.y * t + 0.6 * local.z * to_eye);
  v_position = position;
  v_normal = a_place.x * s + a_place.y * t + a_place.z * to_eye;
  // its rim sinks into what it lies on
  v_rest = vec4(0.0, 0.0, 0.0, 0.70 + 0.30 * a_place.z);
  v_albedo = i_colour;
  v_passing = vec2(i_shape.w, i_opacity);
  gl_Position = u_clip_from_camera * vec4(position, 1.0);
}
)";

const char* const kFineFragmentShader = R"(
in vec4 v_albedo;            // colour, wetness
in vec2 v_passing;           // emission, opacity

void main() {
  float inverse_distance = inversesqrt(dot(v_position, v_position));
  vec3 to_eye = -inverse_distance * v_position;
  // the lamp is beside the lens: the light comes from where the eye is
  float facing = clamp(dot(normalize(v_normal), to_eye), 0.0, 1.0);
  float light = CalcLight(inverse_distance, to_eye.z);
  vec3 shade = mix(vec3(0.42, 0.30, 0.24), vec3(1.0), v_rest.w * (0.5 + 0.5 * facing));
  float wet = v_albedo.a * facing * facing;
  wet *= wet;
  wet *= wet;
  wet *= wet;
  vec3 colour = v_albedo.rgb * shade * (0.05 + light) + v_albedo.a * wet * min(light, 2.0) + v_passing.x * v_albedo.rgb;
  o_colour = WithBrightness(Finish(2.1 * colour));
  // a film is clearest where it is seen square on
  if (v_passing.y < 1.0) o_colour.a = min(1.0, v_passing.y * (1.3 - 0.5 * facing) + 0.6 * v_albedo.a * wet);
}
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
  vec3 mirrored = (0.015 + 0.30 * rim * rim * rim) * vec3(0.50, 0.26, 0.20) * (0.3 + 0.7 * min(light, 1.5));
  vec3 colour = albedo * (0.25 + 0.75 * facing) * (0.05 + light) + mirrored + (0.6 * point + u_gloss.z * facing * facing) * min(light, 2.0);
  float opacity = clamp(u_opacity * (1.0 + 1.2 * rim * rim) * v_rest.w + 0.8 * point * v_rest.w, 0.0, 1.0);
  o_colour = vec4(Finish(2.1 * colour), opacity);
}
)";

}  // namespace trocar::render
