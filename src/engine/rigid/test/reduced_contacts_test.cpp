// SPDX-License-Identifier: Apache-2.0
#include "reduced_contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "rigid_shapes.h"
#include "trocar/rigid/rigid_world.h"

namespace trocar::rigid {

using math::Vec3;

namespace {

/// A world of Bullet's with bodies that are not moved.
class ReducedContactsTest : public testing::Test {
 protected:
  void Add(const RigidBody& definition) {
    std::vector<std::unique_ptr<btCollisionShape>> shapes;
    MakeShapes(definition, shapes);
    const btRigidBody::btRigidBodyConstructionInfo info(definition.mass, nullptr, shapes.back().get(),
                                                        {1, 1, 1});
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    bodies_.back()->setWorldTransform(ToBullet(definition.X_world_body));
    world_.addRigidBody(bodies_.back().get());
    std::ranges::move(shapes, std::back_inserter(shapes_));
  }
  std::vector<btManifoldPoint> Points() const {
    std::vector<btManifoldPoint> points;
    for (int m = 0; m < dispatcher_.getNumManifolds(); ++m) {
      const btPersistentManifold& manifold = *dispatcher_.getInternalManifoldPointer()[m];
      for (int p = 0; p < manifold.getNumContacts(); ++p) points.push_back(manifold.getContactPoint(p));
    }
    return points;
  }
  void TearDown() override {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }

  btDefaultCollisionConfiguration configuration_;
  mutable btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  ReducedContactWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

constexpr double kRing = 0.009, kThickness = 0.002;  // radii of its circle and of its section [m]
RigidBody MakeRing(const Vec3& centre) {
  return {{{RigidShape::Kind::kRing, {kRing, kThickness, 0}, {}}}, {{}, centre}, 0.002, 0.8};
}
RigidBody MakeBox(const Vec3& half, const Vec3& centre, double mass = 0) {
  return {{{RigidShape::Kind::kBox, half, {}}}, {{}, centre}, mass, 0.8};
}

double Least(const std::vector<btManifoldPoint>& points, const auto& measure) {
  double least = 1e9;
  for (const btManifoldPoint& point : points) least = std::min<double>(least, measure(point));
  return least;
}

TEST_F(ReducedContactsTest, OfARingThatLiesOnABoardTheOutermostAreKept) {
  Add(MakeBox({0.1, 0.1, 0.01}, {0, 0, -0.01}));
  // a little askew: one side lies deeper
  RigidBody ring = MakeRing({0, 0, kThickness});
  ring.X_world_body.rotation = math::RotationAbout({1, 0, 0}, 0.001);
  Add(ring);
  world_.FindAllContacts();
  const std::vector<btManifoldPoint> all = Points();
  ASSERT_GE(all.size(), 12u);
  world_.performDiscreteCollisionDetection();
  const std::vector<btManifoldPoint> kept = Points();
  EXPECT_GE(kept.size(), 3u);
  EXPECT_LE(kept.size(), 5u);
  const auto depth = [](const btManifoldPoint& p) { return p.getDistance(); };
  EXPECT_EQ(Least(kept, depth), Least(all, depth));
  for (int axis = 0; axis < 2; ++axis) {
    for (const double way : {1.0, -1.0}) {
      const auto reach = [&](const btManifoldPoint& p) { return way * p.getPositionWorldOnB()[axis]; };
      EXPECT_NEAR(Least(kept, reach), Least(all, reach), 1e-9) << axis << " " << way;
    }
  }
}

TEST_F(ReducedContactsTest, OfEachNormalSomeAreKept) {
  // floor and two walls are one body, as a board and its pegs are
  RigidBody corner = MakeBox({0.1, 0.1, 0.01}, {});
  for (const Vec3& wall : {Vec3{-0.0188, 0, 0.02}, Vec3{0, -0.0188, 0.02}})
    corner.shapes.push_back({RigidShape::Kind::kBox, {0.008, 0.008, 0.01}, {{}, wall}});
  corner.X_world_body.translation = {0, 0, -0.01};
  Add(corner);
  Add(MakeRing({0, 0, kThickness}));
  world_.performDiscreteCollisionDetection();
  Vec3 seen;
  for (const btManifoldPoint& point : Points()) {
    for (int axis = 0; axis < 3; ++axis)
      seen[axis] = std::max<double>(seen[axis], std::abs(point.m_normalWorldOnB[axis]));
  }
  for (int axis = 0; axis < 3; ++axis) EXPECT_GT(seen[axis], 0.99) << axis;
}

TEST_F(ReducedContactsTest, WhereBodiesTouchInAFewPointsAllAreKept) {
  Add(MakeBox({0.1, 0.1, 0.01}, {0, 0, -0.01}));
  Add(MakeBox({0.006, 0.006, 0.006}, {0, 0, 0.006}, 0.003));
  Add(MakeBox({0.006, 0.006, 0.006}, {0.03, 0, 0.006}, 0.003));
  world_.FindAllContacts();
  const std::size_t all = Points().size();
  EXPECT_EQ(all, 8u);
  world_.performDiscreteCollisionDetection();
  EXPECT_EQ(Points().size(), all);
}

/// Where it would tip, were too few points left or the wrong ones.
TEST(ReducedContactsInAWorld, ARingStandsUntilItsMiddleIsBeyondTheEdge) {
  for (const bool is_beyond : {false, true}) {
    RigidWorld world({0, 0, -9.81}, 1.0 / 120);
    ASSERT_TRUE(world.AddBody(MakeBox({0.05, 0.05, 0.01}, {-0.05, 0, -0.01})).ok());
    const auto ring = *world.AddBody(MakeRing({is_beyond ? 0.001 : -0.001, 0, kThickness}));
    for (int tick = 0; tick < 2 * 120; ++tick) world.Step();
    EXPECT_EQ(world.PoseOf(ring).translation.z < -0.01, is_beyond);
  }
}

}  // namespace
}  // namespace trocar::rigid
