// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/patient_edit.h"

#include <algorithm>
#include <cmath>

#include "duct_template.h"
#include "gallbladder_bed.h"
#include "trocar/files/patient_frame.h"
#include "trocar/math/elementary.h"
#include "trocar/meshing/nearest_surface.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using geometry::TriangleMesh;

constexpr double kStrandReach = 0.010;  // longest strand of the bed [m], as the linter has it
constexpr double kThinnest = 0.0001, kThickest = 0.015;  // radius of a tube [m]

base::Error Invalid(const std::string& text) {
  return {base::ErrorCode::kPatientInvalid, text};
}

base::Status CheckPoint(const patient::Patient& patient, std::uint32_t tube, std::uint32_t point) {
  if (tube >= patient.tubes.size() || point >= patient.tubes[tube].line.points.size())
    return Invalid("there is no such point of a duct or artery; choose one in the picture");
  return {};
}

/// 1 at the middle, 0 from `reach` on, smooth.
double CalcFollow(double away, double reach) {
  if (away >= reach) return away == 0 ? 1.0 : 0.0;
  const double t = away / reach, left = 1 - t * t;
  return left * left;
}

/// Distance along the line from one point to every other [m].
std::vector<double> CalcAway(const geometry::CentreLine& line, std::uint32_t point) {
  std::vector<double> away(line.points.size(), 0.0);
  for (std::size_t i = point + 1; i < away.size(); ++i)
    away[i] = away[i - 1] + Distance(line.points[i], line.points[i - 1]);
  for (std::size_t i = point; i > 0; --i)
    away[i - 1] = away[i] + Distance(line.points[i], line.points[i - 1]);
  return away;
}

/// Moves one point of a line by `shift`, its neighbours less and less.
/// \return how far each moved
std::vector<math::Vec3> Drag(geometry::CentreLine& line, std::uint32_t point, const math::Vec3& shift,
                             double reach) {
  const auto away = CalcAway(line, point);
  std::vector<math::Vec3> shifts(away.size());
  for (std::size_t i = 0; i < away.size(); ++i) {
    shifts[i] = CalcFollow(away[i], reach) * shift;
    line.points[i] += shifts[i];
  }
  return shifts;
}

/// Strands of the gallbladder's bed after its region has changed.
void FollowBed(patient::Patient& patient, std::uint32_t gallbladder, const patient::Region& bed) {
  const int liver = patient.OrganOf(roles::OrganRole::kLiver);
  if (liver < 0 || patient.organs[liver].mesh.triangles.empty()) return;
  const auto is_in_bed = [&](std::uint32_t v) {
    return std::binary_search(bed.vertices.begin(), bed.vertices.end(), v);
  };
  const auto is_strand = [&](const patient::Attachment& a) {
    return a.organ_a == gallbladder && a.organ_b == static_cast<std::uint32_t>(liver);
  };
  std::erase_if(patient.attachments,
                [&](const patient::Attachment& a) { return is_strand(a) && !is_in_bed(a.vertex_a); });
  std::vector<std::uint32_t> tied;
  for (const patient::Attachment& a : patient.attachments) {
    if (is_strand(a)) tied.push_back(a.vertex_a);
  }
  std::sort(tied.begin(), tied.end());
  const meshing::NearestSurface surface(patient.organs[liver].mesh);
  for (const auto v : bed.vertices) {
    if (std::binary_search(tied.begin(), tied.end(), v)) continue;
    const meshing::SurfacePoint near = surface.Find(patient.organs[gallbladder].mesh.positions[v]);
    if (near.distance > kStrandReach) continue;
    const TriangleMesh& liver_mesh = patient.organs[liver].mesh;
    for (const auto carrier : FindCarriers(liver_mesh, near)) {
      // a large triangle's corners may lie further away than it does
      if (Distance(patient.organs[gallbladder].mesh.positions[v], liver_mesh.positions[carrier]) >
          kStrandReach)
        continue;
      patient.attachments.push_back(
          {patient::kGallbladderBed, gallbladder, v, static_cast<std::uint32_t>(liver), carrier});
    }
  }
  // one order whatever was painted first, in the place of the first strand
  const auto first = std::find_if(patient.attachments.begin(), patient.attachments.end(), is_strand);
  const auto last = std::stable_partition(first, patient.attachments.end(), is_strand);
  std::stable_sort(first, last, [](const patient::Attachment& a, const patient::Attachment& b) {
    return a.vertex_a < b.vertex_a;
  });
}

}  // namespace

