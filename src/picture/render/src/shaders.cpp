// SPDX-License-Identifier: Apache-2.0
#include "shaders.h"

#include <array>
#include <charconv>
#include <iterator>
#include <string>

#include "trocar/render/tone_curve.h"

namespace trocar::render {

const char* const kVersion = "#version 330 core\n";
const char* const kFine = "#define FINE\n";
const char* const kSmeared = "#define SMEARED\n";
const char* const kPlain = "#define PLAIN\n";

const char* const kSurfaceVertexShader = R"(#version 330 core
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec4 a_rest;  // rest position, ambient occlusion
layout(location = 3) in vec4 a_mark;  // blanching, charring, film of blood, film of bile
layout(location = 5) in float a_pallor;
uniform mat4 u_camera_from_surface;
uniform mat3 u_rotation;              // of the above, without its scale
uniform mat4 u_clip_from_camera;
uniform vec4 u_shade_a[10];            // capsules that shade what is near: first end, radius
uniform vec3 u_shade_b[10];            // second end
uniform int u_shade_count;
out vec3 v_position;
out vec3 v_normal;
out vec4 v_rest;                      // rest position, how open it lies here and now
out float v_open;                     // how open it lies, but for tools
out vec4 v_mark;
out float v_pallor;

// Share of the light that the tools nearby leave. Per vertex: it is soft, and a pixel costs more than a vertex.
float CalcToolShade(vec3 p, vec3 n) {
  float open = 1.0;
  for (int i = 0; i < u_shade_count; ++i) {
    vec3 a = u_shade_a[i].xyz, along = u_shade_b[i] - a;
    float t = clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0);
    vec3 to = a + t * along - p;
    float squared = dot(to, to) + 1e-9, radius = u_shade_a[i].w;
    float up = clamp(dot(n, to) * inversesqrt(squared) * 0.7 + 0.3, 0.0, 1.0);
    // close by it is as dark as a cleft; farther off a long shaft hides a share of the sky that falls with its distance
    float near = radius * inversesqrt(squared);
    open *= 1.0 - up * min(0.9, 1.7 * near * near + 0.22 * near);
  }
  return open;
}

void main() {
  vec4 position = u_camera_from_surface * vec4(a_position, 1.0);
  v_position = position.xyz;
  v_normal = u_rotation * a_normal;
  v_rest = vec4(a_rest.xyz, a_rest.w * CalcToolShade(v_position, v_normal));
  v_open = a_rest.w;
  v_mark = a_mark;
  v_pallor = a_pallor;
  gl_Position = u_clip_from_camera * position;
}
)";

const char* const kFragmentHead = R"(
in vec3 v_position;
in vec3 v_normal;
in vec4 v_rest;
out vec4 o_colour;
)";

// Shared by all that is lit: light, smoke, film and mask.
const char* const kShadingFunctions = R"(
uniform vec3 u_light;        // head light beside the lens
uniform float u_power;       // of the light, in units that a surface 0.1 m away shows unchanged
uniform vec3 u_mask;         // centre x, y and radius [pixels]; radius 0: none
uniform vec2 u_smoke;        // how thick [1/m], how far it has drifted [-]
uniform float u_exposure;    // of the camera [-]

// Light at a distance whose inverse is given. The bundle of fibres is wide, so that it does not burn out at the lens.
float CalcLight(float inverse_distance, float cosine_to_axis) {
  float squared = inverse_distance * inverse_distance;
  return u_power * 0.0109 * squared / (1.0 + 0.0009 * squared) * (0.35 + 0.65 * cosine_to_axis * cosine_to_axis);
}

// The head light on smoke between lens and tissue.
vec3 AddSmoke(vec3 light, vec3 position) {
  vec2 at = 6.0 * position.xy / -position.z;
  float swirl = sin(at.x + u_smoke.y + 1.3 * sin(at.y - 0.7 * u_smoke.y)) + sin(1.7 * at.y - u_smoke.y + sin(1.9 * at.x));
  float clear = exp2(u_smoke.x * position.z * (1.0 + 0.22 * swirl));
  return mix(kSmoke * min(u_power, 1.5), light, clear);
}

