// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue_cuda/gpu_solver.h"

#include <gtest/gtest.h>

#include "check_systems.h"
#include "gpu_solve.h"
#include "stand_in.h"

namespace trocar::tissue_cuda {

using math::Vec3;

namespace {

using base::ErrorCode;
using tissue::SolverKind;
using tissue::TissueModel;
using tissue::TissueState;

ErrorCode CodeOf(const std::string& plan) {
  const StandIn stand_in(plan);
  const auto found = FindGpu(StandIn::Source());
  return found ? ErrorCode::kNone : found.error().code;
}

TEST(FindGpu, DescribesTheGpu) {
  const StandIn stand_in("version=13010 capability=86 memory=1000000");
  const auto found = FindGpu(StandIn::Source());
  ASSERT_TRUE(found) << found.error().Text();
  EXPECT_EQ(found->name, "Stand-in");
  EXPECT_EQ(found->compute_capability, 86);
  EXPECT_EQ(found->driver_version, 13010);
  EXPECT_EQ(found->memory_bytes, 1000000u);
}

TEST(FindGpu, SaysInOneLineWhatIsMissingOrTooOld) {
  DriverSource nowhere = StandIn::Source();
  nowhere.file = "/nonexistent/libcuda.so.1";
  EXPECT_EQ(FindGpu(nowhere).error().code, ErrorCode::kGpuMissing);
  DriverSource not_nvidia = StandIn::Source();
  not_nvidia.file = "libm.so.6";
  EXPECT_EQ(FindGpu(not_nvidia).error().code, ErrorCode::kGpuTooOld);
  DriverSource no_code = StandIn::Source();
  no_code.code = {};
  EXPECT_EQ(FindGpu(no_code).error().code, ErrorCode::kGpuMissing);

  EXPECT_EQ(CodeOf(""), ErrorCode::kNone);
  EXPECT_EQ(CodeOf("init=100"), ErrorCode::kGpuMissing);
  EXPECT_EQ(CodeOf("init=999"), ErrorCode::kGpuFailed);
  EXPECT_EQ(CodeOf("init=803"), ErrorCode::kGpuTooOld);
  EXPECT_EQ(CodeOf("devices=0"), ErrorCode::kGpuMissing);
  EXPECT_EQ(CodeOf("version=11080"), ErrorCode::kGpuTooOld);
  EXPECT_EQ(CodeOf("capability=70"), ErrorCode::kGpuTooOld);
  EXPECT_EQ(CodeOf("fail=cuDeviceGetAttribute:2:999"), ErrorCode::kGpuFailed);
  for (const char* plan : {"init=999", "version=11080", "capability=70"}) {
    const StandIn stand_in(plan);
    const std::string text = FindGpu(StandIn::Source()).error().message;
    EXPECT_EQ(text.find('\n'), std::string::npos);
    EXPECT_NE(text.find("tissue is computed on the processor"), std::string::npos) << text;
  }
}

/// A grid that every layout holds.
struct GridCase {
  TissueModel model = tissue::MakeTissueModel(MakeGridSystem(21, 19, Springs::kVaried, 0.004));
  TissueState state = MakeMovedState(model, 3e-4);
  std::vector<Vec3> forces = std::vector<Vec3>(model.Size(), Vec3{0, 0, 1e-4});
  tissue::TissueLoad load{.gravity = {0, 0, -0.3}, .external_force = forces};
};

// End to end over the driver's interface: what goes up, which kernel runs with what, what comes down.
TEST(GpuSolver, EveryLayoutAndPrecisionReachesTheCpusEquilibrium) {
  const StandIn stand_in;
  GridCase given;
  TissueState expected = given.state;
  tissue::EquilibriumSolver cpu(given.model);
  ASSERT_TRUE(cpu.Solve({SolverKind::kRelaxationPaper, 100'000, 1e-10, 0.0}, given.load, expected).converged);
  const double largest = CalcLargestDistance(expected.position, given.model.rest);
  EXPECT_GT(largest, 1e-4);
  for (const Layout layout : AllLayouts()) {
    for (const Precision precision : {Precision::kDouble, Precision::kSingle}) {
      for (const bool forbid_resident : {false, true}) {
        if (forbid_resident && layout != Layout::kTiled) continue;
        SCOPED_TRACE(std::string(LayoutName(layout)) + " " + std::string(PrecisionName(precision)));
        auto solver = MakeGpuSolver(given.model, {layout, precision, forbid_resident}, StandIn::Source());
        ASSERT_TRUE(solver) << solver.error().Text();
        EXPECT_EQ(solver->IsResident(), layout == Layout::kTiled && !forbid_resident);
        TissueState found = given.state;
        const bool is_single = precision == Precision::kSingle;
        const GpuSettings settings{layout == Layout::kTiled ? 1000 : 4000, is_single ? 1e-5 : 1e-8,
                                   1.9 * 0.5 * tissue::CalcLargestAlpha(given.model, given.load)};
        const auto report = solver->Solve(settings, given.load, found);
        ASSERT_TRUE(report) << report.error().Text();
        EXPECT_GT(report->iterations, 0);
        // the paper's layouts store positions: in single precision they end where a coordinate's last bit
        // does
        const double allowed = is_single && layout != Layout::kTiled ? 2e-3 : 1e-5;
        EXPECT_LT(CalcLargestDistance(expected.position, found.position), allowed * largest)
            << report->residual;
      }
    }
  }
}

TEST(GpuSolver, StreamsWhereTheTilesDoNotFit) {
  const TissueModel model = tissue::MakeTissueModel(MakeGridSystem(40, 40, Springs::kVaried, 0.004));
  {
    const StandIn stand_in("multiprocessors=1");
    const auto solver = MakeGpuSolver(model, {}, StandIn::Source());
    ASSERT_TRUE(solver);
    EXPECT_FALSE(solver->IsResident());  // 7 tiles, 2 places
  }
  const StandIn stand_in("multiprocessors=4");
  const auto solver = MakeGpuSolver(model, {}, StandIn::Source());
  ASSERT_TRUE(solver);
  EXPECT_TRUE(solver->IsResident());
}

TEST(GpuSolver, TakesNewConditionsForcesContactsAndStrandsWithoutBeingMadeAgain) {
  const StandIn stand_in;
  auto definition = MakeScatteredSphere(2, Springs::kVaried, 0.03);
  definition.strands = {{3, 80, 2.0}, {9, 120, 3.0}};
  const TissueModel model = tissue::MakeTissueModel(definition);
  auto solver = MakeGpuSolver(model, {Layout::kTiled, Precision::kDouble}, StandIn::Source());
  ASSERT_TRUE(solver);
  TissueState state = tissue::MakeRestState(model);
  const std::vector<Vec3> forces = MakeForces(model.Size());
  const tissue::ContactSpring contact{{1, 2, 3}, {0.2, 0.3, 0.5}, {0, 0, 1}, 0.05, 2.0};
  for (int tick = 0; tick < 4; ++tick) {
    tissue::TissueLoad load{.gravity = {0, 0, -0.1 * tick}};
    if (tick == 1) load.external_force = forces;
    if (tick == 2) load.contacts = {&contact, 1};
    if (tick == 3) {
      state.strand_is_intact[1] = 0;
      state.condition[50] = tissue::NodeCondition::kPrescribed;
      state.position[50] += Vec3{0.001, 0, 0};
    }
    TissueState expected = state;
    tissue::EquilibriumSolver cpu(model);
    (void)cpu.Solve({SolverKind::kChebyshevJacobi2015, 30, 1e-9}, load, expected);
    ASSERT_TRUE(solver->Solve({30, 1e-9}, load, state));
    EXPECT_LT(CalcLargestDistance(expected.position, state.position), 1e-12) << tick;
  }
}

TEST(GpuSolver, RefusesLoadsThatALayoutCannotHoldAndGoesOnAfterwards) {
  const StandIn stand_in;
  GridCase given;
  auto solver = MakeGpuSolver(given.model, {Layout::kPaperShared}, StandIn::Source());
  ASSERT_TRUE(solver);
  const tissue::ContactSpring contact{{1, 2, 3}, {0.2, 0.3, 0.5}, {0, 0, 1}, 0.05, 2.0};
  const TissueState before = given.state;
  const auto refused = solver->Solve({}, {.contacts = {&contact, 1}}, given.state);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kGpuLayout);
  EXPECT_EQ(given.state.position, before.position);
  EXPECT_TRUE(solver->Solve({}, {}, given.state));
}

TEST(GpuSolver, NamesTheErrorsOfItsMaking) {
  const TissueModel model = tissue::MakeTissueModel(MakeGridSystem(9, 9, Springs::kVaried));
  const auto code = [&](const std::string& plan) {
    const StandIn stand_in(plan);
    const auto solver = MakeGpuSolver(model, {}, StandIn::Source());
    return solver ? ErrorCode::kNone : solver.error().code;
  };
  EXPECT_EQ(code(""), ErrorCode::kNone);
  EXPECT_EQ(code("memory=2000"), ErrorCode::kGpuMemory);
  for (const int loaded : {200, 209, 218, 222})
    EXPECT_EQ(code("load=" + std::to_string(loaded)), ErrorCode::kGpuTooOld);
  for (const char* function :
       {"cuDevicePrimaryCtxRetain", "cuCtxSetCurrent", "cuModuleLoadData", "cuModuleGetFunction",
        "cuStreamCreate", "cuEventCreate", "cuMemHostAlloc", "cuMemcpyHtoDAsync_v2", "cuFuncSetAttribute",
        "cuOccupancyMaxActiveBlocksPerMultiprocessor"}) {
    EXPECT_EQ(code("fail=" + std::string(function) + ":1:999"), ErrorCode::kGpuFailed) << function;
  }
}

// Fault G2: whichever call fails in whichever tick, the state is as it was.
TEST(GpuSolver, AnErrorInTheMiddleOfARunLeavesTheStateUntouched) {
  int failures = 0;
  for (const Layout layout : {Layout::kTiled, Layout::kPaperCoalesced}) {
    for (const char* function :
         {"cuLaunchCooperativeKernel", "cuLaunchKernel", "cuStreamSynchronize", "cuMemcpyDtoHAsync_v2",
          "cuMemcpyHtoDAsync_v2", "cuEventRecord", "cuMemsetD8Async", "cuCtxSetCurrent"}) {
      for (const int call : {1, 3, 40}) {
        const StandIn stand_in("fail=" + std::string(function) + ":" + std::to_string(call) + ":700");
        GridCase given;
        auto solver = MakeGpuSolver(given.model, {layout}, StandIn::Source());
        if (!solver) continue;  // it failed before the first tick
        for (int tick = 0; tick < 3; ++tick) {
          const TissueState before = given.state;
          const auto report = solver->Solve({5, 1e-9}, given.load, given.state);
          if (report) continue;
          ++failures;
          EXPECT_EQ(report.error().code, ErrorCode::kGpuFailed);
          EXPECT_NE(report.error().message.find("CUDA_ERROR_ILLEGAL_ADDRESS"), std::string::npos);
          EXPECT_EQ(given.state.position, before.position) << function << " " << call;
          // and it stays failed
          EXPECT_FALSE(solver->Solve({}, given.load, given.state));
        }
      }
    }
  }
  EXPECT_GT(failures, 20);
}

}  // namespace
}  // namespace trocar::tissue_cuda
