// SPDX-License-Identifier: Apache-2.0
/// \file material.h  Spring constants from tissue constants, not by taste.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/geometry/mesh_topology.h"
#include "trocar/geometry/triangle_mesh.h"

namespace trocar::tissue {

/// Stiffness of each edge so that the net acts as a membrane of modulus E t (Poisson's ratio 1/3):
/// k_c = E t sum_T area(T) / |c|^2 over the triangles T at edge c.
///
/// \param positions         (nv) rest shape [m]
/// \param edges             (ne) from geometry::FindEdges(triangles)
/// \param membrane_modulus  E t, Young's modulus times wall thickness [N/m], >= 0
/// \return (ne) [N/m]
/// Source: van Gelder, "Approximate simulation of elastic membranes by triangulated spring meshes", JGT 3(2),
/// 1998.
std::vector<double> CalcEdgeStiffness(std::span<const math::Vec3> positions,
                                      std::span<const geometry::Triangle> triangles,
                                      std::span<const geometry::Edge> edges, double membrane_modulus);

/// A spring across an edge, between the two corners that face it.
struct BendingSpring {
  std::uint32_t a = 0, b = 0;  ///< a < b
  double stiffness = 0;        ///< [N/m]
};

/// Springs that resist folding: one across each inner edge, k = E t (area of its two triangles) / |c|^2 with
/// c from corner to corner. On the equilateral lattice these springs alone form a membrane of modulus E t and
/// Poisson's ratio 1/3, as the edges alone do (van Gelder's formula for both): a share of the one and the
/// rest of the other leave the membrane as it was and add a wall that does not stay folded.
///
/// \param membrane_modulus  E t times the share [N/m], >= 0
/// \return ascending by a, then b; one for each pair of corners
std::vector<BendingSpring> CalcBendingSprings(std::span<const math::Vec3> positions,
                                              std::span<const geometry::Triangle> triangles,
                                              double membrane_modulus);

/// Share of the wall's modulus that its bending springs carry [-].
///
/// Folded by theta, a wall stores 1/2 k_h theta^2 at each edge, k_h = 2 D / sqrt(3), D = E t^3 / (12 (1 -
/// nu^2)); a bending spring of length 2 h stores 1/2 k (h theta^2 / 4)^2. They agree at the angle theta when
/// the share is 16 / (3 (1 - nu^2) theta^2) (t / h)^2; taken at a right angle. Flatter folds are softer than
/// the wall's, so what unfolds here unfolds all the more in the wall.
///
/// \param thickness  t [m]
/// \param height     h, mean height of the mesh's triangles [m], > 0
/// \return 0 to 3/4, where edges and bending springs are equally stiff: a fine mesh of a thick wall would
/// otherwise
///         lose its edges
/// Source: D: Timoshenko, "Theory of Plates and Shells", 1959, eq. 3; k_h of a triangular net: Seung and
/// Nelson, "Defects in flexible membranes with crystalline order", Phys. Rev. A 38, 1988.
double CalcBendingShare(double thickness, double height);

/// Stiffness of each node's virtual spring as a Winkler foundation: k_i = (E / h) A_i.
///
/// \param vertex_areas  (nv) area that belongs to each node [m^2]
/// \param modulus       E of what lies behind the surface [Pa], >= 0
/// \param depth         h of that layer [m], > 0
/// \return (nv) [N/m]
std::vector<double> CalcFoundationStiffness(std::span<const double> vertex_areas, double modulus,
                                            double depth);

/// Stiffness that a flat round punch feels on an elastic half-space, F / depth = 2 a E / (1 - nu^2) [N/m]:
/// what a surface on a foundation is judged against.
/// \param poisson_ratio  [-], in (-1, 1)
///
/// \param radius a [m] Source: Sneddon, "The relation between load and penetration in the axisymmetric
/// Boussinesq problem", 1965.
double CalcPunchStiffness(double young_modulus, double poisson_ratio, double radius);

/// Axial stiffness of a piece of tube wall, k = E 2 pi r t / l [N/m].
double CalcTubeStiffness(double young_modulus, double radius, double wall_thickness, double length);

}  // namespace trocar::tissue
