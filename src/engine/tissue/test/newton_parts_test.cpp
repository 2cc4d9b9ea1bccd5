// SPDX-License-Identifier: Apache-2.0
/// \file newton_parts_test.cpp  The parts of Newton's method, each against a slow and plain one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <vector>

#include "evaluated.h"
#include "line_smoother.h"
#include "linearisation.h"
#include "local_solve.h"
#include "test_systems.h"
#include "trocar/tissue/equilibrium.h"
#include "trocar_test/threads.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

/// A pressed and pulled sphere with strands, a duct of two rows of springs at its pole, and a spring whose ends meet.
struct Patient {
  TissueDefinition definition;
  std::vector<std::uint32_t> duct;
  std::vector<ContactSpring> contacts;

  explicit Patient(int duct_nodes = 20) {
    definition = MakeMembrane(geometry::MakeSphere({0, 0, 0}, 0.03, 3), 100.0, 1e5);
    std::uint32_t last = 0;
    const auto surface = static_cast<std::uint32_t>(definition.rest.size());
    for (int i = 0; i < duct_nodes; ++i) {
      const auto node = static_cast<std::uint32_t>(definition.rest.size());
      definition.rest.push_back(definition.rest[0] +
                                Vec3{0.001 * std::sin(0.3 * i), 0.0005 * i, 0.002 * (i + 1)});
      definition.mass.push_back(1e-4);
      definition.shape_stiffness.push_back(0.5);
      if (i == 0) {
        definition.strands.push_back({last, node, 900.0});
      } else {
        AddSpring(last, node, 1500.0);
      }
      if (i > 1) AddSpring(node - 2, node, 300.0);
      duct.push_back(node);
      last = node;
    }
    definition.strands.push_back({surface / 2, surface / 3, 40.0});
    contacts = {{{9, 10, 11}, {1. / 3, 1. / 3, 1. / 3}, {0, 0, 1}, 0.031, 500.0}};
  }

  void AddSpring(std::uint32_t a, std::uint32_t b, double k) {
    definition.springs.push_back({a, b, k, math::Distance(definition.rest[a], definition.rest[b])});
  }
};

TissueState Shake(const TissueModel& model, double by, unsigned seed) {
  TissueState state = MakeRestState(model);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> offset(-by, by);
  for (Vec3& p : state.position) p += {offset(random), offset(random), offset(random)};
  state.condition[5] = NodeCondition::kPrescribed;
  return state;
}

double Norm(const Float4& v) {
  return std::sqrt(static_cast<double>(v.x * v.x + v.y * v.y + v.z * v.z));
}

/// Off-diagonal and diagonal blocks, inverse blocks and what is free, of all levels.
std::vector<float> Values(const LinkHierarchy& hierarchy) {
  std::vector<float> all;
  for (const LinkLevel& level : hierarchy.Levels()) {
    for (const auto* values : {&level.links, &level.diagonal_excess, &level.inverse, &level.is_free})
      all.insert(all.end(), values->begin(), values->end());
  }
  return all;
}

/// Value v of the `floats` of a node or an entry.
double ValueAt(const math::AlignedVector<float>& values, std::size_t at, std::size_t v,
               std::size_t floats = 6) {
  return static_cast<double>(
      values[at / kSliceNodes * floats * kSliceNodes + v * kSliceNodes + at % kSliceNodes]);
}

/// What an entry adds to the coarser level: a spring nothing that would soften its ends across.
std::array<double, 6> StableBlock(const LinkLevel& level, std::size_t entry) {
  std::array<double, 6> block;
  for (std::size_t v = 0; v < 6; ++v)
    block[v] = v < level.link_floats ? ValueAt(level.links, entry, v, level.link_floats) : 0.0;
  if (level.link_floats == kBlockFloats) return block;
  const double across = std::max(0.0, block[0]), x = block[1], y = block[2], z = block[3];
  return {across + x * x, x * y, x * z, across + y * y, y * z, across + z * z};
}

