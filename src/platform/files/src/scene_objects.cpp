// SPDX-License-Identifier: Apache-2.0
#include "scene_objects.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "trocar/math/rotation_angle.h"

namespace trocar::files {
namespace {

using math::Vec3;
using rigid::RigidShape;

constexpr std::size_t kMaxPathPoints = 200;

std::string JoinColours() {
  std::string all;
  for (int i = 0; i < static_cast<int>(scene::ObjectColour::kCount); ++i)
    all += (all.empty() ? "" : ", ") + std::string(scene::ColourName(static_cast<scene::ObjectColour>(i)));
  return all;
}

/// Place [mm] and turn [deg] about x, then y, then z of the frame it stands in.
math::Pose ReadPlace(const host::JsonView& view) {
  math::Pose pose;
  if (view.Has("at_mm")) pose.translation = ReadPointMm(view, "at_mm");
  if (view.Has("turn_deg")) {
    const auto turn = view.Numbers("turn_deg", 3, range::kTurnDeg);
    pose.rotation = math::RotationAbout({0, 0, 1}, turn[2] * math::kDegree) *
                    math::RotationAbout({0, 1, 0}, turn[1] * math::kDegree) *
                    math::RotationAbout({1, 0, 0}, turn[0] * math::kDegree);
  }
  return pose;
}

/// A bent wire: a capsule from each point to the next.
void AddPath(const host::JsonView& view, std::vector<RigidShape>& shapes) {
  view.AllowOnly({"kind", "radius_mm", "points_mm"});
  const double radius = 0.001 * view.Number("radius_mm", range::kPathRadiusMm);
  std::vector<Vec3> points;
  for (const host::JsonView& one : view.Array("points_mm")) {
    const auto mm = one.AsNumbers(3, range::kPlaceMm);
    points.push_back(0.001 * Vec3{mm[0], mm[1], mm[2]});
  }
  if (points.size() < 2 || points.size() > kMaxPathPoints) {
    view.Complain("a path needs 2 to 200 points", base::ErrorCode::kSceneInvalid);
    return;
  }
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Vec3 along = points[i + 1] - points[i];
    const double length = math::Norm(along);
    if (!(length > 0)) {
      view.Complain("two points of a path are the same", base::ErrorCode::kSceneInvalid);
      return;
    }
    shapes.push_back({RigidShape::Kind::kCapsule,
                      {radius, 0, 0.5 * length},
                      {math::RotationBetween({0, 0, 1}, along / length), 0.5 * (points[i] + points[i + 1])}});
  }
}

void ReadShape(const host::JsonView& view, std::vector<RigidShape>& shapes) {
  const std::string kind = view.Text("kind");
  if (kind == "path") return AddPath(view, shapes);
  RigidShape shape;
  shape.X_body_shape = ReadPlace(view);
  const auto mm = [&](const char* key) { return 0.001 * view.Number(key, range::kShapeMm); };
  if (kind == "box") {
    view.AllowOnly({"kind", "at_mm", "turn_deg", "size_mm"});
    const auto size = view.Numbers("size_mm", 3, range::kShapeMm);
    for (int axis = 0; axis < 3; ++axis) shape.size[axis] = 0.0005 * size[static_cast<std::size_t>(axis)];
  } else if (kind == "cylinder") {
    view.AllowOnly({"kind", "at_mm", "turn_deg", "radius_mm", "height_mm"});
    shape.kind = RigidShape::Kind::kCylinder;
    shape.size = {mm("radius_mm"), 0, 0.5 * mm("height_mm")};
  } else if (kind == "capsule") {
    view.AllowOnly({"kind", "at_mm", "turn_deg", "radius_mm", "length_mm"});
    shape.kind = RigidShape::Kind::kCapsule;
    shape.size = {mm("radius_mm"), 0, 0.5 * mm("length_mm")};
  } else if (kind == "sphere") {
    view.AllowOnly({"kind", "at_mm", "radius_mm"});
    shape.kind = RigidShape::Kind::kSphere;
    shape.size.x = mm("radius_mm");
  } else if (kind == "ring") {
    view.AllowOnly({"kind", "at_mm", "turn_deg", "radius_mm", "thickness_mm"});
    shape.kind = RigidShape::Kind::kRing;
    shape.size = {mm("radius_mm"), 0.5 * mm("thickness_mm"), 0};
    if (shape.size.y >= shape.size.x)
      view.Complain("a ring must be thinner than it is wide: thickness_mm below 2 radius_mm",
                    base::ErrorCode::kSceneInvalid);
  } else {
    view.Complain(
        "there is no shape \"" + kind + "\"; known are box, cylinder, capsule, sphere, ring and path",
        base::ErrorCode::kUnknownName);
  }
  shapes.push_back(shape);
}

scene::SceneObject ReadObject(const host::JsonView& view) {
  view.AllowOnly({"name", "about", "shapes", "at_mm", "turn_deg", "mass_g", "friction", "colour", "grips"});
  scene::SceneObject object;
  object.name = view.Text("name");
  for (const host::JsonView& shape : view.Array("shapes")) ReadShape(shape, object.body.shapes);
  if (object.body.shapes.empty())
    view.Complain("an object needs at least one shape", base::ErrorCode::kSceneInvalid);
  object.body.X_world_body = ReadPlace(view);
  object.body.mass = 0.001 * view.NumberOr("mass_g", 0.0, range::kMassG);
  object.body.friction = view.NumberOr("friction", 0.8, range::kFriction);
  const std::string colour = view.TextOr("colour", "grey");
  if (const auto found = scene::FindColour(colour); found) {
    object.colour = *found;
  } else {
    view.Complain("there is no colour \"" + colour + "\"; known are " + JoinColours(),
                  base::ErrorCode::kUnknownName);
  }
  if (!view.Has("grips")) return object;
  for (const host::JsonView& one : view.Array("grips")) {
    one.AllowOnly({"at_mm", "across", "open_deg"});
    scene::ObjectGrip grip;
    grip.point = ReadPointMm(one, "at_mm");
    if (one.Has("across")) grip.across = ReadDirection(one, "across");
    if (one.Has("open_deg")) grip.opening = one.Number("open_deg", range::kGripOpenDeg) * math::kDegree;
    object.grips.push_back(grip);
  }
  return object;
}

}  // namespace

