// SPDX-License-Identifier: Apache-2.0
/// \file trainer_box.h  The box that training tasks stand in, and how open what stands still in it lies to its light.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"
#include "trocar/rigid/rigid_world.h"
#include "trocar/scene/scene.h"

namespace trocar::view {

/// Things stand in a box, not in an abdomen.
bool HasTrainerBox(const scene::Scene& scene);

/// Where faces are divided along x, y, z [m], in any order; what lies outside the box, or close to another, is left out.
using Divisions = std::array<std::vector<double>, 3>;
enum class DividedFaces { kAll, kTop };  ///< the top is the face with the largest z

/// A box whose faces have vertices of their own, so that its edges are sharp. Shade is reckoned at vertices, and a triangle
/// costs as much as the pixels that it covers: faces are divided where light changes, and nowhere else.
geometry::TriangleMesh MakeFacedBox(const math::Vec3& min, const math::Vec3& max,
                                    const Divisions& divisions = {}, DividedFaces faces = DividedFaces::kAll);

/// Whether a shape is a board that a task stands on: it lies flat, and is larger than what hands move.
bool IsBoard(const rigid::RigidShape& shape);

/// A board whose top is divided round the feet of what stands on it.
/// \param still  what stands still, world frame
geometry::TriangleMesh MakeBoard(const math::Vec3& half, const math::Pose& X_world_board,
                                 std::span<const geometry::TriangleMesh> still);

/// The inside of a box trainer: floor and walls round the objects, seen from within.
geometry::TriangleMesh MakeTrainerBox(const scene::Scene& scene);

/// How open vertices lie: it is darker in corners and at the foot of what stands on a board.
/// \param still  everything that stands still, world frame
/// \return of each vertex of each, 1 where nothing is near, towards 0 where everything is [-]
std::vector<std::vector<double>> CalcTrainerOpenness(std::span<const geometry::TriangleMesh> still);

}  // namespace trocar::view
