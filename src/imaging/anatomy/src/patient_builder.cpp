// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/patient_builder.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "duct_template.h"
#include "gallbladder_bed.h"
#include "liver_regions.h"
#include "trocar/anatomy/tube_graph.h"
#include "trocar/base/assert.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/meshing/nearest_surface.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using geometry::TriangleMesh;

constexpr double kMetresPerMm = 1e-3;
constexpr double kLiverEdgeReach =
    0.045;  // the liver's edge is looked for so far to either side of the fundus [m]
constexpr double kFundusRadius =
    0.006;  // the fundus is the mean of the surface so close to its extreme point [m]

/// Maps (column, row, slice) to the world without the final shift [m].
class ImageFrame {
 public:
  explicit ImageFrame(const contours::ControlPoints& points)
      : points_(points), directions_(contours::AxisDirections(points)) {}

  math::Vec3 FromMm(const math::Vec3& p) const {
    math::Vec3 world;
    for (int world_axis = 0; world_axis < 3; ++world_axis) {
      for (int axis = 0; axis < 3; ++axis)
        world[world_axis] += kMetresPerMm * directions_[axis][world_axis] * p[axis];
    }
    return world;
  }
  math::Vec3 FromPixel(double slice, const math::Vec2& pixel) const {
    return FromMm({points_.pixel_mm * pixel.x, points_.pixel_mm * pixel.y, points_.slice_mm * slice});
  }
  TriangleMesh FromMm(TriangleMesh mesh) const {
    for (math::Vec3& p : mesh.positions) p = FromMm(p);
    // a mirrored frame turns the triangles inside out
    if (geometry::CalcVolume(mesh.positions, mesh.triangles) < 0) {
      for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    }
    return mesh;
  }

 private:
  const contours::ControlPoints& points_;
  std::array<std::array<double, 3>, 3> directions_;
};

/// Direction of largest extent, by power iteration on the covariance of the area-weighted vertices.
math::Vec3 FindLongAxis(const TriangleMesh& mesh, math::Vec3& centre) {
  const auto areas = geometry::CalcVertexAreas(mesh.positions, mesh.triangles);
  double total = 0;
  centre = {};
  for (std::size_t v = 0; v < areas.size(); ++v) centre += areas[v] * mesh.positions[v], total += areas[v];
  centre = centre / total;
  math::Vec3 axis = math::Normalized(math::Vec3{1, 1, 1});
  constexpr int kIterations = 200;
  for (int i = 0; i < kIterations; ++i) {
    math::Vec3 next;
    for (std::size_t v = 0; v < areas.size(); ++v) {
      const math::Vec3 away = mesh.positions[v] - centre;
      next += (areas[v] * Dot(away, axis)) * away;
    }
    axis = math::Normalized(next);
  }
  return axis;
}

/// Mean of the surface around the vertex that lies furthest along `direction`, put back onto the surface.
math::Vec3 FindEnd(const TriangleMesh& mesh, const meshing::NearestSurface& surface,
                   const math::Vec3& direction) {
  const auto furthest = std::max_element(
      mesh.positions.begin(), mesh.positions.end(),
      [&](const math::Vec3& a, const math::Vec3& b) { return Dot(a, direction) < Dot(b, direction); });
  math::Vec3 mean;
  int count = 0;
  for (const math::Vec3& p : mesh.positions) {
    if (Distance(p, *furthest) <= kFundusRadius) mean += p, ++count;
  }
  return surface.Find(mean / count).at.point;
}

patient::Tube MakeTube(const contours::TubePoints& points, const ImageFrame& frame,
                       const std::set<std::string>& known, double spacing) {
  patient::Tube tube{points.name};
  tube.kind = points.kind == patient::KindName(patient::TubeKind::kArtery) ? patient::TubeKind::kArtery
                                                                           : patient::TubeKind::kDuct;
  // ends outside the scene have no name in a patient
  tube.from = known.contains(points.from) ? points.from : "";
  tube.to = known.contains(points.to) ? points.to : "";
  tube.is_seen = points.is_seen;
  for (const contours::TubePoint& point : points.points) {
    tube.line.points.push_back(frame.FromPixel(point.slice, point.pixel));
    tube.line.radii.push_back(kMetresPerMm * point.radius_mm);
  }
  tube.line = geometry::Resample(tube.line, spacing);
  return tube;
}

