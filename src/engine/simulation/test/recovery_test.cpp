// SPDX-License-Identifier: Apache-2.0
/// Tissue that is pressed and let go comes home, in the built-in patient.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "trocar/files/scene_file.h"
#include "trocar/host/data_folder.h"
#include "trocar/scene/patient_tissue.h"
#include "trocar/simulation/simulation.h"

namespace trocar::simulation {

using files::ReadScene;
using host::FindDataFolder;
using scene::CalcScriptInput;
namespace {

// The demonstration grasps the fundus, lifts it, strokes the body, pulls the infundibulum, and lets go of
// both: 3 to 5 mm of dent used to stay in the gallbladder.
TEST(Recovery, TheGallbladderComesHomeAfterTheDemonstration) {
  const auto data = FindDataFolder();
  ASSERT_TRUE(data.ok());
  auto read = ReadScene(*data / "scenes" / "demonstration.json");
  ASSERT_TRUE(read.ok()) << read.error().Text();
  const auto scene = std::make_shared<const scene::Scene>(std::move(*read));
  auto still = Simulation::Make(scene), played = Simulation::Make(scene);
  ASSERT_TRUE(still.ok() && played.ok());
  const scene::Input home = CalcScriptInput(*scene, 0.0);
  for (int tick = 0; tick < 400; ++tick) still->Step(home);
  double volume_error = 0, highest_pressure = 0;
  for (int tick = 0; tick < static_cast<int>((scene->script.Duration() + 3.0) / scene->tick_seconds);
       ++tick) {
    played->Step(CalcScriptInput(*scene, played->GetSnapshot().time));
    for (const OrganSnapshot& organ : played->GetSnapshot().organs) {
      volume_error = std::max(volume_error, std::fabs(organ.volume / organ.target - 1.0));
      highest_pressure = std::max(highest_pressure, organ.pressure);
    }
  }
  EXPECT_LT(volume_error, 1e-4) << "0.01 % at every tick";
  EXPECT_GT(highest_pressure, 100.0) << "pulling a closed sac raises its pressure";
  const scene::SurfaceInfo& gallbladder = played->Surfaces()[1];
  ASSERT_EQ(gallbladder.name, "gallbladder");
  for (std::uint32_t i = gallbladder.first_node; i < gallbladder.first_node + gallbladder.node_count; ++i) {
    EXPECT_LT(math::Distance(played->GetSnapshot().positions[i], still->GetSnapshot().positions[i]), 1e-4)
        << i;
  }
}

}  // namespace
}  // namespace trocar::simulation
