// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/renderer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <limits>

#include "fine_drawer.h"
#include "fine_shaders.h"
#include "material_look.h"
#include "noise.h"
#include "shader_program.h"
#include "shaders.h"
#include "trocar/core/assert.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/tube.h"

namespace trocar::render {
namespace {

using geometry::Triangle;
using math::Pose;
using math::Vec3;

constexpr double kNear = 0.004;                 // m, in front of the lens
constexpr double kFar = 1.0;                    // m, beyond any abdomen
constexpr Vec3 kLightOffset{0, 0.0035, 0.001};  // m, camera frame: the fibres leave beside the lens
constexpr double kOverlayDepth = 0.01;          // share of the depth buffer that is kept for arrows
constexpr int kNoiseSide = 64;                  // texels
constexpr int kMaskSegments = 128;
constexpr int kFanFirst = 2 * (kMaskSegments + 1);  // vertex after the ring's strip
constexpr double kThickSmoke = 22.0;  // 1/m: half of the light is lost on 45 mm where smoke is 1
constexpr int kPuddleSides = 40, kPuddleRings = 6;
constexpr double kPuddleDome = 0.035;                             // rise of a puddle's middle, in its radius
constexpr double kArrowHeadLength = 4.5, kArrowHeadRadius = 2.4;  // in radii of the arrow's shaft

struct Axes {
  Vec3 x, y, z;
};
Axes CalcAxes(const math::Quaternion& rotation) {
  return {math::Rotate(rotation, {1, 0, 0}), math::Rotate(rotation, {0, 1, 0}),
          math::Rotate(rotation, {0, 0, 1})};
}

float F(double value) {
  return static_cast<float>(value);
}

/// Pose after scaling along x, y, z.
Matrix4 MakeMatrix(const Pose& pose, const Vec3& scale = {1, 1, 1}) {
  const auto [x, y, z] = CalcAxes(pose.rotation);
  const Vec3 t = pose.translation;
  return {F(x.x * scale.x), F(x.y * scale.x), F(x.z * scale.x), 0,
          F(y.x * scale.y), F(y.y * scale.y), F(y.z * scale.y), 0,
          F(z.x * scale.z), F(z.y * scale.z), F(z.z * scale.z), 0,
          F(t.x),           F(t.y),           F(t.z),           1};
}

Matrix3 MakeRotation(const math::Quaternion& rotation) {
  const auto [x, y, z] = CalcAxes(rotation);
  return {F(x.x), F(x.y), F(x.z), F(y.x), F(y.y), F(y.z), F(z.x), F(z.y), F(z.z)};
}

/// Pixels per unit of tangent: the angle spans the round picture.
double CalcFocalLength(const Camera& camera, int height) {
  return 0.5 * kMaskDiameter * height / std::tan(0.5 * std::clamp(camera.field_of_view, 0.1, 2.8));
}

Matrix4 MakeProjection(const Camera& camera, int width, int height) {
  const double focal = CalcFocalLength(camera, height);
  Matrix4 m{};
  m[0] = F(2.0 * focal / width);
  m[5] = F(2.0 * focal / height);
  m[10] = F(-(kFar + kNear) / (kFar - kNear));
  m[11] = -1;
  m[14] = F(-2.0 * kFar * kNear / (kFar - kNear));
  return m;
}

/// A vertex of the streamed buffer and one of the constant buffer.
struct MovingVertex {
  std::array<float, 3> position, normal;
};
struct RestVertex {
  std::array<float, 3> rest;
  float openness;
};
std::array<float, 3> ToFloat(const Vec3& v) {
  return {F(v.x), F(v.y), F(v.z)};
}

struct Surface {
  std::uint32_t generation = 0;  // odd while in use
  Material material = Material::kLiver;
  GLuint array = 0, moving = 0, rest = 0, indices = 0;
  GLuint marks = 0;  // 0: it has none
  GLsizei index_count = 0;
  std::size_t vertex_count = 0;
};

GLuint MakeNoiseTexture(int side, const std::vector<std::uint8_t>& texels) {
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_3D, texture);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTexImage3D(GL_TEXTURE_3D, 0, GL_RGBA8, side, side, side, 0, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R}) {
    glTexParameteri(GL_TEXTURE_3D, wrap, GL_REPEAT);
  }
  glBindTexture(GL_TEXTURE_3D, 0);
  return texture;
}