// Exposure, film curve (tone_curve.h), the lens's darker rim, the mask's soft edge. The curve rises everywhere and stays
// below 1, and strong light loses its colour: nothing turns a highlight grey or black.
vec3 Finish(vec3 light, vec3 position, vec2 pixel) {
  if (u_smoke.x > 0.0) light = AddSmoke(light, position);
  light = clamp(light * u_exposure, 0.0, kMostLight);
  float strongest = max(max(light.r, light.g), light.b), squared = strongest * strongest;
  light += (strongest - light) * (squared / (squared + kWhitening * kWhitening));
  light = light * (light + kFilm.x) / (light * (light + kFilm.y) + kFilm.z);
  if (u_mask.z > 0.0) {
    float r = distance(pixel, u_mask.xy) / u_mask.z;
    light *= (1.0 - 0.45 * r * r * r * r) * clamp((1.0 - r) * 60.0, 0.0, 1.0);
  }
  return sqrt(light);
}

vec4 WithBrightness(vec3 colour) { return vec4(colour, dot(colour, vec3(0.299, 0.587, 0.114))); }
)";

const char* const kTissueFragmentShader = R"(
const float kGrainScale = 2.1, kGrainTilt = 0.22;
const float kBroadGloss = 150.0;  // exponent; a broader highlight than that has no white middle
in vec4 v_mark;
in float v_pallor;
uniform sampler3D u_pattern;
uniform sampler3D u_bumps;
uniform vec3 u_low, u_high, u_cell, u_vessel, u_wrap;
uniform vec3 u_detail_scale;
uniform float u_broad_scale, u_bump_scale;
uniform vec3 u_amounts;      // cell, vessel, vessel width
uniform float u_bump, u_glow;
uniform vec3 u_gloss;        // wet, wet exponent, sheen

