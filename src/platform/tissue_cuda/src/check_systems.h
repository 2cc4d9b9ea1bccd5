// SPDX-License-Identifier: Apache-2.0
/// \file check_systems.h  Systems of awkward sizes for checking the kernels, and a plain iteration to judge
/// them by: for the tests and for the check on a GPU machine.
#pragma once

#include <algorithm>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "trocar/geometry/mesh_topology.h"
#include "trocar/geometry/primitives.h"
#include "trocar/math/random.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::tissue_cuda {

/// How a system's springs differ.
enum class Springs {
  kUniform,  ///< as in the paper: one constant, at rest in the mesh, no virtual springs
  kVaried    ///< each its own constant and rest length; virtual springs
};

/// Definition over nodes and edges, drawn from a seed.
inline tissue::TissueDefinition MakeSystem(std::vector<math::Vec3> rest,
                                           const std::vector<geometry::Edge>& edges, Springs springs,
                                           std::uint64_t seed) {
  math::Random random(seed);
  tissue::TissueDefinition definition;
  definition.rest = std::move(rest);
  const bool is_varied = springs == Springs::kVaried;
  for (std::size_t i = 0; i < definition.rest.size(); ++i) {
    definition.mass.push_back(random.Uniform(0.0005, 0.002));
    definition.shape_stiffness.push_back(is_varied ? random.Uniform(0.05, 0.5) : 0.0);
  }
  for (const auto& [a, b] : edges) {
    const double length = math::Distance(definition.rest[a], definition.rest[b]);
    definition.springs.push_back({a, b, is_varied ? random.Uniform(0.5, 2.0) : 1.0,
                                  is_varied ? length * random.Uniform(0.97, 1.03) : length});
  }
  return definition;
}

/// Grid of `columns` x `rows` with one diagonal a cell; one end fixed.
inline tissue::TissueDefinition MakeGridSystem(std::uint32_t columns, std::uint32_t rows, Springs springs,
                                               double spacing = 1.0) {
  std::vector<math::Vec3> rest;
  std::vector<geometry::Edge> edges;
  for (std::uint32_t row = 0; row < rows; ++row) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      const std::uint32_t i = row * columns + column;
      rest.push_back({spacing * column, spacing * row, 0});
      if (column + 1 < columns) edges.push_back({i, i + 1});
      if (row + 1 < rows) edges.push_back({i, i + columns});
      if (column + 1 < columns && row + 1 < rows) edges.push_back({i, i + columns + 1});
    }
  }
  tissue::TissueDefinition definition = MakeSystem(std::move(rest), edges, springs, columns * 1000 + rows);
  if (columns * rows > 1) definition.fixed = {0, columns * rows - 1};
  return definition;
}

/// The whole numbers below `count` in an order drawn from a seed.
inline std::vector<std::uint32_t> MakeRandomOrder(std::size_t count, std::uint64_t seed) {
  math::Random random(seed);
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.NextWord() % i]);
  return order;
}

/// Moves node i to place[i].
inline void Renumber(const std::vector<std::uint32_t>& place, tissue::TissueDefinition& definition) {
  const tissue::TissueDefinition old = definition;
  for (std::size_t i = 0; i < place.size(); ++i) {
    definition.rest[place[i]] = old.rest[i];
    definition.mass[place[i]] = old.mass[i];
    definition.shape_stiffness[place[i]] = old.shape_stiffness[i];
  }
  for (std::uint32_t& node : definition.fixed) node = place[node];
  for (tissue::Spring& spring : definition.springs) spring.a = place[spring.a], spring.b = place[spring.b];
  for (tissue::Strand& strand : definition.strands) strand.a = place[strand.a], strand.b = place[strand.b];
}

/// Sphere whose nodes are numbered at random, so that neighbours lie anywhere.
inline tissue::TissueDefinition MakeScatteredSphere(int subdivisions, Springs springs, double radius = 5.0) {
  const geometry::TriangleMesh mesh = geometry::MakeSphere({1, 2, 3}, radius, subdivisions);
  tissue::TissueDefinition definition =
      MakeSystem(mesh.positions, geometry::FindEdges(mesh.triangles), springs, 11);
  definition.fixed = {0, 5};
  Renumber(MakeRandomOrder(mesh.positions.size(), 7), definition);
  return definition;
}

