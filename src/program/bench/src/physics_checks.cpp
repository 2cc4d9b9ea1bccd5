// SPDX-License-Identifier: Apache-2.0
#include "trocar/bench/physics_checks.h"

#include <algorithm>
#include <cmath>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/mesh_topology.h"
#include "trocar/geometry/primitives.h"
#include "trocar/tissue/conservation.h"
#include "trocar/tissue/equilibrium.h"
#include "trocar/tissue/material.h"

namespace trocar::bench {
namespace {

using math::Vec3;
using tissue::NodeCondition;

constexpr double kGravity = 9.81;
/// Strain and modulus of the gallbladder's wall, domain facts 3.2: 255 kPa, 2 mm.
constexpr double kWallModulus = 510.0;

/// The judge: far more iterations than a tick has.
tissue::SolverSettings Exact() {
  return {.kind = tissue::SolverKind::kChebyshevJacobi2015, .max_iterations = 100'000, .tolerance = 1e-8};
}

/// Mesh edges and bending springs that share `modulus` [N/m], on a foundation [Pa/m].
tissue::TissueDefinition MakeWall(const geometry::TriangleMesh& mesh, double modulus, double bending_share,
                                  double foundation) {
  tissue::TissueDefinition definition;
  definition.rest = mesh.positions;
  const auto areas = geometry::CalcVertexAreas(mesh.positions, mesh.triangles);
  definition.shape_stiffness = tissue::CalcFoundationStiffness(areas, foundation, 1.0);
  definition.mass.assign(mesh.positions.size(), 0.0);
  const auto edges = geometry::FindEdges(mesh.triangles);
  const auto stiffness =
      tissue::CalcEdgeStiffness(mesh.positions, mesh.triangles, edges, (1.0 - bending_share) * modulus);
  const auto add = [&](std::uint32_t a, std::uint32_t b, double k) {
    definition.springs.push_back({a, b, k, math::Distance(mesh.positions[a], mesh.positions[b])});
  };
  for (std::size_t i = 0; i < edges.size(); ++i) add(edges[i][0], edges[i][1], stiffness[i]);
  if (bending_share > 0.0) {
    for (const auto& s : tissue::CalcBendingSprings(mesh.positions, mesh.triangles, bending_share * modulus))
      add(s.a, s.b, s.stiffness);
  }
  return definition;
}

struct Stretched {
  double modulus, poisson;  // secant [N/m], [-]
};

/// Pulls a strip of equilateral triangles; its ends slide across.
Stretched StretchStrip(double bending_share, double strain) {
  const double side = 0.004;
  const int columns = 41, rows = 25;
  const auto mesh = geometry::MakeTriangularLattice(columns, rows, side);
  const auto model = tissue::MakeTissueModel(MakeWall(mesh, kWallModulus, bending_share, 0.0));
  auto state = tissue::MakeRestState(model);
  std::vector<std::uint32_t> right;
  for (int row = 0; row < rows; ++row) {
    for (const int column : {0, columns - 1}) {
      const auto node = static_cast<std::uint32_t>(row * columns + column);
      state.condition[node] = NodeCondition::kPrescribed;
      state.position[node] = {model.rest[node].x * (1 + strain), model.rest[node].y * (1 - strain / 3), 0};
      if (column != 0) right.push_back(node);
    }
  }
  tissue::EquilibriumSolver solver(model);
  (void)solver.Solve(Exact(), {}, state);
  const double height = (rows - 1) * side * std::sqrt(0.75);
  const auto top = static_cast<std::size_t>((rows - 1) * columns + columns / 2),
             bottom = static_cast<std::size_t>(columns / 2);
  return {-solver.CalcReaction({}, state, right).x / (height * strain),
          ((state.position[top].y - state.position[bottom].y) / height - 1.0) / -strain};
}

}  // namespace

PhysicsCheck CheckPatch() {
  PhysicsCheck check{
      "Patch test: Young's modulus and Poisson's ratio",
      "A strip of equilateral triangles, 41 x 25 nodes, springs by van Gelder from E t = 510 N/m, pulled "
      "by 0.1 % to 8 %; force over width and strain against E t, narrowing against 1/3. With edges "
      "alone and with three quarters of the modulus in bending springs, as a gallbladder has.",
      {},
      {"Secant modulus over strain", "strain [%]", "E t [N/m]"},
      {}};
  for (const double share : {0.0, 0.75}) {
    const std::string kind = share == 0.0 ? "edges" : "edges and bending";
    PlotLine line{kind, {}};
    for (const double strain : {0.001, 0.01, 0.02, 0.04, 0.08}) {
      const Stretched found = StretchStrip(share, strain);
      line.points.push_back({100 * strain, found.modulus});
      if (strain != 0.001) continue;
      check.figures.push_back({"E t, " + kind, found.modulus, 0.9 * kWallModulus, 1.1 * kWallModulus, "N/m"});
      check.figures.push_back({"Poisson's ratio, " + kind, found.poisson, 0.30, 0.3667, ""});
    }
    check.lines.push_back(line);
  }
  return check;
}

PhysicsCheck CheckHangingChain() {
  // analytic: link i of n carries the masses below it, so it is longer by (n - i) m g / k
  constexpr int kLinks = 20;
  const double k = 50.0, mass = 0.002, link = 0.01;
  tissue::TissueDefinition definition;
  for (int i = 0; i <= kLinks; ++i) {
    definition.rest.push_back({0, 0, -link * i});
    definition.mass.push_back(i == 0 ? 0.0 : mass);
    definition.shape_stiffness.push_back(0.0);
    if (i > 0) {
      definition.springs.push_back(
          {static_cast<std::uint32_t>(i - 1), static_cast<std::uint32_t>(i), k, link});
    }
  }
  definition.fixed = {0};
  const auto model = tissue::MakeTissueModel(definition);
  auto state = tissue::MakeRestState(model);
  tissue::EquilibriumSolver solver(model);
  (void)solver.Solve(Exact(), {.gravity = {0, 0, -kGravity}}, state);
  PhysicsCheck check{
      "Hanging chain",
      "Twenty springs of 50 N/m and 2 g each hang from a hook, no virtual springs; how far each node sinks "
      "against the sum of the weights below it over the stiffness.",
      {},
      {"How far each node sinks", "node", "depth below rest [mm]"},
      {{"simulated", {}}, {"analytic", {}}}};
  double worst = 0, deepest = 0, expected = 0;
  for (int i = 0; i <= kLinks; ++i) {
    if (i > 0) expected += (kLinks - i + 1) * mass * kGravity / k;
    const double sunk = model.rest[i].z - state.position[i].z;
    check.lines[0].points.push_back({double(i), 1e3 * sunk});
    check.lines[1].points.push_back({double(i), 1e3 * expected});
    worst = std::max(worst, std::fabs(sunk - expected));
    deepest = expected;
  }
  check.figures.push_back({"largest error over the chain's extension", 100 * worst / deepest, 0.0, 0.1, "%"});
  return check;
}

PhysicsCheck CheckIndentation() {
  // liver: capsule 1 MPa x 0.04 mm on 5.4 kPa over 80 mm
  const double capsule = 40.0, foundation = 5400.0 / 0.08, radius = 0.0025;
  const int n = 61;
  const double spacing = 0.001;
  const auto mesh = geometry::MakeGrid(n, spacing);
  const auto model = tissue::MakeTissueModel(MakeWall(mesh, capsule, 0.0, foundation));
  const Vec3 centre = 0.5 * (n - 1) * spacing * Vec3{1, 1, 0};
  const auto areas = geometry::CalcVertexAreas(mesh.positions, mesh.triangles);
  PhysicsCheck check{"Indentation by a flat tool of 5 mm",
                     "A flat liver surface (capsule E t = 40 N/m on a Winkler foundation of 5.4 kPa over 80 "
                     "mm) is pressed by a round "
                     "punch. At small depth only the foundation under the punch resists: F / depth = E / h "
                     "times its area. A "
                     "half-space would answer F / depth = 2 a E / (1 - nu^2) = 36 N/m; virtual springs "
                     "beside each other do not pull "
                     "on each other, so a small tool feels far less until the capsule is stretched.",
                     {},
                     {"Punch force", "depth [mm]", "force [N]"},
                     {{"simulated", {}}, {"foundation", {}}, {"half-space", {}}}};
  const double half_space = tissue::CalcPunchStiffness(5400.0, 0.5, radius);
  double area = 0;
  std::vector<std::uint32_t> punch;
  for (std::uint32_t i = 0; i < mesh.positions.size(); ++i) {
    if (math::Distance(mesh.positions[i], centre) > radius) continue;
    punch.push_back(i);
    area += areas[i];
  }
  tissue::EquilibriumSolver solver(model);
  double first = 0, last = 0;
  for (const double depth : {0.00001, 0.001, 0.002, 0.003, 0.004, 0.006, 0.008}) {
    auto state = tissue::MakeRestState(model);
    for (const auto node : punch) {
      state.condition[node] = NodeCondition::kPrescribed;
      state.position[node].z = -depth;
    }
    (void)solver.Solve(Exact(), {}, state);
    const double force = solver.CalcReaction({}, state, punch).z;
    check.lines[0].points.push_back({1e3 * depth, force});
    check.lines[1].points.push_back({1e3 * depth, foundation * area * depth});
    check.lines[2].points.push_back({1e3 * depth, half_space * depth});
    if (first == 0.0) first = force / depth;
    last = force / depth;
  }
  check.figures.push_back(
      {"stiffness at 0.01 mm over the foundation's", first / (foundation * area), 0.95, 1.1, ""});
  check.figures.push_back(
      {"stiffness at 0.01 mm over the half-space's", first / half_space, 0.5, 2.0, "", true});
  check.figures.push_back({"stiffness at 8 mm over the half-space's", last / half_space, 0.5, 2.0, "", true});
  return check;
}

PhysicsCheck CheckSelfWeight() {
  const double foundation = 5400.0 / 0.08, load = 20.0;  // [Pa/m], [kg/m^2]
  const auto mesh = geometry::MakeGrid(21, 0.005);
  auto definition = MakeWall(mesh, 40.0, 0.0, foundation);
  const auto areas = geometry::CalcVertexAreas(mesh.positions, mesh.triangles);
  for (std::size_t i = 0; i < areas.size(); ++i) definition.mass[i] = load * areas[i];
  const auto model = tissue::MakeTissueModel(definition);
  auto state = tissue::MakeRestState(model);
  tissue::EquilibriumSolver solver(model);
  (void)solver.Solve(Exact(), {.gravity = {0, 0, -kGravity}}, state);
  const double expected = load * kGravity / foundation;
  double worst = 0;
  for (const Vec3& p : state.position) worst = std::max(worst, std::fabs(-p.z / expected - 1.0));
  return {"Self-weight",
          "A flat surface of 20 kg/m^2 on the liver's foundation sinks by weight over foundation modulus, "
          "everywhere "
          "alike.",
          {{"depth", -1e3 * state.position[mesh.positions.size() / 2].z, 0.999e3 * expected,
            1.001e3 * expected, "mm"},
           {"largest error of any node", 100 * worst, 0.0, 0.1, "%"}},
          {},
          {}};
}

PhysicsCheck CheckEnergy() {
  const auto mesh = geometry::MakeSphere({0, 0, 0}, 0.02, 3);
  const auto model = tissue::MakeTissueModel(MakeWall(mesh, kWallModulus, 0.75, 3e4));
  PhysicsCheck check{
      "Energy goes down",
      "A crumpled sac is let go: the stored energy after each tick of the running solver and of the "
      "paper's relaxation, with 40 iterations a tick. No tick may end with more than it began with.",
      {},
      {"Stored energy, as its logarithm", "tick", "log10 of the energy [J]"},
      {}};
  for (const auto kind : {tissue::SolverSettings{}.kind, tissue::SolverKind::kRelaxationPaper}) {
    auto state = tissue::MakeRestState(model);
    for (std::size_t i = 0; i < state.position.size(); ++i) {
      const auto wobble = [&](int salt) { return 0.004 * std::sin(12.9898 * double(i) + 78.233 * salt); };
      state.position[i] += Vec3{wobble(1), wobble(2), wobble(3)};
    }
    tissue::EquilibriumSolver solver(model);
    PlotLine line{std::string(tissue::SolverName(kind)), {}};
    double before = tissue::CalcEnergy(model, state, {}), start = before, rise = 0;
    for (int tick = 0; tick <= 60; ++tick) {
      line.points.push_back({double(tick), std::log10(std::max(before, 1e-12))});
      (void)solver.Solve({.kind = kind, .max_iterations = 40}, {}, state);
      const double after = tissue::CalcEnergy(model, state, {});
      rise = std::max(rise, (after - before) / start);
      before = after;
    }
    check.figures.push_back({"largest rise in a tick over the energy at the start, " + line.name, rise,
                             -std::numeric_limits<double>::infinity(), 1e-9, ""});
    check.lines.push_back(line);
  }
  return check;
}

PhysicsCheck CheckMeshRefinement() {
  const double radius = 0.015, strain = 1e-3;
  const double expected = 2.0 * kWallModulus / (1.0 - 1.0 / 3.0) / radius * strain;
  PhysicsCheck check{
      "Mesh refinement: pressure of a filled sphere",
      "A closed sphere is filled by 0.3 % of its volume; the constraint's pressure against that of a thin "
      "shell, P = 2 E t strain / ((1 - nu) r), on meshes of 80 to 5,120 triangles.",
      {},
      {"Error of the pressure", "triangles, as their logarithm to base 10", "error [%]"},
      {{"simulated", {}}}};
  double last = 0;
  for (int subdivisions = 1; subdivisions <= 4; ++subdivisions) {
    const auto mesh = geometry::MakeSphere({0, 0, 0}, radius, subdivisions);
    const auto model = tissue::MakeTissueModel(MakeWall(mesh, kWallModulus, 0.0, 100.0));
    auto state = tissue::MakeRestState(model);
    tissue::Conservation conservation(
        model, {{{0, static_cast<std::uint32_t>(mesh.positions.size()), mesh.triangles}}, {}, {}});
    auto kept = conservation.MakeState(state);
    kept.organs[0].target *= 1.0 + 3.0 * strain;
    tissue::EquilibriumSolver solver(model);
    for (int tick = 0; tick < 30; ++tick) {
      tissue::TissueLoad load;
      (void)tissue::SolveConserving(
          solver,
          {.kind = tissue::SolverKind::kChebyshevJacobi2015, .max_iterations = 300, .tolerance = 1e-9},
          1.0 / 120, conservation, load, state, kept);
    }
    last = 100.0 * (kept.organs[0].pressure / expected - 1.0);
    check.lines[0].points.push_back({std::log10(double(mesh.triangles.size())), last});
  }
  check.figures.push_back({"error on the finest mesh", last, -2.0, 2.0, "%"});
  return check;
}

PhysicsCheck CheckFreedOrgan() {
  PhysicsCheck check{
      "A freed organ is carried away",
      "A sac of 15 mm radius, held by nothing but the jaws, is carried 0.2 m and turned by a right angle; "
      "the "
      "largest distance of a node from the rigidly moved rest shape, with virtual springs whose frame "
      "follows and, for comparison, with the paper's, which stay where the organ was imaged.",
      {},
      {"Shape error on the way", "time [s]", "error [mm]"},
      {{"frame follows", {}}, {"frame fixed", {}}}};
  const auto mesh = geometry::MakeSphere({0, 0, 0}, 0.015, 3);
  const auto definition = MakeWall(mesh, kWallModulus, 0.75, 3e4);
  const auto model = tissue::MakeTissueModel(definition);
  for (const bool follows : {true, false}) {
    auto state = tissue::MakeRestState(model);
    tissue::Conservation conservation(
        model, {{{0, static_cast<std::uint32_t>(mesh.positions.size()), mesh.triangles}}, {}, {}});
    auto kept = conservation.MakeState(state);
    if (!follows) {
      kept.regions.count = 0;
      std::fill(kept.regions.of_node.begin(), kept.regions.of_node.end(), tissue::kPinnedRegion);
    }
    tissue::EquilibriumSolver solver(model);
    double error = 0;
    for (int tick = 0; tick <= 300; ++tick) {
      const double way = std::min(1.0, tick / 240.0);
      const math::Pose X{math::RotationAbout(math::Normalized(Vec3{1, 1, 0}), 0.5 * M_PI * way),
                         way * Vec3{0.12, -0.16, 0}};
      for (std::uint32_t i = 0; i < model.Size(); ++i) {
        if (model.rest[i].y > -0.9 * 0.015) continue;
        state.condition[i] = NodeCondition::kPrescribed;
        state.position[i] = X * model.rest[i];
      }
      tissue::TissueLoad load;
      (void)tissue::SolveConserving(solver, {}, 1.0 / 120, conservation, load, state, kept);
      tissue::MotionMoments moments;
      for (std::uint32_t i = 0; i < model.Size(); ++i)
        moments.AddPoint(1.0, model.rest[i], state.position[i]);
      const math::Pose fit = tissue::FitRigidMotion(moments, X.rotation);
      error = 0;
      for (std::uint32_t i = 0; i < model.Size(); ++i)
        error = std::max(error, math::Distance(fit * model.rest[i], state.position[i]));
      check.lines[follows ? 0 : 1].points.push_back({tick / 120.0, 1e3 * error});
    }
    if (follows) check.figures.push_back({"shape error at the end", 1e3 * error, 0.0, 0.1, "mm"});
  }
  return check;
}

}  // namespace trocar::bench
