// SPDX-License-Identifier: Apache-2.0
#include "patient_anatomy.h"

#include <algorithm>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/cholecystectomy/injury.h"
#include "trocar/scene/entering_tubes.h"
#include "trocar/scene/triangle_fat.h"

namespace trocar::cholecystectomy {

using math::Vec3;
using roles::LandmarkRole;
using roles::OrganRole;
using roles::TubeRole;
using scene::FindSurface;
using scene::StrandInfo;
using scene::SurfaceInfo;
namespace {

/// About a strand [m]: the inner half of its lobule (scene::kLobuleRadius), which hides what lies behind it.
constexpr double kCountedRadius = 0.001;
/// What lies this near to the infundibulum turns with the neck [m].
constexpr double kNeckRadius = 0.015;
/// Where a tube is seen to enter the gallbladder: in the middle of what has to be bare of it [m].
constexpr double kEntryArc = 0.5 * CriticalViewSettings{}.skeletonised;

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
                    : scene::ListNodesFrom(surfaces[static_cast<std::size_t>(tube)], gallbladder);
  };
  cystic = list(TubeRole::kCysticDuct), hepatic = list(TubeRole::kCommonHepaticDuct);
  std::reverse(cystic.begin(), cystic.end());
  if (!hepatic.empty() && !cystic.empty() &&
      math::Distance(rest[hepatic.back()], rest[cystic.front()]) <
          math::Distance(rest[hepatic.front()], rest[cystic.front()]))
    std::reverse(hepatic.begin(), hepatic.end());
}

/// At kEntryArc along a tube at rest, or its far end.
TubeEntry EntryOf(const surgery::EnteringTube& tube, std::span<const Vec3> rest) {
  double left = kEntryArc;
  for (std::size_t k = 1; k < tube.nodes.size(); ++k) {
    const double length = math::Distance(rest[tube.nodes[k - 1]], rest[tube.nodes[k]]);
    if (left <= length) return {tube.tube, {tube.nodes[k - 1], tube.nodes[k]}, left / length};
    left -= length;
  }
  return {tube.tube, {tube.nodes.back(), tube.nodes.back()}, 0.0};
}

}  // namespace

MainNodes FindMainNodes(const patient::Patient& patient, std::span<const SurfaceInfo> surfaces,
                        const surgery::VesselMap& map, std::span<const TubeRole> roles) {
  MainNodes main;
  for (std::size_t t = 0; t < patient.tubes.size(); ++t) {
    const SurfaceInfo& surface = surfaces[patient.organs.size() + t];
    const bool is_duct = patient.tubes[t].kind == patient::TubeKind::kDuct;
    for (std::uint32_t k = 0; k < surface.node_count; ++k) {
      if (MayBeDivided(roles[map.Find(t, map.arcs[t][k]).vessel])) continue;
      (is_duct ? main.ducts : main.arteries).push_back(surface.first_node + k);
    }
  }
  return main;
}

TargetTable MakeTargetTable(std::span<const scene::SurfaceInfo> surfaces,
                            std::span<const scene::StrandInfo> strands) {
  TargetTable table;
  for (const scene::SurfaceInfo& surface : surfaces)
    table.surfaces.push_back(TargetOf(surface.organ).value_or(TargetOf(surface.tube)));
  for (const scene::StrandInfo& strand : strands) table.strands.push_back(TargetOf(strand.kind));
  return table;
}

TriangleWindow MakeTriangleWindow(const PatientRows& rows, const MainNodes& main,
                                  const surgery::JudgementSettings& settings) {
  const auto& [surfaces, strands, rest] = rows;
  using Kind = StrandInfo::Kind;
  std::vector<std::uint32_t> cystic, hepatic;
  FindDucts(surfaces, rest, cystic, hepatic);
  TriangleBorders borders;
  for (const std::uint32_t node : cystic) borders.cystic_duct.push_back(rest[node]);
  for (const std::uint32_t node : hepatic) borders.hepatic_duct.push_back(rest[node]);
  for (const std::uint32_t node : main.ducts) borders.main_ducts.push_back(rest[node]);
  for (const std::uint32_t node : main.arteries) borders.main_arteries.push_back(rest[node]);
  std::vector<TriangleFat> fat;
  for (std::uint32_t i = 0; i < strands.size(); ++i) {
    if (strands[i].kind != Kind::kTriangle && strands[i].kind != Kind::kPeritoneum) continue;
    fat.push_back({i, {rest[strands[i].a], rest[strands[i].b]}});
  }
  return {borders, fat, {settings.kept_fat, settings.kept_sheath, kCountedRadius}};
}

TriangleSight MakeTriangleSight(const PatientRows& rows, std::span<const surgery::EnteringTube> entering,
                                std::span<const double> exposable,
                                const surgery::JudgementSettings& settings) {
  const auto& [surfaces, strands, rest] = rows;
  std::vector<std::uint32_t> cystic, hepatic;
  FindDucts(surfaces, rest, cystic, hepatic);
  TROCAR_ASSERT(exposable.size() == entering.size());
  std::vector<TubeEntry> entries;
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
                                  const MainNodes& main, const surgery::JudgementSettings& settings) {
  const auto is_near = [&](std::uint32_t node, std::span<const std::uint32_t> nodes, double kept) {
    return std::any_of(nodes.begin(), nodes.end(), [&](std::uint32_t other) {
      return math::Distance(rest[node], rest[other]) < kept + kCountedRadius;
    });
  };
  std::vector<double> exposable;
  for (const surgery::EnteringTube& tube : entering) {
    double arc = 0, last = 0;
    for (std::size_t k = 1; k < tube.nodes.size() && !is_near(tube.nodes[k], main.ducts, settings.kept_fat) &&
                            !is_near(tube.nodes[k], main.arteries, settings.kept_sheath);
         ++k) {
      last = math::Distance(rest[tube.nodes[k - 1]], rest[tube.nodes[k]]);
      arc += last;
    }
    // what covers the next node reaches half the way to this one; and a tube may be drawn together
    exposable.push_back(std::max(arc - 0.5 * last, kLeastExposable));
  }
  return exposable;
}

DissectedAnatomy MakeDissectedAnatomy(const patient::Patient& patient, const PatientRows& rows,
                                      const MainNodes& main, const surgery::JudgementSettings& settings) {
  const auto& [surfaces, strands, rest] = rows;
  using Kind = StrandInfo::Kind;
  DissectedAnatomy found;
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
  found.triangle = MakeTriangleWindow(rows, main, settings);
  const std::int32_t gallbladder = FindSurface(surfaces, OrganRole::kGallbladder);
  found.entering = scene::FindEnteringTubes(surfaces, strands, gallbladder);
  found.exposable = CalcExposable(found.entering, rest, main, settings);
  found.sight = MakeTriangleSight(rows, found.entering, found.exposable, settings);
  if (gallbladder < 0) return found;
  std::vector<std::uint32_t> hepatic_duct;
  FindDucts(surfaces, rest, found.cystic_duct, hepatic_duct);
  const SurfaceInfo& organ = surfaces[static_cast<std::size_t>(gallbladder)];
  for (std::uint32_t k = 0; neck != nullptr && k < organ.node_count; ++k) {
    if (math::Distance(rest[organ.first_node + k], neck->position) <= kNeckRadius)
      found.neck.push_back(organ.first_node + k);
  }
  return found;
}

}  // namespace trocar::cholecystectomy
