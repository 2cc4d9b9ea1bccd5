// SPDX-License-Identifier: Apache-2.0
// The built-in patient, cut: the tissue goes on with the changed system.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include "allocation_counter.h"
#include "trocar/files/scene_file.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/openings.h"
#include "trocar/patient/patient.h"
#include "trocar/scene/patient_tissue.h"
#include "trocar/surgery/cuttable_organ.h"
#include "trocar/tissue/conservation.h"

namespace trocar::simulation {

using files::ReadScene;
using scene::MakePatientTissue;
using scene::PatientTissue;
namespace {

using geometry::BladeEdge;
using math::Vec3;

class CutPatient : public testing::Test {
 protected:
  static constexpr std::uint32_t kSpare = 1500;

  void SetUp() override {
    auto scene = ReadScene(std::filesystem::path(TROCAR_SOURCE_DIR) / "scenes/demonstration.json");
    ASSERT_TRUE(scene.ok()) << scene.error().Text();
    auto made = MakePatientTissue(*scene, {kSpare, 40});
    ASSERT_TRUE(made.ok()) << made.error().Text();
    patient_ = std::move(scene->patient);
    made_ = std::move(*made);
    model_ = tissue::MakeTissueModel(made_.definition);
    state_ = tissue::MakeRestState(model_);
  }

  surgery::CuttableOrgan MakeOrgan(std::size_t index, bool is_solid) {
    surgery::CuttableOrganSettings settings;
    settings.wall = made_.walls[index];
    settings.cut.has_walls = is_solid;
    settings.first_node = made_.surfaces[index].first_node;
    settings.first_spare = settings.first_node + made_.surfaces[index].node_count;
    settings.spare_count = kSpare;
    auto organ = surgery::CuttableOrgan::Make(patient_.organs[index].mesh, settings);
    EXPECT_TRUE(organ.ok());
    organ->ReserveFor(change_);
    return std::move(*organ);
  }

  void CutTick(surgery::CuttableOrgan& organ, const BladeEdge& before, const BladeEdge& now,
               geometry::CutFront& front) {
    change_.Clear();
    const long allocations = CountAllocations();
    organ.Cut(before, now, state_.position, front, change_);
    EXPECT_EQ(CountAllocations(), allocations) << "a cut allocates";
    if (change_.IsEmpty()) return;
    const auto origins = surgery::ApplyChange(change_, made_.definition);
    model_ = tissue::MakeTissueModel(made_.definition);
    surgery::ApplyChange(change_, origins, model_, state_);
  }

  /// Cuts 30 mm along y over the vertex that lies farthest down or in front.
  void CutOver(surgery::CuttableOrgan& organ, std::uint32_t vertex, int ticks) {
    const Vec3 at = state_.position[organ.Node(vertex)];
    std::vector<Vec3> normals(organ.Mesh().VertexCount());
    geometry::CalcVertexNormals(organ.Mesh().Rest(), organ.Mesh().Triangles(), normals);
    const Vec3 out = normals[vertex];
    const Vec3 along = math::AnyPerpendicular(out);
    geometry::CutFront front;
    const auto blade = [&](int i) {
      const Vec3 middle = at + (0.030 * i / ticks - 0.015) * along;
      return BladeEdge{middle - 0.012 * out, middle + 0.012 * out};
    };
    for (int i = 1; i <= ticks; ++i) CutTick(organ, blade(i - 1), blade(i), front);
  }

