// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/gallstones.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/collision/queries.h"
#include "trocar/geometry/distance.h"
#include "trocar/math/elementary.h"
#include "trocar/math/random.h"
#include "trocar/math/state_fields.h"

namespace trocar::surgery {

using math::Vec3;

namespace {

using math::Cos;
using math::Exp;
using math::Log;

constexpr double kSpread = 0.25;       // of the logarithm of diameters within one patient
constexpr double kMostFilling = 0.5;   // of the organ by stones
constexpr double kSmallest = 0.001;    // diameter; what is smaller is sludge [m]
constexpr double kFriction = 0.45;     // of a stone on wet serosa and fat: a tunable
constexpr double kHolds = 0.60;        // of one that lies: it has settled
constexpr double kWetSeconds = 0.06;   // in which what slides on a wet surface slows to 1/e [s]
constexpr double kFastest = 1.0;       // [m/s]
constexpr double kStep = 0.5;          // of its radius that a stone goes at most between two searches
constexpr double kStill = 0.0004;      // that a stone may stir and still be about to rest [m]
constexpr double kRestSeconds = 0.25;  // of that, and it lies
constexpr double kSettled = 0.05;      // less upright than where it came to rest [-]
constexpr double kPushed = 0.0005;     // into a stone that lies, by a surface that it does not lie on [m]
constexpr double kDeepest = 0.004;     // that tissue may have moved over a stone in a tick [m]

/// A surface with the positions of its vertices.
struct Sheet {
  const OrganSurface* surface = nullptr;
  std::span<const Vec3> nodes;
  std::int32_t support = LooseStone::kOnNothing;
};

std::size_t SheetCount(const StoneGround& ground) noexcept {
  return ground.organs.size() + (ground.bed != nullptr ? 1 : 0);
}

Sheet SheetAt(const StoneGround& ground, std::size_t i) noexcept {
  if (i == ground.organs.size()) return {ground.bed, ground.bed_positions, LooseStone::kOnBed};
  return {&ground.organs[i], ground.organs[i].Nodes(ground.positions), static_cast<std::int32_t>(i)};
}

std::optional<Sheet> SheetUnder(const StoneGround& ground, const LooseStone& stone) noexcept {
  if (stone.support == LooseStone::kOnBed && ground.bed != nullptr)
    return SheetAt(ground, ground.organs.size());
  if (stone.support < 0 || static_cast<std::size_t>(stone.support) >= ground.organs.size())
    return std::nullopt;
  return SheetAt(ground, static_cast<std::size_t>(stone.support));
}

/// Where a stone touches a surface.
struct Touch {
  collision::NearestTriangle nearest;
  Vec3 normal;       // unit, out of the surface
  double depth = 0;  // of the stone in it [m]
};

std::optional<Touch> FindTouch(const Sheet& sheet, const Vec3& p, double radius) noexcept {
  const double reach = radius + kDeepest;
  const geometry::Box& box = sheet.surface->box;
  for (int axis = 0; axis < 3; ++axis) {
    if (p[axis] < box.min[axis] - reach || p[axis] > box.max[axis] + reach) return std::nullopt;
  }
  Touch touch;
  touch.nearest = sheet.surface->tree.FindNearest(sheet.nodes, p, {.max_distance = reach});
  if (!touch.nearest.Found()) return std::nullopt;
  const collision::SurfaceSide side = collision::FindSide(sheet.nodes, sheet.surface->triangles,
                                                          sheet.surface->vertex_triangles, p, touch.nearest);
  touch.depth = radius - side.distance;
  if (!(touch.depth > 0.0)) return std::nullopt;
  const Vec3 out = p - touch.nearest.point;
  const Vec3 along = math::Normalized(side.normal, {0, 0, 1});
  touch.normal =
      std::fabs(side.distance) < 1e-9 ? along : math::Normalized(side.distance < 0.0 ? -out : out, along);
  return touch;
}

std::optional<Touch> FindPush(const StonePusher& pusher, const Vec3& p, double radius) noexcept {
  const double t = geometry::FindNearestOnSegment(p, pusher.a, pusher.b);
  const Vec3 out = p - math::Lerp(pusher.a, pusher.b, t);
  Touch touch;
  touch.depth = radius + pusher.radius - math::Norm(out);
  if (!(touch.depth > 0.0)) return std::nullopt;
  touch.normal = math::Normalized(out);
  return touch;
}

Vec3 UpOf(const StoneGround& ground) noexcept {
  return -math::Normalized(ground.gravity, {0, 0, -1});
}

/// Axes that turn with a triangle: along its first edge, across it, and up.
std::array<Vec3, 3> AxesOf(const Sheet& sheet, std::uint32_t triangle) noexcept {
  const auto& corners = sheet.surface->triangles[triangle];
  const Vec3 &a = sheet.nodes[corners[0]], &b = sheet.nodes[corners[1]], &c = sheet.nodes[corners[2]];
  const Vec3 along = math::Normalized(b - a, {1, 0, 0});
  const Vec3 up = math::Normalized(math::Cross(b - a, c - a));
  return {along, math::Cross(up, along), up};
}

Vec3 PointUnder(const Sheet& sheet, const LooseStone& stone) noexcept {
  const auto& corners = sheet.surface->triangles[stone.triangle];
  Vec3 p;
  for (std::size_t k = 0; k < 3; ++k) p += stone.weights[k] * sheet.nodes[corners[k]];
  return p;
}

void LayDown(const Sheet& sheet, const Touch& touch, double upright, LooseStone& stone) noexcept {
  stone.upright = upright;
  stone.support = sheet.support;
  stone.triangle = touch.nearest.triangle;
  stone.weights = touch.nearest.weights;
  stone.velocity = {};
  const Vec3 offset = stone.position - touch.nearest.point;
  const auto axes = AxesOf(sheet, stone.triangle);
  stone.offset = {math::Dot(offset, axes[0]), math::Dot(offset, axes[1]), math::Dot(offset, axes[2])};
}

void Loosen(LooseStone& stone) noexcept {
  stone.support = LooseStone::kOnNothing;
  stone.velocity = {};
  stone.anchor = stone.position;
  stone.still_seconds = 0;
}

/// Goes along with what carries it. \return false where it has to move
bool Carry(const StoneGround& ground, LooseStone& stone) noexcept {
  if (stone.support == LooseStone::kOnFloor) return true;
  const auto sheet = SheetUnder(ground, stone);
  if (!sheet || stone.triangle >= sheet->surface->triangles.size()) return false;
  const auto axes = AxesOf(*sheet, stone.triangle);
  const Vec3 offset = stone.offset.x * axes[0] + stone.offset.y * axes[1] + stone.offset.z * axes[2];
  stone.position = PointUnder(*sheet, stone) + offset;
  // a hollow holds what its slopes alone would not
  const double level = 1.0 / std::sqrt(1.0 + kHolds * kHolds);
  const double upright = math::Dot(math::Normalized(offset), UpOf(ground));
  if (upright < std::min(level, stone.upright - kSettled)) return false;
  for (const StonePusher& pusher : ground.pushers) {
    if (FindPush(pusher, stone.position, stone.radius - kPushed)) return false;
  }
  for (std::size_t i = 0; i < SheetCount(ground); ++i) {
    const Sheet other = SheetAt(ground, i);
    if (other.support == stone.support) continue;
    const auto touch = FindTouch(other, stone.position, stone.radius - kPushed);
    if (touch) return false;
  }
  return true;
}

/// Out of whatever it has entered; keeps no speed into it.
void Leave(const Touch& touch, LooseStone& stone) noexcept {
  stone.position += touch.depth * touch.normal;
  const double into = math::Dot(stone.velocity, touch.normal);
  if (into < 0.0) stone.velocity -= into * touch.normal;
}

/// Out of the stones beside it, which stay where they are.
void LeaveStones(std::span<LooseStone* const> stones, std::size_t self, LooseStone& stone) noexcept {
  for (std::size_t i = 0; i < stones.size(); ++i) {
    if (i == self) continue;
    const Vec3 out = stone.position - stones[i]->position;
    const double depth = stone.radius + stones[i]->radius - math::Norm(out);
    // where two lie in one place, the later one goes aside
    if (depth > 0.0) Leave({{}, math::Normalized(out, {i < self ? 1.0 : -1.0, 0, 0}), depth}, stone);
  }
}

/// Slows what slides: Coulomb's friction, and the film of liquid under it.
void Rub(const Vec3& normal, const Vec3& gravity, double seconds, LooseStone& stone) noexcept {
  const double pressed = std::max(0.0, -math::Dot(gravity, normal));
  const double speed = math::Norm(stone.velocity);
  if (!(speed > 0.0)) return;
  const double slower = std::max(0.0, speed * Exp(-seconds / kWetSeconds) - kFriction * pressed * seconds);
  stone.velocity *= slower / speed;
}

void Move(const StoneGround& ground, double seconds, std::span<LooseStone* const> stones,
          std::size_t self) noexcept {
  LooseStone& stone = *stones[self];
  stone.velocity += seconds * ground.gravity;
  const double speed = math::Norm(stone.velocity);
  if (speed > kFastest) stone.velocity *= kFastest / speed;
  const double way = std::min(speed, kFastest) * seconds;
  const int steps = std::clamp(base::CeilTo<int>(way / (kStep * stone.radius)), 1, kMostSubsteps);
  const double dt = seconds / steps;
  std::optional<Sheet> under;
  Touch touched;
  double most_upright = 0;
  const Vec3 up = UpOf(ground);
  for (int step = 0; step < steps; ++step) {
    stone.position += dt * stone.velocity;
    under.reset();
    most_upright = 0;
    LeaveStones(stones, self, stone);
    for (const StonePusher& pusher : ground.pushers) {
      if (const auto push = FindPush(pusher, stone.position, stone.radius)) Leave(*push, stone);
    }
    // tissue last: it yields to no stone
    for (std::size_t i = 0; i < SheetCount(ground); ++i) {
      const Sheet sheet = SheetAt(ground, i);
      const auto touch = FindTouch(sheet, stone.position, stone.radius);
      if (!touch) continue;
      Leave(*touch, stone);
      const double upright = math::Dot(touch->normal, up);
      if (upright > most_upright) most_upright = upright, under = sheet, touched = *touch;
    }
    if (under) Rub(touched.normal, ground.gravity, dt, stone);
  }
  if (stone.position.z < ground.deepest + stone.radius) {
    stone.position.z = ground.deepest + stone.radius;
    stone.velocity = {};
    stone.support = LooseStone::kOnFloor;
    return;
  }
  if (math::Distance(stone.position, stone.anchor) > kStill) {
    stone.anchor = stone.position;
    stone.still_seconds = 0;
    return;
  }
  stone.still_seconds += seconds;
  if (under && stone.still_seconds >= kRestSeconds) LayDown(*under, touched, most_upright, stone);
}

}  // namespace

std::vector<double> DrawGallstones(const GallstoneSettings& settings, double capacity, std::uint64_t seed) {
  TROCAR_ASSERT(settings.count >= 0 && settings.count <= kMostGallstones && settings.median_diameter > 0);
  math::Random random(seed);
  std::vector<double> diameters;
  double unfilled = kMostFilling * capacity;
  for (int i = 0; i < settings.count; ++i) {
    // Box and Muller; cut off at three deviations
    const double u = 1.0 - random.Uniform(), v = random.Uniform();
    const double z = std::clamp(std::sqrt(-2.0 * Log(u)) * Cos(2.0 * std::numbers::pi * v), -3.0, 3.0);
    const double diameter = std::max(kSmallest, settings.median_diameter * Exp(kSpread * z));
    const double volume = std::numbers::pi / 6.0 * diameter * diameter * diameter;
    if (volume > unfilled) continue;
    unfilled -= volume;
    diameters.push_back(diameter);
  }
  return diameters;
}

double CalcPassingDiameter(double rim) noexcept {
  return std::max(0.0, rim) / std::numbers::pi;
}

double CalcStoneOutflow(double leaked, double content, std::size_t fitting) noexcept {
  if (!(leaked > 0.0) || !(content > 0.0)) return 0.0;
  return static_cast<double>(fitting) * std::min(1.0, leaked / content);
}

void MoveStones(const StoneGround& ground, double seconds, std::span<LooseStone* const> stones) noexcept {
  for (std::size_t i = 0; i < stones.size(); ++i) {
    LooseStone& stone = *stones[i];
    if (stone.IsLying()) {
      if (Carry(ground, stone)) continue;
      Loosen(stone);
    }
    Move(ground, seconds, stones, i);
  }
}

void ForgetSupports(std::span<LooseStone* const> stones) noexcept {
  for (LooseStone* stone : stones) {
    if (stone->support >= 0) Loosen(*stone);
  }
}

void VisitState(base::StateArchive& archive, LooseStone& stone) {
  archive.Field("position", stone.position);
  archive.Field("velocity", stone.velocity);
  archive.Field("support", stone.support);
  archive.Field("triangle", stone.triangle);
  archive.Field("weights", stone.weights);
  archive.Field("offset", stone.offset);
  archive.Field("upright", stone.upright);
  archive.Field("anchor", stone.anchor);
  archive.Field("still_seconds", stone.still_seconds);
}

}  // namespace trocar::surgery
