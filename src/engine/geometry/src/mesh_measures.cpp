// SPDX-License-Identifier: Apache-2.0
#include "trocar/geometry/mesh_measures.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/geometry/distance.h"
#include "trocar/geometry/mesh_topology.h"
#include "trocar/math/elementary.h"

namespace trocar::geometry {

using math::Vec3;

namespace {

using math::Cross;
using math::Dot;
using math::Norm;

constexpr double kMaxCellsAnAxis = 1e6;      // below 2^21, so that three numbers fit one key
constexpr double kMaxCellsATriangle = 4096;  // larger triangles stay outside the grid

/// Angle between two directions [rad].
double CalcAngle(const Vec3& a, const Vec3& b) {
  return math::Atan2(Norm(Cross(a, b)), Dot(a, b));
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

double CalcSmallestAngle(const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
  return std::min({CalcAngle(b - a, c - a), CalcAngle(c - b, a - b), CalcAngle(a - c, b - c)});
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

  // every side of every triangle as (lower vertex, higher vertex, runs upwards)
  struct Side {
    Edge edge;
    bool is_forward;
    bool operator<(const Side& other) const { return edge < other.edge; }
  };
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    double smallest = M_PI;
    for (int i = 0; i < 3; ++i) {
      const auto from = t[i], to = t[(i + 1) % 3];
      const Vec3 &here = mesh.positions[from], &next = mesh.positions[to],
                 &last = mesh.positions[t[(i + 2) % 3]];
      smallest = std::min(smallest, CalcAngle(next - here, last - here));
      sides.push_back({from < to ? Edge{from, to} : Edge{to, from}, from < to});
    }
    report.min_angle = std::min(report.min_angle, smallest);
    report.mean_min_angle += smallest / static_cast<double>(mesh.triangles.size());
    const bool repeated = t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    if (repeated || !(Norm(CalcAreaNormal(mesh.positions, t)) > 0.0)) ++report.degenerate;
  }
  std::sort(sides.begin(), sides.end());
  for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
    std::size_t forward = 0;
    for (last = first; last < sides.size() && sides[last].edge == sides[first].edge; ++last)
      forward += sides[last].is_forward ? 1 : 0;
    ++report.edges;
    if (last - first == 1)
      ++report.boundary_edges;
    else if (last - first != 2 || forward != 1)
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

namespace {

/// Corners and box of one triangle.
struct PlacedTriangle {
  Triangle triangle;
  Vec3 corners[3];
  Box box;

  PlacedTriangle(const TriangleMesh& mesh, std::uint32_t index)
      : triangle(mesh.triangles[index]),
        corners{mesh.positions[triangle[0]], mesh.positions[triangle[1]], mesh.positions[triangle[2]]},
        box(CalcBox(corners)) {}
};

bool Cut(const PlacedTriangle& a, const PlacedTriangle& b) {
  return BoxesOverlap(a.box, b.box) && TrianglesCut(a.triangle, a.corners, b.triangle, b.corners);
}

}  // namespace

bool BoxesOverlap(const Box& a, const Box& b) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    if (a.max[axis] < b.min[axis] || b.max[axis] < a.min[axis]) return false;
  }
  return true;
}

bool TrianglesCut(const Triangle& a, const Vec3* a_corners, const Triangle& b,
                  const Vec3* b_corners) noexcept {
  int shared = 0, at_a = 0, at_b = 0;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      if (a[i] == b[k]) ++shared, at_a = i, at_b = k;
    }
  }
  if (shared == 0) return TrianglesIntersect(a_corners, b_corners);
  if (shared > 1) return false;
  // beyond the common corner they meet only where the side opposite of it pierces the other triangle
  return SegmentPiercesTriangle(a_corners[(at_a + 1) % 3], a_corners[(at_a + 2) % 3], b_corners) ||
         SegmentPiercesTriangle(b_corners[(at_b + 1) % 3], b_corners[(at_b + 2) % 3], a_corners);
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
  const auto key_of = [&](const Vec3& p) {
    std::array<std::int64_t, 3> index{};
    for (int axis = 0; axis < 3; ++axis)
      index[axis] = base::FloorTo<std::int64_t>((p[axis] - all.min[axis]) / cell);
    return index;
  };
  const auto number = [](const std::array<std::int64_t, 3>& at) {
    return (at[0] * 2097152 + at[1]) * 2097152 + at[2];
  };
  // (cell, triangle); needles across the whole mesh would fill the grid: they are compared with every
  // triangle
  std::vector<std::pair<std::int64_t, std::uint32_t>> entries;
  std::vector<std::uint32_t> large;
  std::vector<PlacedTriangle> placed;
  placed.reserve(mesh.triangles.size());
  for (std::uint32_t index = 0; index < mesh.triangles.size(); ++index) {
    placed.emplace_back(mesh, index);
    const auto low = key_of(placed.back().box.min), high = key_of(placed.back().box.max);
    double cells = 1.0;
    for (int axis = 0; axis < 3; ++axis) cells *= static_cast<double>(high[axis] - low[axis] + 1);
    if (cells > kMaxCellsATriangle) {
      large.push_back(index);
      continue;
    }
    for (auto x = low[0]; x <= high[0]; ++x) {
      for (auto y = low[1]; y <= high[1]; ++y) {
        for (auto z = low[2]; z <= high[2]; ++z) entries.emplace_back(number({x, y, z}), index);
      }
    }
  }
  for (const auto index : large) {
    for (std::uint32_t other = 0; other < placed.size(); ++other) {
      const bool is_other_large = std::binary_search(large.begin(), large.end(), other);
      if (other == index || (is_other_large && other > index)) continue;
      if (Cut(placed[index], placed[other]))
        pairs.push_back({std::min(index, other), std::max(index, other)});
    }
  }
  std::sort(entries.begin(), entries.end());
  for (std::size_t first = 0, last = 0; first < entries.size(); first = last) {
    for (last = first; last < entries.size() && entries[last].first == entries[first].first;) ++last;
    for (std::size_t i = first; i < last; ++i) {
      const PlacedTriangle& a = placed[entries[i].second];
      for (std::size_t k = i + 1; k < last; ++k) {
        const PlacedTriangle& b = placed[entries[k].second];
        if (!BoxesOverlap(a.box, b.box)) continue;
        // a pair that shares several cells counts in the one where its common box begins
        if (number(key_of(math::Max(a.box.min, b.box.min))) != entries[first].first) continue;
        if (TrianglesCut(a.triangle, a.corners, b.triangle, b.corners))
          pairs.push_back({entries[i].second, entries[k].second});
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::size_t CountSelfIntersections(const TriangleMesh& mesh) {
  return FindSelfIntersections(mesh).size();
}

base::Status CheckMesh(const TriangleMesh& mesh) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (!math::IsFinite(mesh.positions[i])) {
      return base::Error{base::ErrorCode::kMeshInvalid,
                         "vertex " + std::to_string(i) + " is not finite; export the mesh again"};
    }
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const auto vertex : mesh.triangles[i]) {
      if (vertex >= mesh.positions.size()) {
        return base::Error{base::ErrorCode::kMeshInvalid,
                           "triangle " + std::to_string(i) + " names vertex " + std::to_string(vertex) +
                               " of " + std::to_string(mesh.positions.size()) + "; export the mesh again"};
      }
    }
  }
  return {};
}

}  // namespace trocar::geometry
