// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/guides.h"

#include <algorithm>
#include <cmath>

#include "trocar/host/translate.h"
#include "trocar/presenter/pointer_map.h"
#include "trocar/presenter/read_outs.h"

namespace trocar::presenter {
namespace {

using math::Pose;
using math::Vec3;
using render::Material;
using rigid::RigidShape;
using view::Trail;

constexpr double kLineWidth = 0.0007, kRingWidth = 0.0009;   // m
constexpr double kFootRadius = 0.0035, kHoldRadius = 0.005;  // m
constexpr double kNextMargin = 0.004, kPlaceRadius = 0.006;  // m
constexpr double kFootLift = 0.0006;                         // above what it lies on [m]
constexpr double kNear = 0.003, kTouchRadius = 0.003;        // about to touch; of the ring that says so [m]
constexpr double kNearest = 0.0015;                          // nearer, the tip touches it [m]
constexpr double kClosedJaw = 0.06, kDash = 0.004;           // rad, m
constexpr int kRingSteps = 24;
constexpr int kMostSteps = 256;           // towards a shape
constexpr double kMet = 2e-5;             // so near is there [m]
constexpr double kStrandRadius = 0.0012;  // of fibres and fat between organs, as they are drawn [m]
constexpr std::array<Material, instrument::kHandCount> kHandColours = {Material::kBlueRubber,
                                                                       Material::kYellowRubber};

std::optional<double> Meet(const Vec3& from, const Vec3& way, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, p = math::Cross(way, ac);
  const double det = math::Dot(ab, p);
  if (std::fabs(det) < 1e-16) return std::nullopt;
  const Vec3 s = from - a;
  const double u = math::Dot(s, p) / det;
  if (u < 0 || u > 1) return std::nullopt;
  const Vec3 q = math::Cross(s, ab);
  const double v = math::Dot(way, q) / det, t = math::Dot(ac, q) / det;
  if (v < 0 || u + v > 1 || t < 0) return std::nullopt;
  return t;
}

/// From a shape's surface, negative inside; p in its frame.
double DistanceFrom(const RigidShape& shape, const Vec3& p) {
  const double across = std::hypot(p.x, p.y);
  switch (shape.kind) {
    case RigidShape::Kind::kBox: {
      const Vec3 out{std::fabs(p.x) - shape.size.x, std::fabs(p.y) - shape.size.y,
                     std::fabs(p.z) - shape.size.z};
      const Vec3 beyond{std::max(out.x, 0.0), std::max(out.y, 0.0), std::max(out.z, 0.0)};
      return math::Norm(beyond) + std::min(std::max({out.x, out.y, out.z}), 0.0);
    }
    case RigidShape::Kind::kCylinder: {
      const double out = across - shape.size.x, up = std::fabs(p.z) - shape.size.z;
      return std::hypot(std::max(out, 0.0), std::max(up, 0.0)) + std::min(std::max(out, up), 0.0);
    }
    case RigidShape::Kind::kCapsule:
      return std::hypot(across, std::max(std::fabs(p.z) - shape.size.z, 0.0)) - shape.size.x;
    case RigidShape::Kind::kSphere:
      return math::Norm(p) - shape.size.x;
    case RigidShape::Kind::kRing:
      return std::hypot(across - shape.size.x, p.z) - shape.size.y;
  }
  return kLongestGuide;
}

/// A shape from outside, by steps as long as nothing is near.
std::optional<double> MeetShape(const RigidShape& shape, const Vec3& from, const Vec3& way, double longest) {
  double at = 0;
  for (int step = 0; step < kMostSteps && at < longest; ++step) {
    const double distance = DistanceFrom(shape, from + at * way);
    if (distance < kMet) return at;
    at += distance;
  }
  return std::nullopt;
}

/// A ball from outside: nodes of a tube lie about as far apart as it is wide.
std::optional<double> MeetBall(const Vec3& from, const Vec3& way, const Vec3& centre, double radius) {
  const Vec3 to = centre - from;
  const double along = math::Dot(to, way), off2 = math::SquaredNorm(to) - along * along;
  if (along < 0 || off2 > radius * radius) return std::nullopt;
  return std::max(0.0, along - std::sqrt(radius * radius - off2));
}

/// Which goal is worked on: one that has begun, else the first that may be.
std::ptrdiff_t FindGoal(const scene::TaskSnapshot& now) {
  std::ptrdiff_t chosen = -1;
  for (std::size_t g = 0; g < now.goals.size(); ++g) {
    const bool may_be = now.phase == scene::TaskPhase::kReady ? g == 0 : now.goals[g].is_open;
    if (!may_be || now.goals[g].is_done) continue;
    const bool has_begun = now.goals[g].steps_done > 0;
    if (chosen < 0 || (has_begun && now.goals[static_cast<std::size_t>(chosen)].steps_done == 0))
      chosen = static_cast<std::ptrdiff_t>(g);
  }
  return chosen;
}

double FindRadius(const scene::SceneObject& object) {
  double radius = 0;
  for (const RigidShape& shape : object.body.shapes) {
    const double out = shape.kind == RigidShape::Kind::kBox ? std::hypot(shape.size.x, shape.size.y)
                                                            : shape.size.x + shape.size.y;
    radius = std::max(radius, math::Norm(shape.X_body_shape.translation) + out);
  }
  return radius;
}

void AddDepthLine(const scene::Scene& scene, std::span<const scene::SurfaceInfo> surfaces,
                  std::span<const scene::StrandInfo> strands, const simulation::Snapshot& snapshot, int hand,
                  std::vector<Trail>& trails) {
  const Vec3& tip = snapshot.instruments[static_cast<std::size_t>(hand)].X_world_tool.translation;
  const Vec3 way = scene.HasPatient() || scene.model
                       ? math::Rotate(snapshot.X_world_laparoscope.rotation,
                                      CalcSightLine(snapshot.X_world_laparoscope, tip))
                       : Vec3{0, 0, -1};
  const Material colour = kHandColours[static_cast<std::size_t>(hand)];
  const Vec3 to_eye = math::Rotate(snapshot.X_world_laparoscope.rotation, Vec3{0, 0, 1});
  if (snapshot.instruments[static_cast<std::size_t>(hand)].is_touching) {
    trails.push_back(MakeRing(tip, to_eye, kTouchRadius, Material::kMark));
    return;
  }
  const auto distance = FindDistanceAhead(scene, surfaces, strands, snapshot, tip, way);
  if (distance && *distance < kNear) trails.push_back(MakeRing(tip, to_eye, kTouchRadius, colour));
  if (!distance || *distance < kNearest) return;
  for (double at = 0; at < *distance; at += 2 * kDash)
    trails.push_back({{tip + at * way, tip + std::min(at + kDash, *distance) * way}, colour, kLineWidth});
  trails.push_back(MakeRing(tip + (*distance - kFootLift) * way, way, kFootRadius, colour));
}

}  // namespace

Trail MakeRing(const Vec3& centre, const Vec3& normal, double radius, Material material) {
  const math::Quaternion turn = math::RotationBetween({0, 0, 1}, normal);
  Trail ring{{}, material, kRingWidth};
  for (int i = 0; i <= kRingSteps; ++i) {
    const double angle = 2 * M_PI * i / kRingSteps;
    ring.points.push_back(centre +
                          math::Rotate(turn, Vec3{radius * std::cos(angle), radius * std::sin(angle), 0}));
  }
  return ring;
}

std::optional<double> FindDistanceAhead(const scene::Scene& scene,
                                        std::span<const scene::SurfaceInfo> surfaces,
                                        std::span<const scene::StrandInfo> strands,
                                        const simulation::Snapshot& snapshot, const Vec3& from,
                                        const Vec3& direction) noexcept {
  double nearest = kLongestGuide;
  const auto take = [&](const std::optional<double>& t) {
    if (t) nearest = std::min(nearest, *t);
  };
  for (std::size_t i = 0; i < scene.objects.size() && i < snapshot.objects.size(); ++i) {
    if (snapshot.objects[i].held_by != 0) continue;  // it goes with the jaws
    for (const RigidShape& shape : scene.objects[i].body.shapes) {
      const Pose X = math::Inverse(snapshot.objects[i].X_world_object * shape.X_body_shape);
      take(MeetShape(shape, X * from, math::Rotate(X.rotation, direction), nearest));
    }
  }
  const auto& is_intact = snapshot.operation.strand_is_intact;
  for (std::size_t i = 0; i < strands.size(); ++i) {
    if (i < is_intact.size() && is_intact[i] == 0) continue;
    const Vec3 &a = snapshot.positions[strands[i].a], &b = snapshot.positions[strands[i].b];
    const int balls = 1 + static_cast<int>(math::Distance(a, b) / kStrandRadius);
    for (int ball = 0; ball <= balls; ++ball)
      take(MeetBall(from, direction, math::Lerp(a, b, static_cast<double>(ball) / balls), kStrandRadius));
  }
  for (const scene::SurfaceInfo& tube : surfaces) {
    for (std::size_t i = 0; i < tube.radii.size(); ++i)
      take(MeetBall(from, direction, snapshot.positions[tube.first_node + i], tube.radii[i]));
  }
  const simulation::OperationSnapshot& cut = snapshot.operation;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const bool is_cut = i < cut.topology.first_triangle.size() && !cut.topology.triangles.empty();
    const auto triangles = is_cut
                               ? std::span(cut.topology.triangles)
                                     .subspan(cut.topology.first_triangle[i], cut.topology.triangle_count[i])
                               : std::span(surfaces[i].triangles);
    const Vec3* nodes = snapshot.positions.data() + (is_cut ? 0 : surfaces[i].first_node);
    for (const geometry::Triangle& t : triangles)
      take(Meet(from, direction, nodes[t[0]], nodes[t[1]], nodes[t[2]]));
  }
  if (nearest < kLongestGuide) return nearest;
  return std::nullopt;
}

