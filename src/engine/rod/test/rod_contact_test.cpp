// SPDX-License-Identifier: Apache-2.0
#include "trocar/rod/rod_contact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "trocar/rod/rod.h"

namespace trocar::rod {
namespace {

using math::Vec3;

RodMaterial MakeThread() {
  RodMaterial material = MakeRoundMaterial(3e-4, 1e9, 0.3, 1350.0);
  material.stretching = 1e4;
  return material;
}

/// Over a shaft across y, half round it; both ends hang down.
std::vector<Vec3> MakeHanging(double radius, double spacing, int below) {
  std::vector<Vec3> nodes;
  for (int i = below; i > 0; --i) nodes.push_back({-radius, 0, -spacing * i});
  const int round = static_cast<int>(std::lround(M_PI * radius / spacing));
  for (int i = 0; i <= round; ++i) {
    const double angle = M_PI - M_PI * i / round;
    nodes.push_back({radius * std::cos(angle), 0, radius * std::sin(angle)});
  }
  for (int i = 1; i <= below; ++i) nodes.push_back({radius, 0, -spacing * i});
  return nodes;
}

/// Pull of a hand that draws a thread over a shaft against a force of half a newton at its other end, over that force.
double CalcPullRatio(double friction, double ticks_down) {
  const double shaft = 0.01, thread = 1.5e-4, force = 0.5;
  const std::vector<Vec3> nodes = MakeHanging(shaft + thread, 1e-3, 12);
  const RodModel model = MakeRodModel({nodes, MakeThread()}).value();
  RodState state = MakeRodState(model, nodes);
  RodSolver solver(model);
  std::vector<RodContact> contacts;
  const RodObstacle obstacle{.a = {0, -0.05, 0},
                             .b = {0, 0.05, 0},
                             .outward = {},
                             .radius = shaft,
                             .friction = friction,
                             .motion = {}};
  std::vector<Vec3> forces(nodes.size());
  forces.back() = {0, 0, -force};
  state.is_held.front() = 1;
  state.is_angle_held.front() = 1;
  double pull = 0;
  for (int tick = 0; tick < 150; ++tick) {
    state.position.front().z -= ticks_down;
    FollowContacts(model, state, std::span(&obstacle, 1), {}, contacts);
    const RodReport report = solver.Solve(
        {.max_steps = 60},
        {.gravity = {}, .force = forces, .drag = 1e-4, .contacts = contacts, .contact = {}}, state);
    EXPECT_TRUE(report.is_finite);
    pull = -solver.Reaction(0).z;
  }
  return pull / force;
}

TEST(RodContact, AThreadOverAShaftFollowsTheCapstanLaw) {
  EXPECT_NEAR(CalcPullRatio(0.0, 2e-5), 1.0, 0.01);
  for (const double friction : {0.1, 0.2, 0.4}) {
    const double drawn = std::log(CalcPullRatio(friction, 2e-5)),
                 let = std::log(CalcPullRatio(friction, -2e-5));
    EXPECT_NEAR(drawn, friction * M_PI, 0.05 * friction * M_PI) << friction;
    EXPECT_NEAR(let, -friction * M_PI, 0.05 * friction * M_PI) << "let go";
  }
}

TEST(RodContact, AThreadThatIsLetGoComesToRestOnWhatLiesBelow) {
  std::vector<Vec3> nodes;
  for (int i = 0; i <= 60; ++i)
    nodes.push_back({1e-3 * i, 0.004 * std::sin(0.2 * i), 0.01 + 0.003 * std::cos(0.3 * i)});
  const RodModel model = MakeRodModel({nodes, MakeThread()}).value();
  RodState state = MakeRodState(model, nodes);
  RodSolver solver(model);
  std::vector<RodContact> contacts;
  const RodObstacle floor{.a = {}, .b = {}, .outward = {0, 0, 1}, .radius = 0, .friction = 0.3, .motion = {}};
  double moved = 1;
  int tick = 0;
  for (; tick < 2000 && moved > 1e-9; ++tick) {
    const std::vector<Vec3> before = state.position;
    FollowContacts(model, state, std::span(&floor, 1), {}, contacts);
    ASSERT_TRUE(
        solver
            .Solve({},
                   {.gravity = {0, 0, -9.81}, .force = {}, .drag = 1e-3, .contacts = contacts, .contact = {}},
                   state)
            .is_finite);
    moved = 0;
    for (std::size_t i = 0; i < before.size(); ++i)
      moved = std::max(moved, math::Distance(before[i], state.position[i]));
  }
  EXPECT_LT(tick, 2000) << "still moves by " << moved;
  for (const Vec3& p : state.position) {
    EXPECT_GT(p.z, 1.4e-4);
    EXPECT_LT(p.z, 3e-3) << "lies";
  }
}

TEST(RodContact, AThreadOnASlopeStaysOrSlidesAsItsFrictionSays) {
  const auto slide = [](double friction) {
    const double slope = std::atan(0.3);
    const Vec3 down = {std::cos(slope), 0, -std::sin(slope)}, outward = {std::sin(slope), 0, std::cos(slope)};
    std::vector<Vec3> nodes;
    for (int i = 0; i <= 30; ++i) nodes.push_back(1e-3 * i * down + 1.499e-4 * outward);
    const RodModel model = MakeRodModel({nodes, MakeThread()}).value();
    RodState state = MakeRodState(model, nodes);
    RodSolver solver(model);
    std::vector<RodContact> contacts;
    const RodObstacle plane{
        .a = {}, .b = {}, .outward = outward, .radius = 0, .friction = friction, .motion = {}};
    for (int tick = 0; tick < 100; ++tick) {
      FollowContacts(model, state, std::span(&plane, 1), {}, contacts);
      (void)solver.Solve(
          {}, {.gravity = {0, 0, -9.81}, .force = {}, .drag = 1e-3, .contacts = contacts, .contact = {}},
          state);
    }
    return math::Dot(state.position[15] - nodes[15], down);
  };
  EXPECT_LT(slide(0.33), 2e-5);
  EXPECT_GT(slide(0.27), 10 * slide(0.33));
}

TEST(RodContact, AShaftThatMovesDragsTheThreadAlong) {
  const std::vector<Vec3> nodes = MakeHanging(0.01015, 1e-3, 12);
  const RodModel model = MakeRodModel({nodes, MakeThread()}).value();
  RodState state = MakeRodState(model, nodes);
  RodSolver solver(model);
  std::vector<RodContact> contacts;
  std::vector<Vec3> forces(nodes.size());
  forces.front() = forces.back() = {0, 0, -0.2};
  RodObstacle shaft{
      .a = {0, -0.05, 0}, .b = {0, 0.05, 0}, .outward = {}, .radius = 0.01, .friction = 0.5, .motion = {}};
  for (int tick = 0; tick < 100; ++tick) {
    shaft.motion = {0, tick < 20 ? 0.0 : 1e-4,
                    0};  // along its own axis: it slides under the thread but for friction
    shaft.a += shaft.motion, shaft.b += shaft.motion;
    FollowContacts(model, state, std::span(&shaft, 1), {}, contacts);
    (void)solver.Solve({.max_steps = 20},
                       {.gravity = {}, .force = forces, .drag = 1e-4, .contacts = contacts, .contact = {}},
                       state);
  }
  EXPECT_NEAR(state.position[nodes.size() / 2].y, 8e-3, 2e-4);
}

TEST(RodContact, ContactsAreSortedAndKeepWhatSticks) {
  const std::vector<Vec3> nodes = {{0, 0, 1.4e-4}, {1e-3, 0, 1.4e-4}, {2e-3, 0, 1.4e-4}};
  const RodModel model = MakeRodModel({nodes, MakeThread()}).value();
  RodState state = MakeRodState(model, nodes);
  const RodObstacle obstacles[] = {
      {.a = {}, .b = {}, .outward = {0, 0, 1}, .radius = 0, .friction = 0.3, .motion = {1e-5, 0, 0}},
      {.a = {1e-3, 1e-3, 0},
       .b = {1e-3, 1e-3, 0},
       .outward = {},
       .radius = 8e-4,
       .friction = 0.1,
       .motion = {}}};
  std::vector<RodContact> contacts;
  FollowContacts(model, state, obstacles, {}, contacts);
  ASSERT_EQ(contacts.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(contacts[i].segment * 2 + contacts[i].obstacle, i);
  contacts[2].pressure = 0.5, contacts[2].anchor.x -= 3e-5;
  const Vec3 anchor = contacts[2].anchor;
  FollowContacts(model, state, obstacles, {}, contacts);
  EXPECT_EQ(contacts[2].pressure, 0.5);
  EXPECT_NEAR(contacts[2].anchor.x, anchor.x + 1e-5, 1e-15) << "it goes with the floor";
  EXPECT_EQ(contacts[0].pressure, 0.0);
}

}  // namespace
}  // namespace trocar::rod
