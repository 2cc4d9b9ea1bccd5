// SPDX-License-Identifier: Apache-2.0
#include "trocar/scene/pathology.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "trocar/files/scene_file.h"
#include "trocar/scene/patient_tissue.h"

namespace trocar::scene {
namespace {

const Scene& BuiltIn() {
  static const Scene scene = [] {
    auto read = files::ReadScene(std::string(TROCAR_SOURCE_DIR) + "/scenes/demonstration.json");
    EXPECT_TRUE(read.ok()) << read.error().Text();
    return *read;
  }();
  return scene;
}

Scene With(std::initializer_list<std::pair<const char*, double>> parameters) {
  Scene scene = BuiltIn();
  for (const auto& [name, value] : parameters) scene.patient.parameters.push_back({name, value, "", "test"});
  return scene;
}

const OrganMaterial& MaterialOf(const std::vector<OrganMaterial>& materials, std::string_view organ) {
  return *std::find_if(materials.begin(), materials.end(), [&](const auto& m) { return m.organ == organ; });
}

PatientTissue Make(const Scene& scene) {
  auto made = MakePatientTissue(scene);
  EXPECT_TRUE(made.ok()) << made.error().Text();
  return std::move(made).value();
}

/// Mean stiffness of an organ's edge springs, and of its virtual springs.
struct Stiffness {
  double edges = 0, foundation = 0;
};
Stiffness MeasureStiffness(const PatientTissue& tissue, std::string_view surface) {
  const auto found = std::find_if(tissue.surfaces.begin(), tissue.surfaces.end(),
                                  [&](const SurfaceInfo& info) { return info.name == surface; });
  const auto is_own = [&](std::uint32_t node) {
    return node >= found->first_node && node < found->first_node + found->node_count;
  };
  Stiffness stiffness;
  for (const auto& spring : tissue.definition.springs) {
    if (is_own(spring.a) && is_own(spring.b)) stiffness.edges += spring.stiffness;
  }
  for (std::uint32_t i = 0; i < found->node_count; ++i)
    stiffness.foundation += tissue.definition.shape_stiffness[found->first_node + i];
  return stiffness;
}

TEST(Pathology, PatientWithoutParametersIsHealthy) {
  EXPECT_EQ(patient::CalcPathology(BuiltIn().patient), patient::Pathology{});
  const auto materials = CalcPatientMaterials(BuiltIn(), patient::Pathology{});
  for (std::size_t i = 0; i < materials.size(); ++i) {
    EXPECT_EQ(materials[i].young_modulus, BuiltIn().materials[i].young_modulus);
    EXPECT_EQ(materials[i].foundation_modulus, BuiltIn().materials[i].foundation_modulus);
  }
  // all sliders at 0 are the same, bit for bit
  const Scene zero = With({{"cirrhosis", 0},
                           {"steatosis", 0},
                           {"hydrops", 0},
                           {"acute_cholecystitis", 0},
                           {"scleroatrophy", 0},
                           {"triangle_fibrosis", 0},
                           {"adhesions", 0},
                           {"gallbladder_wall", 2}});
  EXPECT_EQ(patient::CalcPathology(zero.patient), patient::Pathology{});
}

TEST(Pathology, CirrhoticLiverIsElevenTimesAsStiff) {
  const auto healthy = MeasureStiffness(Make(BuiltIn()), "liver");
  const auto half = MeasureStiffness(Make(With({{"cirrhosis", 0.5}})), "liver");
  const auto whole = MeasureStiffness(Make(With({{"cirrhosis", 1}})), "liver");
  EXPECT_NEAR(whole.foundation / healthy.foundation, 11, 1e-9);
  EXPECT_NEAR(whole.edges / healthy.edges, 11, 1e-9);
  EXPECT_NEAR(half.foundation / healthy.foundation, std::sqrt(11.0), 1e-9);
  // 5.4 kPa becomes 59.4 kPa, the literature's diseased liver
  const auto materials =
      CalcPatientMaterials(BuiltIn(), patient::CalcPathology(With({{"cirrhosis", 1}}).patient));
  EXPECT_NEAR(MaterialOf(materials, "liver").foundation_modulus, 59400, 1);
  EXPECT_EQ(MaterialOf(materials, "gallbladder").young_modulus,
            MaterialOf(BuiltIn().materials, "gallbladder").young_modulus);
}

TEST(Pathology, FattyLiverStaysNearNormal) {
  const auto healthy = MeasureStiffness(Make(BuiltIn()), "liver");
  const auto fatty = MeasureStiffness(Make(With({{"steatosis", 1}})), "liver");
  EXPECT_NEAR(fatty.foundation / healthy.foundation, 6.5 / 5.4, 1e-9);
}

TEST(Pathology, ThickWallIsStifferAndHydropsIsTense) {
  const auto healthy = MeasureStiffness(Make(BuiltIn()), "gallbladder");
  const auto thick = MeasureStiffness(Make(With({{"gallbladder_wall", 4}})), "gallbladder");
  EXPECT_NEAR(thick.edges / healthy.edges, 2, 1e-9);
  EXPECT_NEAR(thick.foundation, healthy.foundation, 1e-12);
  const auto acute = MeasureStiffness(Make(With({{"acute_cholecystitis", 1}})), "gallbladder");
  EXPECT_NEAR(acute.edges / healthy.edges, 2.5, 1e-9);
  const auto shrunk = MeasureStiffness(Make(With({{"scleroatrophy", 1}})), "gallbladder");
  EXPECT_NEAR(shrunk.edges / healthy.edges, 6, 1e-9);
  const auto tense = MeasureStiffness(Make(With({{"hydrops", 1}})), "gallbladder");
  EXPECT_LT(tense.edges, healthy.edges);
  EXPECT_NEAR(tense.foundation / healthy.foundation, 5, 1e-9);
}

TEST(Pathology, FibrosisHoldsDuctsAndBed) {
  const PatientTissue healthy = Make(BuiltIn()), fibrotic = Make(With({{"triangle_fibrosis", 1}}));
  EXPECT_NEAR(MeasureStiffness(fibrotic, "cystic_duct").foundation /
                  MeasureStiffness(healthy, "cystic_duct").foundation,
              5, 1e-9);
  EXPECT_NEAR(fibrotic.definition.strands[0].stiffness / healthy.definition.strands[0].stiffness, 2, 1e-9);
}

TEST(Pathology, AdhesionsTieTheFreeWallToTheLiverNearby) {
  const PatientTissue healthy = Make(BuiltIn()), grown = Make(With({{"adhesions", 0.6}}));
  EXPECT_GT(grown.definition.strands.size(), healthy.definition.strands.size() + 30);
  EXPECT_EQ(grown.conservation.strand_binds.size(), grown.definition.strands.size());
  const auto& patient = BuiltIn().patient;
  const patient::PatientBed bed_of = patient.ListBeds().front();
  const auto few = FindAdhesions(patient, bed_of, 0.3), many = FindAdhesions(patient, bed_of, 0.9);
  EXPECT_TRUE(FindAdhesions(patient, bed_of, 0).empty());
  EXPECT_GT(few.size(), 10u);
  EXPECT_GT(many.size(), few.size());
  // more of the disease keeps what there was
  EXPECT_TRUE(std::includes(many.begin(), many.end(), few.begin(), few.end()));
  const auto& gallbladder = patient.organs[patient.FindOrgan("gallbladder")];
  const auto& liver = patient.organs[patient.FindOrgan("liver")];
  std::set<std::uint32_t> bed;
  for (const auto& region : gallbladder.regions) bed.insert(region.vertices.begin(), region.vertices.end());
  for (const auto& pair : many) {
    EXPECT_FALSE(bed.contains(pair.first));
    EXPECT_LE(math::Distance(gallbladder.mesh.positions[pair.first], liver.mesh.positions[pair.second]),
              0.015);
  }
}

}  // namespace
}  // namespace trocar::scene
