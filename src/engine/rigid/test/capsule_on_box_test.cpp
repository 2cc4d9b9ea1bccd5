// SPDX-License-Identifier: Apache-2.0
#include "capsule_on_box.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "bullet_units.h"
#include "trocar/math/random.h"

namespace trocar::rigid {
namespace {

constexpr double kRadius = 0.3, kHalfLength = 0.8;  // of the capsule [cm]
const btVector3 kHalf(2, 1.5, 0.5);                 // of the box [cm]

struct Contact {
  double distance = 0;
  btVector3 out, on_box;  // of the box, in its frame
};

/// What a world of Bullet's finds.
/// \param is_closed  with the closed form
std::vector<Contact> FindContacts(const btTransform& X_world_box, const btTransform& X_box_capsule,
                                  bool is_closed, bool is_capsule_first) {
  CapsuleOnBox::CreateFunc closed_form;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  if (is_closed) {
    dispatcher.registerCollisionCreateFunc(CAPSULE_SHAPE_PROXYTYPE, BOX_SHAPE_PROXYTYPE, &closed_form);
    dispatcher.registerCollisionCreateFunc(BOX_SHAPE_PROXYTYPE, CAPSULE_SHAPE_PROXYTYPE, &closed_form);
  }
  btDbvtBroadphase broadphase;
  btCollisionWorld world(&dispatcher, &broadphase, &configuration);
  btCapsuleShapeZ capsule_shape(kRadius, 2 * kHalfLength);
  btBoxShape box_shape(kHalf);
  box_shape.setMargin(kMargin);
  btCollisionObject capsule, box;
  capsule.setCollisionShape(&capsule_shape);
  capsule.setWorldTransform(X_world_box * X_box_capsule);
  box.setCollisionShape(&box_shape);
  box.setWorldTransform(X_world_box);
  world.addCollisionObject(is_capsule_first ? &capsule : &box);
  world.addCollisionObject(is_capsule_first ? &box : &capsule);
  world.performDiscreteCollisionDetection();
  std::vector<Contact> contacts;
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
    const bool is_box_second = manifold.getBody1() == &box;
    for (int p = 0; p < manifold.getNumContacts(); ++p) {
      const btManifoldPoint& point = manifold.getContactPoint(p);
      const btVector3 out = (is_box_second ? 1.0 : -1.0) * point.m_normalWorldOnB;
      const btVector3& on_box = is_box_second ? point.getPositionWorldOnB() : point.getPositionWorldOnA();
      contacts.push_back(
          {point.getDistance(), X_world_box.getBasis().transpose() * out, X_world_box.inverse() * on_box});
    }
  }
  world.removeCollisionObject(&capsule);
  world.removeCollisionObject(&box);
  return contacts;
}

const Contact& DeepestOf(const std::vector<Contact>& contacts) {
  return *std::ranges::min_element(contacts, {}, &Contact::distance);
}

TEST(CapsuleOnBox, FindsTheDeepestPointThatTheSearchFinds) {
  math::Random random(5);
  int compared = 0, with_two = 0;
  for (int trial = 0; trial < 800; ++trial) {
    const auto draw = [&](double most) { return random.Uniform(-most, most); };
    // one after the other: the order in which arguments are computed is the compiler's
    const double z = draw(5), y = draw(5), x = draw(5);
    const double roll = draw(3), pitch = draw(1.5), yaw = draw(3);
    const btTransform X_world_box(btQuaternion(yaw, pitch, roll), btVector3(x, y, z));
    // near the upper or the lower face, lying or nearly so, also beyond the edges
    const double side = trial % 2 == 0 ? 1 : -1;
    const double height = 0.5 + random.Uniform(0.2, 0.5), across = draw(2), along = draw(2.5);
    const double tilt = draw(0.2), turn = draw(3);
    const btTransform X_box_capsule(
        btQuaternion(btVector3(0, 0, 1), turn) * btQuaternion(btVector3(0, 1, 0), 0.5 * M_PI + tilt),
        btVector3(along, across, side * height));
    for (const bool is_capsule_first : {true, false}) {
      const auto found = FindContacts(X_world_box, X_box_capsule, true, is_capsule_first);
      const auto searched = FindContacts(X_world_box, X_box_capsule, false, is_capsule_first);
      const auto touches = [](const std::vector<Contact>& contacts) {
        return !contacts.empty() && DeepestOf(contacts).distance < 0;
      };
      ASSERT_EQ(touches(found), touches(searched)) << trial;
      if (!touches(found)) continue;
      ++compared;
      with_two += found.size() > 1 ? 1 : 0;
      EXPECT_NEAR(DeepestOf(found).distance, DeepestOf(searched).distance, 1e-3) << trial;
      EXPECT_GT(DeepestOf(found).out.dot(DeepestOf(searched).out), 0.999) << trial;
    }
  }
  EXPECT_GT(compared, 200);
  EXPECT_GT(with_two, 20) << "lying flat, both of its ends touch";
}

TEST(CapsuleOnBox, LyingFlatTouchesWithBothEnds) {
  const btTransform lying(btQuaternion(btVector3(0, 1, 0), 0.5 * M_PI),
                          btVector3(0.2, 0.1, 0.5 + kRadius - 0.004));
  for (const bool is_capsule_first : {true, false}) {
    const auto contacts = FindContacts(btTransform::getIdentity(), lying, true, is_capsule_first);
    ASSERT_EQ(contacts.size(), 2u);
    for (const Contact& contact : contacts) {
      EXPECT_NEAR(contact.distance, -0.004, 1e-12);
      EXPECT_NEAR(contact.out.z(), 1, 1e-12);
      EXPECT_NEAR(std::abs(contact.on_box.x() - 0.2), kHalfLength, 1e-12);
      EXPECT_NEAR(contact.on_box.y(), 0.1, 1e-12);
      EXPECT_NEAR(contact.on_box.z(), 0.5, 1e-12);
    }
  }
}

}  // namespace
}  // namespace trocar::rigid
