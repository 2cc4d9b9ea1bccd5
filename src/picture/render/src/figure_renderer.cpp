// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/figure_renderer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "figure_strokes.h"
#include "shader_program.h"
#include "trocar/base/assert.h"
#include "trocar/geometry/mesh_measures.h"

namespace trocar::render {
namespace {

using math::Vec3;

constexpr int kSamples = 4;  // a pixel

// the camera carries a lamp, and a weak one stands above it: shape stays readable from everywhere
const char* const kSurfaceVertexSource = R"(#version 330 core
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec3 a_colour;
uniform mat4 u_clip_from_camera, u_camera_from_world;
out vec3 v_position, v_normal, v_colour;
void main() {
  vec4 p = u_camera_from_world * vec4(a_position, 1.0);
  v_position = p.xyz;
  v_normal = mat3(u_camera_from_world) * a_normal;
  v_colour = a_colour;
  gl_Position = u_clip_from_camera * p;
}
)";
const char* const kSurfaceFragmentSource = R"(#version 330 core
in vec3 v_position, v_normal, v_colour;
out vec4 o_colour;
uniform float u_opacity;
uniform float u_light;  // 0: edges, darker and without light
void main() {
  vec3 albedo = v_colour * v_colour;
  vec3 to_eye = normalize(-v_position);
  vec3 n = normalize(v_normal);
  if (dot(n, to_eye) < 0.0) n = -n;
  vec3 key = normalize(vec3(-0.35, 0.55, 1.0));
  float lit = 0.22 + 0.58 * max(dot(n, key), 0.0) + 0.26 * (0.5 + 0.5 * n.y);
  float gleam = 0.10 * pow(max(dot(n, normalize(key + to_eye)), 0.0), 40.0);
  // a veil is denser where it is seen edge-on, as glass is
  float rim = 1.0 - abs(dot(n, to_eye));
  float opacity = u_opacity < 1.0 ? mix(u_opacity, 1.0, 0.55 * rim * rim) : 1.0;
  vec3 light = mix(albedo * 0.30, albedo * lit + vec3(gleam), u_light);
  o_colour = vec4(sqrt(clamp(light, 0.0, 1.0)), opacity);
}
)";
const char* const kStrokeVertexSource = R"(#version 330 core
layout(location = 0) in vec4 a_clip;
layout(location = 1) in vec3 a_colour;
layout(location = 2) in vec3 a_local;
out vec3 v_colour, v_local;
void main() {
  v_colour = a_colour;
  v_local = a_local;
  gl_Position = a_clip;
}
)";
const char* const kStrokeFragmentSource = R"(#version 330 core
in vec3 v_colour, v_local;
out vec4 o_colour;
void main() {
  float r = length(v_local.xy);
  if (v_local.z > 0.5 && r > 1.0) discard;
  // a dark rim sets a disc off from a surface of its own colour
  o_colour = vec4(v_local.z > 0.5 && r > 0.76 ? 0.25 * v_colour : v_colour, 1.0);
}
)";

float F(double value) {
  return static_cast<float>(value);
}

struct Vertex {
  std::array<float, 3> position, normal, colour;
};

struct Uploaded {
  GLuint array = 0, vertices = 0, indices = 0;
  GLsizei index_count = 0;
  double opacity = 1;
  bool has_edges = false;
};

/// A framebuffer of one size and number of samples.
struct Buffer {
  GLuint framebuffer = 0, colour = 0, depth = 0;
  int width = 0, height = 0, samples = -1;

  bool Bind(int wanted_width, int wanted_height, int wanted_samples) {
    if (framebuffer == 0) {
      glGenFramebuffers(1, &framebuffer);
      glGenRenderbuffers(1, &colour);
      glGenRenderbuffers(1, &depth);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    if (wanted_width == width && wanted_height == height && wanted_samples == samples) return true;
    for (const auto& [buffer, format] :
         {std::pair{colour, GL_RGBA8}, std::pair{depth, GL_DEPTH_COMPONENT24}}) {
      glBindRenderbuffer(GL_RENDERBUFFER, buffer);
      glRenderbufferStorageMultisample(GL_RENDERBUFFER, wanted_samples, static_cast<GLenum>(format),
                                       wanted_width, wanted_height);
    }
    glBindRenderbuffer(GL_RENDERBUFFER, 0);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth);
    const bool is_complete = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
    width = is_complete ? wanted_width : 0;
    height = is_complete ? wanted_height : 0;
    samples = is_complete ? wanted_samples : -1;
    return is_complete;
  }
  void Free() {
    glDeleteFramebuffers(1, &framebuffer);
    glDeleteRenderbuffers(1, &colour);
    glDeleteRenderbuffers(1, &depth);
  }
};

