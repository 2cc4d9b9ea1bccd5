// SPDX-License-Identifier: Apache-2.0
/// \file capsule_on_box.h  Contacts of a capsule over a face of a box in closed form: a ring on a board is sixteen of them, and
/// Bullet's iterative search for nearest points takes longer than all the rest of a step.
#pragma once

#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <btBulletDynamicsCommon.h>

namespace trocar::rigid {

/// Beside edges and corners, and where its axis is inside of the box, the capsule is left to Bullet's search.
class CapsuleOnBox final : public btConvexConvexAlgorithm {
 public:
  /// For pairs of a capsule and a box, in either order.
  class CreateFunc final : public btCollisionAlgorithmCreateFunc {
   public:
    btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                   const btCollisionObjectWrapper* a,
                                                   const btCollisionObjectWrapper* b) override;

   private:
    btGjkEpaPenetrationDepthSolver depth_solver_;
  };

  /// \param manifold  of both bodies
  /// \param is_own  the manifold is released with this
  CapsuleOnBox(btPersistentManifold* manifold, bool is_own, const btCollisionAlgorithmConstructionInfo& info,
               const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
               btConvexPenetrationDepthSolver* depth_solver);
  ~CapsuleOnBox() override;

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                        const btDispatcherInfo& info, btManifoldResult* result) override;
  void getAllContactManifolds(btManifoldArray& manifolds) override;

 private:
  btPersistentManifold* manifold_;
  bool is_own_;
};

}  // namespace trocar::rigid
