// SPDX-License-Identifier: Apache-2.0
#include "neighbour_template.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/primitives.h"
#include "trocar/geometry/tube.h"
#include "trocar/math/elementary.h"
#include "trocar/meshing/mesh_repair.h"
#include "trocar/meshing/nearest_surface.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using geometry::CentreLine;
using geometry::TriangleMesh;

// the generator's mean liver, for which the widths below are given [m]
constexpr double kMeanWidth = 0.212, kMeanHeight = 0.162, kMeanDepth = 0.112;
constexpr double kGap = 0.0015;  // kept between surfaces [m]
constexpr int kRounds = 60;      // of moving a centre line out of what is in its way

/// What the template is laid by.
struct Marks {
  geometry::Box liver;
  math::Vec3 fundus, neck;
  double midline = 0;
  double size = 1;  ///< of this body against the mean one [-]

  /// A place by: right or left of the spine, height, and how far in front of the liver's back [m].
  math::Vec3 At(double left, double y, double front) const {
    return {midline + size * left, y, liver.min.z + size * front};
  }
};

Marks FindMarks(const patient::Patient& patient, double midline) {
  const int liver = patient.OrganOf(roles::OrganRole::kLiver);
  const patient::Landmark* fundus = patient.LandmarkOf(roles::LandmarkRole::kFundus);
  const patient::Landmark* neck = patient.LandmarkOf(roles::LandmarkRole::kInfundibulum);
  TROCAR_ASSERT(liver >= 0 && fundus != nullptr && neck != nullptr);
  Marks marks;
  marks.liver = geometry::CalcBox(patient.organs[static_cast<std::size_t>(liver)].mesh.positions);
  marks.fundus = fundus->position, marks.neck = neck->position;
  marks.midline = midline;
  const math::Vec3 sides = marks.liver.max - marks.liver.min;
  marks.size = std::clamp(math::Cbrt(sides.x / kMeanWidth * (sides.y / kMeanHeight) * (sides.z / kMeanDepth)),
                          0.8, 1.25);
  return marks;
}

/// Bodies that a template keeps out of.
class Obstacles {
 public:
  void Add(const TriangleMesh& mesh) { surfaces_.emplace_back(&mesh, meshing::NearestSurface(mesh)); }

  /// How far and whereto a ball must go to lie outside; no way where it does.
  math::Vec3 FindWayOut(const math::Vec3& p, double radius) const {
    math::Vec3 way;
    for (const auto& [mesh, surface] : surfaces_) {
      const auto near = surface.Find(p);
      const geometry::Triangle& t = mesh->triangles[near.triangle];
      const math::Vec3 a = mesh->positions[t[0]];
      const math::Vec3 outward = math::Normalized(
          math::Cross(mesh->positions[t[1]] - a, mesh->positions[t[2]] - a), math::Vec3{0, -1, 0});
      const math::Vec3 to = p - near.at.point;
      const bool is_inside = math::Dot(to, outward) < 0;
      const double depth = radius + kGap + (is_inside ? near.distance : -near.distance);
      if (depth <= 0) continue;
      way += depth * (is_inside || near.distance < 1e-6 ? outward : to / near.distance);
    }
    return way;
  }

 private:
  std::vector<std::pair<const TriangleMesh*, meshing::NearestSurface>> surfaces_;
};

/// Moves a line out of what is in its way, and keeps it smooth.
void MoveOut(const Obstacles& obstacles, CentreLine& line) {
  const std::size_t n = line.points.size();
  for (int round = 0; round < kRounds; ++round) {
    bool is_clear = true;
    for (std::size_t i = 0; i < n; ++i) {
      const math::Vec3 way = obstacles.FindWayOut(line.points[i], line.radii[i]);
      if (math::Norm(way) <= 0) continue;
      line.points[i] += 0.5 * way;
      is_clear = false;
    }
    if (is_clear) return;
    const std::vector<math::Vec3> before = line.points;
    for (std::size_t i = 1; i + 1 < n; ++i)
      line.points[i] = 0.5 * before[i] + 0.25 * (before[i - 1] + before[i + 1]);
  }
  // what is left in the way is narrowed
  for (std::size_t i = 0; i < n; ++i) {
    const double way = math::Norm(obstacles.FindWayOut(line.points[i], line.radii[i]));
    line.radii[i] = std::max(0.3 * line.radii[i], line.radii[i] - way);
  }
}

