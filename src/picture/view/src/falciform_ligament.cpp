// SPDX-License-Identifier: Apache-2.0
#include "falciform_ligament.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "trocar/math/noise.h"

namespace trocar::view {
namespace {

using geometry::TriangleMesh;
using math::Vec3;

constexpr int kColumns = 26, kRows = 9;              // along the liver; from it to the wall
constexpr int kFreeColumns = 6;                      // before the liver's edge
constexpr double kFreeLength = 0.018;                // m that the free edge reaches towards the feet
constexpr double kHalfThick = 0.0007;                // m
constexpr double kCord = 0.0026;                     // m, half of the round ligament's thickness
constexpr double kInto = 0.0015;                     // m that it runs into liver and wall
constexpr double kFold = 0.0030, kFoldWave = 0.014;  // m

/// The wall over a place: its highest point above that [m]; NaN where there is none.
double FindWall(const TriangleMesh& wall, double x, double y) {
  double highest = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [ia, ib, ic] : wall.triangles) {
    const Vec3 &a = wall.positions[ia], &b = wall.positions[ib], &c = wall.positions[ic];
    const double area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    if (std::abs(area) < 1e-12) continue;
    const double s = ((x - a.x) * (c.y - a.y) - (c.x - a.x) * (y - a.y)) / area;
    const double t = ((b.x - a.x) * (y - a.y) - (x - a.x) * (b.y - a.y)) / area;
    if (s < 0.0 || t < 0.0 || s + t > 1.0) continue;
    const double z = a.z + s * (b.z - a.z) + t * (c.z - a.z);
    if (!(highest >= z)) highest = z;
  }
  return highest;
}

/// The attachment as a line from the feet to the head: means of bands across it.
std::vector<Vec3> FindLine(std::span<const Vec3> attachment) {
  const auto [low, high] = std::minmax_element(attachment.begin(), attachment.end(),
                                               [](const Vec3& a, const Vec3& b) { return a.y < b.y; });
  const double from = low->y, span = high->y - low->y;
  std::vector<Vec3> line;
  if (!(span > 0.0)) return line;
  constexpr int kBands = 8;
  for (int band = 0; band < kBands; ++band) {
    Vec3 sum;
    int count = 0;
    for (const Vec3& p : attachment) {
      if (std::min(kBands - 1, static_cast<int>(kBands * (p.y - from) / span)) != band) continue;
      sum += p;
      ++count;
    }
    if (count > 0) line.push_back(sum / count);
  }
  return line;
}

}  // namespace

TriangleMesh MakeFalciformLigament(std::span<const Vec3> attachment, const TriangleMesh& wall) {
  TriangleMesh sheet;
  if (attachment.size() < 3) return sheet;
  const std::vector<Vec3> line = FindLine(attachment);
  if (line.size() < 2) return sheet;
  struct Column {
    Vec3 low, high;
    double half;  // of its thickness at the lower edge [m]
  };
  std::vector<Column> columns;
  for (int i = -kFreeColumns; i < kColumns; ++i) {
    // before the liver's edge the free edge rises to the wall
    const double before = std::max(0.0, -static_cast<double>(i) / kFreeColumns);
    const double at =
        std::max(0.0, static_cast<double>(i) / (kColumns - 1)) * static_cast<double>(line.size() - 1);
    const auto k = std::min(static_cast<std::size_t>(at), line.size() - 2);
    Vec3 low = math::Lerp(line[k], line[k + 1], at - static_cast<double>(k));
    low.y -= kFreeLength * before;
    const double top = FindWall(wall, low.x, low.y);
    if (!std::isfinite(top) || top < low.z) continue;
    low.z += (top - low.z) * before * before - (before > 0.0 ? 0.0 : kInto);
    columns.push_back({low, {low.x, low.y, top + kInto}, before > 0.0 ? kCord : kHalfThick});
  }
  if (columns.size() < 2) return sheet;
  // front and back of the same lattice, joined all round
  for (const double side : {-1.0, 1.0}) {
    for (const Column& column : columns) {
      for (int row = 0; row < kRows; ++row) {
        const double share = static_cast<double>(row) / (kRows - 1);
        Vec3 p = math::Lerp(column.low, column.high, share);
        p.x += kFold * std::sin(M_PI * share) * math::CalcGradientNoise(p / kFoldWave, 0);
        const double half = kHalfThick + (column.half - kHalfThick) * std::max(0.0, 1.0 - 4.0 * share);
        p.x += side * half;
        sheet.positions.push_back(p);
      }
    }
  }
  const auto count = static_cast<std::uint32_t>(columns.size()), rows = static_cast<std::uint32_t>(kRows);
  const auto place = [&](std::uint32_t side, std::uint32_t column, std::uint32_t row) {
    return (side * count + column) * rows + row;
  };
  const auto quad = [&sheet](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    sheet.triangles.push_back({a, b, c});
    sheet.triangles.push_back({a, c, d});
  };
  for (std::uint32_t i = 0; i + 1 < count; ++i) {
    for (std::uint32_t row = 0; row + 1 < rows; ++row) {
      quad(place(0, i, row), place(0, i, row + 1), place(0, i + 1, row + 1), place(0, i + 1, row));
      quad(place(1, i, row), place(1, i + 1, row), place(1, i + 1, row + 1), place(1, i, row + 1));
    }
    quad(place(0, i, 0), place(0, i + 1, 0), place(1, i + 1, 0), place(1, i, 0));
    quad(place(0, i, rows - 1), place(1, i, rows - 1), place(1, i + 1, rows - 1), place(0, i + 1, rows - 1));
  }
  for (std::uint32_t row = 0; row + 1 < rows; ++row) {
    quad(place(0, 0, row), place(1, 0, row), place(1, 0, row + 1), place(0, 0, row + 1));
    quad(place(0, count - 1, row), place(0, count - 1, row + 1), place(1, count - 1, row + 1),
         place(1, count - 1, row));
  }
  return sheet;
}

}  // namespace trocar::view
