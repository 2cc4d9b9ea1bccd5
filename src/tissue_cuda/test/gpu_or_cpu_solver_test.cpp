// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue_cuda/gpu_or_cpu_solver.h"

#include <gtest/gtest.h>

#include "check_systems.h"
#include "gpu_solve.h"
#include "stand_in.h"

namespace trocar::tissue_cuda {
namespace {

using tissue::SolverKind;
using tissue::SolverSettings;
using tissue::TissueModel;
using tissue::TissueState;

TissueModel MakeModel() {
  return tissue::MakeTissueModel(MakeScatteredSphere(2, Springs::kVaried, 0.03));
}
const tissue::TissueLoad kLoad{.gravity = {0, 0, -0.3}};

TEST(GpuOrCpuSolver, WithoutAGpuGivesTheProcessorsBits) {
  const TissueModel model = MakeModel();
  DriverSource nowhere = StandIn::Source();
  nowhere.library = "/nonexistent/libcuda.so.1";
  GpuOrCpuSolver solver(model, 1, MakeGpuSolver(model, {}, nowhere));
  EXPECT_EQ(solver.Gpu(), nullptr);
  ASSERT_TRUE(solver.GpuError());
  EXPECT_EQ(solver.GpuError()->code, core::ErrorCode::kGpuMissing);
  TissueState expected = MakeMovedState(model, 3e-4), found = expected;
  tissue::EquilibriumSolver cpu(model, 1);
  (void)cpu.Solve({}, kLoad, expected);
  (void)solver.Solve({}, kLoad, found);
  EXPECT_EQ(found.position, expected.position);
}

TEST(GpuOrCpuSolver, DoesNotAskForAGpuThatNobodyWants) {
  const TissueModel model = MakeModel();
  const GpuOrCpuSolver solver(model, 1, std::nullopt);
  EXPECT_EQ(solver.Gpu(), nullptr);
  EXPECT_FALSE(solver.GpuError());
}

// Fault G2: the tick in which the GPU fails is solved by the processor, from where it began.
TEST(GpuOrCpuSolver, TheProcessorGoesOnInTheTickInWhichTheGpuFails) {
  const TissueModel model = MakeModel();
  for (int fails_at = 1; fails_at <= 4; ++fails_at) {
    const StandIn stand_in("fail=cuLaunchCooperativeKernel:" + std::to_string(fails_at) + ":700");
    GpuOrCpuSolver solver(model, 1, MakeGpuSolver(model, {}, StandIn::Source()));
    ASSERT_NE(solver.Gpu(), nullptr);
    TissueState state = MakeMovedState(model, 3e-4);
    for (int tick = 1; tick <= 5; ++tick) {
      TissueState expected = state;
      tissue::EquilibriumSolver cpu(model, 1);
      const auto wanted = cpu.Solve({}, kLoad, expected);
      const auto report = solver.Solve({}, kLoad, state);
      EXPECT_EQ(solver.Gpu() != nullptr, tick < fails_at);
      if (tick < fails_at) {
        EXPECT_LT(CalcLargestDistance(state.position, expected.position), 1e-6);
      } else {
        EXPECT_EQ(state.position, expected.position) << tick;
        EXPECT_EQ(report.iterations, wanted.iterations);
        ASSERT_TRUE(solver.GpuError());
        EXPECT_EQ(solver.GpuError()->code, core::ErrorCode::kGpuFailed);
      }
    }
  }
}

TEST(GpuOrCpuSolver, OnlyTheChebyshevIterationGoesToTheGpu) {
  const StandIn stand_in("fail=cuLaunchCooperativeKernel:1:700");
  const TissueModel model = MakeModel();
  GpuOrCpuSolver solver(model, 1, MakeGpuSolver(model, {}, StandIn::Source()));
  TissueState state = MakeMovedState(model, 3e-4);
  (void)solver.Solve({SolverKind::kRelaxationPaper, 3, 1e-9, 0.0}, kLoad, state);
  EXPECT_NE(solver.Gpu(), nullptr);  // it was not asked, so it did not fail
  (void)solver.Solve({}, kLoad, state);
  EXPECT_EQ(solver.Gpu(), nullptr);
}

TEST(GpuOrCpuSolver, ReactionIsTheProcessors) {
  const TissueModel model = MakeModel();
  const GpuOrCpuSolver solver(model, 1, std::nullopt);
  const tissue::EquilibriumSolver cpu(model, 1);
  const TissueState state = MakeMovedState(model, 3e-4);
  const std::uint32_t nodes[] = {0, 7, 5};
  EXPECT_EQ(solver.CalcReaction(kLoad, state, nodes), cpu.CalcReaction(kLoad, state, nodes));
}

}  // namespace
}  // namespace trocar::tissue_cuda
