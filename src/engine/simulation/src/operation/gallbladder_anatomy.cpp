// SPDX-License-Identifier: Apache-2.0
#include "operation/gallbladder_anatomy.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <variant>

#include "trocar/base/assert.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/patient/patient.h"
#include "trocar/scene/triangle_fat.h"
#include "trocar/simulation/ground.h"

namespace trocar::simulation {

using math::Vec3;
using roles::LandmarkRole;
using roles::OrganRole;
using roles::TubeRole;
using scene::FindSurface;
using scene::Scene;
using scene::StrandInfo;
using scene::SurfaceInfo;
namespace {

/// About a strand [m]: the inner half of its lobule (scene::kLobuleRadius), which hides what lies behind it.
constexpr double kCountedRadius = 0.001;
/// What lies this near to the infundibulum turns with the neck [m].
constexpr double kNeckRadius = 0.015;
/// Where a tube is seen to enter the gallbladder: in the middle of what has to be bare of it [m].
constexpr double kEntryArc = 0.5 * cholecystectomy::CriticalViewSettings{}.skeletonised;
constexpr std::uint64_t kStoneSeed = 0x73746f6e6573;  // the stones' own stream

/// A tube's nodes, from the gallbladder on where it ends there.
std::vector<std::uint32_t> ListNodes(const SurfaceInfo& surface, std::int32_t gallbladder) {
  std::vector<std::uint32_t> nodes;
  for (std::uint32_t k = 0; k < surface.node_count; ++k) nodes.push_back(surface.first_node + k);
  if (gallbladder >= 0 && surface.ends[1] == gallbladder) std::reverse(nodes.begin(), nodes.end());
  return nodes;
}

/// Strands of fat, peritoneum and adhesions at each node.
geometry::Rows ListFibres(std::span<const StrandInfo> strands, std::size_t node_count) {
  using Kind = StrandInfo::Kind;
  std::vector<std::vector<std::uint32_t>> at(node_count);
  for (std::uint32_t i = 0; i < strands.size(); ++i) {
    const Kind kind = strands[i].kind;
    if (kind != Kind::kTriangle && kind != Kind::kPeritoneum && kind != Kind::kAdhesion) continue;
    at[strands[i].a].push_back(i);
    at[strands[i].b].push_back(i);
  }
  geometry::Rows rows{{0}, {}};
  for (const auto& list : at) {
    rows.values.insert(rows.values.end(), list.begin(), list.end());
    rows.starts.push_back(static_cast<std::uint32_t>(rows.values.size()));
  }
  return rows;
}

/// Nodes of the cystic and the common hepatic duct, from where they meet on.
void FindDucts(std::span<const SurfaceInfo> surfaces, std::span<const Vec3> rest,
               std::vector<std::uint32_t>& cystic, std::vector<std::uint32_t>& hepatic) {
  const std::int32_t gallbladder = FindSurface(surfaces, OrganRole::kGallbladder);
  const auto list = [&](TubeRole role) {
    const std::int32_t tube = FindSurface(surfaces, role);
    return tube < 0 ? std::vector<std::uint32_t>{}
                    : ListNodes(surfaces[static_cast<std::size_t>(tube)], gallbladder);
  };
  cystic = list(TubeRole::kCysticDuct), hepatic = list(TubeRole::kCommonHepaticDuct);
  std::reverse(cystic.begin(), cystic.end());
  if (!hepatic.empty() && !cystic.empty() &&
      math::Distance(rest[hepatic.back()], rest[cystic.front()]) <
          math::Distance(rest[hepatic.front()], rest[cystic.front()]))
    std::reverse(hepatic.begin(), hepatic.end());
}

/// At kEntryArc along a tube at rest, or its far end.
cholecystectomy::TubeEntry EntryOf(const surgery::EnteringTube& tube, std::span<const Vec3> rest) {
  double left = kEntryArc;
  for (std::size_t k = 1; k < tube.nodes.size(); ++k) {
    const double length = math::Distance(rest[tube.nodes[k - 1]], rest[tube.nodes[k]]);
    if (left <= length) return {tube.tube, {tube.nodes[k - 1], tube.nodes[k]}, left / length};
    left -= length;
  }
  return {tube.tube, {tube.nodes.back(), tube.nodes.back()}, 0.0};
}

double NumberOf(const patient::Patient& patient, std::string_view name, double otherwise) {
  const patient::Parameter* parameter = patient.FindParameter(name);
  const double* number = parameter == nullptr ? nullptr : std::get_if<double>(&parameter->value);
  return number == nullptr ? otherwise : *number;
}

}  // namespace

cholecystectomy::TargetTable MakeTargetTable(std::span<const scene::SurfaceInfo> surfaces,
                                             std::span<const scene::StrandInfo> strands) {
  cholecystectomy::TargetTable table;
  for (const scene::SurfaceInfo& surface : surfaces)
    table.surfaces.push_back(
        cholecystectomy::TargetOf(surface.organ).value_or(cholecystectomy::TargetOf(surface.tube)));
  for (const scene::StrandInfo& strand : strands)
    table.strands.push_back(cholecystectomy::TargetOf(strand.kind));
  return table;
}

surgery::Vessels MakeVessels(surgery::VesselMap map, const patient::Patient& patient,
                             const scene::PatientTissue& tissue, std::uint32_t spare_count,
                             const surgery::VesselSettings& settings) {
  std::vector<surgery::VesselTube> tubes;
  for (std::size_t t = 0; t < patient.tubes.size(); ++t) {
    const geometry::CentreLine& line = patient.tubes[t].line;
    tubes.push_back({tissue.surfaces[patient.organs.size() + t].first_node, line.points, line.radii});
  }
  return {std::move(map), tubes, tissue.first_spare.back(), spare_count, settings};
}

std::vector<surgery::EnteringTube> FindEnteringTubes(const patient::Patient& patient,
                                                     std::span<const SurfaceInfo> surfaces,
                                                     std::span<const StrandInfo> strands) {
  std::vector<surgery::EnteringTube> found;
  const std::int32_t gallbladder = FindSurface(surfaces, OrganRole::kGallbladder);
  if (gallbladder < 0) return found;
  const SurfaceInfo& organ = surfaces[static_cast<std::size_t>(gallbladder)];
  for (std::uint32_t t = 0; t < patient.tubes.size(); ++t) {
    const SurfaceInfo& tube = surfaces[patient.organs.size() + t];
    // one that only grazes the bed, Luschka's duct, is divided with the bed
    if (!tube.Joins(gallbladder)) continue;
    surgery::EnteringTube entering{t, ListNodes(tube, gallbladder), {}};
    for (std::uint32_t i = 0; i < strands.size(); ++i) {
      const StrandInfo& strand = strands[i];
      if (strand.kind == StrandInfo::Kind::kEnd && strand.a == entering.nodes.front() &&
          strand.b >= organ.first_node && strand.b < organ.first_node + organ.node_count)
        entering.end_strands.push_back(i);
    }
    found.push_back(std::move(entering));
  }
  return found;
}

surgery::GallbladderAttachment MakeAttachment(const patient::Patient& patient,
                                              std::span<const SurfaceInfo> surfaces,
                                              std::span<const StrandInfo> strands) {
  using Kind = StrandInfo::Kind;
  const bool has_axis = patient.LandmarkOf(LandmarkRole::kFundus) != nullptr &&
                        patient.LandmarkOf(LandmarkRole::kInfundibulum) != nullptr;
  std::vector<std::uint32_t> holding;
  for (std::uint32_t i = 0; i < strands.size(); ++i) {
    if (strands[i].kind == Kind::kAdhesion || (strands[i].kind == Kind::kBed && has_axis))
      holding.push_back(i);
  }
  return {std::move(holding), FindEnteringTubes(patient, surfaces, strands)};
}

cholecystectomy::DissectedAnatomy MakeDissectedAnatomy(const patient::Patient& patient,
                                                       std::span<const SurfaceInfo> surfaces,
                                                       std::span<const StrandInfo> strands,
                                                       std::span<const Vec3> rest) {
  using Kind = StrandInfo::Kind;
  cholecystectomy::DissectedAnatomy found;
  const patient::Landmark *fundus = patient.LandmarkOf(LandmarkRole::kFundus),
                          *neck = patient.LandmarkOf(LandmarkRole::kInfundibulum);
  for (std::uint32_t i = 0; i < strands.size(); ++i) {
    const Kind kind = strands[i].kind;
    if (kind != Kind::kBed || fundus == nullptr || neck == nullptr) continue;
    const Vec3 axis = fundus->position - neck->position;
    found.bed.push_back(
        {i, math::Dot(rest[strands[i].a] - neck->position, axis) / std::max(1e-12, math::SquaredNorm(axis))});
  }
  found.fibres = ListFibres(strands, rest.size());
  const std::int32_t gallbladder = FindSurface(surfaces, OrganRole::kGallbladder);
  if (gallbladder < 0) return found;
  found.entering = FindEnteringTubes(patient, surfaces, strands);
  std::vector<std::uint32_t> hepatic_duct;
  FindDucts(surfaces, rest, found.cystic_duct, hepatic_duct);
  const SurfaceInfo& organ = surfaces[static_cast<std::size_t>(gallbladder)];
  for (std::uint32_t k = 0; neck != nullptr && k < organ.node_count; ++k) {
    if (math::Distance(rest[organ.first_node + k], neck->position) <= kNeckRadius)
      found.neck.push_back(organ.first_node + k);
  }
  return found;
}

cholecystectomy::TriangleWindow MakeTriangleWindow(std::span<const SurfaceInfo> surfaces,
                                                   std::span<const StrandInfo> strands,
                                                   std::span<const Vec3> rest,
                                                   std::span<const std::uint32_t> main_ducts,
                                                   std::span<const std::uint32_t> main_arteries,
                                                   const cholecystectomy::JudgementSettings& settings) {
  using Kind = StrandInfo::Kind;
  std::vector<std::uint32_t> cystic, hepatic;
  FindDucts(surfaces, rest, cystic, hepatic);
  cholecystectomy::TriangleBorders borders;
  for (const std::uint32_t node : cystic) borders.cystic_duct.push_back(rest[node]);
  for (const std::uint32_t node : hepatic) borders.hepatic_duct.push_back(rest[node]);
  for (const std::uint32_t node : main_ducts) borders.main_ducts.push_back(rest[node]);
  for (const std::uint32_t node : main_arteries) borders.main_arteries.push_back(rest[node]);
  std::vector<cholecystectomy::TriangleFat> fat;
  for (std::uint32_t i = 0; i < strands.size(); ++i) {
    if (strands[i].kind != Kind::kTriangle && strands[i].kind != Kind::kPeritoneum) continue;
    fat.push_back({i, {rest[strands[i].a], rest[strands[i].b]}});
  }
  return {borders, fat, {settings.kept_fat, settings.kept_sheath, kCountedRadius}};
}

cholecystectomy::TriangleSight MakeTriangleSight(const patient::Patient& patient,
                                                 std::span<const SurfaceInfo> surfaces,
                                                 std::span<const StrandInfo> strands,
                                                 std::span<const Vec3> rest,
                                                 std::span<const double> exposable,
                                                 const cholecystectomy::JudgementSettings& settings) {
  std::vector<std::uint32_t> cystic, hepatic;
  FindDucts(surfaces, rest, cystic, hepatic);
  const std::vector<surgery::EnteringTube> entering = FindEnteringTubes(patient, surfaces, strands);
  TROCAR_ASSERT(exposable.size() == entering.size());
  std::vector<cholecystectomy::TubeEntry> entries;
  double kept = 0;  // share of the cystic duct
  for (std::size_t i = 0; i < entering.size(); ++i) {
    entries.push_back(EntryOf(entering[i], rest));
    if (cystic.empty() || entering[i].nodes.front() != cystic.back()) continue;
    double length = 0;
    for (std::size_t k = 1; k < cystic.size(); ++k)
      length += math::Distance(rest[cystic[k - 1]], rest[cystic[k]]);
    kept = std::clamp(1.0 - exposable[i] / length, 0.0, 1.0);
  }
  return {
      std::move(cystic), std::move(hepatic), kept, std::move(entries), scene::MakeTriangleFat(strands, rest),
      settings.kept_fat};
}

std::vector<double> CalcExposable(std::span<const surgery::EnteringTube> entering, std::span<const Vec3> rest,
                                  std::span<const std::uint32_t> main_ducts,
                                  std::span<const std::uint32_t> main_arteries,
                                  const cholecystectomy::JudgementSettings& settings) {
  const auto is_near = [&](std::uint32_t node, std::span<const std::uint32_t> main, double kept) {
    return std::any_of(main.begin(), main.end(), [&](std::uint32_t other) {
      return math::Distance(rest[node], rest[other]) < kept + kCountedRadius;
    });
  };
  std::vector<double> exposable;
  for (const surgery::EnteringTube& tube : entering) {
    double arc = 0, last = 0;
    for (std::size_t k = 1; k < tube.nodes.size() && !is_near(tube.nodes[k], main_ducts, settings.kept_fat) &&
                            !is_near(tube.nodes[k], main_arteries, settings.kept_sheath);
         ++k) {
      last = math::Distance(rest[tube.nodes[k - 1]], rest[tube.nodes[k]]);
      arc += last;
    }
    // what covers the next node reaches half the way to this one; and a tube may be drawn together
    exposable.push_back(std::max(arc - 0.5 * last, kLeastExposable));
  }
  return exposable;
}

surgery::GallstoneSettings FindGallstones(const Scene& scene) {
  surgery::GallstoneSettings stones =
      scene.operation ? scene.operation->gallstones : surgery::GallstoneSettings{};
  stones.count =
      std::clamp(static_cast<int>(std::lround(NumberOf(scene.patient, "gallstone_count", stones.count))), 0,
                 surgery::kMostGallstones);
  stones.median_diameter =
      1e-3 *
      std::clamp(NumberOf(scene.patient, "gallstone_diameter", 1e3 * stones.median_diameter), 1.0, 30.0);
  return stones;
}

base::Result<surgery::GallstoneSpill> MakeGallstones(const Scene& scene,
                                                     std::span<const SurfaceInfo> surfaces,
                                                     std::span<const Vec3> rest) {
  const std::int32_t gallbladder = FindSurface(surfaces, OrganRole::kGallbladder);
  if (gallbladder < 0) return surgery::GallstoneSpill{};
  const geometry::TriangleMesh& wall = scene.patient.organs[static_cast<std::size_t>(gallbladder)].mesh;
  const double capacity = geometry::CalcVolume(wall.positions, wall.triangles);
  const std::vector<double> diameters =
      surgery::DrawGallstones(FindGallstones(scene), capacity, scene.seed ^ kStoneSeed);
  return surgery::GallstoneSpill::Make(diameters, geometry::MakeOmentum(FindOmentumBalls(surfaces, rest)),
                                       scene.operation->parameters.stones);
}

}  // namespace trocar::simulation