void main() {
  vec4 detail = texture(u_pattern, v_rest.xyz * u_detail_scale);
  vec4 broad = texture(u_pattern, v_rest.xyz * u_broad_scale + vec3(0.31, 0.17, 0.53));
  vec4 bumps = texture(u_bumps, v_rest.xyz * u_bump_scale);
  vec3 slope = bumps.xyz * 2.0 - 1.0;

  // the lamp is a few millimetres from the lens: its direction to first order, nearly of unit length
  float inverse_distance = inversesqrt(dot(v_position, v_position));
  vec3 n = normalize(v_normal);
  vec3 to_eye = -inverse_distance * v_position;
  vec3 l = to_eye + inverse_distance * u_light;
  float facing = max(dot(n, to_eye), 0.0);
  slope -= n * dot(n, slope);
  vec3 bumpy = normalize(n - u_bump * slope);
  float to_lamp = dot(bumpy, l);

  vec3 albedo = mix(u_low, u_high, clamp(0.55 * detail.r + 1.1 * broad.r - 0.32, 0.0, 1.0));
  albedo = mix(albedo, u_cell, u_amounts.x * (1.0 - detail.a));
  float vessel = clamp((broad.b - 1.0 + u_amounts.z) / u_amounts.z, 0.0, 1.0);
  // branches are a third as wide as stems, and paler
  float branch = clamp((detail.b - 1.0 + 0.6 * u_amounts.z) / (0.6 * u_amounts.z), 0.0, 1.0);
  albedo = mix(albedo, u_vessel, u_amounts.y * max(vessel * vessel, 0.55 * branch * branch));
  // stretched tissue is white, its vessels are empty; patches of it whiten first
  albedo = mix(albedo, kPallor, v_pallor * (0.55 + 0.45 * detail.r));
  // a thin wall seen edge-on is brighter and paler
  float rim = 1.0 - facing;
  albedo += u_glow * rim * rim * (vec3(0.5) * albedo + kThinRim);

  float wet_share = u_gloss.x, sheen_share = u_gloss.z;
  if (v_mark != vec4(0.0)) {
    // the edges of a burn and of a film of liquid follow the tissue's grain
    float grain = 0.5 * detail.r + 0.5 * broad.r - 0.5;
    // a burn's marks stand at vertices: what is ragged between them hides the triangles
    float ragged = grain + 0.8 * (bumps.a - 0.5) - 0.5 * (detail.g - 0.5);
    float cooked = smoothstep(0.0, 1.0, v_mark.x + 0.8 * ragged * sqrt(v_mark.x));
    albedo = mix(albedo, kBlanched * (0.6 + 0.6 * detail.r) * mix(vec3(1.0), sqrt(albedo), 0.7), 0.7 * cooked);
    vec2 film = smoothstep(0.10, 0.75, v_mark.zw + 0.5 * grain);
    // a thin film colours what is under it, a thick one hides it
    albedo *= mix(vec3(1.0), sqrt(kBileFilm), film.y);
    albedo = mix(albedo, kBileFilm, 0.6 * film.y * film.y);
    albedo *= mix(vec3(1.0), sqrt(kBloodFilm), film.x);
    albedo = mix(albedo, kBloodFilm, 0.85 * film.x * film.x);
    float brown = smoothstep(0.03, 0.45, v_mark.y + 0.9 * ragged * sqrt(v_mark.y));
    float black = smoothstep(0.42, 0.95, v_mark.y + 0.9 * ragged * sqrt(v_mark.y));
    albedo = mix(mix(albedo, kScorched, brown), kCharred, black);
    wet_share = mix(mix(wet_share, max(wet_share, 0.8), max(film.x, film.y)), 0.12, max(brown, 0.6 * cooked));
    sheen_share *= 1.0 - 0.85 * brown;
  }

  float ambient = v_rest.w;
  float light = CalcLight(inverse_distance, to_eye.z);
  vec3 diffuse = clamp((vec3(to_lamp) + u_wrap) / (1.0 + u_wrap), 0.0, 1.0);
  // folds and the shade of tools stay reddish: light reaches them through tissue
  vec3 shade = mix(kShade, vec3(1.0), ambient);
  float half_cosine = max(0.5 * (to_lamp + dot(bumpy, to_eye)), 0.0);
  // the wet coat has a smoother surface of its own; it pools in hollows and thins out between them
  vec3 coat = normalize(n - 0.35 * u_bump * slope + 0.16 * (vec3(detail.r, broad.r, detail.g) - 0.5));
  float coat_cosine = max(0.5 * (dot(coat, l) + dot(coat, to_eye)), 0.0);
  float island = 1.0;
#ifdef FINE
  // near the middle of a highlight the grain beneath shows through the coat: it breaks one large white into many small
  float nearness = smoothstep(0.970, 0.990, coat_cosine);
  if (u_gloss.y > kBroadGloss && nearness > 0.0) {
    vec4 grain = textureLod(u_bumps, v_rest.xyz * (kGrainScale * u_bump_scale) + vec3(0.37, 0.11, 0.71), 0.0);
    vec3 tilt = grain.xyz * 2.0 - 1.0;
    coat = normalize(coat - (nearness * min(u_bump, 0.26)) * (kGrainTilt * (tilt - n * dot(n, tilt)) + 0.75 * slope));
    coat_cosine = max(0.5 * (dot(coat, l) + dot(coat, to_eye)), 0.0);
    // where it stands out of the coat it is dry
    island = 1.0 - nearness * min(1.0, 4.0 * u_bump) * (0.6 - 0.6 * smoothstep(0.46, 0.70, grain.a));
  }
#endif
  float sharpness = u_gloss.y;
#ifdef FINE
  // a highlight smaller than a pixel is spread over it (Tokuyoshi and Kaplanyan 2019)
  vec3 turn_x = dFdx(n), turn_y = dFdy(n);
  float spread = min(0.25 * (dot(turn_x, turn_x) + dot(turn_y, turn_y)), 0.09);
  float softened = 1.0 / (1.0 + 1.4 * sharpness * spread);
  sharpness *= softened;
#else
  float softened = 1.0;
#endif
  float thickness = smoothstep(0.28, 0.66, 0.6 * detail.r + 0.4 * broad.g) * (0.35 + 1.3 * broad.r);
  float wet = 1.6 * wet_share * island * softened * exp2(sharpness * (coat_cosine - 1.0)) * thickness * ambient;
  float sheen = sheen_share * exp2(18.0 * (half_cosine - 1.0));
  vec3 bounce = kBounce * (0.4 + 0.6 * ambient);
  vec3 colour = albedo * (diffuse * shade * light + bounce * (0.4 + light)) + (wet + sheen) * min(light, 1.35) * kTissueHighlight;
  o_colour = WithBrightness(Finish(2.1 * colour, v_position, gl_FragCoord.xy));
}
)";

