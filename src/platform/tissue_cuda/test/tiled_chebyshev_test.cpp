// SPDX-License-Identifier: Apache-2.0
#include "kernels/tiled_chebyshev.h"

#include <gtest/gtest.h>

#include <set>

#include "check_systems.h"
#include "checked_runs.h"
#include "tile_order.h"
#include "trocar/tissue/equilibrium.h"

namespace trocar::tissue_cuda {

using math::Vec3;

namespace {

using tissue::SolverKind;
using tissue::TissueModel;
using tissue::TissueState;

constexpr double kCpuMaxStep = 0.002;  // of the CPU's solver [m]

struct Solved {
  std::vector<Vec3> position;
  TiledReport report;
};

template <template <typename, typename> class Kernel, typename Real>
Solved Solve(const Case& given, const GpuSettings& settings, std::uint32_t blocks, std::uint32_t seed) {
  TissueState state = given.state;
  Watch watch;
  const TiledReport report =
      RunTiled<Kernel, Real>(given.model, settings, given.load, blocks, kCpuMaxStep, {seed}, watch, state);
  EXPECT_EQ(watch.error_count, 0u) << Complaints(watch);
  return {std::move(state.position), report};
}

std::uint32_t CountTiles(const TissueModel& model) {
  return (static_cast<std::uint32_t>(model.Size()) + kTileNodes - 1) / kTileNodes;
}

/// Definitions in millimetres: structured and irregular, of awkward sizes.
std::vector<std::pair<std::string, tissue::TissueDefinition>> MakeDefinitions() {
  std::vector<std::pair<std::string, tissue::TissueDefinition>> all;
  constexpr std::pair<std::uint32_t, std::uint32_t> kSizes[] = {{1, 1},   {2, 1},   {3, 3},  {16, 16},
                                                                {257, 1}, {31, 33}, {33, 40}};
  for (const auto& size : kSizes) {
    all.emplace_back(std::to_string(size.first) + " x " + std::to_string(size.second),
                     MakeGridSystem(size.first, size.second, Springs::kVaried, 0.004));
  }
  all.emplace_back("sphere of 162", MakeScatteredSphere(2, Springs::kVaried, 0.03));
  all.emplace_back("sphere of 642", MakeScatteredSphere(3, Springs::kVaried, 0.03));
  return all;
}

// Oracle: iteration for iteration the CPU's Chebyshev solver, with restarts, cut steps and every kind of
// load.
TEST(TiledChebyshev, TakesTheStepsOfTheCpusSolver) {
  for (const auto& [name, definition] : MakeDefinitions()) {
    SCOPED_TRACE(name);
    for (const bool has_all : {false, true}) {
      const auto given = MakeCase(definition, has_all);
      for (const int iterations : {1, 2, 7, 45}) {
        const GpuSettings settings{iterations, 1e-300};
        TissueState expected = given->state;
        tissue::EquilibriumSolver cpu(given->model);
        const tissue::SolveReport report =
            cpu.Solve({SolverKind::kChebyshevJacobi2015, settings.max_iterations, settings.tolerance},
                      given->load, expected);
        const Solved resident = Solve<TiledResident, double>(*given, settings, CountTiles(given->model), 3);
        EXPECT_LT(CalcLargestDistance(expected.position, resident.position), 1e-11) << iterations;
        EXPECT_EQ(resident.report.iterations, static_cast<std::uint32_t>(report.iterations));
        EXPECT_EQ(resident.report.restarts, static_cast<std::uint32_t>(report.restarts));
        EXPECT_NEAR(resident.report.residual, report.residual, 1e-8);
        EXPECT_NEAR(resident.report.force_scale, report.force_scale, 1e-8 * report.force_scale);
      }
    }
  }
}

// Both kernels, any number of blocks, any order of threads: the same bits, in both precisions.
TEST(TiledChebyshev, ResidentAndStreamingGiveTheSameBitsInAnyOrder) {
  const GpuSettings settings{60, 1e-5};
  for (const auto& [name, definition] : MakeDefinitions()) {
    SCOPED_TRACE(name);
    const auto given = MakeCase(definition, true);
    const std::uint32_t tiles = CountTiles(given->model);
    const Solved resident = Solve<TiledResident, float>(*given, settings, tiles, 0);
    for (const std::uint32_t blocks : {1u, 2u, tiles, tiles + 1}) {
      const Solved streaming = Solve<TiledStreaming, float>(*given, settings, blocks, blocks);
      EXPECT_EQ(streaming.position, resident.position) << blocks;
      EXPECT_EQ(streaming.report.iterations, resident.report.iterations);
      EXPECT_EQ(streaming.report.residual, resident.report.residual);
    }
    EXPECT_EQ((Solve<TiledResident, double>(*given, settings, tiles, 5).position),
              (Solve<TiledStreaming, double>(*given, settings, 3, 6).position));
  }
}

// Single precision holds because displacements are stored: 1e-5 of the largest displacement at equilibrium.
TEST(TiledChebyshev, SinglePrecisionReachesTheReferencesEquilibrium) {
  const std::set<std::string> sizes = {"1 x 1", "16 x 16", "31 x 33", "sphere of 162"};
  for (const auto& [name, definition] : MakeDefinitions()) {
    if (!sizes.contains(name)) continue;
    SCOPED_TRACE(name);
    const auto given = MakeCase(definition, true);
    TissueState expected = given->state;
    tissue::EquilibriumSolver reference(given->model);
    ASSERT_TRUE(reference.Solve({SolverKind::kRelaxationPaper, 200'000, 1e-10, 0.0}, given->load, expected)
                    .converged);
    const Solved found = Solve<TiledResident, float>(*given, {1500, 1e-6}, CountTiles(given->model), 0);
    const double largest = CalcLargestDistance(expected.position, given->model.rest);
    if (given->model.Size() > 2) {
      EXPECT_GT(largest, 1e-4);  // else every node is held
    }
    EXPECT_LE(CalcLargestDistance(expected.position, found.position), 1e-5 * largest)
        << found.report.residual;
  }
}

TEST(TiledChebyshev, EndsWhereTheToleranceIsMetAndKeepsThatState) {
  const auto given = MakeCase(MakeGridSystem(20, 20, Springs::kVaried, 0.004), false);
  const Solved loose = Solve<TiledResident, double>(*given, {1000, 1e-2}, 2, 0);
  EXPECT_EQ(loose.report.converged, 1u);
  EXPECT_LE(loose.report.residual, 1e-2);
  // from there, nothing is left to do: no step is taken and no bit of a free node changes but by rounding
  Case again = *given;
  again.state.position = loose.position;
  const Solved second = Solve<TiledResident, double>(again, {1000, 1e-2}, 2, 0);
  EXPECT_EQ(second.report.iterations, 0u);
  EXPECT_LT(CalcLargestDistance(second.position, loose.position), 1e-17);
}

TEST(TiledChebyshev, LeavesPrescribedNodesToTheBit) {
  const auto given = MakeCase(MakeScatteredSphere(3, Springs::kVaried, 0.03), true);
  const Solved solved = Solve<TiledStreaming, float>(*given, {9, 1e-9}, 2, 1);
  for (std::size_t i = 0; i < given->model.Size(); ++i) {
    if (given->state.condition[i] == tissue::NodeCondition::kPrescribed) {
      EXPECT_EQ(solved.position[i], given->state.position[i]);
    }
  }
}

TEST(TiledChebyshev, ANumberThatIsNoneEndsTheSolveAndIsSeen) {
  const auto given = MakeCase(MakeGridSystem(20, 20, Springs::kVaried, 0.004), false);
  given->state.position[111].y = std::nan("");
  for (int i = 0; i < 2; ++i) {
    const GpuSettings settings{1000, 1e-6};
    const Solved solved = i == 0 ? Solve<TiledResident, float>(*given, settings, 2, 0)
                                 : Solve<TiledStreaming, float>(*given, settings, 2, 0);
    EXPECT_EQ(solved.report.iterations, 1u);
    EXPECT_EQ(solved.report.converged, 0u);
    EXPECT_TRUE(std::isnan(solved.report.residual));
    EXPECT_TRUE(std::isnan(solved.position[111].y));
  }
}

/// The resident kernel without the copies of the tile's border.
template <typename Real, typename Memory>
struct WithoutBorder : TiledResident<Real, Memory> {
  using Base = TiledResident<Real, Memory>;
  template <int kPhase>
  static void Run(const ThreadIndex& where, const typename Base::Args& args, typename Base::Shared& shared,
                  typename Base::Registers& registers) {
    if constexpr (kPhase == 1) {
      Store(shared.displacements, where.thread, ToQuad(registers.here));
    } else {
      Base::template Run<kPhase>(where, args, shared, registers);
    }
  }
};

// Negative controls: each barrier and the border are needed, and their absence is found.
TEST(TiledChebyshev, NeedsEveryBarrierAndItsBorder) {
  const auto given = MakeCase(MakeGridSystem(31, 33, Springs::kVaried, 0.004), false);
  const GpuSettings settings{3, 1e-9};
  const auto count_errors = [&](auto run, int removed) {
    TissueState state = given->state;
    Watch watch;
    run(ExecutorOptions{2, removed}, watch, state);
    return watch.error_count;
  };
  const auto resident = [&](const ExecutorOptions& options, Watch& watch, TissueState& state) {
    (void)RunTiled<TiledResident, float>(given->model, settings, given->load, 4, kCpuMaxStep, options, watch,
                                         state);
  };
  const auto streaming = [&](const ExecutorOptions& options, Watch& watch, TissueState& state) {
    (void)RunTiled<TiledStreaming, float>(given->model, settings, given->load, 4, kCpuMaxStep, options, watch,
                                          state);
  };
  const auto no_border = [&](const ExecutorOptions& options, Watch& watch, TissueState& state) {
    (void)RunTiled<WithoutBorder, float>(given->model, settings, given->load, 4, kCpuMaxStep, options, watch,
                                         state);
  };
  EXPECT_EQ(count_errors(resident, -1), 0u);
  for (const int barrier : {0, 1, 2, 3}) EXPECT_GT(count_errors(resident, barrier), 0u) << barrier;
  EXPECT_EQ(count_errors(streaming, -1), 0u);
  for (const int barrier : {0, 1, 2}) EXPECT_GT(count_errors(streaming, barrier), 0u) << barrier;
  EXPECT_GT(count_errors(no_border, -1), 0u);
}

TEST(TileOrder, FillsTilesWithNeighbours) {
  const TissueModel model = tissue::MakeTissueModel(MakeScatteredSphere(4, Springs::kUniform));
  const std::vector<std::uint32_t> order = CalcTileOrder(model.rest, kTileNodes);
  EXPECT_EQ(std::set<std::uint32_t>(order.begin(), order.end()).size(), model.Size());
  const auto arrays = MakeTiledArrays<float>(model);
  ASSERT_TRUE(arrays);
  // a compact patch of 256 nodes of a surface has about 4 * 16 neighbours; in the order given, nearly all lie
  // outside
  EXPECT_LT(arrays->max_border, 140u);
  EXPECT_EQ(arrays->nodes, 2562u);
  EXPECT_EQ(arrays->tiles, 11u);
}

TEST(TileOrder, TakesAnyNumberOfPointsAndEqualOnes) {
  EXPECT_TRUE(CalcTileOrder({}, 4).empty());
  const std::vector<Vec3> same(11, Vec3{1, 1, 1});
  const auto order = CalcTileOrder(same, 4);
  for (std::uint32_t i = 0; i < 11; ++i) EXPECT_EQ(order[i], i);
}

TEST(TiledArrays, RefuseATileWithTooManyNeighbours) {
  // 256 nodes at one place, each tied to others far away: more than a 16-bit number can name
  std::vector<Vec3> rest;
  std::vector<geometry::Edge> edges;
  for (std::uint32_t i = 0; i < 256; ++i) rest.push_back({0, 0, 1e-6 * i});
  for (std::uint32_t i = 0; i < 66'000; ++i) {
    rest.push_back({100.0 + i, 0, 0});
    edges.push_back({i % 256, 256 + i});
  }
  const auto arrays =
      MakeTiledArrays<float>(tissue::MakeTissueModel(MakeSystem(rest, edges, Springs::kUniform, 1)));
  ASSERT_FALSE(arrays);
  EXPECT_EQ(arrays.error().code, base::ErrorCode::kGpuLayout);
  EXPECT_FALSE(MakeTiledArrays<float>(tissue::MakeTissueModel({})));
}

TEST(FillContacts, ListsCornersByNodeInTheOrderOfTheContacts) {
  const TissueModel model = tissue::MakeTissueModel(MakeGridSystem(4, 4, Springs::kUniform));
  const std::vector<std::uint32_t> same = [] {
    std::vector<std::uint32_t> order(16);
    std::iota(order.begin(), order.end(), 0u);
    return order;
  }();
  const tissue::ContactSpring contacts[] = {{{5, 2, 9}, {0.5, 0.25, 0.25}, {0, 0, 1}, 0.5, 3},
                                            {{2, 5, 1}, {0.5, 0.25, 0.25}, {0, 0, 1}, 0.5, 3}};
  TiledContacts result;
  FillContacts(same, model, contacts, result);
  EXPECT_EQ(result.touched_nodes, (std::vector<std::uint32_t>{1, 2, 5, 9}));
  EXPECT_EQ(result.touch_starts, (std::vector<std::uint32_t>{0, 1, 3, 5, 6}));
  EXPECT_EQ(result.touch_entries, (std::vector<std::uint32_t>{4 + 2, 1, 4, 0, 4 + 1, 2}));
  FillContacts(same, model, {}, result);
  EXPECT_TRUE(result.touched_nodes.empty() && result.contacts.empty() && result.touch_entries.empty());
}

}  // namespace
}  // namespace trocar::tissue_cuda
