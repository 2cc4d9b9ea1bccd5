// SPDX-License-Identifier: Apache-2.0
/// \file element_kinds_test.cpp  Tests that every kind of element passes: a kind that joins the list joins them.
#include "trocar/tissue/element_kinds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "element_examples.h"
#include "evaluated.h"
#include "test_systems.h"
#include "trocar/base/state_archive.h"
#include "trocar/math/pose.h"
#include "trocar/tissue/equilibrium.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

constexpr int kDraws = 20;

/// A square matrix, row by row.
struct Dense {
  explicit Dense(std::size_t n) : size(n), values(n * n, 0.0) {}
  double& At(std::size_t row, std::size_t column) { return values[row * size + column]; }
  double At(std::size_t row, std::size_t column) const { return values[row * size + column]; }
  double Largest() const {
    double largest = 0;
    for (const double value : values) largest = std::max(largest, std::fabs(value));
    return largest;
  }

  std::size_t size;
  std::vector<double> values;
};

void AddBlock(std::size_t i, std::size_t j, bool is_diagonal, const StiffnessBlock& block, Dense& to) {
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      to.At(3 * i + a, 3 * j + b) += block[3 * a + b];
      if (!is_diagonal) to.At(3 * j + b, 3 * i + a) += block[3 * a + b];
    }
  }
}

template <typename Kind>
Dense CalcDense(const Kind& element, const ElementVectors<Kind::kNodes>& position, StiffnessPart part) {
  ElementStiffness<Kind::kNodes> stiffness;
  AddElementStiffness(element, position, part, stiffness);
  Dense made(3 * Kind::kNodes);
  for (std::size_t i = 0; i < Kind::kNodes; ++i) {
    for (std::size_t j = i; j < Kind::kNodes; ++j) AddBlock(i, j, i == j, stiffness.At(i, j), made);
  }
  return made;
}

Dense CalcDense(const ElementMatrix& matrix, std::size_t nodes) {
  Dense made(3 * nodes);
  matrix.ForEachBlock([&](std::uint32_t i, std::uint32_t j, bool is_diagonal, const StiffnessBlock& block) {
    AddBlock(i, j, is_diagonal, block, made);
  });
  return made;
}

/// Whether a + shift I has a Cholesky factor.
bool IsPositive(Dense a, double shift) {
  for (std::size_t j = 0; j < a.size; ++j) {
    a.At(j, j) += shift;
  }
  for (std::size_t j = 0; j < a.size; ++j) {
    if (!(a.At(j, j) > 0.0)) return false;
    for (std::size_t i = j + 1; i < a.size; ++i) {
      const double share = a.At(i, j) / a.At(j, j);
      for (std::size_t k = j; k < a.size; ++k) a.At(i, k) -= share * a.At(j, k);
    }
  }
  return true;
}

Dense Difference(const Dense& a, const Dense& b) {
  Dense made = a;
  for (std::size_t i = 0; i < a.values.size(); ++i) made.values[i] -= b.values[i];
  return made;
}

template <typename Kind>
class EveryElement : public testing::Test {};
using AllKinds = ElementArrays::Apply<testing::Types>;
TYPED_TEST_SUITE(EveryElement, AllKinds);

TYPED_TEST(EveryElement, ForceIsMinusTheGradientOfTheEnergy) {
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    math::Random random(seed);
    auto [element, x] = MakeExample<TypeParam>(random);
    EXPECT_GT(CalcElementEnergy(element, x), 0.0) << "seed " << seed << ": it does not act";
    const auto force = CalcElementForce(element, x);
    for (std::size_t node = 0; node < TypeParam::kNodes; ++node) {
      for (int axis = 0; axis < 3; ++axis) {
        constexpr double kStep = 1e-7;
        const double here = x[node][axis];
        x[node][axis] = here + kStep;
        const double above = CalcElementEnergy(element, x);
        x[node][axis] = here - kStep;
        const double below = CalcElementEnergy(element, x);
        x[node][axis] = here;
        EXPECT_NEAR(force[node][axis], (below - above) / (2 * kStep), 1e-6)
            << "seed " << seed << " node " << node;
      }
    }
  }
}

