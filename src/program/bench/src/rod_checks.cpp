// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "trocar/bench/physics_checks.h"
#include "trocar/rod/rod.h"

namespace trocar::bench {
namespace {

using math::Vec3;

constexpr double kGravity = 9.81;
/// A thread of 0.3 mm and 2 GPa; along its length as stiff as keeps it to a part in a thousand under 10 N.
rod::RodMaterial MakeThread() {
  rod::RodMaterial material = rod::MakeRoundMaterial(3e-4, 2e9, 0.3, 1350.0);
  material.stretching = 1e4;
  return material;
}

std::vector<Vec3> MakeLine(int segments, double length) {
  std::vector<Vec3> nodes;
  for (int i = 0; i <= segments; ++i) nodes.push_back({length * i / segments, 0, 0});
  return nodes;
}

/// A rod, its state and its solver, clamped where a check says so.
struct HeldRod {
  HeldRod(const std::vector<Vec3>& nodes, const rod::RodMaterial& material)
      : model(rod::MakeRodModel({nodes, material}).value()),
        state(rod::MakeRodState(model, nodes)),
        solver(model) {}
  void Hold(std::size_t node) { state.is_held[node] = 1; }
  void ClampFirst() { Hold(0), Hold(1), state.is_angle_held.front() = 1; }
  void ClampLast() {
    Hold(model.NodeCount() - 1), Hold(model.NodeCount() - 2), state.is_angle_held.back() = 1;
  }
  rod::RodReport Solve(const rod::RodLoad& load, int max_steps = 500) {
    return solver.Solve({.max_steps = max_steps}, load, state);
  }

