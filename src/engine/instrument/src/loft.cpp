// SPDX-License-Identifier: Apache-2.0
#include "loft.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/assert.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/math/elementary.h"

namespace trocar::instrument {

using math::Vec3;

namespace {

using math::Cos;
using math::Pow;
using math::Sin;

constexpr double kMostChamfer = 0.0004;  // m

/// Joins ring after ring; `is_loop` joins the last to the first.
geometry::TriangleMesh JoinRings(const std::vector<Ring>& rings, bool is_loop) {
  TROCAR_ASSERT(rings.size() >= 2 && rings[0].size() >= 3);
  geometry::TriangleMesh mesh;
  const auto around = static_cast<std::uint32_t>(rings[0].size());
  const auto count = static_cast<std::uint32_t>(rings.size());
  for (const Ring& ring : rings) {
    TROCAR_ASSERT(ring.size() == around);
    mesh.positions.insert(mesh.positions.end(), ring.begin(), ring.end());
  }
  for (std::uint32_t ring = 0; ring + (is_loop ? 0 : 1) < count; ++ring) {
    const std::uint32_t low = around * ring, high = around * ((ring + 1) % count);
    for (std::uint32_t i = 0; i < around; ++i) {
      const std::uint32_t next = (i + 1) % around;
      mesh.triangles.push_back({low + i, low + next, high + next});
      mesh.triangles.push_back({low + i, high + next, high + i});
    }
  }
  return mesh;
}

void FaceOutward(geometry::TriangleMesh& mesh) {
  if (geometry::CalcVolume(mesh.positions, mesh.triangles) >= 0.0) return;
  for (geometry::Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

Vec3 CalcMean(const Ring& ring) {
  Vec3 sum;
  for (const Vec3& p : ring) sum += p;
  return sum / static_cast<double>(ring.size());
}

}  // namespace

geometry::TriangleMesh MakeLoft(const std::vector<Ring>& rings) {
  geometry::TriangleMesh mesh = JoinRings(rings, false);
  const auto around = static_cast<std::uint32_t>(rings[0].size());
  const auto first = static_cast<std::uint32_t>(mesh.positions.size()), last = first + 1;
  const std::uint32_t end = first - around;
  mesh.positions.push_back(CalcMean(rings.front()));
  mesh.positions.push_back(CalcMean(rings.back()));
  for (std::uint32_t i = 0; i < around; ++i) {
    const std::uint32_t next = (i + 1) % around;
    mesh.triangles.push_back({first, next, i});
    mesh.triangles.push_back({last, end + i, end + next});
  }
  FaceOutward(mesh);
  return mesh;
}

geometry::TriangleMesh MakeLoop(const std::vector<Ring>& rings) {
  geometry::TriangleMesh mesh = JoinRings(rings, true);
  FaceOutward(mesh);
  return mesh;
}

Ring MakeBlockRing(double z, double x_low, double x_high, double y_low, double y_high) {
  const double c = std::min(kMostChamfer, 0.3 * std::min(x_high - x_low, y_high - y_low));
  return {{x_low + c, y_low, z},   {x_high - c, y_low, z}, {x_high, y_low + c, z}, {x_high, y_high - c, z},
          {x_high - c, y_high, z}, {x_low + c, y_high, z}, {x_low, y_high - c, z}, {x_low, y_low + c, z}};
}

Ring MakeRoundRing(double z, double half_width, double half_height, double squareness, int points) {
  Ring ring;
  // a superellipse: exponent 2 is round
  const double power = 2.0 / (2.0 + 6.0 * squareness);
  for (int i = 0; i < points; ++i) {
    const double angle = 2.0 * M_PI * i / points, c = Cos(angle), s = Sin(angle);
    ring.push_back({half_width * std::copysign(Pow(std::abs(c), power), c),
                    half_height * std::copysign(Pow(std::abs(s), power), s), z});
  }
  return ring;
}

void Append(geometry::TriangleMesh& mesh, const geometry::TriangleMesh& more) {
  const auto offset = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), more.positions.begin(), more.positions.end());
  for (const auto& [a, b, c] : more.triangles) mesh.triangles.push_back({a + offset, b + offset, c + offset});
}

}  // namespace trocar::instrument
