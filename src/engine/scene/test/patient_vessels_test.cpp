// SPDX-License-Identifier: Apache-2.0
#include "trocar/scene/patient_vessels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "trocar/files/scene_file.h"
#include "trocar/patient/patient.h"
#include "trocar/scene/scene.h"

namespace trocar::scene {
namespace {

TEST(PatientVessels, JoinsDuctsAndArteriesAsThePatientHasThem) {
  auto scene = files::ReadScene(std::filesystem::path(TROCAR_SOURCE_DIR) / "scenes/cholecystectomy.json");
  ASSERT_TRUE(scene.ok()) << scene.error().Text();
  auto made = MakePatientVessels(scene->patient);
  ASSERT_TRUE(made.ok()) << made.error().Text();
  const VesselAnatomy& anatomy = made->anatomy;
  surgery::VesselMap& map = made->map;
  ASSERT_TRUE(anatomy.liver && anatomy.bowel && anatomy.aorta && anatomy.right_liver);
  EXPECT_EQ(anatomy.hollow_organ.size(), 2u) << "cystic duct and cystic artery";
  ASSERT_EQ(map.organ_ducts.size(), 1u);
  surgery::VesselActs acts;
  (void)map.network.Solve(acts);
  EXPECT_TRUE(map.network.AreConnected(acts, *anatomy.liver, *anatomy.bowel));
  EXPECT_TRUE(map.network.AreConnected(acts, *anatomy.liver, map.organ_ducts[0]));
  EXPECT_FALSE(map.network.AreConnected(acts, *anatomy.liver, *anatomy.aorta));

  // a cut cystic artery bleeds 1 to 2 mL/s (domain facts, section 1.4); a clip upstream stops it
  const auto& tubes = scene->patient.tubes;
  const auto artery =
      static_cast<std::size_t>(std::find_if(tubes.begin(), tubes.end(),
                                            [](const auto& tube) { return tube.name == "cystic_artery"; }) -
                               tubes.begin());
  const double length = map.arcs[artery].back();
  const surgery::VesselPlace cut = map.Find(artery, 0.6 * length), clip = map.Find(artery, 0.3 * length);
  EXPECT_EQ(anatomy.roles[cut.vessel], roles::TubeRole::kCysticArtery);
  acts.openings.push_back({cut.vessel, cut.position, true, 0.0, {}});
  const double rate = map.network.Solve(acts).rate[static_cast<std::size_t>(surgery::Fluid::kBlood)];
  EXPECT_GT(rate, 1.0e-6);
  EXPECT_LT(rate, 2.0e-6);
  acts.clips.push_back({clip.vessel, clip.position, 1.0});
  EXPECT_LT(map.network.Solve(acts).rate[static_cast<std::size_t>(surgery::Fluid::kBlood)], 0.05 * rate);
}

TEST(PatientVessels, WhatHasNoRoleMustStay) {
  auto scene = files::ReadScene(std::filesystem::path(TROCAR_SOURCE_DIR) / "scenes/cholecystectomy.json");
  ASSERT_TRUE(scene.ok()) << scene.error().Text();
  const auto role_of = [&](roles::TubeRole role, const char* other_name) {
    patient::Patient patient = scene->patient;
    patient::Tube& tube = patient.tubes[static_cast<std::size_t>(patient.TubeOf(role))];
    for (patient::Tube& joined : patient.tubes) {
      if (joined.from == tube.name) joined.from = other_name;
      if (joined.to == tube.name) joined.to = other_name;
    }
    tube.name = other_name, tube.role = roles::TubeRole::kOther;
    const auto made = MakePatientVessels(patient);
    EXPECT_TRUE(made.ok());
    const auto index = static_cast<std::size_t>(&tube - patient.tubes.data());
    return made->anatomy.roles[made->map.vessels_of_tube[index].front()];
  };
  // whatever its name contains
  EXPECT_EQ(role_of(roles::TubeRole::kCysticDuct, "no_cystic_duct"), roles::TubeRole::kCommonHepaticDuct);
  EXPECT_EQ(role_of(roles::TubeRole::kCysticArtery, "branch"), roles::TubeRole::kRightHepaticArtery);
  EXPECT_EQ(role_of(roles::TubeRole::kCysticArtery, "branch"), roles::TubeRole::kRightHepaticArtery);
}

// Supplies are a table: without pressure in the aorta nothing bleeds.
TEST(PatientVessels, AreFedAsTheirTableSays) {
  auto scene = files::ReadScene(std::filesystem::path(TROCAR_SOURCE_DIR) / "scenes/cholecystectomy.json");
  ASSERT_TRUE(scene.ok()) << scene.error().Text();
  VesselSupplies supplies;
  supplies.aorta.pressure = supplies.artery_bed.pressure = 0.0;
  auto made = MakePatientVessels(scene->patient, supplies);
  ASSERT_TRUE(made.ok()) << made.error().Text();
  const auto& roles = made->anatomy.roles;
  const auto artery = static_cast<std::uint32_t>(
      std::find(roles.begin(), roles.end(), roles::TubeRole::kCysticArtery) - roles.begin());
  surgery::VesselActs acts;
  acts.openings.push_back({artery, 0.001, true, 0.0, {}});
  EXPECT_EQ(made->map.network.Solve(acts).rate[static_cast<std::size_t>(surgery::Fluid::kBlood)], 0.0);
}

}  // namespace
}  // namespace trocar::scene
