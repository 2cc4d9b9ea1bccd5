// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/contact.h"

#include <algorithm>
#include <cmath>

#include "trocar/collision/queries.h"
#include "trocar/core/assert.h"
#include "trocar/geometry/distance.h"

namespace trocar::surgery {
namespace {

/// A pressed surface keeps its side while the new normal does not turn against the old one more than this
/// [-]: deep in a thin organ the far wall becomes the nearer one, and without memory the tool would be pushed
/// out there.
constexpr double kSideMemoryCosine = 0.2;

bool IsNear(const geometry::Box& box, const Vec3& p, double distance) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    if (p[axis] < box.min[axis] - distance || p[axis] > box.max[axis] + distance) return false;
  }
  return true;
}

Vec3 FaceNormal(std::span<const Vec3> nodes, const geometry::Triangle& t) noexcept {
  return math::Normalized(math::Cross(nodes[t[1]] - nodes[t[0]], nodes[t[2]] - nodes[t[0]]), Vec3{});
}

/// Nearest surface point with its outward normal and the sphere's signed distance.
struct Touch {
  std::uint32_t triangle;
  Vec3 point;
  std::array<double, 3> weights;
  Vec3 normal;
  double distance;
};

Touch FindTouch(const OrganSurface& organ, std::span<const Vec3> nodes, const Vec3& centre,
                ContactSample& sample, std::size_t organ_index) noexcept {
  const collision::SearchLimits limits{.first_guess = sample.last_triangle[organ_index]};
  const auto nearest = organ.hierarchy.FindNearest(nodes, centre, limits);
  const auto side = collision::FindSide(nodes, organ.triangles, organ.vertex_triangles, centre, nearest);
  Touch touch{nearest.triangle, nearest.point, nearest.weights, side.normal, side.distance};
  const bool is_other_side = sample.is_held[organ_index] != 0 &&
                             math::Dot(side.normal, sample.held_normal[organ_index]) < kSideMemoryCosine;
  if (is_other_side) {
    const auto& held = organ.triangles[sample.last_triangle[organ_index]];
    const auto on_held =
        geometry::FindNearestOnTriangle(centre, nodes[held[0]], nodes[held[1]], nodes[held[2]]);
    const Vec3 normal = FaceNormal(nodes, held);
    // the memory ends once the sphere is outside the wall it pressed
    if (math::Dot(centre - on_held.point, normal) < sample.radius) {
      touch = {sample.last_triangle[organ_index], on_held.point, on_held.weights, normal,
               math::Dot(centre - on_held.point, normal)};
    }
  }
  return touch;
}

/// One sphere against one organ.
struct ContactTarget {
  const OrganSurface& organ;
  std::span<const Vec3> nodes;
  Vec3 centre;
  double radius, stiffness;
  std::uint8_t hand, organ_index;
};

/// Spring that pushes a point of a triangle along `normal` out of the sphere.
void AddContact(const ContactTarget& target, std::uint32_t triangle, const std::array<double, 3>& weights,
                const Vec3& normal, ContactSet& contacts) noexcept {
  if (contacts.springs.size() == ContactSet::kCapacity) {
    ++contacts.dropped;
    return;
  }
  tissue::ContactSpring spring;
  for (int corner = 0; corner < 3; ++corner) {
    spring.nodes[corner] = target.organ.first_node + target.organ.triangles[triangle][corner];
  }
  spring.weights = weights;
  spring.normal = normal;
  spring.offset = math::Dot(normal, target.centre) + target.radius;
  spring.stiffness = target.stiffness;
  contacts.springs.push_back(spring);
  contacts.hand.push_back(target.hand);
  contacts.organ.push_back(target.organ_index);
}

/// While the centre is outside, every triangle in reach is pushed away from it: in a dent the walls hold the
/// tool from all sides, and one nearest point alone would throw it from wall to wall.
void AddSurroundingContacts(const ContactTarget& target, double reach, ContactSet& contacts) noexcept {
  constexpr std::size_t kMost = 32;
  constexpr double kSamePoint =
      1e-6;  // [m]; neighbours share the nearest point where it is a vertex or on an edge
  std::array<std::uint32_t, kMost> triangles;
  const collision::Capsule sphere{{target.centre, target.centre}, reach};
  const std::size_t found =
      collision::FindTrianglesInCapsule(target.organ.hierarchy, target.nodes, sphere, triangles);
  std::array<Vec3, kMost> points;
  std::size_t count = 0;
  for (std::size_t i = 0; i < std::min(found, kMost); ++i) {
    const auto& t = target.organ.triangles[triangles[i]];
    const auto nearest = geometry::FindNearestOnTriangle(target.centre, target.nodes[t[0]],
                                                         target.nodes[t[1]], target.nodes[t[2]]);
    const bool is_known = std::any_of(
        points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count),
        [&](const Vec3& p) { return math::SquaredDistance(p, nearest.point) < kSamePoint * kSamePoint; });
    const Vec3 away = nearest.point - target.centre;
    if (is_known || !(math::SquaredNorm(away) > 0.0)) continue;
    points[count++] = nearest.point;
    AddContact(target, triangles[i], nearest.weights, math::Normalized(away), contacts);
  }
}

}  // namespace

