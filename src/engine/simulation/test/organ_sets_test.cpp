// SPDX-License-Identifier: Apache-2.0
// Other sets of organs than liver and gallbladder: scenes, not changes of code.
#include <gtest/gtest.h>

#include <string>

#include "small_scene.h"
#include "trocar/files/patient_file.h"
#include "trocar/patient/patient.h"
#include "trocar/simulation/simulation.h"

namespace trocar::simulation {

using scene::SmallScene;
namespace {

class OrganSets : public SmallScene {
 protected:
  static std::string SceneOf(const std::string& materials, const std::string& more = "") {
    return R"({"format": "trocar-scene", "version": 1, "name": "organs", "patient": "set", "materials": [)" +
           materials +
           R"(], "instruments": {"left": {"tool": "grasper", "port_mm": [-30, 60, 0], "tip": {"at_mm": [0, 70, -80]}},
                                 "right": {"tool": "hook", "port_mm": [30, 60, 0], "tip": {"at_mm": [10, 70, -80]}}},
              "laparoscope": {"port_mm": [0, 0, 0], "target": {"at_mm": [0, 80, -100]}, "depth_mm": 50})" +
           more + "}";
  }
  static std::string MaterialOf(const std::string& organ) {
    return R"({"organ": ")" + organ +
           R"(", "young_modulus_pa": 1e6, "wall_thickness_mm": 0.1, "foundation_modulus_pa": 5400,
               "foundation_depth_mm": 80, "density_kg_m3": 1060, "source": "test"})";
  }

  /// Runs the set for a second: hands that press on what is there.
  void Run(const patient::Patient& patient, const std::string& scene) {
    ASSERT_TRUE(files::WritePatient(folder_ / "set", patient).ok());
    Write("scene.json", scene);
    auto read = Read();
    ASSERT_TRUE(read.ok()) << read.error().Text();
    EXPECT_EQ(read->patient.OrganOf(roles::OrganRole::kGallbladder), -1);
    auto made = Simulation::Make(std::make_shared<const scene::Scene>(std::move(*read)));
    ASSERT_TRUE(made.ok()) << made.error().Text();
    simulation_.emplace(std::move(*made));
    scene::Input input = scene::CalcScriptInput(simulation_->GetScene(), 0.0);
    for (int tick = 0; tick < 120; ++tick) {
      for (auto& hand : input.hands) hand.depth += 0.0002;
      simulation_->Step(input);
    }
    const Snapshot& snapshot = simulation_->GetSnapshot();
    EXPECT_EQ(snapshot.tick, 120u);
    for (const math::Vec3& p : snapshot.positions) ASSERT_TRUE(math::IsFinite(p));
    for (std::uint64_t i = 0; i < snapshot.event_count && i < snapshot.events.size(); ++i)
      EXPECT_NE(snapshot.events[i].kind, surgery::FactKind::kStateRestored);
  }

  std::optional<Simulation> simulation_;
};

TEST_F(OrganSets, ALiverAloneIsAScene) {
  patient::Patient patient = MakePatient();
  patient.organs.pop_back();
  patient.attachments.clear(), patient.tubes.clear(), patient.landmarks.clear();
  Run(patient, SceneOf(MaterialOf("liver")));
  EXPECT_FALSE(simulation_->GetOperationResult().has_value());
  EXPECT_EQ(scene::FindSurface(simulation_->Surfaces(), roles::OrganRole::kLiver), 0);
}

TEST_F(OrganSets, APhantomOfBlocksIsOperatedOn) {
  patient::Patient patient;
  patient.name = "phantom", patient.provenance = "made by a test";
  patient.organs = {{"block", geometry::MakeSphere({0, 0.1, -0.12}, 0.03, 3), {}},
                    {"ball", geometry::MakeSphere({0, 0.056, -0.12}, 0.013, 2), {}}};
  patient.tubes = {
      {"pipe",
       patient::TubeKind::kDuct,
       "ball",
       "",
       {{{0.012, 0.056, -0.12}, {0.02, 0.056, -0.122}, {0.03, 0.058, -0.125}}, {0.0015, 0.0015, 0.0015}}}};
  Run(patient, SceneOf(MaterialOf("block") + "," + MaterialOf("ball") + "," + MaterialOf("duct"),
                       R"(, "operation": {"fat_spacing_mm": 0})"));
  const auto result = simulation_->GetOperationResult();
  ASSERT_TRUE(result.has_value());
  for (const scene::Finding& finding : result->procedure.findings)
    EXPECT_FALSE(finding.is_harm) << finding.name;
  EXPECT_EQ(result->stones.all, 0);
  EXPECT_FALSE(result->is_completed);
}

TEST_F(OrganSets, AMaterialIsFoundByTheOrgansRole) {
  patient::Patient patient = MakePatient();
  patient.organs.pop_back();
  patient.attachments.clear(), patient.tubes.clear(), patient.landmarks.clear();
  patient.organs[0].name = "hepar";  // its role stays
  Run(patient, SceneOf(MaterialOf("liver")));
  EXPECT_EQ(simulation_->Surfaces()[0].name, "hepar");
  EXPECT_EQ(simulation_->Surfaces()[0].look, NameOf(roles::OrganRole::kLiver));
}

TEST_F(OrganSets, AnOrganWithoutAMaterialIsNamed) {
  patient::Patient patient = MakePatient();
  patient.organs[1] = {"spleen", patient.organs[1].mesh, {}};
  patient.attachments.clear(), patient.tubes.clear(), patient.landmarks.clear();
  ASSERT_TRUE(files::WritePatient(folder_ / "set", patient).ok());
  Write("scene.json", SceneOf(MaterialOf("liver")));
  auto read = Read();
  ASSERT_TRUE(read.ok()) << read.error().Text();
  const auto made = Simulation::Make(std::make_shared<const scene::Scene>(std::move(*read)));
  ASSERT_FALSE(made.ok());
  EXPECT_NE(made.error().message.find("spleen"), std::string::npos);
}

}  // namespace
}  // namespace trocar::simulation