Matrix4 MakeOrbitProjection(const OrbitCamera& camera, int width, int height) {
  const auto [near, far] = CalcDepthRange(camera);
  const double focal = 1.0 / std::tan(0.5 * camera.field_of_view);
  Matrix4 m{};
  m[0] = F(focal * height / width);
  m[5] = F(focal);
  m[10] = F((far + near) / (near - far));
  m[11] = -1;
  m[14] = F(2.0 * far * near / (near - far));
  return m;
}

Matrix4 MakeWorldToCamera(const OrbitCamera& camera) {
  const math::Quaternion to_camera = math::Inverse(camera.R_world_camera);
  const Vec3 x = math::Rotate(to_camera, {1, 0, 0}), y = math::Rotate(to_camera, {0, 1, 0}),
             z = math::Rotate(to_camera, {0, 0, 1});
  const Vec3 t = -math::Rotate(to_camera, camera.Position());
  return {F(x.x), F(x.y), F(x.z), 0, F(y.x), F(y.y), F(y.z), 0,
          F(z.x), F(z.y), F(z.z), 0, F(t.x), F(t.y), F(t.z), 1};
}

}  // namespace

struct FigureRenderer::Content {
  Program surface, stroke;
  std::vector<Uploaded> surfaces;
  GLuint stroke_array = 0, stroke_vertices = 0;
  Buffer sampled, resolved;

  Content() = default;
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;
  ~Content() {
    FreeSurfaces();
    glDeleteProgram(surface.name);
    glDeleteProgram(stroke.name);
    glDeleteVertexArrays(1, &stroke_array);
    glDeleteBuffers(1, &stroke_vertices);
    sampled.Free();
    resolved.Free();
  }

  void FreeSurfaces() {
    for (Uploaded& each : surfaces) {
      glDeleteVertexArrays(1, &each.array);
      glDeleteBuffers(1, &each.vertices);
      glDeleteBuffers(1, &each.indices);
    }
    surfaces.clear();
  }

  void DrawSurface(const Uploaded& each) {
    glBindVertexArray(each.array);
    glDrawElements(GL_TRIANGLES, each.index_count, GL_UNSIGNED_INT, nullptr);
  }

  void DrawSurfaces(const OrbitCamera& camera, int width, int height) {
    glUseProgram(surface.name);
    surface.Set("u_clip_from_camera", MakeOrbitProjection(camera, width, height));
    surface.Set("u_camera_from_world", MakeWorldToCamera(camera));
    surface.Set("u_opacity", 1.0f);
    surface.Set("u_light", 1.0f);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1.0f, 1.0f);
    for (const Uploaded& each : surfaces) {
      if (each.opacity >= 1.0) DrawSurface(each);
    }
    glDisable(GL_POLYGON_OFFSET_FILL);
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    surface.Set("u_light", 0.0f);
    for (const Uploaded& each : surfaces) {
      if (each.opacity >= 1.0 && each.has_edges) DrawSurface(each);
    }
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    surface.Set("u_light", 1.0f);
  }

  /// Veils come last: only their nearest layer, so that the order of their triangles does not matter.
  void DrawVeils() {
    glUseProgram(surface.name);
    for (const Uploaded& each : surfaces) {
      if (each.opacity >= 1.0 || each.opacity <= 0.0) continue;
      glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
      glDepthFunc(GL_LESS);
      DrawSurface(each);
      glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
      glDepthFunc(GL_EQUAL);
      glEnable(GL_BLEND);
      glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
      surface.Set("u_opacity", F(each.opacity));
      DrawSurface(each);
      glDisable(GL_BLEND);
    }
    glDepthFunc(GL_LESS);
  }

  void DrawStrokes(const std::vector<StrokeVertex>& strokes) {
    if (strokes.empty()) return;
    glUseProgram(stroke.name);
    glBindVertexArray(stroke_array);
    glBindBuffer(GL_ARRAY_BUFFER, stroke_vertices);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(strokes.size() * sizeof(StrokeVertex)),
                 strokes.data(), GL_STREAM_DRAW);
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(strokes.size()));
    glBindBuffer(GL_ARRAY_BUFFER, 0);
  }
};

FigureRenderer::FigureRenderer(std::unique_ptr<Content> content) : content_(std::move(content)) {}
FigureRenderer::FigureRenderer(FigureRenderer&&) noexcept = default;
FigureRenderer& FigureRenderer::operator=(FigureRenderer&&) noexcept = default;
FigureRenderer::~FigureRenderer() = default;

