// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "trocar/rod/rod.h"

namespace trocar::rod {
namespace {

using math::Vec3;

constexpr double kRadius = 1.5e-4;

RodMaterial MakeThread() {
  RodMaterial material = MakeRoundMaterial(2 * kRadius, 1e9, 0.3, 1350.0);
  material.stretching = 1e4;
  return material;
}

/// Nodes a fixed way apart along a line of points.
std::vector<Vec3> Resample(const std::vector<Vec3>& line, double spacing) {
  std::vector<Vec3> nodes{line.front()};
  double left = spacing;
  for (std::size_t i = 1; i < line.size(); ++i) {
    Vec3 from = line[i - 1];
    for (double way = math::Distance(from, line[i]); way >= left; way = math::Distance(from, line[i])) {
      from = math::Lerp(from, line[i], left / way);
      nodes.push_back(from);
      left = spacing;
    }
    left -= math::Distance(from, line[i]);
  }
  return nodes;
}

/// Two straight tails with an overhand knot between them, about `size` wide.
std::vector<Vec3> MakeOverhandKnot(double size) {
  std::vector<Vec3> line;
  const auto at = [size](double t) {
    return 0.25 * size *
           Vec3{std::sin(t) + 2 * std::sin(2 * t), std::cos(t) - 2 * std::cos(2 * t), -1.2 * std::sin(3 * t)};
  };
  // open at its outermost bow, from where the tails go to both sides
  const double from = M_PI + 0.2, to = 3 * M_PI - 0.2;
  const Vec3 first = at(from), last = at(to);
  const Vec3 out_first = math::Normalized(at(from) - at(from + 0.01)),
             out_last = math::Normalized(at(to) - at(to - 0.01));
  for (int i = 30; i > 0; --i) line.push_back(first + 1e-3 * i * out_first);
  for (int i = 0; i <= 400; ++i) line.push_back(at(from + (to - from) * i / 400));
  for (int i = 1; i <= 30; ++i) line.push_back(last + 1e-3 * i * out_last);
  return Resample(line, 1e-3);
}

/// A rod that is drawn by its ends, with what it does to itself.
struct Thread {
  explicit Thread(const std::vector<Vec3>& nodes, double friction)
      : model(MakeRodModel({nodes, MakeThread()}).value()), state(MakeRodState(model, nodes)), solver(model) {
    settings.self_friction = friction;
    state.is_held.front() = state.is_held.back() = 1;
    state.is_angle_held.front() = 1;
  }
  RodReport Tick() {
    FollowCrossings(model, state, settings, crossings);
    return solver.Solve({.max_steps = 8, .max_move = 0.15, .max_way = 5e-4},
                        {.gravity = {},
                         .force = {},
                         .drag = 1e-3,
                         .contacts = {},
                         .crossings = crossings,
                         .contact = settings},
                        state);
  }
  /// Least distance of two parts that are no neighbours, over the thread's diameter.
  double CalcLeastGap() const {
    double least = INFINITY;
    for (const RodCrossing& c : crossings) {
      const Vec3 apart = math::Lerp(state.position[c.a], state.position[c.a + 1], c.at_a) -
                         math::Lerp(state.position[c.b], state.position[c.b + 1], c.at_b);
      least = std::min(least, math::Dot(apart, c.normal));
    }
    return least / (2 * kRadius);
  }

  RodModel model;
  RodState state;
  RodSolver solver;
  RodContactSettings settings;
  std::vector<RodCrossing> crossings;
};

/// How a thread with its ends joined far away is knotted or wound: changes by two where one part goes through another.
double CalcClosedWrithe(const Thread& thread) {
  std::vector<Vec3> closed = thread.state.position;
  const Vec3 a = closed.back(), b = closed.front();
  const Vec3 up = {0, 0, 0.5};
  closed.push_back(a + up), closed.push_back(b + up);
  return CalcWrithe(closed);
}

/// A thread along x whose end comes round and lies across its first part, over it. Held where a case says so.
std::vector<Vec3> MakeCrossed() {
  std::vector<Vec3> line;
  for (int i = 0; i <= 20; ++i) line.push_back({1e-3 * i, 0, 0});
  for (int i = 1; i <= 30; ++i) {
    const double u = 1.5 * M_PI * i / 30;
    line.push_back({0.02 + 0.01 * std::sin(u), 0.01 - 0.01 * std::cos(u), 1e-3 * i / 30});
  }
  for (int i = 1; i <= 20; ++i) line.push_back({0.01, 0.01 - 1e-3 * i, 1e-3});
  return Resample(line, 1e-3);
}

TEST(RodCrossing, TwoPartsPressOnEachOtherAndDoNotPass) {
  Thread thread(MakeCrossed(), 0.2);
  const std::size_t last = thread.model.NodeCount() - 1;
  // the first part is held on both sides of the crossing, the other one by its end and before the crossing
  for (const std::size_t node : {std::size_t{1}, std::size_t{20}, last - 20}) thread.state.is_held[node] = 1;
  const double before = CalcClosedWrithe(thread);
  double most = 0;
  for (int tick = 0; tick < 40; ++tick) {
    for (const std::size_t node : {last - 20, last}) thread.state.position[node].z -= 5e-5;
    ASSERT_TRUE(thread.Tick().is_finite);
    for (const RodCrossing& c : thread.crossings) most = std::max(most, c.pressure);
    ASSERT_GT(thread.CalcLeastGap(), 0.5) << tick;
  }
  EXPECT_GT(most, 0.01) << "they press";
  EXPECT_LT(thread.state.position[10].z, -1e-4) << "the first part gives way";
  EXPECT_NEAR(CalcClosedWrithe(thread), before, 1.0) << "going through would change it by two";
}

TEST(RodCrossing, AnOverhandKnotDrawnTightStaysOne) {
  Thread thread(MakeOverhandKnot(0.02), 0.15);
  const Vec3 along = math::Normalized(thread.state.position.back() - thread.state.position.front());
  double tension = 0;
  for (int tick = 0; tick < 600 && tension < 2.0; ++tick) {
    thread.state.position.front() -= 1e-4 * along, thread.state.position.back() += 1e-4 * along;
    ASSERT_TRUE(thread.Tick().is_finite);
    tension = thread.state.tension[2];
    ASSERT_GT(thread.CalcLeastGap(), 0.5) << tick << " tension " << tension;
  }
  EXPECT_GE(tension, 2.0) << "it holds";
  EXPECT_LT(math::Distance(thread.state.position.front(), thread.state.position.back()),
            static_cast<double>(thread.model.SegmentCount()) * 1e-3 - 3e-3)
      << "some thread is in the knot; one that had slipped through itself would be straight";
  // an ideal trefoil's is 3.4, of its mirror image -3.4 (Katritch et al., Nature 384, 1996)
  EXPECT_NEAR(std::fabs(CalcClosedWrithe(thread)), 3.2, 0.4);
}

}  // namespace
}  // namespace trocar::rod