const char* const kToolFragmentShader = R"(
const float kGroovesPerMetre = 11000.0;  // radians: 0.57 mm from one to the next
const vec3 kWorn = vec3(0.9, 0.95, 1.0);
in float v_open;
uniform vec3 u_low, u_high;
uniform vec3 u_gloss;        // wet, wet exponent, sheen
#ifdef PLAIN
uniform vec2 u_lines;        // printed lines: how many a metre along each edge, how dark
#else
uniform sampler3D u_pattern;
uniform float u_grooves;     // depth of fine grooves across the shaft
uniform float u_wear;        // scratches and rubbed places that are lighter than the rest
#endif
uniform vec3 u_axis;         // of the shaft, along which it was polished
uniform vec3 u_room;         // what is mirrored from all round
uniform vec4 u_overhead;     // lamp of a box trainer: direction to it, power
uniform vec4 u_shade_a[10];   // capsules and, below, lying rings that take its light
uniform vec3 u_shade_b[10];
uniform int u_shade_count;
uniform vec4 u_ring[12];     // centre, radius
uniform int u_ring_count;
uniform float u_ring_section;

// Share of the overhead light that reaches a place: shadows are the softer the higher what casts them.
float CalcOverheadShade(vec3 p) {
  vec3 up = u_overhead.xyz;
  float open = 1.0;
  for (int i = 0; i < u_shade_count; ++i) {
    vec3 a = u_shade_a[i].xyz - p, along = u_shade_b[i] - u_shade_a[i].xyz;
    float rise = dot(along, up), start = dot(a, up);
    vec3 flat_a = a - start * up, flat_along = along - rise * up;
    float t = clamp(-dot(flat_a, flat_along) / (dot(flat_along, flat_along) + 1e-9), 0.0, 1.0);
    vec3 aside = flat_a + t * flat_along;
    float height = start + t * rise, radius = u_shade_a[i].w, soft = 0.6 * radius + 0.22 * max(height, 0.0);
    float cover = clamp((radius + soft - length(aside)) / (2.0 * soft), 0.0, 1.0);
    open *= 1.0 - 0.75 * cover * cover * (radius / (radius + 0.06 * max(height, 0.0))) * step(0.6 * radius, height);
  }
  for (int i = 0; i < u_ring_count; ++i) {
    vec3 to = u_ring[i].xyz - p;
    float height = dot(to, up), soft = 0.5 * u_ring_section + 0.22 * max(height, 0.0);
    float aside = abs(length(to - height * up) - u_ring[i].w);
    float cover = clamp((u_ring_section + soft - aside) / (2.0 * soft), 0.0, 1.0);
    open *= 1.0 - 0.7 * cover * cover * (u_ring_section / (u_ring_section + 0.06 * max(height, 0.0))) * step(0.6 * u_ring_section, height);
  }
  return open;
}

#ifdef PLAIN
// Share of a pixel that printed lines cover: thin ones at each tile, broader ones at each fifth.
float CalcLines(vec3 place) {
  float most = 0.0;
  for (int i = 0; i < 3; ++i) {
    float at = place[i], width = fwidth(at);
    if (width < 1e-5) continue;  // a face square to this axis has no such lines
    float fine = abs(fract(at + 0.5) - 0.5), broad = 5.0 * abs(fract(0.2 * at + 0.5) - 0.5);
    float cover = max(0.7 * clamp((0.022 + 0.5 * width - fine) / width, 0.0, 1.0) * min(1.0, 0.044 / width),
                      clamp((0.035 + 0.5 * width - broad) / width, 0.0, 1.0) * min(1.0, 0.07 / width));
    most = max(most, cover);
  }
  return most;
}
#endif