/// Rod and cone along +z with radius and length 1, so that each can be scaled along its axis.
geometry::TriangleMesh MakeUnitRod() {
  return geometry::MakeTube({{{0, 0, 0}, {0, 0, 1}}, {1.0, 1.0}}, 16);
}
geometry::TriangleMesh MakeUnitCone() {
  return geometry::MakeTube({{{0, 0, 0}, {0, 0, 1}}, {1.0, 0.02}}, 16);
}

/// Level liquid of radius about 1 with an uneven shore, domed by surface tension, facing +z.
geometry::TriangleMesh MakeUnitPuddle() {
  geometry::TriangleMesh mesh;
  mesh.positions.push_back({0, 0, kPuddleDome});
  for (int ring = 1; ring <= kPuddleRings; ++ring) {
    // rings crowd at the shore, where the surface bends
    const double share = std::sqrt(static_cast<double>(ring) / kPuddleRings);
    for (int side = 0; side < kPuddleSides; ++side) {
      const double angle = 2.0 * M_PI * side / kPuddleSides;
      const double shore = 1.0 + 0.10 * std::sin(2 * angle + 0.7) + 0.07 * std::sin(3 * angle + 2.1) +
                           0.04 * std::sin(5 * angle);
      mesh.positions.push_back({share * shore * std::cos(angle), share * shore * std::sin(angle),
                                kPuddleDome * (1.0 - std::pow(share, 6))});
    }
  }
  const auto at = [](int ring, int side) {
    return static_cast<std::uint32_t>(1 + (ring - 1) * kPuddleSides + side % kPuddleSides);
  };
  for (int side = 0; side < kPuddleSides; ++side) {
    mesh.triangles.push_back({0, at(1, side), at(1, side + 1)});
    for (int ring = 1; ring < kPuddleRings; ++ring) {
      mesh.triangles.push_back({at(ring, side), at(ring + 1, side), at(ring + 1, side + 1)});
      mesh.triangles.push_back({at(ring, side), at(ring + 1, side + 1), at(ring, side + 1)});
    }
  }
  return mesh;
}

/// What a puddle looks like: it is as clear as its liquids by their shares, and as coloured as their pigments.
MaterialLook MixLook(const Puddle& puddle) {
  const std::array<Material, 3> liquids = {Material::kBlood, Material::kBile, Material::kRinse};
  const std::array<double, 3> amounts = {puddle.blood, puddle.bile, puddle.rinse};
  constexpr std::array<double, 3> kPigment = {8.0, 1.5,
                                              0.1};  // how strongly each colours what it is mixed with
  double all = 0, pigment = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    all += amounts[i];
    pigment += kPigment[i] * amounts[i];
  }
  MaterialLook mixed = GetLook(Material::kBlood);
  if (!(all > 0.0)) return mixed;
  mixed.low = mixed.high = {};
  mixed.opacity = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const MaterialLook& look = GetLook(liquids[i]);
    const float colour = F(kPigment[i] * amounts[i] / pigment);
    for (std::size_t k = 0; k < 3; ++k) {
      mixed.low[k] += colour * look.low[k];
      mixed.high[k] += colour * look.high[k];
    }
    mixed.opacity += F(amounts[i] / all) * look.opacity;
  }
  return mixed;
}

}  // namespace

struct Renderer::Content {
  Program tissue, tool, clear, mask, smooth;
  FineDrawer fine;
  GLuint pattern = 0, bumps = 0;
  GLuint mask_array = 0, mask_vertices = 0;
  // the picture before its edges are smoothed
  GLuint framebuffer = 0, picture = 0, depth = 0;
  int picture_width = 0, picture_height = 0;
  std::vector<Surface> surfaces;
  SurfaceId rod, cone, puddle;
  std::vector<MovingVertex> staging;  // kept, so that a frame does not allocate

  Content() = default;
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;
  ~Content() {
    for (Surface& surface : surfaces) Free(surface);
    for (const Program& program : {tissue, tool, clear, mask, smooth}) glDeleteProgram(program.name);
    glDeleteTextures(1, &pattern);
    glDeleteTextures(1, &bumps);
    glDeleteVertexArrays(1, &mask_array);
    glDeleteBuffers(1, &mask_vertices);
    glDeleteFramebuffers(1, &framebuffer);
    glDeleteTextures(1, &picture);
    glDeleteRenderbuffers(1, &depth);
  }

