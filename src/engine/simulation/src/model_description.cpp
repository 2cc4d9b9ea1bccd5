// SPDX-License-Identifier: Apache-2.0
#include "trocar/simulation/model_description.h"

#include <utility>

#include "operation/operation.h"
#include "trocar/scene/patient_tissue.h"
#include "trocar/scene/patient_vessels.h"

namespace trocar::simulation {

using scene::MakePatientTissue;

base::Result<ModelDescription> DescribeModel(const scene::Scene& scene) {
  auto tissue =
      MakePatientTissue(scene, scene.operation.has_value() ? Operation::kSpare : scene::SpareNodes{});
  if (!tissue.ok()) return tissue.error();
  ModelDescription description;
  const auto vessels = scene::MakePatientVessels(scene.patient);
  for (std::size_t t = 0; vessels.ok() && t < scene.patient.tubes.size(); ++t) {
    const scene::SurfaceInfo& surface = tissue->surfaces[scene.patient.organs.size() + t];
    std::vector<roles::TubeRole>& roles = description.tube_roles.emplace_back();
    for (std::uint32_t k = 0; k < surface.node_count; ++k)
      roles.push_back(vessels->anatomy.roles[vessels->map.Find(t, vessels->map.arcs[t][k]).vessel]);
  }
  description.surfaces = std::move(tissue->surfaces);
  description.strands = std::move(tissue->strands);
  description.rest = std::move(tissue->definition.rest);
  return description;
}

}  // namespace trocar::simulation
