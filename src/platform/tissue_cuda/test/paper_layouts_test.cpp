// SPDX-License-Identifier: Apache-2.0
#include "kernels/paper_layouts.h"

#include <gtest/gtest.h>

#include "check_systems.h"
#include "checked_runs.h"
#include "trocar/tissue/equilibrium.h"

namespace trocar::tissue_cuda {
namespace {

using tissue::TissueModel;
using tissue::TissueState;

constexpr Layout kPaperLayouts[] = {Layout::kPaperGlobal, Layout::kPaperCoalesced, Layout::kPaperShared,
                                    Layout::kPaperSharedCoalesced};

class PaperLayout : public testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(Memory, PaperLayout, testing::ValuesIn(kPaperLayouts), [](const auto& chosen) {
  std::string name(LayoutName(chosen.param));
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

/// Steps of a layout against the plain judge, every element watched; returns the largest distance.
template <typename Real>
double CompareSteps(Layout layout, const tissue::TissueDefinition& definition, int steps,
                    std::uint32_t seed) {
  const TissueModel model = tissue::MakeTissueModel(definition);
  const std::vector<math::Vec3> forces = MakeForces(model.Size());
  const tissue::TissueLoad load{
      .gravity = {0.1, 0, -9.81}, .stiffness_scale = 1.25, .shape_scale = 0.5, .external_force = forces};
  const double alpha = 0.5 * tissue::CalcLargestAlpha(model, load);
  TissueState expected = MakeMovedState(model, 0.1), found = expected;
  RelaxPlainly(model, load, alpha, steps, expected);
  Watch watch;
  RunPaper<Real>(layout, model, load, alpha, steps, {seed}, watch, found);
  EXPECT_EQ(watch.error_count, 0u) << Complaints(watch);
  return CalcLargestDistance(expected.position, found.position);
}

// Awkward sizes: one node, a chain, a tile with and without a neighbour beyond, prime, wide, tall.
TEST_P(PaperLayout, StepsAsThePlainIterationOnGridsOfAwkwardSizes) {
  constexpr std::pair<std::uint32_t, std::uint32_t> kSizes[] = {
      {1, 1},   {2, 1},   {1, 2},   {2, 2},   {3, 3},  {15, 4}, {16, 16},
      {17, 16}, {16, 17}, {31, 33}, {33, 31}, {5, 67}, {97, 3}};
  for (const auto& size : kSizes) {
    const std::uint32_t columns = size.first, rows = size.second;
    SCOPED_TRACE(std::to_string(columns) + " x " + std::to_string(rows));
    for (const Springs springs : {Springs::kUniform, Springs::kVaried}) {
      const auto definition = MakeGridSystem(columns, rows, springs);
      EXPECT_LT(CompareSteps<double>(GetParam(), definition, 4, 1), 1e-12);
      EXPECT_LT(CompareSteps<float>(GetParam(), definition, 4, 2), 5e-5);
    }
  }
}

TEST_P(PaperLayout, StepsAsThePlainIterationOnThePapersLargestGrid) {
  EXPECT_LT(CompareSteps<double>(GetParam(), MakeGridSystem(208, 208, Springs::kUniform), 2, 5), 1e-11);
}

TEST(PaperLayouts, TakeIrregularMeshesWithoutSharedMemory) {
  for (const Layout layout : {Layout::kPaperGlobal, Layout::kPaperCoalesced}) {
    for (const int subdivisions : {0, 2, 3}) {
      const auto definition = MakeScatteredSphere(subdivisions, Springs::kVaried);
      EXPECT_LT(CompareSteps<double>(layout, definition, 5, 9), 1e-12);
      EXPECT_LT(CompareSteps<float>(layout, definition, 5, 9), 1e-4);
    }
  }
}

// Oracle: the equilibrium is the CPU reference's.
TEST_P(PaperLayout, ReachesTheEquilibriumOfThePapersRelaxation) {
  const TissueModel model = tissue::MakeTissueModel(MakeGridSystem(18, 19, Springs::kVaried));
  const tissue::TissueLoad load{.gravity = {0, 0, -9.81}, .shape_scale = 10};
  TissueState expected = MakeMovedState(model, 0.05), found = expected;
  tissue::EquilibriumSolver reference(model);
  ASSERT_TRUE(
      reference.Solve({tissue::SolverKind::kRelaxationPaper, 100'000, 1e-10, 0.0}, load, expected).converged);
  Watch watch;
  RunPaper<double>(GetParam(), model, load, 0.9 * tissue::CalcLargestAlpha(model, load), 600, {}, watch,
                   found);
  EXPECT_EQ(watch.error_count, 0u) << Complaints(watch);
  const double largest = CalcLargestDistance(expected.position, model.rest);
  EXPECT_GT(largest, 0.01);
  EXPECT_LT(CalcLargestDistance(expected.position, found.position), 1e-5 * largest);
}

// Negative control: without the barrier between copying the tile and reading it, threads read what nobody
// wrote.
TEST(PaperLayouts, SharedMemoryNeedsItsBarrier) {
  const TissueModel model = tissue::MakeTissueModel(MakeGridSystem(20, 20, Springs::kUniform));
  for (const Layout layout : {Layout::kPaperShared, Layout::kPaperSharedCoalesced}) {
    TissueState state = MakeMovedState(model, 0.1);
    Watch watch;
    RunPaper<double>(layout, model, {}, 0.05, 1, {4, 0}, watch, state);
    EXPECT_GT(watch.error_count, 0u);
  }
}

/// The shared layout without the copies at the tile's rim.
struct WithoutBorder : PaperShared<double, CheckedMemory, true> {
  using Base = PaperShared<double, CheckedMemory, true>;
  template <int kPhase>
  static void Run(const ThreadIndex& where, const Args& args, Shared& shared, Registers& registers) {
    if constexpr (kPhase == 0) {
      const int in_column = static_cast<int>(where.thread % kTileSide),
                in_row = static_cast<int>(where.thread / kTileSide);
      const auto tiles_across = (args.columns + kTileSide - 1) / kTileSide;
      Copy(args, shared, static_cast<int>(where.block % tiles_across * kTileSide) + in_column,
           static_cast<int>(where.block / tiles_across * kTileSide) + in_row, in_column + 1, in_row + 1);
    } else {
      Base::Run<kPhase>(where, args, shared, registers);
    }
  }
};

// Negative control: a tile without its border is found out, where there is more than one tile.
TEST(PaperLayouts, SharedMemoryNeedsItsBorder) {
  for (const std::uint32_t side : {16u, 17u}) {
    const TissueModel model = tissue::MakeTissueModel(MakeGridSystem(side, side, Springs::kUniform));
    const auto arrays = MakePaperArrays<double>(model, Layout::kPaperSharedCoalesced);
    ASSERT_TRUE(arrays);
    std::vector<double> positions, forces;
    FillPoints(*arrays, model, tissue::MakeRestState(model), {}, positions, forces);
    Watch watch;
    CheckedHeap heap(watch);
    auto args = BindPaperArrays(*arrays, heap);
    args.positions = heap.Filled("positions", positions);
    args.next_positions = heap.Array<double>("next_positions", positions.size());
    ASSERT_TRUE(RunChecked<WithoutBorder>(args, CountPaperBlocks(*arrays), kPaperThreads, {}, watch));
    EXPECT_EQ(watch.error_count > 0, side > 16) << Complaints(watch);
  }
}

TEST(PaperLayouts, ReportTheResidualWhereTheyAreAsked) {
  const TissueModel model = tissue::MakeTissueModel(MakeGridSystem(9, 7, Springs::kVaried));
  const TissueState state = MakeMovedState(model, 0.1);
  std::vector<math::Vec3> residual(model.Size());
  tissue::CalcResidual(model, state, {}, residual);
  double largest = 0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (state.condition[i] != tissue::NodeCondition::kPrescribed)
      largest = std::max(largest, math::Norm(residual[i]));
  }
  for (const Layout layout : kPaperLayouts) {
    const auto arrays = MakePaperArrays<double>(model, layout);
    ASSERT_TRUE(arrays);
    std::vector<double> positions, forces;
    FillPoints(*arrays, model, state, {}, positions, forces);
    Watch watch;
    CheckedHeap heap(watch);
    auto args = BindPaperArrays(*arrays, heap);
    args.positions = heap.Filled("positions", positions);
    args.next_positions = heap.Array<double>("next_positions", positions.size());
    args.largest = heap.Filled("largest", std::vector<Key>(2, 0));
    ASSERT_TRUE(RunPaperStep(layout, args, CountPaperBlocks(*arrays), {8}, watch));
    EXPECT_EQ(watch.error_count, 0u) << Complaints(watch);
    EXPECT_NEAR(std::sqrt(FromKey<double>(args.largest.contents->values[0])), largest, 1e-12);
    EXPECT_GT(FromKey<double>(args.largest.contents->values[1]), 0.0);
  }
}

TEST(PaperArrays, KeepThePapersArraysWhereAllSpringsAreAlike) {
  const TissueModel uniform = tissue::MakeTissueModel(MakeGridSystem(5, 4, Springs::kUniform));
  const auto paper = MakePaperArrays<float>(uniform, Layout::kPaperGlobal);
  ASSERT_TRUE(paper);
  EXPECT_TRUE(paper->link_stiffness.empty() && paper->rest_points.empty());
  EXPECT_EQ(paper->mesh_stiffness, 1.0f);
  EXPECT_EQ(paper->neighbors.size(), 20u * 6u);
  const TissueModel varied = tissue::MakeTissueModel(MakeGridSystem(5, 4, Springs::kVaried));
  const auto more = MakePaperArrays<float>(varied, Layout::kPaperCoalesced);
  ASSERT_TRUE(more);
  EXPECT_EQ(more->link_stiffness.size(), 32u * 6u);
  EXPECT_EQ(more->rest_points.size(), 32u * 4u);
}

TEST(FindGridShape, RecognisesStructuredMeshesAndNoOthers) {
  constexpr std::pair<std::uint32_t, std::uint32_t> kSizes[] = {{2, 2}, {3, 2},   {2, 3}, {2, 9},
                                                                {9, 2}, {16, 16}, {31, 7}};
  for (const auto& size : kSizes) {
    const TissueModel model =
        tissue::MakeTissueModel(MakeGridSystem(size.first, size.second, Springs::kUniform));
    const auto grid = FindGridShape(model);
    ASSERT_TRUE(grid) << size.first << " x " << size.second;
    EXPECT_EQ(grid->columns * grid->rows, model.Size());
  }
  const auto exact = FindGridShape(tissue::MakeTissueModel(MakeGridSystem(31, 7, Springs::kUniform)));
  EXPECT_EQ(exact->columns, 31u);
  EXPECT_FALSE(FindGridShape(tissue::MakeTissueModel(MakeScatteredSphere(2, Springs::kUniform))));
  // a spring from the end of a row to the beginning of the next but one: index neighbours, not space
  // neighbours
  auto wrapped = MakeGridSystem(6, 5, Springs::kUniform);
  wrapped.springs.push_back({5, 12, 1.0, 1.0});
  EXPECT_FALSE(FindGridShape(tissue::MakeTissueModel(wrapped)));
}

TEST(PaperArrays, RefuseWhatTheyCannotHold) {
  const TissueModel scattered = tissue::MakeTissueModel(MakeScatteredSphere(1, Springs::kUniform));
  const auto shared = MakePaperArrays<float>(scattered, Layout::kPaperShared);
  ASSERT_FALSE(shared);
  EXPECT_EQ(shared.error().code, base::ErrorCode::kGpuLayout);
  auto with_strand = MakeGridSystem(3, 3, Springs::kUniform);
  with_strand.strands = {{0, 4, 1.0}};
  const auto strands = MakePaperArrays<float>(tissue::MakeTissueModel(with_strand), Layout::kPaperGlobal);
  ASSERT_FALSE(strands);
  EXPECT_EQ(strands.error().code, base::ErrorCode::kGpuLayout);
  EXPECT_FALSE(MakePaperArrays<float>(tissue::MakeTissueModel({}), Layout::kPaperGlobal));
}

}  // namespace
}  // namespace trocar::tissue_cuda