TYPED_TEST(EveryElement, WholeStiffnessIsTheDerivativeOfTheForce) {
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    math::Random random(seed);
    auto [element, x] = MakeExample<TypeParam>(random);
    const Dense stiffness = CalcDense(element, x, StiffnessPart::kWhole);
    for (std::size_t node = 0; node < TypeParam::kNodes; ++node) {
      for (int axis = 0; axis < 3; ++axis) {
        constexpr double kStep = 1e-7;
        const double here = x[node][axis];
        x[node][axis] = here + kStep;
        const auto above = CalcElementForce(element, x);
        x[node][axis] = here - kStep;
        const auto below = CalcElementForce(element, x);
        x[node][axis] = here;
        for (std::size_t other = 0; other < TypeParam::kNodes; ++other) {
          for (int along = 0; along < 3; ++along) {
            EXPECT_NEAR(stiffness.At(3 * other + static_cast<std::size_t>(along),
                                     3 * node + static_cast<std::size_t>(axis)),
                        (below[other][along] - above[other][along]) / (2 * kStep), 1e-5 * stiffness.Largest())
                << "seed " << seed << " nodes " << other << " " << node;
          }
        }
      }
    }
  }
}

TYPED_TEST(EveryElement, FirmStiffnessIsPositiveAndWithinItsBounds) {
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    math::Random random(seed);
    const auto example = MakeExample<TypeParam>(random);
    const auto& element = example.element;  // clang 14 lets no lambda see a structured binding
    const auto& x = example.position;
    const Dense firm = CalcDense(element, x, StiffnessPart::kFirm);
    const Dense bound = CalcDense(element, x, StiffnessPart::kBound);
    const double rounding = 1e-9 * bound.Largest();
    EXPECT_GT(firm.Largest(), 0.0) << "seed " << seed;
    EXPECT_TRUE(IsPositive(firm, rounding)) << "seed " << seed;
    EXPECT_TRUE(IsPositive(Difference(bound, firm), rounding)) << "seed " << seed;
    // the smoother's: K <= 2 D, and D no less than the nodes' own blocks
    ElementMatrix matrix;
    SetElementMatrix(
        [&] {
          ElementArrays elements;
          elements.Of<TypeParam>().push_back(element);
          return elements;
        }(),
        [&](std::uint32_t node) { return x[node]; }, StiffnessPart::kFirm, [](std::uint32_t) { return true; },
        matrix);
    Dense twice(firm.size), own(firm.size);
    matrix.ForEachBound([&](std::uint32_t node, const std::array<double, 6>& m) {
      const StiffnessBlock block = {m[0], m[1], m[2], m[1], m[3], m[4], m[2], m[4], m[5]};
      AddBlock(node, node, true, block, twice), AddBlock(node, node, true, block, twice);
      AddBlock(node, node, true, block, own);
    });
    EXPECT_TRUE(IsPositive(Difference(twice, firm), rounding)) << "seed " << seed;
    for (std::size_t node = 0; node < TypeParam::kNodes; ++node) {
      for (std::size_t axis = 3 * node; axis < 3 * node + 3; ++axis)
        EXPECT_GE(own.At(axis, axis), firm.At(axis, axis) - rounding) << "seed " << seed;
    }
  }
}

TYPED_TEST(EveryElement, ForcesAndTorquesSumToZeroWhereItSaysSo) {
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    math::Random random(seed);
    const auto [element, x] = MakeExample<TypeParam>(random);
    const auto force = CalcElementForce(element, x);
    Vec3 sum, torque;
    double largest = 0;
    for (std::size_t i = 0; i < TypeParam::kNodes; ++i) {
      sum += force[i];
      torque += math::Cross(x[i], force[i]);
      largest = std::max(largest, math::Norm(force[i]));
    }
    ASSERT_GT(largest, 0.0);
    const bool has_no_sum = math::Norm(sum) < 1e-12 * largest;
    const bool has_no_torque = has_no_sum && math::Norm(torque) < 1e-12 * 0.1 * largest;
    EXPECT_EQ(has_no_sum, TypeParam::kInvariance != ElementInvariance::kNone) << "seed " << seed;
    EXPECT_EQ(has_no_torque, TypeParam::kInvariance == ElementInvariance::kMotions) << "seed " << seed;
  }
}

// --- state

template <typename Kind>
ElementArrays DrawArray(std::size_t count) {
  math::Random random(5);
  ElementArrays elements;
  for (std::size_t i = 0; i < count; ++i) elements.Of<Kind>().push_back(MakeExample<Kind>(random).element);
  return elements;
}