base::Result<FigureRenderer> FigureRenderer::Make() {
  if (const auto status = CheckGraphicsVersion(); !status) return status.error();
  auto content = std::make_unique<Content>();
  auto surface = MakeProgram({kSurfaceVertexSource}, {kSurfaceFragmentSource});
  if (!surface) return surface.error();
  content->surface = *surface;
  auto stroke = MakeProgram({kStrokeVertexSource}, {kStrokeFragmentSource});
  if (!stroke) return stroke.error();
  content->stroke = *stroke;
  glGenVertexArrays(1, &content->stroke_array);
  glGenBuffers(1, &content->stroke_vertices);
  glBindVertexArray(content->stroke_array);
  glBindBuffer(GL_ARRAY_BUFFER, content->stroke_vertices);
  const auto offset = [](std::size_t bytes) { return reinterpret_cast<const void*>(bytes); };
  for (const GLuint location : {0u, 1u, 2u}) glEnableVertexAttribArray(location);
  glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, sizeof(StrokeVertex), offset(0));
  glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, sizeof(StrokeVertex),
                        offset(offsetof(StrokeVertex, colour)));
  glVertexAttribPointer(2, 3, GL_FLOAT, GL_FALSE, sizeof(StrokeVertex),
                        offset(offsetof(StrokeVertex, local)));
  glBindVertexArray(0);
  glBindBuffer(GL_ARRAY_BUFFER, 0);
  return FigureRenderer(std::move(content));
}

void FigureRenderer::SetSurfaces(std::span<const FigureSurface> surfaces) {
  content_->FreeSurfaces();
  const auto offset = [](std::size_t bytes) { return reinterpret_cast<const void*>(bytes); };
  for (const FigureSurface& surface : surfaces) {
    const std::size_t count = surface.positions.size();
    TROCAR_ASSERT(surface.colours.size() == count || surface.colours.size() == 1);
    for (const auto& t : surface.triangles) TROCAR_ASSERT(t[0] < count && t[1] < count && t[2] < count);
    std::vector<Vec3> normals(count);
    geometry::CalcVertexNormals(surface.positions, surface.triangles, normals);
    std::vector<Vertex> vertices(count);
    for (std::size_t v = 0; v < count; ++v) {
      const Vec3 &p = surface.positions[v], &n = normals[v];
      const SrgbColour& colour = surface.colours[surface.colours.size() == 1 ? 0 : v];
      vertices[v] = {
          {F(p.x), F(p.y), F(p.z)}, {F(n.x), F(n.y), F(n.z)}, {F(colour[0]), F(colour[1]), F(colour[2])}};
    }
    Uploaded each;
    each.opacity = surface.opacity;
    each.has_edges = surface.has_edges;
    each.index_count = static_cast<GLsizei>(3 * surface.triangles.size());
    glGenVertexArrays(1, &each.array);
    glGenBuffers(1, &each.vertices);
    glGenBuffers(1, &each.indices);
    glBindVertexArray(each.array);
    glBindBuffer(GL_ARRAY_BUFFER, each.vertices);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(count * sizeof(Vertex)), vertices.data(),
                 GL_STATIC_DRAW);
    for (const GLuint location : {0u, 1u, 2u}) {
      glEnableVertexAttribArray(location);
      glVertexAttribPointer(location, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                            offset(location * sizeof(Vertex::position)));
    }
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, each.indices);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER,
                 static_cast<GLsizeiptr>(surface.triangles.size() * sizeof(geometry::Triangle)),
                 surface.triangles.data(), GL_STATIC_DRAW);
    glBindVertexArray(0);
    content_->surfaces.push_back(each);
  }
  glBindBuffer(GL_ARRAY_BUFFER, 0);
}

void FigureRenderer::Draw(const OrbitCamera& camera, const FigureMarks& marks, const FigureOptions& options,
                          int width, int height) {
  if (width < 1 || height < 1) return;
  Content& c = *content_;
  // a toolkit may have left anything behind
  for (const GLenum state : {GL_BLEND, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_FRAMEBUFFER_SRGB, GL_CULL_FACE})
    glDisable(state);
  GLint target = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target);
  const bool is_sampled = c.resolved.Bind(width, height, 0) && c.sampled.Bind(width, height, kSamples);
  if (!is_sampled) glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(target));
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
  glDepthRange(0.0, 1.0);
  glViewport(0, 0, width, height);
  glClearColor(F(options.background[0]), F(options.background[1]), F(options.background[2]), 1);
  glClearDepth(1.0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);

  const Strokes strokes = MakeStrokes(marks, camera, width, height, options.pixel_scale);
  c.DrawSurfaces(camera, width, height);
  c.DrawStrokes(strokes.hidden);
  c.DrawVeils();
  glDisable(GL_DEPTH_TEST);
  c.DrawStrokes(strokes.on_top);
  if (options.has_axes) c.DrawStrokes(MakeAxes(camera, width, height, options.pixel_scale));

  if (is_sampled) {
    // samples become pixels in a buffer of our own: a toolkit's may have another format
    const auto copy = [width, height](GLuint from, GLuint to) {
      glBindFramebuffer(GL_READ_FRAMEBUFFER, from);
      glBindFramebuffer(GL_DRAW_FRAMEBUFFER, to);
      glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    };
    copy(c.sampled.framebuffer, c.resolved.framebuffer);
    copy(c.resolved.framebuffer, static_cast<GLuint>(target));
    glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(target));
  }
  glBindVertexArray(0);
  glUseProgram(0);
}

}  // namespace trocar::render