// Oracle: two aggregates' members, pair by pair. What joins a member to a held node holds its aggregate.
TEST(LinkHierarchy, CoarseLevelsAreTheSumsOfTheirMembers) {
  const Patient patient;
  const TissueModel model = MakeTissueModel(patient.definition);
  Evaluated evaluated(model, {}, Shake(model, 1e-3, 3), Levels().back());
  evaluated.hierarchy.UpdateCoarse(*evaluated.kernels, evaluated.workers);
  const auto levels = evaluated.hierarchy.Levels();
  ASSERT_GE(levels.size(), 3u);
  for (std::size_t at = 0; at + 1 < levels.size(); ++at) {
    const LinkLevel &fine = levels[at], &coarse = levels[at + 1];
    const std::vector<std::uint32_t>& aggregate = evaluated.made.hierarchy.levels[at].aggregate;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::array<double, 6>> links;
    std::vector<std::array<double, 6>> diagonals(coarse.Size());
    std::size_t held = 0;
    for (std::uint32_t i = 0; i < fine.Size(); ++i) {
      if (fine.is_free[i] == 0.0f || aggregate[i] == Aggregation::kNone) continue;
      auto& diagonal = diagonals[aggregate[i]];
      for (std::size_t v = 0; v < 6; ++v) diagonal[v] += ValueAt(fine.diagonal_excess, i, v);
      for (std::uint32_t h = 0; h < fine.layout->RowSteps(i); ++h) {
        const std::size_t entry = fine.layout->Entry(i, h);
        const std::uint32_t other = fine.layout->others[entry];
        if (other == i) break;
        const std::array<double, 6> link = StableBlock(fine, entry);
        const bool is_held = fine.is_free[other] == 0.0f;
        held += is_held;
        if (!is_held && aggregate[other] == aggregate[i]) continue;
        auto& sum = is_held ? diagonal : links[{aggregate[i], aggregate[other]}];
        for (std::size_t v = 0; v < 6; ++v) sum[v] += (is_held ? 1.0 : 0.7) * link[v];
      }
    }
    EXPECT_TRUE(at > 0 || held > 0) << "the patient has held nodes";
    for (std::uint32_t a = 0; a < coarse.Size(); ++a) {
      for (std::size_t v = 0; v < 6; ++v) {
        EXPECT_NEAR(ValueAt(coarse.diagonal_excess, a, v), diagonals[a][v],
                    1e-6 * (std::fabs(diagonals[a][0]) + 1000.0))
            << at << " " << a;
      }
      for (std::uint32_t h = 0; h < coarse.layout->RowSteps(a); ++h) {
        const std::size_t entry = coarse.layout->Entry(a, h);
        const std::uint32_t b = coarse.layout->others[entry];
        if (b == a) break;
        const std::array<double, 6> sum = links[{a, b}];
        for (std::size_t v = 0; v < 6; ++v) {
          EXPECT_NEAR(ValueAt(coarse.links, entry, v), sum[v], 1e-6 * (std::fabs(sum[0]) + 1000.0))
              << at << ": " << a << " " << b;
        }
      }
    }
  }
}

// Nothing of what the levels held before is left, and sums do not depend on who forms them.
TEST(LinkHierarchy, CoarseLevelsAreAsMadeAnewForAnyThreads) {
  const Patient patient;
  const TissueModel model = MakeTissueModel(patient.definition);
  const base::SimdLevel level = Levels().back();
  TissueState other = Shake(model, 1e-3, 3);
  other.condition[5] = NodeCondition::kFree, other.condition[70] = NodeCondition::kPrescribed;
  Evaluated anew(model, {}, Shake(model, 5e-4, 7), level);
  anew.hierarchy.UpdateCoarse(*anew.kernels, anew.workers);
  ASSERT_GE(anew.hierarchy.Levels().size(), 3u);
  const std::vector<float> expected = Values(anew.hierarchy);
  for (const int threads : {1, 2, 3, 4, 8}) {
    Evaluated again(model, {}, other, level);
    Workers workers(test::UseThreads(threads));
    const Workers::Session session(workers);
    again.hierarchy.UpdateCoarse(*again.kernels, workers);
    ASSERT_NE(Values(again.hierarchy), expected);
    LinkLevel& finest = again.hierarchy.Finest();
    const LinkLevel& wanted = anew.hierarchy.Finest();
    finest.links = wanted.links, finest.diagonal_excess = wanted.diagonal_excess,
    finest.inverse = wanted.inverse;
    finest.is_free = wanted.is_free;
    again.hierarchy.UpdateCoarse(*again.kernels, workers);
    EXPECT_EQ(Values(again.hierarchy), expected) << threads << " threads";
  }
}

