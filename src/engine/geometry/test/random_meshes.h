// SPDX-License-Identifier: Apache-2.0
/// \file random_meshes.h  Random manifold surfaces: what organs could look like, and much worse.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/primitives.h"
#include "trocar/geometry/tube.h"
#include "trocar/math/pose.h"
#include "trocar/math/random.h"

namespace trocar::geometry {

struct NamedSurface {
  std::string name;
  TriangleMesh mesh;
};

inline math::Vec3 RandomDirection(math::Random& random) {
  math::Vec3 v;
  do {
    v = {random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
  } while (!(SquaredNorm(v) > 0.01 && SquaredNorm(v) < 1.0));
  return math::Normalized(v);
}

/// Of any direction and at most so long; with every compiler the same draws in the same order.
inline math::Vec3 RandomVector(double longest, math::Random& random) {
  const double length = random.Uniform(0, longest);
  return length * RandomDirection(random);
}

inline std::uint32_t RandomIndex(std::size_t count, math::Random& random) {
  return static_cast<std::uint32_t>(random.Uniform() * static_cast<double>(count));
}

/// Puts a vertex at a random place into a random triangle.
inline void InsertVertex(TriangleMesh& mesh, math::Random& random) {
  const std::uint32_t t = RandomIndex(mesh.triangles.size(), random);
  const auto v = static_cast<std::uint32_t>(mesh.positions.size());
  const auto [a, b, c] = mesh.triangles[t];
  const double u = random.Uniform(0.2, 0.5), w = random.Uniform(0.2, 0.3);
  mesh.positions.push_back(u * mesh.positions[a] + w * mesh.positions[b] + (1 - u - w) * mesh.positions[c]);
  mesh.triangles[t] = {a, b, v};
  mesh.triangles.push_back({b, c, v});
  mesh.triangles.push_back({c, a, v});
}

/// Turns random edges within their two triangles, where that folds nothing and makes no edge that is there: valences
/// become irregular.
inline void FlipEdges(TriangleMesh& mesh, std::size_t attempts, math::Random& random) {
  std::map<Edge, std::uint32_t> sides;  // directed edge -> triangle
  const auto list = [&](std::uint32_t t) {
    for (std::size_t i = 0; i < 3; ++i) sides[{mesh.triangles[t][i], mesh.triangles[t][(i + 1) % 3]}] = t;
  };
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) list(t);
  for (std::size_t attempt = 0; attempt < attempts; ++attempt) {
    const std::uint32_t t = RandomIndex(mesh.triangles.size(), random);
    const std::size_t i = RandomIndex(3, random);
    const std::uint32_t a = mesh.triangles[t][i], b = mesh.triangles[t][(i + 1) % 3],
                        c = mesh.triangles[t][(i + 2) % 3];
    const auto other = sides.find({b, a});
    if (other == sides.end()) continue;
    const std::uint32_t s = other->second;
    const Triangle& beyond = mesh.triangles[s];
    const std::uint32_t d =
        *std::find_if(beyond.begin(), beyond.end(), [&](std::uint32_t v) { return v != a && v != b; });
    if (c == d || sides.count({c, d}) != 0 || sides.count({d, c}) != 0) continue;
    const Triangle first = {a, d, c}, second = {d, b, c};
    const math::Vec3 up =
        CalcAreaNormal(mesh.positions, mesh.triangles[t]) + CalcAreaNormal(mesh.positions, beyond);
    const auto lies_well = [&](const Triangle& n) {
      const auto& x = mesh.positions;
      return math::Dot(CalcAreaNormal(x, n), up) > 0.0 &&
             CalcSmallestAngle(x[n[0]], x[n[1]], x[n[2]]) > 3.0 * M_PI / 180.0;
    };
    if (!lies_well(first) || !lies_well(second)) continue;
    sides.erase({a, b});
    sides.erase({b, a});
    mesh.triangles[t] = first;
    mesh.triangles[s] = second;
    list(t);
    list(s);
  }
}

/// Takes random triangles away where the rest stays manifold, and then the vertices that have none left.
inline void MakeHoles(TriangleMesh& mesh, std::size_t count, math::Random& random) {
  const auto without_loose = [](const TriangleMesh& whole) {
    TriangleMesh kept;
    std::vector<std::uint32_t> number(whole.positions.size(), 0xffffffffU);
    for (Triangle t : whole.triangles) {
      for (std::uint32_t& v : t) {
        if (number[v] == 0xffffffffU) {
          number[v] = static_cast<std::uint32_t>(kept.positions.size());
          kept.positions.push_back(whole.positions[v]);
        }
        v = number[v];
      }
      kept.triangles.push_back(t);
    }
    return kept;
  };
  for (std::size_t i = 0; i < count && mesh.triangles.size() > 4; ++i) {
    TriangleMesh less = mesh;
    less.triangles.erase(less.triangles.begin() + RandomIndex(less.triangles.size(), random));
    less = without_loose(less);
    if (InspectMesh(less).manifold) mesh = std::move(less);
  }
}

/// Moves every vertex by up to a share of its shortest edge.
inline void Jitter(TriangleMesh& mesh, double share, math::Random& random) {
  std::vector<double> shortest(mesh.positions.size(), INFINITY);
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      const double length = math::Distance(mesh.positions[a], mesh.positions[b]);
      shortest[a] = std::min(shortest[a], length);
      shortest[b] = std::min(shortest[b], length);
    }
  }
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    mesh.positions[v] += RandomVector(share * shortest[v], random);
}

