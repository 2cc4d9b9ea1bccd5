// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue_cuda/gpu_or_cpu_solver.h"

#include <gtest/gtest.h>

#include "check_systems.h"
#include "gpu_solve.h"
#include "stand_in.h"
#include "trocar/tissue/element_kinds.h"

namespace trocar::tissue_cuda {

using math::Vec3;

namespace {

using tissue::SolverKind;
using tissue::SolverSettings;
using tissue::TissueModel;
using tissue::TissueState;

TissueModel MakeModel() {
  return tissue::MakeTissueModel(MakeScatteredSphere(2, Springs::kVaried, 0.03));
}
const tissue::TissueLoad kLoad{.gravity = {0, 0, -0.3}};
const SolverSettings kChebyshev{.kind = SolverKind::kChebyshevJacobi2015};

TEST(GpuOrCpuSolver, WithoutAGpuGivesTheProcessorsBits) {
  const TissueModel model = MakeModel();
  DriverSource nowhere = StandIn::Source();
  nowhere.file = "/nonexistent/libcuda.so.1";
  GpuOrCpuSolver solver(model, base::Threads{}, MakeGpuSolver(model, {}, nowhere));
  EXPECT_EQ(solver.Gpu(), nullptr);
  ASSERT_TRUE(solver.GpuError());
  EXPECT_EQ(solver.GpuError()->code, base::ErrorCode::kGpuMissing);
  TissueState expected = MakeMovedState(model, 3e-4), found = expected;
  tissue::EquilibriumSolver cpu(model);
  (void)cpu.Solve(kChebyshev, kLoad, expected);
  (void)solver.Solve(kChebyshev, kLoad, found);
  EXPECT_EQ(found.position, expected.position);
}

// Fault G2: the tick in which the GPU fails is solved by the processor, from where it began.
TEST(GpuOrCpuSolver, TheProcessorGoesOnInTheTickInWhichTheGpuFails) {
  const TissueModel model = MakeModel();
  for (int fails_at = 1; fails_at <= 4; ++fails_at) {
    const StandIn stand_in("fail=cuLaunchCooperativeKernel:" + std::to_string(fails_at) + ":700");
    GpuOrCpuSolver solver(model, base::Threads{}, MakeGpuSolver(model, {}, StandIn::Source()));
    ASSERT_NE(solver.Gpu(), nullptr);
    TissueState state = MakeMovedState(model, 3e-4);
    for (int tick = 1; tick <= 5; ++tick) {
      TissueState expected = state;
      tissue::EquilibriumSolver cpu(model);
      const auto wanted = cpu.Solve(kChebyshev, kLoad, expected);
      const auto report = solver.Solve(kChebyshev, kLoad, state);
      EXPECT_EQ(solver.Gpu() != nullptr, tick < fails_at);
      if (tick < fails_at) {
        EXPECT_LT(CalcLargestDistance(state.position, expected.position), 1e-6);
      } else {
        EXPECT_EQ(state.position, expected.position) << tick;
        EXPECT_EQ(report.iterations, wanted.iterations);
        ASSERT_TRUE(solver.GpuError());
        EXPECT_EQ(solver.GpuError()->code, base::ErrorCode::kGpuFailed);
      }
    }
  }
}

TEST(GpuOrCpuSolver, CutSpringsAreSolvedOnTheProcessorAndTheGpuIsKept) {
  const StandIn stand_in;
  const TissueModel model = MakeModel();
  GpuOrCpuSolver solver(model, base::Threads{}, MakeGpuSolver(model, {}, StandIn::Source()));
  ASSERT_NE(solver.Gpu(), nullptr);
  TissueState state = MakeMovedState(model, 3e-4);
  state.spring_factor[5] = 0.0;
  TissueState expected = state;
  tissue::EquilibriumSolver cpu(model);
  (void)cpu.Solve(kChebyshev, kLoad, expected);
  (void)solver.Solve(kChebyshev, kLoad, state);
  EXPECT_EQ(state.position, expected.position);
  EXPECT_NE(solver.Gpu(), nullptr);
  // asked directly, the GPU's solver says no instead of solving another tissue
  base::Result<GpuSolver> alone = MakeGpuSolver(model, {}, StandIn::Source());
  ASSERT_TRUE(alone);
  EXPECT_EQ(alone->Solve(MakeGpuSettings(kChebyshev), kLoad, state).error().code,
            base::ErrorCode::kGpuLayout);
}

TEST(GpuOrCpuSolver, ElementsAreSolvedOnTheProcessorAndTheGpuIsKept) {
  const StandIn stand_in;
  const TissueModel model = MakeModel();
  GpuOrCpuSolver solver(model, base::Threads{}, MakeGpuSolver(model, {}, StandIn::Source()));
  ASSERT_NE(solver.Gpu(), nullptr);
  TissueState state = MakeMovedState(model, 3e-4), expected = state, other = state;
  tissue::ElementArrays elements;
  elements.Of<tissue::AnchorElement>().push_back({.nodes = {7}, .stiffness = 20.0, .anchor = model.rest[9]});
  tissue::TissueLoad load = kLoad;
  load.elements = &elements;
  tissue::EquilibriumSolver cpu(model);
  (void)cpu.Solve(kChebyshev, load, expected);
  (void)solver.Solve(kChebyshev, load, state);
  EXPECT_EQ(state.position, expected.position);
  (void)cpu.Solve(kChebyshev, kLoad, other);
  EXPECT_NE(state.position, other.position) << "the element does nothing";
  EXPECT_NE(solver.Gpu(), nullptr);
  base::Result<GpuSolver> alone = MakeGpuSolver(model, {}, StandIn::Source());
  ASSERT_TRUE(alone);
  EXPECT_EQ(alone->Solve(MakeGpuSettings(kChebyshev), load, state).error().code, base::ErrorCode::kGpuLayout);
}

TEST(GpuOrCpuSolver, SpringsThatStiffenAreRefused) {
  const StandIn stand_in;
  auto definition = MakeScatteredSphere(2, Springs::kVaried, 0.03);
  definition.laws.push_back({.stiffening = 5.0});
  definition.springs[0].law = 1;
  const TissueModel model = tissue::MakeTissueModel(definition);
  const base::Result<GpuSolver> made = MakeGpuSolver(model, {}, StandIn::Source());
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, base::ErrorCode::kGpuLayout);
}

TEST(GpuOrCpuSolver, TheChebyshevIterationAndAnOpenChoiceGoToTheGpu) {
  const StandIn stand_in("fail=cuLaunchCooperativeKernel:1:700");
  const TissueModel model = MakeModel();
  GpuOrCpuSolver solver(model, base::Threads{}, MakeGpuSolver(model, {}, StandIn::Source()));
  TissueState state = MakeMovedState(model, 3e-4);
  (void)solver.Solve({SolverKind::kRelaxationPaper, 3, 1e-9, 0.0}, kLoad, state);
  EXPECT_NE(solver.Gpu(), nullptr);  // it was not asked, so it did not fail
  (void)solver.Solve({.kind = SolverKind::kAdaptive}, kLoad, state);
  EXPECT_EQ(solver.Gpu(), nullptr);
}

/// Constraints as the conservation of volumes has them: moves every free node, its past alike, and changes a force.
struct Shift final : tissue::ConstraintSet {
  explicit Shift(std::size_t nodes, int interval_in) : force(nodes), interval(interval_in) {}

