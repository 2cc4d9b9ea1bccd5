// SPDX-License-Identifier: Apache-2.0
// Every shader is GLSL ES 3.0, too, but for its first line: what a tablet or a browser would need.
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "test_scene.h"
#include "trocar/geometry/primitives.h"
#include "trocar/render/figure_renderer.h"

namespace trocar::render {
namespace {

/// Names that OpenGL gives out one after another; far more than there are.
constexpr GLuint kMostNames = 1000;
constexpr std::string_view kDesktopVersion = "#version 330 core\n";
constexpr const char* kEmbeddedHead =
    "#version 300 es\n"
    "precision highp float;\nprecision highp int;\n"
    "precision highp sampler2D;\nprecision highp sampler3D;\n";

/// A vertex and a fragment shader that are linked.
struct Sources {
  std::string vertex, fragment;
};

std::string ReadSource(GLuint shader) {
  GLint size = 0;
  glGetShaderiv(shader, GL_SHADER_SOURCE_LENGTH, &size);
  std::string source(static_cast<std::size_t>(size), '\0');
  GLsizei length = 0;
  glGetShaderSource(shader, size, &length, source.data());
  source.resize(static_cast<std::size_t>(length));
  return source;
}

/// Of all programs of the current context.
std::vector<Sources> ReadPrograms() {
  std::vector<Sources> found;
  for (GLuint name = 1; name < kMostNames; ++name) {
    if (glIsProgram(name) != GL_TRUE) continue;
    std::array<GLuint, 2> shaders{};
    GLsizei count = 0;
    glGetAttachedShaders(name, 2, &count, shaders.data());
    Sources sources;
    for (const GLuint shader : shaders) {
      GLint kind = 0;
      glGetShaderiv(shader, GL_SHADER_TYPE, &kind);
      (kind == GL_VERTEX_SHADER ? sources.vertex : sources.fragment) = ReadSource(shader);
    }
    found.push_back(std::move(sources));
  }
  return found;
}

/// An OpenGL ES 3 context in place of the current one, as long as it lives.
class EmbeddedContext {
 public:
  EmbeddedContext() : display_(eglGetCurrentDisplay()) {
    const EGLint wish[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_ES3_BIT, EGL_SURFACE_TYPE, EGL_DONT_CARE,
                           EGL_NONE};
    const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 0, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (eglBindAPI(EGL_OPENGL_ES_API) != EGL_TRUE ||
        eglChooseConfig(display_, wish, &config, 1, &count) != EGL_TRUE || count == 0)
      return;
    context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, version);
    is_current_ = context_ != EGL_NO_CONTEXT &&
                  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_TRUE;
  }
  ~EmbeddedContext() {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
    eglBindAPI(EGL_OPENGL_API);
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, desktop_);
  }
  EmbeddedContext(const EmbeddedContext&) = delete;
  EmbeddedContext& operator=(const EmbeddedContext&) = delete;

  bool IsCurrent() const { return is_current_; }

 private:
  EGLDisplay display_;
  EGLContext desktop_ = eglGetCurrentContext();
  EGLContext context_ = EGL_NO_CONTEXT;
  bool is_current_ = false;
};

/// \return what the compiler says; empty: good
std::string Compile(GLuint program, GLenum kind, const std::string& desktop) {
  if (!desktop.starts_with(kDesktopVersion)) return "another first line: " + desktop.substr(0, 40);
  const std::string source = kEmbeddedHead + desktop.substr(kDesktopVersion.size());
  const char* text = source.c_str();
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint is_compiled = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &is_compiled);
  std::string log(2048, '\0');
  GLsizei length = 0;
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), &length, log.data());
  log.resize(static_cast<std::size_t>(length));
  glAttachShader(program, shader);
  glDeleteShader(shader);
  return is_compiled == GL_TRUE ? "" : "compiler: " + log;
}

/// \return what compiler and linker say; empty: good
std::string Build(const Sources& sources) {
  const GLuint program = glCreateProgram();
  std::string said = Compile(program, GL_VERTEX_SHADER, sources.vertex) +
                     Compile(program, GL_FRAGMENT_SHADER, sources.fragment);
  if (said.empty()) {
    glLinkProgram(program);
    GLint is_linked = GL_FALSE;
    glGetProgramiv(program, GL_LINK_STATUS, &is_linked);
    if (is_linked != GL_TRUE) said = "does not link";
  }
  glDeleteProgram(program);
  return said;
}

class EmbeddedShaders : public DrawingTest {};

TEST_F(EmbeddedShaders, EachProgramIsGlslEs30) {
  auto figures = FigureRenderer::Make();
  ASSERT_TRUE(figures.ok());
  // the programs of labels and depth are made when they are first wanted
  GeometryPicture picture;
  Frame frame = PlainFrame();
  const SurfaceId ball = renderer_->AddSurface(geometry::MakeSphere({0, 0, 0}, 0.01, 1), Material::kLiver);
  frame.surfaces.push_back({.surface = ball, .label = 1});
  ASSERT_TRUE(renderer_->DrawGeometry(frame, {}, kWidth, kHeight, picture).ok());

  const std::vector<Sources> programs = ReadPrograms();
  // tissue twice, tools, what is clear, the fine, mask, four ways to smooth, glow, geometry, two of figures
  EXPECT_EQ(programs.size(), 15u);
  const EmbeddedContext embedded;
  ASSERT_TRUE(embedded.IsCurrent());
  ASSERT_TRUE(
      std::string_view(reinterpret_cast<const char*>(glGetString(GL_VERSION))).starts_with("OpenGL ES 3"));
  for (const Sources& sources : programs) {
    ASSERT_FALSE(sources.vertex.empty() || sources.fragment.empty());
    EXPECT_EQ(Build(sources), "") << sources.vertex << sources.fragment;
  }
  // the control: what only a desktop's compiler takes
  Sources wrong = programs.front();
  const auto begin = wrong.fragment.rfind('}');
  ASSERT_NE(begin, std::string::npos);
  wrong.fragment.insert(begin, "  float mixed = 1;\n");
  EXPECT_NE(Build(wrong), "");
}

}  // namespace
}  // namespace trocar::render