struct TubeShape {
  roles::NeighbourRole role;
  CentreLine line;
  double spacing = 0.008;  ///< of its rings [m]
  int sides = 14;
  double haustra = 0;  ///< depth of its bulges [-]
};

TriangleMesh MakeTemplateTube(const TubeShape& shape, const Obstacles& obstacles) {
  CentreLine line = geometry::Resample(shape.line, shape.spacing);
  MoveOut(obstacles, line);
  constexpr double kPitch = 0.026;  // of haustra [m]
  const double length = geometry::CalcLength(line);
  double along = 0;
  std::vector<double> radii = line.radii;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    if (i > 0) along += math::Distance(line.points[i], line.points[i - 1]);
    if (shape.haustra > 0)
      radii[i] *= 1.0 - shape.haustra * (1.0 - std::sqrt(std::fabs(math::Sin(M_PI * along / kPitch))));
    // round ends
    const double end = std::min(along, length - along) / line.radii[i];
    if (end < 1.0) radii[i] *= std::max(0.35, std::sqrt(1.0 - (1.0 - end) * (1.0 - end)));
  }
  line.radii = std::move(radii);
  TriangleMesh mesh = geometry::MakeTube(line, shape.sides);
  // rings crowd on the inner side of a bend
  for (math::Vec3& p : mesh.positions) p = 1000.0 * p;
  meshing::RepairMesh(mesh);
  for (math::Vec3& p : mesh.positions) p = 0.001 * p;
  return mesh;
}

std::vector<TubeShape> ListTubes(const Marks& m) {
  const double s = m.size, top = m.liver.max.y, bottom = m.liver.min.y, front = m.liver.max.z;
  const auto scaled = [s](std::vector<double> radii) {
    for (double& radius : radii) radius *= s;
    return radii;
  };
  const math::Vec3 f = m.fundus, n = m.neck;
  const auto along_colon = [&](double left, double y, double behind) {
    return math::Vec3{m.midline + s * left, y, front - s * behind};
  };
  return {
      {roles::NeighbourRole::kStomach,
       {{m.At(0.072, top - 0.030, 0.030), m.At(0.082, top - 0.062, 0.042), m.At(0.078, top - 0.100, 0.058),
         m.At(0.056, n.y - 0.028, 0.072), m.At(0.030, n.y - 0.026, 0.066), m.At(0.012, n.y - 0.016, 0.056)},
        scaled({0.030, 0.036, 0.034, 0.026, 0.018, 0.011})},
       0.009,
       20},
      {roles::NeighbourRole::kDuodenum,
       {{m.At(0.006, n.y - 0.016, 0.054), m.At(-0.018, n.y - 0.012, 0.050), m.At(-0.036, n.y - 0.034, 0.036),
         m.At(-0.036, n.y - 0.070, 0.028), m.At(-0.012, n.y - 0.086, 0.028), m.At(0.024, n.y - 0.080, 0.030)},
        scaled({0.013, 0.013, 0.013, 0.012, 0.012, 0.012})},
       0.006,
       14},
      {roles::NeighbourRole::kColon,
       {{m.At(-0.108, bottom - 0.040, 0.014), m.At(-0.106, bottom + 0.000, 0.026),
         math::Vec3{f.x - 0.030, f.y - 0.020, f.z - 0.048}, math::Vec3{f.x + 0.020, f.y - 0.024, f.z - 0.040},
         along_colon(-0.010, f.y - 0.058, 0.050), along_colon(0.070, f.y - 0.046, 0.050),
         m.At(0.118, top - 0.096, 0.050), m.At(0.116, bottom - 0.030, 0.022)},
        scaled({0.022, 0.022, 0.020, 0.020, 0.020, 0.020, 0.019, 0.018})},
       0.0065,
       16,
       0.22},
      {roles::NeighbourRole::kPancreas,
       {{m.At(-0.016, n.y - 0.044, 0.040), m.At(-0.006, n.y - 0.032, 0.044), m.At(0.010, n.y - 0.024, 0.046),
         m.At(0.050, n.y - 0.012, 0.042), m.At(0.092, n.y + 0.006, 0.014)},
        scaled({0.013, 0.012, 0.009, 0.010, 0.008})},
       0.006,
       12},
      {roles::NeighbourRole::kVenaCava,
       {{m.At(-0.019, bottom - 0.060, 0.014), m.At(-0.020, 0.5 * (top + bottom), 0.014),
         m.At(-0.022, top - 0.010, 0.014)},
        scaled({0.011, 0.011, 0.010})},
       0.010,
       14},
      {roles::NeighbourRole::kAorta,
       {{m.At(0.009, bottom - 0.060, 0.017), m.At(0.007, 0.5 * (top + bottom), 0.014),
         m.At(0.005, top + 0.010, 0.010)},
        scaled({0.0095, 0.0105, 0.0115})},
       0.010,
       14},
      {roles::NeighbourRole::kPortalVein,
       {{m.At(0.002, n.y - 0.032, 0.036), m.At(-0.002, n.y - 0.014, 0.040),
         n + s * math::Vec3{0.016, 0.002, -0.010}},
        scaled({0.0065, 0.0065, 0.0055})},
       0.004,
       12},
      {roles::NeighbourRole::kSpine,
       {{m.At(0, bottom - 0.060, -0.008), m.At(0, 0.5 * (top + bottom), -0.012),
         m.At(0, top + 0.010, -0.016)},
        scaled({0.019, 0.018, 0.016})},
       0.011,
       16}};
}

