// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/patient_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "nearest_surface.h"
#include "trocar/core/assert.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/mesh_topology.h"

namespace trocar::anatomy {
namespace {

using geometry::TriangleMesh;

constexpr double kMetresPerMm = 1e-3;
/// Directions in which the diaphragm and the abdominal wall lie, seen from the liver: right, cranial,
/// anterior.
const Vec3 kTowardsDiaphragm = math::Normalized(Vec3{-0.45, 0.7, 0.55});
constexpr double kFacesDiaphragm = 0.25;  // cosine to that direction
constexpr double kSuperiorNormal = 0.3;   // y of a normal of the superior face
constexpr double kCoronaryPosterior =
    0.4;  // part of the liver's depth, from behind, in which the coronary ligament lies
constexpr double kCarries = 0.2;  // barycentric weight from which a liver vertex carries an attachment
constexpr double kLiverEdgeReach =
    0.045;  // the liver's edge is looked for so far to either side of the fundus [m]
constexpr double kFundusRadius =
    0.006;  // the fundus is the mean of the surface so close to its extreme point [m]

/// Maps (column, row, slice) to the world without the final shift [m].
class ImageFrame {
 public:
  explicit ImageFrame(const ControlPoints& points) : points_(points), directions_(AxisDirections(points)) {}

  Vec3 FromMm(const Vec3& p) const {
    Vec3 world;
    for (int world_axis = 0; world_axis < 3; ++world_axis) {
      for (int axis = 0; axis < 3; ++axis)
        world[world_axis] += kMetresPerMm * directions_[axis][world_axis] * p[axis];
    }
    return world;
  }
  Vec3 FromPixel(double slice, const Vec2& pixel) const {
    return FromMm({points_.pixel_mm * pixel.x, points_.pixel_mm * pixel.y, points_.slice_mm * slice});
  }
  TriangleMesh FromMm(TriangleMesh mesh) const {
    for (Vec3& p : mesh.positions) p = FromMm(p);
    // a mirrored frame turns the triangles inside out
    if (geometry::CalcVolume(mesh.positions, mesh.triangles) < 0) {
      for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    }
    return mesh;
  }