std::vector<std::byte> Save(ElementArrays& elements) {
  std::vector<std::byte> bytes;
  base::StateArchive archive = base::StateArchive::ForSave(bytes);
  VisitState(archive, elements, 5);
  return bytes;
}

TYPED_TEST(EveryElement, SavesAndRestoresToTheBit) {
  ElementArrays elements = DrawArray<TypeParam>(3), restored = DrawArray<TypeParam>(1);
  const std::vector<std::byte> bytes = Save(elements);
  base::StateArchive archive = base::StateArchive::ForRestore(bytes);
  VisitState(archive, restored, 5);
  ASSERT_TRUE(archive.ok()) << archive.Failure();
  EXPECT_TRUE(archive.IsAtEnd());
  EXPECT_EQ(Save(restored), bytes);
  math::Random random(5);
  for (const TypeParam& element : restored.Of<TypeParam>()) {
    const auto [expected, x] = MakeExample<TypeParam>(random);
    EXPECT_EQ(element.nodes, expected.nodes);
    EXPECT_EQ(CalcElementEnergy(element, x), CalcElementEnergy(expected, x));
  }
  // every byte counts
  std::set<std::vector<std::byte>> seen{bytes};
  for (TypeParam& element : elements.Of<TypeParam>()) {
    element.stiffness *= 2;
    EXPECT_TRUE(seen.insert(Save(elements)).second);
  }
}

TYPED_TEST(EveryElement, RestoringRefusesWhatNoSystemHas) {
  const auto refuses = [](ElementArrays wrong) {
    const std::vector<std::byte> bytes = Save(wrong);
    base::StateArchive archive = base::StateArchive::ForRestore(bytes);
    ElementArrays restored;
    VisitState(archive, restored, 5);
    return !archive.ok();
  };
  EXPECT_FALSE(refuses(DrawArray<TypeParam>(2)));
  ElementArrays far = DrawArray<TypeParam>(2), broken = far;
  far.Of<TypeParam>()[1].nodes.back() = 5;
  EXPECT_TRUE(refuses(far)) << "there are five nodes";
  broken.Of<TypeParam>()[0].stiffness = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refuses(broken));
  EXPECT_TRUE(refuses(DrawArray<TypeParam>(TypeParam::kCapacity + 1)));
}

TYPED_TEST(EveryElement, ACutThroughABondEndsIt) {
  ElementArrays elements = DrawArray<TypeParam>(2);
  auto& array = elements.Of<TypeParam>();
  for (std::uint32_t& node : array[1].nodes) node += 10;
  EXPECT_EQ(FollowCut({}, elements), 0u);
  for (const ElementBond& bond : TypeParam::kBonds) {
    const auto [low, high] = std::minmax(array[1].nodes[bond[0]], array[1].nodes[bond[1]]);
    ElementArrays cut = elements;
    // others are cut too, before and behind in the list
    const std::vector<PartedNodes> parted = {{0, 99}, {low, high}, {50, 51}};
    EXPECT_EQ(FollowCut(parted, cut), 1u);
    ASSERT_EQ(cut.Of<TypeParam>().size(), 1u);
    EXPECT_EQ(cut.Of<TypeParam>()[0].nodes, array[0].nodes);
  }
}

// --- in a system

/// The nodes of an element, each with an anchor and a chain of springs that leads away: several levels of the multigrid.
template <typename Kind>
struct ElementSystem {
  TissueModel model;
  TissueState state;  // at the example's positions
  ElementArrays elements;

  explicit ElementSystem(std::uint64_t seed, std::uint32_t chain = 10) {
    math::Random random(seed);
    const auto [element, x] = MakeExample<Kind>(random);
    elements.Of<Kind>().push_back(element);
    TissueDefinition definition;
    definition.rest.assign(x.begin(), x.end());
    for (std::uint32_t i = 0; i < Kind::kNodes; ++i) {
      std::uint32_t last = i;
      const Vec3 along = 0.004 * math::Normalized(DrawVector(random, 1));
      for (std::uint32_t k = 0; k < chain; ++k) {
        const auto next = static_cast<std::uint32_t>(definition.rest.size());
        definition.rest.push_back(definition.rest[last] + along);
        definition.springs.push_back({last, next, 300.0, 0.004});
        last = next;
      }
    }
    definition.mass.assign(definition.rest.size(), 1e-3);
    definition.shape_stiffness.assign(definition.rest.size(), 20.0);
    model = MakeTissueModel(definition);
    state = MakeRestState(model);
  }
  TissueLoad Load() const { return {.gravity = {0.2, 0.1, -0.4}, .elements = &elements}; }
};