  static void Free(Surface& surface) {
    if (surface.generation % 2 == 0) return;
    glDeleteVertexArrays(1, &surface.array);
    for (const GLuint buffer : {surface.moving, surface.rest, surface.indices, surface.marks})
      glDeleteBuffers(1, &buffer);
    surface.marks = 0;
    ++surface.generation;
  }

  Surface* FindSurface(SurfaceId id) {
    if (id.generation % 2 == 0 || id.index >= surfaces.size()) return nullptr;
    Surface& surface = surfaces[id.index];
    return surface.generation == id.generation ? &surface : nullptr;
  }

  void UploadMoving(const Surface& surface, std::span<const Vec3> positions, std::span<const Vec3> normals) {
    staging.resize(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i)
      staging[i] = {ToFloat(positions[i]), ToFloat(normals[i])};
    const auto bytes = static_cast<GLsizeiptr>(staging.size() * sizeof(MovingVertex));
    glBindBuffer(GL_ARRAY_BUFFER, surface.moving);
    // a fresh store, so that the driver need not wait for the frame that still reads the old one
    glBufferData(GL_ARRAY_BUFFER, bytes, nullptr, GL_STREAM_DRAW);
    glBufferSubData(GL_ARRAY_BUFFER, 0, bytes, staging.data());
    glBindBuffer(GL_ARRAY_BUFFER, 0);
  }

