// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/patient_lint.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string_view>

#include "nearest_surface.h"
#include "patient_frame.h"
#include "trocar/geometry/mesh_measures.h"

namespace trocar::anatomy {
namespace {

using core::ErrorCode;
using geometry::TriangleMesh;

constexpr double kMlPerCubicMetre = 1e6;
constexpr double kLiverSizeMin = 0.1, kLiverSizeMax = 0.4;  // longest side of the box [m]
constexpr double kBedReach = 0.010;                         // longest attachment [m]
constexpr double kJoinReach = 0.003;                        // between a tube's end and what it joins [m]
constexpr double kLandmarkReach = 0.005;  // between a gallbladder landmark and its surface [m]
constexpr double kDeepInside = 0.002;     // of the gallbladder in the liver [m]
constexpr double kVast = 1e5;             // no coordinate is larger, whatever its unit [m]
constexpr double kMinAngleDeg = 5.0;      // below it springs and normals turn useless
/// Part of the fixed area that may look to the viscera: a few triangles along the edge.
constexpr double kVisceralShare = 0.05;
/// Right, cranial, anterior: where the diaphragm and the abdominal wall lie, seen from the liver.
const Vec3 kTowardsDiaphragm = math::Normalized(Vec3{-0.45, 0.7, 0.55});

struct Range {
  double min = 0, max = 0;
};

/// Volume of a liver: 1200 to 1500 mL, with two standard deviations (17 of 140 mm) of its span either way.
constexpr Range kLiverMl = {500.0, 2900.0};
/// From a scleroatrophic gallbladder (40 x 15 mm) to hydrops (150 x 50 mm), as ellipsoids.
constexpr Range kGallbladderMl = {4.5, 200.0};

struct TubeRange {
  std::string_view name;
  TubeKind kind;
  Range radius_mm, length_mm;
};

/// Normal calibre and length widened by the variations and dilatations that are known; the last two stand for
/// every other duct and artery.
constexpr TubeRange kTubeRanges[] = {
    {"cystic_duct", TubeKind::kDuct, {0.5, 2.5}, {5.0, 80.0}},
    {"common_hepatic_duct", TubeKind::kDuct, {0.5, 5.0}, {10.0, 60.0}},
    {"common_bile_duct", TubeKind::kDuct, {0.75, 7.5}, {30.0, 120.0}},
    {"cystic_artery", TubeKind::kArtery, {0.3, 2.0}, {3.0, 60.0}},
    {"", TubeKind::kDuct, {0.25, 7.5}, {1.0, 200.0}},
    {"", TubeKind::kArtery, {0.25, 6.0}, {1.0, 300.0}},
};

const TubeRange& FindRange(const Tube& tube) {
  for (const TubeRange& range : kTubeRanges) {
    if (range.name == tube.name || (range.name.empty() && range.kind == tube.kind)) return range;
  }
  return *std::prev(std::end(kTubeRanges));
}

std::string Rounded(double value, int digits = 1) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*g",
                std::fabs(value) < 1e5 && std::fabs(value) >= 1.0 ? digits + 3 : 3, value);
  return text;
}

std::string Mm(double metres) {
  return Rounded(kMmPerMetre * metres) + " mm";
}

/// A place as the files give it.
std::string PlaceText(const Vec3& world) {
  const Vec3 p = ToLps(world);
  char text[128];
  std::snprintf(text, sizeof(text), "(%.1f, %.1f, %.1f) mm", p.x, p.y, p.z);
  return text;
}

std::string Count(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

double LongestSide(const TriangleMesh& mesh) {
  const geometry::Box box = geometry::CalcBox(mesh.positions);
  return std::max({box.max.x - box.min.x, box.max.y - box.min.y, box.max.z - box.min.z});
}

/// Centre of a surface by its area: also meaningful for an open mesh.
Vec3 CalcCentre(const TriangleMesh& mesh) {
  Vec3 centre;
  double total = 0;
  for (const auto& t : mesh.triangles) {
    const double area = math::Norm(geometry::CalcAreaNormal(mesh.positions, t));
    centre += area / 3.0 * (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]);
    total += area;
  }
  return total > 0 ? centre / total : mesh.positions.front();
}

