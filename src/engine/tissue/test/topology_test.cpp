// SPDX-License-Identifier: Apache-2.0
/// \file topology_test.cpp  A solver that goes on with another model after a cut, against one made anew.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <new>
#include <random>
#include <set>
#include <vector>

#include "aggregation.h"
#include "hierarchy_topology.h"
#include "test_systems.h"
#include "trocar/tissue/conservation.h"
#include "trocar/tissue/element_kinds.h"
#include "trocar/tissue/equilibrium.h"
#include "trocar_test/threads.h"

namespace {
std::atomic<int> allocations{0};
}

// both plain forms; the array forms and the rest call them
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size > 0 ? size : 1);
}
// vectors that begin at a cache line call this one
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  ++allocations;
  const auto line = static_cast<std::size_t>(alignment);
  if (void* memory = std::aligned_alloc(line, (size / line + 1) * line)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
// some standard libraries give the size as well
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, const std::nothrow_t&) noexcept {
  std::free(memory);
}

namespace trocar::tissue {
namespace {

constexpr std::uint32_t kSpare = 40;

/// A sac with strands and spare nodes, cut at random.
struct Theatre {
  geometry::TriangleMesh mesh = geometry::MakeSphere({0, 0, 0}, 0.03, 3);
  TissueDefinition definition = MakeMembrane(mesh, 100.0, 1e5);
  std::uint32_t next_spare = 0;
  std::mt19937 random;

  explicit Theatre(unsigned seed) : random(seed) {
    next_spare = static_cast<std::uint32_t>(definition.rest.size());
    definition.strands = {{3, 100, 40.0}, {50, 60, 20.0}};
    for (std::uint32_t i = 0; i < kSpare; ++i) {
      definition.rest.push_back(definition.rest.front());
      definition.mass.push_back(0), definition.shape_stiffness.push_back(0);
      definition.fixed.push_back(next_spare + i);
    }
  }

