// SPDX-License-Identifier: Apache-2.0
// Where an operation meets the rest of the tick: what it is told, and how all else follows its cuts.
#include <utility>

#include "simulation_content.h"
#include "trocar/core/assert.h"
#include "trocar/geometry/openings.h"

namespace trocar::session {

TissueNow Simulation::Content::GetTissue() noexcept {
  return {&tissue_model, &definition_now, &tissue,        conservation.get(),
          &conserved,    touch.Organs(),  &touch.Tubes(), std::span(torn_springs).first(torn_spring_count)};
}

/// What the tools do beyond grasping and pushing.
void Simulation::Content::Operate(const Input& input) noexcept {
  instrument::JointLimits limits;
  limits.min_depth = 0.01;
  hands.input = &input;
  hands.joints = joints;
  for (int hand = 0; hand < kHandCount; ++hand)
    hands.X_proxy[hand] = touch.Proxy(hand), hands.X_device[hand] = touch.Device(hand);
  hands.forces = forces;
  hands.gravity = load.gravity + kImagingGravity;
  hands.changes = changes;
  hands.grasps = &grasps;
  hands.camera = {CalcLaparoscopePose(scene->laparoscope, instrument::ClampJoints(input.laparoscope, limits)),
                  scene->laparoscope.field_of_view};
  hands.time = static_cast<double>(tick) * scene->tick_seconds;
  hands.seconds = scene->tick_seconds;
  if (operation->Act(hands, GetTissue())) ChangeTopology();
}

/// What the operation tells becomes events.
void Simulation::Content::NoteActs() noexcept {
  for (const OperationNote& note : operation->Notes()) {
    Note(note.kind, note.hand, note.surface, 0.0);
    Event& event = snapshot.events[(snapshot.event_count - 1) % snapshot.events.size()];
    event.error = note.error;
    event.p_rest = note.p_rest;
  }
}

/// Takes a cut into model, solver, volumes and contacts, in the tick that made it. Allocates.
void Simulation::Content::ChangeTopology() {
  const surgery::TopologyChange& change = operation->Change();
  const auto origins = surgery::ApplyChange(change, definition_now);
  tissue_model = tissue::MakeTissueModel(definition_now);
  surgery::ApplyChange(change, origins, tissue_model, tissue);
  // a spring that is new is of no wall: where it tears, a cut has opened the organ already
  std::vector<std::int32_t> organs(origins.size(), -1);
  std::vector<double> areas(origins.size(), 0.0);
  for (std::size_t i = 0; i < origins.size(); ++i) {
    if (origins[i] == geometry::kNone) continue;
    organs[i] = spring_organs[origins[i]];
    areas[i] = spring_areas[origins[i]];
  }
  spring_organs = std::move(organs);
  spring_areas = std::move(areas);
  torn_springs.resize(tissue_model.SpringCount());
  FollowTopology();
  has_cut = true;
}

/// Goes on with the changed model in all that was made for the one of before.
void Simulation::Content::FollowTopology() {
  solver->UpdateTopology(tissue_model);
  std::vector<geometry::TriangleMesh> meshes;
  std::vector<tissue::ClosedOrgan> closed;
  for (std::size_t i = 0; i < scene->patient.organs.size(); ++i) {
    const geometry::EditableMesh& mesh = operation->Organ(i).Mesh();
    meshes.push_back(mesh.RestMesh());
    if (conservation->Settings().organs.empty()) continue;  // sheets have no volume
    tissue::ClosedOrgan organ = conservation->Settings().organs[i];
    organ.node_count = static_cast<std::uint32_t>(mesh.VertexCount());
    organ.triangles = meshes.back().triangles;
    for (const geometry::Triangle& lid : geometry::MakeLids(mesh)) organ.triangles.push_back(lid);
    closed.push_back(std::move(organ));
  }
  conservation->UpdateTopology(tissue_model, std::move(closed), conserved);
  guard->UpdateTopology(tissue_model, tissue);
  // indices in range and finite coordinates, which is all that it asks for, a cut keeps
  const core::Status followed =
      touch.Follow(tissue_model, tissue, meshes, operation->TubePieces(), operation->TubesOfPieces());
  TROCAR_ASSERT(followed.ok());
}

}  // namespace trocar::session
