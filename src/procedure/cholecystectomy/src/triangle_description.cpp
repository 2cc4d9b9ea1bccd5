// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/triangle_description.h"

#include <cstddef>

#include "patient_anatomy.h"
#include "trocar/cholecystectomy/injury.h"
#include "trocar/scene/entering_tubes.h"

namespace trocar::cholecystectomy {

TriangleDescription DescribeTriangle(const scene::Scene& scene, const simulation::ModelDescription& model) {
  TriangleDescription triangle;
  if (!scene.operation) return triangle;
  MainNodes main;
  for (std::size_t t = 0; t < model.tube_roles.size(); ++t) {
    const scene::SurfaceInfo& surface = model.surfaces[scene.patient.organs.size() + t];
    const bool is_duct = scene.patient.tubes[t].kind == patient::TubeKind::kDuct;
    for (std::uint32_t k = 0; k < surface.node_count; ++k) {
      if (!MayBeDivided(model.tube_roles[t][k]))
        (is_duct ? main.ducts : main.arteries).push_back(surface.first_node + k);
    }
  }
  const PatientRows rows{model.surfaces, model.strands, model.rest};
  const surgery::JudgementSettings& settings = scene.operation->parameters.judgement;
  triangle.window_strands = MakeTriangleWindow(rows, main, settings).Strands();
  const auto entering = scene::FindEnteringTubes(
      model.surfaces, model.strands, scene::FindSurface(model.surfaces, roles::OrganRole::kGallbladder));
  const std::vector<double> exposable = CalcExposable(entering, model.rest, main, settings);
  triangle.sight = MakeTriangleSight(rows, entering, exposable, settings);
  triangle.exposable.resize(scene.patient.tubes.size());
  for (std::size_t i = 0; i < entering.size(); ++i) triangle.exposable[entering[i].tube] = exposable[i];
  return triangle;
}

}  // namespace trocar::cholecystectomy