NextStep FindNextStep(const scene::Task& task, const simulation::Snapshot& snapshot) {
  NextStep next;
  if (snapshot.task.IsOver()) return next;
  const std::ptrdiff_t goal = FindGoal(snapshot.task);
  if (goal < 0) return next;
  const auto g = static_cast<std::size_t>(goal);
  const auto& steps = task.goals[g].steps;
  const std::size_t step = snapshot.task.goals[g].steps_done;
  if (step >= steps.size()) return next;
  next.object = steps[step].object;
  const bool is_taken =
      next.object >= 0 && snapshot.objects[static_cast<std::size_t>(next.object)].held_by != 0;
  if (!is_taken) return next;
  for (std::size_t s = step; s < steps.size() && next.regions.empty(); ++s) {
    for (const int region : steps[s].regions) {
      const auto is_in = [&](const scene::ObjectSnapshot& one) {
        return one.held_by == 0 &&
               task.regions[static_cast<std::size_t>(region)].Contains(one.X_world_object.translation);
      };
      if (std::none_of(snapshot.objects.begin(), snapshot.objects.end(), is_in))
        next.regions.push_back(region);
    }
  }
  return next;
}

std::vector<Trail> MakeGuides(const scene::Scene& scene, std::span<const scene::SurfaceInfo> surfaces,
                              std::span<const scene::StrandInfo> strands,
                              const simulation::Snapshot& snapshot) {
  std::vector<Trail> trails;
  for (int hand = 0; hand < instrument::kHandCount; ++hand) {
    AddDepthLine(scene, surfaces, strands, snapshot, hand, trails);
    const auto& tool = snapshot.instruments[static_cast<std::size_t>(hand)];
    if (tool.is_grasping) {
      const Vec3 along = math::Rotate(tool.X_world_tool.rotation, Vec3{0, 0, 1});
      trails.push_back(MakeRing(tool.X_world_tool.translation + kHoldRadius * along, along, kHoldRadius,
                                kHandColours[static_cast<std::size_t>(hand)]));
    }
  }
  if (!scene.task) return trails;
  const NextStep next = FindNextStep(*scene.task, snapshot);
  if (next.object >= 0) {
    const auto object = static_cast<std::size_t>(next.object);
    trails.push_back(MakeRing(snapshot.objects[object].X_world_object.translation, {0, 0, 1},
                              FindRadius(scene.objects[object]) + kNextMargin, Material::kMark));
  }
  for (const int region : next.regions)
    trails.push_back(MakeRing(scene.task->regions[static_cast<std::size_t>(region)].centre, {0, 0, 1},
                              kPlaceRadius, Material::kMark));
  return trails;
}

std::string DescribeJaws(const scene::Scene& scene, const simulation::Snapshot& snapshot,
                         instrument::Hand hand) {
  const simulation::InstrumentSnapshot& now = snapshot.instruments[hand];
  if (now.object >= 0) return host::TranslateWith("holds {1}", {ObjectLabel(scene, now.object)});
  if (now.is_grasping) return host::TranslateWith("holds the {1}", {OrganLabel(scene.patient, now.organ)});
  const scene::InstrumentSetup& setup = scene.instruments[hand];
  const std::size_t place = snapshot.operation.tools[hand];
  const instrument::Tool& tool = place < setup.tray.size() ? setup.tray[place] : setup.tool;
  if (!(tool.max_jaw > 0)) return "";
  return now.joints.jaw > kClosedJaw ? host::TranslateIn("jaws", "open")
                                     : host::TranslateIn("jaws", "closed");
}

}  // namespace trocar::presenter
