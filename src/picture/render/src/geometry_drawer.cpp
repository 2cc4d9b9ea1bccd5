// SPDX-License-Identifier: Apache-2.0
#include "geometry_drawer.h"

#include <algorithm>
#include <array>
#include <limits>

#include "camera_matrices.h"

namespace trocar::render {
namespace {

constexpr const char* kVertexShader = R"(#version 330 core
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
layout(location = 4) in vec3 a_earlier;
uniform mat4 u_camera_from_surface;
uniform mat4 u_earlier_from_surface;
uniform mat3 u_rotation;
uniform mat4 u_clip_from_camera;
out vec3 v_position;
out vec3 v_normal;
out vec3 v_now;
out vec3 v_before;
void main() {
  vec4 position = u_camera_from_surface * vec4(a_position, 1.0);
  v_position = position.xyz;
  v_normal = u_rotation * a_normal;
  gl_Position = u_clip_from_camera * position;
  v_now = gl_Position.xyw;
  v_before = (u_clip_from_camera * (u_earlier_from_surface * vec4(a_earlier, 1.0))).xyw;
}
)";

constexpr const char* kFragmentShader = R"(#version 330 core
in vec3 v_position;
in vec3 v_normal;
in vec3 v_now;
in vec3 v_before;
uniform uint u_label;
uniform float u_has_earlier;
uniform vec2 u_half_size;
layout(location = 0) out vec4 o_geometry;
layout(location = 1) out uint o_label;
layout(location = 2) out vec2 o_flow;
void main() {
  // between opposite normals there is none
  o_geometry = vec4(normalize(v_normal + vec3(0.0, 0.0, 1e-9)), -v_position.z);
  o_label = u_label;
  bool is_known = u_has_earlier > 0.5 && v_before.z > 0.0;
  vec2 way = v_now.xy / v_now.z - v_before.xy / v_before.z;
  o_flow = is_known ? way * u_half_size * vec2(1.0, -1.0) : vec2(1e9);
}
)";

constexpr GLfloat kUnknownFlow = 1e9f;  // as the shader has it

}  // namespace

GeometryDrawer::~GeometryDrawer() {
  if (framebuffer_ == 0) return;
  glDeleteProgram(program_.name);
  glDeleteFramebuffers(1, &framebuffer_);
  for (const GLuint buffer : {normals_, labels_, flow_, depth_}) glDeleteRenderbuffers(1, &buffer);
}

base::Status GeometryDrawer::Resize(int width, int height) {
  if (framebuffer_ == 0) {
    auto program = MakeProgram({kVertexShader}, {kFragmentShader});
    if (!program) return program.error();
    program_ = *program;
    label_place_ = program_.Find("u_label");
    glGenFramebuffers(1, &framebuffer_);
    for (GLuint* buffer : {&normals_, &labels_, &flow_, &depth_}) glGenRenderbuffers(1, buffer);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  if (width == width_ && height == height_) return {};
  const auto attach = [&](GLuint buffer, GLenum format, GLenum place) {
    glBindRenderbuffer(GL_RENDERBUFFER, buffer);
    glRenderbufferStorage(GL_RENDERBUFFER, format, width, height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, place, GL_RENDERBUFFER, buffer);
  };
  attach(normals_, GL_RGBA32F, GL_COLOR_ATTACHMENT0);
  attach(labels_, GL_R16UI, GL_COLOR_ATTACHMENT1);
  attach(flow_, GL_RG32F, GL_COLOR_ATTACHMENT2);
  attach(depth_, GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT);
  glBindRenderbuffer(GL_RENDERBUFFER, 0);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    width_ = height_ = 0;
    return base::Error{base::ErrorCode::kNoGraphics,
                       "the driver has no framebuffer of floating-point numbers in this size; choose a "
                       "smaller picture, or let Mesa draw (LIBGL_ALWAYS_SOFTWARE=1)"};
  }
  width_ = width;
  height_ = height;
  return {};
}