/// A ball, flattened and with a hollow on the side of the spine.
TriangleMesh MakeKidney(const Marks& m, const Obstacles& obstacles) {
  TriangleMesh kidney = geometry::MakeSphere({0, 0, 0}, 1.0, 3);
  const math::Vec3 radii = m.size * math::Vec3{0.026, 0.050, 0.024};
  math::Vec3 centre = m.At(-0.070, m.liver.min.y + 0.030 * m.size, -0.006);
  const double middle = (radii.x + radii.z) / 2;
  for (int round = 0; round < kRounds; ++round) {
    // three balls along its length
    math::Vec3 way;
    for (const double part : {-0.5, 0.0, 0.5})
      way += obstacles.FindWayOut(centre + math::Vec3{0, part * radii.y, 0}, middle) / 3.0;
    if (math::Norm(way) <= 0) break;
    // caudal and backwards is free
    centre += 0.6 * math::Norm(way) * math::Normalized(math::Vec3{0, -0.8, -0.6});
  }
  for (math::Vec3& p : kidney.positions) {
    const double hollow = 0.30 * math::Exp(-6.0 * p.y * p.y) * std::max(0.0, p.x) * std::max(0.0, p.x);
    p = centre + math::Vec3{radii.x * (p.x - hollow), radii.y * p.y, radii.z * p.z};
  }
  return kidney;
}

}  // namespace

std::vector<patient::Neighbour> MakeTemplateNeighbours(const patient::Patient& patient, double midline) {
  const Marks marks = FindMarks(patient, midline);
  Obstacles organs;
  for (const patient::Organ& organ : patient.organs) organs.Add(organ.mesh);
  for (const patient::Neighbour& seen : patient.neighbours) organs.Add(seen.mesh);
  std::vector<patient::Neighbour> made;
  const auto add = [&](roles::NeighbourRole role, TriangleMesh mesh) {
    made.push_back({roles::NameOf(role), std::move(mesh), false, role});
  };
  for (const TubeShape& shape : ListTubes(marks)) {
    if (patient.NeighbourOf(shape.role) == nullptr) add(shape.role, MakeTemplateTube(shape, organs));
  }
  if (patient.NeighbourOf(roles::NeighbourRole::kRightKidney) == nullptr)
    add(roles::NeighbourRole::kRightKidney, MakeKidney(marks, organs));
  return made;
}

}  // namespace trocar::anatomy
