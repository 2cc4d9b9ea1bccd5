// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/shape_measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "trocar/base/to_integer.h"
#include "trocar/files/patient_frame.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/math/elementary.h"
#include "trocar/math/rotation_angle.h"
#include "trocar/math/vector.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using base::Error;
using base::ErrorCode;
using geometry::TriangleMesh;

constexpr double kDegrees = 180.0 / M_PI;
constexpr double kMlPerCubicMetre = 1e6;
constexpr double kMm2PerSquareMetre = 1e6;
constexpr std::size_t kSlabs = 20;
constexpr double kPouchReach = 0.45;  // of the axis, from the infundibulum on: there a pouch bulges [-]
constexpr double kNeckFrom = 0.05, kNeckTo = 0.30;  // of the axis: there the neck is narrowest [-]
constexpr double kEdgeReach = 0.025;                // of the liver's lower edge, from the landmark [m]

constexpr ShapeRange kLiterature[] = {
    {"liver_transverse", 200, 225, "thecommonvein.net"},
    {"liver_vertical", 150, 175, "thecommonvein.net: right lobe"},
    {"liver_depth", 100, 125, "thecommonvein.net"},
    {"liver_volume", 594, 2250, "Feng, WJG 2017: CT, n = 369"},
    {"gallbladder_length", 33, 120, "JRABMS 2022: cadavers, n = 100"},
    {"gallbladder_diameter", 20, 50, "JRABMS 2022: cadavers, n = 100"},
    {"gallbladder_volume", 17, 50,
     "Am J Gastroenterol 1992: mean 17 to 19 fasting, n = 1703; textbooks to 50"},
    {"gallbladder_inclination", 28, 70, "Sanal 2016: CT, 49 +- 21, one deviation either way"},
};

/// The gallbladder cut across its axis.
class Slabs {
 public:
  Slabs(const TriangleMesh& mesh, const math::Vec3& from, const math::Vec3& axis, double length) {
    const std::vector<double> areas = geometry::CalcVertexAreas(mesh.positions, mesh.triangles);
    const auto slab_of = [&](const math::Vec3& p) {
      const double t = Dot(p - from, axis) / length;
      return base::TruncateTo<std::size_t>(std::clamp(t, 0.0, 1.0 - 1e-9) * kSlabs);
    };
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      Slab& slab = slabs_[slab_of(mesh.positions[v])];
      slab.centre += areas[v] * mesh.positions[v];
      slab.area += areas[v];
    }
    for (Slab& slab : slabs_) {
      if (slab.area > 0) slab.centre = slab.centre / slab.area;
    }
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      Slab& slab = slabs_[slab_of(mesh.positions[v])];
      const math::Vec3 arm = mesh.positions[v] - slab.centre;
      slab.diameter += 2.0 * areas[v] * Norm(arm - Dot(arm, axis) * axis) / slab.area;
    }
  }

  /// Of the middle of a slab along the axis [-].
  static double PlaceOf(std::size_t slab) { return (static_cast<double>(slab) + 0.5) / kSlabs; }
  double DiameterAt(std::size_t slab) const { return slabs_[slab].diameter; }
  const math::Vec3& CentreAt(std::size_t slab) const { return slabs_[slab].centre; }

  double LargestDiameter() const {
    double largest = 0;
    for (const Slab& slab : slabs_) largest = std::max(largest, slab.diameter);
    return largest;
  }
  double SmallestDiameter(double from, double to) const {
    double smallest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < kSlabs; ++i)
      if (PlaceOf(i) >= from && PlaceOf(i) <= to) smallest = std::min(smallest, slabs_[i].diameter);
    return smallest;
  }
  /// How much wider the gallbladder is near the infundibulum than where it narrows after that [m].
  double PouchDepth() const {
    double widest = 0, depth = 0;
    for (std::size_t i = 0; i < kSlabs && PlaceOf(i) <= kPouchReach; ++i) {
      widest = std::max(widest, slabs_[i].diameter);
      depth = std::max(depth, widest - slabs_[i].diameter);
    }
    return depth;
  }
  /// Angle between the centre line's first and last third [rad].
  double Bend() const {
    constexpr std::size_t kThird = kSlabs / 3;
    const math::Vec3 first = math::Normalized(CentreAt(kThird) - CentreAt(1)),
                     last = math::Normalized(CentreAt(kSlabs - 2) - CentreAt(kSlabs - 1 - kThird));
    return math::Acos(std::clamp(Dot(first, last), -1.0, 1.0));
  }

 private:
  struct Slab {
    math::Vec3 centre;
    double area = 0, diameter = 0;
  };
  std::array<Slab, kSlabs> slabs_;
};