std::vector<std::uint32_t> FindBrushVertices(const geometry::TriangleMesh& mesh,
                                             const geometry::Rows& neighbours, std::uint32_t vertex,
                                             const math::Vec3& place, double radius) {
  std::vector<std::uint32_t> found = {vertex}, stack = {vertex};
  std::vector<char> is_seen(mesh.positions.size(), 0);
  is_seen[vertex] = 1;
  while (!stack.empty()) {
    const auto here = stack.back();
    stack.pop_back();
    for (const auto w : neighbours.Row(here)) {
      if (is_seen[w] || Distance(mesh.positions[w], place) > radius) continue;
      is_seen[w] = 1;
      found.push_back(w);
      stack.push_back(w);
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

base::Status PaintRegion(patient::Patient& patient, std::string_view organ_name, std::string_view region_name,
                         std::span<const std::uint32_t> vertices, bool is_added) {
  const int index = patient.FindOrgan(organ_name);
  if (index < 0) return Invalid("there is no organ \"" + std::string(organ_name) + "\"");
  patient::Organ& organ = patient.organs[index];
  if (!patient::IsPlainName(region_name)) return Invalid("a region's name consists of a-z, 0-9 and _");
  if (std::any_of(vertices.begin(), vertices.end(), [&](auto v) { return v >= organ.mesh.positions.size(); }))
    return Invalid("a vertex is not in the mesh of " + organ.name);
  auto region = std::find_if(organ.regions.begin(), organ.regions.end(),
                             [&](const patient::Region& each) { return each.name == region_name; });
  if (region == organ.regions.end()) {
    if (!is_added) return {};
    region = organ.regions.insert(organ.regions.end(), patient::Region{std::string(region_name), {}});
  }
  std::vector<std::uint32_t> brush(vertices.begin(), vertices.end()), painted;
  std::sort(brush.begin(), brush.end());
  brush.erase(std::unique(brush.begin(), brush.end()), brush.end());
  const auto& old = region->vertices;
  if (is_added) {
    std::set_union(old.begin(), old.end(), brush.begin(), brush.end(), std::back_inserter(painted));
  } else {
    std::set_difference(old.begin(), old.end(), brush.begin(), brush.end(), std::back_inserter(painted));
  }
  region->vertices = std::move(painted);
  if (organ.role == roles::OrganRole::kGallbladder && region->role == roles::RegionRole::kGallbladderBed)
    FollowBed(patient, static_cast<std::uint32_t>(index), *region);
  return {};
}

base::Status MoveTubePoint(patient::Patient& patient, std::uint32_t tube, std::uint32_t point,
                           const math::Vec3& position, double reach) {
  if (const auto status = CheckPoint(patient, tube, point); !status) return status;
  if (!math::IsFinite(position) || !(reach >= 0)) return Invalid("the place is not finite");
  const TubeGraph graph = MakeTubeGraph(patient);
  const auto shifts =
      Drag(patient.tubes[tube].line, point, position - patient.tubes[tube].line.points[point], reach);
  // what is joined to a point that moved moves as far
  for (const TubeNode& node : graph.nodes) {
    const auto own = std::find_if(node.vertices.begin(), node.vertices.end(),
                                  [&](const TubeVertex& v) { return v.tube == tube; });
    if (own == node.vertices.end() || shifts[own->point] == math::Vec3{}) continue;
    for (const TubeVertex& other : node.vertices) {
      if (other.tube != tube) Drag(patient.tubes[other.tube].line, other.point, shifts[own->point], reach);
    }
  }
  return {};
}

base::Status InsertTubePoint(patient::Patient& patient, std::uint32_t tube, std::uint32_t after,
                             const math::Vec3& position) {
  if (const auto status = CheckPoint(patient, tube, after + 1); !status) return status;
  if (!math::IsFinite(position)) return Invalid("the place is not finite");
  auto& line = patient.tubes[tube].line;
  const auto at = static_cast<std::ptrdiff_t>(after) + 1;
  const double before = Distance(line.points[after], position),
               behind = Distance(position, line.points[after + 1]);
  const double share = before + behind > 0 ? before / (before + behind) : 0.5;
  line.radii.insert(line.radii.begin() + at,
                    line.radii[after] + share * (line.radii[after + 1] - line.radii[after]));
  line.points.insert(line.points.begin() + at, position);
  return {};
}

base::Status DeleteTubePoint(patient::Patient& patient, std::uint32_t tube, std::uint32_t point) {
  if (const auto status = CheckPoint(patient, tube, point); !status) return status;
  auto& line = patient.tubes[tube].line;
  if (line.points.size() <= 2)
    return Invalid(patient.tubes[tube].name + " needs two points; remove it as a whole");
  line.points.erase(line.points.begin() + point);
  line.radii.erase(line.radii.begin() + point);
  return {};
}

base::Status ScaleTubeRadius(patient::Patient& patient, std::uint32_t tube, std::uint32_t point,
                             double factor, double reach) {
  if (const auto status = CheckPoint(patient, tube, point); !status) return status;
  if (!(factor > 0) || !std::isfinite(factor) || !(reach >= 0))
    return Invalid("a radius grows by a factor above 0");
  auto& line = patient.tubes[tube].line;
  const auto away = CalcAway(line, point);
  for (std::size_t i = 0; i < away.size(); ++i) {
    line.radii[i] =
        std::clamp(line.radii[i] * math::Pow(factor, CalcFollow(away[i], reach)), kThinnest, kThickest);
  }
  return {};
}

base::Status JoinTubeEnd(patient::Patient& patient, std::uint32_t tube, TubeEnd end, std::string_view name) {
  if (const auto status = CheckPoint(patient, tube, 0); !status) return status;
  patient::Tube& self = patient.tubes[tube];
  if (name == self.name) return Invalid(self.name + " cannot join itself");
  std::string known;
  bool is_known = name.empty();
  const auto look = [&](const std::string& each) {
    is_known |= each == name;
    known += (known.empty() ? "" : ", ") + each;
  };
  for (const patient::Organ& organ : patient.organs) look(organ.name);
  for (const patient::Tube& other : patient.tubes) look(other.name);
  if (!is_known) {
    return base::Error{base::ErrorCode::kUnknownName,
                       "there is no organ or tube \"" + std::string(name) + "\"; known are " + known};
  }
  (end == TubeEnd::kFrom ? self.from : self.to) = name;
  // only this end is to move, however far
  patient::Patient part;
  part.organs = patient.organs;
  part.tubes = patient.tubes;
  for (std::uint32_t t = 0; t < part.tubes.size(); ++t) {
    if (t != tube || end != TubeEnd::kFrom) part.tubes[t].from.clear();
    if (t != tube || end != TubeEnd::kTo) part.tubes[t].to.clear();
  }
  constexpr double kAnywhere = 10.0;  // m
  JoinTubes(part, kAnywhere);
  self.line = std::move(part.tubes[tube].line);
  return {};
}

base::Status AddTube(patient::Patient& patient, patient::Tube tube) {
  const bool is_taken = patient.FindOrgan(tube.name) >= 0 || patient.FindTube(tube.name) >= 0;
  if (is_taken || !patient::IsPlainName(tube.name))
    return Invalid("the name \"" + tube.name + "\" is taken or no plain word (a-z, 0-9 and _)");
  const auto& line = tube.line;
  const bool is_usable =
      line.points.size() >= 2 && line.points.size() == line.radii.size() &&
      std::all_of(line.points.begin(), line.points.end(),
                  [](const math::Vec3& p) { return math::IsFinite(p); }) &&
      std::all_of(line.radii.begin(), line.radii.end(), [](double r) { return r > 0 && std::isfinite(r); });
  if (!is_usable) return Invalid("a duct or artery needs two points or more, each with a radius");
  patient.tubes.push_back(std::move(tube));
  return {};
}

base::Status RemoveTube(patient::Patient& patient, std::uint32_t tube) {
  if (const auto status = CheckPoint(patient, tube, 0); !status) return status;
  const std::string name = patient.tubes[tube].name;
  patient.tubes.erase(patient.tubes.begin() + tube);
  for (patient::Tube& other : patient.tubes) {
    if (other.from == name) other.from.clear();
    if (other.to == name) other.to.clear();
  }
  return {};
}

std::vector<std::string> FindMissingTubes(const patient::Patient& patient) {
  std::vector<std::string> missing;
  for (const roles::TubeRole role :
       {roles::TubeRole::kCysticDuct, roles::TubeRole::kCommonHepaticDuct, roles::TubeRole::kCommonBileDuct,
        roles::TubeRole::kRightHepaticArtery, roles::TubeRole::kCysticArtery}) {
    if (patient.TubeOf(role) < 0) missing.emplace_back(roles::NameOf(role));
  }
  return missing;
}

namespace {

/// What the patient calls the organ or tube of a conventional name.
std::string FindOwnName(const patient::Patient& patient, const std::string& conventional) {
  if (patient.FindOrgan(conventional) >= 0 || patient.FindTube(conventional) >= 0) return conventional;
  const roles::OrganRole organ = roles::ConventionalRole<roles::OrganRole>(conventional);
  if (organ != roles::OrganRole::kOther && patient.OrganOf(organ) >= 0)
    return patient.organs[patient.OrganOf(organ)].name;
  const roles::TubeRole tube = roles::ConventionalRole<roles::TubeRole>(conventional);
  if (tube != roles::TubeRole::kOther && patient.TubeOf(tube) >= 0)
    return patient.tubes[patient.TubeOf(tube)].name;
  return conventional;
}

}  // namespace

base::Status AddTemplateTube(patient::Patient& patient, std::string_view name) {
  const int liver = patient.OrganOf(roles::OrganRole::kLiver),
            gallbladder = patient.OrganOf(roles::OrganRole::kGallbladder);
  const patient::Landmark* neck = patient.LandmarkOf(roles::LandmarkRole::kInfundibulum);
  if (liver < 0 || gallbladder < 0 || neck == nullptr)
    return Invalid("ducts are placed by liver, gallbladder and the landmark infundibulum; place it first");
  auto tubes = MakeTemplateTubes(patient.organs[liver].mesh, patient.organs[gallbladder].mesh, neck->position,
                                 patient.parameters);
  const auto wanted =
      std::find_if(tubes.begin(), tubes.end(), [&](const patient::Tube& tube) { return tube.name == name; });
  if (wanted == tubes.end())
    return base::Error{base::ErrorCode::kUnknownName,
                       "\"" + std::string(name) + "\" is none of the usual tubes"};
  if (auto status = AddTube(patient, std::move(*wanted)); !status) return status;
  // its ends meet the patient's own tubes, wherever those run
  const auto index = static_cast<std::uint32_t>(patient.tubes.size() - 1);
  for (const TubeEnd end : {TubeEnd::kFrom, TubeEnd::kTo}) {
    const std::string target =
        FindOwnName(patient, end == TubeEnd::kFrom ? patient.tubes[index].from : patient.tubes[index].to);
    if (!JoinTubeEnd(patient, index, end, target)) {
      // what it would join is missing, too: it leaves the scene there
      if (auto status = JoinTubeEnd(patient, index, end, ""); !status) return status;
    }
  }
  return {};
}

base::Status PlaceLandmark(patient::Patient& patient, std::string_view name, const math::Vec3& position) {
  if (!patient::IsPlainName(name)) return Invalid("a landmark's name consists of a-z, 0-9 and _");
  if (!math::IsFinite(position)) return Invalid("the place is not finite");
  math::Vec3 place = position;
  const auto known = std::find_if(patient.landmarks.begin(), patient.landmarks.end(),
                                  [&](const patient::Landmark& landmark) { return landmark.name == name; });
  const roles::LandmarkRole role =
      known == patient.landmarks.end() ? roles::ConventionalRole<roles::LandmarkRole>(name) : known->role;
  const int gallbladder = patient.OrganOf(roles::OrganRole::kGallbladder);
  if ((role == roles::LandmarkRole::kFundus || role == roles::LandmarkRole::kInfundibulum) &&
      gallbladder >= 0 && !patient.organs[gallbladder].mesh.triangles.empty()) {
    place = meshing::NearestSurface(patient.organs[gallbladder].mesh).Find(position).at.point;
  }
  if (known == patient.landmarks.end()) {
    patient.landmarks.push_back({std::string(name), place});
  } else {
    known->position = place;
  }
  return {};
}

std::optional<math::Vec3> FindWhere(const patient::Patient& patient, std::string_view where) {
  const auto slash = where.find('/');
  const std::string_view name = where.substr(0, slash);
  const std::string_view part =
      slash == std::string_view::npos ? std::string_view() : where.substr(slash + 1);
  const auto middle = [](std::span<const math::Vec3> points) -> std::optional<math::Vec3> {
    math::Vec3 sum;
    for (const math::Vec3& p : points) sum += p;
    if (points.empty() || !math::IsFinite(sum)) return std::nullopt;
    return sum / static_cast<double>(points.size());
  };
  for (const patient::Organ& organ : patient.organs) {
    if (organ.name != name) continue;
    for (const patient::Region& region : organ.regions) {
      if (region.name != part) continue;
      std::vector<math::Vec3> points;
      for (const auto v : region.vertices) {
        if (v < organ.mesh.positions.size()) points.push_back(organ.mesh.positions[v]);
      }
      if (const auto found = middle(points)) return found;
    }
    return middle(organ.mesh.positions);
  }
  for (const patient::Tube& tube : patient.tubes) {
    if (tube.name != name || tube.line.points.empty()) continue;
    if (part == "from") return tube.line.points.front();
    if (part == "to") return tube.line.points.back();
    return tube.line.points[tube.line.points.size() / 2];
  }
  if (const patient::Landmark* landmark = patient.FindLandmark(name)) return landmark->position;
  std::vector<math::Vec3> points;
  for (const patient::Attachment& a : patient.attachments) {
    if (a.name == name && a.organ_a < patient.organs.size() &&
        a.vertex_a < patient.organs[a.organ_a].mesh.positions.size())
      points.push_back(patient.organs[a.organ_a].mesh.positions[a.vertex_a]);
  }
  return middle(points);
}

}  // namespace trocar::anatomy
