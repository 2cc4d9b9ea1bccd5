// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/mesh_decimation.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <queue>
#include <string>
#include <vector>

#include "nearest_surface.h"
#include "trocar/anatomy/mesh_smoothing.h"
#include "trocar/geometry/mesh_measures.h"

namespace trocar::anatomy {
namespace {

using geometry::Triangle;
using geometry::TriangleMesh;
using math::Vec3;

/// Weight of the distance to the planes that a vertex stands for, against the edge's length: short edges go
/// first, except where the surface bends sharply.
constexpr double kPlaneWeight = 40.0;
/// Two triangles whose normals differ more than this (cosine) form a ridge that no flip may cut.
constexpr double kFlipCosine = 0.85;
/// A triangle may turn by at most this (cosine) when a corner moves.
constexpr double kTurnCosine = 0.3;

constexpr std::uint32_t kNoVertex = 0xffffffffu;

/// Mean squared distance to a set of planes: x^T A x + 2 b x + c over the weight.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  Vec3 b;
  double c = 0, weight = 0;

  void AddPlane(const Vec3& n, double d, double w) {
    xx += w * n.x * n.x, xy += w * n.x * n.y, xz += w * n.x * n.z;
    yy += w * n.y * n.y, yz += w * n.y * n.z, zz += w * n.z * n.z;
    b += (w * d) * n;
    c += w * d * d;
    weight += w;
  }
  void Add(const Quadric& q) {
    xx += q.xx, xy += q.xy, xz += q.xz, yy += q.yy, yz += q.yz, zz += q.zz;
    b += q.b, c += q.c, weight += q.weight;
  }
  double Evaluate(const Vec3& p) const {
    const double value = xx * p.x * p.x + yy * p.y * p.y + zz * p.z * p.z +
                         2.0 * (xy * p.x * p.y + xz * p.x * p.z + yz * p.y * p.z + Dot(b, p)) + c;
    return weight > 0 ? std::max(0.0, value / weight) : 0.0;
  }
};

/// A closed manifold surface whose edges can be collapsed and flipped.
class EditableSurface {
 public:
  explicit EditableSurface(const TriangleMesh& mesh)
      : positions_(mesh.positions),
        triangles_(mesh.triangles),
        alive_(mesh.triangles.size(), 1),
        around_(mesh.positions.size()),
        version_(mesh.positions.size(), 0),
        live_(mesh.triangles.size()) {
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      for (const auto v : triangles_[t]) around_[v].push_back(t);
    }
  }

  std::size_t TriangleCount() const { return live_; }

  void CollapseTo(std::size_t budget);
  void FlipEdges();
  void Relax(const NearestSurface& surface);
  TriangleMesh Take() const;

 private:
  struct Candidate {
    double cost;
    std::uint32_t a, b;
    std::uint32_t version_a, version_b;
    // cheapest first; ties by index so that the order never depends on the heap
    bool operator<(const Candidate& other) const {
      if (cost != other.cost) return cost > other.cost;
      if (a != other.a) return a > other.a;
      return b > other.b;
    }
  };

  std::vector<std::uint32_t> Neighbours(std::uint32_t v) const {
    std::vector<std::uint32_t> ring;
    for (const auto t : around_[v]) {
      for (const auto w : triangles_[t]) {
        if (w != v) ring.push_back(w);
      }
    }
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    return ring;
  }
  Vec3 AreaNormal(const Triangle& t) const { return geometry::CalcAreaNormal(positions_, t); }

  /// Whether the triangles around v, without those that hold `gone`, keep their side and some shape with v at
  /// p.
  bool KeepsShape(std::uint32_t v, std::uint32_t gone, const Vec3& p) const {
    for (const auto t : around_[v]) {
      const Triangle& triangle = triangles_[t];
      if (std::find(triangle.begin(), triangle.end(), gone) != triangle.end()) continue;
      Vec3 corners[3];
      for (int i = 0; i < 3; ++i) corners[i] = triangle[i] == v ? p : positions_[triangle[i]];
      const Vec3 before = AreaNormal(triangle),
                 after = Cross(corners[1] - corners[0], corners[2] - corners[0]);
      const double longest =
          std::max({SquaredDistance(corners[0], corners[1]), SquaredDistance(corners[1], corners[2]),
                    SquaredDistance(corners[2], corners[0])});
      if (!(Norm(after) > 0.05 * longest)) return false;
      if (Dot(before, after) < kTurnCosine * Norm(before) * Norm(after)) return false;
    }
    return true;
  }

  std::vector<Vec3> positions_;
  std::vector<Triangle> triangles_;
  std::vector<char> alive_;
  std::vector<std::vector<std::uint32_t>> around_;
  std::vector<std::uint32_t> version_;
  std::size_t live_;
};

