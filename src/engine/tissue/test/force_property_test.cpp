// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <vector>

#include "test_systems.h"
#include "trocar/math/random.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

struct RandomSystem {
  TissueModel model;
  TissueState state;
  std::vector<ContactSpring> contacts;
  std::vector<Vec3> external;

  TissueLoad Load() const {
    return {.gravity = {0.3, -9, 1},
            .stiffness_scale = 1.3,
            .shape_scale = 0.7,
            .contacts = contacts,
            .external_force = external};
  }
};

RandomSystem MakeRandomSystem(std::uint64_t seed) {
  math::Random random(seed);
  const auto vector = [&](double size) {
    return Vec3{random.Uniform(-size, size), random.Uniform(-size, size), random.Uniform(-size, size)};
  };
  const auto mesh = geometry::MakeSphere({0, 0, 0}, 0.03, 1);
  TissueDefinition definition = MakeMembrane(mesh, 100.0, 2e4);
  definition.strands = {{0, 20, 30.0}, {5, 30, 10.0}, {6, 31, 20.0}};
  RandomSystem system{MakeTissueModel(definition), {}, {}, {}};
  system.state = MakeRestState(system.model);
  system.state.strand_is_intact[1] = 0;
  for (Vec3& p : system.state.position) p += vector(0.004);
  for (std::size_t i = 0; i < system.model.Size(); ++i) system.external.push_back(vector(0.1));
  ContactSpring pressing{{1, 2, 3}, {0.2, 0.3, 0.5}, math::Normalized(vector(1)), 0, 300.0};
  pressing.offset = CalcContactDepth(pressing, system.state.position) * -1.0 + 0.004;
  ContactSpring open = pressing;
  open.offset = -1.0;
  system.contacts = {pressing, open};
  return system;
}

// Property: the force is minus the gradient of the energy, by central differences.
TEST(CalcResidual, IsMinusTheGradientOfTheEnergy) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    RandomSystem system = MakeRandomSystem(seed);
    std::vector<Vec3> residual(system.model.Size());
    CalcResidual(system.model, system.state, system.Load(), residual);
    for (std::size_t node = 0; node < system.model.Size(); node += 3) {
      for (int axis = 0; axis < 3; ++axis) {
        const double h = 1e-7, x = system.state.position[node][axis];
        system.state.position[node][axis] = x + h;
        const double above = CalcEnergy(system.model, system.state, system.Load());
        system.state.position[node][axis] = x - h;
        const double below = CalcEnergy(system.model, system.state, system.Load());
        system.state.position[node][axis] = x;
        EXPECT_NEAR(residual[node][axis], -(above - below) / (2 * h), 1e-5)
            << "seed " << seed << " node " << node;
      }
    }
  }
}

// Property: springs and strands act and react, so without supports the forces of a free system sum to
// nothing.
TEST(CalcResidual, InnerForcesSumToZero) {
  RandomSystem system = MakeRandomSystem(9);
  std::vector<Vec3> residual(system.model.Size());
  CalcResidual(system.model, system.state, {.shape_scale = 0.0}, residual);
  Vec3 sum;
  for (const Vec3& f : residual) sum += f;
  EXPECT_NEAR(math::Norm(sum), 0.0, 1e-12);
}

}  // namespace
}  // namespace trocar::tissue
