// SPDX-License-Identifier: Apache-2.0
/// \file surface_contact.h  Two-sided contact: a node of one moving part against a triangle of another.
///
/// E = k/2 max(0, gap - d)^2, where d = n . (x_p - x_a) is the distance of the node from the triangle's plane and n the normal of
/// the triangle as it lies. The gradient of d is n at the node and -lambda_i n at the corners, lambda the barycentric coordinates
/// of the node's foot in the plane: what pushes the node pushes the triangle back, forces and torques sum to zero.
#pragma once

#include "trocar/geometry/triangle_mesh.h"
#include "trocar/tissue/element.h"

namespace trocar::tissue {

struct SurfaceContact {
  static constexpr std::string_view kName = "surface_contacts";
  static constexpr std::size_t kNodes = 4, kCapacity = 512;
  static constexpr ElementInvariance kInvariance = ElementInvariance::kMotions;
  /// A triangle that is cut through holds nothing off.
  static constexpr std::array<ElementBond, 3> kBonds = {{{1, 2}, {2, 3}, {3, 1}}};

  /// The node, then the corners, counterclockwise as seen from the side on which the node is to stay.
  std::array<std::uint32_t, kNodes> nodes{};
  double stiffness = 0;  ///< k [N/m], >= 0
  double gap = 0;        ///< distance at which the parts begin to press [m], >= 0
};

/// The node over its triangle.
struct ContactPlane {
  math::Vec3 normal;              ///< n, unit; zero where the triangle has no area
  double distance = 0;            ///< d, negative where the node is through [m]
  std::array<double, 3> weights;  ///< lambda, sum 1 [-]; within [0, 1] where the foot lies in the triangle
};
/// \note Real-time safe.
ContactPlane CalcContactPlane(const SurfaceContact& element, const ElementVectors<4>& position) noexcept;

double CalcElementEnergy(const SurfaceContact& element, const ElementVectors<4>& position) noexcept;
ElementVectors<4> CalcElementForce(const SurfaceContact& element, const ElementVectors<4>& position) noexcept;
void AddElementStiffness(const SurfaceContact& element, const ElementVectors<4>& position, StiffnessPart part,
                         ElementStiffness<4>& stiffness) noexcept;
bool IsElementUsable(const SurfaceContact& element) noexcept;
void VisitState(base::StateArchive& archive, SurfaceContact& element);

}  // namespace trocar::tissue
