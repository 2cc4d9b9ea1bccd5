// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/linear_response.h"

#include <gtest/gtest.h>

#include <cmath>

#include "test_systems.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

// Oracle: the residual of the whole model, moved by a little of the answer, falls by as much of the force.
TEST(LinearResponse, IsTheAnswerOfTheModelToASmallForce) {
  const auto mesh = geometry::MakeSphere({0, 0, 0}, 0.03, 2);
  TissueDefinition definition = MakeMembrane(mesh, 100.0, 3e4);
  definition.fixed = {3, 4};
  definition.strands = {{5, 90, 40.0}};
  const TissueModel model = MakeTissueModel(definition);
  TissueState state = MakeRestState(model);
  const TissueLoad load{.stiffness_scale = 1.5, .shape_scale = 0.7};
  std::vector<Vec3> force(model.Size()), response(model.Size());
  for (std::size_t i = 0; i < force.size(); ++i) {
    const auto x = static_cast<double>(i);
    force[i] = {std::sin(x), std::cos(2 * x), std::sin(3 * x)};
  }
  LinearResponse linear(model);
  linear.SetStiffness(state, load);
  const LinearReport report = linear.Solve(force, 2000, 1e-10, response);
  EXPECT_LE(report.residual, 1e-10) << report.iterations;
  EXPECT_EQ(response[3], Vec3{}) << "fixed nodes stay";
  const double step = 1e-7;
  for (std::size_t i = 0; i < model.Size(); ++i) state.position[i] += step * response[i];
  std::vector<Vec3> residual(model.Size());
  CalcResidual(model, state, load, residual);
  for (std::size_t i = 0; i < model.Size(); ++i) {
    if (model.is_fixed[i]) continue;
    EXPECT_LT(math::Distance(residual[i] / -step, force[i]), 1e-3) << i;
  }
}

// Where only strands have parted, the short way is the long one, bit for bit.
TEST(LinearResponse, FollowsStrandsAsIfTheWholeStiffnessWereTaken) {
  TissueDefinition definition = MakeMembrane(geometry::MakeSphere({0, 0, 0}, 0.03, 2), 100.0, 3e4);
  definition.fixed = {3, 4};
  definition.strands = {{5, 90, 40.0}, {5, 60, 30.0}, {3, 70, 20.0}};
  const TissueModel model = MakeTissueModel(definition);
  TissueState state = MakeRestState(model);
  const TissueLoad load{.stiffness_scale = 1.5, .shape_scale = 0.7};
  const std::vector<Vec3> force(model.Size(), Vec3{0, 0.5, 1});
  const auto answer = [&](LinearResponse& linear) {
    std::vector<Vec3> response(model.Size());
    (void)linear.Solve(force, 20, 0.0, response);
    return response;
  };
  LinearResponse followed(model), anew(model);
  followed.SetStiffness(state, load);
  const auto whole = answer(followed);
  state.strand_is_intact[0] = 0, state.strand_is_intact[2] = 0;
  followed.FollowStrands(state, load);
  anew.SetStiffness(state, load);
  const auto parted = answer(followed);
  EXPECT_EQ(parted, answer(anew));
  EXPECT_NE(parted, whole) << "negative control";
}

TEST(LinearResponse, AGoodFirstGuessNeedsNoIteration) {
  const TissueModel model =
      MakeTissueModel(MakeMembrane(geometry::MakeSphere({0, 0, 0}, 0.03, 1), 100.0, 3e4));
  const TissueState state = MakeRestState(model);
  const std::vector<Vec3> force(model.Size(), Vec3{0, 0, 1});
  std::vector<Vec3> response(model.Size());
  LinearResponse linear(model);
  linear.SetStiffness(state, {});
  EXPECT_GT(linear.Solve(force, 1000, 1e-9, response).iterations, 0);
  EXPECT_EQ(linear.Solve(force, 1000, 1e-8, response).iterations, 0);
  EXPECT_EQ(linear.Solve(std::vector<Vec3>(model.Size()), 1000, 1e-8, response).iterations, 0);
  EXPECT_EQ(response[0], Vec3{}) << "no force, no answer";
}

}  // namespace
}  // namespace trocar::tissue
