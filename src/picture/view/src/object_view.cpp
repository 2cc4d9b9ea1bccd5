// SPDX-License-Identifier: Apache-2.0
#include "object_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "trainer_box.h"
#include "trocar/geometry/primitives.h"
#include "trocar/geometry/tube.h"
#include "trocar/view/labels.h"

namespace trocar::view {
namespace {

using geometry::TriangleMesh;
using math::Pose;
using math::Vec3;
using render::Material;
using rigid::RigidShape;
using scene::ObjectColour;

constexpr int kSides = 28;
constexpr int kRingSteps = 44, kRingSides = 12;
constexpr int kMarkSides = 6;              // of a line's section
constexpr double kMarkThickness = 0.0006;  // half of a mark's line [m]
constexpr double kBandMark = 0.00045;      // likewise, of a ring round a duct [m]

/// Torus about z: as a closed tube would be, without a seam.
/// \param around  sides of its section
TriangleMesh MakeTorus(double radius, double section, int around) {
  TriangleMesh mesh;
  for (int i = 0; i < kRingSteps; ++i) {
    const double u = 2 * M_PI * i / kRingSteps;
    const Vec3 out{std::cos(u), std::sin(u), 0};
    for (int j = 0; j < around; ++j) {
      const double v = 2 * M_PI * j / around;
      mesh.positions.push_back((radius + section * std::cos(v)) * out + Vec3{0, 0, section * std::sin(v)});
    }
  }
  const auto at = [around](int i, int j) {
    return static_cast<std::uint32_t>((i % kRingSteps) * around + j % around);
  };
  for (int i = 0; i < kRingSteps; ++i) {
    for (int j = 0; j < around; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

/// Straight tube along z between two heights; its ends are flat where the radii do not fall.
TriangleMesh MakeRod(std::vector<double> heights, std::vector<double> radii) {
  geometry::CentreLine axis;
  for (const double z : heights) axis.points.push_back({0, 0, z});
  axis.radii = std::move(radii);
  return geometry::MakeTube(axis, kSides);
}

/// A board of such a colour is a mat with lines on it.
bool IsPale(ObjectColour colour) {
  return colour == ObjectColour::kGrey || colour == ObjectColour::kWhite;
}

}  // namespace

Material MaterialOf(ObjectColour colour) {
  switch (colour) {
    case ObjectColour::kRed:
      return Material::kRedRubber;
    case ObjectColour::kYellow:
      return Material::kYellowRubber;
    case ObjectColour::kGreen:
      return Material::kGreenRubber;
    case ObjectColour::kBlue:
      return Material::kBlueRubber;
    case ObjectColour::kWhite:
      return Material::kWhitePlastic;
    case ObjectColour::kBlack:
      return Material::kShaft;
    case ObjectColour::kSteel:
      return Material::kSteel;
    case ObjectColour::kGrey:
    case ObjectColour::kCount:
      break;
  }
  return Material::kSleeve;
}

TriangleMesh MakeCapsule(double radius, double half_length) {
  constexpr int kSteps = 5;
  std::vector<double> heights, radii;
  for (int end : {-1, 1}) {
    for (int i = 0; i <= kSteps; ++i) {
      const double angle = 0.5 * M_PI * (end < 0 ? kSteps - i : i) / kSteps;
      heights.push_back(end * (half_length + radius * std::sin(angle)));
      radii.push_back(std::max(0.02 * radius, radius * std::cos(angle)));
    }
  }
  return MakeRod(std::move(heights), std::move(radii));
}

namespace {

TriangleMesh MakeShape(const RigidShape& shape) {
  const Vec3& s = shape.size;
  switch (shape.kind) {
    case RigidShape::Kind::kBox:
      return MakeFacedBox(-1.0 * s, s);
    case RigidShape::Kind::kCylinder:
      return MakeRod({-s.z, s.z}, {s.x, s.x});
    case RigidShape::Kind::kCapsule:
      return MakeCapsule(s.x, std::max(s.z, 1e-5));
    case RigidShape::Kind::kSphere:
      return geometry::MakeSphere({}, s.x, 3);
    case RigidShape::Kind::kRing:
      return MakeTorus(s.x, s.y, kRingSides);
  }
  return {};
}

void Append(TriangleMesh& to, const TriangleMesh& mesh, const Pose& X) {
  const auto first = static_cast<std::uint32_t>(to.positions.size());
  for (const Vec3& p : mesh.positions) to.positions.push_back(X * p);
  for (const auto& t : mesh.triangles) to.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

/// Lines of a mark about the origin.
TriangleMesh MakeMark(const scene::Region& region) {
  TriangleMesh mesh;
  const double reach = region.radius > 0 ? region.radius : std::min(region.half.x, region.half.y);
  switch (region.mark) {
    case scene::RegionMark::kBall:
      return geometry::MakeSphere({}, reach, 3);
    case scene::RegionMark::kRing:
      Append(mesh, MakeTorus(reach, kMarkThickness, kMarkSides),
             {{}, {0, 0, region.radius > 0 ? 0.0 : -0.5 * region.half.z}});
      break;
    case scene::RegionMark::kCage:
      Append(mesh, MakeTorus(reach, kMarkThickness, kMarkSides), {});
      Append(mesh, MakeTorus(reach, kMarkThickness, kMarkSides),
             {math::RotationAbout({1, 0, 0}, M_PI / 2), {}});
      Append(mesh, MakeTorus(reach, kMarkThickness, kMarkSides),
             {math::RotationAbout({0, 1, 0}, M_PI / 2), {}});
      break;
    case scene::RegionMark::kBand:
    case scene::RegionMark::kNone:
      break;
  }
  return mesh;
}

}  // namespace

void ObjectView::AddMark(render::Renderer& renderer, std::size_t index, const simulation::Snapshot& start) {
  const scene::Region& region = task_->regions[index];
  if (region.mark == scene::RegionMark::kNone) return;
  Mark mark;
  mark.region = index;
  TriangleMesh mesh = MakeMark(region);
  Pose X{{}, region.centre};
  if (region.mark == scene::RegionMark::kBand) {
    const auto pieces =
        std::span(start.operation.topology.tube_pieces).first(start.operation.topology.tube_piece_count);
    double nearest = std::numeric_limits<double>::infinity(), radius = 0;
    for (const surgery::TubePiece& piece : pieces) {
      const Vec3 &a = start.positions[piece.a], &b = start.positions[piece.b];
      const double t = std::clamp(math::Dot(region.centre - a, b - a) / math::SquaredNorm(b - a), 0.0, 1.0);
      const double distance = math::Distance(region.centre, math::Lerp(a, b, t));
      if (!(distance < nearest)) continue;
      nearest = distance;
      radius = std::lerp(piece.radius_a, piece.radius_b, t);
      mark.is_on_tube = true, mark.a = piece.a, mark.b = piece.b, mark.t = t;
    }
    mesh = MakeTorus(radius + 0.5 * kBandMark, kBandMark, kMarkSides);
  }
  if (region.facing) {
    // it sits in a socket, so that its open side shows
    X.rotation = math::RotationBetween({0, 0, 1}, *region.facing);
    const double r = region.radius;
    view::Append(mesh, MakeRod({-1.7 * r, -0.2 * r}, {1.5 * r, 1.5 * r}), {});
  }
  if (region.mark == scene::RegionMark::kBall && walls_ != render::SurfaceId{})
    still_shades_.push_back({region.centre, region.centre, region.radius});
  mark.idle = renderer.AddSurface(mesh, Material::kSleeve);
  mark.next = renderer.AddSurface(mesh, Material::kMark);
  mark.X_world_mark = X;
  marks_.push_back(mark);
}

void ObjectView::Add(render::Renderer& renderer, const scene::Scene& scene,
                     const simulation::Snapshot& start) {
  if (HasTrainerBox(scene)) AddStill(renderer, scene);
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const scene::SceneObject& object = scene.objects[i];
    if (HasTrainerBox(scene) && !object.Moves()) continue;
    for (const RigidShape& shape : object.body.shapes) {
      if (object.Moves()) AddShade(i, shape);
      parts_.push_back(
          {renderer.AddSurface(MakeShape(shape), MaterialOf(object.colour)), i, shape.X_body_shape});
    }
  }
  task_ = scene.task;
  if (!task_) return;
  for (std::size_t region = 0; region < task_->regions.size(); ++region) AddMark(renderer, region, start);
}

/// The box, and what stands still in it, each with the shade of all.
void ObjectView::AddStill(render::Renderer& renderer, const scene::Scene& scene) {
  struct Piece {
    std::size_t object = 0;
    const RigidShape* shape = nullptr;
    Pose X_world_piece;
    TriangleMesh mesh;
    Material material = Material::kBoxWall;
  };
  std::vector<Piece> pieces;
  std::vector<TriangleMesh> in_world;
  const auto place = [&](const Piece& piece, TriangleMesh& to) {
    to = {};
    view::Append(to, piece.mesh, piece.X_world_piece);
  };
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const scene::SceneObject& object = scene.objects[i];
    if (object.Moves()) continue;
    for (const RigidShape& shape : object.body.shapes) {
      pieces.push_back(
          {i, &shape, object.body.X_world_body * shape.X_body_shape, MakeShape(shape),
           IsBoard(shape) && IsPale(object.colour) ? Material::kBoard : MaterialOf(object.colour)});
      place(pieces.back(), in_world.emplace_back());
    }
  }
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (!IsBoard(*pieces[i].shape)) continue;
    pieces[i].mesh = MakeBoard(pieces[i].shape->size, pieces[i].X_world_piece, in_world);
    place(pieces[i], in_world[i]);
  }
  in_world.push_back(MakeTrainerBox(scene));
  const std::vector<std::vector<double>> open = CalcTrainerOpenness(in_world);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    parts_.push_back({renderer.AddSurface(pieces[i].mesh, pieces[i].material, open[i]), pieces[i].object,
                      pieces[i].shape->X_body_shape});
  }
  walls_ = renderer.AddSurface(in_world.back(), Material::kBoxWall, open.back());
}

/// A ring throws a ring's shadow, all else that of a rod through its longest axis.
void ObjectView::AddShade(std::size_t object, const RigidShape& shape) {
  if (shape.kind == RigidShape::Kind::kRing) {
    rings_.push_back({object, shape.X_body_shape, shape.size.x, shape.size.y});
    return;
  }
  Rod rod{object, shape.X_body_shape, {}, shape.size.x};
  switch (shape.kind) {
    case RigidShape::Kind::kBox: {
      const Vec3& half = shape.size;
      const int longest = half.x >= half.y && half.x >= half.z ? 0 : half.y >= half.z ? 1 : 2;
      rod.radius = 0.5 * (half.x + half.y + half.z - half[longest]);
      rod.half_span[longest] = std::max(0.0, half[longest] - rod.radius);
      break;
    }
    case RigidShape::Kind::kCylinder:
    case RigidShape::Kind::kCapsule:
      rod.half_span.z = shape.size.z;
      break;
    case RigidShape::Kind::kSphere:
    case RigidShape::Kind::kRing:
      break;
  }
  rods_.push_back(rod);
}

void ObjectView::Append(const simulation::Snapshot& snapshot,
                        std::vector<render::SurfaceDraw>& surfaces) const {
  for (const Part& part : parts_)
    surfaces.push_back({part.surface, snapshot.objects[part.object].X_world_object * part.X_object_part,
                        MakeLabel(LabelClass::kObject, part.object)});
  if (!task_) return;
  const std::vector<int> next = FindNextRegions(snapshot.task);
  for (const Mark& mark : marks_) {
    const bool is_next = std::find(next.begin(), next.end(), static_cast<int>(mark.region)) != next.end();
    Pose X = mark.X_world_mark;
    if (mark.is_on_tube) {
      const Vec3 &a = snapshot.positions[mark.a], &b = snapshot.positions[mark.b];
      X = {math::RotationBetween({0, 0, 1}, math::Normalized(b - a, {0, 0, 1})), math::Lerp(a, b, mark.t)};
    }
    surfaces.push_back({is_next ? mark.next : mark.idle, X, MakeLabel(LabelClass::kMark, mark.region)});
  }
}

void ObjectView::AppendShades(const simulation::Snapshot& snapshot, render::Frame& frame) const {
  frame.ring_shades.clear();
  for (const Ring& ring : rings_) {
    if (frame.ring_shades.size() == render::kMaxRingShades) break;
    const Pose X_world_ring = snapshot.objects[ring.object].X_world_object * ring.X_object_ring;
    frame.ring_shades.push_back({X_world_ring.translation, ring.radius});
    frame.ring_section = ring.section;
  }
  for (const render::Shade& shade : still_shades_) {
    if (frame.shades.size() < render::kMaxShades) frame.shades.push_back(shade);
  }
  for (const Rod& rod : rods_) {
    if (frame.shades.size() == render::kMaxShades) break;
    const Pose X = snapshot.objects[rod.object].X_world_object * rod.X_object_rod;
    frame.shades.push_back({X * (-1.0 * rod.half_span), X * rod.half_span, rod.radius});
  }
}

/// Of the goal that is being worked on, else of the first that may be: where it leads to next.
std::vector<int> ObjectView::FindNextRegions(const scene::TaskSnapshot& now) const {
  std::ptrdiff_t chosen = -1;
  for (std::size_t g = 0; g < now.goals.size(); ++g) {
    const bool may_be = now.phase == scene::TaskPhase::kReady ? g == 0 : now.goals[g].is_open;
    if (may_be && (chosen < 0 || (now.goals[g].steps_done > 0 &&
                                  now.goals[static_cast<std::size_t>(chosen)].steps_done == 0)))
      chosen = static_cast<std::ptrdiff_t>(g);
  }
  if (chosen < 0) return {};
  const auto g = static_cast<std::size_t>(chosen);
  const auto& steps = task_->goals[g].steps;
  for (std::size_t step = now.goals[g].steps_done; step < steps.size(); ++step) {
    if (!steps[step].regions.empty()) return steps[step].regions;
  }
  return {};
}

}  // namespace trocar::view
