// SPDX-License-Identifier: Apache-2.0
#include "fine_drawer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "fine_shaders.h"
#include "shaders.h"
#include "single_precision.h"

namespace trocar::render {
namespace {

using math::Vec3;

constexpr double kNearest = 0.004;  // m, before the lens
constexpr std::uint32_t kBlobSides = 7, kPuffSides = 10;
/// Least half width in pixels: thinner ones would come and go from frame to frame.
constexpr double kLeastPixels = 0.6;
/// A fibre of fewer pixels is straight, one of fewer than the second has one bend.
constexpr double kSheetWidth = 0.0009;                     // m; wider ones are sheets
constexpr double kThreadWaist = 0.50, kSheetWaist = 0.45;  // width in the middle, in that of the roots
constexpr double kStraightPixels = 12, kBentPixels = 40;

std::uint32_t Mix(std::uint32_t seed) {
  seed ^= seed >> 16;
  seed *= 0x7feb352dU;
  seed ^= seed >> 15;
  seed *= 0x846ca68bU;
  return seed ^ (seed >> 16);
}

/// 0 to 1, the same for the same seed.
float Shuffle(std::uint32_t seed) {
  return static_cast<float>(Mix(seed) >> 8) / 16777216.0f;
}

/// Colour and wetness of one piece: each lies somewhere between the material's two colours, nearer to the light one,
/// because a small piece lies open.
std::array<float, 4> PickColour(const MaterialLook& look, std::uint32_t seed) {
  const float share = 0.4f + 0.6f * Shuffle(seed + 0x9e3779b9U);
  return {look.low[0] + share * (look.high[0] - look.low[0]),
          look.low[1] + share * (look.high[1] - look.low[1]),
          look.low[2] + share * (look.high[2] - look.low[2]), look.wet};
}

/// Columns of a rotation: products are cheaper than with a quaternion, thousands of times a frame.
struct Frame3 {
  Vec3 x, y, z, t;

  explicit Frame3(const math::Pose& pose)
      : x(math::Rotate(pose.rotation, {1, 0, 0})),
        y(math::Rotate(pose.rotation, {0, 1, 0})),
        z(math::Rotate(pose.rotation, {0, 0, 1})),
        t(pose.translation) {}
  Vec3 operator*(const Vec3& p) const { return p.x * x + p.y * y + p.z * z + t; }
};

/// Whether a ball about a point in front of the lens may be in the picture.
bool IsSeen(const Vec3& p_camera, double radius, const Viewport& viewport) {
  if (p_camera.z > -kNearest) return false;
  const double scale = viewport.focal / -p_camera.z;
  return std::abs(p_camera.x) * scale < viewport.half_width + radius * scale &&
         std::abs(p_camera.y) * scale < viewport.half_height + radius * scale;
}

}  // namespace

FineDrawer::~FineDrawer() {
  if (array_ == 0) return;
  glDeleteProgram(program_.name);
  glDeleteVertexArrays(1, &array_);
  for (const GLuint buffer : {corners_on_card_, indices_on_card_}) glDeleteBuffers(1, &buffer);
}

base::Status FineDrawer::Make(const Looks& looks) {
  const std::string colours = MakeEffectColours(looks);
  auto program = MakeProgram({kFineVertexHead, colours.c_str(), kShadingFunctions, kFineVertexShader},
                             {kFineFragmentShader});
  if (!program) return program.error();
  program_ = *program;
  const auto offset = [](std::size_t bytes) { return reinterpret_cast<const void*>(bytes); };
  glGenVertexArrays(1, &array_);
  glGenBuffers(1, &corners_on_card_);
  glGenBuffers(1, &indices_on_card_);
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, corners_on_card_);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_on_card_);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Corner), offset(offsetof(Corner, position)));
  glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, sizeof(Corner), offset(offsetof(Corner, normal)));
  glVertexAttribPointer(2, 4, GL_FLOAT, GL_FALSE, sizeof(Corner), offset(offsetof(Corner, albedo)));
  glVertexAttribPointer(3, 3, GL_FLOAT, GL_FALSE, sizeof(Corner), offset(offsetof(Corner, passing)));
  for (const GLuint location : {0u, 1u, 2u, 3u}) glEnableVertexAttribArray(location);
  glBindVertexArray(0);
  glBindBuffer(GL_ARRAY_BUFFER, 0);

  for (std::uint32_t shape = 0; shape < kShapes; ++shape) {
    const double p = 2 * M_PI * Shuffle(3 * shape), q = 2 * M_PI * Shuffle(3 * shape + 1);
    const double turns = 5.0 + 4.0 * Shuffle(3 * shape + 2);
    for (std::size_t i = 0; i <= kMostSteps; ++i) {
      const double along = static_cast<double>(i) / kMostSteps, bell = 4.0 * along * (1.0 - along);
      waves_[shape][i] = {static_cast<float>(bell * std::sin(p + turns * along)),
                          static_cast<float>(0.7 * bell * std::sin(q + 8.0 * along))};
    }
  }
  return {};
}

