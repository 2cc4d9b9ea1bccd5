// SPDX-License-Identifier: Apache-2.0
#include "trocar/simulation/model_description.h"

#include <utility>

#include "operation/gallbladder_anatomy.h"
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
  std::vector<std::uint32_t> main_ducts, main_arteries;
  for (std::size_t t = 0; vessels.ok() && t < scene.patient.tubes.size(); ++t) {
    const scene::SurfaceInfo& surface = tissue->surfaces[scene.patient.organs.size() + t];
    std::vector<cholecystectomy::VesselRole>& roles = description.tube_roles.emplace_back();
    for (std::uint32_t k = 0; k < surface.node_count; ++k) {
      roles.push_back(vessels->anatomy.roles[vessels->map.Find(t, vessels->map.arcs[t][k]).vessel]);
      const bool is_duct = scene.patient.tubes[t].kind == patient::TubeKind::kDuct;
      if (!cholecystectomy::MayBeDivided(roles.back()))
        (is_duct ? main_ducts : main_arteries).push_back(surface.first_node + k);
    }
  }
  if (scene.operation.has_value()) {
    description.window_strands =
        MakeTriangleWindow(tissue->surfaces, tissue->strands, tissue->definition.rest, main_ducts,
                           main_arteries, scene.operation->parameters.judgement)
            .Strands();
    const auto entering = FindEnteringTubes(scene.patient, tissue->surfaces, tissue->strands);
    const cholecystectomy::JudgementSettings& settings = scene.operation->parameters.judgement;
    const std::vector<double> exposable =
        CalcExposable(entering, tissue->definition.rest, main_ducts, main_arteries, settings);
    description.sight = MakeTriangleSight(scene.patient, tissue->surfaces, tissue->strands,
                                          tissue->definition.rest, exposable, settings);
    description.exposable.resize(scene.patient.tubes.size());
    for (std::size_t i = 0; i < entering.size(); ++i) description.exposable[entering[i].tube] = exposable[i];
  }
  description.surfaces = std::move(tissue->surfaces);
  description.strands = std::move(tissue->strands);
  description.rest = std::move(tissue->definition.rest);
  return description;
}

}  // namespace trocar::simulation
