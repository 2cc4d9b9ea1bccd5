// SPDX-License-Identifier: Apache-2.0
#include "pressure_stiffness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "link_hierarchy.h"
#include "solver_model.h"
#include "test_systems.h"
#include "trocar/tissue/volume_constraint.h"
#include "trocar_test/threads.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

/// Two spheres apart from each other, pressed out of shape, a node of each held.
struct Spheres {
  geometry::TriangleMesh mesh = geometry::MakeSphere({0.1, -0.2, 0.05}, 0.02, 2);
  std::uint32_t size = static_cast<std::uint32_t>(mesh.positions.size());
  TissueModel model;
  TissueState state;
  std::vector<PressedSurface> surfaces;
  static constexpr double kPressure[] = {700.0, -150.0};

  Spheres() {
    TissueDefinition definition = MakeMembrane(mesh, 100.0, 1e4);
    const TissueDefinition one = definition;
    for (const Vec3& p : one.rest) definition.rest.push_back(p + Vec3{0.05, 0, 0});
    definition.mass.insert(definition.mass.end(), one.mass.begin(), one.mass.end());
    definition.shape_stiffness.insert(definition.shape_stiffness.end(), one.shape_stiffness.begin(),
                                      one.shape_stiffness.end());
    for (auto spring : one.springs) {
      spring.a += size, spring.b += size;
      definition.springs.push_back(spring);
    }
    model = MakeTissueModel(definition);
    state = MakeRestState(model);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> offset(-1e-3, 1e-3);
    for (Vec3& p : state.position) p += {offset(random), offset(random), offset(random)};
    state.condition[3] = state.condition[size + 7] = NodeCondition::kPrescribed;
    surfaces = {{0, mesh.triangles}, {size, mesh.triangles}};
  }
};

/// The follower stiffness of one state, in the solvers' order.
struct Follower {
  SolverModel made;
  const OrderedModel& model = made.ordered;
  OrderedLoad load;
  LinkHierarchy hierarchy;
  PressureStiffness pressure;
  std::vector<Double4> position;
  Workers workers;
  const Kernels& kernels;

  Follower(const Spheres& from, base::SimdLevel level, int threads = 1)
      : made(MakeSolverModel(from.model)),
        hierarchy(made.hierarchy, model.graph),
        pressure(model),
        workers(test::UseThreads(threads)),
        kernels(GetKernels(level)) {
    load.constant.resize(model.Size()), load.is_free.resize(model.Size());
    SetOrderedLoad(model, {}, from.state, load);
    for (std::uint32_t i = 0; i < model.Size(); ++i)
      hierarchy.Finest().is_free[i] = load.is_free[i] ? 1.0f : 0.0f;
    position.resize(model.layout.PaddedNodes());
    for (std::uint32_t i = 0; i < model.Size(); ++i) {
      const Vec3& p = from.state.position[model.old_of_new[i]];
      position[i] = {p.x, p.y, p.z, 0.0};
    }
    pressure.SetSurfaces(from.surfaces);
    pressure.Update(kernels, workers, Spheres::kPressure, position);
  }
  /// K x, in the caller's order.
  std::vector<Vec3> Multiply(const std::vector<Vec3>& x) {
    math::AlignedVector<Float4> direction(position.size()), product(position.size());
    for (std::uint32_t i = 0; i < model.Size(); ++i) {
      const Vec3& v = x[model.old_of_new[i]];
      direction[i] = {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), 0.0f};
    }
    RunPass(kernels, workers, hierarchy.Finest(), LinkPass::kFollower, direction.data(), nullptr, 0.0f,
            product.data(), pressure.FollowerStiffness());
    std::vector<Vec3> out(x.size());
    for (std::uint32_t i = 0; i < model.Size(); ++i)
      out[model.old_of_new[i]] = {product[i].x, product[i].y, product[i].z};
    return out;
  }
};

std::vector<Vec3> MakeDirection(const Spheres& spheres) {
  std::vector<Vec3> direction;
  std::mt19937 random(6);
  std::uniform_real_distribution<float> part(-1, 1);
  for (std::size_t i = 0; i < spheres.model.Size(); ++i) {
    const bool is_held = spheres.state.condition[i] == NodeCondition::kPrescribed;
    direction.push_back(is_held ? Vec3{} : Vec3{part(random), part(random), part(random)});
  }
  return direction;
}