TYPED_TEST(EveryElement, BalanceAndProductAreThoseOfThePlainEvaluation) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    ElementSystem<TypeParam> system(seed);
    system.state.condition[0] = seed == 5 ? NodeCondition::kPrescribed : NodeCondition::kFree;
    std::mt19937 random(static_cast<unsigned>(seed));
    std::uniform_real_distribution<double> offset(-2e-4, 2e-4);
    TissueState moved = system.state;
    for (Vec3& p : moved.position) p += {offset(random), offset(random), offset(random)};
    moved.position[0] = system.state.position[0];
    const TissueLoad load = system.Load();
    std::vector<Vec3> expected(system.model.Size());
    CalcResidual(system.model, moved, load, expected);
    for (const base::SimdLevel level : Levels()) {
      Evaluated before(system.model, load, system.state, level), here(system.model, load, moved, level);
      for (std::uint32_t i = 0; i < system.model.Size(); ++i) {
        const std::uint32_t old = here.model.old_of_new[i];
        const Float4& found = here.balance.residual[i];
        const bool is_held = moved.condition[old] == NodeCondition::kPrescribed;
        ASSERT_LT(math::Distance({found.x, found.y, found.z}, is_held ? Vec3{} : expected[old]), 1e-6)
            << "seed " << seed << " node " << old;
      }
      const double change =
          CalcEnergy(system.model, moved, load) - CalcEnergy(system.model, system.state, load);
      EXPECT_NEAR(here.balance.energy - before.balance.energy, change, 1e-9 * std::fabs(change));
      double largest = 0;
      system.elements.ForEach([&](const auto& element) {
        for (const Vec3& force : CalcElementForce(
                 element, GatherPositions(element, [&](std::uint32_t node) { return moved.position[node]; })))
          largest = std::max(largest, math::Norm(force));
      });
      if (seed != 5) {
        EXPECT_GE(here.balance.force_scale, (1 - 1e-9) * largest) << "seed " << seed;
      }

      // the product, by differences
      std::vector<Float4> direction(here.balance.residual.size()), product = direction;
      TissueState aside = moved;
      constexpr double kStep = 1e-8;
      math::Random draws(seed);
      for (std::uint32_t i = 0; i < system.model.Size(); ++i) {
        if (!here.load.is_free[i]) continue;
        const Vec3 d = DrawVector(draws, 1);
        direction[i] = {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z), 0};
        aside.position[here.model.old_of_new[i]] += kStep * d;
      }
      RunPass(*here.kernels, here.workers, here.hierarchy.Finest(), LinkPass::kProduct, direction.data(),
              nullptr, 0.0f, product.data());
      here.linearisation.CompleteProduct(here.hierarchy.Finest(), direction.data(), product.data());
      std::vector<Vec3> after(system.model.Size());
      CalcResidual(system.model, aside, load, after);
      double most = 0;
      for (const Float4& f : product) most = std::max(most, math::Norm(Vec3{f.x, f.y, f.z}));
      for (std::uint32_t i = 0; i < system.model.Size(); ++i) {
        const std::uint32_t old = here.model.old_of_new[i];
        if (!here.load.is_free[i]) continue;
        ASSERT_LT(
            math::Distance({product[i].x, product[i].y, product[i].z}, (expected[old] - after[old]) / kStep),
            1e-4 * most)
            << "seed " << seed << " node " << old;
      }
    }
  }
}

