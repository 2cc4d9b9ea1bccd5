// SPDX-License-Identifier: Apache-2.0
#include "operation/operated_anatomy.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <variant>

#include "trocar/base/to_integer.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/scene/entering_tubes.h"
#include "trocar/scene/procedure.h"
#include "trocar/simulation/ground.h"

namespace trocar::simulation {

using math::Vec3;
using scene::Scene;
using scene::StrandInfo;
using scene::SurfaceInfo;
namespace {

constexpr std::uint64_t kStoneSeed = 0x73746f6e6573;  // the stones' own stream

double NumberOf(const patient::Patient& patient, std::string_view name, double otherwise) {
  const patient::Parameter* parameter = patient.FindParameter(name);
  const double* number = parameter == nullptr ? nullptr : std::get_if<double>(&parameter->value);
  return number == nullptr ? otherwise : *number;
}

const patient::Landmark* FindLandmark(const Scene& scene, std::optional<roles::LandmarkRole> role) {
  return role ? scene.patient.LandmarkOf(*role) : nullptr;
}

}  // namespace

OperatedOrgans FindOperatedOrgans(const Scene& scene, std::span<const SurfaceInfo> surfaces) {
  const scene::Procedure* procedure = scene::ProcedureOf(scene);
  if (procedure == nullptr) return {};
  const auto find = [&](std::optional<roles::OrganRole> role) {
    return role ? scene::FindSurface(surfaces, *role) : -1;
  };
  return {find(procedure->organ), find(procedure->host)};
}

const patient::Landmark* FindNeck(const Scene& scene) {
  const scene::Procedure* procedure = scene::ProcedureOf(scene);
  return procedure == nullptr ? nullptr : FindLandmark(scene, procedure->neck);
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

surgery::OrganAttachment MakeAttachment(const Scene& scene, std::span<const SurfaceInfo> surfaces,
                                        std::span<const StrandInfo> strands) {
  using Kind = StrandInfo::Kind;
  const scene::Procedure* procedure = scene::ProcedureOf(scene);
  const bool has_axis =
      procedure != nullptr && FindNeck(scene) != nullptr && FindLandmark(scene, procedure->tip) != nullptr;
  std::vector<std::uint32_t> holding;
  for (std::uint32_t i = 0; i < strands.size(); ++i) {
    if (strands[i].kind == Kind::kAdhesion || (strands[i].kind == Kind::kBed && has_axis))
      holding.push_back(i);
  }
  const std::int32_t organ = FindOperatedOrgans(scene, surfaces).organ;
  return {std::move(holding), scene::FindEnteringTubes(surfaces, strands, organ)};
}

surgery::GallstoneSettings FindGallstones(const Scene& scene) {
  surgery::GallstoneSettings stones =
      scene.operation ? scene.operation->gallstones : surgery::GallstoneSettings{};
  stones.count = std::clamp(base::RoundTo<int>(NumberOf(scene.patient, "gallstone_count", stones.count)), 0,
                            surgery::kMostGallstones);
  stones.median_diameter =
      1e-3 *
      std::clamp(NumberOf(scene.patient, "gallstone_diameter", 1e3 * stones.median_diameter), 1.0, 30.0);
  return stones;
}

base::Result<surgery::GallstoneSpill> MakeGallstones(const Scene& scene,
                                                     std::span<const SurfaceInfo> surfaces,
                                                     std::span<const Vec3> rest) {
  const std::int32_t organ = FindOperatedOrgans(scene, surfaces).organ;
  if (organ < 0) return surgery::GallstoneSpill{};
  const geometry::TriangleMesh& wall = scene.patient.organs[static_cast<std::size_t>(organ)].mesh;
  const double capacity = geometry::CalcVolume(wall.positions, wall.triangles);
  const std::vector<double> diameters =
      surgery::DrawGallstones(FindGallstones(scene), capacity, scene.seed ^ kStoneSeed);
  return surgery::GallstoneSpill::Make(diameters, geometry::MakeOmentum(FindOmentumBalls(surfaces, rest)),
                                       scene.operation->parameters.stones);
}

}  // namespace trocar::simulation
