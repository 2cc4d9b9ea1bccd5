// SPDX-License-Identifier: Apache-2.0
#include "noise_textures.h"

#include <cstdint>
#include <vector>

#include "noise.h"

namespace trocar::render {
namespace {

constexpr int kNoiseSide = 64;  // texels

GLuint MakeTexture(int side, const std::vector<std::uint8_t>& texels) {
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

void BindBoth(GLuint pattern, GLuint bumps) {
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_3D, bumps);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_3D, pattern);
}

}  // namespace

NoiseTextures::~NoiseTextures() {
  glDeleteTextures(1, &pattern_);
  glDeleteTextures(1, &bumps_);
}

void NoiseTextures::Make() {
  const NoiseTiles tiles = MakeNoiseTiles(kNoiseSide);
  pattern_ = MakeTexture(tiles.side, tiles.pattern);
  bumps_ = MakeTexture(tiles.side, tiles.bumps);
}

void NoiseTextures::Bind() const {
  BindBoth(pattern_, bumps_);
}

void NoiseTextures::Unbind() {
  BindBoth(0, 0);
}

}  // namespace trocar::render
