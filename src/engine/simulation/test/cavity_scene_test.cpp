// SPDX-License-Identifier: Apache-2.0
/// The built-in patient's organs in their cavity.
#include <gtest/gtest.h>

#include <algorithm>

#include "trocar/files/scene_file.h"
#include "trocar/host/data_folder.h"
#include "trocar/patient/patient.h"
#include "trocar/simulation/simulation.h"
#include "trocar/surgery/cavity.h"

namespace trocar::simulation {

using files::ReadScene;
using host::FindDataFolder;
using math::Vec3;
using scene::CalcScriptInput;

namespace {

/// The cavity as the simulation fits it, and how far each organ's vertices may lie beyond it.
struct FittedCavity {
  explicit FittedCavity(const Simulation& simulation) {
    const scene::Scene& scene = simulation.GetScene();
    std::vector<Vec3> face, nodes;
    for (const patient::Organ& organ : scene.patient.organs) {
      nodes.insert(nodes.end(), organ.mesh.positions.begin(), organ.mesh.positions.end());
      for (const patient::Region& region : organ.regions) {
        if (region.name != patient::kDiaphragmaticFace) continue;
        for (const auto vertex : region.vertices) face.push_back(organ.mesh.positions[vertex]);
      }
    }
    const Vec3 ports[] = {scene.instruments[0].p_world_port, scene.instruments[1].p_world_port,
                          scene.laparoscope.p_world_port};
    cavity = surgery::FitCavity(ports, face, nodes);
  }
  /// Farthest that a vertex has gone beyond a wall, or beyond where it was imaged beyond it [m].
  double Beyond(const Simulation& simulation) const {
    double beyond = 0;
    const auto& organs = simulation.GetScene().patient.organs;
    for (std::size_t organ = 0; organ < organs.size(); ++organ) {
      const auto& rest = organs[organ].mesh.positions;
      for (std::size_t i = 0; i < rest.size(); ++i) {
        const Vec3& p = simulation.GetSnapshot().positions[simulation.Surfaces()[organ].first_node + i];
        const auto before = cavity.FindClearances(rest[i]), now = cavity.FindClearances(p);
        for (int part = 0; part < surgery::kCavityParts; ++part)
          beyond = std::max(beyond, std::min(0.0, before[part].distance) - now[part].distance);
      }
    }
    return beyond;
  }
  surgery::Cavity cavity;
};

Simulation MakePatient() {
  auto scene = ReadScene(*FindDataFolder() / "scenes" / "retraction.json");
  EXPECT_TRUE(scene.ok());
  auto made = Simulation::Make(std::make_shared<const scene::Scene>(std::move(*scene)));
  EXPECT_TRUE(made.ok());
  return std::move(*made);
}

// A softened liver, head down: it rises by centimetres, to the diaphragm and not through it.
TEST(PatientInCavity, ALiverThatIsPushedUpRestsOnTheDome) {
  Simulation simulation = MakePatient();
  const FittedCavity fitted(simulation);
  ASSERT_TRUE(fitted.cavity.has_wall && fitted.cavity.has_dome && fitted.cavity.has_floor);
  scene::Input input = CalcScriptInput(simulation.GetScene(), 0.0);
  input.settings.gravity = 0.0;  // less than when it was imaged: the organs rise
  input.settings.stiffness_scale = input.settings.shape_scale = 0.2;
  for (int tick = 0; tick < 200; ++tick) simulation.Step(input);
  double moved = 0;
  const auto& rest = simulation.GetScene().patient.organs[0].mesh.positions;
  for (std::size_t i = 0; i < rest.size(); ++i)
    moved = std::max(moved, math::Distance(rest[i], simulation.GetSnapshot().positions[i]));
  EXPECT_GT(moved, 0.010);
  EXPECT_LT(fitted.Beyond(simulation), 0.0006);
  EXPECT_GT(fitted.Beyond(simulation), surgery::CavityContactSettings{}.play) << "the dome bears something";
  EXPECT_EQ(simulation.GetSnapshot().dropped_contacts, 0u);
  EXPECT_LT(simulation.CalcEquilibriumError(), 0.001);
}

// At rest nothing presses and nothing costs.
TEST(PatientInCavity, AtRestTheWallsDoNothing) {
  Simulation simulation = MakePatient();
  const FittedCavity fitted(simulation);
  const scene::Input home = CalcScriptInput(simulation.GetScene(), 0.0);
  for (int tick = 0; tick < 30; ++tick) simulation.Step(home);
  EXPECT_LT(fitted.Beyond(simulation), surgery::CavityContactSettings{}.play);
}

}  // namespace
}  // namespace trocar::simulation