  static void UploadMarks(Surface& surface, std::span<const SurfaceMark> marks) {
    if (surface.marks == 0) {
      glGenBuffers(1, &surface.marks);
      glBindVertexArray(surface.array);
      glBindBuffer(GL_ARRAY_BUFFER, surface.marks);
      glEnableVertexAttribArray(3);
      glVertexAttribPointer(3, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(SurfaceMark), nullptr);
      glBindVertexArray(0);
    }
    glBindBuffer(GL_ARRAY_BUFFER, surface.marks);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(marks.size_bytes()), marks.data(), GL_STREAM_DRAW);
    glBindBuffer(GL_ARRAY_BUFFER, 0);
  }

  void UploadTriangles(Surface& surface, std::span<const Triangle> triangles) {
    for (const Triangle& t : triangles) {
      TROCAR_ASSERT(t[0] < surface.vertex_count && t[1] < surface.vertex_count &&
                    t[2] < surface.vertex_count);
    }
    surface.index_count = static_cast<GLsizei>(3 * triangles.size());
    glBindVertexArray(surface.array);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, surface.indices);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(triangles.size_bytes()), triangles.data(),
                 GL_STATIC_DRAW);
    glBindVertexArray(0);
  }

  void MakeMask() {
    std::vector<std::array<float, 3>> ring;
    for (int i = 0; i <= kMaskSegments; ++i) {
      const double angle = 2.0 * M_PI * i / kMaskSegments;
      ring.push_back({F(std::cos(angle)), F(std::sin(angle)), 0});
      ring.push_back({F(std::cos(angle)), F(std::sin(angle)), 1});
    }
    for (int i = 0; i <= kMaskSegments; ++i) ring.push_back(ring[static_cast<std::size_t>(2 * i)]);
    glGenVertexArrays(1, &mask_array);
    glGenBuffers(1, &mask_vertices);
    glBindVertexArray(mask_array);
    glBindBuffer(GL_ARRAY_BUFFER, mask_vertices);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(ring.size() * sizeof ring[0]), ring.data(),
                 GL_STATIC_DRAW);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
    glBindVertexArray(0);
    glBindBuffer(GL_ARRAY_BUFFER, 0);
  }

  /// Half axes of the picture's circle in clip space.
  static std::array<float, 2> CalcCircle(int width, int height) {
    return {F(kMaskDiameter * height / width), F(kMaskDiameter)};
  }

  void DrawMask(int width, int height) {
    glUseProgram(mask.name);
    mask.Set("u_inner", CalcCircle(width, height));
    mask.Set("u_colour", Colour{0, 0, 0});
    glBindVertexArray(mask_array);
    glDrawArrays(GL_TRIANGLE_STRIP, 0, kFanFirst);
  }

  /// Makes the own framebuffer the target.
  /// \return false where the driver refuses it
  bool BindPicture(int width, int height) {
    if (framebuffer == 0) {
      glGenFramebuffers(1, &framebuffer);
      glGenTextures(1, &picture);
      glGenRenderbuffers(1, &depth);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    if (width == picture_width && height == picture_height) return true;
    glBindTexture(GL_TEXTURE_2D, picture);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
      glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
    glBindTexture(GL_TEXTURE_2D, 0);
    glBindRenderbuffer(GL_RENDERBUFFER, depth);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
    glBindRenderbuffer(GL_RENDERBUFFER, 0);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, picture, 0);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth);
    const bool is_complete = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
    picture_width = is_complete ? width : 0;
    picture_height = is_complete ? height : 0;
    return is_complete;
  }

  /// Copies the picture into the bound framebuffer with soft edges; outside the circle it is black.
  void DrawSmoothed(bool has_mask, int width, int height) {
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glUseProgram(smooth.name);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, picture);
    smooth.Set("u_picture", 0);
    smooth.Set("u_texel", std::array<float, 2>{F(1.0 / width), F(1.0 / height)});
    // without a mask a circle round the whole picture
    const double wide = 1.5 * std::hypot(width, height);
    smooth.Set("u_inner", has_mask ? CalcCircle(width, height)
                                   : std::array<float, 2>{F(wide / width), F(wide / height)});
    glBindVertexArray(mask_array);
    glDrawArrays(GL_TRIANGLE_FAN, kFanFirst, kMaskSegments + 1);
    glBindTexture(GL_TEXTURE_2D, 0);
  }

  /// Uniforms that stay the same for the whole frame.
  void SetFrame(const Program& program, const Frame& frame, const Pose& X_camera_world,
                const Matrix4& projection, int width, int height) {
    glUseProgram(program.name);
    program.Set("u_clip_from_camera", projection);
    program.Set("u_light", ToFloat(kLightOffset));
    program.Set("u_power", F(std::max(0.0, frame.light_power)));
    program.Set("u_smoke", std::array<float, 2>{F(kThickSmoke * std::clamp(frame.smoke, 0.0, 1.0)),
                                                F(std::fmod(0.6 * frame.time, 200.0 * M_PI))});
    program.Set("u_mask", Colour{F(0.5 * width), F(0.5 * height),
                                 frame.has_mask ? F(0.5 * kMaskDiameter * height) : 0.0f});
    std::array<float, 4 * kMaxShades> first{};
    std::array<float, 3 * kMaxShades> second{};
    const std::size_t count = std::min(frame.shades.size(), kMaxShades);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 a = X_camera_world * frame.shades[i].a;
      Vec3 b = X_camera_world * frame.shades[i].b;
      if (a == b) b.z += 1e-6;  // the shader divides by the length
      for (std::size_t k = 0; k < 3; ++k) {
        first[4 * i + k] = F(a[static_cast<int>(k)]);
        second[3 * i + k] = F(b[static_cast<int>(k)]);
      }
      first[4 * i + 3] = F(frame.shades[i].radius);
    }
    glUniform4fv(program.Find("u_shade_a"), kMaxShades, first.data());
    glUniform3fv(program.Find("u_shade_b"), kMaxShades, second.data());
    program.Set("u_shade_count", static_cast<int>(count));
  }

  void SetLook(const Program& program, const MaterialLook& look) {
    const auto inverse = [](float tile) { return tile > 0.0f ? 1.0f / tile : 0.0f; };
    program.Set("u_low", look.low);
    program.Set("u_high", look.high);
    program.Set("u_gloss", Colour{look.wet, look.wet_exponent, look.sheen});
    if (look.opacity < 1.0f) {
      program.Set("u_opacity", look.opacity);
      return;
    }
    if (!look.is_tissue) {
      program.Set("u_grooves", look.grooves);
      return;
    }
    program.Set("u_cell", look.cell);
    program.Set("u_vessel", look.vessel);
    program.Set("u_wrap", look.wrap);
    program.Set("u_detail_scale", Colour{inverse(look.detail_tile[0]), inverse(look.detail_tile[1]),
                                         inverse(look.detail_tile[2])});
    program.Set("u_broad_scale", inverse(look.broad_tile));
    program.Set("u_bump_scale", inverse(look.bump_tile));
    program.Set("u_amounts", Colour{look.cell_amount, look.vessel_amount, look.vessel_width});
    program.Set("u_bump", look.bump);
    program.Set("u_glow", look.glow);
  }

  void DrawSurface(const Surface& surface, const Pose& X_camera_surface, const Vec3& scale) {
    DrawSurface(surface, X_camera_surface, scale, GetLook(surface.material));
  }

  void DrawSurface(const Surface& surface, const Pose& X_camera_surface, const Vec3& scale,
                   const MaterialLook& look) {
    const Program& program = look.opacity < 1.0f ? clear : look.is_tissue ? tissue : tool;
    glUseProgram(program.name);
    program.Set("u_camera_from_surface", MakeMatrix(X_camera_surface, scale));
    program.Set("u_rotation", MakeRotation(X_camera_surface.rotation));
    SetLook(program, look);
    if (!look.is_tissue && look.opacity >= 1.0f)
      program.Set("u_axis", ToFloat(math::Rotate(X_camera_surface.rotation, {0, 0, 1})));
    glBindVertexArray(surface.array);
    glDrawElements(GL_TRIANGLES, surface.index_count, GL_UNSIGNED_INT, nullptr);
  }

  /// Everything that light passes through, after what it is seen against.
  void DrawClear(const Frame& frame, const Viewport& viewport) {
    const Pose& X_camera_world = viewport.X_camera_world;
    glEnable(GL_BLEND);
    // alpha keeps the brightness of what is behind, for the smoothing of edges
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    glDepthMask(GL_FALSE);
    for (const Puddle& p : frame.puddles) {
      if (!(p.radius > 0.0)) continue;
      const Pose X_world_puddle{math::RotationBetween({0, 0, 1}, p.up), p.centre};
      DrawSurface(*FindSurface(puddle), X_camera_world * X_world_puddle, {p.radius, p.radius, p.radius},
                  MixLook(p));
    }
    for (const SurfaceDraw& draw : frame.surfaces) {
      const Surface* surface = FindSurface(draw.surface);
      if (surface != nullptr && GetLook(surface->material).opacity < 1.0f)
        DrawSurface(*surface, X_camera_world * draw.X_world_surface, {1, 1, 1});
    }
    // ribbons face the eye
    glDisable(GL_CULL_FACE);
    fine.DrawFibres(frame.fibres, viewport);
    glEnable(GL_CULL_FACE);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
  }

  void DrawArrow(const Arrow& arrow, const Pose& X_camera_world) {
    const double length = math::Norm(arrow.span);
    if (!(length > 0.0) || !std::isfinite(length) || !(arrow.radius > 0.0)) return;
    const Vec3 direction = arrow.span / length;
    const math::Quaternion rotation = math::RotationBetween({0, 0, 1}, direction);
    const double head = std::min(kArrowHeadLength * arrow.radius, length);
    const double rod_length = length - head;
    if (rod_length > 0.0) {
      DrawSurface(*FindSurface(rod), X_camera_world * Pose{rotation, arrow.p_world_tail},
                  {arrow.radius, arrow.radius, rod_length});
    }
    DrawSurface(*FindSurface(cone),
                X_camera_world * Pose{rotation, arrow.p_world_tail + rod_length * direction},
                {kArrowHeadRadius * arrow.radius, kArrowHeadRadius * arrow.radius, head});
  }
};

