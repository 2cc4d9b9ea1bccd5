// SPDX-License-Identifier: Apache-2.0
/// \file material.h  Spring constants from tissue constants, not by taste.
#pragma once

#include <span>
#include <vector>

#include "trocar/geometry/mesh_topology.h"
#include "trocar/geometry/triangle_mesh.h"

namespace trocar::tissue {

using math::Vec3;

/// Stiffness of each edge so that the net acts as a membrane of modulus E t (Poisson's ratio 1/3):
/// k_c = E t sum_T area(T) / |c|^2 over the triangles T at edge c.
///
/// \param positions         (nv) rest shape [m]
/// \param edges             (ne) from geometry::FindEdges(triangles)
/// \param membrane_modulus  E t, Young's modulus times wall thickness [N/m], >= 0
/// \return (ne) [N/m]
/// Source: van Gelder, "Approximate simulation of elastic membranes by triangulated spring meshes", JGT 3(2),
/// 1998.
std::vector<double> CalcEdgeStiffness(std::span<const Vec3> positions,
                                      std::span<const geometry::Triangle> triangles,
                                      std::span<const geometry::Edge> edges, double membrane_modulus);

/// Stiffness of each node's virtual spring as a Winkler foundation: k_i = (E / h) A_i.
///
/// \param vertex_areas  (nv) area that belongs to each node [m^2]
/// \param modulus       E of what lies behind the surface [Pa], >= 0
/// \param depth         h of that layer [m], > 0
/// \return (nv) [N/m]
std::vector<double> CalcFoundationStiffness(std::span<const double> vertex_areas, double modulus,
                                            double depth);

/// Axial stiffness of a piece of tube wall, k = E 2 pi r t / l [N/m].
double CalcTubeStiffness(double young_modulus, double radius, double wall_thickness, double length);

}  // namespace trocar::tissue
