// SPDX-License-Identifier: Apache-2.0
#include "patient_tissue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "small_scene.h"
#include "trocar/geometry/mesh_measures.h"

namespace trocar::session {
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
  EXPECT_EQ(made_.surfaces[2].material, "duct");
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

TEST_F(PatientTissueTest, TiesBedAndDuctWithStrands) {
  EXPECT_EQ(made_.definition.strands.size(), scene_.patient.attachments.size() + 4);
}

}  // namespace
}  // namespace trocar::session