void main() {
  float inverse_distance = inversesqrt(dot(v_position, v_position));
  vec3 n = normalize(v_normal);
  vec3 to_eye = -inverse_distance * v_position;
  vec3 l = normalize(to_eye + inverse_distance * u_light);
  vec3 h = normalize(l + to_eye);
  float light = CalcLight(inverse_distance, to_eye.z);
  float facing = max(dot(n, to_eye), 0.0);

  // steel is brushed across the shaft; on insulation the trocar's valve has drawn scratches along it; both are worn where
  // they are touched
  float pattern = 1.0, grooves = 1.0, unevenness = 0.0;
#ifdef PLAIN
  if (u_lines.x > 0.0) pattern -= u_lines.y * CalcLines(u_lines.x * v_rest.xyz);
#else
  bool is_metal = u_grooves > 0.0;
  float metal = is_metal ? 1.0 : 0.0;
  vec4 clouds = texture(u_pattern, 45.0 * v_rest.xyz);
  vec4 streaks = texture(u_pattern, (is_metal ? vec3(9.0, 9.0, 760.0) : vec3(170.0, 170.0, 7.0)) * v_rest.xyz);
  pattern = 1.0 + metal * (0.5 * (streaks.r - 0.5) + 0.5 * (clouds.r - 0.5));
  unevenness = metal * 0.05 * (streaks.r - 0.5);
  // grooves too fine for the picture become an even grey
  if (is_metal) {
    float groove = v_rest.z * kGroovesPerMetre;
    grooves -= u_grooves * (0.5 + 0.5 * sin(groove) * clamp(1.6 - 0.7 * fwidth(groove), 0.0, 1.0));
  }
#endif

  // what it mirrors: tissue or box all round, the dark middle of the lens; only metal gives it the colour of tissue
  vec3 mirrored = 2.0 * dot(n, to_eye) * n - to_eye;
  float away = 0.5 - 0.5 * mirrored.z;
  vec3 room = mix(kMirroredLens, u_room, away * away) * (0.55 + 0.45 * mirrored.y);
  room = mix(vec3(dot(room, vec3(0.30, 0.55, 0.15))), room, 0.15 + 0.60 * smoothstep(0.1, 0.3, u_gloss.z));

  float cosine = clamp(dot(n, l), 0.0, 1.0);
  float along = dot(u_axis, h) + unevenness;
  float streak = exp2(-u_gloss.y * along * along) * cosine * cosine;
  float point = exp2(4.0 * u_gloss.y * (max(dot(n, h), 0.0) - 1.0));
  float rim = 1.0 - facing;
  vec3 base = mix(u_low, u_high, cosine * cosine) * pattern;
#ifndef PLAIN
  if (u_wear > 0.0) {
    float scratch = clamp(11.0 * streaks.b - 9.9, 0.0, 1.0) * clamp(4.0 * clouds.r - 1.6, 0.0, 1.0);
    base += u_wear * (0.033 * scratch + 0.015 * clamp(2.9 * clouds.r - 1.3, 0.0, 1.0)) * kWorn;
  }
#endif
  vec3 colour = base * (0.55 * cosine * (0.5 + 0.5 * v_open) + 0.04 * v_open) * light * grooves;
  colour += (u_gloss.z + 0.12 * rim * rim * rim) * room * pattern * (0.25 + 0.75 * min(light, 1.5));
  colour += u_gloss.x * (0.30 * streak * pattern + 0.8 * point) * min(light, 2.0) * kMetalHighlight;
  if (u_overhead.w > 0.0) {
    float up = dot(n, u_overhead.xyz), open = CalcOverheadShade(v_position);
    colour = colour * (0.6 + 0.4 * open) + u_overhead.w * mix(u_low, u_high, 0.75) * pattern * open *
              ((0.30 + 0.20 * up) * v_open + 0.5 * max(up, 0.0) * (0.4 + 0.6 * v_open));
    colour += u_overhead.w * u_gloss.z * open * room * max(mirrored.y, 0.0);
  }
  o_colour = WithBrightness(Finish(1.6 * colour, v_position, gl_FragCoord.xy));
}
)";

const char* const kScreenVertexShader = R"(#version 330 core
layout(location = 0) in vec3 a_position;  // of the mask's ring: z 0 is the inner edge
uniform vec2 u_inner;
void main() { gl_Position = vec4(a_position.xy * u_inner, 0.0, 1.0); }
)";

const char* const kSmoothFragmentShader = R"(
out vec4 o_colour;
uniform sampler2D u_picture;  // alpha: brightness
uniform vec2 u_texel;         // of it
uniform vec2 u_size;          // of the target, which may be larger [pixels]
#ifdef FINE
uniform sampler2D u_glow;     // light that the lens scatters about highlights

