// SPDX-License-Identifier: Apache-2.0
#include "trocar/geometry/mesh_measures.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <string>
#include <unordered_map>
#include <vector>

#include "trocar/core/assert.h"
#include "trocar/geometry/distance.h"
#include "trocar/geometry/mesh_topology.h"

namespace trocar::geometry {
namespace {

using math::Cross;
using math::Dot;
using math::Norm;

constexpr double kMaxCellsAnAxis = 1e6;      // below 2^21, so that three numbers fit one key
constexpr double kMaxCellsATriangle = 4096;  // larger triangles stay outside the grid

/// Angle between two directions [rad].
double CalcAngle(const Vec3& a, const Vec3& b) {
  return std::atan2(Norm(Cross(a, b)), Dot(a, b));
}

/// Whether the triangles around each vertex form one fan: neighbours in the fan share an edge at the vertex.
std::size_t CountVerticesWithSeveralFans(const TriangleMesh& mesh) {
  const Rows around = FindVertexTriangles(mesh.triangles, mesh.positions.size());
  std::size_t odd = 0;
  std::vector<std::uint32_t> stack;
  for (std::uint32_t vertex = 0; vertex < mesh.positions.size(); ++vertex) {
    const auto fan = around.Row(vertex);
    if (fan.size() < 2) continue;
    const auto share_edge = [&](const Triangle& a, const Triangle& b) {
      for (const auto i : a) {
        if (i != vertex && std::find(b.begin(), b.end(), i) != b.end()) return true;
      }
      return false;
    };
    std::vector<char> seen(fan.size(), 0);
    stack.assign(1, 0);
    seen[0] = 1;
    std::size_t reached = 1;
    while (!stack.empty()) {
      const auto current = stack.back();
      stack.pop_back();
      for (std::uint32_t other = 0; other < fan.size(); ++other) {
        if (seen[other] || !share_edge(mesh.triangles[fan[current]], mesh.triangles[fan[other]])) continue;
        seen[other] = 1;
        ++reached;
        stack.push_back(other);
      }
    }
    if (reached != fan.size()) ++odd;
  }
  return odd;
}

}  // namespace

Box CalcBox(std::span<const Vec3> positions) {
  if (positions.empty()) return {};
  Box box{positions[0], positions[0]};
  for (const Vec3& p : positions) box.min = math::Min(box.min, p), box.max = math::Max(box.max, p);
  return box;
}

Vec3 CalcAreaNormal(std::span<const Vec3> positions, const Triangle& t) {
  return Cross(positions[t[1]] - positions[t[0]], positions[t[2]] - positions[t[0]]);
}

double CalcArea(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  double twice = 0;
  for (const Triangle& t : triangles) twice += Norm(CalcAreaNormal(positions, t));
  return 0.5 * twice;
}

double CalcVolume(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  if (positions.empty()) return 0.0;
  // relative to a point of the mesh: less cancellation than relative to the origin
  const Vec3 reference = positions[0];
  double six = 0;
  for (const Triangle& t : triangles) {
    six += Dot(positions[t[0]] - reference, Cross(positions[t[1]] - reference, positions[t[2]] - reference));
  }
  return six / 6.0;
}

void CalcVertexNormals(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                       std::span<Vec3> normals) {
  TROCAR_ASSERT(normals.size() == positions.size());
  std::fill(normals.begin(), normals.end(), Vec3{});
  for (const Triangle& t : triangles) {
    const Vec3 area_normal = CalcAreaNormal(positions, t);
    const double twice_area = Norm(area_normal);
    if (!(twice_area > 0.0)) continue;
    const Vec3 unit = area_normal / twice_area;
    for (int i = 0; i < 3; ++i) {
      const Vec3& here = positions[t[i]];
      normals[t[i]] += CalcAngle(positions[t[(i + 1) % 3]] - here, positions[t[(i + 2) % 3]] - here) * unit;
    }
  }
  for (Vec3& normal : normals) normal = math::Normalized(normal);
}

std::vector<double> CalcVertexAreas(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  std::vector<double> areas(positions.size(), 0.0);
  for (const Triangle& t : triangles) {
    const double third = Norm(CalcAreaNormal(positions, t)) / 6.0;
    for (const auto vertex : t) areas[vertex] += third;
  }
  return areas;
}

MeshReport InspectMesh(const TriangleMesh& mesh) {
  MeshReport report;
  report.triangles = mesh.triangles.size();
  report.vertices = mesh.positions.size();
  report.area = CalcArea(mesh.positions, mesh.triangles);
  report.volume = CalcVolume(mesh.positions, mesh.triangles);
  report.min_angle = mesh.triangles.empty() ? 0.0 : M_PI;

  struct Sides {
    int forward = 0, backward = 0;
  };
  std::map<Edge, Sides> edges;
  for (const Triangle& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const auto from = t[i], to = t[(i + 1) % 3];
      const Vec3 &here = mesh.positions[from], &next = mesh.positions[to],
                 &last = mesh.positions[t[(i + 2) % 3]];
      report.min_angle = std::min(report.min_angle, CalcAngle(next - here, last - here));
      if (from < to)
        ++edges[{from, to}].forward;
      else
        ++edges[{to, from}].backward;
    }
    const bool repeated = t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    if (repeated || !(Norm(CalcAreaNormal(mesh.positions, t)) > 0.0)) ++report.degenerate;
  }
  report.edges = edges.size();
  for (const auto& [edge, sides] : edges) {
    if (sides.forward + sides.backward == 1)
      ++report.boundary_edges;
    else if (sides.forward != 1 || sides.backward != 1)
      ++report.odd_edges;
  }
  report.odd_vertices = CountVerticesWithSeveralFans(mesh);
  const auto components = FindComponents(mesh.triangles, mesh.positions.size());
  report.components = components.empty() ? 0 : *std::max_element(components.begin(), components.end()) + 1;
  const auto euler = static_cast<long>(report.vertices) - static_cast<long>(report.edges) +
                     static_cast<long>(report.triangles);
  report.genus = static_cast<int>((2 * static_cast<long>(report.components) - euler) / 2);
  report.closed = report.boundary_edges == 0 && !mesh.triangles.empty();
  report.manifold = report.odd_edges == 0 && report.odd_vertices == 0 && report.degenerate == 0;
  report.outward = report.volume > 0.0;
  return report;
}

