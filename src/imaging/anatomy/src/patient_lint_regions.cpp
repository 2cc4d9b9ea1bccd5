// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>
#include <utility>

#include "liver_regions.h"
#include "patient_linter.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using geometry::TriangleMesh;

constexpr double kBedReach = 0.010;  // longest attachment [m]
/// Part of the fixed area that may look to the viscera: a few triangles along the edge.
constexpr double kVisceralShare = 0.05;

}  // namespace

void Linter::LintRegions(std::size_t index) {
  const patient::Organ& organ = patient_.organs[index];
  std::vector<roles::RegionRole> wanted;
  if (organ.role == roles::OrganRole::kLiver)
    wanted = {roles::RegionRole::kDiaphragmaticFace, roles::RegionRole::kFalciform,
              roles::RegionRole::kCoronary, roles::RegionRole::kGallbladderBed};
  if (organ.role == roles::OrganRole::kGallbladder) wanted = {roles::RegionRole::kGallbladderBed};
  for (const roles::RegionRole role : wanted) {
    if (organ.RegionOf(role) == nullptr)
      Add("L-REGION-MISSING", organ.name + "/" + roles::NameOf(role),
          "there is no such region; build the patient again");
  }
  std::set<std::string> names;
  for (const patient::Region& region : organ.regions) {
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

void Linter::LintFixedFaces() {
  const patient::Organ* liver = FindUsable(roles::OrganRole::kLiver);
  if (liver == nullptr || !is_unit_right_) return;
  const TriangleMesh mesh = Outward(liver->mesh);
  const auto normals =
      CalcBroadNormals(mesh, geometry::FindVertexNeighbours(mesh.triangles, mesh.positions.size()));
  const auto areas = geometry::CalcVertexAreas(mesh.positions, mesh.triangles);
  std::set<std::uint32_t> bed;
  for (const patient::Region& region : liver->regions) {
    if (region.role == roles::RegionRole::kGallbladderBed)
      bed.insert(region.vertices.begin(), region.vertices.end());
  }
  for (const patient::Region& region : liver->regions) {
    if (!roles::IsFixed(region.role)) continue;
    double all = 0, visceral = 0;
    std::size_t in_bed = 0;
    for (const auto v : region.vertices) {
      if (v >= areas.size()) continue;
      all += areas[v];
      visceral += Dot(normals[v], kTowardsDiaphragm) < 0 ? areas[v] : 0.0;
      in_bed += bed.contains(v) ? 1 : 0;
    }
    if (visceral > kVisceralShare * all) {
      Add("L-REGION-VISCERAL", liver->name + "/" + region.name,
          Rounded(100.0 * visceral / all) +
              " % of this fixed region lies on the visceral face, which must be free to move; draw it "
              "again");
    } else if (in_bed > 0) {
      Add("L-REGION-VISCERAL", liver->name + "/" + region.name,
          Count(in_bed, "vertex", "vertices") +
              " of this fixed region also belong to the gallbladder bed, which must be free to move; draw "
              "it "
              "again");
    }
  }
}

void Linter::LintAttachments() {
  struct Tally {
    std::size_t all = 0, outside = 0, far = 0;
    double longest = 0;
    math::Vec3 place;
  };
  std::vector<std::pair<std::string, Tally>> tallies;
  for (const patient::Attachment& a : patient_.attachments) {
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
    const math::Vec3& from = patient_.organs[a.organ_a].mesh.positions[a.vertex_a];
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

}  // namespace trocar::anatomy