// Along an edge that is nearly upright or level, so that it has smaller steps (T. Lottes, FXAA, NVIDIA 2009); where the farther taps reach
// beyond the edge, which their brightness tells, the nearer ones count. `around` is better for what stands slanting, and for thin lines.
vec3 BlurAlong(vec2 at, float here, vec3 around) {
  float nw = texture(u_picture, at + vec2(-1.0, 1.0) * u_texel).a;
  float ne = texture(u_picture, at + vec2(1.0, 1.0) * u_texel).a;
  float sw = texture(u_picture, at + vec2(-1.0, -1.0) * u_texel).a;
  float se = texture(u_picture, at + vec2(1.0, -1.0) * u_texel).a;
  float low = min(here, min(min(nw, ne), min(sw, se))), high = max(here, max(max(nw, ne), max(sw, se)));
  vec2 edge = vec2(sw + se - nw - ne, ne + se - nw - sw);
  float less = min(abs(edge.x), abs(edge.y)), more = max(abs(edge.x), abs(edge.y));
  vec2 along = clamp(edge / (less + max(0.03125 * (nw + ne + sw + se), 0.0078)), -8.0, 8.0);
  float straight = clamp(more / (2.0 * (high - low) + 0.001), 0.0, 1.0) * clamp(0.25 * max(abs(along.x), abs(along.y)) - 0.5, 0.0, 1.0);
  along *= u_texel;
  vec4 near = 0.5 * (texture(u_picture, at - along / 6.0) + texture(u_picture, at + along / 6.0));
  vec4 far = 0.5 * near + 0.25 * (texture(u_picture, at - 0.5 * along) + texture(u_picture, at + 0.5 * along));
  return mix(around, far.a < low || far.a > high ? near.rgb : far.rgb, straight);
}
#endif
#ifdef SMEARED
uniform vec4 u_blots[6];      // what sticks to the lens: centre, radius [heights of the picture], how thick
const vec3 kSmearTint = vec3(1.0, 0.80, 0.74);

// How thick the smear is at a place: thick in the middle, with a lobed and uneven edge.
float CalcSmear(vec2 place) {
  float thick = 0.0;
  for (int i = 0; i < 6; ++i) {
    if (u_blots[i].z <= 0.0) continue;
    vec2 to = place - u_blots[i].xy;
    float turn = atan(to.y, to.x) + 5.0 * u_blots[i].x;
    float lobes = 1.0 + 0.16 * sin(2.0 * turn) + 0.12 * sin(3.0 * turn + 1.7) + 0.07 * sin(7.0 * turn);
    float streaks = 0.86 + 0.14 * sin(210.0 * to.x + 70.0 * to.y + 3.0 * sin(40.0 * to.y));
    thick = max(thick, u_blots[i].w * streaks * (1.0 - smoothstep(0.30, 1.0, length(to) / (u_blots[i].z * lobes))));
  }
  return thick;
}

// Out of focus: light from all round comes to each place, and the smear shines a little of its own.
vec3 SeeThroughSmear(vec2 at, vec2 shape, float thick) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 16; ++i) {
    float turn = 2.399963 * float(i), far = 0.085 * thick * sqrt((float(i) + 0.5) / 16.0);
    sum += texture(u_picture, at + far * vec2(cos(turn), sin(turn)) / shape).rgb;
  }
  vec3 blurred = 0.0625 * sum;
  float grey = dot(blurred, vec3(0.299, 0.587, 0.114));
  return mix(blurred, kSmearTint * (0.10 + 0.80 * grey), 0.55 * thick);
}
#endif
void main() {
  vec2 at = gl_FragCoord.xy / u_size;
  vec4 here = texture(u_picture, at);
  // each tap lies between four pixels, so that together they blur a pixel a little
  vec4 nw = texture(u_picture, at + vec2(-0.5, 0.5) * u_texel);
  vec4 ne = texture(u_picture, at + vec2(0.5, 0.5) * u_texel);
  vec4 sw = texture(u_picture, at + vec2(-0.5, -0.5) * u_texel);
  vec4 se = texture(u_picture, at + vec2(0.5, -0.5) * u_texel);
  float low = min(min(nw.a, ne.a), min(sw.a, se.a));
  float high = max(max(nw.a, ne.a), max(sw.a, se.a));
  float share = clamp((high - low - 0.03) * 16.0, 0.0, 1.0);
  vec3 smoothed = 0.25 * (nw.rgb + ne.rgb + sw.rgb + se.rgb);
#ifdef FINE
  if (share > 0.0) smoothed = BlurAlong(at, here.a, smoothed);
#endif
  vec3 colour = mix(here.rgb, smoothed, share);
#ifdef SMEARED
  vec2 shape = vec2(u_texel.y / u_texel.x, 1.0);
  float thick = CalcSmear((at - 0.5) * shape);
  if (thick > 0.0) colour = mix(colour, SeeThroughSmear(at, shape, thick), smoothstep(0.0, 0.25, thick));
#endif
#ifdef FINE
  // added as on a screen: it comes nearer to white and never beyond
  colour += (1.0 - colour) * 0.45 * texture(u_glow, at).rgb;
#endif
  o_colour = vec4(colour, 1.0);
}
)";

