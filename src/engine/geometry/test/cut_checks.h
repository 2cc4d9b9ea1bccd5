// SPDX-License-Identifier: Apache-2.0
/// \file cut_checks.h  Slow, obvious oracles for cut surfaces, and random ones to cut.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/surface_cut.h"
#include "trocar/math/random.h"

namespace trocar::geometry {

/// What must stay the same over any number of cuts.
struct Uncut {
  double rest_area = 0, area = 0;  ///< of the surface without walls [m^2]
  std::size_t small_angles = 0;    ///< triangles with an angle below one degree at rest
  bool is_closed = false;
};

inline double CalcKindArea(const EditableMesh& mesh, std::span<const math::Vec3> x, TriangleKind kind) {
  double area = 0;
  for (std::size_t t = 0; t < mesh.TriangleCount(); ++t) {
    if (mesh.Kinds()[t] == kind) area += 0.5 * math::Norm(CalcAreaNormal(x, mesh.Triangles()[t]));
  }
  return area;
}

inline std::size_t CountSmallAngles(const EditableMesh& mesh) {
  std::size_t count = 0;
  for (const Triangle& t : mesh.Triangles()) {
    const auto x = mesh.Rest();
    count += CalcSmallestAngle(x[t[0]], x[t[1]], x[t[2]]) < M_PI / 180.0 ? 1 : 0;
  }
  return count;
}

inline Uncut Measure(const EditableMesh& mesh) {
  return {CalcKindArea(mesh, mesh.Rest(), TriangleKind::kSurface),
          CalcKindArea(mesh, mesh.Positions(), TriangleKind::kSurface), CountSmallAngles(mesh),
          InspectMesh(mesh.RestMesh()).closed};
}

/// Empty where the mesh is what a cut may leave, else what is wrong. Nothing here uses the half-edges but the
/// last check, which compares them with the triangles.
inline std::string FindFault(const EditableMesh& mesh, const Uncut& uncut, bool has_walls) {
  const MeshReport report = InspectMesh(mesh.RestMesh());
  if (!report.manifold) {
    return "not manifold: " + std::to_string(report.odd_edges) + " edges, " +
           std::to_string(report.odd_vertices) + " vertices, " + std::to_string(report.degenerate) +
           " degenerate";
  }
  if (has_walls && uncut.is_closed && !report.closed) return "no longer closed";
  const double area = CalcKindArea(mesh, mesh.Rest(), TriangleKind::kSurface);
  if (!(std::fabs(area / uncut.rest_area - 1.0) < 1e-9))
    return "area at rest " + std::to_string(area / uncut.rest_area);
  const double area_now = CalcKindArea(mesh, mesh.Positions(), TriangleKind::kSurface);
  if (!(std::fabs(area_now / uncut.area - 1.0) < 1e-9))
    return "area now " + std::to_string(area_now / uncut.area);
  if (CountSmallAngles(mesh) > uncut.small_angles) return "a sliver";
  std::vector<int> uses(mesh.VertexCount(), 0);
  std::vector<Triangle> sorted;
  std::map<Edge, std::vector<std::uint32_t>> sides;  // directed edge -> half-edges
  for (std::uint32_t t = 0; t < mesh.TriangleCount(); ++t) {
    Triangle corners = mesh.Triangles()[t];
    for (std::uint32_t i = 0; i < 3; ++i) {
      ++uses[corners[i]];
      sides[{corners[i], corners[(i + 1) % 3]}].push_back(3 * t + i);
    }
    std::sort(corners.begin(), corners.end());
    sorted.push_back(corners);
  }
  if (std::find(uses.begin(), uses.end(), 0) != uses.end()) return "an isolated vertex";
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return "a triangle twice";
  for (const auto& [edge, halves] : sides) {
    if (halves.size() != 1) return "two triangles run the same way along an edge";
    const auto other = sides.find({edge[1], edge[0]});
    const std::uint32_t twin = other == sides.end() ? kNone : other->second[0];
    if (mesh.Twin(halves[0]) != twin) return "half-edges and triangles disagree";
    if (mesh.From(mesh.Outgoing(edge[0])) != edge[0]) return "a wrong outgoing half-edge";
    if (mesh.IsScored(halves[0]) && (twin == kNone || !mesh.IsScored(twin))) return "scored on one side";
  }
  for (std::uint32_t v = 0; v < mesh.VertexCount(); ++v) {
    if (!math::IsFinite(mesh.Rest()[v]) || !math::IsFinite(mesh.Positions()[v])) return "not finite";
  }
  return {};
}

/// Lengths of the boundary's loops [m], by walking from vertex to vertex.
inline std::vector<double> FindLoopLengths(const TriangleMesh& mesh) {
  std::map<Edge, int> directed;
  for (const Triangle& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) directed[{t[i], t[(i + 1) % 3]}] = 1;
  }
  std::map<std::uint32_t, std::uint32_t> next;
  for (const auto& [edge, one] : directed) {
    if (directed.find({edge[1], edge[0]}) == directed.end()) next[edge[0]] = edge[1];
  }
  std::vector<double> lengths;
  while (!next.empty()) {
    double length = 0;
    std::uint32_t at = next.begin()->first;
    for (auto found = next.find(at); found != next.end(); found = next.find(at)) {
      length += math::Distance(mesh.positions[at], mesh.positions[found->second]);
      at = found->second;
      next.erase(found);
    }
    lengths.push_back(length);
  }
  return lengths;
}

}  // namespace trocar::geometry
