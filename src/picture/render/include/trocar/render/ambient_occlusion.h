// SPDX-License-Identifier: Apache-2.0
/// \file ambient_occlusion.h  Ambient occlusion of a surface at rest: the soft shade in folds, computed once.
#pragma once

#include <span>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::render {

/// Ambient occlusion of each point, as maps of it are stored: the share of the sky that nothing nearby covers. What is farther
/// away counts less.
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
std::vector<double> CalcAmbientOcclusion(std::span<const geometry::TriangleMesh* const> occluders,
                                         std::span<const math::Vec3> positions,
                                         std::span<const math::Vec3> normals, double reach);

}  // namespace trocar::render
