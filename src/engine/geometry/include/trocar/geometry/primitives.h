// SPDX-License-Identifier: Apache-2.0
/// \file primitives.h  Simple meshes for tests, samples and instruments.
#pragma once

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::geometry {

/// Sphere of radius [m] about `centre`: an icosahedron divided `subdivisions` times, 20 * 4^s triangles.
TriangleMesh MakeSphere(const math::Vec3& centre, double radius, int subdivisions);

/// Flat n x n grid in the plane z = 0 from the origin, one diagonal a cell, as the paper's Table 1 meshes:
/// n * n vertices, 2 (n - 1)^2 triangles, spacing [m].
TriangleMesh MakeGrid(int n, double spacing);

/// Flat patch of equilateral triangles with side `spacing` [m]: `columns` x `rows` vertices, in the plane z =
/// 0.
TriangleMesh MakeTriangularLattice(int columns, int rows, double spacing);

/// Closed box between two corners, 12 triangles.
TriangleMesh MakeBox(const math::Vec3& min, const math::Vec3& max);

}  // namespace trocar::geometry