/// Vertices of a region as flags.
std::vector<std::uint8_t> FlagsOf(const patient::Region& region, std::size_t count) {
  std::vector<std::uint8_t> flags(count, 0);
  for (const std::uint32_t v : region.vertices) flags[v] = 1;
  return flags;
}

/// Area of the triangles that lie in a region with all corners [m^2].
double CalcRegionArea(const TriangleMesh& mesh, const std::vector<std::uint8_t>& is_in) {
  std::vector<geometry::Triangle> inside;
  for (const geometry::Triangle& t : mesh.triangles)
    if (is_in[t[0]] && is_in[t[1]] && is_in[t[2]]) inside.push_back(t);
  return geometry::CalcArea(mesh.positions, inside);
}

/// How deep the gallbladder lies in its fossa: the farthest of its bed behind the bed's border, along the bed's mean
/// direction [m].
double CalcFossaDepth(const TriangleMesh& mesh, const std::vector<std::uint8_t>& is_bed,
                      const math::Vec3& axis) {
  math::Vec3 into_liver;
  std::vector<std::uint8_t> is_border(mesh.positions.size(), 0);
  for (const geometry::Triangle& t : mesh.triangles) {
    const int corners = is_bed[t[0]] + is_bed[t[1]] + is_bed[t[2]];
    if (corners == 3) into_liver += geometry::CalcAreaNormal(mesh.positions, t);
    if (corners == 0 || corners == 3) continue;
    for (const std::uint32_t v : t) is_border[v] = is_border[v] || is_bed[v];
  }
  into_liver = math::Normalized(into_liver - Dot(into_liver, axis) * axis);
  double deepest = -std::numeric_limits<double>::infinity(), border = 0;
  std::size_t count = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const double depth = Dot(mesh.positions[v], into_liver);
    if (is_bed[v]) deepest = std::max(deepest, depth);
    if (is_border[v]) border += depth, ++count;
  }
  return count == 0 ? 0.0 : deepest - border / static_cast<double>(count);
}

/// Angle between the liver's front and its visceral face at the lower edge [rad]; nothing where one is not near.
std::optional<double> CalcEdgeAngle(const TriangleMesh& liver, const math::Vec3& edge) {
  math::Vec3 front, back;
  for (const geometry::Triangle& t : liver.triangles) {
    const math::Vec3 middle = (liver.positions[t[0]] + liver.positions[t[1]] + liver.positions[t[2]]) / 3.0;
    if (Distance(middle, edge) > kEdgeReach) continue;
    const math::Vec3 normal = geometry::CalcAreaNormal(liver.positions, t);
    (normal.z > 0 ? front : back) += normal;
  }
  if (Norm(front) == 0 || Norm(back) == 0) return std::nullopt;
  return M_PI - math::AngleBetween(front, back);
}

}  // namespace

std::span<const ShapeRange> LiteratureRanges() {
  return kLiterature;
}