  /// What a cut does: springs go, some weaken, and a node is parted in two that share the springs.
  void Cut() {
    auto& springs = definition.springs;
    for (int removed = 0; removed < 5; ++removed)
      springs.erase(springs.begin() + static_cast<std::ptrdiff_t>(random() % springs.size()));
    for (int weakened = 0; weakened < 5; ++weakened) springs[random() % springs.size()].stiffness *= 0.4;
    const std::uint32_t node = static_cast<std::uint32_t>(random() % mesh.positions.size()),
                        twin = next_spare++;
    definition.rest[twin] = definition.rest[node] + math::Vec3{1e-4, 0, 0};
    definition.mass[twin] = definition.mass[node] *= 0.5;
    definition.shape_stiffness[twin] = definition.shape_stiffness[node] *= 0.5;
    std::erase(definition.fixed, twin);
    bool takes = false;
    for (Spring& spring : springs) {
      if (spring.a != node && spring.b != node) continue;
      if ((takes = !takes)) (spring.a == node ? spring.a : spring.b) = twin;
    }
    springs.push_back({node, twin, 3.0, 1e-4});
  }
};

TissueState Pull(const TissueModel& model) {
  TissueState state = MakeRestState(model);
  state.condition[7] = NodeCondition::kPrescribed;
  state.position[7] += {0.004, 0.002, 0.006};
  return state;
}

class AfterACut : public testing::TestWithParam<SolverKind> {};

// Every solver: the same bits as one made anew, cut after cut, with solves between.
TEST_P(AfterACut, GoesOnAsIfMadeAnew) {
  SolverSettings settings;
  settings.kind = GetParam();
  for (unsigned seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    Theatre theatre(seed);
    TissueModel model = MakeTissueModel(theatre.definition);
    const TissueModel whole = model;
    EquilibriumSolver solver(model, {.threads = test::UseThreads(2), .spare_share = 0.5});
    for (int cut = 0; cut < 6; ++cut) {
      theatre.Cut();
      model = MakeTissueModel(theatre.definition);
      solver.UpdateTopology(model);
      EquilibriumSolver anew(model);
      TissueState state = Pull(model), expected = state;
      state.spring_factor[11] = expected.spring_factor[11] = 0.3;
      for (int tick = 0; tick < 2; ++tick) {
        const SolveReport one = solver.Solve(settings, {.gravity = {0, 0, -3}}, state);
        const SolveReport other = anew.Solve(settings, {.gravity = {0, 0, -3}}, expected);
        ASSERT_EQ(one.iterations, other.iterations);
        ASSERT_EQ(one.linear_iterations, other.linear_iterations);
        ASSERT_EQ(state.position, expected.position) << "cut " << cut;
      }
      // negative control: the uncut tissue is elsewhere
      EquilibriumSolver uncut(whole);
      TissueState elsewhere = Pull(whole);
      (void)uncut.Solve(settings, {.gravity = {0, 0, -3}}, elsewhere);
      ASSERT_NE(state.position, elsewhere.position);
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Every, AfterACut, testing::ValuesIn(kSolverKinds),
                         [](const auto& kind) { return std::string(SolverName(kind.param)); });

// As many elements as a kind may have come and go: a solve that was prepared allocates nothing.
TEST(Prepared, ElementsAllocateNothing) {
  const TissueModel model =
      MakeTissueModel(MakeMembrane(geometry::MakeSphere({0, 0, 0}, 0.03, 3), 100.0, 1e5));
  ElementArrays elements;
  for (std::uint32_t i = 0; i < SurfaceContact::kCapacity; ++i)
    elements.Of<SurfaceContact>().push_back(
        {.nodes = {i, i + 1, i + 2, i + 3}, .stiffness = 3.0, .gap = 0.002});
  for (std::uint32_t i = 0; i < SlidingConstraint::kCapacity; ++i) {
    elements.Of<SlidingConstraint>().push_back(
        {.nodes = {i, i + 1, i + 2, i + 300, i + 301}, .weights = {0.2, 0.3, 0.5}, .stiffness = 0.01});
  }
  const SolverSettings settings{.kind = SolverKind::kNewtonMultigrid};
  EquilibriumSolver solver(model);
  solver.Prepare(settings, 0);
  TissueState state = MakeRestState(model);
  const int before = allocations;
  for (const bool has_elements : {true, false, true}) {
    const SolveReport report = solver.Solve(
        settings, {.gravity = {0, 0, -1}, .elements = has_elements ? &elements : nullptr}, state);
    EXPECT_GT(report.linear_iterations, 0);
  }
  EXPECT_EQ(allocations, before);
}

TEST(AfterACut, NothingIsAllocatedWithinTheReserve) {
  Theatre theatre(5);
  TissueModel model = MakeTissueModel(theatre.definition);
  EquilibriumSolver solver(model, {.spare_share = 0.5});
  for (const SolverKind kind : kSolverKinds) solver.Prepare({.kind = kind}, 1);
  for (int cut = 0; cut < 30; ++cut) {
    theatre.Cut();
    model = MakeTissueModel(theatre.definition);
    const int before = allocations;
    solver.UpdateTopology(model);
    EXPECT_EQ(allocations, before) << "cut " << cut;
  }
  // negative control: the counter counts, and without a reserve there is something to count
  const int before = allocations;
  EquilibriumSolver small(model);
  EXPECT_GT(allocations, before);
  const int made = allocations;
  for (int cut = 0; cut < 5; ++cut) theatre.Cut();
  for (std::uint32_t i = 0; i < 100; ++i) theatre.definition.springs.push_back({i, i + 200, 1.0, 0.01});
  model = MakeTissueModel(theatre.definition);
  const int remade = allocations;
  small.UpdateTopology(model);
  EXPECT_GT(allocations, remade);
  EXPECT_GT(remade, made);
  // and goes on all the same
  EquilibriumSolver anew(model);
  TissueState one = Pull(model), other = one;
  (void)small.Solve({}, {}, one);
  (void)anew.Solve({}, {}, other);
  EXPECT_EQ(one.position, other.position);
}

// What a solver needs is made by Prepare(), or else by its first solve; no later one allocates.
TEST_P(AfterACut, OnlyAFirstSolveAllocates) {
  const SolverSettings settings{.kind = GetParam()};
  const Theatre theatre(4);
  const TissueModel model = MakeTissueModel(theatre.definition);
  TissueState state = Pull(model);
  const auto count = [&](EquilibriumSolver& solver) {
    const int before = allocations;
    (void)solver.Solve(settings, {.gravity = {0, 0, -3}}, state);
    return allocations - before;
  };
  EquilibriumSolver prepared(model), unprepared(model);
  prepared.Prepare(settings, 0);
  EXPECT_EQ(count(prepared), 0);
  EXPECT_GT(count(unprepared), 0) << "negative control";
  EXPECT_EQ(count(unprepared), 0);
}

// Solvers of one model share what it is made into, until a cut gives each its own; the one that made it may be gone.
TEST_P(AfterACut, SharedMemoryChangesNoBit) {
  const SolverSettings settings{.kind = GetParam()};
  Theatre theatre(6);
  TissueModel model = MakeTissueModel(theatre.definition);
  auto first = std::make_unique<EquilibriumSolver>(model, SolverOptions{.spare_share = 0.5});
  EquilibriumSolver second(model, {.spare_share = 0.5}, first->ShareModel());
  EXPECT_EQ(second.ShareModel(), first->ShareModel());
  first.reset();
  EquilibriumSolver alone(model);
  const auto expect_same = [&] {
    TissueState state = Pull(model), expected = state;
    (void)second.Solve(settings, {.gravity = {0, 0, -3}}, state);
    (void)alone.Solve(settings, {.gravity = {0, 0, -3}}, expected);
    EXPECT_EQ(state.position, expected.position);
  };
  expect_same();
  theatre.Cut();
  model = MakeTissueModel(theatre.definition);
  second.UpdateTopology(model), alone.UpdateTopology(model);
  expect_same();
}

// A sheet that was a stencil is none after a cut, and one again when it is whole.
TEST(AfterACut, AStructuredMeshIsOneNoMore) {
  TissueDefinition definition = MakeMembrane(geometry::MakeGrid(20, 0.001), 100.0, 1e5);
  const TissueModel whole = MakeTissueModel(definition);
  EquilibriumSolver solver(whole);
  ASSERT_TRUE(solver.IsStructured());
  std::swap(definition.springs[40].b, definition.springs[300].b);
  const TissueModel cut = MakeTissueModel(definition);
  solver.UpdateTopology(cut);
  EXPECT_FALSE(solver.IsStructured());
  EquilibriumSolver anew(cut);
  TissueState state = Pull(cut), expected = state;
  (void)solver.Solve({}, {}, state);
  (void)anew.Solve({}, {}, expected);
  EXPECT_EQ(state.position, expected.position);
  solver.UpdateTopology(whole);
  EXPECT_TRUE(solver.IsStructured());
}

// What a solver keeps from solve to solve is the model's: one that has solved other problems before finds the same bits.
TEST(SolverMemory, AColdStartOnAGridForgetsWhereOtherNodesWereHeld) {
  const TissueModel model = MakeTissueModel(MakeMembrane(geometry::MakeGrid(80, 0.001), 100.0, 10.0));
  const auto press = [&](EquilibriumSolver& solver, std::uint32_t held) {
    TissueState state = MakeRestState(model);
    for (std::uint32_t i = 0; i < 80; ++i) state.condition[held * 80 + i] = NodeCondition::kPrescribed;
    SolverSettings settings;
    settings.kind = SolverKind::kAcceleratedDescent;
    const SolveReport report = solver.Solve(settings, {.gravity = {0, 0, -9.81}}, state);
    EXPECT_GT(report.coarse_levels, 2);
    return state.position;
  };
  EquilibriumSolver used(model), anew(model);
  const auto first = press(used, 40);
  const auto second = press(used, 0);
  EXPECT_EQ(second, press(anew, 0));
  EXPECT_NE(second, first);
}

TEST(SolverMemory, AFactorThatIsNoNumberHidesNoCutSpring) {
  TissueDefinition definition = MakeHangingSpring(20, 0.1, 0.05);
  definition.rest.push_back({0, 0, -0.2}), definition.mass.push_back(0.05);
  definition.shape_stiffness.push_back(0);
  definition.springs.insert(definition.springs.begin(), {1, 2, 20, 0.1});
  const TissueModel model = MakeTissueModel(definition);
  EquilibriumSolver used(model), anew(model);
  TissueState state = MakeRestState(model);
  state.spring_factor = {0.0, std::nan("")};
  EXPECT_FALSE(used.Solve({}, {.gravity = {0, 0, -9.81}}, state).is_finite);
  state.spring_factor[1] = 1.0;
  TissueState expected = state;
  (void)used.Solve({}, {.gravity = {0, 0, -9.81}}, state);
  (void)anew.Solve({}, {.gravity = {0, 0, -9.81}}, expected);
  EXPECT_EQ(state.position, expected.position);
  EXPECT_EQ(state.position[2], model.rest[2]) << "nothing holds it: it stays";
}

// The volume is kept through a cut, and what the tissue comes to is what a conservation made anew finds.
TEST(AfterACut, VolumesAreKept) {
  Theatre theatre(9);
  TissueModel model = MakeTissueModel(theatre.definition);
  EquilibriumSolver solver(model, {.spare_share = 0.5});
  const ConservationSettings settings{
      .organs = {{0, static_cast<std::uint32_t>(theatre.mesh.positions.size()), theatre.mesh.triangles}}};
  Conservation conservation(model, settings);
  TissueState state = Pull(model);
  ConservationState kept = conservation.MakeState(MakeRestState(model));
  const auto solve = [&](EquilibriumSolver& with, Conservation& keeper, TissueState& tissue,
                         ConservationState& keeps) {
    for (int tick = 0; tick < 40; ++tick) {
      TissueLoad load;
      (void)SolveConserving(with, {}, 0.01, keeper, load, tissue, keeps);
    }
  };
  solve(solver, conservation, state, kept);
  const double pressure_before = kept.organs[0].pressure;
  for (int cut = 0; cut < 4; ++cut) theatre.Cut();
  model = MakeTissueModel(theatre.definition);
  solver.UpdateTopology(model);
  conservation.UpdateTopology(model, settings.organs, kept);
  state.spring_factor.assign(model.SpringCount(), 1.0);
  state.spring_damage.assign(model.SpringCount(), 0.0);
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    if (i != 7) state.condition[i] = model.is_fixed[i] ? NodeCondition::kPrescribed : NodeCondition::kFree;
  }
  solve(solver, conservation, state, kept);
  EXPECT_NEAR(kept.organs[0].volume, kept.organs[0].target, 1e-6 * kept.organs[0].target);
  EXPECT_NE(kept.organs[0].pressure, pressure_before);

  EquilibriumSolver anew(model);
  Conservation other(model, settings);
  TissueState expected = state;
  ConservationState expected_kept = kept;
  solve(anew, other, expected, expected_kept);
  double largest = 0;
  for (std::size_t i = 0; i < model.Size(); ++i)
    largest = std::max(largest, math::Distance(state.position[i], expected.position[i]));
  EXPECT_LT(largest, 1e-3 * 0.0075);
  EXPECT_NEAR(kept.organs[0].pressure, expected_kept.organs[0].pressure,
              0.01 * std::fabs(expected_kept.organs[0].pressure));
}

LinkGraph MakeLinkGraph(const TissueModel& model) {
  LinkGraph made;
  made.graph.Clear();
  for (std::size_t i = 0; i < model.Size(); ++i) {
    for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
      made.graph.others.push_back(model.half_springs[h].other);
      made.stiffness.push_back(model.half_springs[h].stiffness);
    }
    made.graph.starts.push_back(static_cast<std::uint32_t>(made.graph.others.size()));
  }
  return made;
}

// Oracle: the sums of the links between aggregates, pair by pair.
TEST(Aggregation, SumsTheLinksBetweenAggregates) {
  Theatre theatre(2);
  for (int cut = 0; cut < 10; ++cut) theatre.Cut();
  const LinkGraph fine = MakeLinkGraph(MakeTissueModel(theatre.definition));
  Aggregation aggregation;
  for (const int pairings : {1, 2, 3}) {
    aggregation.Join(fine, pairings);
    const auto& aggregate = aggregation.Aggregate();
    const LinkGraph& coarse = aggregation.Coarse();
    std::vector<int> sizes(coarse.graph.Size(), 0);
    for (std::uint32_t i = 0; i < fine.graph.Size(); ++i) {
      const bool is_single = fine.graph.starts[i] == fine.graph.starts[i + 1];
      ASSERT_EQ(aggregate[i] == Aggregation::kNone, is_single) << i;
      if (!is_single) ++sizes.at(aggregate[i]);
    }
    for (const int size : sizes) EXPECT_TRUE(size >= 1 && size <= 1 << pairings) << size;
    std::vector<std::vector<double>> dense(coarse.graph.Size(),
                                           std::vector<double>(coarse.graph.Size(), 0.0));
    for (std::uint32_t i = 0; i < fine.graph.Size(); ++i) {
      for (auto h = fine.graph.starts[i]; h < fine.graph.starts[i + 1]; ++h) {
        const std::uint32_t from = aggregate[i], to = aggregate[fine.graph.others[h]];
        if (from != to) dense[from][to] += fine.stiffness[h];
      }
    }
    for (std::uint32_t a = 0; a < coarse.graph.Size(); ++a) {
      std::set<std::uint32_t> row;
      for (auto h = coarse.graph.starts[a]; h < coarse.graph.starts[a + 1]; ++h) {
        EXPECT_TRUE(row.empty() || *row.rbegin() < coarse.graph.others[h]);
        row.insert(coarse.graph.others[h]);
        EXPECT_NEAR(coarse.stiffness[h], dense[a][coarse.graph.others[h]], 1e-9);
      }
      for (std::uint32_t b = 0; b < coarse.graph.Size(); ++b) EXPECT_EQ(dense[a][b] > 0.0, row.contains(b));
    }
  }
}

// Spare nodes do not hang about on the coarser levels: the last one is small enough for a direct solution.
TEST(HierarchyBuilder, LeavesSpareNodesOut) {
  Theatre theatre(3);
  for (int more = 0; more < 500; ++more) {
    theatre.definition.rest.push_back({});
    theatre.definition.mass.push_back(0), theatre.definition.shape_stiffness.push_back(0);
  }
  const LinkGraph fine = MakeLinkGraph(MakeTissueModel(theatre.definition));
  HierarchyTopology hierarchy;
  HierarchyBuilder().Build(fine.graph, fine.stiffness, hierarchy);
  EXPECT_LE(hierarchy.Coarsest().layout.node_count, 24u);
  EXPECT_LT(hierarchy.levels[1].layout.node_count, theatre.mesh.positions.size() / 2);
}

}  // namespace
}  // namespace trocar::tissue