// A load of 64 bytes that crosses a cache line counts twice.
TEST(LinkHierarchy, ArraysBeginAtCacheLines) {
  const Patient patient;
  const TissueModel model = MakeTissueModel(patient.definition);
  const Evaluated here(model, {}, MakeRestState(model), Levels().back());
  const auto is_aligned = [](const void* p) {
    return reinterpret_cast<std::uintptr_t>(p) % math::kCacheLine == 0;
  };
  for (const LinkLevel& level : here.hierarchy.Levels()) {
    for (const auto* values : {&level.links, &level.diagonal_excess, &level.inverse, &level.is_free})
      EXPECT_TRUE(is_aligned(values->data()));
    for (const auto* nodes : {&level.x, &level.b, &level.r}) EXPECT_TRUE(is_aligned(nodes->data()));
  }
  EXPECT_TRUE(is_aligned(here.springs.stiffness.data()) && is_aligned(here.springs.rest_length.data()));
}

// Oracle: forces and differences of energy against the plain evaluation, with every kind of spring.
TEST(Linearisation, AgreesWithThePlainResidualAndEnergy) {
  Patient patient;
  patient.definition.rest.push_back(patient.definition.rest.back());
  patient.definition.mass.push_back(1e-4), patient.definition.shape_stiffness.push_back(1.0);
  const auto n = static_cast<std::uint32_t>(patient.definition.rest.size());
  patient.definition.springs.push_back({n - 2, n - 1, 50.0, 0.001});
  const TissueModel model = MakeTissueModel(patient.definition);
  const TissueLoad load{
      .gravity = {1, 2, -9.81}, .stiffness_scale = 1.3, .shape_scale = 0.7, .contacts = patient.contacts};
  const TissueState rest = MakeRestState(model), state = Shake(model, 5e-4, 7);
  std::vector<Vec3> expected(model.Size());
  CalcResidual(model, state, load, expected);
  double largest = 0;
  for (const Vec3& f : expected) largest = std::max(largest, math::Norm(f));
  for (const base::SimdLevel level : Levels()) {
    const Evaluated here(model, load, state, level), before(model, load, rest, level);
    EXPECT_TRUE(here.balance.is_pressing[0] != 0);
    for (std::uint32_t i = 0; i < model.Size(); ++i) {
      const std::uint32_t old = here.model.old_of_new[i];
      const Float4& found = here.balance.residual[i];
      const Vec3 force{found.x, found.y, found.z};
      const Vec3 wanted = state.condition[old] == NodeCondition::kPrescribed ? Vec3{} : expected[old];
      ASSERT_LT(math::Distance(force, wanted), 1e-6 * largest)
          << base::SimdLevelName(level) << " node " << old;
    }
    const double change = CalcEnergy(model, state, load) - CalcEnergy(model, rest, load);
    EXPECT_NEAR(here.balance.energy - before.balance.energy, change, 1e-9 * std::fabs(change))
        << base::SimdLevelName(level);
  }
}