TYPED_TEST(EveryElement, CoarseLevelsHaveTheGalerkinProduct) {
  ElementSystem<TypeParam> system(3, 30);
  // thousands of times as stiff as what is around it
  auto& element = system.elements.template Of<TypeParam>().front();
  element.stiffness *= 1e4;
  Evaluated here(system.model, system.Load(), system.state, Levels().back());
  here.hierarchy.UpdateCoarse(*here.kernels, here.workers);
  const auto levels = here.hierarchy.Levels();
  ASSERT_GE(levels.size(), 2u);
  EXPECT_FALSE(here.hierarchy.HasNewElements());
  EXPECT_FALSE(levels.front().elements.IsEmpty());
  for (std::size_t at = 0; at + 1 < levels.size(); ++at) {
    const std::vector<std::uint32_t>& aggregate = here.made.hierarchy.levels[at].aggregate;
    const Dense fine = CalcDense(levels[at].elements.Firm(), levels[at].Size());
    const Dense coarse = CalcDense(levels[at + 1].elements.Firm(), levels[at + 1].Size());
    Dense expected(coarse.size);
    for (std::size_t row = 0; row < fine.size; ++row) {
      for (std::size_t column = 0; column < fine.size; ++column) {
        if (aggregate[row / 3] == Aggregation::kNone || aggregate[column / 3] == Aggregation::kNone) continue;
        expected.At(3 * aggregate[row / 3] + row % 3, 3 * aggregate[column / 3] + column % 3) +=
            fine.At(row, column);
      }
    }
    EXPECT_LT(Difference(expected, coarse).Largest(), 1e-8 * fine.Largest()) << "level " << at;
  }
  // the cycle stays symmetric and positive definite
  here.hierarchy.UpdateLineSmoother();
  const std::size_t padded = here.balance.residual.size();
  math::Random random(9);
  const auto draw = [&] {
    std::vector<Float4> drawn(padded);
    for (std::uint32_t i = 0; i < system.model.Size(); ++i) {
      const Vec3 v = DrawVector(random, 1);
      drawn[i] = {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), 0};
    }
    return drawn;
  };
  const auto dot = [](const std::vector<Float4>& a, const std::vector<Float4>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      sum += math::Dot(Vec3{a[i].x, a[i].y, a[i].z}, Vec3{b[i].x, b[i].y, b[i].z});
    return sum;
  };
  const auto apply = [&](const std::vector<Float4>& b) {
    std::vector<Float4> x(padded);
    here.hierarchy.Apply(*here.kernels, here.workers, b.data(), x.data());
    return x;
  };
  for (int draws = 0; draws < 20; ++draws) {
    const std::vector<Float4> a = draw(), b = draw();
    const std::vector<Float4> x = apply(a), y = apply(b);
    EXPECT_GT(dot(a, x), 0.0);
    EXPECT_NEAR(dot(x, b), dot(a, y), 1e-4 * std::sqrt(dot(a, x) * dot(b, y)));
  }
}