Renderer::Renderer(std::unique_ptr<Content> content) : content_(std::move(content)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

core::Result<Renderer> Renderer::Make() {
  if (const auto status = CheckGraphicsVersion(); !status) return status.error();
  auto content = std::make_unique<Content>();
  auto tissue =
      MakeProgram({kSurfaceVertexShader}, {kFragmentHead, kShadingFunctions, kTissueFragmentShader});
  if (!tissue) return tissue.error();
  content->tissue = *tissue;
  auto tool = MakeProgram({kSurfaceVertexShader}, {kFragmentHead, kShadingFunctions, kToolFragmentShader});
  if (!tool) return tool.error();
  content->tool = *tool;
  auto clear = MakeProgram({kClearVertexShader}, {kFragmentHead, kShadingFunctions, kClearFragmentShader});
  if (!clear) return clear.error();
  content->clear = *clear;
  if (const auto status = content->fine.Make(); !status) return status.error();
  auto mask = MakeProgram({kMaskVertexShader}, {kMaskFragmentShader});
  if (!mask) return mask.error();
  content->mask = *mask;
  auto smooth = MakeProgram({kScreenVertexShader}, {kSmoothFragmentShader});
  if (!smooth) return smooth.error();
  content->smooth = *smooth;
  const NoiseTiles tiles = MakeNoiseTiles(kNoiseSide);
  content->pattern = MakeNoiseTexture(tiles.side, tiles.pattern);
  content->bumps = MakeNoiseTexture(tiles.side, tiles.bumps);
  content->MakeMask();
  Renderer renderer(std::move(content));
  renderer.content_->rod = renderer.AddSurface(MakeUnitRod(), Material::kForce);
  renderer.content_->cone = renderer.AddSurface(MakeUnitCone(), Material::kForce);
  renderer.content_->puddle = renderer.AddSurface(MakeUnitPuddle(), Material::kBlood);
  return renderer;
}

SurfaceId Renderer::AddSurface(std::span<const Triangle> triangles, std::span<const Vec3> rest,
                               Material material, std::span<const double> openness) {
  TROCAR_ASSERT(openness.empty() || openness.size() == rest.size());
  auto& surfaces = content_->surfaces;
  auto free_place =
      std::find_if(surfaces.begin(), surfaces.end(), [](const Surface& s) { return s.generation % 2 == 0; });
  if (free_place == surfaces.end()) free_place = surfaces.insert(surfaces.end(), Surface{});
  Surface& surface = *free_place;
  ++surface.generation;
  surface.material = material;
  surface.vertex_count = rest.size();
  glGenVertexArrays(1, &surface.array);
  for (GLuint* buffer : {&surface.moving, &surface.rest, &surface.indices}) glGenBuffers(1, buffer);

  glBindVertexArray(surface.array);
  glBindBuffer(GL_ARRAY_BUFFER, surface.moving);
  const auto offset = [](std::size_t bytes) { return reinterpret_cast<const void*>(bytes); };
  for (const GLuint location : {0u, 1u, 2u}) glEnableVertexAttribArray(location);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(MovingVertex), offset(0));
  glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, sizeof(MovingVertex),
                        offset(offsetof(MovingVertex, normal)));
  glBindBuffer(GL_ARRAY_BUFFER, surface.rest);
  glVertexAttribPointer(2, 4, GL_FLOAT, GL_FALSE, sizeof(RestVertex), offset(0));
  std::vector<RestVertex> rest_vertices(rest.size());
  for (std::size_t i = 0; i < rest.size(); ++i) {
    rest_vertices[i] = {ToFloat(rest[i]), openness.empty() ? 1.0f : F(openness[i])};
  }
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(rest_vertices.size() * sizeof(RestVertex)),
               rest_vertices.data(), GL_STATIC_DRAW);
  glBindVertexArray(0);
  content_->UploadTriangles(surface, triangles);

  std::vector<Vec3> normals(rest.size());
  geometry::CalcVertexNormals(rest, triangles, normals);
  content_->UploadMoving(surface, rest, normals);
  return {static_cast<std::uint32_t>(free_place - surfaces.begin()), surface.generation};
}

