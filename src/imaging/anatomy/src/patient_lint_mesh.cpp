// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "patient_linter.h"
#include "trocar/files/patient_frame.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/math/elementary.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using base::ErrorCode;
using geometry::TriangleMesh;

constexpr double kMlPerCubicMetre = 1e6;
constexpr double kLiverSizeMin = 0.1, kLiverSizeMax = 0.4;  // longest side of the box [m]
constexpr double kVast = 1e5;                               // no coordinate is larger, whatever its unit [m]
constexpr double kMinAngleDeg = 5.0;                        // below it springs and normals turn useless

/// Volume of a liver: 1200 to 1500 mL, with two standard deviations (17 of 140 mm) of its span either way.
constexpr Range kLiverMl = {500.0, 2900.0};
/// From a scleroatrophic gallbladder (40 x 15 mm) to hydrops (150 x 50 mm), as ellipsoids.
constexpr Range kGallbladderMl = {4.5, 200.0};

double LongestSide(const TriangleMesh& mesh) {
  const geometry::Box box = geometry::CalcBox(mesh.positions);
  return std::max({box.max.x - box.min.x, box.max.y - box.min.y, box.max.z - box.min.z});
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
      const math::Vec3& here = mesh.positions[mesh.triangles[i][k]];
      const math::Vec3 a = mesh.positions[mesh.triangles[i][(k + 1) % 3]] - here;
      const math::Vec3 b = mesh.positions[mesh.triangles[i][(k + 2) % 3]] - here;
      smallest = std::min(smallest, math::Atan2(math::Norm(Cross(a, b)), Dot(a, b)) * 180.0 / M_PI);
    }
    slivers.count += smallest < kMinAngleDeg ? 1 : 0;
    if (smallest < slivers.angle_deg) slivers.angle_deg = smallest, slivers.worst = i;
  }
  return slivers;
}

}  // namespace

void Linter::LintMesh(std::size_t index) {
  const patient::Organ& organ = patient_.organs[index];
  MeshSummary summary{organ.name, organ.mesh.triangles.size(), false, false, 0, 0.0};
  const bool is_unread = index < mesh_errors_.size() && mesh_errors_[index].code != ErrorCode::kNone;
  const auto status = geometry::CheckMesh(organ.mesh);
  const auto vast =
      std::find_if(organ.mesh.positions.begin(), organ.mesh.positions.end(), [](const math::Vec3& p) {
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

void Linter::LintSurface(const patient::Organ& organ, MeshSummary& summary) {
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

/// Neighbours are scenery that is touched: their surfaces must be whole, and need not be fit for springs.
void Linter::LintNeighbour(std::size_t index) {
  const patient::Neighbour& neighbour = patient_.neighbours[index];
  const std::size_t error = patient_.organs.size() + index;
  if (error < mesh_errors_.size() && mesh_errors_[error].code != ErrorCode::kNone) {
    Add("L-MESH-UNREADABLE", neighbour.name, mesh_errors_[error].Text());
    return;
  }
  if (const auto status = geometry::CheckMesh(neighbour.mesh); !status.ok()) {
    Add("L-MESH-NUMBER", neighbour.name, status.error().message);
    return;
  }
  if (neighbour.mesh.triangles.empty()) {
    Add("L-MESH-EMPTY", neighbour.name, "the mesh has no triangle; build it again");
    return;
  }
  const auto mesh = geometry::InspectMesh(neighbour.mesh);
  if (!mesh.closed) {
    Add("L-MESH-OPEN", neighbour.name,
        Count(mesh.boundary_edges, "edge belongs", "edges belong") +
            " to one triangle only: the surface has a hole; close it");
  } else if (!mesh.outward) {
    Add("L-MESH-INSIDE-OUT", neighbour.name,
        "the triangles face inwards; turn each one round (flip the normals when exporting)");
  }
  if (!mesh.manifold) {
    Add("L-MESH-MANIFOLD", neighbour.name,
        Count(mesh.odd_edges, "edge", "edges") +
            " where not exactly two triangles meet side by side; repair "
            "the mesh");
  }
}

void Linter::LintUnit() {
  const patient::Organ* liver = FindUsable(roles::OrganRole::kLiver);
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
  Add("L-UNIT", liver->name,
      "the longest side of its box is " + Mm(size) + ", and a liver's is 100 to 400 mm" + guess);
}

void Linter::LintVolumes() {
  if (!is_unit_right_) return;
  for (std::size_t i = 0; i < patient_.organs.size(); ++i) {
    const MeshSummary& mesh = report_.meshes[i];
    const roles::OrganRole role = patient_.organs[i].role;
    const bool is_liver = role == roles::OrganRole::kLiver;
    if (!mesh.closed || (!is_liver && role != roles::OrganRole::kGallbladder)) continue;
    const Range& range = is_liver ? kLiverMl : kGallbladderMl;
    const double volume = std::fabs(mesh.volume_ml);
    if (volume >= range.min && volume <= range.max) continue;
    Add("L-VOLUME", mesh.name,
        "its volume is " + Rounded(volume) + " mL, plausible is " + Rounded(range.min) + " to " +
            Rounded(range.max) + " mL; check the contours and the distance between slices");
  }
}

}  // namespace trocar::anatomy
