// SPDX-License-Identifier: Apache-2.0
#include "simulation_model.h"

#include <array>
#include <bit>
#include <cstdint>
#include <utility>

#include "operation/operated_anatomy.h"
#include "operation/operation.h"
#include "trocar/base/state_hash.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/patient/patient.h"
#include "trocar/scene/scene_fields.h"
#include "trocar/tissue/conserved_equilibrium.h"
#include "trocar/tissue/damage.h"
#include "trocar/tissue/equilibrium.h"

namespace trocar::simulation {

using scene::InstrumentSetup;
using scene::kSpareShareForCuts;
using scene::MakePatientTissue;
namespace {

/// Relative change of a filled organ's volume below which it counts as at rest [-].
constexpr double kFilledTolerance = 1e-4;

/// A spring's part of its organ's surface is the hole that it leaves when it tears.
WallSprings MakeWalls(const patient::Patient& patient, const scene::PatientTissue& tissue) {
  WallSprings walls{tissue.spring_organs, {}};
  const auto& springs = tissue.definition.springs;
  std::vector<double> areas, square_lengths(patient.organs.size(), 0.0);
  for (const patient::Organ& organ : patient.organs)
    areas.push_back(geometry::CalcArea(organ.mesh.positions, organ.mesh.triangles));
  const auto square_length = [&](std::size_t i) { return springs[i].rest_length * springs[i].rest_length; };
  for (std::size_t i = 0; i < walls.organs.size(); ++i) square_lengths[walls.organs[i]] += square_length(i);
  walls.areas.resize(springs.size());
  for (std::size_t i = 0; i < walls.organs.size(); ++i) {
    const std::int32_t organ = walls.organs[i];
    walls.areas[i] = areas[organ] * square_length(i) / square_lengths[organ];
  }
  walls.organs.resize(springs.size(), -1);
  return walls;
}

/// Rest, with tense organs filled.
base::Status Fill(const tissue::TissueModel& tissue_model, const base::Threads& threads,
                  SimulationModel& model) {
  tissue::SolverOptions options;
  options.threads = threads;
  if (model.scene->operation) options.spare_share = kSpareShareForCuts;
  tissue::EquilibriumSolver solver(tissue_model, options);
  model.solver_model = solver.ShareModel();
  tissue::Conservation conservation(tissue_model, model.tissue->conservation);
  model.tissue_at_start = tissue::MakeRestState(tissue_model);
  model.conserved_at_start = conservation.MakeState(model.tissue_at_start);
  const auto& pressures = model.tissue->internal_pressure;
  for (std::size_t organ = 0; organ < pressures.size(); ++organ) {
    if (pressures[organ] == 0.0) continue;
    const double change = tissue::FillToPressure(solver, organ, pressures[organ], {}, conservation,
                                                 model.tissue_at_start, model.conserved_at_start);
    if (!(change < kFilledTolerance)) {
      return base::Error{
          base::ErrorCode::kSceneInvalid,
          "the wall of \"" + model.tissue->surfaces[organ].name +
              "\" does not hold its internal pressure; lower internal_pressure_pa, or make the "
              "wall stiffer"};
    }
  }
  return {};
}

/// Counts objects and goals instead of reading them; only recordings and states of before have it.
std::uint64_t CalcFirstFingerprint(const SimulationModel& model) {
  base::StateHash hash;
  const scene::Scene& scene = *model.scene;
  base::AddStateTo(hash, model.tissue->definition);
  base::AddStateTo(hash, model.tissue_at_start);
  hash.Add(scene.tick_seconds);
  hash.Add(scene.seed);
  for (const std::size_t count :
       {model.tissue->definition.strands.size(), model.tissue->surfaces.size(), scene.objects.size(),
        scene.task ? scene.task->goals.size() + 1 : 0, scene.operation ? std::size_t{1} : 0})
    hash.Add(std::uint64_t{count});
  for (const InstrumentSetup& setup : scene.instruments) {
    for (const double value : {setup.p_world_port.x, setup.p_world_port.y, setup.p_world_port.z})
      hash.Add(value);
  }
  for (const patient::Neighbour& neighbour : scene.patient.neighbours) {
    hash.Add(std::uint64_t{neighbour.mesh.triangles.size()});
    hash.Add(static_cast<std::uint64_t>(neighbour.role));
    for (const math::Vec3& p : neighbour.mesh.positions) {
      for (const double value : {p.x, p.y, p.z}) hash.Add(value);
    }
  }
  // states that were saved with the delivered tables stay what they are
  if (scene.operation && scene.operation->parameters != scene::OperationParameters{}) {
    using Words = std::array<std::uint64_t, sizeof(scene::OperationParameters) / sizeof(std::uint64_t)>;
    for (const std::uint64_t word : std::bit_cast<Words>(scene.operation->parameters)) hash.Add(word);
  }
  return hash.Value();
}

/// Of the scene, and of what this program makes of it.
std::uint64_t CalcFingerprint(const SimulationModel& model) {
  base::StateHash hash;
  hash.Add(scene::CalcSceneFingerprint(*model.scene));
  base::AddStateTo(hash, model.tissue->definition);
  base::AddStateTo(hash, model.tissue_at_start);
  hash.Add(std::uint64_t{model.tissue->surfaces.size()});
  return hash.Value();
}

}  // namespace

base::Result<std::shared_ptr<const SimulationModel>> MakeSimulationModel(
    std::shared_ptr<const scene::Scene> scene, const base::Threads& threads) {
  auto made = MakePatientTissue(*scene, scene->operation ? Operation::kSpare : scene::SpareNodes{});
  if (!made.ok()) return made.error();
  made->conservation.imaging_gravity = kImagingGravity;
  auto model = std::make_shared<SimulationModel>();
  model->scene = std::move(scene);
  model->tissue = std::make_shared<const scene::PatientTissue>(std::move(*made));
  const tissue::TissueModel tissue_model = tissue::MakeTissueModel(model->tissue->definition);
  model->walls = MakeWalls(model->scene->patient, *model->tissue);
  model->walls_tear = tissue::HasTearingSprings(tissue_model);
  // what is taken out, else the one that there is
  const std::int32_t operated = FindOperatedOrgans(*model->scene, model->tissue->surfaces).organ;
  model->hollow_organ = operated >= 0 ? operated : model->scene->patient.HollowOrgan();
  if (const auto filled = Fill(tissue_model, threads, *model); !filled.ok()) return filled.error();
  model->fingerprint = CalcFingerprint(*model);
  model->first_fingerprint = CalcFirstFingerprint(*model);
  return std::shared_ptr<const SimulationModel>(std::move(model));
}

}  // namespace trocar::simulation