SurfaceId Renderer::AddSurface(const geometry::TriangleMesh& mesh, Material material,
                               std::span<const double> openness) {
  return AddSurface(mesh.triangles, mesh.positions, material, openness);
}

void Renderer::UpdateSurface(SurfaceId id, std::span<const Vec3> positions, std::span<const Vec3> normals) {
  Surface* surface = content_->FindSurface(id);
  TROCAR_ASSERT(surface != nullptr && positions.size() == surface->vertex_count &&
                normals.size() == positions.size());
  if (surface != nullptr) content_->UploadMoving(*surface, positions, normals);
}

void Renderer::UpdateMarks(SurfaceId id, std::span<const SurfaceMark> marks) {
  Surface* surface = content_->FindSurface(id);
  TROCAR_ASSERT(surface != nullptr && marks.size() == surface->vertex_count);
  if (surface != nullptr) content_->UploadMarks(*surface, marks);
}

void Renderer::UpdateTriangles(SurfaceId id, std::span<const Triangle> triangles) {
  Surface* surface = content_->FindSurface(id);
  TROCAR_ASSERT(surface != nullptr);
  if (surface != nullptr) content_->UploadTriangles(*surface, triangles);
}

void Renderer::RemoveSurface(SurfaceId id) {
  if (Surface* surface = content_->FindSurface(id)) Content::Free(*surface);
}

