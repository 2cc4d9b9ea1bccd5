// SPDX-License-Identifier: Apache-2.0
/// \file shader_program.h  Compiling and linking GLSL, and setting uniforms by name.
#pragma once

#include <epoxy/gl.h>

#include <array>
#include <initializer_list>

#include "trocar/base/result.h"

namespace trocar::render {

using Matrix4 = std::array<float, 16>;  ///< column after column
using Matrix3 = std::array<float, 9>;   ///< column after column

/// A linked program with the places of its uniforms.
struct Program {
  GLuint name = 0;

  GLint Find(const char* uniform) const { return glGetUniformLocation(name, uniform); }
  void Set(const char* uniform, float v) const { glUniform1f(Find(uniform), v); }
  void Set(const char* uniform, int v) const { glUniform1i(Find(uniform), v); }
  void Set(const char* uniform, const std::array<float, 2>& v) const {
    glUniform2fv(Find(uniform), 1, v.data());
  }
  void Set(const char* uniform, const std::array<float, 3>& v) const {
    glUniform3fv(Find(uniform), 1, v.data());
  }
  void Set(const char* uniform, const Matrix3& m) const {
    glUniformMatrix3fv(Find(uniform), 1, GL_FALSE, m.data());
  }
  void Set(const char* uniform, const Matrix4& m) const {
    glUniformMatrix4fv(Find(uniform), 1, GL_FALSE, m.data());
  }
};

/// \pre an OpenGL context is current
/// \return kGraphicsTooOld below OpenGL 3.3 or for OpenGL ES, with the version that was found
base::Status CheckGraphicsVersion();

/// \return kShaderFailed with the compiler's words
base::Result<Program> MakeProgram(std::initializer_list<const char*> vertex_sources,
                                  std::initializer_list<const char*> fragment_sources);

}  // namespace trocar::render
