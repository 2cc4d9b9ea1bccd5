// SPDX-License-Identifier: Apache-2.0
#include "round_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <vector>

#include "shaders.h"
#include "single_precision.h"
#include "trocar/render/frame.h"
#include "trocar/render/looks.h"

namespace trocar::render {
namespace {

constexpr int kSegments = 128;
constexpr int kGlowShrink = 8;                  // pixels of the picture to one of the glow
constexpr int kFanFirst = 2 * (kSegments + 1);  // vertex after the ring's strip

/// Half axes of the picture's circle in clip space.
std::array<float, 2> CalcCircle(int width, int height) {
  return {ToFloat(kMaskDiameter * height / width), ToFloat(kMaskDiameter)};
}

/// Each as centre, radius and thickness; those that are not there have no radius.
void SetBlots(const Program& program, std::span<const Blot> blots) {
  std::array<std::array<float, 4>, kMaxBlots> packed{};
  for (std::size_t i = 0; i < std::min(blots.size(), kMaxBlots); ++i)
    packed[i] = {ToFloat(blots[i].centre.x), ToFloat(blots[i].centre.y), ToFloat(blots[i].radius),
                 ToFloat(blots[i].thick)};
  glUniform4fv(glGetUniformLocation(program.name, "u_blots"), static_cast<GLsizei>(kMaxBlots),
               packed[0].data());
}

}  // namespace

RoundPicture::~RoundPicture() {
  for (const Program& program : {mask_, smooth_, smooth_fine_, smeared_, smeared_fine_, glow_})
    glDeleteProgram(program.name);
  glDeleteFramebuffers(2, glow_framebuffers_.data());
  glDeleteTextures(2, glow_pictures_.data());
  glDeleteVertexArrays(1, &ring_);
  glDeleteBuffers(1, &ring_vertices_);
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteTextures(1, &picture_);
  glDeleteRenderbuffers(1, &depth_);
}

base::Status RoundPicture::Make() {
  const auto mask = MakeProgram({kMaskVertexShader}, {kMaskFragmentShader});
  if (!mask) return mask.error();
  mask_ = *mask;
  for (const auto& [program, fine, smeared] :
       {std::tuple{&smooth_, "", ""}, std::tuple{&smooth_fine_, kFine, ""},
        std::tuple{&smeared_, "", kSmeared}, std::tuple{&smeared_fine_, kFine, kSmeared}}) {
    const auto made = MakeProgram({kScreenVertexShader}, {kVersion, fine, smeared, kSmoothFragmentShader});
    if (!made) return made.error();
    *program = *made;
  }
  const auto glow = MakeProgram({kFullVertexShader}, {kGlowFragmentShader});
  if (!glow) return glow.error();
  glow_ = *glow;
  MakeRing();
  return {};
}

/// A strip from the circle outwards, then a fan that fills the circle.
void RoundPicture::MakeRing() {
  std::vector<std::array<float, 3>> ring;
  for (int i = 0; i <= kSegments; ++i) {
    const double angle = 2.0 * M_PI * i / kSegments;
    ring.push_back({ToFloat(std::cos(angle)), ToFloat(std::sin(angle)), 0});
    ring.push_back({ToFloat(std::cos(angle)), ToFloat(std::sin(angle)), 1});
  }
  for (int i = 0; i <= kSegments; ++i) ring.push_back(ring[static_cast<std::size_t>(2 * i)]);
  glGenVertexArrays(1, &ring_);
  glGenBuffers(1, &ring_vertices_);
  glBindVertexArray(ring_);
  glBindBuffer(GL_ARRAY_BUFFER, ring_vertices_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(ring.size() * sizeof ring[0]), ring.data(),
               GL_STATIC_DRAW);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  glBindVertexArray(0);
  glBindBuffer(GL_ARRAY_BUFFER, 0);
}

void RoundPicture::DrawMask(int width, int height) {
  glUseProgram(mask_.name);
  mask_.Set("u_inner", CalcCircle(width, height));
  mask_.Set("u_colour", Colour{0, 0, 0});
  glBindVertexArray(ring_);
  glDrawArrays(GL_TRIANGLE_STRIP, 0, kFanFirst);
}

bool RoundPicture::Bind(int width, int height) {
  if (framebuffer_ == 0) {
    glGenFramebuffers(1, &framebuffer_);
    glGenTextures(1, &picture_);
    glGenRenderbuffers(1, &depth_);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  if (width == width_ && height == height_) return true;
  glBindTexture(GL_TEXTURE_2D, picture_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
  glBindTexture(GL_TEXTURE_2D, 0);
  glBindRenderbuffer(GL_RENDERBUFFER, depth_);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
  glBindRenderbuffer(GL_RENDERBUFFER, 0);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, picture_, 0);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
  const bool is_complete = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  width_ = is_complete ? width : 0;
  height_ = is_complete ? height : 0;
  return is_complete;
}

/// The bright parts of the own picture at an eighth of its size, blurred across and down. Leaves the target changed.
void RoundPicture::MakeGlow(int width, int height) {
  const int small_width = std::max(1, width / kGlowShrink), small_height = std::max(1, height / kGlowShrink);
  if (glow_framebuffers_[0] == 0) {
    glGenFramebuffers(2, glow_framebuffers_.data());
    glGenTextures(2, glow_pictures_.data());
  }
  if (small_width != glow_width_ || small_height != glow_height_) {
    glow_width_ = small_width, glow_height_ = small_height;
    for (std::size_t i = 0; i < 2; ++i) {
      glBindTexture(GL_TEXTURE_2D, glow_pictures_[i]);
      glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, small_width, small_height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                   nullptr);
      for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
      for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
        glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
      glBindFramebuffer(GL_FRAMEBUFFER, glow_framebuffers_[i]);
      glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, glow_pictures_[i], 0);
    }
  }
  glViewport(0, 0, small_width, small_height);
  glUseProgram(glow_.name);
  glow_.Set("u_picture", 0);
  const std::array<float, 2> texel = {ToFloat(1.0 / small_width), ToFloat(1.0 / small_height)};
  glow_.Set("u_texel", texel);
  glBindVertexArray(ring_);
  const auto pass = [&](std::size_t target, GLuint source, const std::array<float, 2>& step) {
    glBindFramebuffer(GL_FRAMEBUFFER, glow_framebuffers_[target]);
    glBindTexture(GL_TEXTURE_2D, source);
    glow_.Set("u_step", step);
    glDrawArrays(GL_TRIANGLE_FAN, kFanFirst, kSegments + 1);
  };
  pass(0, picture_, {0, 0});
  pass(1, glow_pictures_[0], {texel[0], 0});
  pass(0, glow_pictures_[1], {0, texel[1]});
}

