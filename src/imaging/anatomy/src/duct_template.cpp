// SPDX-License-Identifier: Apache-2.0
#include "duct_template.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/files/patient_frame.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/math/cubic_spline.h"
#include "trocar/math/elementary.h"
#include "trocar/meshing/nearest_surface.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using geometry::TriangleMesh;
using math::Cos;
using math::Sin;
using math::Vec3;

constexpr double kClearMm = 0.6;       // between a tube's skin and an organ
constexpr double kSampleMm = 2.5;      // between points of a line
constexpr double kInsertionMm = 25.0;  // a low or parallel insertion lies so much further down
constexpr double kHighShare = 0.45;    // of the common hepatic duct that is left by a high insertion

// directions that anatomy gives: left, cranial, anterior
const Vec3 kTowardsHilum = math::Normalized(Vec3{0.82, -0.40, -0.35});
const Vec3 kTowardsHighHilum = math::Normalized(Vec3{0.90, 0.15, -0.25});
const Vec3 kUpTheDuct = math::Normalized(Vec3{0.05, 0.97, 0.0});
const Vec3 kDownTheDuct = math::Normalized(Vec3{0.22, -0.92, -0.30});
const Vec3 kBehind = {0, 0, -1};
const Vec3 kLeft = {1, 0, 0};

/// A closed surface that tubes stay out of.
class Obstacle {
 public:
  explicit Obstacle(const TriangleMesh& mesh) : mesh_(mesh), surface_(mesh), normals_(mesh.positions.size()) {
    geometry::CalcVertexNormals(mesh.positions, mesh.triangles, normals_);
  }
  const TriangleMesh& Mesh() const { return mesh_; }
  const std::vector<Vec3>& Normals() const { return normals_; }
  Vec3 FindNearest(const Vec3& p) const { return surface_.Find(p).at.point; }

  /// Distance to the surface, negative inside, and the way out.
  double Find(const Vec3& p, Vec3& outward) const {
    const meshing::SurfacePoint near = surface_.Find(p);
    const auto& triangle = mesh_.triangles[near.triangle];
    Vec3 normal;
    for (int i = 0; i < 3; ++i) normal += near.at.weights[i] * normals_[triangle[i]];
    outward = math::Normalized(normal);
    return Dot(p - near.at.point, outward) < 0 ? -near.distance : near.distance;
  }

 private:
  const TriangleMesh& mesh_;
  meshing::NearestSurface surface_;
  std::vector<Vec3> normals_;
};

/// The line with its corners rounded; both ends stay.
std::vector<Vec3> Smoothed(const std::vector<Vec3>& line) {
  std::vector<Vec3> smooth = line;
  for (std::size_t i = 1; i + 1 < line.size(); ++i)
    smooth[i] = 0.5 * line[i] + 0.25 * (line[i - 1] + line[i + 1]);
  return smooth;
}

class Placer {
 public:
  Placer(const TriangleMesh& liver, const TriangleMesh& gallbladder)
      : liver_(liver), gallbladder_(gallbladder) {}
  const Obstacle& Liver() const { return liver_; }
  const Obstacle& Gallbladder() const { return gallbladder_; }

  double FindClearance(const Vec3& p) const {
    Vec3 ignored;
    return std::min(liver_.Find(p, ignored), gallbladder_.Find(p, ignored));
  }
  Vec3 PushOut(Vec3 p, double distance) const {
    constexpr int kRounds = 4;
    for (int round = 0; round < kRounds; ++round) {
      bool is_clear = true;
      for (const Obstacle* obstacle : {&liver_, &gallbladder_}) {
        Vec3 outward;
        const double here = obstacle->Find(p, outward);
        if (here >= distance) continue;
        p += (distance - here) * outward;
        is_clear = false;
      }
      if (is_clear) break;
    }
    return p;
  }