/// Moves a patient so that its origin is the umbilicus on the insufflated wall, known by one landmark's place. Pictures show a wall
/// that is not insufflated, so that without either the fundus goes where the scenes expect it.
base::Status MoveToOrigin(const contours::ControlPoints& points, patient::Patient& patient) {
  constexpr std::string_view kUmbilicus = NameOf(roles::LandmarkRole::kUmbilicus);
  const bool is_placed = patient.FindLandmark(kUmbilicus) != nullptr;
  const contours::ControlPoints usual = MakeWorldFrame();
  const bool is_given = !points.origin_landmark.empty();
  const std::string anchor_name = is_given    ? points.origin_landmark
                                  : is_placed ? std::string(kUmbilicus)
                                              : usual.origin_landmark;
  const patient::Landmark* anchor = patient.FindLandmark(anchor_name);
  if (anchor == nullptr) {
    return base::Error{base::ErrorCode::kPatientInvalid, "the origin's landmark '" + anchor_name +
                                                             "' is not known; use fundus or infundibulum"};
  }
  const auto& place_mm = is_given    ? points.origin_mm
                         : is_placed ? std::array{0.0, 0.0, 0.0}
                                     : usual.origin_mm;
  const math::Vec3 shift =
      kMetresPerMm * math::Vec3{place_mm[0], place_mm[1], place_mm[2]} - anchor->position;
  for (patient::Organ& organ : patient.organs) {
    for (math::Vec3& p : organ.mesh.positions) p += shift;
  }
  for (patient::Tube& tube : patient.tubes) {
    for (math::Vec3& p : tube.line.points) p += shift;
  }
  for (patient::Landmark& landmark : patient.landmarks) landmark.position += shift;
  // both: CheckPatient refuses the name that is there twice
  if (is_given || !is_placed) patient.landmarks.push_back({std::string(kUmbilicus), {0, 0, 0}});
  return {};
}

}  // namespace