/// A ball, box, tube, sheet or single triangle, 1 to 300 mm large, stretched, bent, with irregular triangles; sheets have
/// random holes. Always manifold; all but sheets and triangles are closed.
inline NamedSurface MakeRandomSurface(math::Random& random) {
  NamedSurface surface;
  TriangleMesh& mesh = surface.mesh;
  const double kind = random.Uniform();
  bool is_sheet = false;
  if (kind < 0.4) {
    surface.name = "random ball";
    mesh = MakeSphere({}, 0.5, random.Uniform() < 0.3 ? 1 : 2);
  } else if (kind < 0.5) {
    surface.name = "random box";
    mesh = MakeBox({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5});
  } else if (kind < 0.65) {
    surface.name = "random tube";
    const double bend = random.Uniform(0, 0.3), radius = random.Uniform(0.05, 0.2);
    mesh =
        MakeTube(Resample({{{0, 0, 0}, {0.5, bend, 0}, {1, 0, bend}}, {radius, 0.7 * radius, radius}}, 0.1),
                 4 + static_cast<int>(random.Uniform() * 9));
  } else if (kind < 0.95) {
    surface.name = "random sheet";
    is_sheet = true;
    const int columns = 2 + static_cast<int>(random.Uniform() * 14),
              rows = 2 + static_cast<int>(random.Uniform() * 10);
    mesh = random.Uniform() < 0.5 ? MakeGrid(columns, 1.0 / columns)
                                  : MakeTriangularLattice(columns, rows, 1.0 / columns);
  } else {
    surface.name = "one triangle";
    is_sheet = true;
    mesh = {{{0, 0, 0}, {1, 0, 0}, {0, random.Uniform(0.1, 1), 0}}, {{0, 1, 2}}};
  }
  const double irregular = random.Uniform();
  const auto share = [&](double part) {
    return static_cast<std::size_t>(part * irregular * static_cast<double>(mesh.triangles.size()));
  };
  for (std::size_t i = share(0.2); i > 0; --i) InsertVertex(mesh, random);
  FlipEdges(mesh, share(2.0), random);
  if (is_sheet) MakeHoles(mesh, share(0.05), random);
  Jitter(mesh, 0.25 * random.Uniform(), random);
  const math::Vec3 stretch{random.Uniform(0.3, 1), random.Uniform(0.3, 1), random.Uniform(0.3, 1)};
  const math::Vec3 wave = RandomVector(6, random), push = RandomVector(0.15, random);
  const double size = 0.001 * std::pow(300.0, random.Uniform());
  for (math::Vec3& p : mesh.positions) {
    p = {p.x * stretch.x, p.y * stretch.y, p.z * stretch.z};
    p = size * (p + std::sin(math::Dot(wave, p)) * push);
  }
  EXPECT_TRUE(InspectMesh(mesh).manifold) << surface.name;
  return surface;
}

}  // namespace trocar::geometry
