// SPDX-License-Identifier: Apache-2.0
/// \file spring_slices_test.cpp  Where neighbours are loaded from, and one iteration on any mesh against a plain
/// one.
#include "spring_slices.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>
#include <vector>

#include "trocar_test/threads.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

struct MeshSettings {
  int side = 48;
  double flipped_share = 0;  // of the diagonals [-]
  bool is_shuffled = false;
  int long_springs = 0;  // between nodes far apart
};

/// A sheet with one diagonal a cell, not quite regular in space, whose border is held.
TissueModel MakeMesh(const MeshSettings& settings) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> jitter(-0.2, 0.2), share(0.0, 1.0);
  const int n = settings.side;
  std::vector<std::uint32_t> place(static_cast<std::size_t>(n) * n);
  std::iota(place.begin(), place.end(), 0u);
  if (settings.is_shuffled) std::shuffle(place.begin(), place.end(), random);
  TissueDefinition definition;
  definition.rest.resize(place.size());
  definition.mass.assign(place.size(), 1e-3);
  definition.shape_stiffness.assign(place.size(), 0.05);
  const auto node = [&](int row, int column) { return place[static_cast<std::size_t>(row) * n + column]; };
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      definition.rest[node(row, column)] = {column + jitter(random), row + jitter(random), jitter(random)};
      if (row == 0 || column == 0 || row + 1 == n || column + 1 == n)
        definition.fixed.push_back(node(row, column));
    }
  }
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    const double length = math::Distance(definition.rest[a], definition.rest[b]);
    definition.springs.push_back({a, b, 1.0 + 0.1 * (a % 5), 0.97 * length});
  };
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      if (column + 1 < n) join(node(row, column), node(row, column + 1));
      if (row + 1 < n) join(node(row, column), node(row + 1, column));
      if (row + 1 == n || column + 1 == n) continue;
      const bool is_flipped = share(random) < settings.flipped_share;
      is_flipped ? join(node(row, column + 1), node(row + 1, column))
                 : join(node(row, column), node(row + 1, column + 1));
    }
  }
  for (int i = 0; i < settings.long_springs; ++i) join(node(3, 3 + i), node(n - 4, n - 4 - i));
  return MakeTissueModel(definition);
}

/// The iteration in double precision, by the model's own springs.
struct PlainIteration {
  const TissueModel& model;
  std::vector<Vec3> u, previous;

  void Step(const Vec3& load, double omega, double damping, bool is_first) {
    std::vector<Vec3> next(u.size());
    for (std::size_t i = 0; i < u.size(); ++i) {
      Vec3 force = load - model.shape_stiffness[i] * u[i];
      double sum = 0;
      for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
        const auto& half = model.half_springs[h];
        const Vec3 along = (model.rest[half.other] + u[half.other]) - (model.rest[i] + u[i]);
        force += half.stiffness * (1.0 - half.rest_length / math::Norm(along)) * along;
        sum += half.stiffness;
      }
      const double step = model.is_fixed[i] ? 0.0 : 1.0 / (2.0 * sum + model.shape_stiffness[i]);
      const Vec3 before = is_first ? u[i] : previous[i];
      next[i] = before + omega * (u[i] + damping * step * force - before);
    }
    previous = u;
    u = next;
  }
};

constexpr Vec3 kLoad = {0.001, 0.002, -0.02};  // on every node [N]

/// A sliced mesh before its first iteration.
struct Sliced {
  OrderedModel ordered;
  OrderedSprings springs;
  SpringSlices slices;
  PlainIteration plain;

  explicit Sliced(const TissueModel& model)
      : ordered(MakeOrderedModel(model)), springs(MakeOrderedSprings(model, ordered)), plain{model, {}, {}} {
    slices.SetModel(ordered);
    OrderedLoad load;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> offset(-0.1, 0.1);
    for (std::uint32_t i = 0; i < ordered.Size(); ++i) {
      load.constant.push_back(kLoad);
      load.is_free.push_back(model.is_fixed[ordered.old_of_new[i]] ? 0 : 1);
      plain.u.push_back({offset(random), offset(random), offset(random)});
    }
    slices.SetLoad(ordered, springs, load, {});
    for (std::uint32_t i = 0; i < ordered.Size(); ++i)
      slices.SetDisplacement(i, plain.u[ordered.old_of_new[i]]);
  }
};

