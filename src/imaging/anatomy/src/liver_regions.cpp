// SPDX-License-Identifier: Apache-2.0
#include "liver_regions.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trocar/base/to_integer.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/mesh_topology.h"

namespace trocar::anatomy {

using geometry::TriangleMesh;
using math::Vec3;

const Vec3 kTowardsDiaphragm = math::Normalized(Vec3{-0.45, 0.7, 0.55});

namespace {

constexpr double kFacesDiaphragm = 0.25;  // cosine to that direction
// the left slope of the dome and the left lobe lie against diaphragm and wall, too
const Vec3 kLeftOfDome = math::Normalized(Vec3{0.35, 0.72, 0.6});
constexpr double kFacesLeftOfDome = 0.5;
constexpr double kSmoothing = 0.010;        // nodules and dents smaller than this do not count [m]
constexpr double kCoronaryPosterior = 0.4;  // part of the liver's depth, from behind
constexpr double kCoronarySuperior = 0.30;  // y of a normal, at least: not the back that faces the kidney
constexpr double kCoronaryHigh = 0.45;      // part of the liver's height, from below, above which it lies

/// Parts of the marked vertices that hang together along edges: number of each vertex's part, -1 elsewhere.
std::vector<int> FindParts(const geometry::Rows& neighbours, const std::vector<char>& marked,
                           std::vector<std::size_t>& sizes) {
  std::vector<int> part(marked.size(), -1);
  std::vector<std::uint32_t> stack;
  for (std::uint32_t seed = 0; seed < marked.size(); ++seed) {
    if (!marked[seed] || part[seed] >= 0) continue;
    const int number = static_cast<int>(sizes.size());
    sizes.push_back(0);
    stack.assign(1, seed);
    part[seed] = number;
    while (!stack.empty()) {
      const auto here = stack.back();
      stack.pop_back();
      ++sizes[number];
      for (const auto w : neighbours.Row(here)) {
        if (!marked[w] || part[w] >= 0) continue;
        part[w] = number;
        stack.push_back(w);
      }
    }
  }
  return part;
}

void KeepLargestPart(const geometry::Rows& neighbours, std::vector<char>& marked) {
  std::vector<std::size_t> sizes;
  const auto part = FindParts(neighbours, marked, sizes);
  if (sizes.empty()) return;
  const int largest = static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  for (std::size_t v = 0; v < marked.size(); ++v) marked[v] = part[v] == largest;
}

/// What the marked vertices enclose belongs to them.
void FillHoles(const geometry::Rows& neighbours, std::vector<char>& marked) {
  std::vector<char> rest(marked.size());
  for (std::size_t v = 0; v < marked.size(); ++v) rest[v] = !marked[v];
  KeepLargestPart(neighbours, rest);
  for (std::size_t v = 0; v < marked.size(); ++v) marked[v] = !rest[v];
}

/// Depth of each vertex below the plane that touches the mesh in the direction of its normal [m].
std::vector<double> CalcHullDepths(const TriangleMesh& mesh, const std::vector<Vec3>& normals) {
  std::vector<double> depths(mesh.positions.size());
  for (std::size_t v = 0; v < depths.size(); ++v) {
    double highest = -std::numeric_limits<double>::max();
    for (const Vec3& p : mesh.positions) highest = std::max(highest, Dot(p, normals[v]));
    depths[v] = highest - Dot(mesh.positions[v], normals[v]);
  }
  return depths;
}

std::vector<std::uint32_t> ListMarked(const std::vector<char>& marked) {
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < marked.size(); ++v) {
    if (marked[v]) vertices.push_back(v);
  }
  return vertices;
}

}  // namespace