// The stiffness is the change of the residual, by differences.
TEST(Linearisation, StiffnessIsTheDerivativeOfTheResidual) {
  const Patient patient;
  const TissueModel model = MakeTissueModel(patient.definition);
  const TissueLoad load{};
  const TissueState state = Shake(model, 5e-4, 8);
  const double by = 1e-8;
  for (const base::SimdLevel level : Levels()) {
    Evaluated here(model, load, state, level);
    std::vector<Float4> direction(here.balance.residual.size()), product = direction;
    TissueState moved = state;
    std::mt19937 random(3);
    std::uniform_real_distribution<float> part(-1, 1);
    for (std::uint32_t i = 0; i < model.Size(); ++i) {
      if (!here.load.is_free[i]) continue;
      const Float4 d = direction[i] = {part(random), part(random), part(random), 0};
      moved.position[here.model.old_of_new[i]] +=
          by * Vec3{static_cast<double>(d.x), static_cast<double>(d.y), static_cast<double>(d.z)};
    }
    RunPass(*here.kernels, here.workers, here.hierarchy.Finest(), LinkPass::kProduct, direction.data(),
            nullptr, 0.0f, product.data());
    std::vector<Vec3> before(model.Size()), after(model.Size());
    CalcResidual(model, state, load, before);
    CalcResidual(model, moved, load, after);
    double largest = 0;
    for (const Float4& f : product) largest = std::max(largest, Norm(f));
    for (std::uint32_t i = 0; i < model.Size(); ++i) {
      const std::uint32_t old = here.model.old_of_new[i];
      if (!here.load.is_free[i]) continue;
      const Vec3 wanted = (before[old] - after[old]) / by;
      const Vec3 found{product[i].x, product[i].y, product[i].z};
      ASSERT_LT(math::Distance(found, wanted), 1e-4 * largest)
          << base::SimdLevelName(level) << " node " << old;
    }
  }
}

TEST(Linearisation, EachWidthOfVectorsGivesTheSameBits) {
  const Patient patient;
  const TissueModel model = MakeTissueModel(patient.definition);
  const TissueLoad load{.gravity = {0, 0, -9.81}, .contacts = patient.contacts};
  const TissueState state = Shake(model, 1e-3, 9);
  const Evaluated a(model, load, state, base::SimdLevel::kBaseline);
  for (const base::SimdLevel level : Levels()) {
    const Evaluated b(model, load, state, level);
    EXPECT_EQ(a.balance.energy, b.balance.energy) << base::SimdLevelName(level);
    EXPECT_EQ(a.hierarchy.Finest().links, b.hierarchy.Finest().links) << base::SimdLevelName(level);
    EXPECT_EQ(a.hierarchy.Finest().inverse, b.hierarchy.Finest().inverse) << base::SimdLevelName(level);
    for (std::size_t i = 0; i < a.balance.residual.size(); ++i) {
      const Float4 &x = a.balance.residual[i], &y = b.balance.residual[i];
      ASSERT_TRUE(x.x == y.x && x.y == y.y && x.z == y.z) << base::SimdLevelName(level) << " node " << i;
    }
  }
}

// A duct is found, a surface is not, and the solution balances: K x = b where all but the chain stand still.
TEST(LineSmoother, SolveTheDuctExactly) {
  const Patient patient;
  const TissueModel model = MakeTissueModel(patient.definition);
  const TissueState state = MakeRestState(model);
  Evaluated here(model, {}, state, base::SimdLevel::kBaseline);
  LineSmoother smoother(here.model.graph, here.model.layout);
  std::vector<std::uint32_t> found;
  for (const std::uint32_t i : smoother.Nodes()) found.push_back(here.model.old_of_new[i]);
  std::sort(found.begin(), found.end());
  ASSERT_EQ(found, patient.duct);
  std::vector<Float4> b(here.balance.residual.size()), x = b, product = b;
  for (const std::uint32_t i : smoother.Nodes()) b[i] = {1.0f, -0.5f, 0.25f, 0.0f};
  smoother.Factorise(here.hierarchy.Finest());
  smoother.Solve(here.hierarchy.Finest(), nullptr, b.data());
  smoother.Add(nullptr, 1.0f, x.data());
  RunPass(*here.kernels, here.workers, here.hierarchy.Finest(), LinkPass::kProduct, x.data(), nullptr, 0.0f,
          product.data());
  for (const std::uint32_t i : smoother.Nodes())
    EXPECT_LT(Norm({product[i].x - b[i].x, product[i].y - b[i].y, product[i].z - b[i].z, 0}), 2e-3);
  // from there nothing is left to correct
  std::vector<Float4> again = x;
  smoother.Solve(here.hierarchy.Finest(), x.data(), b.data());
  smoother.Add(x.data(), 1.0f, again.data());
  for (const std::uint32_t i : smoother.Nodes())
    EXPECT_LT(Norm({again[i].x - x[i].x, again[i].y - x[i].y, again[i].z - x[i].z, 0}), 2e-3 * Norm(x[i]));
}