  /// Line through the waypoints, out of the organs but for its ends, bowed towards `bow` until it is `length`
  /// long; longer only where the way itself is.
  std::vector<Vec3> Route(const std::vector<Vec3>& waypoints, double radius, double length,
                          const Vec3& bow) const {
    const math::CubicSpline spline(waypoints, math::SplineEnds::kNatural);
    const int count = std::max(4, base::RoundTo<int>(std::max(length, spline.Length()) / kSampleMm));
    const auto line_at = [&](double amplitude) {
      std::vector<Vec3> line;
      for (int i = 0; i <= count; ++i) {
        const double t = static_cast<double>(i) / count;
        const double away = Sin(M_PI * t);
        Vec3 p = spline.Evaluate(t * spline.Length()) + (amplitude * away) * bow;
        // near the ends the line belongs to the organ that it enters
        if (i > 0 && i < count) p = PushOut(p, (radius + kClearMm) * std::min(1.0, 2.5 * away));
        line.push_back(p);
      }
      // pushed points get a smooth line again
      constexpr int kSmoothRounds = 2;
      for (int round = 0; round < kSmoothRounds; ++round) line = Smoothed(line);
      return line;
    };
    const auto length_of = [](const std::vector<Vec3>& line) {
      double sum = 0;
      for (std::size_t i = 1; i < line.size(); ++i) sum += Distance(line[i - 1], line[i]);
      return sum;
    };
    double low = 0, high = 0.6 * length;
    if (length_of(line_at(low)) >= length) return line_at(low);
    constexpr int kHalvings = 14;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (low + high);
      (length_of(line_at(middle)) < length ? low : high) = middle;
    }
    return line_at(low);
  }

 private:
  Obstacle liver_, gallbladder_;
};

/// How control points name what lies beyond the pictures.
constexpr const char* kOutside = "outside";

contours::TubePoints MakeTubePoints(roles::TubeRole role, const char* from, const char* to,
                                    const std::vector<Vec3>& line, double first_radius, double last_radius) {
  const patient::TubeKind kind = roles::IsDuct(role) ? patient::TubeKind::kDuct : patient::TubeKind::kArtery;
  contours::TubePoints tube{NameOf(role), patient::KindName(kind), from, to, false, {}};
  for (std::size_t i = 0; i < line.size(); ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(line.size() - 1);
    tube.points.push_back(
        {line[i].z, {line[i].x, line[i].y}, first_radius + t * (last_radius - first_radius)});
  }
  return tube;
}

struct Hilum {
  Vec3 confluence;  // on the liver, where the common hepatic duct comes out
  Vec3 junction;    // where the cystic duct would join it
};

/// The pair of points that fits both ducts' lengths and runs as ducts do.
Hilum FindHilum(const Placer& placer, const Vec3& neck, const Vec3& usual, double cystic_reach,
                double hepatic_reach) {
  const TriangleMesh& mesh = placer.Liver().Mesh();
  // directions around the usual one
  const Vec3 u = math::AnyPerpendicular(usual), v = Cross(usual, u);
  std::vector<Vec3> junctions;
  std::vector<double> costs;
  constexpr int kRings = 3, kSpokes = 12;
  for (int ring = 0; ring <= kRings; ++ring) {
    for (int spoke = 0; spoke < (ring == 0 ? 1 : kSpokes); ++spoke) {
      const double tilt = 0.28 * ring, turn = 2 * M_PI * spoke / kSpokes;
      const Vec3 direction = Cos(tilt) * usual + Sin(tilt) * (Cos(turn) * u + Sin(turn) * v);
      const Vec3 junction = neck + cystic_reach * direction;
      constexpr double kWanted = 6.0;  // mm between a junction and the organs
      const double lacking = std::max(0.0, kWanted - placer.FindClearance(junction));
      junctions.push_back(junction);
      costs.push_back(4.0 * tilt * tilt + lacking * lacking);
    }
  }
  double best = std::numeric_limits<double>::max();
  Hilum hilum{neck, neck};
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3& h = mesh.positions[i];
    if (Distance(h, neck) > cystic_reach + hepatic_reach + 10.0) continue;
    // the hilum opens to the viscera
    const double faces = Dot(placer.Liver().Normals()[i], Vec3{0.2, -0.9, -0.35});
    for (std::size_t k = 0; k < junctions.size(); ++k) {
      const Vec3 up = h - junctions[k];
      const double distance = Norm(up);
      const double miss = distance - hepatic_reach;
      const double off = 1.0 - Dot(up, kUpTheDuct) / std::max(distance, 1e-9);
      const double cost = costs[k] + miss * miss + 12.0 * off + 6.0 * (1.0 - faces);
      if (cost < best) best = cost, hilum = {h, junctions[k]};
    }
  }
  return hilum;
}