  void SolveAHundredTicks(const surgery::CuttableOrgan& organ, std::size_t index) {
    tissue::ConservationSettings settings = made_.conservation;
    settings.imaging_gravity = {0, 0, -9.81};
    auto& closed = settings.organs[index];
    closed.node_count = static_cast<std::uint32_t>(organ.Mesh().VertexCount());
    closed.triangles.assign(organ.Mesh().Triangles().begin(), organ.Mesh().Triangles().end());
    for (const geometry::Triangle& lid : geometry::MakeLids(organ.Mesh())) closed.triangles.push_back(lid);
    tissue::Conservation conservation(model_, settings);
    tissue::ConservationState conserved = conservation.MakeState(tissue::MakeRestState(model_));
    tissue::EquilibriumSolver solver(model_);
    tissue::SolverSettings solver_settings;
    // pulled to the left and held, under a tilted table
    const std::uint32_t held = organ.Node(17);
    state_.condition[held] = tissue::NodeCondition::kPrescribed;
    for (int tick = 0; tick < 100; ++tick) {
      if (tick < 40) state_.position[held].x += 2e-4;
      tissue::TissueLoad load;
      load.gravity = {2.0, 0, 1.0};
      const auto report =
          tissue::SolveConserving(solver, solver_settings, 1.0 / 120, conservation, load, state_, conserved);
      ASSERT_TRUE(report.is_finite) << tick;
    }
    for (std::size_t i = 0; i < state_.position.size(); ++i) {
      ASSERT_TRUE(math::IsFinite(state_.position[i])) << i;
      ASSERT_LT(math::Distance(state_.position[i], model_.rest[i]), 0.1) << i;
    }
  }

  std::uint32_t FindLowest(std::size_t index) const {
    const auto& x = patient_.organs[index].mesh.positions;
    return static_cast<std::uint32_t>(
        std::min_element(x.begin(), x.end(), [](const Vec3& a, const Vec3& b) { return a.y < b.y; }) -
        x.begin());
  }

  patient::Patient patient_;
  PatientTissue made_;
  tissue::TissueModel model_;
  tissue::TissueState state_;
  surgery::TopologyChange change_;
};

TEST_F(CutPatient, SpareNodesChangeNothing) {
  auto scene = ReadScene(std::filesystem::path(TROCAR_SOURCE_DIR) / "scenes/demonstration.json");
  const auto plain = MakePatientTissue(*scene);
  ASSERT_TRUE(plain.ok());
  EXPECT_EQ(plain->definition.springs.size(), made_.definition.springs.size());
  EXPECT_EQ(plain->definition.rest.size() + 2 * kSpare + 40, made_.definition.rest.size());
  double plain_mass = 0, mass = 0;
  for (const double each : plain->definition.mass) plain_mass += each;
  for (const double each : made_.definition.mass) mass += each;
  EXPECT_NEAR(mass / plain_mass, 1.0, 1e-12);
}

TEST_F(CutPatient, GallbladderOpens) {
  const int index = patient_.FindOrgan("gallbladder");
  ASSERT_GE(index, 0);
  auto organ = MakeOrgan(static_cast<std::size_t>(index), false);
  CutOver(organ, FindLowest(static_cast<std::size_t>(index)), 40);
  const auto report = geometry::InspectMesh(organ.Mesh().RestMesh());
  EXPECT_TRUE(report.manifold);
  EXPECT_FALSE(report.closed);
  EXPECT_GT(geometry::FindOpenings(organ.Mesh(), {}), 0u);
  SolveAHundredTicks(organ, static_cast<std::size_t>(index));
}

TEST_F(CutPatient, LiverGetsATrench) {
  const int index = patient_.FindOrgan("liver");
  ASSERT_GE(index, 0);
  auto organ = MakeOrgan(static_cast<std::size_t>(index), true);
  CutOver(organ, FindLowest(static_cast<std::size_t>(index)), 40);
  const auto report = geometry::InspectMesh(organ.Mesh().RestMesh());
  EXPECT_TRUE(report.manifold);
  EXPECT_TRUE(report.closed);
  EXPECT_GT(report.vertices, patient_.organs[static_cast<std::size_t>(index)].mesh.positions.size() + 10);
  SolveAHundredTicks(organ, static_cast<std::size_t>(index));
}

}  // namespace
}  // namespace trocar::simulation