TEST(LineSmoother, ASurfaceIsNone) {
  const TissueModel model =
      MakeTissueModel(MakeMembrane(geometry::MakeSphere({0, 0, 0}, 0.03, 3), 100.0, 1e5));
  const OrderedModel ordered = MakeOrderedModel(model);
  EXPECT_TRUE(LineSmoother(ordered.graph, ordered.layout).Nodes().empty());
}

// What the solver promises, where it is hardest: a soft duct on a stiff surface.
TEST(NewtonMultigrid, KeepsItsPromiseOnADuct) {
  const Patient patient(60);
  const TissueModel model = MakeTissueModel(patient.definition);
  TissueState state = MakeRestState(model);
  state.condition[patient.duct.back()] = NodeCondition::kPrescribed;
  EquilibriumSolver solver(model), judge(model);
  SolverSettings settings;
  settings.kind = SolverKind::kNewtonMultigrid;
  SolverSettings exact = settings;
  exact.max_error = 1e-9, exact.newton.max_steps = 200, exact.newton.max_linear_iterations = 1000;
  for (int tick = 0; tick < 20; ++tick) {
    state.position[patient.duct.back()] += {0.0002, 0.0005, 0.0};
    const SolveReport report = solver.Solve(settings, {}, state);
    ASSERT_TRUE(report.converged) << "tick " << tick;
    TissueState truth = state;
    (void)judge.Solve(exact, {}, truth);
    double error = 0, scale = 0;
    for (std::size_t i = 0; i < model.Size(); ++i) {
      error = std::max(error, math::Distance(state.position[i], truth.position[i]));
      scale = std::max(scale, math::Distance(truth.position[i], model.rest[i]));
    }
    EXPECT_LT(error, 1e-3 * scale) << "tick " << tick;
  }
}

/// A step in which the listed nodes of the model go far and all others a hundredth of that.
std::vector<Float4> MakeStep(const OrderedModel& model, const std::vector<std::uint32_t>& far) {
  std::vector<Float4> step(model.layout.PaddedNodes(), Float4{1e-5f, 0, 0, 0});
  for (const std::uint32_t node : far) step[model.new_of_old[node]] = {0, 1e-3f, 0, 0};
  return step;
}