std::vector<std::array<std::uint32_t, 2>> FindSelfIntersections(const TriangleMesh& mesh) {
  std::vector<std::array<std::uint32_t, 2>> pairs;
  if (mesh.triangles.empty()) return pairs;
  const Box all = CalcBox(mesh.positions);
  const Vec3 extent = all.max - all.min;
  const double longest = std::max({extent.x, extent.y, extent.z});
  // uniform grid with cells of about one edge length, and never so many that their numbers overflow
  const double edge =
      2.0 * std::sqrt(CalcArea(mesh.positions, mesh.triangles) / static_cast<double>(mesh.triangles.size()));
  const double cell = std::max(edge, longest / kMaxCellsAnAxis);
  if (!(cell > 0.0) || !std::isfinite(cell)) return pairs;
  const auto cell_of = [&](const Vec3& p, int axis) {
    return static_cast<std::int64_t>(std::floor((p[axis] - all.min[axis]) / cell));
  };
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> grid;
  // needles across the whole mesh would fill the grid: they are compared with every triangle
  std::vector<std::uint32_t> large, candidates;
  for (std::uint32_t index = 0; index < mesh.triangles.size(); ++index) {
    const Triangle& t = mesh.triangles[index];
    const Vec3 corners[3] = {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
    const Box box = CalcBox(corners);
    double cells = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      cells *= static_cast<double>(cell_of(box.max, axis) - cell_of(box.min, axis) + 1);
    }
    candidates = large;
    if (cells > kMaxCellsATriangle) {
      candidates.resize(index);
      std::iota(candidates.begin(), candidates.end(), 0u);
      large.push_back(index);
    } else {
      for (auto x = cell_of(box.min, 0); x <= cell_of(box.max, 0); ++x) {
        for (auto y = cell_of(box.min, 1); y <= cell_of(box.max, 1); ++y) {
          for (auto z = cell_of(box.min, 2); z <= cell_of(box.max, 2); ++z) {
            auto& bucket = grid[(x * 2097152 + y) * 2097152 + z];
            candidates.insert(candidates.end(), bucket.begin(), bucket.end());
            bucket.push_back(index);
          }
        }
      }
      std::sort(candidates.begin(), candidates.end());
      candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    }
    for (const auto other : candidates) {
      const Triangle& u = mesh.triangles[other];
      const bool neighbours = std::any_of(
          t.begin(), t.end(), [&](auto v) { return std::find(u.begin(), u.end(), v) != u.end(); });
      const Vec3 others[3] = {mesh.positions[u[0]], mesh.positions[u[1]], mesh.positions[u[2]]};
      if (!neighbours && TrianglesIntersect(corners, others)) pairs.push_back({other, index});
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::size_t CountSelfIntersections(const TriangleMesh& mesh) {
  return FindSelfIntersections(mesh).size();
}

core::Status CheckMesh(const TriangleMesh& mesh) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (!math::IsFinite(mesh.positions[i])) {
      return core::Error{core::ErrorCode::kMeshInvalid,
                         "vertex " + std::to_string(i) + " is not finite; export the mesh again"};
    }
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const auto vertex : mesh.triangles[i]) {
      if (vertex >= mesh.positions.size()) {
        return core::Error{core::ErrorCode::kMeshInvalid,
                           "triangle " + std::to_string(i) + " names vertex " + std::to_string(vertex) +
                               " of " + std::to_string(mesh.positions.size()) + "; export the mesh again"};
      }
    }
  }
  return {};
}

}  // namespace trocar::geometry
