// SPDX-License-Identifier: Apache-2.0
// A patient without pictures takes the place of a scene's own and can be operated on.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "trocar/anatomy/generate_patient.h"
#include "trocar/files/patient_file.h"
#include "trocar/files/scene_file.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/simulation.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::simulation {

using files::ReadScene;
using scene::CalcScriptInput;
using surgery::FactKind;
namespace {

namespace fs = std::filesystem;

TEST(GeneratedPatient, RunsInTheDemonstrationScene) {
  const test::TemporaryFolder temporary;
  const fs::path folder = temporary.Path() / "patient";
  auto patient = anatomy::GeneratePatient(2);
  ASSERT_TRUE(patient.ok()) << patient.error().Text();
  ASSERT_TRUE(files::WritePatient(folder, *patient).ok());
  const fs::path scene_path = fs::path(TROCAR_SOURCE_DIR) / "scenes/demonstration.json";
  auto read = ReadScene(scene_path, folder);
  ASSERT_TRUE(read.ok()) << read.error().Text();
  EXPECT_EQ(read->patient.name, patient->name);
  EXPECT_EQ(read->patient_folder, folder);
  auto simulation = Simulation::Make(std::make_shared<const scene::Scene>(*read));
  ASSERT_TRUE(simulation.ok()) << simulation.error().Text();
  double worst_residual = 0;
  for (int tick = 0; tick < 240; ++tick) {
    simulation->Step(CalcScriptInput(*read, simulation->GetSnapshot().time));
    // organs first settle under their weight
    if (tick >= 5) worst_residual = std::max(worst_residual, simulation->GetSnapshot().residual);
  }
  EXPECT_LT(worst_residual, 0.05) << "every tick ends near equilibrium";
  const Snapshot& snapshot = simulation->GetSnapshot();
  EXPECT_EQ(snapshot.tick, 240u);
  ASSERT_FALSE(snapshot.positions.empty());
  for (const math::Vec3& p : snapshot.positions) ASSERT_TRUE(math::IsFinite(p));
  for (std::uint64_t i = 0; i < snapshot.event_count && i < snapshot.events.size(); ++i) {
    EXPECT_NE(snapshot.events[i].kind, FactKind::kStateRestored);
    EXPECT_NE(snapshot.events[i].kind, FactKind::kOrganFrozen);
  }
  EXPECT_EQ(ReadScene(scene_path, folder / "nowhere").error().code, base::ErrorCode::kFileMissing);
}

}  // namespace
}  // namespace trocar::simulation