/// A state away from rest: every free node moved a little, one node prescribed elsewhere.
inline tissue::TissueState MakeMovedState(const tissue::TissueModel& model, double extent) {
  tissue::TissueState state = tissue::MakeRestState(model);
  math::Random random(3);
  for (std::size_t i = 0; i < model.Size(); ++i) {
    const math::Vec3 move{random.Uniform(-extent, extent), random.Uniform(-extent, extent),
                          random.Uniform(-extent, extent)};
    if (!model.is_fixed[i]) state.position[i] += move;
  }
  if (model.Size() > 2) state.condition[model.Size() / 2] = tissue::NodeCondition::kPrescribed;
  return state;
}

/// External forces on every third node.
inline std::vector<math::Vec3> MakeForces(std::size_t count) {
  std::vector<math::Vec3> forces(count);
  for (std::size_t i = 0; i < count; i += 3) forces[i] = {0.01, -0.02, 0.03 * static_cast<double>(i % 5)};
  return forces;
}

/// Everything that a load can hold.
struct Case {
  tissue::TissueModel model;
  tissue::TissueState state;
  std::vector<math::Vec3> forces;
  std::vector<tissue::ContactSpring> contacts;
  tissue::TissueLoad load;
};

/// A tissue of millimetres with strands (one cut), contacts (one open), forces, gravity and a held node.
inline std::unique_ptr<Case> MakeCase(tissue::TissueDefinition definition, bool has_all) {
  auto made = std::make_unique<Case>();
  const auto n = static_cast<std::uint32_t>(definition.rest.size());
  if (has_all && n > 20) {
    for (std::uint32_t i = 0; i < 6; ++i) definition.strands.push_back({2 * i, n - 1 - 3 * i, 0.3 + 0.1 * i});
  }
  made->model = tissue::MakeTissueModel(definition);
  made->state = MakeMovedState(made->model, 3e-4);
  made->load.gravity = {0, 0, -0.5};
  if (!has_all) return made;
  if (!made->state.strand_is_intact.empty()) made->state.strand_is_intact[2] = 0;
  made->forces = MakeForces(n);
  for (math::Vec3& force : made->forces) force *= 0.01;
  for (std::uint32_t c = 0; c < 4 && n > 20; ++c) {
    tissue::ContactSpring contact{{c, n / 2 + c, (7 * c + 3) % n}, {0.2, 0.3, 0.5}, {0.6, 0, 0.8}, 0, 2.0};
    const double depth = tissue::CalcContactDepth(contact, made->model.rest);
    contact.offset = 0.002 - depth - (c == 1 ? 0.01 : 0.0);
    made->contacts.push_back(contact);
  }
  made->load.stiffness_scale = 1.25;
  made->load.shape_scale = 0.5;
  made->load.external_force = made->forces;
  made->load.contacts = made->contacts;
  return made;
}

/// Judge: `steps` times x <- x + alpha R with all nodes at once, R by the plain evaluation that no solver
/// shares.
inline void RelaxPlainly(const tissue::TissueModel& model, const tissue::TissueLoad& load, double alpha,
                         int steps, tissue::TissueState& state) {
  std::vector<math::Vec3> residual(model.Size());
  for (int step = 0; step < steps; ++step) {
    tissue::CalcResidual(model, state, load, residual);
    for (std::size_t i = 0; i < model.Size(); ++i) {
      if (state.condition[i] != tissue::NodeCondition::kPrescribed) state.position[i] += alpha * residual[i];
    }
  }
}

/// Largest distance between the nodes of two states, and of one state from rest.
inline double CalcLargestDistance(const std::vector<math::Vec3>& a, const std::vector<math::Vec3>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double distance = math::Distance(a[i], b[i]);
    if (!(distance <= largest)) largest = distance;  // NaN stays
  }
  return largest;
}

}  // namespace trocar::tissue_cuda