// Oracle: another solver, for which every other node is prescribed. There are a contact, strands, a duct and a load.
TEST(LocalSolve, ComesToRestWhereAllOthersAreHeld) {
  const Patient patient;
  const std::uint32_t alone = patient.duct.back();
  const TissueModel model = MakeTissueModel(patient.definition);
  TissueState state = Shake(model, 3e-5, 7);
  std::vector<Vec3> external(model.Size());
  for (const std::uint32_t node : {9u, 30u, alone}) external[node] = {1e-4, -2e-4, 3e-4};
  ContactSpring contact{
      .weights = {0.5, 0.3, 0.2}, .normal = (-1.0 / 0.03) * model.rest[9], .stiffness = 500.0};
  const std::uint32_t* const next = &model.spring_starts[9];
  contact.nodes = {9, model.half_springs[*next].other, model.half_springs[*next + 1].other};
  for (int corner = 0; corner < 3; ++corner)
    contact.offset +=
        contact.weights[corner] * math::Dot(contact.normal, state.position[contact.nodes[corner]]);
  contact.offset += 1e-4;
  // a node of the duct against the triangle of the tool
  ElementArrays elements;
  SurfaceContact& pressed = elements.Of<SurfaceContact>().emplace_back();
  pressed = {.nodes = {patient.duct[2], contact.nodes[0], contact.nodes[1], contact.nodes[2]},
             .stiffness = 50.0};
  const auto corners = GatherPositions(pressed, [&](std::uint32_t node) { return state.position[node]; });
  pressed.gap = 1e-4 + CalcContactPlane(pressed, corners).distance;
  if (!(pressed.gap > 1e-4)) {
    std::swap(pressed.nodes[2], pressed.nodes[3]);
    pressed.gap = 2e-4 - pressed.gap;
  }
  const TissueLoad load{.gravity = {0, 0.1, -0.9},
                        .contacts = std::span(&contact, 1),
                        .external_force = external,
                        .elements = &elements};
  Evaluated whole(model, load, state, base::FindSimdLevel());
  const std::vector<Double4> before = whole.position;

  LocalSolve local(whole.model, whole.springs);
  const auto step = MakeStep(whole.model, {9, patient.duct[2], 30});
  ASSERT_TRUE(local.Gather(whole.load, state.strand_is_intact, step, 1e-3));
  std::vector<Float4> more(whole.model.layout.PaddedNodes());
  for (const std::uint32_t i : local.Free()) more[i] = {1e-4f, 0, -2e-4f, 0};
  local.AddForce(more, -0.5);
  const auto solve = [&] { return local.Solve(*whole.kernels, whole.workers, 1e-10, 0.003, whole.position); };
  const auto report = solve();
  EXPECT_GT(report.steps, 1);
  EXPECT_GT(report.longest, 1e-5);
  EXPECT_LT(report.smallest_ritz, 1.0);
  local.TakeBack(whole.position);
  for (std::uint32_t i = 0; i < model.Size(); ++i)
    ASSERT_EQ(whole.position[i].y, before[i].y) << "node " << i;
  for (int again = 0; again < 5 && solve().steps > 0; ++again) {
  }

  TissueState truth = state;
  std::fill(truth.condition.begin(), truth.condition.end(), NodeCondition::kPrescribed);
  for (const std::uint32_t i : local.Free()) {
    truth.condition[whole.model.old_of_new[i]] = NodeCondition::kFree;
    external[whole.model.old_of_new[i]] += Vec3{-0.5 * double{1e-4f}, 0, 0.5 * double{2e-4f}};
  }
  EquilibriumSolver solver(model);
  const SolverSettings exact{
      .kind = SolverKind::kChebyshevJacobi2015, .max_iterations = 20000, .tolerance = 1e-11};
  ASSERT_TRUE(solver.Solve(exact, load, truth).converged);
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    const Double4& here = whole.position[i];
    EXPECT_LT(math::Distance(truth.position[whole.model.old_of_new[i]], {here.x, here.y, here.z}), 1e-8)
        << "node " << i;
  }
}

TEST(LocalSolve, IsASmallPartOfTheModelOrNone) {
  const Patient patient;
  const TissueModel model = MakeTissueModel(patient.definition);
  const TissueState state = Shake(model, 3e-5, 7);
  const Evaluated whole(model, {}, state, base::SimdLevel::kBaseline);
  LocalSolve local(whole.model, whole.springs);
  // slow: two rings around node 9, less what is held
  std::vector<bool> is_near(model.Size());
  is_near[9] = true;
  for (int ring = 0; ring < 2; ++ring) {
    const std::vector<bool> inner = is_near;
    for (std::uint32_t i = 0; i < model.Size(); ++i) {
      for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h)
        is_near[i] = is_near[i] || inner[model.half_springs[h].other];
    }
  }
  is_near[5] = false;
  std::vector<std::uint32_t> expected;
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    if (is_near[whole.model.old_of_new[i]]) expected.push_back(i);
  }
  for (int repeat = 0; repeat < 2; ++repeat) {  // nothing stays from the one before
    ASSERT_TRUE(local.Gather(whole.load, state.strand_is_intact, MakeStep(whole.model, {9}), 1e-3));
    EXPECT_TRUE(std::ranges::equal(local.Free(), expected));
    std::vector<std::uint32_t> all;
    for (std::uint32_t i = 0; i < model.Size(); ++i) all.push_back(i);
    EXPECT_FALSE(local.Gather(whole.load, state.strand_is_intact, MakeStep(whole.model, all), 1e-3));
    EXPECT_TRUE(local.Free().empty());
  }
  EXPECT_FALSE(local.Gather(whole.load, state.strand_is_intact, MakeStep(whole.model, {5}), 1e-3))
      << "held nodes do not move";
}

// Conjugate gradients on a diagonal matrix whose eigenvalues are known.
}  // namespace
}  // namespace trocar::tissue
