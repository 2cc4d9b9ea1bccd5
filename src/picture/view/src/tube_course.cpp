// SPDX-License-Identifier: Apache-2.0
#include "tube_course.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "trocar/base/assert.h"
#include "trocar/math/noise.h"

namespace trocar::view {
namespace {

using math::Vec3;

constexpr std::size_t kLivingSteps = 2;                  // rings from node to node
constexpr double kCalibreWave = 0.009, kCalibre = 0.24;  // m, of the radius
constexpr double kBeadWave = 0.0042, kBead = 0.12;       // m, of the radius
constexpr double kWallWave = 0.0021, kWall = 0.16;       // m, of the radius: vessels and folds of the wall
constexpr double kBendWave = 0.011;                      // m
constexpr double kBend = 0.00022, kBendOfRadius = 0.30;  // m, and so much of the radius
constexpr double kThinnest = 0.72, kThickest = 1.30;     // of the model's radius
constexpr double kEvenLength = 0.0015, kFadeLength = 0.005;  // m from a fixed end

double Noise(const Vec3& p, double wave, const Vec3& offset) {
  return math::CalcGradientNoise(p / wave + offset, 0);
}

/// 0 at a fixed end, 1 away from it.
double CalcFreedom(const Vec3& p, std::span<const Vec3> fixed) {
  double freedom = 1;
  for (const Vec3& end : fixed) {
    const double share = std::clamp((math::Distance(p, end) - kEvenLength) / kFadeLength, 0.0, 1.0);
    freedom = std::min(freedom, share * share * (3.0 - 2.0 * share));
  }
  return freedom;
}

}  // namespace

TubeCourse::TubeCourse(std::span<const Vec3> rest, std::span<const double> radii, std::span<const Vec3> fixed,
                       TubeLook look)
    : steps_(look == TubeLook::kLiving ? kLivingSteps : 1) {
  TROCAR_ASSERT(rest.size() >= 2 && radii.size() == rest.size());
  const std::size_t rings = (rest.size() - 1) * steps_ + 1;
  radii_.resize(rings);
  bends_.assign(rings, Vec3{});
  swells_.assign(rings * kSides, 1.0);
  centres_.resize(rings);
  for (std::size_t ring = 0; ring < rings; ++ring) {
    const Place place = PlaceOf(ring * kSides);
    const std::size_t next = std::min(place.node + 1, radii.size() - 1);
    radii_[ring] = (1.0 - place.share) * radii[place.node] + place.share * radii[next];
  }
  if (look == TubeLook::kEven) return;
  std::vector<double> freedom(rings);
  for (std::size_t ring = 0; ring < rings; ++ring) {
    const Vec3 c = CentreOf(rest, ring);
    freedom[ring] = CalcFreedom(c, fixed);
    const double calibre =
        kCalibre * Noise(c, kCalibreWave, {3.1, 0, 0}) + kBead * Noise(c, kBeadWave, {0, 5.7, 0});
    const Vec3 aside{Noise(c, kBendWave, {1.7, 0, 0}), Noise(c, kBendWave, {0, 8.3, 0}),
                     Noise(c, kBendWave, {0, 0, 4.9})};
    bends_[ring] = freedom[ring] * (kBend + kBendOfRadius * radii_[ring]) * aside;
    radii_[ring] *= std::clamp(1.0 + freedom[ring] * calibre, kThinnest, kThickest);
  }
  std::vector<Vec3> skin(SkinSize());
  CalcEvenSkin(rest, skin);
  for (std::size_t v = 0; v < swells_.size(); ++v)
    swells_[v] = 1.0 + freedom[v / kSides] * kWall * Noise(skin[v], kWallWave, {0, 0, 2.3});
}

TubeCourse::Place TubeCourse::PlaceOf(std::size_t vertex) const {
  const std::size_t walls = radii_.size() * kSides;
  const std::size_t ring = vertex < walls ? vertex / kSides : vertex == walls ? 0 : radii_.size() - 1;
  return {ring / steps_, static_cast<double>(ring % steps_) / static_cast<double>(steps_)};
}

/// On the Catmull-Rom spline through the nodes.
Vec3 TubeCourse::CentreOf(std::span<const Vec3> nodes, std::size_t ring) const {
  const std::size_t i = ring / steps_, last = nodes.size() - 1;
  if (ring % steps_ == 0) return nodes[i];
  const double t = static_cast<double>(ring % steps_) / static_cast<double>(steps_);
  const Vec3 &b = nodes[i], &c = nodes[i + 1];
  const Vec3 a = i > 0 ? nodes[i - 1] : 2.0 * b - c, d = i + 2 <= last ? nodes[i + 2] : 2.0 * c - b;
  return b + (0.5 * t) * ((c - a) + t * ((2.0 * a - 5.0 * b + 4.0 * c - d) + t * (3.0 * (b - c) + d - a)));
}

/// As geometry::CalcTubeSkin, with a cheaper transport of the ring's frame: it is done anew for every picture.
void TubeCourse::CalcEvenSkin(std::span<const Vec3> nodes, std::span<Vec3> skin) {
  static const auto circle = [] {
    std::array<std::array<double, 2>, kSides> points{};
    for (std::size_t side = 0; side < kSides; ++side) {
      const double angle = 2.0 * M_PI * static_cast<double>(side) / kSides;
      points[side] = {std::cos(angle), std::sin(angle)};
    }
    return points;
  }();
  const std::size_t rings = centres_.size();
  for (std::size_t ring = 0; ring < rings; ++ring) centres_[ring] = CentreOf(nodes, ring) + bends_[ring];
  Vec3 tangent = math::Normalized(centres_[1] - centres_[0], {1, 0, 0});
  Vec3 across = math::AnyPerpendicular(tangent);
  for (std::size_t ring = 0; ring < rings; ++ring) {
    const Vec3 along = centres_[std::min(ring + 1, rings - 1)] - centres_[ring > 0 ? ring - 1 : 0];
    tangent = math::Normalized(along, tangent);
    across = math::Normalized(across - math::Dot(across, tangent) * tangent, math::AnyPerpendicular(tangent));
    const Vec3 up = math::Cross(tangent, across);
    for (std::size_t side = 0; side < kSides; ++side)
      skin[ring * kSides + side] =
          centres_[ring] + radii_[ring] * (circle[side][0] * across + circle[side][1] * up);
  }
  skin[rings * kSides] = centres_.front();
  skin[rings * kSides + 1] = centres_.back();
}

void TubeCourse::CalcSkin(std::span<const Vec3> nodes, std::span<Vec3> skin) {
  CalcEvenSkin(nodes, skin);
  for (std::size_t v = 0; v < swells_.size(); ++v) {
    const Vec3& centre = centres_[v / kSides];
    skin[v] = centre + swells_[v] * (skin[v] - centre);
  }
}

}  // namespace trocar::view
