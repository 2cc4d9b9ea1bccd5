// SPDX-License-Identifier: Apache-2.0
#include "trocar/scene/patient_vessels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "trocar/patient/patient.h"

namespace trocar::scene {

using math::Vec3;
namespace {

using roles::OrganRole;
using roles::TubeRole;
using surgery::FlowJunction;
using surgery::FlowVessel;
using surgery::Fluid;
using surgery::VesselMap;

constexpr double kShortestVessel = 1e-4;  // [m]

std::vector<double> CalcArcs(const std::vector<Vec3>& points) {
  std::vector<double> arcs{0.0};
  for (std::size_t i = 1; i < points.size(); ++i)
    arcs.push_back(arcs.back() + math::Distance(points[i - 1], points[i]));
  return arcs;
}

/// What nothing is known of must stay, as the common hepatic duct and the right hepatic artery must.
TubeRole RoleOf(const patient::Tube& tube) {
  const bool is_artery = tube.kind == patient::TubeKind::kArtery;
  const bool is_known = tube.role != TubeRole::kOther && roles::IsDuct(tube.role) != is_artery;
  if (is_known) return tube.role;
  return is_artery ? TubeRole::kRightHepaticArtery : TubeRole::kCommonHepaticDuct;
}

/// Builds junctions where tubes end and where others join them.
class VesselBuilder {
 public:
  VesselBuilder(const patient::Patient& patient, const VesselSupplies& supplies,
                const surgery::FluidTable& fluids)
      : patient_(patient), settings_(supplies), fluids_(fluids), cuts_(patient.tubes.size()) {}

  base::Result<PatientVessels> Build() {
    for (const patient::Tube& tube : patient_.tubes) arcs_.push_back(CalcArcs(tube.line.points));
    for (std::size_t t = 0; t < patient_.tubes.size(); ++t) {
      for (const bool is_first : {true, false}) Node(t, is_first ? 0 : arcs_[t].size() - 1);
    }
    for (std::size_t t = 0; t < patient_.tubes.size(); ++t) {
      for (const bool is_first : {true, false}) JoinEnd(t, is_first);
    }
    for (std::size_t t = 0; t < patient_.tubes.size(); ++t) {
      for (const bool is_first : {true, false}) SupplyEnd(t, is_first);
    }
    return Finish();
  }

 private:
  /// A place on a tube where vessels begin or end.
  struct Cut {
    std::size_t point;
    std::size_t group;  // of places that are one junction
  };

  std::size_t Node(std::size_t tube, std::size_t point) {
    for (const Cut& cut : cuts_[tube]) {
      if (cut.point == point) return cut.group;
    }
    groups_.push_back(groups_.size());
    cuts_[tube].push_back({point, groups_.size() - 1});
    return groups_.size() - 1;
  }
  std::size_t Root(std::size_t group) const {
    while (groups_[group] != group) group = groups_[group];
    return group;
  }
  /// Organs, then tubes; -1 where it leaves the scene.
  int EndPart(std::size_t t, bool is_first) const {
    return patient_.FindPart(is_first ? patient_.tubes[t].from : patient_.tubes[t].to);
  }
  std::size_t EndPoint(std::size_t t, bool is_first) const { return is_first ? 0 : arcs_[t].size() - 1; }

  void JoinEnd(std::size_t t, bool is_first) {
    const int part = EndPart(t, is_first);
    if (part < 0 || IsOrgan(part)) return;
    const std::size_t other = static_cast<std::size_t>(part) - patient_.organs.size();
    if (other == t) return;
    const Vec3& end = patient_.tubes[t].line.points[EndPoint(t, is_first)];
    const auto& points = patient_.tubes[other].line.points;
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < points.size(); ++k) {
      if (math::Distance(points[k], end) < math::Distance(points[nearest], end)) nearest = k;
    }
    const std::size_t a = Root(Node(other, nearest)), b = Root(Node(t, EndPoint(t, is_first)));
    groups_[std::max(a, b)] = std::min(a, b);
    joined_.push_back({t, is_first});
    // where the other tube's own end lies there too, it is no loose end either
    for (const bool others_first : {true, false}) {
      if (EndPoint(other, others_first) == nearest) joined_.push_back({other, others_first});
    }
  }

  void SupplyEnd(std::size_t t, bool is_first) {
    if (std::find(joined_.begin(), joined_.end(), std::pair{t, is_first}) != joined_.end()) return;
    const patient::Tube& tube = patient_.tubes[t];
    const int organ = EndPart(t, is_first);
    const OrganRole role = patient_.RoleOfOrgan(organ);
    FlowJunction supply;
    if (tube.kind == patient::TubeKind::kArtery) {
      supply = IsOrgan(organ) ? settings_.artery_bed : settings_.aorta;
    } else {
      supply = role == OrganRole::kLiver ? settings_.liver
               : roles::IsHollow(role)   ? settings_.hollow_organ
                                         : settings_.bowel;
    }
    supplies_.push_back({Root(Node(t, EndPoint(t, is_first))), supply, t, organ});
  }

  bool IsOrgan(int part) const {
    return part >= 0 && static_cast<std::size_t>(part) < patient_.organs.size();
  }