 private:
  const ControlPoints& points_;
  std::array<std::array<double, 3>, 3> directions_;
};

/// Direction of largest extent, by power iteration on the covariance of the area-weighted vertices.
Vec3 FindLongAxis(const TriangleMesh& mesh, Vec3& centre) {
  const auto areas = geometry::CalcVertexAreas(mesh.positions, mesh.triangles);
  double total = 0;
  centre = {};
  for (std::size_t v = 0; v < areas.size(); ++v) centre += areas[v] * mesh.positions[v], total += areas[v];
  centre = centre / total;
  Vec3 axis = math::Normalized(Vec3{1, 1, 1});
  constexpr int kIterations = 200;
  for (int i = 0; i < kIterations; ++i) {
    Vec3 next;
    for (std::size_t v = 0; v < areas.size(); ++v) {
      const Vec3 away = mesh.positions[v] - centre;
      next += (areas[v] * Dot(away, axis)) * away;
    }
    axis = math::Normalized(next);
  }
  return axis;
}

std::vector<std::uint32_t> Ascending(std::set<std::uint32_t> vertices) {
  return {vertices.begin(), vertices.end()};
}

/// Largest part of the marked vertices that hangs together along edges.
void KeepLargestPatch(const geometry::Rows& neighbours, std::vector<char>& marked) {
  std::vector<int> part(marked.size(), -1);
  std::vector<std::size_t> sizes;
  std::vector<std::uint32_t> stack;
  for (std::uint32_t seed = 0; seed < marked.size(); ++seed) {
    if (!marked[seed] || part[seed] >= 0) continue;
    const int number = static_cast<int>(sizes.size());
    sizes.push_back(0);
    stack.assign(1, seed);
    part[seed] = number;
    while (!stack.empty()) {
      const auto here = stack.back();
      stack.pop_back();
      ++sizes[number];
      for (const auto w : neighbours.Row(here)) {
        if (!marked[w] || part[w] >= 0) continue;
        part[w] = number;
        stack.push_back(w);
      }
    }
  }
  if (sizes.empty()) return;
  const int largest = static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  for (std::size_t v = 0; v < marked.size(); ++v) marked[v] = part[v] == largest;
}

/// Depth of each vertex below the plane that touches the mesh in the direction of its normal [m].
std::vector<double> CalcHullDepths(const TriangleMesh& mesh, const std::vector<Vec3>& normals) {
  std::vector<double> depths(mesh.positions.size());
  for (std::size_t v = 0; v < depths.size(); ++v) {
    double highest = -std::numeric_limits<double>::max();
    for (const Vec3& p : mesh.positions) highest = std::max(highest, Dot(p, normals[v]));
    depths[v] = highest - Dot(mesh.positions[v], normals[v]);
  }
  return depths;
}

struct LiverRegions {
  std::vector<std::uint32_t> diaphragmatic, falciform, coronary;
};

LiverRegions FindLiverRegions(const TriangleMesh& liver, const NearestSurface& gallbladder,
                              double falciform_x, const RegionSettings& settings) {
  const std::size_t n = liver.positions.size();
  std::vector<Vec3> normals(n);
  geometry::CalcVertexNormals(liver.positions, liver.triangles, normals);
  const auto depths = CalcHullDepths(liver, normals);
  const auto neighbours = geometry::FindVertexNeighbours(liver.triangles, n);

  std::vector<char> face(n, 0);
  for (std::size_t v = 0; v < n; ++v) {
    face[v] = Dot(normals[v], kTowardsDiaphragm) > kFacesDiaphragm && depths[v] < settings.hull_depth;
  }
  KeepLargestPatch(neighbours, face);
  // single holes belong to the face
  std::vector<char> smooth = face;
  for (std::size_t v = 0; v < n; ++v) {
    const auto row = neighbours.Row(v);
    const auto count = std::count_if(row.begin(), row.end(), [&](auto w) { return face[w] != 0; });
    const bool is_visceral = Dot(normals[v], kTowardsDiaphragm) < 0;
    if (!face[v] && !is_visceral && 4 * count > 3 * static_cast<std::ptrdiff_t>(row.size())) smooth[v] = 1;
  }
  face = smooth;
  std::vector<Vec3> border;
  for (std::size_t v = 0; v < n; ++v) {
    if (!face[v]) border.push_back(liver.positions[v]);
  }
  std::vector<char> fixed = face;
  for (std::size_t v = 0; v < n; ++v) {
    if (!face[v]) continue;
    const bool is_margin = std::any_of(border.begin(), border.end(), [&](const Vec3& p) {
      return Distance(p, liver.positions[v]) < settings.margin;
    });
    if (is_margin || gallbladder.Find(liver.positions[v]).distance < settings.gallbladder_clear) fixed[v] = 0;
  }
  KeepLargestPatch(neighbours, fixed);

  const geometry::Box box = geometry::CalcBox(liver.positions);
  std::set<std::uint32_t> diaphragmatic, falciform, coronary;
  for (std::uint32_t v = 0; v < n; ++v) {
    if (!fixed[v]) continue;
    const Vec3& p = liver.positions[v];
    diaphragmatic.insert(v);
    if (std::fabs(p.x - falciform_x) <= settings.falciform_half) falciform.insert(v);
    const bool is_posterior = p.z < box.min.z + kCoronaryPosterior * (box.max.z - box.min.z);
    if (is_posterior && normals[v].y > kSuperiorNormal && p.x < falciform_x) coronary.insert(v);
  }
  return {Ascending(diaphragmatic), Ascending(falciform), Ascending(coronary)};
}

struct Bed {
  std::vector<std::uint32_t> gallbladder, liver;
  std::vector<std::array<std::uint32_t, 2>> pairs;  // gallbladder vertex, liver vertex
};

Bed FindBed(const TriangleMesh& gallbladder, const TriangleMesh& liver, double bed_distance) {
  std::vector<Vec3> normals(gallbladder.positions.size());
  geometry::CalcVertexNormals(gallbladder.positions, gallbladder.triangles, normals);
  const NearestSurface surface(liver);
  std::set<std::uint32_t> of_gallbladder, of_liver;
  Bed bed;
  for (std::uint32_t v = 0; v < gallbladder.positions.size(); ++v) {
    const SurfacePoint near = surface.Find(gallbladder.positions[v]);
    if (near.distance > bed_distance) continue;
    const auto& triangle = liver.triangles[near.triangle];
    // the surfaces face each other
    if (Dot(normals[v], geometry::CalcAreaNormal(liver.positions, triangle)) >= 0) continue;
    of_gallbladder.insert(v);
    for (int corner = 0; corner < 3; ++corner) {
      if (near.at.weights[corner] < kCarries) continue;
      bed.pairs.push_back({v, triangle[corner]});
      of_liver.insert(triangle[corner]);
    }
  }
  bed.gallbladder = Ascending(of_gallbladder);
  bed.liver = Ascending(of_liver);
  return bed;
}

/// Mean of the surface around the vertex that lies furthest along `direction`, put back onto the surface.
Vec3 FindEnd(const TriangleMesh& mesh, const NearestSurface& surface, const Vec3& direction) {
  const auto furthest =
      std::max_element(mesh.positions.begin(), mesh.positions.end(),
                       [&](const Vec3& a, const Vec3& b) { return Dot(a, direction) < Dot(b, direction); });
  Vec3 mean;
  int count = 0;
  for (const Vec3& p : mesh.positions) {
    if (Distance(p, *furthest) <= kFundusRadius) mean += p, ++count;
  }
  return surface.Find(mean / count).at.point;
}

Tube MakeTube(const TubePoints& points, const ImageFrame& frame, const std::set<std::string>& known,
              double spacing) {
  Tube tube;
  tube.name = points.name;
  tube.kind = points.kind == "artery" ? TubeKind::kArtery : TubeKind::kDuct;
  // ends outside the scene have no name in a patient
  tube.from = known.contains(points.from) ? points.from : "";
  tube.to = known.contains(points.to) ? points.to : "";
  tube.is_seen = points.is_seen;
  for (const TubePoint& point : points.points) {
    tube.line.points.push_back(frame.FromPixel(point.slice, point.pixel));
    tube.line.radii.push_back(kMetresPerMm * point.radius_mm);
  }
  tube.line = geometry::Resample(tube.line, spacing);
  return tube;
}

}  // namespace

core::Result<Patient> AssemblePatient(const ControlPoints& points,
                                      const std::vector<StructureMesh>& structures,
                                      const RegionSettings& settings) {
  const ImageFrame frame(points);
  Patient patient;
  patient.name = points.name;
  patient.provenance = points.provenance;
  for (const StructureMesh& structure : structures) {
    patient.organs.push_back({structure.name, frame.FromMm(structure.mesh), {}});
  }
  const int liver_index = patient.FindOrgan("liver"), gallbladder_index = patient.FindOrgan("gallbladder");
  if (liver_index < 0 || gallbladder_index < 0) {
    return core::Error{
        core::ErrorCode::kPatientInvalid,
        "a patient needs the structures \"liver\" and \"gallbladder\"; place their control points"};
  }
  Organ& liver = patient.organs[liver_index];
  Organ& gallbladder = patient.organs[gallbladder_index];
  const NearestSurface gallbladder_surface(gallbladder.mesh);

  // tubes, their ends on the gallbladder's surface where they enter it
  std::set<std::string> known;
  for (const Organ& organ : patient.organs) known.insert(organ.name);
  for (const TubePoints& tube : points.tubes) known.insert(tube.name);
  for (const TubePoints& tube_points : points.tubes) {
    Tube tube = MakeTube(tube_points, frame, known, settings.tube_spacing);
    const auto snap = [&](Vec3& end) { end = gallbladder_surface.Find(end).at.point; };
    if (tube.from == "gallbladder") snap(tube.line.points.front());
    if (tube.to == "gallbladder") snap(tube.line.points.back());
    patient.tubes.push_back(std::move(tube));
  }

  // the gallbladder's ends along its long axis; the cystic duct starts at the infundibulum
  Vec3 centre;
  Vec3 axis = FindLongAxis(gallbladder.mesh, centre);
  const auto duct = std::find_if(patient.tubes.begin(), patient.tubes.end(),
                                 [](const Tube& t) { return t.name == "cystic_duct"; });
  const bool has_duct = duct != patient.tubes.end();
  const Vec3 towards_fundus = has_duct ? centre - duct->line.points.front() : Vec3{0, -1, 1};
  if (Dot(axis, towards_fundus) < 0) axis = -axis;
  const Vec3 fundus = FindEnd(gallbladder.mesh, gallbladder_surface, axis);
  const Vec3 infundibulum = FindEnd(gallbladder.mesh, gallbladder_surface, -axis);

  const LandmarkPoint* fissure = points.FindLandmark("umbilical_fissure");
  const double falciform_x =
      fissure ? frame.FromPixel(fissure->slice, fissure->pixel).x : infundibulum.x + 0.02;
  const LiverRegions regions = FindLiverRegions(liver.mesh, gallbladder_surface, falciform_x, settings);
  Bed bed = FindBed(gallbladder.mesh, liver.mesh, settings.bed_distance);
  if (bed.pairs.empty()) {
    return core::Error{core::ErrorCode::kPatientInvalid,
                       "liver and gallbladder do not touch; check their control points against the pictures"};
  }
  // free side of the body: opposite of the bed
  Vec3 towards_bed;
  for (const auto v : bed.gallbladder) towards_bed += gallbladder.mesh.positions[v] - centre;
  towards_bed = math::Normalized(towards_bed - Dot(towards_bed, axis) * axis);
  const Vec3 body = gallbladder_surface.Find(centre - 0.1 * towards_bed).at.point;
  // lowest point of the liver in front of the gallbladder
  const Vec3* edge = nullptr;
  for (const Vec3& p : liver.mesh.positions) {
    if (std::fabs(p.x - fundus.x) > kLiverEdgeReach || p.z < centre.z) continue;
    if (edge == nullptr || p.y < edge->y) edge = &p;
  }

  liver.regions = {{kDiaphragmaticFace, regions.diaphragmatic},
                   {kFalciform, regions.falciform},
                   {kCoronary, regions.coronary},
                   {kGallbladderBed, bed.liver}};
  gallbladder.regions = {{kGallbladderBed, bed.gallbladder}};
  for (const auto& pair : bed.pairs) {
    patient.attachments.push_back({kGallbladderBed, static_cast<std::uint32_t>(gallbladder_index), pair[0],
                                   static_cast<std::uint32_t>(liver_index), pair[1]});
  }
  patient.landmarks = {{"fundus", fundus}, {"infundibulum", infundibulum}, {"gallbladder_body", body}};
  if (edge != nullptr) patient.landmarks.push_back({"liver_edge", *edge});
  const auto middle_of = [&](std::string_view name) -> const Vec3* {
    for (const Tube& tube : patient.tubes) {
      if (tube.name == name) return &tube.line.points[tube.line.points.size() / 2];
    }
    return nullptr;
  };
  const Vec3 *cystic = middle_of("cystic_duct"), *hepatic = middle_of("common_hepatic_duct");
  if (cystic && hepatic) patient.landmarks.push_back({"hepatocystic_triangle", 0.5 * (*cystic + *hepatic)});
  for (const LandmarkPoint& placed : points.landmarks) {
    patient.landmarks.push_back({placed.name, frame.FromPixel(placed.slice, placed.pixel)});
  }

  // the origin: the umbilicus on the insufflated wall, known by one landmark's place
  if (!points.origin_landmark.empty()) {
    const Landmark* anchor = patient.FindLandmark(points.origin_landmark);
    if (anchor == nullptr) {
      return core::Error{
          core::ErrorCode::kPatientInvalid,
          "the origin's landmark '" + points.origin_landmark + "' is not known; use fundus or infundibulum"};
    }
    const Vec3 wanted = kMetresPerMm * Vec3{points.origin_mm[0], points.origin_mm[1], points.origin_mm[2]};
    const Vec3 shift = wanted - anchor->position;
    for (Organ& organ : patient.organs) {
      for (Vec3& p : organ.mesh.positions) p += shift;
    }
    for (Tube& tube : patient.tubes) {
      for (Vec3& p : tube.line.points) p += shift;
    }
    for (Landmark& landmark : patient.landmarks) landmark.position += shift;
    patient.landmarks.push_back({"umbilicus", {0, 0, 0}});
  }
  if (const auto status = CheckPatient(patient); !status.ok()) return status.error();
  return patient;
}

}  // namespace trocar::anatomy