void Renderer::Draw(const Frame& frame, int width, int height) {
  if (width < 1 || height < 1) return;
  Content& c = *content_;
  // a toolkit may have left anything behind
  for (const GLenum state :
       {GL_BLEND, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_FRAMEBUFFER_SRGB, GL_POLYGON_OFFSET_FILL}) {
    glDisable(state);
  }
  GLint target = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target);
  const bool is_smoothed = frame.has_smooth_edges && !frame.is_wireframe && c.BindPicture(width, height);
  if (!is_smoothed) glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(target));
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthRange(0.0, 1.0);
  glViewport(0, 0, width, height);
  glClearColor(F(frame.clear_colour[0]), F(frame.clear_colour[1]), F(frame.clear_colour[2]), 1);
  glClearDepth(1.0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  // first, at the near plane: what lies outside the circle is then never shaded
  glDisable(GL_CULL_FACE);
  if (frame.has_mask) c.DrawMask(width, height);

  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  glFrontFace(GL_CCW);
  if (frame.is_wireframe) glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  const Pose X_camera_world = math::Inverse(frame.camera.X_world_camera);
  const Matrix4 projection = MakeProjection(frame.camera, width, height);
  c.SetFrame(c.tool, frame, X_camera_world, projection, width, height);
  c.SetFrame(c.clear, frame, X_camera_world, projection, width, height);
  c.SetFrame(c.fine.GetProgram(), frame, X_camera_world, projection, width, height);
  c.SetFrame(c.tissue, frame, X_camera_world, projection, width, height);
  glVertexAttrib4f(3, 0, 0, 0, 0);  // of surfaces without marks
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_3D, c.bumps);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_3D, c.pattern);
  glUseProgram(c.tissue.name);
  c.tissue.Set("u_pattern", 0);
  c.tissue.Set("u_bumps", 1);
  // arrows in a slice of depth before everything else: they are a read-out, no organ may hide them
  glDepthRange(0.001, kOverlayDepth);
  for (const Arrow& arrow : frame.arrows) c.DrawArrow(arrow, X_camera_world);
  glDepthRange(kOverlayDepth, 1.0);
  for (const SurfaceDraw& draw : frame.surfaces) {
    const Surface* surface = c.FindSurface(draw.surface);
    if (surface != nullptr && GetLook(surface->material).opacity >= 1.0f)
      c.DrawSurface(*surface, X_camera_world * draw.X_world_surface, {1, 1, 1});
  }
  const Viewport viewport{X_camera_world, CalcFocalLength(frame.camera, height), 0.5 * width, 0.5 * height};
  glDisable(GL_CULL_FACE);  // blobs face the eye
  c.fine.DrawBlobs(frame.blobs, viewport);
  glEnable(GL_CULL_FACE);
  c.DrawClear(frame, viewport);

  glDepthRange(0.0, 1.0);
  if (frame.is_wireframe) glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_3D, 0);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_3D, 0);
  if (is_smoothed) {
    glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(target));
    c.DrawSmoothed(frame.has_mask, width, height);
  }
  glBindVertexArray(0);
  glUseProgram(0);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
}

math::Vec2 CalcPixel(const Camera& camera, const Vec3& p_world, int width, int height) {
  const Vec3 p = math::Inverse(camera.X_world_camera) * p_world;
  constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
  if (!(p.z < 0.0)) return {kNowhere, kNowhere};
  const double focal = CalcFocalLength(camera, height);
  // pixel centres lie at whole numbers
  return {0.5 * width - 0.5 + focal * p.x / -p.z, 0.5 * height - 0.5 - focal * p.y / -p.z};
}

}  // namespace trocar::render