// Oracle: what pressures do to the nodes, P dV/dx, before and after. It is of second degree in the positions, so that
// differences about the middle are exact.
TEST(PressureStiffness, IsTheDerivativeOfWhatPressuresDo) {
  const Spheres spheres;
  const std::vector<Vec3> direction = MakeDirection(spheres);
  const double by = 1e-4;
  const auto calc_force = [&](double share) {
    std::vector<Vec3> position = spheres.state.position, force(position.size());
    for (std::size_t i = 0; i < position.size(); ++i) position[i] += share * by * direction[i];
    for (std::size_t c = 0; c < 2; ++c) {
      const auto part = [&](std::vector<Vec3>& v) {
        return std::span(v).subspan(c * spheres.size, spheres.size);
      };
      (void)CalcVolumeGradient(part(position), spheres.mesh.triangles, part(force));
      for (Vec3& f : part(force)) f = Spheres::kPressure[c] * f;
    }
    return force;
  };
  const std::vector<Vec3> before = calc_force(-1.0), after = calc_force(1.0);
  double largest = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    largest = std::fmax(largest, math::Distance(before[i], after[i]) / (2 * by));
  ASSERT_GT(largest, 1.0);
  for (const base::SimdLevel level : Levels()) {
    const std::vector<Vec3> product = Follower(spheres, level).Multiply(direction);
    for (std::size_t i = 0; i < product.size(); ++i) {
      const bool is_held = spheres.state.condition[i] == NodeCondition::kPrescribed;
      const Vec3 wanted = is_held ? Vec3{} : (before[i] - after[i]) / (2 * by);
      ASSERT_LT(math::Distance(product[i], wanted), 1e-5 * largest)
          << base::SimdLevelName(level) << " node " << i;
    }
  }
}

TEST(PressureStiffness, IsTheSameForAnyThreadsAndWideVectors) {
  const Spheres spheres;
  const std::vector<Vec3> direction = MakeDirection(spheres);
  const std::vector<Vec3> one = Follower(spheres, base::SimdLevel::kBaseline).Multiply(direction);
  for (const base::SimdLevel level : Levels()) {
    for (const int threads : {1, 3})
      EXPECT_EQ(Follower(spheres, level, threads).Multiply(direction), one) << base::SimdLevelName(level);
  }
}

// A cut gives a surface other triangles; the same ones are not looked at again.
TEST(PressureStiffness, FollowsItsSurfaces) {
  Spheres spheres;
  const std::vector<Vec3> direction = MakeDirection(spheres);
  Follower follower(spheres, base::FindSimdLevel());
  const std::vector<Vec3> product = follower.Multiply(direction);
  const auto update = [&] {
    follower.pressure.SetSurfaces(spheres.surfaces);
    follower.pressure.Update(follower.kernels, follower.workers, Spheres::kPressure, follower.position);
    return follower.Multiply(direction);
  };
  EXPECT_EQ(update(), product);

  std::vector<geometry::Triangle> inside_out = spheres.mesh.triangles;
  for (auto& triangle : inside_out) std::swap(triangle[0], triangle[1]);
  spheres.surfaces[0].triangles = inside_out;
  const std::vector<Vec3> turned_over = update();
  for (std::size_t i = 0; i < product.size(); ++i)
    ASSERT_EQ(turned_over[i], i < spheres.size ? -product[i] : product[i]) << i;

  // around a hole three edges have one triangle each: they are left out, with their neighbours' answer to them
  const auto lost = spheres.mesh.triangles.back();
  spheres.surfaces[0].triangles = std::span(spheres.mesh.triangles).first(spheres.mesh.triangles.size() - 1);
  const std::vector<Vec3> open = update();
  for (std::size_t i = 0; i < product.size(); ++i) {
    const bool is_corner = std::ranges::find(lost, i) != lost.end();
    ASSERT_EQ(open[i] == product[i], !is_corner) << i;
  }

  constexpr double kNone[] = {0.0, 0.0};
  follower.pressure.Update(follower.kernels, follower.workers, kNone, follower.position);
  EXPECT_EQ(follower.pressure.FollowerStiffness(), nullptr);
}

}  // namespace
}  // namespace trocar::tissue
