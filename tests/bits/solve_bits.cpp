// SPDX-License-Identifier: Apache-2.0
/// \file solve_bits.cpp  Prints a fingerprint of what every solver finds, at every level of vector instructions that this processor has.
///
/// check_bits.sh compiles it, together with the solvers' own sources, once for each compiler and optimisation: all
/// must print the same.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include "trocar/base/state_hash.h"
#include "trocar/geometry/mesh_topology.h"
#include "trocar/geometry/primitives.h"
#include "trocar/tissue/conservation.h"
#include "trocar/tissue/equilibrium.h"
#include "trocar/tissue/material.h"
#if !defined(TROCAR_BITS_ONE_THREAD)
#include "trocar/host/threads.h"
#endif

namespace {

using namespace trocar::tissue;
using trocar::base::HasSimdLevel;
using trocar::base::SimdLevel;
using trocar::base::SimdLevelName;
using trocar::math::Vec3;

/// Where there is no library of threads (WebAssembly, another processor's), the caller does all: the bits are the same.
trocar::base::Threads UseTwoThreads() {
#if defined(TROCAR_BITS_ONE_THREAD)
  return {};
#else
  return trocar::host::UseThreads(2);
#endif
}

struct Sheet {
  TissueModel model;
  TissueState state;
};

/// A sheet of n x n nodes with one diagonal a cell, its left edge held. An irregular one is bent out of its plane and hangs on
/// strands, and a chain of eight nodes hangs from its corner.
Sheet MakeSheet(std::uint32_t n, bool is_irregular) {
  TissueDefinition definition;
  const auto at = [n](std::uint32_t row, std::uint32_t column) { return row * n + column; };
  for (std::uint32_t row = 0; row < n; ++row) {
    for (std::uint32_t column = 0; column < n; ++column) {
      const double x = 0.01 * column, y = 0.01 * row;
      definition.rest.push_back({x, y, is_irregular ? 3.0 * x * (0.2 - y) : 0.0});
      if (column == 0) definition.fixed.push_back(at(row, column));
    }
  }
  const auto add_spring = [&](std::uint32_t a, std::uint32_t b, double k) {
    const Vec3 along = definition.rest[b] - definition.rest[a];
    definition.springs.push_back({a, b, k, std::sqrt(trocar::math::SquaredNorm(along))});
  };
  for (std::uint32_t row = 0; row < n; ++row) {
    for (std::uint32_t column = 0; column < n; ++column) {
      if (column + 1 < n) add_spring(at(row, column), at(row, column + 1), 100.0);
      if (row + 1 < n) add_spring(at(row, column), at(row + 1, column), 100.0);
      if (column + 1 < n && row + 1 < n) add_spring(at(row, column), at(row + 1, column + 1), 50.0);
    }
  }
  if (is_irregular) {
    std::uint32_t last = at(n - 1, n - 1);
    for (int link = 0; link < 8; ++link) {
      definition.rest.push_back(definition.rest[last] + Vec3{0.004, 0.001 * link, 0.002});
      const auto next = static_cast<std::uint32_t>(definition.rest.size() - 1);
      add_spring(last, next, 400.0);
      last = next;
    }
    for (std::uint32_t row = 0; row + 2 < n; row += 2)
      definition.strands.push_back({at(row, 2), at(row + 2, 4), 30.0});
  }
  definition.mass.assign(definition.rest.size(), 1e-3);
  definition.shape_stiffness.assign(definition.rest.size(), is_irregular ? 0.3 : 1.0);
  Sheet sheet{MakeTissueModel(definition), {}};
  sheet.state = MakeRestState(sheet.model);
  return sheet;
}

/// Three solves in a row: under weight, with a node pulled away, pressed by a tool.
std::uint64_t CalcFingerprint(Sheet sheet, SolverKind kind, SimdLevel level) {
  EquilibriumSolver solver(sheet.model, {.threads = UseTwoThreads(), .simd = level});
  SolverSettings settings;
  settings.kind = kind;
  settings.max_iterations = 60;
  const ContactSpring contact{{70, 71, 91}, {0.25, 0.25, 0.5}, {0, 0, 1}, 0.02, 300.0};
  TissueLoad load{.gravity = {0.3, -0.5, -9.81}};
  trocar::base::StateHash hash;
  for (int solve = 0; solve < 3; ++solve) {
    if (solve == 1) {
      sheet.state.condition[150] = NodeCondition::kPrescribed;
      sheet.state.position[150] += Vec3{0.002, 0.001, 0.02};
    }
    if (solve == 2) load.contacts = {&contact, 1};
    const SolveReport report = solver.Solve(settings, load, sheet.state);
    hash.Add(static_cast<std::uint64_t>(report.iterations));
    for (const Vec3& p : sheet.state.position) hash.Add(p.x), hash.Add(p.y), hash.Add(p.z);
  }
  return hash.Value();
}

/// A tense sac, held at one side and pulled at the other, in ticks that keep its volume and follow folds.
std::uint64_t CalcSacFingerprint(SimdLevel level) {
  constexpr double kRadius = 0.015;
  const auto mesh = trocar::geometry::MakeSphere({}, kRadius, 3);
  const auto n = static_cast<std::uint32_t>(mesh.positions.size());
  TissueDefinition definition;
  definition.rest = mesh.positions;
  definition.mass.assign(n, 1e-4);
  definition.shape_stiffness.assign(n, 0.01);
  const auto edges = trocar::geometry::FindEdges(mesh.triangles);
  const auto stiffness = CalcEdgeStiffness(mesh.positions, mesh.triangles, edges, 510.0);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto [a, b] = edges[i];
    definition.springs.push_back(
        {a, b, stiffness[i], trocar::math::Distance(mesh.positions[a], mesh.positions[b])});
  }
  const TissueModel model = MakeTissueModel(definition);
  TissueState tissue = MakeRestState(model);
  ConservationSettings closed;
  closed.organs = {{0, n, mesh.triangles}};
  Conservation conservation(model, closed);
  ConservationState state = conservation.MakeState(tissue);
  state.organs[0].target *= 1.2;
  EquilibriumSolver solver(model, {.threads = UseTwoThreads(), .simd = level});
  SolverSettings settings;
  settings.kind = SolverKind::kNewtonMultigrid;
  trocar::base::StateHash hash;
  for (int tick = 0; tick < 8; ++tick) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const double height = mesh.positions[i].y / kRadius;
      if (std::fabs(height) < 0.9) continue;
      tissue.condition[i] = NodeCondition::kPrescribed;
      tissue.position[i] = mesh.positions[i];
      if (height < 0.0) tissue.position[i] += (tick + 1) * Vec3{0.0015, 0.0, 0.0005};
    }
    TissueLoad load;
    const SolveReport report =
        SolveConserving(solver, settings, 1.0 / 120, conservation, load, tissue, state);
    hash.Add(static_cast<std::uint64_t>(report.linear_iterations));
    hash.Add(state.organs[0].pressure);
    for (const Vec3& p : tissue.position) hash.Add(p.x), hash.Add(p.y), hash.Add(p.z);
  }
  return hash.Value();
}

}  // namespace

int main() {
  for (const SimdLevel level : {SimdLevel::kBaseline, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
    if (!HasSimdLevel(level)) continue;
    for (const SolverKind kind : kSolverKinds) {
      for (const bool is_irregular : {false, true}) {
        std::printf(
            "%s %s %s %016llx\n", std::string(SimdLevelName(level)).c_str(),
            std::string(SolverName(kind)).c_str(), is_irregular ? "irregular" : "grid",
            static_cast<unsigned long long>(CalcFingerprint(MakeSheet(20, is_irregular), kind, level)));
      }
    }
    std::printf("%s sac %016llx\n", std::string(SimdLevelName(level)).c_str(),
                static_cast<unsigned long long>(CalcSacFingerprint(level)));
  }
}
