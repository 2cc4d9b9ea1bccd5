// SPDX-License-Identifier: Apache-2.0
#include "split_quality.h"

#include <algorithm>

#include "trocar/geometry/mesh_measures.h"

namespace trocar::geometry {

using math::Vec3;

bool MaySplit(const EditableMesh& mesh, std::uint32_t h, double t, double min_angle) {
  const auto halves = [&](std::span<const Vec3> x, std::uint32_t side) {
    const Vec3 &a = x[mesh.From(side)], &b = x[mesh.To(side)], &c = x[mesh.Opposite(side)];
    const Vec3 p = math::Lerp(a, b, side == h ? t : 1.0 - t);
    return std::min(CalcSmallestAngle(a, p, c), CalcSmallestAngle(p, b, c));
  };
  const auto whole = [&](std::span<const Vec3> x, std::uint32_t side) {
    return CalcSmallestAngle(x[mesh.From(side)], x[mesh.To(side)], x[mesh.Opposite(side)]);
  };
  const std::uint32_t sides[2] = {h, mesh.Twin(h)};
  for (const auto side : sides) {
    if (side == kNone) continue;
    if (!(halves(mesh.Rest(), side) >= min_angle)) return false;
    if (!(halves(mesh.Positions(), side) >= min_angle) && whole(mesh.Positions(), side) >= min_angle)
      return false;
  }
  return sides[1] == kNone || mesh.Opposite(sides[0]) != mesh.Opposite(sides[1]);
}

bool MayInsert(const EditableMesh& mesh, std::uint32_t t, const std::array<double, 3>& weights,
               double min_angle) {
  const Triangle& corners = mesh.Triangles()[t];
  const auto thirds = [&](std::span<const Vec3> x) {
    const Vec3 &a = x[corners[0]], &b = x[corners[1]], &c = x[corners[2]];
    const Vec3 p = weights[0] * a + weights[1] * b + weights[2] * c;
    return std::min({CalcSmallestAngle(a, b, p), CalcSmallestAngle(b, c, p), CalcSmallestAngle(c, a, p)});
  };
  return weights[0] > 0.0 && weights[1] > 0.0 && weights[2] > 0.0 && thirds(mesh.Rest()) >= min_angle &&
         thirds(mesh.Positions()) >= min_angle;
}

std::array<double, 3> CalcWeights(const EditableMesh& mesh, std::uint32_t t, const Vec3& p) {
  const Triangle& corners = mesh.Triangles()[t];
  const auto x = mesh.Positions();
  const Vec3 normal = CalcAreaNormal(x, corners);
  const double twice_area = math::SquaredNorm(normal);
  const auto weight = [&](int i) {
    const Vec3 &a = x[corners[(i + 1) % 3]], &b = x[corners[(i + 2) % 3]];
    return math::Dot(math::Cross(b - a, p - a), normal) / twice_area;
  };
  const double first = weight(0), second = weight(1);
  return {first, second, 1.0 - first - second};
}

}  // namespace trocar::geometry
