// SPDX-License-Identifier: Apache-2.0
#include "trocar/simulation/model_description.h"

#include <utility>

#include "operation/operation.h"
#include "operation/vessel_map.h"
#include "trocar/scene/patient_tissue.h"

namespace trocar::simulation {

using scene::MakePatientTissue;

core::Result<ModelDescription> DescribeModel(const Scene& scene) {
  auto tissue = MakePatientTissue(scene, scene.operation.has_value() ? Operation::kSpare : SpareNodes{});
  if (!tissue.ok()) return tissue.error();
  ModelDescription description;
  const auto map = MakeVesselMap(scene.patient);
  for (std::size_t t = 0; map.ok() && t < scene.patient.tubes.size(); ++t) {
    const SurfaceInfo& surface = tissue->surfaces[scene.patient.organs.size() + t];
    std::vector<training::VesselRole>& roles = description.tube_roles.emplace_back();
    for (std::uint32_t k = 0; k < surface.node_count; ++k)
      roles.push_back(map->anatomy.roles[map->Find(t, map->arcs[t][k]).vessel]);
  }
  description.surfaces = std::move(tissue->surfaces);
  description.strands = std::move(tissue->strands);
  description.rest = std::move(tissue->definition.rest);
  return description;
}

}  // namespace trocar::simulation
