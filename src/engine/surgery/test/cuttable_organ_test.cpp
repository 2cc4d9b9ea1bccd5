// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/cuttable_organ.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "cuttable_fixture.h"
#include "trocar/geometry/openings.h"
#include "trocar/geometry/primitives.h"
#include "trocar/math/random.h"

namespace trocar::surgery {
namespace {

constexpr WallMaterial kWall{510.0, 0.4, 2e4, 2.0};

std::map<geometry::Edge, tissue::Spring> BySprings(const std::vector<tissue::Spring>& springs) {
  std::map<geometry::Edge, tissue::Spring> map;
  for (const tissue::Spring& spring : springs) {
    EXPECT_TRUE(
        map.emplace(geometry::Edge{std::min(spring.a, spring.b), std::max(spring.a, spring.b)}, spring)
            .second);
  }
  return map;
}

// Oracle: after any number of cuts the system is the one that would be made from the cut mesh anew.
TEST(CuttableOrgan, ChangesAddUpToTheCutMesh) {
  CuttableSystem system(geometry::MakeSphere({}, 0.03, 2), kWall, {});
  math::Random random(3);
  std::size_t opened = 0;
  for (int stroke = 0; stroke < 12; ++stroke) {
    const double z = random.Uniform(-0.02, 0.02), y = random.Uniform(-0.02, 0.0);
    const double side = random.Uniform() < 0.5 ? -1 : 1;
    opened += system.CutLine({{side * 0.01, y, z}, {side * 0.04, y, z}},
                             {{side * 0.01, y + 0.02, z + 0.004}, {side * 0.04, y + 0.02, z + 0.004}}, 6);
  }
  ASSERT_GT(opened, 40u);
  const auto& mesh = system.organ->Mesh();
  const geometry::TriangleMesh now = mesh.RestMesh();
  auto anew = CalcWallSprings(now, kWall);
  for (auto& spring : anew) spring.a = system.organ->Node(spring.a), spring.b = system.organ->Node(spring.b);
  const auto expected = BySprings(anew), found = BySprings(system.definition.springs);
  ASSERT_EQ(found.size(), expected.size());
  for (const auto& [pair, spring] : expected) {
    ASSERT_TRUE(found.count(pair));
    EXPECT_NEAR(found.at(pair).stiffness / spring.stiffness, 1.0, 1e-9);
    EXPECT_NEAR(found.at(pair).rest_length, spring.rest_length, 1e-15);
  }
  const auto areas = geometry::CalcVertexAreas(now.positions, now.triangles);
  for (std::uint32_t v = 0; v < areas.size(); ++v) {
    EXPECT_NEAR(system.definition.mass[system.organ->Node(v)], kWall.mass_by_area * areas[v], 1e-15);
    EXPECT_NEAR(system.definition.shape_stiffness[system.organ->Node(v)], kWall.foundation * areas[v], 1e-12);
  }
}

double SumMass(const tissue::TissueDefinition& definition) {
  double sum = 0;
  for (const double mass : definition.mass) sum += mass;
  return sum;
}

TEST(CuttableOrgan, ATrenchMakesNoMass) {
  geometry::CutSettings cut;
  cut.has_walls = true;
  cut.depth = 0.004;
  CuttableSystem system(geometry::MakeSphere({}, 0.03, 3), kWall, cut);
  const double mass = SumMass(system.definition);
  ASSERT_GT(system.CutLine({{0.02, -0.01, 0.001}, {0.04, -0.01, 0.001}},
                           {{0.02, 0.01, 0.001}, {0.04, 0.01, 0.001}}, 25),
            8u);
  EXPECT_NEAR(SumMass(system.definition) / mass, 1.0, 1e-12);
  // the bottom is held by what lies below it
  const auto& mesh = system.organ->Mesh();
  for (std::uint32_t v = 0; v < mesh.VertexCount(); ++v) {
    if (mesh.Sources()[v].origin != geometry::VertexOrigin::kTrench) continue;
    EXPECT_GT(system.definition.shape_stiffness[system.organ->Node(v)], 0.0);
  }
}

/// Force with which a sheet of 60 x 40 mm resists when its ends are drawn 3 mm apart along x.
double CalcPull(CuttableSystem& system) {
  std::vector<std::uint32_t> right;
  const auto& mesh = system.organ->Mesh();
  system.state = tissue::MakeRestState(system.model);
  for (std::uint32_t v = 0; v < mesh.VertexCount(); ++v) {
    const double x = mesh.Rest()[v].x;
    if (x > 0.001 && x < 0.059) continue;
    const std::uint32_t node = system.organ->Node(v);
    system.state.condition[node] = tissue::NodeCondition::kPrescribed;
    if (x >= 0.059) {
      system.state.position[node].x += 0.003;
      right.push_back(node);
    }
  }
  tissue::EquilibriumSolver solver(system.model);
  tissue::SolverSettings settings;
  for (int tick = 0; tick < 40; ++tick) solver.Solve(settings, {}, system.state);
  return math::Norm(solver.CalcReaction({}, system.state, right));
}

geometry::TriangleMesh MakeSheet() {
  geometry::TriangleMesh mesh = geometry::MakeTriangularLattice(16, 12, 0.004);
  return mesh;
}

// Analytic: a slit along the pull leaves a sheet as stiff as it was; one across half of it does not.
TEST(CuttableOrgan, ASlitAlongThePullKeepsTheStiffness) {
  const WallMaterial wall{510.0, 0.0, 0.01, 1.0};
  CuttableSystem whole(MakeSheet(), wall, {}), along(MakeSheet(), wall, {}), across(MakeSheet(), wall, {});
  ASSERT_GT(along.CutLine(Upright(0.0121, 0.0187), Upright(0.0473, 0.0187), 30), 8u);
  ASSERT_GT(across.CutLine(Upright(0.0311, -0.001), Upright(0.0311, 0.022), 30), 5u);
  const double force = CalcPull(whole), force_along = CalcPull(along), force_across = CalcPull(across);
  EXPECT_GT(force, 0.1);
  EXPECT_NEAR(force_along / force, 1.0, 0.02);
  EXPECT_LT(force_across, 0.8 * force);
  EXPECT_GT(force_across, 0.2 * force);
}

// Negative control of the one above: a sheet cut right through carries nothing.
TEST(CuttableOrgan, TwoPiecesCarryNoForce) {
  const WallMaterial wall{510.0, 0.2, 0.0, 1.0};
  CuttableSystem system(MakeSheet(), wall, {});
  system.CutLine(Upright(0.0311, -0.01), Upright(0.0311, 0.05), 30);
  EXPECT_LT(CalcPull(system), 1e-3);  // newtons; the whole sheet takes more than 0.1
}

// The solver goes on with the new model, whatever is cut and drawn.
class CutAndSolve : public testing::TestWithParam<bool> {};

TEST_P(CutAndSolve, AHundredTicksAfterEveryStrokeAreFinite) {
  math::Random random(11);
  for (int round = 0; round < 3; ++round) {
    geometry::CutSettings cut;
    cut.has_walls = GetParam();
    cut.depth = 0.004;
    CuttableSystem system(geometry::MakeSphere({}, 0.03, 2), kWall, cut);
    for (int stroke = 0; stroke < 3; ++stroke) {
      const double z = random.Uniform(-0.02, 0.02), y = random.Uniform(-0.02, 0.0);
      system.CutLine({{0.01, y, z}, {0.05, y, z}}, {{0.01, y + 0.02, z + 0.006}, {0.05, y + 0.02, z + 0.006}},
                     8);
      tissue::EquilibriumSolver solver(system.model);
      tissue::SolverSettings settings;
      settings.max_iterations = 20;
      const auto held = static_cast<std::uint32_t>(random.Uniform() * 162);
      system.state.condition[held] = tissue::NodeCondition::kPrescribed;
      for (int tick = 0; tick < 100; ++tick) {
        system.state.position[held] += math::Vec3{1e-4, 0, 5e-5};
        const auto report = solver.Solve(settings, {}, system.state);
        ASSERT_TRUE(report.is_finite);
      }
      system.state.condition[held] = tissue::NodeCondition::kFree;
      for (const math::Vec3& p : system.state.position) {
        ASSERT_TRUE(math::IsFinite(p));
        ASSERT_LT(math::Norm(p), 0.2);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OpenAndWalls, CutAndSolve, testing::Bool());

TEST(CuttableOrgan, SpringsInheritFromTheOneTheyArePartOf) {
  CuttableSystem system(MakeSheet(), kWall, {});
  std::map<geometry::Edge, tissue::Spring> before = BySprings(system.definition.springs);
  system.Cut(Upright(-0.01, 0.0187), Upright(0.07, 0.0187));
  std::size_t inherited = 0, fresh = 0;
  for (const SpringChange& spring : system.change.springs) {
    EXPECT_LT(spring.a, spring.b);
    if (spring.inherits[0] == geometry::kNone) {
      ++fresh;
    } else {
      ++inherited;
      EXPECT_TRUE(before.count({spring.inherits[0], spring.inherits[1]}) || spring.stiffness == 0.0);
    }
  }
  EXPECT_GT(inherited, 30u);
  EXPECT_GT(fresh, 10u);
}

// What was weakened before stays weak: the parts of a torn edge are torn.
TEST(CuttableOrgan, PartsOfAWeakSpringAreWeak) {
  CuttableSystem system(MakeSheet(), kWall, {});
  for (std::size_t i = 0; i < system.state.spring_factor.size(); ++i) {
    system.state.spring_factor[i] = system.definition.springs[i].a % 2 == 0 ? 0.25 : 0.5;
    system.state.spring_damage[i] = system.state.spring_factor[i] / 2;
  }
  system.Cut(Upright(-0.01, 0.0187), Upright(0.07, 0.0187));
  ASSERT_EQ(system.state.spring_factor.size(), system.definition.springs.size());
  std::size_t weak = 0, fresh = 0;
  for (std::size_t i = 0; i < system.definition.springs.size(); ++i) {
    const tissue::Spring& spring = system.definition.springs[i];
    const double factor = system.state.spring_factor[i];
    if (factor == 1.0) {
      ++fresh;
      EXPECT_GE(std::max(spring.a, spring.b), 16u * 12u) << "only springs of new nodes are whole";
      EXPECT_EQ(system.state.spring_damage[i], 0.0);
    } else {
      ++weak;
      EXPECT_EQ(system.state.spring_damage[i], factor / 2);
      const bool is_old = spring.a < 16 * 12 && spring.b < 16 * 12;
      EXPECT_TRUE(!is_old || factor == (spring.a % 2 == 0 ? 0.25 : 0.5));
    }
  }
  EXPECT_GT(fresh, 10u);
  EXPECT_GT(weak, 500u);
}

TEST(CuttableOrgan, NewNodesOnFixedEdgesAreFixed) {
  CuttableSystem system(MakeSheet(), kWall, {});
  for (std::uint32_t v = 0; v < 16 * 12; ++v) system.definition.fixed.push_back(v);
  system.Cut(Upright(-0.01, 0.0187), Upright(0.07, 0.0187));
  const std::size_t count = system.organ->Mesh().VertexCount();
  ASSERT_GT(count, 16u * 12u + 20u);
  for (std::uint32_t v = 0; v < count; ++v) EXPECT_EQ(system.model.is_fixed[system.organ->Node(v)], 1);
}

TEST(CuttableOrgan, ASolidOrganMustBeClosed) {
  CuttableOrganSettings settings;
  settings.cut.has_walls = true;
  settings.spare_count = 10;
  EXPECT_EQ(CuttableOrgan::Make(MakeSheet(), settings).error().code, base::ErrorCode::kMeshNotClosed);
}

}  // namespace
}  // namespace trocar::surgery
