// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/surface_contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "evaluated.h"
#include "node_vectors.h"
#include "test_systems.h"
#include "trocar/math/random.h"
#include "trocar/tissue/element_kinds.h"
#include "trocar/tissue/equilibrium.h"
#include "truncated_conjugate_gradients.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

TEST(CalcContactPlane, HasTheFootOfTheNode) {
  const SurfaceContact contact{};
  // the triangle lies in z = 1; a node over the middle of its longest edge, 2 above it
  const ContactPlane plane = CalcContactPlane(contact, {Vec3{2, 1, 3}, {0, 0, 1}, {4, 0, 1}, {0, 2, 1}});
  EXPECT_LT(math::Distance(plane.normal, {0, 0, 1}), 1e-15);
  EXPECT_NEAR(plane.distance, 2.0, 1e-15);
  EXPECT_NEAR(plane.weights[0], 0.0, 1e-15);
  EXPECT_NEAR(plane.weights[1], 0.5, 1e-15);
  EXPECT_NEAR(plane.weights[2], 0.5, 1e-15);
}

TEST(SurfaceContact, LetsGoAndDoesNotStick) {
  const SurfaceContact contact{.nodes = {0, 1, 2, 3}, .stiffness = 100.0, .gap = 0.5};
  ElementVectors<4> x = {Vec3{0.2, 0.2, 0.4}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_NEAR(CalcElementForce(contact, x)[0].z, 100.0 * 0.1, 1e-12);
  x[0].z = 0.6;
  for (const Vec3& force : CalcElementForce(contact, x)) EXPECT_EQ(force, Vec3{});
  EXPECT_EQ(CalcElementEnergy(contact, x), 0.0);
  x[0].z = -0.1;  // through the surface: still pushed out
  EXPECT_NEAR(CalcElementForce(contact, x)[0].z, 100.0 * 0.6, 1e-12);
  x[3] = x[2];  // a triangle without area has no side
  for (const Vec3& force : CalcElementForce(contact, x)) EXPECT_EQ(force, Vec3{});
}

/// Two blocks of three columns each, the upper ones over the middles of the lower triangle's edges. Columns are strands, which keep
/// upright under pressure.
struct Blocks {
  static constexpr std::uint32_t kLayers = 5;
  static constexpr double kLink = 400.0;                    // of one strand [N/m]
  static constexpr double kColumn = kLink / (kLayers - 1);  // [N/m]
  static constexpr double kContact = 250.0, kGap = 0.0005;  // [N/m], [m]
  static constexpr double kApart = 0.001,
                          kApproach = 0.003;  // between the blocks at rest; of the upper one's top [m]

  TissueDefinition definition;
  TissueModel model;
  TissueState state;
  ElementArrays elements;

  static std::uint32_t Lower(std::uint32_t column, std::uint32_t layer) { return 3 * layer + column; }
  static std::uint32_t Upper(std::uint32_t column, std::uint32_t layer) {
    return 3 * kLayers + 3 * layer + column;
  }

  Blocks() {
    const std::array<Vec3, 3> corners = {Vec3{0, 0, 0}, {0.01, 0, 0}, {0.005, 0.009, 0}};
    const double height = 0.002;
    for (std::uint32_t layer = 0; layer < kLayers; ++layer) {
      for (const Vec3& corner : corners) definition.rest.push_back(corner + Vec3{0, 0, layer * height});
    }
    for (std::uint32_t layer = 0; layer < kLayers; ++layer) {
      for (std::size_t column = 0; column < 3; ++column) {
        definition.rest.push_back(0.5 * (corners[column] + corners[(column + 1) % 3]) +
                                  Vec3{0, 0, (kLayers - 1 + layer) * height + kApart});
      }
    }
    definition.mass.assign(definition.rest.size(), 0.0);
    definition.shape_stiffness.assign(definition.rest.size(), 0.0);
    for (std::uint32_t layer = 0; layer + 1 < kLayers; ++layer) {
      for (std::uint32_t column = 0; column < 3; ++column) {
        definition.strands.push_back({Lower(column, layer), Lower(column, layer + 1), kLink});
        definition.strands.push_back({Upper(column, layer), Upper(column, layer + 1), kLink});
      }
    }
    for (std::uint32_t column = 0; column < 3; ++column) {
      definition.fixed.push_back(Lower(column, 0));
      definition.fixed.push_back(Upper(column, kLayers - 1));
      elements.Of<SurfaceContact>().push_back(
          {.nodes = {Upper(column, 0), Lower(0, kLayers - 1), Lower(1, kLayers - 1), Lower(2, kLayers - 1)},
           .stiffness = kContact,
           .gap = kGap});
    }
    model = MakeTissueModel(definition);
    state = MakeRestState(model);
    for (std::uint32_t column = 0; column < 3; ++column)
      state.position[Upper(column, kLayers - 1)].z -= kApproach;
  }
};

// Analytic: columns and contact in row, each under the same force.
TEST(SurfaceContact, TwoBlocksOverlapAsColumnsAndContactInRow) {
  const double force =
      (Blocks::kApproach - Blocks::kApart + Blocks::kGap) / (2 / Blocks::kColumn + 1 / Blocks::kContact);
  for (const SolverKind kind : {SolverKind::kNewtonMultigrid, SolverKind::kChebyshevJacobi2015}) {
    Blocks blocks;
    EquilibriumSolver solver(blocks.model);
    const SolverSettings settings{
        .kind = kind, .max_iterations = 20'000, .tolerance = 1e-11, .max_error = 1e-8};
    const TissueLoad load{.elements = &blocks.elements};
    const SolveReport report = solver.Solve(settings, load, blocks.state);
    // the recurrence measures against springs, of which there are none
    EXPECT_TRUE(report.converged || kind != SolverKind::kNewtonMultigrid);
    for (std::uint32_t column = 0; column < 3; ++column) {
      const SurfaceContact& contact = blocks.elements.Of<SurfaceContact>()[column];
      const auto x =
          GatherPositions(contact, [&](std::uint32_t node) { return blocks.state.position[node]; });
      const ContactPlane plane = CalcContactPlane(contact, x);
      EXPECT_NEAR(contact.gap - plane.distance, force / Blocks::kContact, 1e-8) << SolverName(kind);
      EXPECT_NEAR(CalcElementForce(contact, x)[0].z, force, 1e-5) << SolverName(kind);
      // both sides give way alike
      const std::uint32_t top = Blocks::Lower(column, Blocks::kLayers - 1), bottom = Blocks::Upper(column, 0);
      EXPECT_NEAR(blocks.model.rest[top].z - blocks.state.position[top].z, force / Blocks::kColumn, 1e-8);
      EXPECT_NEAR(blocks.model.rest[bottom].z - blocks.state.position[bottom].z,
                  Blocks::kApproach - force / Blocks::kColumn, 1e-8);
    }
    // what the hand that holds the upper block feels is what the ground under the lower one bears
    std::vector<std::uint32_t> held, ground;
    for (std::uint32_t column = 0; column < 3; ++column) {
      held.push_back(Blocks::Upper(column, Blocks::kLayers - 1)), ground.push_back(Blocks::Lower(column, 0));
    }
    const Vec3 above = solver.CalcReaction(load, blocks.state, held),
               below = solver.CalcReaction(load, blocks.state, ground);
    EXPECT_NEAR(above.z, 3 * force, 1e-5);
    EXPECT_LT(math::Norm(above + below), 1e-6);
  }
}

/// Two spheres of one system that overlap by a millimetre, and the contacts of each one's nodes with the other's triangles.
struct Spheres {
  static constexpr double kRadius = 0.03, kGap = 0.0005, kContact = 600.0;

  std::vector<geometry::TriangleMesh> meshes = {
      geometry::MakeSphere({0, 0, 0}, kRadius, 3),
      geometry::MakeSphere({0.0005, 0.0003, 2 * kRadius - 0.001}, kRadius, 3)};
  TissueDefinition definition;
  ElementArrays elements;

  Spheres() {
    for (const geometry::TriangleMesh& mesh : meshes) {
      TissueDefinition one = MakeMembrane(mesh, 100.0, 2e5);
      const auto first = static_cast<std::uint32_t>(definition.rest.size());
      for (Spring& spring : one.springs) spring.a += first, spring.b += first;
      definition.rest.insert(definition.rest.end(), one.rest.begin(), one.rest.end());
      definition.mass.insert(definition.mass.end(), one.mass.begin(), one.mass.end());
      definition.shape_stiffness.insert(definition.shape_stiffness.end(), one.shape_stiffness.begin(),
                                        one.shape_stiffness.end());
      definition.springs.insert(definition.springs.end(), one.springs.begin(), one.springs.end());
    }
    FindContacts(0, 1), FindContacts(1, 0);
  }

  /// Nodes of one sphere over triangles of the other, each pair by brute force.
  void FindContacts(std::size_t of, std::size_t against) {
    const auto count = static_cast<std::uint32_t>(meshes[0].positions.size());
    const auto first = static_cast<std::uint32_t>(of) * count,
               other = static_cast<std::uint32_t>(against) * count;
    for (std::uint32_t node = first; node < first + meshes[of].positions.size(); ++node) {
      for (const geometry::Triangle& triangle : meshes[against].triangles) {
        const SurfaceContact contact{
            .nodes = {node, other + triangle[0], other + triangle[1], other + triangle[2]},
            .stiffness = kContact,
            .gap = kGap};
        const auto x = GatherPositions(contact, [&](std::uint32_t i) { return definition.rest[i]; });
        const ContactPlane plane = CalcContactPlane(contact, x);
        const bool is_over =
            std::all_of(plane.weights.begin(), plane.weights.end(), [](double w) { return w >= 0; });
        if (is_over && std::fabs(plane.distance) < 0.002) elements.Of<SurfaceContact>().push_back(contact);
      }
    }
  }
};

TEST(SurfaceContact, PressedSpheresPartAndActAndReact) {
  const Spheres spheres;
  ASSERT_GT(spheres.elements.Of<SurfaceContact>().size(), 10u);
  const TissueModel model = MakeTissueModel(spheres.definition);
  TissueState state = MakeRestState(model), other = state;
  EquilibriumSolver solver(model);
  const TissueLoad load{.elements = &spheres.elements};
  const SolverSettings settings{.kind = SolverKind::kNewtonMultigrid, .max_error = 1e-6};
  EXPECT_TRUE(solver.Solve(settings, load, state).converged);
  EXPECT_TRUE(solver.Solve({SolverKind::kChebyshevJacobi2015, 100'000, 1e-9, 0.0}, load, other).converged);
  for (std::size_t i = 0; i < model.Size(); ++i)
    ASSERT_LT(math::Distance(state.position[i], other.position[i]), 1e-7) << "node " << i;
  // forces of the contacts on either sphere: equal and opposite, and no torque on the whole
  std::vector<Vec3> force(model.Size());
  AddElementForces(spheres.elements, state.position, force);
  Vec3 lower, upper, torque;
  for (std::size_t i = 0; i < model.Size(); ++i) {
    (i < model.Size() / 2 ? lower : upper) += force[i];
    torque += math::Cross(state.position[i], force[i]);
  }
  EXPECT_GT(upper.z, 0.005);
  EXPECT_LT(math::Norm(lower + upper), 1e-12);
  EXPECT_LT(math::Norm(torque), 1e-13);
}

/// Strands between the spheres, in the place of the contacts.
std::vector<Strand> MakeStrands(const Spheres& spheres, double stiffness) {
  std::vector<Strand> strands;
  for (const SurfaceContact& contact : spheres.elements.Of<SurfaceContact>()) {
    const auto x =
        GatherPositions(contact, [&](std::uint32_t node) { return spheres.definition.rest[node]; });
    const auto weights = CalcContactPlane(contact, x).weights;
    const auto nearest = std::max_element(weights.begin(), weights.end()) - weights.begin();
    strands.push_back({contact.nodes[0], contact.nodes[1 + static_cast<std::size_t>(nearest)], stiffness});
  }
  return strands;
}

ElementArrays MakeElements(const std::vector<Strand>& strands, const TissueModel& model) {
  ElementArrays elements;
  for (const Strand& strand : strands) {
    elements.Of<StrandElement>().push_back({.nodes = {strand.a, strand.b},
                                            .stiffness = strand.stiffness,
                                            .rest_offset = model.rest[strand.b] - model.rest[strand.a]});
  }
  return elements;
}

// Links of the model between two parts are in all levels of the multigrid by themselves; elements of the tissue's own stiffness
// need as many iterations.
TEST(SurfaceContact, PartsThatElementsJoinConvergeAsFastAsPartsThatTheModelJoins) {
  const Spheres spheres;
  const TissueModel apart = MakeTissueModel(spheres.definition);
  TissueDefinition definition = spheres.definition;
  definition.strands = MakeStrands(spheres, 100.0);
  const TissueModel joined = MakeTissueModel(definition);
  const ElementArrays elements = MakeElements(definition.strands, apart);
  std::vector<Vec3> pull(apart.Size());
  for (std::size_t i = 0; i < pull.size(); ++i) pull[i].z = i < pull.size() / 2 ? -1e-4 : 1e-4;
  const SolverSettings settings{.kind = SolverKind::kNewtonMultigrid, .max_error = 1e-5};
  TissueState expected = MakeRestState(joined), found = MakeRestState(apart);
  const SolveReport in_model = EquilibriumSolver(joined).Solve(settings, {.external_force = pull}, expected);
  const SolveReport as_elements =
      EquilibriumSolver(apart).Solve(settings, {.external_force = pull, .elements = &elements}, found);
  EXPECT_TRUE(in_model.converged && as_elements.converged);
  double farthest = 0;
  for (std::size_t i = 0; i < pull.size(); ++i) {
    ASSERT_LT(math::Distance(expected.position[i], found.position[i]), 1e-7) << "node " << i;
    farthest = std::max(farthest, math::Distance(found.position[i], apart.rest[i]));
  }
  EXPECT_GT(farthest, 1e-5);
  EXPECT_LE(as_elements.linear_iterations, 1.2 * in_model.linear_iterations) << in_model.linear_iterations;
}

/// Iterations of conjugate gradients that bring the preconditioned residual down to a millionth.
int CountIterations(Evaluated& here) {
  here.hierarchy.UpdateLineSmoother();
  const std::size_t padded = here.balance.residual.size();
  math::AlignedVector<Float4> step(padded), r(padded), z(padded), p(padded), q(padded);
  math::Random random(4);
  for (std::uint32_t i = 0; i < here.model.Size(); ++i) {
    if (here.load.is_free[i])
      r[i] = ToFloat({random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)});
  }
  const auto precondition = [&] {
    here.hierarchy.Apply(*here.kernels, here.workers, r.data(), z.data());
    return CalcDotAndLongest(*here.kernels, here.workers, r, z);
  };
  const auto multiply = [&] {
    RunPass(*here.kernels, here.workers, here.hierarchy.Finest(), LinkPass::kProduct, p.data(), nullptr, 0.0f,
            q.data());
    here.linearisation.CompleteProduct(here.hierarchy.Finest(), p.data(), q.data());
  };
  const double first = precondition().longest;
  const TruncatedReport report =
      SolveTruncated(*here.kernels, here.workers, 500, INFINITY, {step, r, z, p, q}, multiply, precondition,
                     [&](double left, double) { return left <= 1e-6 * first; });
  EXPECT_FALSE(report.met_negative_curvature);
  return report.iterations;
}

// Control: what the coarse levels have of the elements saves iterations.
TEST(SurfaceContact, CoarseLevelsThatKnowTheElementsSaveIterations) {
  const Spheres spheres;
  const TissueModel model = MakeTissueModel(spheres.definition);
  const ElementArrays elements = MakeElements(MakeStrands(spheres, 3000.0), model);
  Evaluated here(model, {.elements = &elements}, MakeRestState(model), base::FindSimdLevel());
  here.hierarchy.UpdateCoarse(*here.kernels, here.workers);
  const int with = CountIterations(here);
  LinkLevel& finest = here.hierarchy.Finest();
  finest.elements.RemoveDiagonal(finest.diagonal_excess);
  here.hierarchy.UpdateCoarse(*here.kernels, here.workers);
  here.linearisation.Linearise(*here.kernels, here.workers, here.position, finest, here.balance);
  EXPECT_TRUE(here.hierarchy.HasNewElements());
  const int without = CountIterations(here);
  RecordProperty("with", with), RecordProperty("without", without);
  EXPECT_LT(with, without) << with << " with them";
}

}  // namespace
}  // namespace trocar::tissue
