// SPDX-License-Identifier: Apache-2.0
/// \file openness.h  How open a surface lies: a stand-in for the soft shade in folds, worked out once.
#pragma once

#include <span>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::render {

/// Share of the sky over each point that nothing nearby covers; what is farther counts less.
///
/// \param occluders  meshes that cover [m]
/// \param positions  (n) [m]
/// \param normals    (n) unit
/// \param reach      what is farther away covers nothing [m], > 0
/// \return  (n) 1 open, 0 covered all round [-]; what lies closer than a quarter of `reach` above the surface
/// is
///          too near to be told from the surface itself
/// Source: obscurance on a voxel grid, after Zhukov, Iones, Kronin, "An ambient light illumination model",
/// 1998.
std::vector<double> CalcOpenness(std::span<const geometry::TriangleMesh* const> occluders,
                                 std::span<const math::Vec3> positions, std::span<const math::Vec3> normals,
                                 double reach);

}  // namespace trocar::render