void EditableSurface::CollapseTo(std::size_t budget) {
  std::vector<Quadric> quadrics(positions_.size());
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    if (!alive_[t]) continue;
    const Vec3 normal = AreaNormal(triangles_[t]);
    const double area = Norm(normal);
    if (area == 0) continue;
    const Vec3 unit = normal / area;
    for (const auto v : triangles_[t])
      quadrics[v].AddPlane(unit, -Dot(unit, positions_[triangles_[t][0]]), area);
  }
  std::priority_queue<Candidate> queue;
  const auto offer = [&](std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    Quadric both = quadrics[a];
    both.Add(quadrics[b]);
    const Vec3 middle = 0.5 * (positions_[a] + positions_[b]);
    const double cost = SquaredDistance(positions_[a], positions_[b]) + kPlaneWeight * both.Evaluate(middle);
    queue.push({cost, a, b, version_[a], version_[b]});
  };
  for (std::uint32_t v = 0; v < positions_.size(); ++v) {
    for (const auto w : Neighbours(v)) {
      if (v < w) offer(v, w);
    }
  }
  while (live_ > budget && !queue.empty()) {
    const Candidate edge = queue.top();
    queue.pop();
    if (version_[edge.a] != edge.version_a || version_[edge.b] != edge.version_b) continue;
    // link condition: the ends share exactly the two vertices opposite of the edge
    const auto ring_a = Neighbours(edge.a), ring_b = Neighbours(edge.b);
    std::vector<std::uint32_t> shared;
    std::set_intersection(ring_a.begin(), ring_a.end(), ring_b.begin(), ring_b.end(),
                          std::back_inserter(shared));
    if (shared.size() != 2 || ring_a.size() + ring_b.size() < 8) continue;
    if (std::any_of(shared.begin(), shared.end(), [&](auto v) { return around_[v].size() <= 3; })) continue;
    const Vec3 middle = 0.5 * (positions_[edge.a] + positions_[edge.b]);
    if (!KeepsShape(edge.a, edge.b, middle) || !KeepsShape(edge.b, edge.a, middle)) continue;

    // b goes into a
    positions_[edge.a] = middle;
    quadrics[edge.a].Add(quadrics[edge.b]);
    for (const auto t : around_[edge.b]) {
      Triangle& triangle = triangles_[t];
      if (std::find(triangle.begin(), triangle.end(), edge.a) != triangle.end()) {
        alive_[t] = 0;
        --live_;
        for (const auto v : triangle) {
          if (v != edge.b) std::erase(around_[v], t);
        }
      } else {
        std::replace(triangle.begin(), triangle.end(), edge.b, edge.a);
        around_[edge.a].push_back(t);
      }
    }
    around_[edge.b].clear();
    ++version_[edge.a];
    ++version_[edge.b];
    for (const auto w : Neighbours(edge.a)) offer(edge.a, w);
  }
}

void EditableSurface::FlipEdges() {
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    if (!alive_[t]) continue;
    for (int i = 0; i < 3; ++i) {
      const auto a = triangles_[t][i], b = triangles_[t][(i + 1) % 3], c = triangles_[t][(i + 2) % 3];
      // the triangle on the other side of a-b
      std::uint32_t other = t;
      for (const auto u : around_[a]) {
        if (u != t && std::find(triangles_[u].begin(), triangles_[u].end(), b) != triangles_[u].end())
          other = u;
      }
      if (other == t) continue;
      std::uint32_t d = a;
      for (const auto v : triangles_[other]) {
        if (v != a && v != b) d = v;
      }
      const auto angle = [&](std::uint32_t at) {
        const Vec3 p = positions_[a] - positions_[at], q = positions_[b] - positions_[at];
        return std::atan2(Norm(Cross(p, q)), Dot(p, q));
      };
      if (d == c || angle(c) + angle(d) <= M_PI + 1e-9) continue;  // Delaunay already
      if (around_[a].size() <= 4 || around_[b].size() <= 4) continue;
      const auto ring = Neighbours(c);
      if (std::binary_search(ring.begin(), ring.end(), d)) continue;
      const Vec3 n0 = math::Normalized(AreaNormal(triangles_[t])),
                 n1 = math::Normalized(AreaNormal(triangles_[other]));
      if (Dot(n0, n1) < kFlipCosine) continue;
      const Triangle first = {a, d, c}, second = {d, b, c};
      const Vec3 mean = math::Normalized(n0 + n1);
      const Vec3 m0 = AreaNormal(first), m1 = AreaNormal(second);
      if (Dot(mean, m0) < kFlipCosine * Norm(m0) || Dot(mean, m1) < kFlipCosine * Norm(m1)) continue;
      triangles_[t] = first;
      triangles_[other] = second;
      std::erase(around_[b], t);
      std::erase(around_[a], other);
      around_[d].push_back(t);
      around_[c].push_back(other);
      break;
    }
  }
}