void FineDrawer::DrawFibres(const Looks& looks, std::span<const Fibre> fibres, const Viewport& viewport,
                            const Program* program) {
  corners_.clear();
  indices_.clear();
  const Frame3 X_camera_world(viewport.X_camera_world);
  for (const Fibre& fibre : fibres) {
    const Vec3 a = X_camera_world * fibre.a, b = X_camera_world * fibre.b, chord = b - a;
    const double length = math::Norm(chord);
    if (a.z > -kNearest || b.z > -kNearest ||
        !IsSeen(0.5 * (a + b), 0.5 * length + fibre.wave + fibre.width, viewport))
      continue;
    const MaterialLook& look = looks[fibre.material];
    const double pixels = viewport.focal * length / -std::max(a.z, b.z);
    const std::size_t steps = fibre.wave == 0.0 || pixels < kStraightPixels ? 1
                              : pixels < kBentPixels                        ? 2
                                                                            : kMostSteps;
    const Wave& wave = waves_[Mix(fibre.seed) % kShapes];
    const Vec3 along = math::Normalized(chord), u = math::AnyPerpendicular(along), w = math::Cross(along, u);
    std::array<Vec3, kMostSteps + 1> centres;
    for (std::size_t i = 0; i <= steps; ++i) {
      const auto& lift = wave[i * kMostSteps / steps];
      centres[i] = a + (static_cast<double>(i) / static_cast<double>(steps)) * chord +
                   fibre.wave * (double{lift[0]} * u + double{lift[1]} * w);
    }
    const auto first = static_cast<std::uint32_t>(corners_.size());
    const std::array<float, 4> albedo = PickColour(look, fibre.seed);
    // a sheet is clear at its edges, so that it seems to run on into its neighbours; a thread is not
    const bool is_sheet = fibre.width > kSheetWidth;
    const std::array<float, 3> passing = {look.emission, look.opacity, 1.0f};
    const std::array<float, 3> edge_passing = {look.emission, is_sheet ? 0.0f : look.opacity, 1.0f};
    for (std::size_t i = 0; i <= steps; ++i) {
      const Vec3 tangent = centres[std::min(i + 1, steps)] - centres[i > 0 ? i - 1 : 0];
      const Vec3 to_eye = -math::Normalized(centres[i]),
                 across = math::Normalized(math::Cross(tangent, to_eye), u);
      // broader where it takes root
      const double root = 2.0 * static_cast<double>(i) / static_cast<double>(steps) - 1.0;
      const double waist = is_sheet ? kSheetWaist : kThreadWaist;
      const double half = std::max(0.5 * fibre.width * (waist + (1.0 - waist) * root * root),
                                   kLeastPixels * -centres[i].z / viewport.focal);
      for (const double side : {-1.0, 0.0, 1.0}) {
        if (side == 0.0 && !is_sheet) continue;
        corners_.push_back({ToFloat(centres[i] + (side * half) * across),
                            ToFloat((0.85 * side) * across + 0.53 * to_eye), albedo,
                            side == 0.0 ? passing : edge_passing});
      }
    }
    const std::uint32_t columns = is_sheet ? 3 : 2;
    for (std::uint32_t i = 0; i < steps; ++i) {
      for (std::uint32_t column = 0; column + 1 < columns; ++column) {
        const std::uint32_t at = first + columns * i + column, next = at + columns;
        indices_.insert(indices_.end(), {at, at + 1, next, at + 1, next + 1, next});
      }
    }
  }
  Draw(program);
}