/// The mesh with its triangles outwards: an inside-out mesh is one finding, not several.
TriangleMesh Outward(TriangleMesh mesh) {
  if (geometry::CalcVolume(mesh.positions, mesh.triangles) < 0) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  }
  return mesh;
}

/// Smallest angle of each triangle; those below kMinAngleDeg count.
struct Slivers {
  std::size_t count = 0, worst = 0;
  double angle_deg = 180.0;
};

Slivers FindSlivers(const TriangleMesh& mesh) {
  Slivers slivers;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    double smallest = 180.0;
    for (int k = 0; k < 3; ++k) {
      const Vec3& here = mesh.positions[mesh.triangles[i][k]];
      const Vec3 a = mesh.positions[mesh.triangles[i][(k + 1) % 3]] - here;
      const Vec3 b = mesh.positions[mesh.triangles[i][(k + 2) % 3]] - here;
      smallest = std::min(smallest, std::atan2(math::Norm(Cross(a, b)), Dot(a, b)) * 180.0 / M_PI);
    }
    slivers.count += smallest < kMinAngleDeg ? 1 : 0;
    if (smallest < slivers.angle_deg) slivers.angle_deg = smallest, slivers.worst = i;
  }
  return slivers;
}

/// One pass over a patient. Each stage adds its findings; later stages use what earlier ones found usable.
class Linter {
 public:
  Linter(const Patient& patient, const std::vector<core::Error>& mesh_errors)
      : patient_(patient), mesh_errors_(mesh_errors) {}

  LintReport Run() {
    LintNames();
    for (std::size_t i = 0; i < patient_.organs.size(); ++i) LintMesh(i);
    LintUnit();
    LintVolumes();
    for (std::size_t i = 0; i < patient_.organs.size(); ++i) LintRegions(i);
    LintFixedFaces();
    LintAttachments();
    LintTubes();
    LintLandmarks();
    LintSides();
    LintDepth();
    return std::move(report_);
  }

 private:
  void Add(const char* code, std::string where, std::string text) {
    report_.findings.push_back({code, std::move(where), std::move(text)});
  }

  const Organ* FindUsable(std::string_view name) const {
    const int index = patient_.FindOrgan(name);
    return index >= 0 && is_usable_[index] ? &patient_.organs[index] : nullptr;
  }

  const Tube* FindTube(std::string_view name) const {
    for (const Tube& tube : patient_.tubes) {
      if (tube.name == name) return &tube;
    }
    return nullptr;
  }

  void LintNames() {
    const auto look = [this](const auto& things, const char* what) {
      std::set<std::string> names;
      for (const auto& thing : things) {
        if (!names.insert(thing.name).second)
          Add("L-NAME-TWICE", thing.name, std::string("two ") + what + " have this name; rename one");
      }
    };
    look(patient_.organs, "organs");
    look(patient_.tubes, "tubes");
    look(patient_.landmarks, "landmarks");
    for (const Tube& tube : patient_.tubes) {
      if (patient_.FindOrgan(tube.name) >= 0)
        Add("L-NAME-TWICE", tube.name, "an organ and a tube have this name; rename one");
    }
    for (const char* organ : {"liver", "gallbladder"}) {
      if (patient_.FindOrgan(organ) < 0)
        Add("L-ORGAN-MISSING", organ,
            "there is no such organ; place its contours and build the patient again");
    }
  }

