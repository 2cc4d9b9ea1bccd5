// SPDX-License-Identifier: Apache-2.0
#include "fine_drawer.h"

#include <cmath>
#include <cstddef>

#include "fine_shaders.h"
#include "material_look.h"
#include "shaders.h"

namespace trocar::render {
namespace {

constexpr int kFibreSteps = 6;  // pieces of a fibre
constexpr int kBlobSides = 10;
/// Least half width in pixels: thinner ones would come and go from frame to frame.
constexpr float kLeastPixels = 0.6f;

/// 0 to 1, the same for the same seed.
float Shuffle(std::uint32_t seed) {
  seed ^= seed >> 16;
  seed *= 0x7feb352dU;
  seed ^= seed >> 15;
  seed *= 0x846ca68bU;
  seed ^= seed >> 16;
  return static_cast<float>(seed >> 8) / 16777216.0f;
}

std::array<float, 3> ToFloat(const math::Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

/// Colour and wetness of one piece: each lies somewhere between the material's two colours, nearer to the light one,
/// because a small piece lies open.
std::array<float, 4> PickColour(const MaterialLook& look, float share) {
  share = 0.4f + 0.6f * share;
  return {look.low[0] + share * (look.high[0] - look.low[0]),
          look.low[1] + share * (look.high[1] - look.low[1]),
          look.low[2] + share * (look.high[2] - look.low[2]), look.wet};
}

}  // namespace

FineDrawer::~FineDrawer() {
  if (instances_ == 0) return;
  for (const Program& program : Programs()) glDeleteProgram(program.name);
  for (const GLuint array : {fibre_array_, blob_array_}) glDeleteVertexArrays(1, &array);
  for (const GLuint buffer : {instances_, fibre_places_, blob_places_}) glDeleteBuffers(1, &buffer);
}

core::Status FineDrawer::Make() {
  auto fibre = MakeProgram(kFibreVertexShader, {kShadingFunctions, kFineFragmentShader});
  if (!fibre) return fibre.error();
  fibre_ = *fibre;
  auto blob = MakeProgram(kBlobVertexShader, {kShadingFunctions, kFineFragmentShader});
  if (!blob) return blob.error();
  blob_ = *blob;
  glGenBuffers(1, &instances_);

  std::vector<std::array<float, 3>> strip;
  for (int i = 0; i <= kFibreSteps; ++i) {
    const float along = static_cast<float>(i) / kFibreSteps;
    strip.push_back({along, -1, 0});
    strip.push_back({along, 1, 0});
  }
  fibre_vertices_ = static_cast<GLsizei>(strip.size());
  MakeArray(fibre_array_, fibre_places_, strip);

  std::vector<std::array<float, 3>> dome = {{0, 0, 1}};
  for (int i = 0; i <= kBlobSides; ++i) {
    const double angle = 2 * M_PI * i / kBlobSides;
    dome.push_back({static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0});
  }
  blob_vertices_ = static_cast<GLsizei>(dome.size());
  MakeArray(blob_array_, blob_places_, dome);
  return {};
}

void FineDrawer::MakeArray(GLuint& array, GLuint& places, std::span<const std::array<float, 3>> vertices) {
  const auto offset = [](std::size_t bytes) { return reinterpret_cast<const void*>(bytes); };
  glGenVertexArrays(1, &array);
  glGenBuffers(1, &places);
  glBindVertexArray(array);
  glBindBuffer(GL_ARRAY_BUFFER, places);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size_bytes()), vertices.data(),
               GL_STATIC_DRAW);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  glBindBuffer(GL_ARRAY_BUFFER, instances_);
  glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, sizeof(Instance), offset(offsetof(Instance, a)));
  glVertexAttribPointer(2, 3, GL_FLOAT, GL_FALSE, sizeof(Instance), offset(offsetof(Instance, b)));
  glVertexAttribPointer(3, 4, GL_FLOAT, GL_FALSE, sizeof(Instance), offset(offsetof(Instance, shape)));
  glVertexAttribPointer(4, 4, GL_FLOAT, GL_FALSE, sizeof(Instance), offset(offsetof(Instance, colour)));
  glVertexAttribPointer(5, 1, GL_FLOAT, GL_FALSE, sizeof(Instance), offset(offsetof(Instance, opacity)));
  for (const GLuint location : {1u, 2u, 3u, 4u, 5u}) {
    glEnableVertexAttribArray(location);
    glVertexAttribDivisor(location, 1);
  }
  glBindVertexArray(0);
  glBindBuffer(GL_ARRAY_BUFFER, 0);
}

void FineDrawer::DrawFibres(std::span<const Fibre> fibres, const Matrix4& X_camera_world, float pixel) {
  staging_.clear();
  for (const Fibre& fibre : fibres) {
    const MaterialLook& look = GetLook(fibre.material);
    const float seed = Shuffle(fibre.seed);
    staging_.push_back(
        {ToFloat(fibre.a),
         ToFloat(fibre.b),
         {0.5f * static_cast<float>(fibre.width), static_cast<float>(fibre.wave), seed, look.emission},
         PickColour(look, Shuffle(fibre.seed + 0x9e3779b9U)),
         look.opacity});
  }
  Draw(fibre_, fibre_array_, GL_TRIANGLE_STRIP, fibre_vertices_, X_camera_world, pixel);
}

void FineDrawer::DrawBlobs(std::span<const Blob> blobs, const Matrix4& X_camera_world, float pixel) {
  staging_.clear();
  for (const Blob& blob : blobs) {
    const MaterialLook& look = GetLook(blob.material);
    const float seed = Shuffle(blob.seed);
    staging_.push_back({ToFloat(blob.centre),
                        {},
                        {static_cast<float>(blob.radius), 0, seed, look.emission},
                        PickColour(look, Shuffle(blob.seed + 0x9e3779b9U))});
  }
  Draw(blob_, blob_array_, GL_TRIANGLE_FAN, blob_vertices_, X_camera_world, pixel);
}

void FineDrawer::Draw(const Program& program, GLuint array, GLenum mode, GLsizei vertices,
                      const Matrix4& X_camera_world, float pixel) {
  if (staging_.empty()) return;
  const auto bytes = static_cast<GLsizeiptr>(staging_.size() * sizeof(Instance));
  glBindBuffer(GL_ARRAY_BUFFER, instances_);
  // a fresh store, so that the driver need not wait for the draw that still reads the old one
  glBufferData(GL_ARRAY_BUFFER, bytes, nullptr, GL_STREAM_DRAW);
  glBufferSubData(GL_ARRAY_BUFFER, 0, bytes, staging_.data());
  glBindBuffer(GL_ARRAY_BUFFER, 0);
  glUseProgram(program.name);
  program.Set("u_camera_from_surface", X_camera_world);
  program.Set("u_least", kLeastPixels * pixel);
  glBindVertexArray(array);
  glDrawArraysInstanced(mode, 0, vertices, static_cast<GLsizei>(staging_.size()));
}

}  // namespace trocar::render