/// Vertex of the organ for which `cost` is least.
template <typename Cost>
Vec3 FindVertex(const TriangleMesh& mesh, Cost cost) {
  const auto best = std::min_element(mesh.positions.begin(), mesh.positions.end(),
                                     [&](const Vec3& a, const Vec3& b) { return cost(a) < cost(b); });
  return *best;
}

Vec3 PointAt(const std::vector<Vec3>& line, double t) {
  const double at = t * static_cast<double>(line.size() - 1);
  const auto i = std::min(base::TruncateTo<std::size_t>(at), line.size() - 2);
  return math::Lerp(line[i], line[i + 1], at - static_cast<double>(i));
}

/// Ducts and arteries of one patient, each placed by those before it [mm].
class DuctTemplate {
 public:
  DuctTemplate(const TriangleMesh& liver, const TriangleMesh& gallbladder, const Vec3& neck,
               std::span<const patient::Parameter> parameters)
      : placer_(liver, gallbladder), neck_(neck), parameters_(parameters) {}

  std::vector<contours::TubePoints> Place() {
    PlaceHepaticDuct();
    PlaceCysticDuct();
    PlaceBileDuct();
    PlaceHepaticArtery();
    const bool is_double = IsYes("double_cystic_artery");
    PlaceCysticArtery("", math::Normalized(Vec3{0.7, -0.4, 0.4}), is_double);
    if (is_double) PlaceCysticArtery("_deep", math::Normalized(Vec3{-0.5, -0.6, -0.3}), is_double);
    if (IsYes(NameOf(roles::TubeRole::kSubvesicalDuct))) PlaceSubvesicalDuct();
    return std::move(tubes_);
  }

 private:
  double Number(std::string_view name) const { return NumberOf(parameters_, name); }
  bool IsYes(std::string_view name) const { return TextOf(parameters_, name) == "yes"; }
  bool IsInserted(std::string_view how) const { return TextOf(parameters_, "cystic_duct_insertion") == how; }
  /// Runs beside the common hepatic duct before it joins it.
  bool RunsBeside() const { return IsInserted("parallel") || IsInserted("low"); }

  /// Common hepatic duct, from the liver down to the place where the cystic duct reaches it.
  void PlaceHepaticDuct() {
    hepatic_radius_ = 0.5 * Number("hepatic_duct_diameter");
    const double cystic_length = Number("cystic_duct_length");
    double hepatic_length = Number("hepatic_duct_length");
    bile_length_ = Number("bile_duct_length");
    double reach = 0.86 * cystic_length;
    if (IsInserted("medial")) reach = 0.70 * cystic_length;
    if (RunsBeside()) reach = 0.86 * std::max(0.35 * cystic_length, cystic_length - kInsertionMm);
    const bool is_high = IsInserted("high");
    const double upper = is_high ? kHighShare * hepatic_length : hepatic_length;
    hilum_ = FindHilum(placer_, neck_, is_high ? kTowardsHighHilum : kTowardsHilum, reach, 0.96 * upper);
    along_ = math::Normalized(hilum_.junction - hilum_.confluence, -kUpTheDuct);
    right_ =
        math::Normalized(neck_ - hilum_.junction - Dot(neck_ - hilum_.junction, along_) * along_, -kLeft);
    junction_ = hilum_.junction;
    std::vector<Vec3> way = {hilum_.confluence, hilum_.junction};
    if (RunsBeside()) {
      junction_ = placer_.PushOut(hilum_.junction + std::min(kInsertionMm, 0.6 * cystic_length) *
                                                        math::Normalized(along_ + kDownTheDuct),
                                  hepatic_radius_ + kClearMm);
      const double further = Distance(junction_, hilum_.junction);
      way.push_back(junction_);
      hepatic_length += further, bile_length_ -= further;
    } else {
      bile_length_ += hepatic_length - upper;
      hepatic_length = upper;
    }
    hepatic_ = placer_.Route(way, hepatic_radius_, hepatic_length, kLeft);
  }