TYPED_TEST(EveryElement, EverySolverFindsItsEquilibrium) {
  ElementSystem<TypeParam> system(4, 6);
  const TissueLoad load = system.Load();
  TissueLoad without = load;
  without.elements = nullptr;
  const auto solve = [&](const SolverSettings& settings, const TissueLoad& loads) {
    TissueState state = system.state;
    EquilibriumSolver solver(system.model);
    EXPECT_TRUE(solver.Solve(settings, loads, state).converged) << SolverName(settings.kind);
    return state.position;
  };
  const SolverSettings exact{SolverKind::kChebyshevJacobi2015, 100'000, 1e-10, 0.0};
  const std::vector<Vec3> truth = solve(exact, load), other = solve(exact, without);
  TissueState at_truth = system.state;
  at_truth.position = truth;
  std::vector<Vec3> residual(system.model.Size());
  CalcResidual(system.model, at_truth, load, residual);
  double largest = 0, moved = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    largest = std::max(largest, math::Norm(residual[i]));
    moved = std::max(moved, math::Distance(truth[i], other[i]));
  }
  EXPECT_LT(largest, 1e-9);
  EXPECT_GT(moved, 1e-5) << "the element changes nothing";
  for (SolverSettings settings : {SolverSettings{.kind = SolverKind::kNewtonMultigrid, .max_error = 1e-7},
                                  SolverSettings{.kind = SolverKind::kAdaptive, .max_error = 1e-7},
                                  SolverSettings{SolverKind::kAcceleratedDescent, 100'000, 1e-10, 0.0},
                                  SolverSettings{SolverKind::kGaussSeidelBrown2001, 100'000, 1e-10, 0.0},
                                  SolverSettings{SolverKind::kRelaxationPaper, 400'000, 1e-9, 0.0}}) {
    const std::vector<Vec3> found = solve(settings, load);
    for (std::size_t i = 0; i < truth.size(); ++i)
      ASSERT_LT(math::Distance(found[i], truth[i]), 1e-7) << SolverName(settings.kind) << " node " << i;
  }
}

TYPED_TEST(EveryElement, ReactionOfAHeldNodeHasItsForce) {
  const ElementSystem<TypeParam> system(2);
  const EquilibriumSolver solver(system.model);
  const TissueLoad load = system.Load();
  TissueLoad without = load;
  without.elements = nullptr;
  const std::uint32_t node = 0;
  const Vec3 difference = solver.CalcReaction(load, system.state, {&node, 1}) -
                          solver.CalcReaction(without, system.state, {&node, 1});
  const Vec3 expected = CalcElementForceOn(system.elements, system.state.position, node).sum;
  EXPECT_GT(math::Norm(expected), 1e-3);
  EXPECT_LT(math::Distance(difference, expected), 1e-12);
}

// A broken element, or too many of them, ends a solve at once.
TYPED_TEST(EveryElement, IsNotSolvedWhereItIsNotUsable) {
  ElementSystem<TypeParam> system(2);
  EquilibriumSolver solver(system.model);
  TissueState state = system.state;
  const SolverSettings settings{.kind = SolverKind::kNewtonMultigrid};
  EXPECT_TRUE(solver.Solve(settings, system.Load(), state).is_finite);
  state = system.state;
  system.elements.template Of<TypeParam>().front().stiffness = NAN;
  EXPECT_FALSE(solver.Solve(settings, system.Load(), state).is_finite);
  EXPECT_EQ(state.position, system.state.position);
}

// --- the list

TEST(ElementArrays, NamesOfTheKindsAreTheirOwn) {
  std::set<std::string> names;
  std::size_t kinds = 0;
  ElementArrays().ForEachKind([&](const auto& array) {
    names.insert(std::string(std::remove_cvref_t<decltype(array)>::value_type::kName));
    ++kinds;
  });
  EXPECT_EQ(names.size(), kinds);
}

/// A sphere under its weight with strands and a tool that presses.
struct PressedSphere {
  TissueDefinition definition = MakeMembrane(geometry::MakeSphere({0, 0, 0}, 0.03, 3), 100.0, 2e5);
  std::vector<ContactSpring> contacts = {{{9, 10, 11}, {0.2, 0.3, 0.5}, {0, 0, -1}, 0.0, 200.0}};

  PressedSphere() {
    definition.strands = {{3, 40, 30.0}, {5, 60, 20.0}};
    const Vec3 centre = 0.2 * definition.rest[9] + 0.3 * definition.rest[10] + 0.5 * definition.rest[11];
    contacts[0].normal = -math::Normalized(centre);
    contacts[0].offset = math::Dot(contacts[0].normal, centre) + 0.001;
  }
  TissueLoad Load() const { return {.gravity = {1, 2, -3}, .contacts = contacts}; }
};

std::vector<Vec3> SolveTicks(const TissueModel& model, const TissueLoad& load, SolverKind kind) {
  EquilibriumSolver solver(model);
  TissueState state = MakeRestState(model);
  for (int tick = 0; tick < 3; ++tick) (void)solver.Solve({.kind = kind}, load, state);
  return state.position;
}

// An empty list, and elements that do not act, leave every bit.
TEST(ElementArrays, WhatDoesNotActLeavesTheBits) {
  const PressedSphere sphere;
  const TissueModel model = MakeTissueModel(sphere.definition);
  ElementArrays none, open;
  // far from each other: node 100 against a triangle that looks away from it
  open.Of<SurfaceContact>().push_back({.nodes = {0, 9, 10, 11}, .stiffness = 500.0, .gap = 0.0});
  const auto x =
      GatherPositions(open.Of<SurfaceContact>()[0], [&](std::uint32_t node) { return model.rest[node]; });
  if (CalcElementEnergy(open.Of<SurfaceContact>()[0], x) > 0.0)
    std::swap(open.Of<SurfaceContact>()[0].nodes[2], open.Of<SurfaceContact>()[0].nodes[3]);
  for (const SolverKind kind : kSolverKinds) {
    TissueLoad load = sphere.Load();
    const std::vector<Vec3> expected = SolveTicks(model, load, kind);
    load.elements = &none;
    EXPECT_EQ(SolveTicks(model, load, kind), expected) << SolverName(kind);
    if (kind != SolverKind::kNewtonMultigrid) continue;
    load.elements = &open;
    EXPECT_EQ(SolveTicks(model, load, kind), expected) << SolverName(kind);
  }
}

// Oracle: the kernels' springs, strands, virtual springs and contacts against the same as elements.
TEST(ElementArrays, KernelsEvaluateWhatTheirElementsSay) {
  const PressedSphere sphere;
  const TissueModel model = MakeTissueModel(sphere.definition);
  TissueState state = MakeRestState(model);
  math::Random random(3);
  for (Vec3& p : state.position) p += DrawVector(random, 1e-3);
  const TissueLoad load = {.stiffness_scale = 1.3, .shape_scale = 0.7, .contacts = sphere.contacts};
  double energy = 0;
  std::vector<Vec3> force(model.Size());
  const auto add = [&](const auto& element) {
    const auto x = GatherPositions(element, [&](std::uint32_t node) { return state.position[node]; });
    energy += CalcElementEnergy(element, x);
    const auto forces = CalcElementForce(element, x);
    for (std::size_t i = 0; i < forces.size(); ++i) force[element.nodes[i]] += forces[i];
  };
  for (const Spring& spring : sphere.definition.springs)
    add(SpringElement{.nodes = {spring.a, spring.b},
                      .stiffness = load.stiffness_scale * spring.stiffness,
                      .rest_length = spring.rest_length,
                      .law = {}});
  for (const Strand& strand : sphere.definition.strands)
    add(StrandElement{.nodes = {strand.a, strand.b},
                      .stiffness = load.stiffness_scale * strand.stiffness,
                      .rest_offset = model.rest[strand.b] - model.rest[strand.a]});
  for (std::uint32_t i = 0; i < model.Size(); ++i)
    add(AnchorElement{
        .nodes = {i}, .stiffness = load.shape_scale * model.shape_stiffness[i], .anchor = model.rest[i]});
  for (const ContactSpring& contact : sphere.contacts) add(contact);
  EXPECT_GT(CalcElementEnergy(sphere.contacts[0],
                              GatherPositions(sphere.contacts[0],
                                              [&](std::uint32_t node) { return state.position[node]; })),
            0.0);
  EXPECT_NEAR(CalcEnergy(model, state, load), energy, 1e-12 * energy);
  for (const base::SimdLevel level : Levels()) {
    const Evaluated here(model, load, state, level), rest(model, load, MakeRestState(model), level);
    for (std::uint32_t i = 0; i < model.Size(); ++i) {
      const Float4& found = here.balance.residual[i];
      EXPECT_LT(math::Distance({found.x, found.y, found.z}, force[here.model.old_of_new[i]]), 1e-6);
    }
  }
}

// Every fifth spring stands in the array instead of the model: the same equilibrium, in about as many iterations.
TEST(ElementArrays, SpringsAsElementsConvergeAsFastAsInTheModel) {
  PressedSphere sphere;
  const TissueModel whole = MakeTissueModel(sphere.definition);
  ElementArrays elements;
  std::vector<Spring> kept;
  for (std::size_t i = 0; i < sphere.definition.springs.size(); ++i) {
    const Spring& spring = sphere.definition.springs[i];
    if (i % 15 != 0 || elements.Of<SpringElement>().size() == SpringElement::kCapacity) {
      kept.push_back(spring);
      continue;
    }
    elements.Of<SpringElement>().push_back({.nodes = {spring.a, spring.b},
                                            .stiffness = spring.stiffness,
                                            .rest_length = spring.rest_length,
                                            .law = {}});
  }
  ASSERT_GT(elements.Of<SpringElement>().size(), 100u);
  sphere.definition.springs = kept;
  const TissueModel less = MakeTissueModel(sphere.definition);
  const SolverSettings settings{.kind = SolverKind::kNewtonMultigrid, .max_error = 1e-6};
  TissueState expected = MakeRestState(whole), found = MakeRestState(less);
  const SolveReport one = EquilibriumSolver(whole).Solve(settings, sphere.Load(), expected);
  TissueLoad load = sphere.Load();
  load.elements = &elements;
  const SolveReport other = EquilibriumSolver(less).Solve(settings, load, found);
  EXPECT_TRUE(one.converged && other.converged);
  for (std::size_t i = 0; i < whole.Size(); ++i)
    ASSERT_LT(math::Distance(expected.position[i], found.position[i]), 1e-7) << "node " << i;
  EXPECT_LE(other.linear_iterations, 1.15 * one.linear_iterations)
      << one.linear_iterations << " in the model, steps " << one.iterations << " " << other.iterations;
}

}  // namespace
}  // namespace trocar::tissue
