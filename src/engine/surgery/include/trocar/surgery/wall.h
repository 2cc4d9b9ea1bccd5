// SPDX-License-Identifier: Apache-2.0
/// \file wall.h  The springs, masses and foundation of an organ's wall as functions of its mesh, so that a mesh that
/// was cut has the same membrane as before.
#pragma once

#include <cstdint>
#include <vector>

#include "trocar/geometry/editable_mesh.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::surgery {

/// Material of a wall, by area.
struct WallMaterial {
  double membrane_modulus = 0;  ///< E t, Young's modulus times thickness [N/m]
  double bending_share = 0;     ///< of it that bending springs carry, see tissue::CalcBendingShare [-]
  double foundation = 0;    ///< stiffness of the virtual springs by area, E / h of what lies behind [N/m^3]
  double mass_by_area = 0;  ///< [kg/m^2]
  std::uint32_t law = 0;    ///< of the wall's springs, index in TissueDefinition::laws
  double prestrain = 0;     ///< of the mesh as given, beyond the wall without tension, >= 0 [-]
};

/// Modulus of a trench's walls, as a share of the surface's: cut parenchyma has no capsule [-], a tunable.
inline constexpr double kTrenchShare = 0.1;

/// Edges by van Gelder's formula and bending springs across them, one spring for each pair of vertices.
///
/// \param mesh   rest shape, every triangle of the surface
/// \return springs between vertices: bending springs in ascending order, then edges
/// Source: tissue/material.h.
std::vector<tissue::Spring> CalcWallSprings(const geometry::TriangleMesh& mesh, const WallMaterial& material);

/// The spring between two vertices of a mesh that is being cut: CalcWallSprings for this one pair. Walls of trenches
/// have edges of kTrenchShare and no bending springs, which would hold the trench shut.
///
/// \return stiffness 0 where the pair has none
/// \note Real-time safe.
tissue::Spring CalcWallSpring(const geometry::EditableMesh& mesh, std::uint32_t a, std::uint32_t b,
                              const WallMaterial& material) noexcept;

/// Mass and foundation of one vertex.
struct WallNode {
  double mass = 0;             ///< [kg]; walls of trenches weigh nothing, so that a cut makes no mass
  double shape_stiffness = 0;  ///< [N/m]; walls hold the bottom of a trench, not its rim
};
/// \note Real-time safe.
WallNode CalcWallNode(const geometry::EditableMesh& mesh, std::uint32_t v,
                      const WallMaterial& material) noexcept;

}  // namespace trocar::surgery