math::Vec3 ReadPointMm(const host::JsonView& view, std::string_view key, host::NumberRange each) {
  const auto mm = view.Numbers(key, 3, each);
  return 0.001 * math::Vec3{mm[0], mm[1], mm[2]};
}

math::Vec3 ReadDirection(const host::JsonView& view, std::string_view key) {
  const auto n = view.Numbers(key, 3, range::kDirection);
  const math::Vec3 direction{n[0], n[1], n[2]};
  if (!(math::Norm(direction) > 1e-6))
    view.Complain(std::string(key) + " is a direction: one of its parts must differ from 0",
                  base::ErrorCode::kSceneInvalid);
  return math::Normalized(direction, {1, 0, 0});
}

std::vector<scene::SceneObject> ReadObjects(const host::JsonView& scene, std::string_view key) {
  std::vector<scene::SceneObject> objects;
  for (const host::JsonView& view : scene.Array(key)) {
    if (objects.size() == scene::kMaxObjects) {
      view.Complain(
          "a scene may have at most 64 objects; join those that never move into one of several shapes",
          base::ErrorCode::kSceneInvalid);
      break;
    }
    objects.push_back(ReadObject(view));
    const auto same = [&](const scene::SceneObject& other) { return other.name == objects.back().name; };
    if (std::any_of(objects.begin(), objects.end() - 1, same))
      view.Complain("another object is called \"" + objects.back().name + "\" already; names must differ",
                    base::ErrorCode::kSceneInvalid);
  }
  return objects;
}

}  // namespace trocar::files
