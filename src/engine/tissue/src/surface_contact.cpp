// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/surface_contact.h"

#include <cmath>

#include "trocar/math/state_fields.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

/// The plane and how the barycentric coordinates change in it: gradients of the corners' hat functions, 1 / their heights [1/m].
struct PlaneGradients {
  ContactPlane plane;
  std::array<Vec3, 3> hat;
};

PlaneGradients CalcPlaneGradients(const ElementVectors<4>& x) noexcept {
  PlaneGradients made;
  const Vec3 across = math::Cross(x[2] - x[1], x[3] - x[1]);
  const double twice_area = math::Norm(across);
  ContactPlane& plane = made.plane;
  plane.weights = {1.0, 0.0, 0.0};
  if (!(twice_area > 0.0)) return made;
  const Vec3 n = across / twice_area;
  plane.normal = n;
  plane.distance = math::Dot(n, x[0] - x[1]);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &next = x[1 + (i + 1) % 3], &last = x[1 + (i + 2) % 3];
    made.hat[i] = math::Cross(n, last - next) / twice_area;
    plane.weights[i] = math::Dot(made.hat[i], x[0] - next);
  }
  return made;
}

double CalcDepth(const SurfaceContact& element, const ContactPlane& plane) noexcept {
  return math::SquaredNorm(plane.normal) > 0.0 ? element.gap - plane.distance : 0.0;
}

/// w of the gradient w_i n of the distance: 1 at the node, -lambda_i at the corners.
std::array<double, 4> CalcGradientWeights(const ContactPlane& plane) noexcept {
  return {1.0, -plane.weights[0], -plane.weights[1], -plane.weights[2]};
}

}  // namespace

ContactPlane CalcContactPlane(const SurfaceContact& /*element*/, const ElementVectors<4>& position) noexcept {
  return CalcPlaneGradients(position).plane;
}

double CalcElementEnergy(const SurfaceContact& element, const ElementVectors<4>& position) noexcept {
  const double depth = math::Max(0.0, CalcDepth(element, CalcContactPlane(element, position)));
  return 0.5 * element.stiffness * depth * depth;
}

ElementVectors<4> CalcElementForce(const SurfaceContact& element,
                                   const ElementVectors<4>& position) noexcept {
  const ContactPlane plane = CalcContactPlane(element, position);
  const double depth = CalcDepth(element, plane);
  ElementVectors<4> force;
  if (!(depth > 0.0)) return force;
  const std::array<double, 4> weights = CalcGradientWeights(plane);
  for (std::size_t i = 0; i < 4; ++i) force[i] = (weights[i] * element.stiffness * depth) * plane.normal;
  return force;
}

/// With u = D x the displacements along the normal, the corners tilt the plane by dn = -sum hat_i u_i and move the foot by
/// v = x_p - sum lambda_i x_i against the triangle. The second derivative of the distance is then dn . v + v . dn - d dn . dn.
void AddElementStiffness(const SurfaceContact& element, const ElementVectors<4>& position, StiffnessPart part,
                         ElementStiffness<4>& stiffness) noexcept {
  const auto [plane, hat] = CalcPlaneGradients(position);
  const double depth = CalcDepth(element, plane);
  const Vec3& n = plane.normal;
  const std::array<double, 4> w = CalcGradientWeights(plane);
  if (part == StiffnessPart::kBound || depth > 0.0) {
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i; j < 4; ++j)
        AddOuterProduct(stiffness.At(i, j), n, n, element.stiffness * w[i] * w[j]);
    }
  }
  if (part != StiffnessPart::kWhole || !(depth > 0.0)) return;
  const double force = element.stiffness * depth;
  const std::array<Vec3, 4> tilt = {Vec3{}, hat[0], hat[1], hat[2]};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i; j < 4; ++j) {
      StiffnessBlock& block = stiffness.At(i, j);
      AddOuterProduct(block, n, tilt[i], force * w[j]);
      AddOuterProduct(block, tilt[j], n, force * w[i]);
      AddOuterProduct(block, n, n, force * plane.distance * math::Dot(tilt[i], tilt[j]));
    }
  }
}

bool IsElementUsable(const SurfaceContact& element) noexcept {
  return std::isfinite(element.stiffness) && element.stiffness >= 0.0 && std::isfinite(element.gap) &&
         element.gap >= 0.0;
}

void VisitState(base::StateArchive& archive, SurfaceContact& element) {
  archive.Field("nodes", element.nodes);
  archive.Field("stiffness", element.stiffness);
  archive.Field("gap", element.gap);
}

}  // namespace trocar::tissue