  /// The last part of a low or parallel cystic duct: beside the common hepatic duct, then into it.
  std::vector<Vec3> PlaceBesideHepaticDuct(double cystic_radius) const {
    std::vector<Vec3> beside;
    if (!RunsBeside()) return beside;
    const double away = hepatic_radius_ + cystic_radius + (IsInserted("parallel") ? 0.4 : 4.0);
    const double first =
        Distance(hilum_.confluence, hilum_.junction) /
        (Distance(hilum_.confluence, hilum_.junction) + Distance(hilum_.junction, junction_));
    constexpr int kSteps = 10;
    for (int i = 1; i <= kSteps; ++i) {
      const double t = static_cast<double>(i) / kSteps;
      beside.push_back(PointAt(hepatic_, first + t * (1 - first)) +
                       (away * std::min(1.0, 5 * (1 - t))) * right_);
    }
    return beside;
  }

  void PlaceCysticDuct() {
    cystic_radius_ = 0.5 * Number("cystic_duct_diameter");
    // the duct leaves the gallbladder as a funnel, but no wider than a cystic duct may be
    constexpr double kWidestMouthMm = 2.45;
    const double mouth = std::max(cystic_radius_, std::min(1.25 * cystic_radius_, kWidestMouthMm));
    std::vector<Vec3> way = {neck_};
    if (IsInserted("medial")) {
      const double around = hepatic_radius_ + cystic_radius_ + 0.6;
      way.push_back(junction_ - 5.0 * along_ + around * math::Normalized(right_ + kBehind));
      way.push_back(junction_ - 2.5 * along_ + around * kBehind);
      way.push_back(junction_ - around * right_);
    }
    const std::vector<Vec3> beside = PlaceBesideHepaticDuct(cystic_radius_);
    double along_length = 0;
    for (std::size_t i = 1; i < beside.size(); ++i) along_length += Distance(beside[i - 1], beside[i]);
    way.push_back(beside.empty() ? junction_ : beside.front());
    const Vec3 sag = math::Normalized(kDownTheDuct - 0.3 * kLeft);
    auto cystic = placer_.Route(way, cystic_radius_, Number("cystic_duct_length") - along_length, sag);
    if (!beside.empty()) {
      cystic.insert(cystic.end(), beside.begin() + 1, beside.end());
      constexpr int kRounds = 6;  // both turns get a radius of about 5 mm
      for (int round = 0; round < kRounds; ++round) cystic = Smoothed(cystic);
    }
    tubes_.push_back(MakeTubePoints(roles::TubeRole::kCysticDuct, NameOf(roles::OrganRole::kGallbladder),
                                    NameOf(roles::TubeRole::kCommonBileDuct), cystic, mouth, cystic_radius_));
    tubes_.push_back(MakeTubePoints(roles::TubeRole::kCommonHepaticDuct, NameOf(roles::OrganRole::kLiver),
                                    NameOf(roles::TubeRole::kCommonBileDuct), hepatic_,
                                    0.85 * hepatic_radius_, hepatic_radius_));
  }

  /// Common bile duct, with its gentle curve to the pancreas.
  void PlaceBileDuct() {
    const double radius = 0.5 * Number("bile_duct_diameter");
    const Vec3 end = junction_ + 0.96 * bile_length_ * kDownTheDuct;
    const auto bile =
        placer_.Route({junction_, math::Lerp(junction_, end, 0.5), end}, radius, bile_length_, kBehind);
    tubes_.push_back(MakeTubePoints(roles::TubeRole::kCommonBileDuct,
                                    NameOf(roles::TubeRole::kCommonHepaticDuct), kOutside, bile, radius,
                                    0.85 * radius));
  }