// Three iterations, with and without lookups, at each level. Springs are up to 60 m long, displacements 0.1 m.
TEST(SpringSlices, IterateAsThePlainFormulaSays) {
  const MeshSettings meshes[] = {
      {}, {.is_shuffled = true}, {.long_springs = 12}, {.flipped_share = 0.5, .is_shuffled = true}};
  for (const MeshSettings& settings : meshes) {
    const TissueModel model = MakeMesh(settings);
    for (const base::SimdLevel level :
         {base::SimdLevel::kBaseline, base::SimdLevel::kAvx2, base::SimdLevel::kAvx512}) {
      if (!base::HasSimdLevel(level)) continue;
      Sliced sliced(model);
      Workers workers;
      for (const auto& [omega, is_first] : {std::pair{1.0f, true}, {1.5f, false}, {1.3f, false}}) {
        (void)sliced.slices.Step(GetKernels(level), workers, omega, 0.9f, is_first, false);
        sliced.plain.Step(kLoad, static_cast<double>(omega), static_cast<double>(0.9f), is_first);
      }
      for (std::uint32_t i = 0; i < sliced.ordered.Size(); ++i) {
        ASSERT_LT(
            math::Distance(sliced.slices.GetDisplacement(i), sliced.plain.u[sliced.ordered.old_of_new[i]]),
            5e-6)
            << base::SimdLevelName(level) << " node " << i;
      }
    }
  }
}

// Regular meshes are looked up, in whatever order they come; where few neighbours lie together, none are.
TEST(SpringSlices, LookNeighboursUpWhereMostLieTogether) {
  EXPECT_TRUE(Sliced(MakeMesh({})).slices.HasLookups());
  EXPECT_TRUE(Sliced(MakeMesh({.is_shuffled = true})).slices.HasLookups());
  EXPECT_TRUE(Sliced(MakeMesh({.long_springs = 12})).slices.HasLookups());
  EXPECT_FALSE(Sliced(MakeMesh({.side = 90, .flipped_share = 0.5})).slices.HasLookups());
}

// To the bit; the mesh has long springs, so that a few steps load their neighbours one by one.
TEST(SpringSlices, HaveTheSameBitsLookedUpOrNot) {
  if (!base::HasSimdLevel(base::SimdLevel::kAvx512)) GTEST_SKIP() << "this processor has no AVX-512";
  const TissueModel model = MakeMesh({.long_springs = 12});
  Sliced a(model), b(model);
  ASSERT_TRUE(a.slices.HasLookups());
  Kernels single = GetKernels(base::SimdLevel::kAvx512);
  ASSERT_TRUE(single.looks_up);
  single.looks_up = false;
  Workers workers(test::UseThreads(2));
  const Workers::Session session(workers);
  for (int i = 0; i < 25; ++i) {
    const bool is_first = i == 0;
    const double here =
        a.slices.Step(GetKernels(base::SimdLevel::kAvx512), workers, 1.2f, 0.9f, is_first, true);
    ASSERT_EQ(here, b.slices.Step(single, workers, 1.2f, 0.9f, is_first, true));
    ASSERT_GT(here, 0.0);
  }
  for (std::uint32_t i = 0; i < a.ordered.Size(); ++i)
    ASSERT_EQ(a.slices.GetDisplacement(i), b.slices.GetDisplacement(i)) << "node " << i;
}

// Six iterations: four that follow each other, and two; with ranges for two and three threads, whose edges are caught up
// on; and a mesh too small for any of it.
TEST(SpringSlices, IterateSeveralAtATimeToTheSameBits) {
  constexpr std::array<float, 6> kOmegas = {1.0f, 1.6f, 1.5f, 1.45f, 1.4f, 1.38f};
  for (const int side : {120, 24}) {
    const TissueModel model = MakeMesh({.side = side});
    for (const int threads : {1, 2, 3}) {
      Sliced a(model), b(model);
      ASSERT_EQ(a.slices.CountRanges(threads), side == 120 ? threads : 0);
      Workers workers(test::UseThreads(threads));
      const Workers::Session session(workers);
      const Kernels& kernels = GetKernels(base::FindSimdLevel());
      for (const bool is_first : {true, false}) {
        const double together = a.slices.Iterate(kernels, workers, kOmegas, 0.9f, is_first, true);
        double one_by_one = 0;
        for (const float omega : kOmegas)
          one_by_one = b.slices.Step(kernels, workers, omega, 0.9f, is_first && omega == 1.0f,
                                     omega == kOmegas.back());
        ASSERT_GT(together, 0.0);
        ASSERT_EQ(together, one_by_one) << threads << " threads";
      }
      for (std::uint32_t i = 0; i < a.ordered.Size(); ++i)
        ASSERT_EQ(a.slices.GetDisplacement(i), b.slices.GetDisplacement(i))
            << threads << " threads, node " << i;
    }
  }
}

// The largest residual of an iteration must not hide one that is not a number, wherever in the mesh.
TEST(SpringSlices, ReportAResidualThatIsNotANumber) {
  const TissueModel model = MakeMesh({.side = 120});
  Sliced sliced(model);
  sliced.slices.SetDisplacement(sliced.ordered.Size() / 2, {NAN, 0, 0});
  Workers workers;
  EXPECT_TRUE(
      std::isnan(sliced.slices.Step(GetKernels(base::FindSimdLevel()), workers, 1.0f, 0.9f, true, true)));
}

}  // namespace
}  // namespace trocar::tissue
