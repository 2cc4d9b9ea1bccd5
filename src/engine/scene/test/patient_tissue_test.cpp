// SPDX-License-Identifier: Apache-2.0
#include "trocar/scene/patient_tissue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "small_scene.h"
#include "trocar/geometry/mesh_measures.h"

namespace trocar::scene {
namespace {

class PatientTissueTest : public SmallScene {
 protected:
  void SetUp() override {
    SmallScene::SetUp();
    auto scene = Read();
    ASSERT_TRUE(scene.ok()) << scene.error().Text();
    scene_ = std::move(*scene);
    auto made = MakePatientTissue(scene_);
    ASSERT_TRUE(made.ok());
    made_ = std::move(*made);
  }
  Scene scene_;
  PatientTissue made_;
};

TEST_F(PatientTissueTest, LaysOrganAfterOrganThenTubes) {
  ASSERT_EQ(made_.surfaces.size(), 3u);
  EXPECT_EQ(made_.surfaces[1].first_node, made_.surfaces[0].node_count);
  EXPECT_EQ(made_.surfaces[2].name, "cystic_duct");
  EXPECT_EQ(made_.surfaces[2].look, "duct");
  EXPECT_EQ(made_.surfaces[2].first_node + made_.surfaces[2].node_count, made_.definition.rest.size());
}

TEST_F(PatientTissueTest, WeighsWhatTheOrgansWeigh) {
  double expected = 0;
  for (const auto& organ : scene_.patient.organs) {
    expected += 1060.0 * geometry::CalcVolume(organ.mesh.positions, organ.mesh.triangles);
  }
  const auto& mass = made_.definition.mass;
  const double organs = std::accumulate(mass.begin(), mass.begin() + made_.surfaces[2].first_node, 0.0);
  EXPECT_NEAR(organs / expected, 1.0, 1e-12);
}

TEST_F(PatientTissueTest, FixesThePapersRegionsAndTheEndsThatLeaveTheScene) {
  const auto& face = scene_.patient.organs[0].regions[0].vertices;
  for (const auto vertex : face) {
    EXPECT_NE(std::find(made_.definition.fixed.begin(), made_.definition.fixed.end(), vertex),
              made_.definition.fixed.end());
  }
  EXPECT_EQ(made_.definition.fixed.size(), face.size() + 1);
  EXPECT_EQ(made_.definition.fixed.back(), made_.definition.rest.size() - 1) << "the duct's far end";
}

TEST_F(PatientTissueTest, KeepsTheVolumeOfEachOrganAndLetsOnlyTheBedBind) {
  ASSERT_EQ(made_.conservation.organs.size(), 2u);
  EXPECT_EQ(made_.conservation.organs[1].first_node, made_.surfaces[1].first_node);
  const auto& binds = made_.conservation.strand_binds;
  ASSERT_EQ(binds.size(), made_.definition.strands.size());
  EXPECT_EQ(std::accumulate(binds.begin(), binds.end(), std::size_t{0}), scene_.patient.attachments.size());
  EXPECT_EQ(binds.back(), 0) << "the duct's end is a joint";
}

TEST_F(PatientTissueTest, AnOrganWithAHoleIsNamed) {
  scene_.patient.organs[1].mesh.triangles.pop_back();
  const auto made = MakePatientTissue(scene_);
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.error().code, base::ErrorCode::kSceneInvalid);
  EXPECT_NE(made.error().message.find("gallbladder"), std::string::npos);
}

TEST_F(PatientTissueTest, NoPairOfNodesIsJoinedTwice) {
  auto springs = made_.definition.springs;
  for (auto& spring : springs) {
    if (spring.a > spring.b) std::swap(spring.a, spring.b);
  }
  std::sort(springs.begin(), springs.end(),
            [](const auto& a, const auto& b) { return std::pair(a.a, a.b) < std::pair(b.a, b.b); });
  for (std::size_t i = 1; i < springs.size(); ++i) {
    EXPECT_FALSE(springs[i - 1].a == springs[i].a && springs[i - 1].b == springs[i].b) << springs[i].a;
  }
}

TEST_F(PatientTissueTest, TiesBedAndDuctWithStrands) {
  EXPECT_EQ(made_.definition.strands.size(), scene_.patient.attachments.size() + 4);
}

}  // namespace
}  // namespace trocar::scene