  /// Right hepatic artery: from the left, behind the common hepatic duct, through the triangle into the liver.
  void PlaceHepaticArtery() {
    const double radius = 0.5 * Number("hepatic_artery_diameter");
    const Vec3 crossing =
        placer_.PushOut(PointAt(hepatic_, 0.45) + (hepatic_radius_ + radius + 0.8) * kBehind, radius + 0.5);
    turn_ = crossing + std::min(9.0, 0.4 * Distance(neck_, hilum_.junction)) * right_ - 1.0 * kBehind;
    if (IsYes("moynihan_hump")) {
      // the loop comes to lie on the gallbladder's neck
      turn_ = neck_ + (radius + cystic_radius_ + 1.5) * math::Normalized(crossing - neck_ + Vec3{0, 4, 0});
    }
    turn_ = placer_.PushOut(turn_, radius + kClearMm);
    const Vec3 entry = FindVertex(placer_.Liver().Mesh(), [&](const Vec3& p) {
      return Distance(p, crossing + 8.0 * right_ + 12.0 * kUpTheDuct) + 40.0 * (Distance(p, neck_) < 6.0);
    });
    const Vec3 origin = placer_.PushOut(crossing + Vec3{26, -7, -3}, radius + kClearMm);
    artery_ = placer_.Route({origin, crossing, turn_, entry}, radius, 0.0, kBehind);
    tubes_.push_back(MakeTubePoints(roles::TubeRole::kRightHepaticArtery, kOutside,
                                    NameOf(roles::OrganRole::kLiver), artery_, radius, 0.8 * radius));
  }

  /// Cystic artery: from the hepatic artery's turn to a side of the gallbladder.
  void PlaceCysticArtery(const char* name_ending, const Vec3& side, bool is_double) {
    const double length = Number("cystic_artery_length");
    const double radius = 0.5 * Number("cystic_artery_diameter") * (is_double ? 0.8 : 1.0);
    // the second one enters another side of the gallbladder, also where neither is long enough to choose
    constexpr double kApartMm = 8.0;
    const Vec3 start = *std::min_element(artery_.begin(), artery_.end(), [&](const Vec3& a, const Vec3& b) {
      return Distance(a, turn_) < Distance(b, turn_);
    });
    const Vec3 target = FindVertex(placer_.Gallbladder().Mesh(), [&](const Vec3& p) {
      const double reach_miss = Distance(p, start) - 0.9 * length;
      Vec3 outward;
      const double depth = placer_.Liver().Find(p, outward);
      double crowding = 0;
      for (const Vec3& other : entries_) crowding += std::max(0.0, kApartMm - Distance(p, other));
      return std::fabs(reach_miss) - 0.6 * Dot(p - neck_, side) + (depth < 2.0 ? 10.0 : 0.0) +
             10.0 * crowding;
    });
    entries_.push_back(target);
    const Vec3 middle = placer_.PushOut(0.5 * (start + target), radius + kClearMm);
    tubes_.push_back(
        MakeTubePoints(roles::TubeRole::kCysticArtery, NameOf(roles::TubeRole::kRightHepaticArtery),
                       NameOf(roles::OrganRole::kGallbladder),
                       placer_.Route({start, middle, target}, radius, length, side), radius, 0.85 * radius));
    tubes_.back().name += name_ending;
  }

  /// Out of the liver at the bed's medial border, along it to the common hepatic duct.
  void PlaceSubvesicalDuct() {
    const double radius = 0.5 * Number("subvesical_duct_diameter");
    const Vec3 goal = PointAt(hepatic_, 0.3);
    const Vec3 start = FindVertex(placer_.Liver().Mesh(), [&](const Vec3& p) {
      Vec3 outward;
      const double away = placer_.Gallbladder().Find(p, outward);
      return std::fabs(away - 4.0) + 0.5 * std::fabs(Distance(p, neck_) - 28.0) - 0.2 * Dot(p - neck_, kLeft);
    });
    tubes_.push_back(
        MakeTubePoints(roles::TubeRole::kSubvesicalDuct, NameOf(roles::OrganRole::kLiver),
                       NameOf(roles::TubeRole::kCommonHepaticDuct),
                       placer_.Route({start, placer_.PushOut(0.5 * (start + goal), radius + kClearMm), goal},
                                     radius, 0.0, kLeft),
                       radius, radius));
  }

