// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "trocar/simulation/simulation.h"
#include "trocar/simulation/snapshot_codec.h"

namespace trocar::simulation {

SnapshotLayout DescribeSnapshots(const Simulation& simulation) {
  const scene::Scene& scene = simulation.GetScene();
  SnapshotLayout layout;
  layout.shape = simulation.GetSnapshot();
  layout.model = simulation.ModelFingerprint();
  layout.surfaces = simulation.Surfaces().size();
  layout.neighbours = scene.patient.neighbours.size();
  for (std::size_t hand = 0; hand < layout.tools.size(); ++hand)
    layout.tools[hand] = std::max<std::size_t>(scene.instruments[hand].tray.size(), 1);
  if (const scene::Procedure* procedure = scene::ProcedureOf(scene)) {
    layout.phases = procedure->phases.size();
    layout.procedure_errors = procedure->errors.size();
  }
  if (!scene.task) return layout;
  layout.rules = scene.task->errors.size();
  for (const scene::Goal& goal : scene.task->goals) layout.goal_steps.push_back(goal.steps.size());
  return layout;
}

}  // namespace trocar::simulation