base::Result<std::vector<ShapeMeasure>> MeasureShapes(const patient::Patient& patient) {
  const int liver_index = patient.OrganOf(roles::OrganRole::kLiver),
            gallbladder_index = patient.OrganOf(roles::OrganRole::kGallbladder);
  const patient::Landmark *infundibulum = patient.LandmarkOf(roles::LandmarkRole::kInfundibulum),
                          *fundus = patient.LandmarkOf(roles::LandmarkRole::kFundus);
  const Error lacks{
      ErrorCode::kPatientInvalid,
      "liver, gallbladder, its bed, infundibulum and fundus are measured; the patient lacks one of "
      "them: build it again, or place the landmarks with trocar anatomy edit"};
  if (liver_index < 0 || gallbladder_index < 0 || infundibulum == nullptr || fundus == nullptr) return lacks;
  const TriangleMesh& liver = patient.organs[static_cast<std::size_t>(liver_index)].mesh;
  const patient::Organ& gallbladder = patient.organs[static_cast<std::size_t>(gallbladder_index)];
  const TriangleMesh& mesh = gallbladder.mesh;
  const patient::Region* bed = gallbladder.RegionOf(roles::RegionRole::kGallbladderBed);
  if (bed == nullptr || bed->vertices.empty()) return lacks;

  std::vector<ShapeMeasure> measures;
  const auto add = [&](std::string_view name, double value, std::string_view unit, std::string_view about,
                       bool is_seen = true) {
    measures.push_back({name, unit, about, value, is_seen});
  };
  const geometry::Box box = geometry::CalcBox(liver.positions);
  add("liver_transverse", files::kMmPerMetre * (box.max.x - box.min.x), "mm", "right to left");
  add("liver_vertical", files::kMmPerMetre * (box.max.y - box.min.y), "mm", "cranial to caudal");
  add("liver_depth", files::kMmPerMetre * (box.max.z - box.min.z), "mm", "front to back");
  add("liver_volume", kMlPerCubicMetre * geometry::CalcVolume(liver.positions, liver.triangles), "mL",
      "enclosed");
  const patient::Landmark* edge = patient.LandmarkOf(roles::LandmarkRole::kLiverEdge);
  if (edge != nullptr) {
    add("fundus_below_edge", files::kMmPerMetre * (edge->position.y - fundus->position.y), "mm",
        "fundus caudal of the liver's lower edge");
    if (const auto angle = CalcEdgeAngle(liver, edge->position))
      add("liver_edge_angle", kDegrees * *angle, "deg",
          "between front and visceral face, within 25 mm of the edge");
  }

  const math::Vec3 way = fundus->position - infundibulum->position;
  const double length = Norm(way);
  if (length <= 0) return lacks;
  const math::Vec3 axis = way / length;
  const Slabs slabs(mesh, infundibulum->position, axis, length);
  const std::vector<std::uint8_t> is_bed = FlagsOf(*bed, mesh.positions.size());
  const double bed_area = CalcRegionArea(mesh, is_bed), depth = CalcFossaDepth(mesh, is_bed, axis);
  add("gallbladder_length", files::kMmPerMetre * length, "mm", "infundibulum to fundus, straight");
  add("gallbladder_diameter", files::kMmPerMetre * slabs.LargestDiameter(), "mm", "largest across the axis");
  add("gallbladder_volume", kMlPerCubicMetre * geometry::CalcVolume(mesh.positions, mesh.triangles), "mL",
      "enclosed");
  add("gallbladder_inclination", kDegrees * math::Asin(std::clamp(-axis.y, -1.0, 1.0)), "deg",
      "of the axis, caudal of the axial plane");
  add("gallbladder_azimuth", kDegrees * math::Atan2(-axis.x, axis.z), "deg",
      "of the axis in the axial plane, from anterior to the patient's right");
  add("gallbladder_bend", kDegrees * slabs.Bend(), "deg", "between the centre line's first and last third");
  add("gallbladder_neck", files::kMmPerMetre * slabs.SmallestDiameter(kNeckFrom, kNeckTo), "mm",
      "smallest diameter at 5 to 30 % of the axis");
  add("hartmann_pouch", files::kMmPerMetre * slabs.PouchDepth(), "mm",
      "how much wider the infundibulum is than what follows");
  add("contact_area", kMm2PerSquareMetre * bed_area, "mm^2", "of the gallbladder with the liver");
  add("contact_share", bed_area / geometry::CalcArea(mesh.positions, mesh.triangles), "",
      "of the gallbladder's surface");
  add("fossa_depth", files::kMmPerMetre * depth, "mm", "of the bed behind its border");
  add("fossa_depth_share", depth / slabs.LargestDiameter(), "", "the same, of the largest diameter");

  // what hangs on ducts
  const int cystic = patient.TubeOf(roles::TubeRole::kCysticDuct),
            hepatic = patient.TubeOf(roles::TubeRole::kCommonHepaticDuct);
  if (cystic >= 0) {
    const patient::Tube& duct = patient.tubes[static_cast<std::size_t>(cystic)];
    const math::Vec3& origin =
        duct.to == gallbladder.name ? duct.line.points.back() : duct.line.points.front();
    double beyond = 0;
    for (const math::Vec3& p : mesh.positions) beyond = std::max(beyond, Dot(origin - p, axis));
    add("wall_beyond_duct", files::kMmPerMetre * beyond, "mm",
        "of the gallbladder, beyond where the cystic duct leaves it", duct.is_seen);
  }
  if (hepatic >= 0) {
    const patient::Tube& duct = patient.tubes[static_cast<std::size_t>(hepatic)];
    const std::string& liver_name = patient.organs[static_cast<std::size_t>(liver_index)].name;
    const math::Vec3& hilum = duct.to == liver_name ? duct.line.points.back() : duct.line.points.front();
    add("infundibulum_to_hilum", files::kMmPerMetre * Distance(hilum, infundibulum->position), "mm",
        "to where the common hepatic duct leaves the liver", duct.is_seen);
  }
  return measures;
}

}  // namespace trocar::anatomy