  Placer placer_;
  Vec3 neck_;
  std::span<const patient::Parameter> parameters_;
  double hepatic_radius_ = 0, cystic_radius_ = 0, bile_length_ = 0;
  Hilum hilum_;
  Vec3 along_, right_;  // the common hepatic duct; towards the gallbladder
  Vec3 junction_;       // of the cystic duct with it
  std::vector<Vec3> hepatic_, artery_;
  Vec3 turn_;                  // of the right hepatic artery
  std::vector<Vec3> entries_;  // of cystic arteries
  std::vector<contours::TubePoints> tubes_;
};

}  // namespace

std::vector<contours::TubePoints> PlaceDucts(const TriangleMesh& liver, const TriangleMesh& gallbladder,
                                             const Vec3& neck,
                                             std::span<const patient::Parameter> parameters) {
  return DuctTemplate(liver, gallbladder, neck, parameters).Place();
}

std::vector<patient::Tube> MakeTemplateTubes(const TriangleMesh& liver, const TriangleMesh& gallbladder,
                                             const Vec3& neck,
                                             std::span<const patient::Parameter> parameters) {
  constexpr double kSpacing = 0.002;  // m
  const auto in_mm = [](TriangleMesh mesh) {
    for (Vec3& p : mesh.positions) p *= files::kMmPerMetre;
    return mesh;
  };
  const auto rules = ParameterRules();
  const bool is_whole = std::all_of(rules.begin(), rules.end(), [&](const ParameterRule& rule) {
    return std::any_of(parameters.begin(), parameters.end(),
                       [&](const patient::Parameter& parameter) { return parameter.name == rule.name; });
  });
  auto usual = DrawParameters(0, MakeUsualSettings());
  TROCAR_ASSERT(usual.ok());
  const auto placed = PlaceDucts(in_mm(liver), in_mm(gallbladder), files::kMmPerMetre * neck,
                                 is_whole ? parameters : std::span<const patient::Parameter>(*usual));
  std::vector<patient::Tube> tubes;
  for (const contours::TubePoints& points : placed) {
    const auto name_of = [](const std::string& end) { return end == kOutside ? std::string() : end; };
    patient::Tube tube{points.name,
                       points.kind == patient::KindName(patient::TubeKind::kArtery)
                           ? patient::TubeKind::kArtery
                           : patient::TubeKind::kDuct,
                       name_of(points.from),
                       name_of(points.to),
                       {},
                       false};
    for (const contours::TubePoint& point : points.points) {
      tube.line.points.push_back(Vec3{point.pixel.x, point.pixel.y, point.slice} / files::kMmPerMetre);
      tube.line.radii.push_back(point.radius_mm / files::kMmPerMetre);
    }
    tube.line = geometry::Resample(tube.line, kSpacing);
    tubes.push_back(std::move(tube));
  }
  return tubes;
}

std::optional<Vec3> CalcTriangleMiddle(const patient::Patient& patient) {
  const auto middle_of = [&](roles::TubeRole role) -> const Vec3* {
    const int tube = patient.TubeOf(role);
    if (tube < 0) return nullptr;
    const auto& line = patient.tubes[static_cast<std::size_t>(tube)].line.points;
    return &line[line.size() / 2];
  };
  const Vec3 *cystic = middle_of(roles::TubeRole::kCysticDuct),
             *hepatic = middle_of(roles::TubeRole::kCommonHepaticDuct);
  if (cystic == nullptr || hepatic == nullptr) return std::nullopt;
  return 0.5 * (*cystic + *hepatic);
}

double CalcLengthMm(const contours::TubePoints& tube) {
  double sum = 0;
  for (std::size_t i = 1; i < tube.points.size(); ++i) {
    const contours::TubePoint &a = tube.points[i - 1], &b = tube.points[i];
    sum += Norm(Vec3{b.pixel.x - a.pixel.x, b.pixel.y - a.pixel.y, b.slice - a.slice});
  }
  return sum;
}

contours::ControlPoints MakeWorldFrame() {
  contours::ControlPoints points;
  points.axes = {"left", "superior", "anterior"};
  points.origin_landmark = NameOf(roles::LandmarkRole::kFundus);
  points.origin_mm = {-75, 95, -70};
  return points;
}

}  // namespace trocar::anatomy
