// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <set>
#include <string>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/math/rotation_angle.h"
#include "trocar/patient/patient.h"

namespace trocar::patient {
namespace {

using base::Error;
using base::ErrorCode;

/// Diagonal of an organ's box [m]: a person's largest and smallest.
constexpr double kLargestOrgan = 1.0, kSmallestOrgan = 0.002;

/// From the origin [m]: the frame's origin lies in the body, or where a scanner's table is.
constexpr double kFarthest = 6.0;
constexpr double kMostTableTilt = 30 * math::kDegree;

Error Invalid(const std::string& what) {
  return {ErrorCode::kPatientInvalid, "the patient is inconsistent: " + what + "; build it again"};
}

/// Refuses an organ of a size or at a place that none has: mostly a file in metres or micrometres instead of millimetres.
base::Status CheckSize(const Organ& organ) {
  if (organ.mesh.positions.empty()) return {};  // has no surface, which is said elsewhere
  math::Vec3 low = organ.mesh.positions.front(), high = low;
  for (const math::Vec3& p : organ.mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  }
  const double size = math::Norm(high - low), reach = std::max(math::Norm(low), math::Norm(high));
  if (size >= kSmallestOrgan && size <= kLargestOrgan && reach <= kFarthest) return {};
  char text[240];
  std::snprintf(
      text, sizeof text,
      "%.60s is %.3g mm large and lies up to %.3g mm from the origin; an organ is 2 to 1000 mm; check the "
      "unit of its mesh, which is millimetres",
      organ.name.c_str(), 1e3 * size, 1e3 * reach);
  return Error{ErrorCode::kPatientInvalid, text};
}

/// Refuses a role that two of the things have.
template <class Thing>
base::Status CheckRoles(const std::vector<Thing>& things, const std::string& what) {
  const Thing* second = FindSecondOfRole(things);
  if (second == nullptr) return {};
  return Invalid("two " + what + " have the role " + roles::SpokenName(second->role) + ", '" + second->name +
                 "' is one of them");
}

/// Of what lies beside the operated organs. \param names  of the organs; those of the neighbours are added
base::Status CheckSurroundings(const Patient& patient, std::set<std::string>& names) {
  if (const Neighbour* second = FindSecondOfRole(patient.neighbours); second != nullptr) {
    return Invalid("two neighbours have the role " + roles::SpokenName(second->role) + ", '" + second->name +
                   "' is one of them");
  }
  for (const Neighbour& one : patient.neighbours) {
    if (!IsPlainName(one.name))
      return Invalid("neighbour's name '" + one.name + "' must consist of a-z, 0-9 and _");
    if (!names.insert(one.name).second) return Invalid("the name '" + one.name + "' is used twice");
    if (const auto status = geometry::CheckMesh(one.mesh); !status.ok())
      return Invalid(one.name + ": " + status.error().message);
    const auto report = geometry::InspectMesh(one.mesh);
    if (!report.closed || !report.manifold || !report.outward) {
      return Error{ErrorCode::kMeshNotClosed,
                   "the mesh of " + one.name + " is not closed, manifold and outward; repair it"};
    }
  }
  bool is_used[kPortUseCount] = {};
  for (const Port& port : patient.ports) {
    bool& is_there = is_used[static_cast<std::size_t>(port.use)];
    if (is_there) return Invalid(std::string("there are two ports for ") + NameOf(port.use));
    is_there = true;
    if (!math::IsFinite(port.position))
      return Invalid(std::string("the port for ") + NameOf(port.use) + " is nowhere");
  }
  if (patient.table) {
    for (const double tilt : {patient.table->head_up, patient.table->right_up}) {
      if (!(std::fabs(tilt) <= kMostTableTilt * (1 + 1e-9)))
        return Invalid("the table tilts by more than 30 degrees");
    }
  }
  return {};
}

}  // namespace

base::Status CheckPatient(const Patient& patient) {
  if (patient.organs.empty()) return Invalid("it has no organ");
  if (base::Status good = CheckRoles(patient.organs, "organs"); !good) return good;
  if (base::Status good = CheckRoles(patient.landmarks, "landmarks"); !good) return good;
  std::set<std::string> names;
  for (const Organ& organ : patient.organs) {
    if (!IsPlainName(organ.name))
      return Invalid("organ name '" + organ.name + "' must consist of a-z, 0-9 and _");
    if (!names.insert(organ.name).second) return Invalid("the name '" + organ.name + "' is used twice");
    if (const auto status = geometry::CheckMesh(organ.mesh); !status.ok())
      return Invalid(organ.name + ": " + status.error().message);
    if (base::Status good = CheckSize(organ); !good) return good;
    const auto report = geometry::InspectMesh(organ.mesh);
    if (!report.closed || !report.manifold) {
      return Error{ErrorCode::kMeshNotClosed, "the mesh of " + organ.name + " is not closed and manifold (" +
                                                  std::to_string(report.boundary_edges) + " open edges, " +
                                                  std::to_string(report.odd_edges) + " odd edges, " +
                                                  std::to_string(report.odd_vertices) + " odd vertices, " +
                                                  std::to_string(report.degenerate) +
                                                  " flat triangles); repair it"};
    }
    if (!report.outward) return Invalid("the triangles of " + organ.name + " face inwards");
    if (base::Status good = CheckRoles(organ.regions, "regions of " + organ.name); !good) return good;
    std::set<std::string> regions;
    for (const Region& region : organ.regions) {
      if (!regions.insert(region.name).second)
        return Invalid("region '" + region.name + "' of " + organ.name + " is there twice");
      for (std::size_t i = 0; i < region.vertices.size(); ++i) {
        if (region.vertices[i] >= organ.mesh.positions.size()) {
          return Invalid("region '" + region.name + "' of " + organ.name +
                         " names a vertex that is not there");
        }
        if (i > 0 && region.vertices[i] <= region.vertices[i - 1]) {
          return Invalid("the vertices of region '" + region.name + "' of " + organ.name + " do not ascend");
        }
      }
    }
  }
  if (base::Status good = CheckSurroundings(patient, names); !good) return good;
  for (const Attachment& a : patient.attachments) {
    const bool in_range = a.organ_a < patient.organs.size() && a.organ_b < patient.organs.size() &&
                          a.vertex_a < patient.organs[a.organ_a].mesh.positions.size() &&
                          a.vertex_b < patient.organs[a.organ_b].mesh.positions.size();
    if (!in_range)
      return Invalid("an attachment '" + a.name + "' names an organ or vertex that is not there");
  }
  for (const Tube& tube : patient.tubes) {
    if (!names.insert(tube.name).second) return Invalid("the name '" + tube.name + "' is used twice");
  }
  for (const Tube& tube : patient.tubes) {
    if (tube.line.points.size() < 2 || tube.line.points.size() != tube.line.radii.size()) {
      return Invalid("tube '" + tube.name + "' needs two points or more, and a radius for each");
    }
    for (std::size_t i = 0; i < tube.line.points.size(); ++i) {
      const double radius = tube.line.radii[i];
      if (!math::IsFinite(tube.line.points[i]) || !(radius > 0.0) || !std::isfinite(radius)) {
        return Invalid("tube '" + tube.name +
                       "' has a point that is not finite or a radius that is not positive");
      }
    }
    for (const std::string& end : {tube.from, tube.to}) {
      if (!end.empty() && !names.contains(end)) {
        return Invalid("tube '" + tube.name + "' leads to '" + end + "', which is neither organ nor tube");
      }
    }
  }
  std::set<std::string> landmarks;
  for (const Landmark& landmark : patient.landmarks) {
    if (!landmarks.insert(landmark.name).second)
      return Invalid("landmark '" + landmark.name + "' is there twice");
    if (!math::IsFinite(landmark.position)) return Invalid("landmark '" + landmark.name + "' is not finite");
  }
  std::set<std::string> parameters;
  for (const Parameter& parameter : patient.parameters) {
    if (parameter.name.empty() || !parameters.insert(parameter.name).second)
      return Invalid("parameter '" + parameter.name + "' has no name or is there twice");
    const double* number = std::get_if<double>(&parameter.value);
    if (number != nullptr && !std::isfinite(*number))
      return Invalid("parameter '" + parameter.name + "' is not finite");
  }
  return {};
}

}  // namespace trocar::patient
