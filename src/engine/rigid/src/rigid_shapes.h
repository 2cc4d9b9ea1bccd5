// SPDX-License-Identifier: Apache-2.0
/// \file rigid_shapes.h  Shapes of bodies as Bullet's.
#pragma once

#include <memory>
#include <vector>

#include "bullet_units.h"
#include "trocar/rigid/rigid_world.h"

namespace trocar::rigid {

/// Finite, and larger than nothing.
bool IsPositive(double value);
bool HasSize(const RigidShape& shape);
/// Half of what a shape measures where it is thinnest [m].
double HalfWidth(const RigidShape& shape);

/// \param[out] shapes  parts of the body; the last is the whole, and holds the others
void MakeShapes(const RigidBody& definition, std::vector<std::unique_ptr<btCollisionShape>>& shapes);

}  // namespace trocar::rigid
