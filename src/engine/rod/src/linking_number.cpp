// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "trocar/math/elementary.h"
#include "trocar/rod/rod.h"

namespace trocar::rod {

using math::Vec3;

namespace {

/// Solid angle under which two segments see each other, over 4 pi, with its sign; 0 where they lie in a plane.
double CalcShare(const Vec3& a1, const Vec3& a2, const Vec3& b1, const Vec3& b2) noexcept {
  const Vec3 r13 = b1 - a1, r14 = b2 - a1, r23 = b1 - a2, r24 = b2 - a2;
  const Vec3 normals[4] = {math::Cross(r13, r14), math::Cross(r14, r24), math::Cross(r24, r23),
                           math::Cross(r23, r13)};
  Vec3 unit[4];
  for (int i = 0; i < 4; ++i) {
    if (!(math::SquaredNorm(normals[i]) > 0.0)) return 0.0;
    unit[i] = math::Normalized(normals[i]);
  }
  double angle = 0;
  for (int i = 0; i < 4; ++i)
    angle += math::Asin(std::clamp(math::Dot(unit[i], unit[(i + 1) % 4]), -1.0, 1.0));
  const double sense = math::Dot(math::Cross(b2 - b1, a2 - a1), r13);
  return sense == 0.0 ? 0.0 : std::copysign(angle, sense) / (4.0 * M_PI);
}

const Vec3& CornerAfter(std::span<const Vec3> curve, std::size_t corner) noexcept {
  return curve[corner + 1 < curve.size() ? corner + 1 : 0];
}

}  // namespace

double CalcLinkingNumber(std::span<const Vec3> a, std::span<const Vec3> b) noexcept {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j)
      sum += CalcShare(a[i], CornerAfter(a, i), b[j], CornerAfter(b, j));
  }
  return sum;
}

double CalcWrithe(std::span<const Vec3> curve) noexcept {
  double sum = 0;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    for (std::size_t j = i + 2; j < curve.size(); ++j) {
      if (i == 0 && j + 1 == curve.size()) continue;
      sum += 2.0 * CalcShare(curve[i], CornerAfter(curve, i), curve[j], CornerAfter(curve, j));
    }
  }
  return sum;
}

}  // namespace trocar::rod