ToolSamples MakeToolSamples(const instrument::Tool& tool, const ContactSettings& settings,
                            std::size_t organ_count) {
  ToolSamples made;
  const auto add = [&](ContactSample::Part part, double along, double radius) {
    ContactSample sample{part, along, radius, {}, {}, {}};
    sample.last_triangle.assign(organ_count, collision::kNoTriangle);
    sample.held_normal.assign(organ_count, Vec3{});
    sample.is_held.assign(organ_count, 0);
    made.samples.push_back(std::move(sample));
  };
  const auto add_row = [&](ContactSample::Part part, double length, double radius) {
    const int steps = std::max(1, static_cast<int>(std::lround(length / settings.sample_step)));
    for (int i = 1; i <= steps; ++i) add(part, length * i / steps, radius);
  };
  // the jaw's last sphere ends where the metal ends
  const double jaw_radius = 0.5 * tool.jaw_width;
  add_row(ContactSample::Part::kUpperJaw, tool.jaw_length - jaw_radius, jaw_radius);
  add_row(ContactSample::Part::kLowerJaw, tool.jaw_length - jaw_radius, jaw_radius);
  add(ContactSample::Part::kShaft, 0.0, tool.shaft_radius);
  add_row(ContactSample::Part::kShaft, settings.shaft_reach, tool.shaft_radius);
  return made;
}

void ResetToolSamples(ToolSamples& samples) noexcept {
  for (ContactSample& sample : samples.samples) {
    std::fill(sample.last_triangle.begin(), sample.last_triangle.end(), collision::kNoTriangle);
    std::fill(sample.is_held.begin(), sample.is_held.end(), std::uint8_t{0});
  }
}

Vec3 CalcSampleCentre(const instrument::Tool& tool, const ContactSample& sample, double jaw) noexcept {
  const Vec3 hinge = instrument::JawHinge(tool);
  if (sample.part == ContactSample::Part::kShaft) return hinge + Vec3{0, 0, sample.along};
  const int side = sample.part == ContactSample::Part::kUpperJaw ? +1 : -1;
  return math::Lerp(hinge, instrument::JawTip(tool, jaw, side), sample.along / tool.jaw_length);
}

ContactSet::ContactSet() {
  springs.reserve(kCapacity);
  hand.reserve(kCapacity);
  organ.reserve(kCapacity);
}

void ContactSet::Clear() noexcept {
  springs.clear();
  hand.clear();
  organ.clear();
  dropped = 0;
}

void FindContacts(const instrument::Tool& tool, const Pose& X_world_tool, double jaw, std::uint8_t hand,
                  std::span<const OrganSurface> organs, std::span<const Vec3> positions,
                  const ContactSettings& settings, std::int32_t grasped_organ, ToolSamples& samples,
                  ContactSet& contacts) noexcept {
  for (ContactSample& sample : samples.samples) {
    const Vec3 centre = X_world_tool * CalcSampleCentre(tool, sample, jaw);
    for (std::size_t index = 0; index < organs.size(); ++index) {
      const OrganSurface& organ = organs[index];
      const bool is_in_jaws =
          static_cast<std::int32_t>(index) == grasped_organ && sample.part != ContactSample::Part::kShaft;
      const double reach = sample.radius + settings.margin;
      if (is_in_jaws || !IsNear(organ.box, centre, reach)) {
        sample.is_held[index] = 0;
        continue;
      }
      const auto nodes = organ.Nodes(positions);
      const Touch touch = FindTouch(organ, nodes, centre, sample, index);
      sample.last_triangle[index] = touch.triangle;
      const bool is_touching = touch.distance < reach && math::SquaredNorm(touch.normal) > 0.0;
      sample.is_held[index] = is_touching && touch.distance < sample.radius;
      sample.held_normal[index] = touch.normal;
      if (!is_touching) continue;
      const ContactTarget target{
          organ, nodes, centre, sample.radius, settings.stiffness, hand, static_cast<std::uint8_t>(index)};
      if (touch.distance > 0.0) {
        AddSurroundingContacts(target, reach, contacts);
      } else {
        AddContact(target, touch.triangle, touch.weights, -touch.normal, contacts);
      }
    }
  }
}

ContactReaction CalcContactReaction(const ContactSet& contacts, std::uint8_t hand,
                                    std::span<const Vec3> positions) noexcept {
  ContactReaction reaction;
  for (std::size_t i = 0; i < contacts.springs.size(); ++i) {
    if (contacts.hand[i] != hand) continue;
    const tissue::ContactSpring& spring = contacts.springs[i];
    const double depth = tissue::CalcContactDepth(spring, positions);
    if (!(depth > 0.0)) continue;
    reaction.force -= (spring.stiffness * depth) * spring.normal;
    if (depth > reaction.deepest) {
      reaction.deepest = depth;
      reaction.organ = contacts.organ[i];
    }
  }
  return reaction;
}

}  // namespace trocar::surgery