  void LintMesh(std::size_t index) {
    const Organ& organ = patient_.organs[index];
    MeshSummary summary{organ.name, organ.mesh.triangles.size(), false, false, 0, 0.0};
    const bool is_unread = index < mesh_errors_.size() && mesh_errors_[index].code != ErrorCode::kNone;
    const auto status = geometry::CheckMesh(organ.mesh);
    const auto vast =
        std::find_if(organ.mesh.positions.begin(), organ.mesh.positions.end(), [](const Vec3& p) {
          return math::IsFinite(p) && std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}) > kVast;
        });
    const bool is_vast = vast != organ.mesh.positions.end();
    is_usable_.push_back(!is_unread && status.ok() && !is_vast && !organ.mesh.triangles.empty());
    if (is_unread) {
      Add("L-MESH-UNREADABLE", organ.name, mesh_errors_[index].Text());
    } else if (!status.ok()) {
      Add("L-MESH-NUMBER", organ.name, status.error().message);
    } else if (is_vast) {
      Add("L-MESH-NUMBER", organ.name,
          "vertex " + std::to_string(vast - organ.mesh.positions.begin()) +
              " lies more than 100 km away; export the mesh again");
    } else if (organ.mesh.triangles.empty()) {
      Add("L-MESH-EMPTY", organ.name, "the mesh has no triangle; build it again");
    }
    if (is_usable_.back()) LintSurface(organ, summary);
    report_.meshes.push_back(std::move(summary));
  }

  void LintSurface(const Organ& organ, MeshSummary& summary) {
    const auto mesh = geometry::InspectMesh(organ.mesh);
    summary.closed = mesh.closed;
    summary.manifold = mesh.manifold;
    summary.volume_ml = kMlPerCubicMetre * mesh.volume;
    if (!mesh.closed) {
      Add("L-MESH-OPEN", organ.name,
          Count(mesh.boundary_edges, "edge belongs", "edges belong") +
              " to one triangle only: the surface has a hole; close it");
    }
    if (!mesh.manifold) {
      Add("L-MESH-MANIFOLD", organ.name,
          Count(mesh.odd_edges, "edge", "edges") + " where not exactly two triangles meet side by side, " +
              Count(mesh.odd_vertices, "vertex", "vertices") + " where two surfaces touch in a point and " +
              Count(mesh.degenerate, "triangle", "triangles") + " without area; repair the mesh");
    }
    if (mesh.closed && !mesh.outward) {
      Add("L-MESH-INSIDE-OUT", organ.name,
          "the triangles face inwards; turn each one round (flip the normals when exporting)");
    }
    const auto cuts = geometry::FindSelfIntersections(organ.mesh);
    summary.self_intersections = cuts.size();
    if (!cuts.empty()) {
      const auto& [a, b] = cuts.front();
      Add("L-MESH-SELF-CUT", organ.name,
          Count(cuts.size(), "pair of triangles cuts", "pairs of triangles cut") +
              " each other, the first (triangles " + std::to_string(a) + " and " + std::to_string(b) +
              ") near " + PlaceText(organ.mesh.positions[organ.mesh.triangles[a][0]]) +
              "; smooth or redraw the contours there");
    }
    const Slivers slivers = FindSlivers(organ.mesh);
    if (slivers.count > 0) {
      Add("L-MESH-ANGLE", organ.name,
          Count(slivers.count, "triangle has", "triangles have") + " an angle below 5 degrees, the worst " +
              Rounded(slivers.angle_deg) + " degrees (triangle " + std::to_string(slivers.worst) + ") near " +
              PlaceText(organ.mesh.positions[organ.mesh.triangles[slivers.worst][0]]) + "; remesh it");
    }
  }

  void LintUnit() {
    const Organ* liver = FindUsable("liver");
    if (liver == nullptr) return;
    const double size = LongestSide(liver->mesh);
    const auto fits = [](double metres) { return metres >= kLiverSizeMin && metres <= kLiverSizeMax; };
    is_unit_right_ = fits(size);
    if (is_unit_right_) return;
    std::string guess = "; check the unit of the meshes";
    if (fits(1000.0 * size)) guess = ": the file looks like metres; its numbers must be millimetres";
    if (fits(10.0 * size)) guess = ": the file looks like centimetres; its numbers must be millimetres";
    if (fits(size / 1000.0))
      guess = ": this looks like millimetres taken for metres; divide the coordinates by 1000";
    Add("L-UNIT", "liver",
        "the longest side of its box is " + Mm(size) + ", and a liver's is 100 to 400 mm" + guess);
  }

  void LintVolumes() {
    if (!is_unit_right_) return;
    for (std::size_t i = 0; i < patient_.organs.size(); ++i) {
      const MeshSummary& mesh = report_.meshes[i];
      const bool is_liver = mesh.name == "liver";
      if (!mesh.closed || (!is_liver && mesh.name != "gallbladder")) continue;
      const Range& range = is_liver ? kLiverMl : kGallbladderMl;
      const double volume = std::fabs(mesh.volume_ml);
      if (volume >= range.min && volume <= range.max) continue;
      Add("L-VOLUME", mesh.name,
          "its volume is " + Rounded(volume) + " mL, plausible is " + Rounded(range.min) + " to " +
              Rounded(range.max) + " mL; check the contours and the distance between slices");
    }
  }

  void LintRegions(std::size_t index) {
    const Organ& organ = patient_.organs[index];
    std::vector<const char*> wanted;
    if (organ.name == "liver") wanted = {kDiaphragmaticFace, kFalciform, kCoronary, kGallbladderBed};
    if (organ.name == "gallbladder") wanted = {kGallbladderBed};
    for (const char* name : wanted) {
      const bool is_there = std::any_of(organ.regions.begin(), organ.regions.end(),
                                        [&](const Region& region) { return region.name == name; });
      if (!is_there)
        Add("L-REGION-MISSING", organ.name + "/" + name, "there is no such region; build the patient again");
    }
    std::set<std::string> names;
    for (const Region& region : organ.regions) {
      const std::string where = organ.name + "/" + region.name;
      if (!names.insert(region.name).second)
        Add("L-NAME-TWICE", where, "two regions have this name; rename one");
      if (region.vertices.empty())
        Add("L-REGION-EMPTY", where, "the region has no vertex; build the patient again");
      const auto outside = std::count_if(region.vertices.begin(), region.vertices.end(),
                                         [&](std::uint32_t v) { return v >= organ.mesh.positions.size(); });
      // without its mesh nothing can be said of a region's vertices
      if (outside > 0 && is_usable_[index]) {
        Add("L-REGION-RANGE", where,
            Count(static_cast<std::size_t>(outside), "vertex is", "vertices are") +
                " not in the mesh; the mesh was changed after the regions: build the patient again");
      }
      const auto fall = std::adjacent_find(region.vertices.begin(), region.vertices.end(),
                                           [](auto a, auto b) { return a >= b; });
      if (fall != region.vertices.end())
        Add("L-REGION-ORDER", where, "its vertices do not ascend, or one is there twice; sort them");
    }
  }

  void LintFixedFaces() {
    const Organ* liver = FindUsable("liver");
    if (liver == nullptr) return;
    const TriangleMesh mesh = Outward(liver->mesh);
    std::vector<Vec3> normals(mesh.positions.size());
    geometry::CalcVertexNormals(mesh.positions, mesh.triangles, normals);
    const auto areas = geometry::CalcVertexAreas(mesh.positions, mesh.triangles);
    std::set<std::uint32_t> bed;
    for (const Region& region : liver->regions) {
      if (region.name == kGallbladderBed) bed.insert(region.vertices.begin(), region.vertices.end());
    }
    for (const Region& region : liver->regions) {
      if (region.name != kDiaphragmaticFace && region.name != kFalciform && region.name != kCoronary)
        continue;
      double all = 0, visceral = 0;
      std::size_t in_bed = 0;
      for (const auto v : region.vertices) {
        if (v >= areas.size()) continue;
        all += areas[v];
        visceral += Dot(normals[v], kTowardsDiaphragm) < 0 ? areas[v] : 0.0;
        in_bed += bed.contains(v) ? 1 : 0;
      }
      if (visceral > kVisceralShare * all) {
        Add("L-REGION-VISCERAL", "liver/" + region.name,
            Rounded(100.0 * visceral / all) +
                " % of this fixed region lies on the visceral face, which must be free to move; draw it "
                "again");
      } else if (in_bed > 0) {
        Add("L-REGION-VISCERAL", "liver/" + region.name,
            Count(in_bed, "vertex", "vertices") +
                " of this fixed region also belong to the gallbladder bed, which must be free to move; draw "
                "it "
                "again");
      }
    }
  }

  void LintAttachments() {
    struct Tally {
      std::size_t all = 0, outside = 0, far = 0;
      double longest = 0;
      Vec3 place;
    };
    std::vector<std::pair<std::string, Tally>> tallies;
    for (const Attachment& a : patient_.attachments) {
      auto tally =
          std::find_if(tallies.begin(), tallies.end(), [&](const auto& t) { return t.first == a.name; });
      if (tally == tallies.end()) tally = tallies.insert(tallies.end(), {a.name, {}});
      Tally& t = tally->second;
      ++t.all;
      const auto is_outside = [&](std::uint32_t organ, std::uint32_t vertex) {
        return organ >= patient_.organs.size() ||
               (is_usable_[organ] && vertex >= patient_.organs[organ].mesh.positions.size());
      };
      if (is_outside(a.organ_a, a.vertex_a) || is_outside(a.organ_b, a.vertex_b)) {
        ++t.outside;
        continue;
      }
      if (!is_unit_right_ || !is_usable_[a.organ_a] || !is_usable_[a.organ_b]) continue;
      const Vec3& from = patient_.organs[a.organ_a].mesh.positions[a.vertex_a];
      const double length = Distance(from, patient_.organs[a.organ_b].mesh.positions[a.vertex_b]);
      if (length <= kBedReach) continue;
      ++t.far;
      if (length > t.longest) t.longest = length, t.place = from;
    }
    for (const auto& [name, t] : tallies) {
      if (t.outside > 0) {
        Add("L-ATTACHMENT-RANGE", name,
            std::to_string(t.outside) + " of " + std::to_string(t.all) +
                " attachments name an organ or vertex that is not there; build the patient again");
      }
      if (t.far > 0) {
        Add("L-ATTACHMENT-FAR", name,
            std::to_string(t.far) + " of " + std::to_string(t.all) +
                " attachments reach further than 10 mm, the longest " + Mm(t.longest) + " from " +
                PlaceText(t.place) + "; build the patient again");
      }
    }
  }

  /// \return distance to the skin of the tube [m], 0 inside
  static double DistanceToTube(const Vec3& p, const geometry::CentreLine& line) {
    double nearest = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
      const double t = geometry::FindNearestOnSegment(p, line.points[i], line.points[i + 1]);
      const double radius = line.radii[i] + t * (line.radii[i + 1] - line.radii[i]);
      nearest = std::min(nearest, Distance(p, math::Lerp(line.points[i], line.points[i + 1], t)) - radius);
    }
    return std::max(nearest, 0.0);
  }

  static bool IsWellFormed(const Tube& tube) {
    const auto& line = tube.line;
    return line.points.size() >= 2 && line.points.size() == line.radii.size() &&
           std::all_of(line.points.begin(), line.points.end(),
                       [](const Vec3& p) { return math::IsFinite(p); }) &&
           std::all_of(line.radii.begin(), line.radii.end(), [](double r) { return std::isfinite(r); });
  }

  void LintTubeEnd(const Tube& tube, const std::string& target, const Vec3& end, const std::string& where) {
    if (target.empty()) return;  // leaves the scene
    const Tube* other = FindTube(target);
    const bool is_known = patient_.FindOrgan(target) >= 0 || (other != nullptr && other != &tube);
    if (!is_known) {
      Add("L-TUBE-END", where,
          "it ends nowhere: '" + target +
              "' is neither an organ nor another tube; name what it joins, or nothing where it leaves the "
              "scene");
      return;
    }
    if (!is_unit_right_ || !IsWellFormed(tube)) return;
    double distance = 0;
    if (const Organ* organ = FindUsable(target); organ != nullptr) {
      const TriangleMesh mesh = Outward(organ->mesh);
      const NearestSurface surface(mesh);
      distance = surface.Find(end).distance;
      // ducts and arteries of the liver run on inside it
      if (target == "liver" && distance > kJoinReach && surface.IsInside(end)) distance = 0;
    } else if (other != nullptr && IsWellFormed(*other)) {
      distance = DistanceToTube(end, other->line);
    }
    if (distance > kJoinReach) {
      Add("L-TUBE-FAR", where,
          "the end at " + PlaceText(end) + " lies " + Mm(distance) + " from " + target +
              ", which it claims to join; move it there (at most 3 mm)");
    }
  }

  void LintTubes() {
    for (const Tube& tube : patient_.tubes) {
      const auto& line = tube.line;
      if (line.points.size() < 2 || line.points.size() != line.radii.size()) {
        Add("L-TUBE-POINTS", tube.name, "it needs two points or more, and a radius for each");
      } else if (!IsWellFormed(tube)) {
        Add("L-TUBE-NUMBER", tube.name, "a point or radius is not finite; write the file again");
      } else if (is_unit_right_) {
        LintTubeSize(tube);
      }
      const Vec3 nowhere;
      const bool has_points = !line.points.empty();
      LintTubeEnd(tube, tube.from, has_points ? line.points.front() : nowhere, tube.name + "/from");
      LintTubeEnd(tube, tube.to, has_points ? line.points.back() : nowhere, tube.name + "/to");
      LintTubeLinks(tube);
    }
  }

  /// What leaves the scene must still be joined to something in it.
  void LintTubeLinks(const Tube& tube) {
    if (tube.name == "cystic_duct" && (tube.from.empty() || tube.to.empty())) {
      Add("L-TUBE-END", tube.name + (tube.from.empty() ? "/from" : "/to"),
          "it ends nowhere: a cystic duct joins the gallbladder to a duct and never leaves the scene");
      return;
    }
    if (tube.name == "cystic_artery" && tube.from != "gallbladder" && tube.to != "gallbladder") {
      Add("L-TUBE-END", tube.name, "it ends nowhere: a cystic artery leads to the gallbladder");
      return;
    }
    if (!tube.from.empty() || !tube.to.empty()) return;
    const bool is_joined = std::any_of(patient_.tubes.begin(), patient_.tubes.end(), [&](const Tube& other) {
      return &other != &tube && (other.from == tube.name || other.to == tube.name);
    });
    if (!is_joined) Add("L-TUBE-END", tube.name, "it ends nowhere: it joins nothing, and nothing joins it");
  }

  void LintTubeSize(const Tube& tube) {
    const TubeRange& range = FindRange(tube);
    const auto [thin, thick] = std::minmax_element(tube.line.radii.begin(), tube.line.radii.end());
    const double min_mm = kMmPerMetre * *thin, max_mm = kMmPerMetre * *thick;
    // file and arithmetic round: a radius on the border is inside
    constexpr double kRound = 1e-9;
    if (min_mm < range.radius_mm.min - kRound || max_mm > range.radius_mm.max + kRound) {
      Add("L-TUBE-RADIUS", tube.name,
          "its radius runs from " + Rounded(min_mm) + " to " + Rounded(max_mm) + " mm, plausible is " +
              Rounded(range.radius_mm.min) + " to " + Rounded(range.radius_mm.max) +
              " mm; correct the radii");
    }
    const double length_mm = kMmPerMetre * geometry::CalcLength(tube.line);
    // of a tube that leaves the scene only a part is there
    const bool is_whole = !tube.from.empty() && !tube.to.empty();
    if (length_mm > range.length_mm.max || (is_whole && length_mm < range.length_mm.min)) {
      Add("L-TUBE-LENGTH", tube.name,
          "it is " + Rounded(length_mm) + " mm long, plausible is " + Rounded(range.length_mm.min) + " to " +
              Rounded(range.length_mm.max) + " mm; check its points");
    }
  }

  void LintLandmarks() {
    for (const char* name : {"umbilicus", "fundus", "infundibulum"}) {
      if (patient_.FindLandmark(name) == nullptr)
        Add("L-LANDMARK-MISSING", name, "there is no such landmark; place it");
    }
    for (const Landmark& landmark : patient_.landmarks) {
      if (!math::IsFinite(landmark.position))
        Add("L-LANDMARK-NUMBER", landmark.name, "its position is not finite; place it again");
    }
    const Organ* gallbladder = FindUsable("gallbladder");
    if (gallbladder == nullptr || !is_unit_right_) return;
    const NearestSurface surface(gallbladder->mesh);
    for (const char* name : {"fundus", "infundibulum"}) {
      const Landmark* landmark = patient_.FindLandmark(name);
      if (landmark == nullptr || !math::IsFinite(landmark->position)) continue;
      const double distance = surface.Find(landmark->position).distance;
      if (distance > kLandmarkReach) {
        Add("L-LANDMARK-FAR", name,
            "it lies " + Mm(distance) +
                " from the surface of the gallbladder; place it there (at most 5 mm)");
      }
    }
  }

  /// A finite landmark's place.
  std::optional<Vec3> FindPlace(std::string_view name) const {
    const Landmark* landmark = patient_.FindLandmark(name);
    if (landmark == nullptr || !math::IsFinite(landmark->position)) return std::nullopt;
    return landmark->position;
  }

  void LintSides() {
    const auto umbilicus = FindPlace("umbilicus");
    for (const char* name : {"liver", "gallbladder"}) {
      const Organ* organ = FindUsable(name);
      if (!umbilicus || organ == nullptr) continue;
      const double left = CalcCentre(organ->mesh).x - umbilicus->x;
      if (left <= 0) continue;
      Add("L-SIDE-LEFT-RIGHT", name,
          "its centre lies " + Mm(left) +
              " to the patient's left of the umbilicus, and it belongs to the right: left and right are "
              "swapped "
              "(RAS read as LPS?)");
    }
    const auto fundus = FindPlace("fundus");
    auto inner = FindPlace("infundibulum");
    const Tube* hepatic = FindTube("common_hepatic_duct");
    if (!inner && hepatic != nullptr && IsWellFormed(*hepatic)) inner = hepatic->line.points.front();
    if (!fundus || !inner) return;
    if (fundus->y >= inner->y) {
      Add("L-SIDE-CRANIAL-CAUDAL", "gallbladder",
          "the fundus does not lie caudal to the infundibulum: cranial and caudal are swapped (slices in the "
          "wrong order?)");
    }
    if (fundus->z <= inner->z) {
      Add("L-SIDE-ANTERIOR-POSTERIOR", "gallbladder",
          "the fundus does not lie anterior to the infundibulum: anterior and posterior are swapped (RAS "
          "read as "
          "LPS?)");
    }
  }

  void LintDepth() {
    const Organ *liver = FindUsable("liver"), *gallbladder = FindUsable("gallbladder");
    if (liver == nullptr || gallbladder == nullptr || !is_unit_right_) return;
    const TriangleMesh mesh = Outward(liver->mesh);
    const NearestSurface surface(mesh);
    std::size_t inside = 0;
    double deepest = 0;
    Vec3 place;
    for (const Vec3& p : gallbladder->mesh.positions) {
      const double depth = surface.Find(p).distance;
      if (depth <= kDeepInside || !surface.IsInside(p)) continue;
      ++inside;
      if (depth > deepest) deepest = depth, place = p;
    }
    if (inside == 0) return;
    Add("L-GALLBLADDER-DEEP", "gallbladder",
        Count(inside, "vertex lies", "vertices lie") + " deeper than 2 mm inside the liver, the deepest " +
            Mm(deepest) + " at " + PlaceText(place) + "; part the two contours there");
  }

  const Patient& patient_;
  const std::vector<core::Error>& mesh_errors_;
  std::vector<bool> is_usable_;  // (organs) finite, indices in range, not empty
  bool is_unit_right_ = true;
  LintReport report_;
};

}  // namespace

LintReport LintPatient(const Patient& patient) {
  return Linter(patient, {}).Run();
}

core::Result<LintReport> LintPatientFolder(const std::filesystem::path& folder) {
  const auto read = ReadPatientUnchecked(folder);
  if (!read.ok()) return read.error();
  return Linter(read->patient, read->mesh_errors).Run();
}

}  // namespace trocar::anatomy