void FineDrawer::DrawBlobs(const Looks& looks, std::span<const Blob> blobs, const Viewport& viewport,
                           const Program* program) {
  corners_.clear();
  indices_.clear();
  std::array<std::array<double, 2>, kBlobSides> circle;
  for (std::uint32_t i = 0; i < kBlobSides; ++i)
    circle[i] = {std::cos(2 * M_PI * i / kBlobSides), std::sin(2 * M_PI * i / kBlobSides)};
  const Frame3 X_camera_world(viewport.X_camera_world);
  for (const Blob& blob : blobs) {
    const Vec3 centre = X_camera_world * blob.centre;
    if (!IsSeen(centre, 1.5 * blob.radius, viewport)) continue;
    const MaterialLook& look = looks[blob.material];
    const Vec3 to_eye = -math::Normalized(centre);
    // turned and lumpy: no two alike
    const Vec3 turned =
        math::Normalized(Vec3{Shuffle(blob.seed) - 0.5, Shuffle(blob.seed + 1) - 0.5, 0.02}, {1, 0, 0});
    const Vec3 s = math::Normalized(math::Cross(to_eye, turned)), t = math::Cross(to_eye, s);
    const double radius = std::max(blob.radius, kLeastPixels * -centre.z / viewport.focal);
    const auto first = static_cast<std::uint32_t>(corners_.size());
    const std::array<float, 4> albedo = PickColour(look, blob.seed);
    corners_.push_back(
        {ToFloat(centre + (0.6 * radius) * to_eye), ToFloat(to_eye), albedo, {look.emission, 1, 1}});
    const std::uint32_t lumps = Mix(blob.seed + 2);
    for (std::uint32_t i = 0; i < kBlobSides; ++i) {
      const Vec3 out = circle[i][0] * s + circle[i][1] * t;
      const double lump = 0.85 + 0.35 * ((lumps >> (4 * i)) & 15U) / 15.0;
      // its rim sinks into what it lies on
      corners_.push_back(
          {ToFloat(centre + (lump * radius) * out), ToFloat(out), albedo, {look.emission, 1, 0.7f}});
      indices_.insert(indices_.end(), {first, first + 1 + i, first + 1 + (i + 1) % kBlobSides});
    }
  }
  Draw(program);
}

void FineDrawer::DrawPuffs(const Looks& looks, std::span<const Puff> puffs, const Viewport& viewport) {
  corners_.clear();
  indices_.clear();
  const Frame3 X_camera_world(viewport.X_camera_world);
  for (const Puff& puff : puffs) {
    const Vec3 centre = X_camera_world * puff.centre;
    if (!IsSeen(centre, puff.radius, viewport)) continue;
    const MaterialLook& look = looks[puff.material];
    const Vec3 to_eye = -math::Normalized(centre), s = math::AnyPerpendicular(to_eye),
               t = math::Cross(to_eye, s);
    const auto first = static_cast<std::uint32_t>(corners_.size());
    const std::array<float, 4> albedo = PickColour(look, 0);
    // thick in the middle, less than half of it half way out, nothing at the rim
    const auto add = [&](const Vec3& p, double opacity) {
      corners_.push_back(
          {ToFloat(p), ToFloat(to_eye), albedo, {look.emission, static_cast<float>(opacity), 1.0f}});
    };
    add(centre, puff.opacity);
    for (const auto& [share, opacity] : {std::pair{0.5, 0.42 * puff.opacity}, std::pair{1.0, 0.0}}) {
      for (std::uint32_t i = 0; i < kPuffSides; ++i) {
        const double angle = 2 * M_PI * i / kPuffSides;
        add(centre + (share * puff.radius) * (std::cos(angle) * s + std::sin(angle) * t), opacity);
      }
    }
    for (std::uint32_t i = 0; i < kPuffSides; ++i) {
      const std::uint32_t a = first + 1 + i, b = first + 1 + (i + 1) % kPuffSides;
      indices_.insert(indices_.end(), {first, a, b, a, a + kPuffSides, b, b, a + kPuffSides, b + kPuffSides});
    }
  }
  Draw(nullptr);
}

void FineDrawer::Draw(const Program* program) {
  if (indices_.empty()) return;
  glUseProgram(program != nullptr ? program->name : program_.name);
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, corners_on_card_);
  // a fresh store each time, so that the driver need not wait for the draw that still reads the old one
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners_.size() * sizeof(Corner)), corners_.data(),
               GL_STREAM_DRAW);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices_.size() * sizeof(std::uint32_t)),
               indices_.data(), GL_STREAM_DRAW);
  glBindBuffer(GL_ARRAY_BUFFER, 0);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(indices_.size()), GL_UNSIGNED_INT, nullptr);
}

}  // namespace trocar::render
