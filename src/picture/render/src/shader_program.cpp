// SPDX-License-Identifier: Apache-2.0
#include "shader_program.h"

#include <string>

namespace trocar::render {
namespace {

base::Error ShaderFailed(const std::string& what, const std::string& log) {
  return {base::ErrorCode::kShaderFailed,
          what + ": " + log + "; update the graphics driver or set LIBGL_ALWAYS_SOFTWARE=1"};
}

base::Result<GLuint> MakeShader(GLenum kind, std::initializer_list<const char*> sources) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, static_cast<GLsizei>(sources.size()), sources.begin(), nullptr);
  glCompileShader(shader);
  GLint is_compiled = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &is_compiled);
  if (is_compiled == GL_TRUE) return shader;
  std::string log(2048, '\0');
  GLsizei length = 0;
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), &length, log.data());
  log.resize(static_cast<std::size_t>(length));
  glDeleteShader(shader);
  return ShaderFailed(
      kind == GL_VERTEX_SHADER ? "a vertex shader does not compile" : "a fragment shader does not compile",
      log);
}

}  // namespace

base::Status CheckGraphicsVersion() {
  if (!epoxy_is_desktop_gl() || epoxy_gl_version() < 33) {
    const auto* version = reinterpret_cast<const char*>(glGetString(GL_VERSION));
    return base::Error{
        base::ErrorCode::kGraphicsTooOld,
        std::string("OpenGL here is ") + (version == nullptr ? "unknown" : version) +
            ", desktop OpenGL 3.3 is needed; update the graphics driver or set LIBGL_ALWAYS_SOFTWARE=1"};
  }
  return {};
}

base::Result<Program> MakeProgram(std::initializer_list<const char*> vertex_sources,
                                  std::initializer_list<const char*> fragment_sources) {
  const auto vertex = MakeShader(GL_VERTEX_SHADER, vertex_sources);
  if (!vertex) return vertex.error();
  const auto fragment = MakeShader(GL_FRAGMENT_SHADER, fragment_sources);
  if (!fragment) {
    glDeleteShader(*vertex);
    return fragment.error();
  }
  const Program program{glCreateProgram()};
  glAttachShader(program.name, *vertex);
  glAttachShader(program.name, *fragment);
  glLinkProgram(program.name);
  glDeleteShader(*vertex);
  glDeleteShader(*fragment);
  GLint is_linked = GL_FALSE;
  glGetProgramiv(program.name, GL_LINK_STATUS, &is_linked);
  if (is_linked == GL_TRUE) return program;
  std::string log(2048, '\0');
  GLsizei length = 0;
  glGetProgramInfoLog(program.name, static_cast<GLsizei>(log.size()), &length, log.data());
  log.resize(static_cast<std::size_t>(length));
  glDeleteProgram(program.name);
  return ShaderFailed("a shader program does not link", log);
}

}  // namespace trocar::render
