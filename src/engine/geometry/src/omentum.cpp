// SPDX-License-Identifier: Apache-2.0
#include "trocar/geometry/omentum.h"

#include <algorithm>
#include <cmath>

#include "trocar/geometry/primitives.h"
#include "trocar/math/elementary.h"
#include "trocar/math/noise.h"

namespace trocar::geometry {

TriangleMesh MakeOmentum(std::span<const Ball> above) {
  constexpr double kSpacing = 0.0042;
  constexpr int kColumns = 90, kRows = 83;
  constexpr math::Vec3 kCorner{-0.190, -0.150, 0};
  TriangleMesh bed = geometry::MakeTriangularLattice(kColumns, kRows, kSpacing);
  for (math::Vec3& p : bed.positions) {
    p += kCorner;
    const double slow = math::CalcGradientNoise(18.0 * p, 0);
    const math::CellNoise lobule = math::CalcCellNoise(62.0 * p, 0),
                          small = math::CalcCellNoise(140.0 * p, 0);
    const double bulge =
        0.0065 * (0.8 - lobule.nearest * lobule.nearest) + 0.0022 * (0.8 - small.nearest * small.nearest);
    // the omentum hangs over the middle and falls away to the flanks
    const double side = p.x / 0.19;
    double floor = -0.112 - 0.035 * side * side + 0.012 * slow;
    for (const Ball& o : above) {
      const double aside = math::Hypot(p.x - o.centre.x, p.y - o.centre.y);
      const double limit = o.centre.z - o.radius - 0.004 + 1.1 * std::max(0.0, aside - o.radius);
      floor = std::min(floor, limit);
    }
    p.z = floor + bulge;
  }
  return bed;
}

}  // namespace trocar::geometry