const char* const kFullVertexShader = R"(#version 330 core
layout(location = 0) in vec3 a_position;  // of the mask's ring, which covers the picture when it is large enough
void main() { gl_Position = vec4(3.0 * a_position.xy, 0.0, 1.0); }
)";

const char* const kGlowFragmentShader = R"(#version 330 core
out vec4 o_colour;
uniform sampler2D u_picture;
uniform vec2 u_texel;  // of the target
uniform vec2 u_step;   // between taps, in the source; 0, 0: the first pass, which keeps what is bright
void main() {
  vec2 at = gl_FragCoord.xy * u_texel;
  vec3 sum = vec3(0.0);
  if (u_step == vec2(0.0)) {
    for (int i = 0; i < 4; ++i) {
      vec3 light = texture(u_picture, at + (vec2(i & 1, i >> 1) - 0.5) * 0.5 * u_texel).rgb;
      float bright = max(max(light.r, light.g), light.b);
      sum += light * smoothstep(0.86, 1.0, bright);
    }
    o_colour = vec4(0.25 * sum, 1.0);
    return;
  }
  for (int i = -4; i <= 4; ++i) sum += (0.205 - 0.047 * abs(float(i))) * texture(u_picture, at + float(i) * u_step).rgb;
  o_colour = vec4(min(sum, 1.0), 1.0);
}
)";

const char* const kMaskVertexShader = R"(#version 330 core
layout(location = 0) in vec3 a_position;  // x, y: direction; z: 0 inner, 1 outer edge
uniform vec2 u_inner;                     // half axes of the picture's circle in clip space
void main() {
  vec2 edge = a_position.xy * (a_position.z > 0.5 ? vec2(4.0) : u_inner);
  gl_Position = vec4(edge, -1.0, 1.0);
}
)";

const char* const kMaskFragmentShader = R"(#version 330 core
out vec4 o_colour;
uniform vec3 u_colour;
void main() { o_colour = vec4(u_colour, 1.0); }
)";

namespace {

/// A number as GLSL reads it: as many digits as tell it from every other, and no locale's comma.
std::string FormatFloat(double number) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
  std::string text(digits.data(), end);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

}  // namespace

std::string MakeEffectColours(const Looks& looks) {
  static constexpr const char* kNames[] = {
      "kSmoke",           "kBlanched",       "kScorched",     "kCharred",        "kBloodFilm",
      "kBileFilm",        "kPallor",         "kThinRim",      "kShade",          "kBounce",
      "kTissueHighlight", "kMetalHighlight", "kMirroredLens", "kMirroredTissue", "kMirroredWall",
      "kMirroredBox",     "kStrandShade"};
  static_assert(std::size(kNames) == static_cast<std::size_t>(Effect::kCount));
  std::string source;
  for (std::size_t i = 0; i < looks.effects.size(); ++i) {
    source += std::string("const vec3 ") + kNames[i] + " = vec3(";
    for (std::size_t k = 0; k < 3; ++k) {
      source.append(k == 0 ? "" : ", ").append(FormatFloat(looks.effects[i][k]));
    }
    source += ");\n";
  }
  source += "const vec3 kFilm = vec3(" + FormatFloat(kFilmA) + ", " + FormatFloat(kFilmB) + ", " +
            FormatFloat(kFilmC) + ");\n";
  source += "const float kMostLight = " + FormatFloat(kMostLight) +
            ", kWhitening = " + FormatFloat(kWhitening) + ";\n";
  return source;
}

}  // namespace trocar::render
