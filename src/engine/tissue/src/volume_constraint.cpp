// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/volume_constraint.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/assert.h"

namespace trocar::tissue {

using math::Vec3;

double CalcVolumeGradient(std::span<const Vec3> position, std::span<const geometry::Triangle> triangles,
                          std::span<Vec3> gradient) noexcept {
  TROCAR_ASSERT(gradient.size() == position.size());
  std::fill(gradient.begin(), gradient.end(), Vec3{});
  if (position.empty()) return 0.0;
  const Vec3 origin = position.front();
  double six_volumes = 0;
  for (const geometry::Triangle& t : triangles) {
    const Vec3 a = position[t[0]] - origin, ab = position[t[1]] - position[t[0]],
               ac = position[t[2]] - position[t[0]];
    const Vec3 normal = math::Cross(ab, ac);
    six_volumes += math::Dot(a, normal);
    // on a closed surface the triangle's share of the three gradients may be dealt out evenly
    const Vec3 share = normal / 6.0;
    for (const auto node : t) gradient[node] += share;
  }
  return six_volumes / 6.0;
}

double CalcClosedVolume(std::span<const Vec3> position,
                        std::span<const geometry::Triangle> triangles) noexcept {
  if (position.empty()) return 0.0;
  const Vec3 origin = position.front();
  double six_volumes = 0;
  for (const geometry::Triangle& t : triangles) {
    six_volumes += math::Dot(position[t[0]] - origin,
                             math::Cross(position[t[1]] - position[t[0]], position[t[2]] - position[t[0]]));
  }
  return six_volumes / 6.0;
}

double CalcOutflow(double pressure, double compliance, double area, double density, double dt) noexcept {
  if (!(pressure > 0.0 && compliance > 0.0 && area > 0.0 && density > 0.0 && dt > 0.0)) return 0.0;
  // dV^2 = a^2 (P - dV / c)  with  a = C_d A dt sqrt(2 / rho); the stable form of the positive root
  const double reached = kDischargeCoefficient * area * dt;
  const double a2 = reached * reached * 2.0 / density;
  const double b = a2 / compliance;
  const double outflow = 2.0 * a2 * pressure / (b + std::sqrt(b * b + 4.0 * a2 * pressure));
  return std::min(outflow, compliance * pressure);
}

}  // namespace trocar::tissue
