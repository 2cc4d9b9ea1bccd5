// SPDX-License-Identifier: Apache-2.0
#include "capsule_on_box.h"

#include <algorithm>
#include <array>
#include <new>
#include <optional>

namespace trocar::rigid {
namespace {

/// A face over which both ends of a capsule's axis lie.
struct Face {
  int axis = 0;
  double side = 1;
};

/// \param ends  of the capsule's axis, in the box's frame
/// \param half  of the box
std::optional<Face> FindFace(const std::array<btVector3, 2>& ends, const btVector3& half) {
  for (int axis = 0; axis < 3; ++axis) {
    const double side = ends[0][axis] < 0 ? -1 : 1;
    const bool is_over = std::ranges::all_of(ends, [&](const btVector3& end) {
      if (side * end[axis] < half[axis]) return false;
      for (int other = 0; other < 3; ++other)
        if (other != axis && std::abs(end[other]) > half[other]) return false;
      return true;
    });
    if (is_over) return Face{axis, side};
  }
  return std::nullopt;
}

}  // namespace

CapsuleOnBox::CapsuleOnBox(btPersistentManifold* manifold, bool is_own,
                           const btCollisionAlgorithmConstructionInfo& info,
                           const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                           btConvexPenetrationDepthSolver* depth_solver)
    : btConvexConvexAlgorithm(manifold, info, a, b, depth_solver, 0, 0),
      manifold_(manifold),
      is_own_(is_own) {}

CapsuleOnBox::~CapsuleOnBox() {
  if (is_own_) m_dispatcher->releaseManifold(manifold_);
}

btCollisionAlgorithm* CapsuleOnBox::CreateFunc::CreateCollisionAlgorithm(
    btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
    const btCollisionObjectWrapper* b) {
  const bool is_own = info.m_manifold == nullptr;
  btPersistentManifold* manifold =
      is_own ? info.m_dispatcher1->getNewManifold(a->getCollisionObject(), b->getCollisionObject())
             : info.m_manifold;
  void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(CapsuleOnBox));
  return new (memory) CapsuleOnBox(manifold, is_own, info, a, b, &depth_solver_);
}

void CapsuleOnBox::processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                                    const btDispatcherInfo& info, btManifoldResult* result) {
  const bool is_capsule_first = a->getCollisionShape()->getShapeType() == CAPSULE_SHAPE_PROXYTYPE;
  const btCollisionObjectWrapper& over = is_capsule_first ? *a : *b;
  const btCollisionObjectWrapper& under = is_capsule_first ? *b : *a;
  const auto& capsule = static_cast<const btCapsuleShape&>(*over.getCollisionShape());
  const btVector3 half =
      static_cast<const btBoxShape*>(under.getCollisionShape())->getHalfExtentsWithMargin();
  const btTransform& X_world_box = under.getWorldTransform();
  const btTransform X_box_capsule = X_world_box.inverseTimes(over.getWorldTransform());
  btVector3 along(0, 0, 0);
  along[capsule.getUpAxis()] = capsule.getHalfHeight();
  const std::array<btVector3, 2> ends = {X_box_capsule * along, X_box_capsule * -along};
  const std::optional<Face> face = FindFace(ends, half);
  result->setPersistentManifold(manifold_);
  if (!face) {
    btConvexConvexAlgorithm::processCollision(a, b, info, result);
  } else {
    btVector3 out(0, 0, 0);
    out[face->axis] = face->side;
    const btVector3 normal = X_world_box.getBasis() * out;
    for (const btVector3& end : ends) {
      const double from_axis = face->side * end[face->axis] - half[face->axis];
      // Bullet's normal is out of the second body, and the point on its surface
      const btVector3 on_box = X_world_box * (end - from_axis * out);
      const btVector3 on_capsule = X_world_box * (end - capsule.getRadius() * out);
      result->addContactPoint(is_capsule_first ? normal : -normal, is_capsule_first ? on_box : on_capsule,
                              from_axis - capsule.getRadius());
    }
  }
  if (is_own_) result->refreshContactPoints();
}

void CapsuleOnBox::getAllContactManifolds(btManifoldArray& manifolds) {
  if (is_own_) manifolds.push_back(manifold_);
}

}  // namespace trocar::rigid
