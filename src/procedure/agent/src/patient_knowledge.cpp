// SPDX-License-Identifier: Apache-2.0
#include "patient_knowledge.h"

#include <algorithm>
#include <limits>

#include "trocar/base/assert.h"
#include "trocar/cholecystectomy/injury.h"
#include "trocar/patient/patient.h"

namespace trocar::agent {

using math::Vec3;
using roles::LandmarkRole;
using roles::OrganRole;
using roles::TubeRole;
using scene::StrandInfo;
using scene::SurfaceInfo;

namespace {

/// Where the left hand holds the gallbladder: from the neck towards the fundus, and off the bed [m].
constexpr double kHoldBack = 0.020, kHoldBeside = 0.012;
constexpr double kNeckRadius = 0.015;  // what lies so near to the infundibulum turns with the neck [m]

/// Node of an organ that lies nearest to a point at rest.
std::uint32_t FindNode(const PatientKnowledge& known, std::int32_t organ, const Vec3& p) {
  const SurfaceInfo& surface = known.surfaces[static_cast<std::size_t>(organ)];
  std::uint32_t nearest = surface.first_node;
  for (std::uint32_t i = 0; i < surface.node_count; ++i) {
    const std::uint32_t node = surface.first_node + i;
    if (math::SquaredDistance(known.rest[node], p) < math::SquaredDistance(known.rest[nearest], p))
      nearest = node;
  }
  return nearest;
}

/// Lines of ducts and arteries, and what anatomy teaches of each.
void LearnTubes(const patient::Patient& patient, const simulation::ModelDescription& model,
                PatientKnowledge& known) {
  const auto role_of = [&](TubeRole role) {
    return static_cast<std::size_t>(std::max(0, patient.TubeOf(role)));
  };
  known.cystic_duct = role_of(TubeRole::kCysticDuct);
  known.cystic_artery = role_of(TubeRole::kCysticArtery);
  known.hepatic_duct = role_of(TubeRole::kCommonHepaticDuct);
  for (std::size_t t = 0; t < patient.tubes.size(); ++t) {
    const SurfaceInfo& surface = known.surfaces[known.first_tube + t];
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t k = 0; k < surface.node_count; ++k) nodes.push_back(surface.first_node + k);
    std::vector<double> radii = patient.tubes[t].line.radii;
    if (surface.ends[1] == known.gallbladder) {
      std::reverse(nodes.begin(), nodes.end());
      std::reverse(radii.begin(), radii.end());
    }
    known.tube_nodes.push_back(std::move(nodes));
    known.tube_radii.push_back(std::move(radii));
    known.is_artery.push_back(patient.tubes[t].kind == patient::TubeKind::kArtery ? 1 : 0);
  }
  for (std::size_t t = 0; t < model.tube_roles.size(); ++t) {
    const SurfaceInfo& surface = known.surfaces[known.first_tube + t];
    if (surface.Joins(known.gallbladder)) known.entering.push_back(t);
    for (std::uint32_t k = 0; k < surface.node_count; ++k) {
      const cholecystectomy::VesselRole role = model.tube_roles[t][k];
      const bool must_stay = !cholecystectomy::MayBeDivided(role);
      const bool is_duct = patient.tubes[t].kind == patient::TubeKind::kDuct;
      if (must_stay) known.main_nodes.push_back(surface.first_node + k);
      if (must_stay && is_duct) known.main_ducts.push_back(surface.first_node + k);
      if ((must_stay && !is_duct) || role == cholecystectomy::VesselRole::kSubvesicalDuct)
        known.careful_nodes.push_back(surface.first_node + k);
    }
  }
  for (std::uint32_t i = 0; i < known.strands.size(); ++i) {
    const bool enters = std::any_of(known.entering.begin(), known.entering.end(), [&](std::size_t tube) {
      return known.strands[i].a == known.tube_nodes[tube].front();
    });
    if (known.strands[i].kind == StrandInfo::Kind::kEnd && enters) known.end_strands.push_back(i);
  }
}

}  // namespace