base::Status GeometryDrawer::Begin(const Matrix4& clip_from_camera, int width, int height, bool has_flow) {
  if (const auto status = Resize(width, height); !status) return status;
  constexpr GLenum kBuffers[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2};
  glDrawBuffers(has_flow ? 3 : 2, kBuffers);
  glViewport(0, 0, width, height);
  constexpr GLfloat kNoGeometry[] = {0, 0, 0, 0};
  constexpr GLuint kNoLabel[] = {0, 0, 0, 0};
  constexpr GLfloat kFarthest = 1;
  glClearBufferfv(GL_COLOR, 0, kNoGeometry);
  glClearBufferuiv(GL_COLOR, 1, kNoLabel);
  glClearBufferfv(GL_DEPTH, 0, &kFarthest);
  constexpr GLfloat kNoFlow[] = {kUnknownFlow, kUnknownFlow, 0, 0};
  if (has_flow) glClearBufferfv(GL_COLOR, 2, kNoFlow);
  glUseProgram(program_.name);
  program_.Set("u_clip_from_camera", clip_from_camera);
  program_.Set("u_half_size",
               std::array{0.5f * static_cast<float>(width), 0.5f * static_cast<float>(height)});
  return {};
}

void GeometryDrawer::Draw(const Surface& surface, const math::Pose& X_camera_surface, const math::Vec3& scale,
                          std::uint16_t label, const std::optional<math::Pose>& X_earlier_surface) {
  glUseProgram(program_.name);
  const bool has_earlier = X_earlier_surface && surface.earlier != 0;
  program_.Set("u_has_earlier", has_earlier ? 1.0f : 0.0f);
  if (has_earlier) program_.Set("u_earlier_from_surface", MakeMatrix(*X_earlier_surface, scale));
  program_.Set("u_camera_from_surface", MakeMatrix(X_camera_surface, scale));
  program_.Set("u_rotation", MakeRotation(X_camera_surface.rotation));
  glUniform1ui(label_place_, label);
  glBindVertexArray(surface.array);
  glDrawElements(GL_TRIANGLES, surface.index_count, GL_UNSIGNED_INT, nullptr);
}

const Program& GeometryDrawer::BeginFine(std::uint16_t label) {
  glUseProgram(program_.name);
  program_.Set("u_camera_from_surface", MakeMatrix({}, {1, 1, 1}));
  program_.Set("u_rotation", MakeRotation({}));
  program_.Set("u_has_earlier", 0.0f);
  glUniform1ui(label_place_, label);
  return program_;
}

void GeometryDrawer::Read(GeometryPicture& picture, bool has_flow) {
  const auto columns = static_cast<std::size_t>(width_), rows = static_cast<std::size_t>(height_);
  picture.width = width_;
  picture.height = height_;
  picture.depth.resize(columns * rows);
  picture.normals.resize(3 * columns * rows);
  picture.labels.resize(columns * rows);
  staging_.resize(4 * columns * rows);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_FLOAT, staging_.data());
  glReadBuffer(GL_COLOR_ATTACHMENT1);
  glReadPixels(0, 0, width_, height_, GL_RED_INTEGER, GL_UNSIGNED_SHORT, picture.labels.data());
  // OpenGL's first row is the bottom one
  for (std::size_t row = 0; row < rows / 2; ++row) {
    const auto low = picture.labels.begin() + static_cast<std::ptrdiff_t>(row * columns);
    std::swap_ranges(low, low + static_cast<std::ptrdiff_t>(columns),
                     picture.labels.begin() + static_cast<std::ptrdiff_t>((rows - 1 - row) * columns));
  }
  for (std::size_t row = 0; row < rows; ++row) {
    const float* from = staging_.data() + 4 * columns * (rows - 1 - row);
    for (std::size_t i = row * columns; i < (row + 1) * columns; ++i, from += 4) {
      std::copy(from, from + 3, picture.normals.begin() + static_cast<std::ptrdiff_t>(3 * i));
      picture.depth[i] = from[3];
    }
  }
  picture.flow.clear();
  if (!has_flow) return;
  picture.flow.resize(2 * columns * rows);
  glReadBuffer(GL_COLOR_ATTACHMENT2);
  glReadPixels(0, 0, width_, height_, GL_RG, GL_FLOAT, staging_.data());
  for (std::size_t row = 0; row < rows; ++row) {
    const float* from = staging_.data() + 2 * columns * (rows - 1 - row);
    std::transform(
        from, from + 2 * columns, picture.flow.begin() + static_cast<std::ptrdiff_t>(2 * columns * row),
        [](float v) { return v < 0.5f * kUnknownFlow ? v : std::numeric_limits<float>::quiet_NaN(); });
  }
}

}  // namespace trocar::render
