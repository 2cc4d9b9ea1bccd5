// SPDX-License-Identifier: Apache-2.0
/// \file volume_constraint.h  The volume of a closed organ as one scalar constraint, its pressure, and what
/// leaves through a hole.
///
/// Pure functions over plain values; tissue/conservation.h puts them into a tick.
/// Source: Hong, Jung, Choi, Welch, "Fast volume preservation for a mass-spring system", IEEE CG&A 26(5),
/// 2006: one constraint V(x) = V_0 with the divergence theorem's volume and gradient. The paper steps in
/// time; here the multiplier is found in equilibrium, where it is the pressure.
#pragma once

#include <cstdint>
#include <span>

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::tissue {

/// Volume and its gradient with respect to each node, g_a = dV/dx_a = 1/6 sum over triangles (a, b, c) of
/// (x_b - x_a) x (x_c - x_a). Pressure P pushes node a with P g_a.
///
/// \param position   (nv) of the organ's own nodes [m]
/// \param[out] gradient  (nv) [m^2]
/// \return volume [m^3], positive when the triangles face outwards
/// \pre the triangles form a closed surface
/// \note Real-time safe.
double CalcVolumeGradient(std::span<const math::Vec3> position, std::span<const geometry::Triangle> triangles,
                          std::span<math::Vec3> gradient) noexcept;

/// Volume alone, about the first node, so that organs far from the origin lose no digits [m^3].
/// \note Real-time safe.
double CalcClosedVolume(std::span<const math::Vec3> position,
                        std::span<const geometry::Triangle> triangles) noexcept;

/// Fluid that leaves a closed sac through an opening within one tick.
///
/// Flow through an orifice, Q = C_d A sqrt(2 P / rho), taken at the pressure at the end of the tick,
/// P' = P - dV / c: it cannot empty the sac below zero pressure, however long the tick or large the hole.
///
/// \param pressure    P above the surroundings [Pa]; nothing leaves unless > 0
/// \param compliance  c = dV/dP [m^3/Pa], > 0
/// \param area        of the opening [m^2], >= 0
/// \param density     rho of the fluid [kg/m^3], > 0
/// \param dt          [s], >= 0
/// \return dV [m^3], in [0, c P]
/// \note Real-time safe.
/// Source: Torricelli's law with a discharge coefficient for a sharp-edged hole (Batchelor, "An Introduction
/// to Fluid Dynamics", 1967, section 6.3).
double CalcOutflow(double pressure, double compliance, double area, double density, double dt) noexcept;

/// C_d of a thin sharp-edged hole [-].
inline constexpr double kDischargeCoefficient = 0.61;
/// Bile [kg/m^3].
inline constexpr double kBileDensity = 1010.0;

}  // namespace trocar::tissue