void RoundPicture::DrawSmoothed(const Smoothing& smoothing, int width, int height) {
  const bool has_glow = smoothing.has_glow, is_smeared = !smoothing.blots.empty();
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glActiveTexture(GL_TEXTURE0);
  if (has_glow) {
    GLint target = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target);
    MakeGlow(width_, height_);
    glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(target));
  }
  glViewport(0, 0, width, height);
  glClearColor(0, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  const Program& smooth = is_smeared ? (has_glow ? smeared_fine_ : smeared_)
                          : has_glow ? smooth_fine_
                                     : smooth_;
  glUseProgram(smooth.name);
  if (is_smeared) SetBlots(smooth, smoothing.blots);
  if (has_glow) {
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_2D, glow_pictures_[0]);
    smooth.Set("u_glow", 1);
    glActiveTexture(GL_TEXTURE0);
  }
  glBindTexture(GL_TEXTURE_2D, picture_);
  smooth.Set("u_picture", 0);
  smooth.Set("u_size", std::array<float, 2>{ToFloat(width), ToFloat(height)});
  smooth.Set("u_texel", std::array<float, 2>{ToFloat(1.0 / width_), ToFloat(1.0 / height_)});
  // without a mask a circle round the whole picture
  const double wide = 1.5 * std::hypot(width, height);
  smooth.Set("u_inner", smoothing.has_mask
                            ? CalcCircle(width, height)
                            : std::array<float, 2>{ToFloat(wide / width), ToFloat(wide / height)});
  glBindVertexArray(ring_);
  glDrawArrays(GL_TRIANGLE_FAN, kFanFirst, kSegments + 1);
  glBindTexture(GL_TEXTURE_2D, 0);
  if (has_glow) {
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_2D, 0);
    glActiveTexture(GL_TEXTURE0);
  }
}

}  // namespace trocar::render