base::Result<patient::Patient> AssemblePatient(const contours::ControlPoints& points,
                                               const std::vector<meshing::StructureMesh>& structures,
                                               const RegionSettings& settings) {
  const ImageFrame frame(points);
  patient::Patient patient;
  patient.name = points.name;
  patient.provenance = points.provenance;
  for (const meshing::StructureMesh& structure : structures) {
    patient.organs.push_back({structure.name, frame.FromMm(structure.mesh), {}});
  }
  const int liver_index = patient.OrganOf(roles::OrganRole::kLiver),
            gallbladder_index = patient.OrganOf(roles::OrganRole::kGallbladder);
  if (liver_index < 0 || gallbladder_index < 0) {
    return base::Error{
        base::ErrorCode::kPatientInvalid,
        "a patient needs the structures \"liver\" and \"gallbladder\"; place their control points"};
  }
  patient::Organ& liver = patient.organs[liver_index];
  patient::Organ& gallbladder = patient.organs[gallbladder_index];
  const meshing::NearestSurface gallbladder_surface(gallbladder.mesh);

  // tubes, their ends on the gallbladder's surface where they enter it
  std::set<std::string> known;
  for (const patient::Organ& organ : patient.organs) known.insert(organ.name);
  for (const contours::TubePoints& tube : points.tubes) known.insert(tube.name);
  for (const contours::TubePoints& tube_points : points.tubes) {
    patient::Tube tube = MakeTube(tube_points, frame, known, settings.tube_spacing);
    const auto snap = [&](math::Vec3& end) { end = gallbladder_surface.Find(end).at.point; };
    if (tube.from == gallbladder.name) snap(tube.line.points.front());
    if (tube.to == gallbladder.name) snap(tube.line.points.back());
    patient.tubes.push_back(std::move(tube));
  }
  // joints become exact; what lies too far away stays, for the linter to find
  JoinTubes(patient);

  // the gallbladder's ends along its long axis; the cystic duct starts at the infundibulum
  math::Vec3 centre;
  math::Vec3 axis = FindLongAxis(gallbladder.mesh, centre);
  const int duct = patient.TubeOf(roles::TubeRole::kCysticDuct);
  const math::Vec3 towards_fundus =
      duct >= 0 ? centre - patient.tubes[duct].line.points.front() : math::Vec3{0, -1, 1};
  if (Dot(axis, towards_fundus) < 0) axis = -axis;
  const math::Vec3 fundus = FindEnd(gallbladder.mesh, gallbladder_surface, axis);
  const math::Vec3 infundibulum = FindEnd(gallbladder.mesh, gallbladder_surface, -axis);

  // pictures that show no duct at all: the usual ones, placed by the landmarks
  if (points.tubes.empty()) {
    patient.tubes = MakeTemplateTubes(liver.mesh, gallbladder.mesh, infundibulum, {});
    JoinTubes(patient);
  }

  const contours::LandmarkPoint* fissure =
      points.FindLandmark(NameOf(roles::LandmarkRole::kUmbilicalFissure));
  const double falciform_x =
      fissure ? frame.FromPixel(fissure->slice, fissure->pixel).x : infundibulum.x + 0.02;
  const LiverRegions regions = FindLiverRegions(liver.mesh, gallbladder_surface, falciform_x, settings);
  Bed bed = FindBed(gallbladder.mesh, liver.mesh, settings.bed_distance);
  if (bed.pairs.empty()) {
    return base::Error{base::ErrorCode::kPatientInvalid,
                       "liver and gallbladder do not touch; check their control points against the pictures"};
  }
  // free side of the body: opposite of the bed
  math::Vec3 towards_bed;
  for (const auto v : bed.gallbladder) towards_bed += gallbladder.mesh.positions[v] - centre;
  towards_bed = math::Normalized(towards_bed - Dot(towards_bed, axis) * axis);
  const math::Vec3 body = gallbladder_surface.Find(centre - 0.1 * towards_bed).at.point;
  // lowest point of the liver in front of the gallbladder
  const math::Vec3* edge = nullptr;
  for (const math::Vec3& p : liver.mesh.positions) {
    if (std::fabs(p.x - fundus.x) > kLiverEdgeReach || p.z < centre.z) continue;
    if (edge == nullptr || p.y < edge->y) edge = &p;
  }

  liver.regions = {{patient::kDiaphragmaticFace, regions.diaphragmatic},
                   {patient::kFalciform, regions.falciform},
                   {patient::kCoronary, regions.coronary},
                   {patient::kGallbladderBed, bed.liver}};
  gallbladder.regions = {{patient::kGallbladderBed, bed.gallbladder}};
  for (const auto& pair : bed.pairs) {
    patient.attachments.push_back({patient::kGallbladderBed, static_cast<std::uint32_t>(gallbladder_index),
                                   pair[0], static_cast<std::uint32_t>(liver_index), pair[1]});
  }
  patient.landmarks = {{NameOf(roles::LandmarkRole::kFundus), fundus},
                       {NameOf(roles::LandmarkRole::kInfundibulum), infundibulum},
                       {NameOf(roles::LandmarkRole::kGallbladderBody), body}};
  if (edge != nullptr) patient.landmarks.push_back({NameOf(roles::LandmarkRole::kLiverEdge), *edge});
  if (const auto middle = CalcTriangleMiddle(patient))
    patient.landmarks.push_back({NameOf(roles::LandmarkRole::kHepatocysticTriangle), *middle});
  for (const contours::LandmarkPoint& placed : points.landmarks) {
    patient.landmarks.push_back({placed.name, frame.FromPixel(placed.slice, placed.pixel)});
  }

  if (const auto status = MoveToOrigin(points, patient); !status.ok()) return status.error();
  if (const auto status = patient::CheckPatient(patient); !status.ok()) return status.error();
  return patient;
}

}  // namespace trocar::anatomy
