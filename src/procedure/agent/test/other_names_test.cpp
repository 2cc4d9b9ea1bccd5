// SPDX-License-Identifier: Apache-2.0
// A patient whose organs, ducts, arteries, regions and landmarks have other names, and whose file says what they are: the
// surgeons operate on it as on the built-in one, bit by bit, and it is judged the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "trocar/agent/surgeon.h"
#include "trocar/anatomy/patient_lint.h"
#include "trocar/cholecystectomy/operation_judge.h"
#include "trocar/files/patient_file.h"
#include "trocar/files/scene_file.h"
#include "trocar/patient/patient.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/simulation.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::agent {

using files::ReadScene;
using scene::Scene;
using simulation::OperationResult;
using simulation::Simulation;

namespace {

namespace fs = std::filesystem;

const fs::path kScene = fs::path(TROCAR_SOURCE_DIR) / "scenes/cholecystectomy.json";

/// Nothing keeps its name; every part keeps its role.
patient::Patient Rename(patient::Patient patient) {
  std::map<std::string, std::string> names;
  const auto rename = [&](std::string& name, const std::string& what) {
    const std::string other = what + "_" + std::to_string(names.size());
    names[name] = other;
    name = other;
  };
  for (patient::Organ& organ : patient.organs) {
    rename(organ.name, "solid");
    for (patient::Region& region : organ.regions) rename(region.name, "patch");
  }
  for (patient::Tube& tube : patient.tubes) rename(tube.name, "pipe");
  for (patient::Tube& tube : patient.tubes) {
    if (!tube.from.empty()) tube.from = names.at(tube.from);
    if (!tube.to.empty()) tube.to = names.at(tube.to);
  }
  for (patient::Landmark& landmark : patient.landmarks) rename(landmark.name, "mark");
  for (patient::Attachment& attachment : patient.attachments) attachment.name = "strand";
  return patient;
}

class OtherNames : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const auto built_in = ReadScene(kScene);
    ASSERT_TRUE(built_in.ok()) << built_in.error().Text();
    // written and read alike, so that places are rounded alike
    usual_ = ReadBack(built_in->patient);
    renamed_ = ReadBack(Rename(built_in->patient));
    ASSERT_TRUE(usual_ && renamed_);
  }
  static std::shared_ptr<const Scene> ReadBack(const patient::Patient& patient) {
    const test::TemporaryFolder temporary;
    const fs::path folder = temporary.Path() / "patient";
    const auto wrote = files::WritePatient(folder, patient);
    EXPECT_TRUE(wrote.ok()) << wrote.error().Text();
    // a renamed patient has no landmark "fundus": the scene's is found by its role
    auto scene = ReadScene(kScene, folder);
    EXPECT_TRUE(scene.ok()) << scene.error().Text();
    return scene.ok() ? std::make_shared<const Scene>(std::move(*scene)) : nullptr;
  }

  struct Played {
    std::uint64_t hash = 0;
    OperationResult result;
  };
  static Played Play(const std::shared_ptr<const Scene>& scene, const std::string& name, double seconds) {
    auto simulation = Simulation::Make(scene);
    EXPECT_TRUE(simulation.ok());
    auto surgeon = MakeSurgeon(name, scene, 1);
    EXPECT_TRUE(surgeon.ok()) << surgeon.error().Text();
    while (!(*surgeon)->HasFinished() && simulation->GetSnapshot().time < seconds)
      simulation->Step((*surgeon)->Act(simulation->GetSnapshot()));
    return {simulation->Hash(), *simulation->GetOperationResult()};
  }
  /// \return how many errors both made
  static std::size_t ExpectTheSame(const std::string& surgeon, double seconds) {
    const Played usual = Play(usual_, surgeon, seconds), renamed = Play(renamed_, surgeon, seconds);
    EXPECT_EQ(renamed.hash, usual.hash);
    const auto others = renamed.result.procedure.errors.Entries(),
               errors = usual.result.procedure.errors.Entries();
    EXPECT_EQ(others.size(), errors.size());
    for (std::size_t i = 0; i < std::min(others.size(), errors.size()); ++i) {
      EXPECT_EQ(others[i].error, errors[i].error);
      EXPECT_EQ(others[i].time, errors[i].time);
    }
    const cholecystectomy::OperationDetail &other = *cholecystectomy::FindDetail(renamed.result.procedure),
                                           &own = *cholecystectomy::FindDetail(usual.result.procedure);
    EXPECT_EQ(other.injuries.strasberg, own.injuries.strasberg);
    EXPECT_EQ(other.injuries.wrong_vessels, own.injuries.wrong_vessels);
    EXPECT_EQ(other.injuries.structures_entering, own.injuries.structures_entering);
    EXPECT_EQ(other.facts.skeletonised, own.facts.skeletonised);
    EXPECT_EQ(renamed.result.procedure.now.phase, usual.result.procedure.now.phase);
    EXPECT_EQ(own.injuries.structures_entering, 2) << "a cystic duct and a cystic artery";
    return errors.size();
  }

  static std::shared_ptr<const Scene> usual_, renamed_;
};
std::shared_ptr<const Scene> OtherNames::usual_, OtherNames::renamed_;

TEST_F(OtherNames, NothingButTheNamesIsDifferent) {
  ASSERT_EQ(renamed_->patient.tubes.size(), usual_->patient.tubes.size());
  for (std::size_t i = 0; i < usual_->patient.tubes.size(); ++i) {
    EXPECT_NE(renamed_->patient.tubes[i].name, usual_->patient.tubes[i].name);
    EXPECT_EQ(renamed_->patient.tubes[i].role, usual_->patient.tubes[i].role);
  }
  const auto findings = [](const Scene& scene) {
    return anatomy::LintPatient(scene.patient).findings.size();
  };
  EXPECT_EQ(findings(*renamed_), findings(*usual_));
}

TEST_F(OtherNames, TheExpertBeginsWithTheSameBits) {
  EXPECT_EQ(ExpectTheSame("expert", 6.0), 0u);
}

TEST_F(OtherNames, ACarelessSurgeonIsJudgedTheSame) {
  EXPECT_GT(ExpectTheSame("clips_main_duct", 25.0), 0u);
}

TEST_F(OtherNames, WithoutRolesTheyAreStrangers) {
  patient::Patient patient = renamed_->patient;
  for (patient::Organ& organ : patient.organs) organ.role = roles::OrganRole::kOther;
  for (patient::Tube& tube : patient.tubes) tube.role = roles::TubeRole::kOther;
  for (patient::Landmark& landmark : patient.landmarks) landmark.role = roles::LandmarkRole::kOther;
  const test::TemporaryFolder temporary;
  const fs::path folder = temporary.Path() / "patient";
  ASSERT_TRUE(files::WritePatient(folder, patient).ok());
  const auto scene = ReadScene(kScene, folder);
  ASSERT_FALSE(scene.ok());
  EXPECT_NE(scene.error().message.find("fundus"), std::string::npos) << scene.error().Text();
}

}  // namespace
}  // namespace trocar::agent