std::vector<Vec3> CalcBroadNormals(const TriangleMesh& mesh, const geometry::Rows& neighbours) {
  std::vector<Vec3> normals(mesh.positions.size());
  geometry::CalcVertexNormals(mesh.positions, mesh.triangles, normals);
  double length = 0;
  const auto edges = geometry::FindEdges(mesh.triangles);
  for (const auto& [a, b] : edges) length += Distance(mesh.positions[a], mesh.positions[b]);
  length /= static_cast<double>(std::max<std::size_t>(edges.size(), 1));
  // each round spreads a normal over about one edge; rounds add as the squares of their reach
  constexpr int kMaxRounds = 200;
  const double edges_away = kSmoothing / length;
  const int rounds = std::clamp(base::RoundTo<int>(edges_away * edges_away), 1, kMaxRounds);
  for (int round = 0; round < rounds; ++round) {
    std::vector<Vec3> next = normals;
    for (std::size_t v = 0; v < normals.size(); ++v) {
      for (const auto w : neighbours.Row(v)) next[v] += normals[w];
      next[v] = math::Normalized(next[v], normals[v]);
    }
    normals = std::move(next);
  }
  return normals;
}

LiverRegions FindLiverRegions(const TriangleMesh& liver, const meshing::NearestSurface& gallbladder,
                              double falciform_x, const RegionSettings& settings) {
  const std::size_t n = liver.positions.size();
  const auto neighbours = geometry::FindVertexNeighbours(liver.triangles, n);
  const auto normals = CalcBroadNormals(liver, neighbours);
  const auto depths = CalcHullDepths(liver, normals);

  // the face that looks to diaphragm and wall, dents and all
  std::vector<char> face(n, 0);
  for (std::size_t v = 0; v < n; ++v) {
    const double faces = Dot(normals[v], kTowardsDiaphragm);
    const bool is_outer =
        faces > kFacesDiaphragm || (faces > 0 && Dot(normals[v], kLeftOfDome) > kFacesLeftOfDome);
    face[v] = is_outer && depths[v] < settings.hull_depth;
  }
  KeepLargestPart(neighbours, face);
  FillHoles(neighbours, face);

  // around the gallbladder, and along its border, the liver can be lifted
  std::vector<char> is_clear(n, 0), fixed = face;
  std::vector<Vec3> outside;
  for (std::size_t v = 0; v < n; ++v) {
    is_clear[v] = gallbladder.Find(liver.positions[v]).distance < settings.gallbladder_clear;
    if (!face[v]) outside.push_back(liver.positions[v]);
  }
  for (std::size_t v = 0; v < n; ++v) {
    if (!face[v]) continue;
    const bool is_margin = std::any_of(outside.begin(), outside.end(), [&](const Vec3& p) {
      return Distance(p, liver.positions[v]) < settings.margin;
    });
    if (is_margin || is_clear[v]) fixed[v] = 0;
  }
  KeepLargestPart(neighbours, fixed);

  // ligaments hold the face up to its border
  const geometry::Box box = geometry::CalcBox(liver.positions);
  std::vector<char> falciform(n, 0), coronary(n, 0);
  for (std::uint32_t v = 0; v < n; ++v) {
    const Vec3& p = liver.positions[v];
    const double beside = p.x - falciform_x;
    // vertices to either side of the plane too: no gap where triangles are large
    const auto row = neighbours.Row(v);
    const bool is_cut = std::any_of(
        row.begin(), row.end(), [&](auto w) { return (liver.positions[w].x - falciform_x) * beside < 0; });
    falciform[v] = face[v] && !is_clear[v] && (std::fabs(beside) <= settings.falciform_half || is_cut);
    const bool is_posterior = p.z < box.min.z + kCoronaryPosterior * (box.max.z - box.min.z);
    const bool is_high = p.y > box.min.y + kCoronaryHigh * (box.max.y - box.min.y);
    coronary[v] = Dot(normals[v], kTowardsDiaphragm) > 0 && normals[v].y > kCoronarySuperior &&
                  is_posterior && is_high && beside < 0 && !is_clear[v];
  }
  KeepLargestPart(neighbours, falciform);
  KeepLargestPart(neighbours, coronary);
  return {ListMarked(fixed), ListMarked(falciform), ListMarked(coronary)};
}

}  // namespace trocar::anatomy