  base::Result<PatientVessels> Finish() {
    std::vector<std::uint32_t> number(groups_.size(), 0);
    std::vector<FlowJunction> junctions;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      if (Root(g) != g) continue;
      number[g] = static_cast<std::uint32_t>(junctions.size());
      junctions.emplace_back();
    }
    std::vector<FlowVessel> vessels;
    std::vector<std::vector<std::uint32_t>> of_tube(patient_.tubes.size());
    std::vector<std::vector<double>> starts(patient_.tubes.size());
    VesselAnatomy anatomy;
    for (std::size_t t = 0; t < patient_.tubes.size(); ++t) {
      const patient::Tube& tube = patient_.tubes[t];
      std::sort(cuts_[t].begin(), cuts_[t].end(),
                [](const Cut& a, const Cut& b) { return a.point < b.point; });
      for (std::size_t i = 0; i + 1 < cuts_[t].size(); ++i) {
        const Cut &from = cuts_[t][i], &to = cuts_[t][i + 1];
        double radius = 0;
        for (std::size_t k = from.point; k <= to.point; ++k) radius += tube.line.radii[k];
        radius *= settings_.lumen_share / static_cast<double>(to.point - from.point + 1);
        of_tube[t].push_back(static_cast<std::uint32_t>(vessels.size()));
        starts[t].push_back(arcs_[t][from.point]);
        vessels.push_back({tube.kind == patient::TubeKind::kArtery ? Fluid::kBlood : Fluid::kBile,
                           number[Root(from.group)], number[Root(to.group)],
                           std::max(kShortestVessel, arcs_[t][to.point] - arcs_[t][from.point]), radius});
        anatomy.roles.push_back(RoleOf(tube));
      }
    }
    std::vector<std::uint32_t> organ_ducts;
    for (const Supply& supply : supplies_) {
      const std::uint32_t j = number[Root(supply.group)];
      junctions[j] = supply.junction;
      const bool is_artery = patient_.tubes[supply.tube].kind == patient::TubeKind::kArtery;
      const OrganRole role = patient_.RoleOfOrgan(supply.organ);
      if (roles::IsHollow(role)) {
        anatomy.hollow_organ.push_back(j);
        if (!is_artery) organ_ducts.push_back(j);
      } else if (is_artery && role == OrganRole::kLiver) {
        anatomy.right_liver = j;
      } else if (is_artery) {
        if (!IsOrgan(supply.organ)) anatomy.aorta = j;
      } else if (role != OrganRole::kLiver) {
        anatomy.bowel = j;
      } else if (!anatomy.liver || RoleOf(patient_.tubes[supply.tube]) == TubeRole::kCommonHepaticDuct) {
        anatomy.liver = j;
      }
    }
    FindUpstream(vessels, anatomy);
    auto network = surgery::FlowNetwork::Make(std::move(vessels), std::move(junctions), fluids_);
    if (!network.ok()) return network.error();
    return PatientVessels{VesselMap{std::move(*network), std::move(arcs_), std::move(of_tube),
                                    std::move(starts), std::move(organ_ducts)},
                          std::move(anatomy)};
  }

  /// Which end of each vessel bile or blood comes from, and how far below the confluence it begins: by the shortest way from
  /// the liver's duct, or from the aorta.
  static void FindUpstream(const std::vector<FlowVessel>& vessels, VesselAnatomy& anatomy) {
    std::uint32_t junction_count = 0;
    for (const FlowVessel& vessel : vessels)
      junction_count = std::max({junction_count, vessel.from + 1, vessel.to + 1});
    std::vector<double> distance(junction_count, std::numeric_limits<double>::infinity());
    for (const auto& source : {anatomy.liver, anatomy.aorta}) {
      if (source && *source < junction_count) distance[*source] = 0.0;
    }
    for (std::uint32_t round = 0; round < junction_count; ++round) {
      for (const FlowVessel& vessel : vessels) {
        distance[vessel.to] = std::min(distance[vessel.to], distance[vessel.from] + vessel.length);
        distance[vessel.from] = std::min(distance[vessel.from], distance[vessel.to] + vessel.length);
      }
    }
    for (const FlowVessel& vessel : vessels) {
      const bool is_from = distance[vessel.from] <= distance[vessel.to];
      anatomy.is_upstream_from.push_back(is_from);
      const double upper = distance[is_from ? vessel.from : vessel.to];
      anatomy.below_source.push_back(std::isfinite(upper) ? upper : 0.0);
    }
  }

  struct Supply {
    std::size_t group;
    FlowJunction junction;
    std::size_t tube;
    int organ;  // that it comes from or goes to; none: beyond the scene
  };

  const patient::Patient& patient_;
  const VesselSupplies& settings_;
  const surgery::FluidTable& fluids_;
  std::vector<std::vector<double>> arcs_;
  std::vector<std::vector<Cut>> cuts_;
  std::vector<std::size_t> groups_;  // union-find over places
  std::vector<std::pair<std::size_t, bool>> joined_;
  std::vector<Supply> supplies_;
};

}  // namespace

base::Result<PatientVessels> MakePatientVessels(const patient::Patient& patient,
                                                const VesselSupplies& supplies,
                                                const surgery::FluidTable& fluids) {
  return VesselBuilder(patient, supplies, fluids).Build();
}

}  // namespace trocar::scene