PatientKnowledge LearnPatient(const scene::Scene& scene, const simulation::ModelDescription& model,
                              const cholecystectomy::TriangleDescription& triangle) {
  const patient::Patient& patient = scene.patient;
  PatientKnowledge known;
  known.strands = model.strands;
  known.surfaces = model.surfaces;
  known.rest = model.rest;
  known.window_strands = triangle.window_strands;
  known.exposable = triangle.exposable;
  known.first_tube = patient.organs.size();
  known.gallbladder = scene::FindSurface(known.surfaces, OrganRole::kGallbladder);
  known.liver = scene::FindSurface(known.surfaces, OrganRole::kLiver);
  TROCAR_ASSERT(known.gallbladder >= 0 && known.liver >= 0);
  LearnTubes(patient, model, known);
  const Vec3 neck = patient.LandmarkOf(LandmarkRole::kInfundibulum)->position,
             fundus = patient.LandmarkOf(LandmarkRole::kFundus)->position,
             edge = patient.LandmarkOf(LandmarkRole::kLiverEdge)->position;
  known.neck = FindNode(known, known.gallbladder, neck);
  known.fundus = FindNode(known, known.gallbladder, fundus);
  known.liver_node = FindNode(known, known.liver, edge);
  for (const StrandInfo& strand : known.strands) {
    if (strand.kind == StrandInfo::Kind::kBed)
      known.bed_normal += known.rest[strand.a] - known.rest[strand.b];
  }
  known.bed_normal = math::Normalized(known.bed_normal, {0, -1, 0});
  // beside the neck, so that both tools have clearance
  const Vec3 axis = math::Normalized(fundus - neck);
  known.hold = FindNode(known, known.gallbladder, neck + kHoldBack * axis + kHoldBeside * known.bed_normal);
  const SurfaceInfo& surface = known.surfaces[static_cast<std::size_t>(known.gallbladder)];
  for (std::uint32_t node = surface.first_node; node < surface.first_node + surface.node_count; ++node) {
    if (math::Distance(known.rest[node], neck) <= kNeckRadius) known.neck_nodes.push_back(node);
  }
  return known;
}

Vec3 PatientKnowledge::BedAxis() const {
  return math::Normalized(rest[fundus] - rest[neck]);
}

Vec3 PatientKnowledge::BedBack() const {
  const Vec3 axis = BedAxis();
  return math::Normalized(axis - math::Dot(axis, bed_normal) * bed_normal);
}

double PatientKnowledge::AlongBed(std::uint32_t node) const {
  return math::Dot(rest[node] - rest[neck], BedAxis());
}

bool PatientKnowledge::MayHold(const HoldFilter& may, std::uint32_t node) const {
  return may.Allows(AlongBed(node), AlongBed(fundus));
}

std::vector<std::uint32_t> PatientKnowledge::BedStrands(double share) const {
  using Kind = StrandInfo::Kind;
  const Vec3 axis = BedAxis();
  const auto along = [&](std::uint32_t i) { return math::Dot(rest[strands[i].a] - rest[neck], axis); };
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (std::uint32_t i = 0; i < strands.size(); ++i) {
    if (strands[i].kind == Kind::kBed) first = std::min(first, along(i)), last = std::max(last, along(i));
  }
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < strands.size(); ++i) {
    const bool is_bed = strands[i].kind == Kind::kBed || strands[i].kind == Kind::kAdhesion;
    if (is_bed && along(i) <= first + share * (last - first)) found.push_back(i);
  }
  return found;
}

std::vector<double> PatientKnowledge::BedOrder(const std::vector<std::uint32_t>& bed,
                                               bool is_from_fundus) const {
  const Vec3 axis = BedAxis();
  std::vector<double> order;
  for (const std::uint32_t i : bed) {
    const double along = 0.5 * math::Dot(rest[strands[i].a] - rest[neck], axis);
    order.push_back(is_from_fundus ? -along : along);
  }
  return order;
}

Vec3 PatientKnowledge::DuctAtRest() const {
  const auto& duct = tube_nodes[cystic_duct];
  return rest[duct.front()] - rest[duct.back()];
}

}  // namespace trocar::agent