  void Project(TissueState& state, std::span<Vec3> before) noexcept override {
    ++calls;
    for (std::size_t i = 0; i < state.position.size(); ++i) {
      if (state.condition[i] == tissue::NodeCondition::kPrescribed) continue;
      const Vec3 move{1e-5 * static_cast<double>(i % 3), 0, -2e-5};
      state.position[i] += move;
      if (!before.empty()) before[i] += move;
    }
    force[static_cast<std::size_t>(calls) % force.size()] += Vec3{0, 1e-3, 0};
  }
  int Interval() const noexcept override { return interval; }

  std::vector<Vec3> force;
  int interval, calls = 0;
};

// The solve is interrupted at every interval, on the GPU as on the processor, and goes on where it was.
TEST(GpuOrCpuSolver, CallsTheConstraintsBetweenTheSameIterationsAsTheProcessor) {
  const TissueModel model = MakeModel();
  for (const int interval : {1, 5, 7}) {
    for (const int iterations : {1, 14, 50}) {
      for (const bool forbid_resident : {false, true}) {
        const StandIn stand_in;
        GpuOrCpuSolver solver(
            model, base::Threads{},
            MakeGpuSolver(model, {Layout::kTiled, Precision::kDouble, forbid_resident}, StandIn::Source()));
        ASSERT_NE(solver.Gpu(), nullptr);
        tissue::EquilibriumSolver cpu(model);
        const SolverSettings settings{SolverKind::kChebyshevJacobi2015, iterations, 1e-30, 0.0};
        const auto run = [&](tissue::EquilibriumSolver& which, TissueState& state, Shift& shift) {
          tissue::TissueLoad load = kLoad;
          load.external_force = shift.force;
          return which.Solve(settings, load, state, &shift);
        };
        TissueState expected = MakeMovedState(model, 3e-4), found = expected;
        Shift on_cpu(model.Size(), interval), on_gpu = on_cpu;
        const auto wanted = run(cpu, expected, on_cpu);
        const auto report = run(solver, found, on_gpu);
        EXPECT_EQ(on_gpu.calls, on_cpu.calls);
        EXPECT_EQ(on_gpu.calls, iterations / interval);
        EXPECT_EQ(report.iterations, wanted.iterations);
        EXPECT_EQ(report.restarts, wanted.restarts);
        EXPECT_NEAR(report.residual, wanted.residual, 1e-7);
        EXPECT_LT(CalcLargestDistance(expected.position, found.position), 1e-11)
            << interval << " " << iterations;
        EXPECT_NE(solver.Gpu(), nullptr);
      }
    }
  }
}

TEST(GpuOrCpuSolver, AFailureBetweenTwoCallsOfTheConstraintsStartsTheTickAgain) {
  const TissueModel model = MakeModel();
  const StandIn stand_in("fail=cuLaunchCooperativeKernel:3:700");
  GpuOrCpuSolver solver(model, base::Threads{}, MakeGpuSolver(model, {}, StandIn::Source()));
  TissueState expected = MakeMovedState(model, 3e-4), found = expected;
  Shift on_cpu(model.Size(), 5), on_gpu = on_cpu;
  tissue::EquilibriumSolver cpu(model);
  (void)cpu.Solve(kChebyshev, kLoad, expected, &on_cpu);
  (void)solver.Solve(kChebyshev, kLoad, found, &on_gpu);
  EXPECT_EQ(solver.Gpu(), nullptr);
  EXPECT_EQ(on_gpu.calls, on_cpu.calls + 2);
  // these constraints' force is not in the load: from the same start the processor finds the same end
  EXPECT_EQ(found.position, expected.position);
}

}  // namespace
}  // namespace trocar::tissue_cuda