  rod::RodModel model;
  rod::RodState state;
  rod::RodSolver solver;
};

/// Sinking of the tip of a cantilever over its length, by the elastica (Bisshopp and Drucker, Q. Appl. Math. 3, 1945): the slope
/// at the tip for which a rod integrated from there is level at the clamp.
///
/// \param load  P l^2 / E I [-]
double CalcElasticaTip(double load) {
  constexpr int kSteps = 2000;
  struct End {
    double slope, sunk;
  };
  const auto integrate = [load](double slope) {
    double angle = slope, curvature = 0, sunk = 0;
    const double h = 1.0 / kSteps;
    for (int i = 0; i < kSteps; ++i) {
      // midpoint rule, from the tip to the clamp
      const double middle = angle - 0.5 * h * curvature;
      const double middle_curvature = curvature + 0.5 * h * load * std::cos(angle);
      sunk += h * std::sin(middle);
      curvature += h * load * std::cos(middle);
      angle -= h * middle_curvature;
    }
    return End{angle, sunk};
  };
  double low = 0, high = 0.5 * M_PI;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (integrate(middle).slope < 0.0 ? low : high) = middle;
  }
  return integrate(0.5 * (low + high)).sunk;
}

/// The value in [low, high] from which on a rod is not stable any more.
double FindOnset(double low, double high, const std::function<bool(double)>& is_stable) {
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    (is_stable(middle) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Pressure at which a straight rod of 0.1 m ceases to be stable, over E I / l^2.
double FindBucklingLoad(int segments, bool is_clamped) {
  const double length = 0.1;
  const rod::RodMaterial thread = MakeThread();
  // a clamp holds a segment, from whose middle on the rod bends
  const double bending_length = is_clamped ? length - length / segments : length;
  const auto is_stable = [&](double load) {
    HeldRod held(MakeLine(segments, length), thread);
    held.Hold(0), held.Hold(static_cast<std::size_t>(segments));
    held.state.is_angle_held.front() = 1;  // else it may spin about its axis
    if (is_clamped) held.ClampFirst(), held.ClampLast();
    const double strain = load * thread.bending / (bending_length * bending_length) / thread.stretching;
    for (Vec3& p : held.state.position) p.x *= 1.0 - strain;
    return held.Solve({}).is_stable;
  };
  return FindOnset(1.0, 100.0, is_stable);
}

/// Twist at which a ring that is clamped at one place leaves its plane, over 2 pi E I / G J.
double FindRingTwist(int segments) {
  const rod::RodMaterial thread = MakeThread();
  std::vector<Vec3> nodes;
  for (int i = 0; i <= segments + 1; ++i) {
    const double angle = 2.0 * M_PI * i / segments;
    nodes.push_back({0.02 * std::cos(angle), 0.02 * std::sin(angle), 0});
  }
  const double unit = 2.0 * M_PI * thread.bending / thread.twisting;
  return FindOnset(1.0, 3.0, [&](double twist) {
    HeldRod ring(nodes, thread);
    ring.ClampFirst(), ring.ClampLast();
    for (std::size_t s = 0; s < ring.state.angle.size(); ++s)
      ring.state.angle[s] = twist * unit * static_cast<double>(s) / segments;
    // the whole ring may swing about its clamp without any energy: hardly held, it is not taken for unstable
    const double hold = 1e-4 * thread.bending * 2.0 * M_PI / (segments * 0.02 * 0.02 * 0.02);
    return ring.Solve({.gravity = {}, .force = {}, .drag = hold}).is_stable;
  });
}

double PercentOff(double value, double expected) {
  return 100.0 * std::fabs(value / expected - 1.0);
}

}  // namespace

PhysicsCheck CheckRodCantilever() {
  PhysicsCheck check{"Rod: cantilever under its tip's load",
                     "A thread of 0.1 m in 100 segments is clamped level and loaded at its tip by up to ten "
                     "times E I / l^2; how far the tip "
                     "sinks against the elastica (Bisshopp and Drucker 1945).",
                     {},
                     {"How far the tip sinks", "load over E I / l^2", "sunk, over the length"},
                     {{"simulated", {}}, {"elastica", {}}}};
  const double length = 0.1;
  constexpr int kSegments = 100;
  const rod::RodMaterial thread = MakeThread();
  const double bending_length = length - 0.5 * length / kSegments;
  double worst = 0;
  HeldRod held(MakeLine(kSegments, length), thread);
  held.ClampFirst();
  std::vector<Vec3> force(kSegments + 1);
  for (const double load : {0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0}) {
    force.back() = {0, 0, -load * thread.bending / (bending_length * bending_length)};
    const bool is_found = held.Solve({.gravity = {}, .force = force}).converged;
    const double sunk = -held.state.position.back().z / bending_length, expected = CalcElasticaTip(load);
    check.lines[0].points.push_back({load, sunk}), check.lines[1].points.push_back({load, expected});
    worst = std::max(worst, is_found ? PercentOff(sunk, expected) : INFINITY);
  }
  check.figures.push_back({"largest error of the sinking", worst, 0.0, 0.5, "%"});
  return check;
}

PhysicsCheck CheckRodBuckling() {
  PhysicsCheck check{
      "Rod: Euler's buckling",
      "A straight thread of 0.1 m is pressed along its length; the load at which its stiffness ceases to be "
      "positive definite, "
      "against pi^2 E I / l^2 with pinned ends and four times that with clamped ones.",
      {},
      {"Critical load against the number of segments", "segments", "over Euler's [-]", false, 640, 260, true},
      {{"pinned", {}}, {"clamped", {}}}};
  for (const int segments : {10, 20, 50, 100}) {
    const double pinned = FindBucklingLoad(segments, false) / (M_PI * M_PI),
                 clamped = FindBucklingLoad(segments, true) / (4.0 * M_PI * M_PI);
    check.lines[0].points.push_back({double(segments), pinned});
    check.lines[1].points.push_back({double(segments), clamped});
    if (segments != 100) continue;
    check.figures.push_back({"pinned, 100 segments, off by", PercentOff(pinned, 1.0), 0.0, 2.0, "%"});
    check.figures.push_back({"clamped, 100 segments, off by", PercentOff(clamped, 1.0), 0.0, 2.0, "%"});
  }
  return check;
}

PhysicsCheck CheckRodRing() {
  PhysicsCheck check{"Rod: twisted ring (Michell 1889, Zajac 1962)",
                     "A thread is bent into a ring, both ends clamped at one place, and one of them twisted; "
                     "the twist at which the plane ring "
                     "ceases to be stable against 2 pi sqrt(3) E I / G J.",
                     {},
                     {"Critical twist against the number of segments", "segments", "over Zajac's [-]"},
                     {{"simulated", {}}}};
  for (const int segments : {20, 40, 80, 160}) {
    const double share = FindRingTwist(segments) / std::sqrt(3.0);
    check.lines[0].points.push_back({double(segments), share});
    if (segments == 160)
      check.figures.push_back({"160 segments, off by", PercentOff(share, 1.0), 0.0, 5.0, "%"});
  }
  return check;
}

PhysicsCheck CheckRodCatenary() {
  PhysicsCheck check{"Rod: catenary",
                     "A chain of 0.2 m in 200 segments, without stiffness against bending, hangs between two "
                     "hands that come together; how "
                     "deep its middle hangs, and what each hand carries, against the catenary.",
                     {},
                     {"Where it hangs, the hands 0.12 m apart", "across [mm]", "depth [mm]", true},
                     {{"simulated", {}}, {"catenary", {}}}};
  constexpr int kSegments = 200;
  constexpr double kLength = 0.2;
  rod::RodMaterial chain = MakeThread();
  chain.bending = chain.twisting = 0.0;
  HeldRod held(MakeLine(kSegments, kLength), chain);
  held.Hold(0), held.Hold(kSegments);
  double apart = kLength, worst = 0, worst_pull = 0, stretched = 0;
  while (apart > 0.0601) {
    apart -= 0.001;
    held.state.position.back().x = apart;
    const rod::RodReport report = held.Solve({.gravity = {0, 0, -kGravity}, .force = {}});
    if (apart > 0.181) continue;
    // l = 2 a sinh(d / 2 a)
    double low = 1e-3, high = 10.0;
    for (int i = 0; i < 100; ++i) {
      const double a = 0.5 * (low + high);
      (2.0 * a * std::sinh(0.5 * apart / a) > kLength ? low : high) = a;
    }
    const double a = low, depth = a * (std::cosh(0.5 * apart / a) - 1.0);
    const double across = chain.mass_per_length * kGravity * a;  // the tension's level part
    worst = std::max(worst,
                     report.converged ? PercentOff(-held.state.position[kSegments / 2].z, depth) : INFINITY);
    worst_pull = std::max(worst_pull, PercentOff(-held.solver.Reaction(0).x, across));
    stretched = std::max(stretched, report.length_error);
    if (std::fabs(apart - 0.12) > 1e-9) continue;
    for (int i = 0; i <= kSegments; i += 4) {
      const Vec3& p = held.state.position[static_cast<std::size_t>(i)];
      check.lines[0].points.push_back({1e3 * p.x, 1e3 * p.z});
      const double x = p.x - 0.5 * apart;
      check.lines[1].points.push_back(
          {1e3 * p.x, 1e3 * (a * (std::cosh(x / a) - std::cosh(0.5 * apart / a)))});
    }
  }
  check.figures.push_back({"largest error of the depth", worst, 0.0, 0.5, "%"});
  check.figures.push_back({"largest error of a hand's level pull", worst_pull, 0.0, 1.0, "%"});
  check.figures.push_back({"largest error of a segment's length", 100.0 * stretched, 0.0, 0.1, "%"});
  return check;
}

}  // namespace trocar::bench
