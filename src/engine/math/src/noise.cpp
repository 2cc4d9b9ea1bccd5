// SPDX-License-Identifier: Apache-2.0
#include "trocar/math/noise.h"

#include <cmath>
#include <cstdint>
#include <utility>

#include "trocar/base/to_integer.h"

namespace trocar::math {
namespace {

std::uint32_t HashCell(int x, int y, int z) noexcept {
  auto h = static_cast<std::uint32_t>(x) * 0x8da6b343u ^ static_cast<std::uint32_t>(y) * 0xd8163841u ^
           static_cast<std::uint32_t>(z) * 0xcb1ab31fu;
  h = (h ^ (h >> 16)) * 0x7feb352du;
  h = (h ^ (h >> 15)) * 0x846ca68bu;
  return h ^ (h >> 16);
}

int Wrap(int i, int period) noexcept {
  return period == 0 ? i : ((i % period) + period) % period;
}

double CalcCornerSlope(std::uint32_t hash, double x, double y, double z) noexcept {
  // the twelve edges of a cube, four of them twice
  switch (hash & 15u) {
    case 0:
    case 12:
      return x + y;
    case 1:
    case 13:
      return -x + y;
    case 2:
      return x - y;
    case 3:
      return -x - y;
    case 4:
      return x + z;
    case 5:
      return -x + z;
    case 6:
      return x - z;
    case 7:
      return -x - z;
    case 8:
      return y + z;
    case 9:
    case 14:
      return -y + z;
    case 10:
      return y - z;
    default:
      return -y - z;
  }
}

double Fade(double t) noexcept {
  return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}
double Mix(double a, double b, double t) noexcept {
  return a + t * (b - a);
}

}  // namespace

double CalcGradientNoise(const Vec3& p, int period) noexcept {
  const double fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
  const int x0 = Wrap(base::TruncateTo<int>(fx), period), x1 = Wrap(base::TruncateTo<int>(fx + 1), period);
  const int y0 = Wrap(base::TruncateTo<int>(fy), period), y1 = Wrap(base::TruncateTo<int>(fy + 1), period);
  const int z0 = Wrap(base::TruncateTo<int>(fz), period), z1 = Wrap(base::TruncateTo<int>(fz + 1), period);
  const double x = p.x - fx, y = p.y - fy, z = p.z - fz;
  const double u = Fade(x), v = Fade(y), w = Fade(z);
  const double a = Mix(Mix(CalcCornerSlope(HashCell(x0, y0, z0), x, y, z),
                           CalcCornerSlope(HashCell(x1, y0, z0), x - 1, y, z), u),
                       Mix(CalcCornerSlope(HashCell(x0, y1, z0), x, y - 1, z),
                           CalcCornerSlope(HashCell(x1, y1, z0), x - 1, y - 1, z), u),
                       v);
  const double b = Mix(Mix(CalcCornerSlope(HashCell(x0, y0, z1), x, y, z - 1),
                           CalcCornerSlope(HashCell(x1, y0, z1), x - 1, y, z - 1), u),
                       Mix(CalcCornerSlope(HashCell(x0, y1, z1), x, y - 1, z - 1),
                           CalcCornerSlope(HashCell(x1, y1, z1), x - 1, y - 1, z - 1), u),
                       v);
  return Mix(a, b, w);
}

CellNoise CalcCellNoise(const Vec3& p, int period) noexcept {
  const double fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
  CellNoise distance{1e9, 1e9};  // squared until the end
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const double cx = fx + dx, cy = fy + dy, cz = fz + dz;
        const std::uint32_t hash =
            HashCell(Wrap(base::TruncateTo<int>(cx), period), Wrap(base::TruncateTo<int>(cy), period),
                     Wrap(base::TruncateTo<int>(cz), period));
        const Vec3 feature{cx + (hash & 1023u) / 1023.0, cy + ((hash >> 10) & 1023u) / 1023.0,
                           cz + ((hash >> 20) & 1023u) / 1023.0};
        const double d = SquaredDistance(feature, p);
        if (d < distance.nearest) {
          distance.second = std::exchange(distance.nearest, d);
        } else if (d < distance.second) {
          distance.second = d;
        }
      }
    }
  }
  return {std::sqrt(distance.nearest), std::sqrt(distance.second)};
}

}  // namespace trocar::math