void EditableSurface::Relax(const NearestSurface& surface) {
  for (std::uint32_t v = 0; v < positions_.size(); ++v) {
    if (around_[v].empty()) continue;
    // area-weighted centre of the triangles around, in the tangent plane
    Vec3 normal, centre;
    double total = 0.0;
    for (const auto t : around_[v]) {
      const Vec3 n = AreaNormal(triangles_[t]);
      const double area = Norm(n);
      Vec3 middle;
      for (const auto w : triangles_[t]) middle += positions_[w] / 3.0;
      normal += n, centre += area * middle, total += area;
    }
    if (total == 0) continue;
    normal = math::Normalized(normal);
    const Vec3 away = centre / total - positions_[v];
    const Vec3 target = surface.Find(positions_[v] + 0.7 * (away - Dot(away, normal) * normal)).at.point;
    if (KeepsShape(v, kNoVertex, target)) positions_[v] = target;
  }
}

TriangleMesh EditableSurface::Take() const {
  TriangleMesh mesh;
  std::vector<std::uint32_t> number(positions_.size(), 0);
  for (std::uint32_t v = 0; v < positions_.size(); ++v) {
    if (around_[v].empty()) continue;
    number[v] = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(positions_[v]);
  }
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    if (!alive_[t]) continue;
    mesh.triangles.push_back({number[triangles_[t][0]], number[triangles_[t][1]], number[triangles_[t][2]]});
  }
  return mesh;
}

/// meshoptimizer's result, or nothing when it is not closed and manifold or changed the topology.
std::optional<TriangleMesh> SimplifyInBulk(const TriangleMesh& mesh, std::size_t triangles, int genus) {
  // floats about the centre keep their digits
  const geometry::Box box = geometry::CalcBox(mesh.positions);
  const Vec3 centre = 0.5 * (box.min + box.max);
  std::vector<float> positions;
  positions.reserve(mesh.positions.size() * 3);
  for (const Vec3& p : mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) positions.push_back(static_cast<float>(p[axis] - centre[axis]));
  }
  std::vector<unsigned> indices;
  indices.reserve(mesh.triangles.size() * 3);
  for (const Triangle& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
  std::vector<unsigned> kept(indices.size());
  constexpr float kAnyError = 0.05f;  // of the extent; the count is what stops it
  kept.resize(meshopt_simplify(kept.data(), indices.data(), indices.size(), positions.data(),
                               mesh.positions.size(), 3 * sizeof(float), triangles * 3, kAnyError, 0,
                               nullptr));
  TriangleMesh all{mesh.positions, {}};
  for (std::size_t i = 0; i + 2 < kept.size(); i += 3)
    all.triangles.push_back({kept[i], kept[i + 1], kept[i + 2]});
  TriangleMesh simplified = EditableSurface(all).Take();
  const auto report = geometry::InspectMesh(simplified);
  if (!report.closed || !report.manifold || !report.outward || report.genus != genus) return std::nullopt;
  return simplified;
}

}  // namespace

core::Result<TriangleMesh> DecimateMesh(const TriangleMesh& mesh, const DecimationSettings& settings) {
  const auto before = geometry::InspectMesh(mesh);
  if (!before.closed || !before.manifold || !before.outward) {
    return core::Error{core::ErrorCode::kMeshNotClosed,
                       "the mesh to decimate is not closed, manifold and outward; repair it first"};
  }
  const auto budget = static_cast<std::size_t>(settings.triangle_budget);
  // meshoptimizer does not check the link condition: where it breaks the surface, ask for less, then do
  // without
  std::optional<TriangleMesh> bulk;
  for (double factor = settings.bulk_factor; !bulk; factor *= 2) {
    const auto wanted = static_cast<std::size_t>(factor * static_cast<double>(budget));
    if (wanted >= mesh.triangles.size()) break;
    bulk = SimplifyInBulk(mesh, wanted, before.genus);
  }
  EditableSurface surface(bulk ? *bulk : mesh);
  surface.CollapseTo(budget);
  if (surface.TriangleCount() > budget) {
    return core::Error{core::ErrorCode::kMeshNotClosed,
                       "the mesh cannot be reduced to " + std::to_string(budget) +
                           " triangles without breaking it (" + std::to_string(surface.TriangleCount()) +
                           " left); raise triangle_budget"};
  }
  const NearestSurface original(mesh);
  for (int round = 0; round < settings.relaxation_rounds; ++round) {
    surface.FlipEdges();
    surface.Relax(original);
  }
  surface.FlipEdges();
  TriangleMesh decimated = surface.Take();
  SetVolume(decimated, before.volume);
  const auto after = geometry::InspectMesh(decimated);
  if (!after.closed || !after.manifold || !after.outward) {
    return core::Error{core::ErrorCode::kMeshNotClosed,
                       "decimation left a mesh that is not closed and manifold"};
  }
  return decimated;
}

}  // namespace trocar::anatomy
