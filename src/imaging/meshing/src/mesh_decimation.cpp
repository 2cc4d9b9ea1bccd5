// SPDX-License-Identifier: Apache-2.0
#include "trocar/meshing/mesh_decimation.h"

#include <meshoptimizer.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <queue>
#include <string>
#include <vector>

#include "editable_surface.h"
#include "trocar/base/to_integer.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/math/elementary.h"
#include "trocar/meshing/mesh_smoothing.h"
#include "trocar/meshing/nearest_surface.h"

namespace trocar::meshing {
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

/// Whether the triangles around v, without those that hold `gone`, keep their side and some shape with v at
/// p.
bool KeepsShape(const EditableSurface& surface, std::uint32_t v, std::uint32_t gone, const Vec3& p) {
  for (const auto t : surface.Around(v)) {
    const Triangle& triangle = surface.TriangleAt(t);
    if (std::find(triangle.begin(), triangle.end(), gone) != triangle.end()) continue;
    Vec3 corners[3];
    for (int i = 0; i < 3; ++i) corners[i] = triangle[i] == v ? p : surface.Position(triangle[i]);
    const Vec3 before = surface.AreaNormal(triangle),
               after = Cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double longest =
        std::max({SquaredDistance(corners[0], corners[1]), SquaredDistance(corners[1], corners[2]),
                  SquaredDistance(corners[2], corners[0])});
    if (!(Norm(after) > 0.05 * longest)) return false;
    if (Dot(before, after) < kTurnCosine * Norm(before) * Norm(after)) return false;
  }
  return true;
}

/// Collapses the cheapest edge again and again.
class Decimator {
 public:
  explicit Decimator(EditableSurface& surface)
      : surface_(surface), quadrics_(surface.VertexSlots()), version_(surface.VertexSlots(), 0) {
    for (std::uint32_t t = 0; t < surface.TriangleSlots(); ++t) {
      const Triangle& triangle = surface.TriangleAt(t);
      const Vec3 normal = surface.AreaNormal(triangle);
      const double area = Norm(normal);
      if (area == 0) continue;
      const Vec3 unit = normal / area;
      for (const auto v : triangle)
        quadrics_[v].AddPlane(unit, -Dot(unit, surface.Position(triangle[0])), area);
    }
  }

  void CollapseTo(std::size_t budget) {
    std::vector<std::uint32_t> ring;
    for (std::uint32_t v = 0; v < surface_.VertexSlots(); ++v) {
      surface_.GatherNeighbours(v, ring);
      for (const auto w : ring) {
        if (v < w) Offer(v, w);
      }
    }
    while (surface_.TriangleCount() > budget && !queue_.empty()) {
      const Candidate edge = queue_.top();
      queue_.pop();
      if (version_[edge.a] != edge.version_a || version_[edge.b] != edge.version_b) continue;
      if (!surface_.CanCollapse(edge.a, edge.b)) continue;
      const Vec3 middle = 0.5 * (surface_.Position(edge.a) + surface_.Position(edge.b));
      if (!KeepsShape(surface_, edge.a, edge.b, middle) || !KeepsShape(surface_, edge.b, edge.a, middle))
        continue;
      surface_.Collapse(edge.a, edge.b, middle);
      quadrics_[edge.a].Add(quadrics_[edge.b]);
      ++version_[edge.a];
      ++version_[edge.b];
      surface_.GatherNeighbours(edge.a, ring);
      for (const auto w : ring) Offer(edge.a, w);
    }
  }

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

  void Offer(std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    Quadric both = quadrics_[a];
    both.Add(quadrics_[b]);
    const Vec3 &p = surface_.Position(a), &q = surface_.Position(b);
    const double cost = SquaredDistance(p, q) + kPlaneWeight * both.Evaluate(0.5 * (p + q));
    queue_.push({cost, a, b, version_[a], version_[b]});
  }

  EditableSurface& surface_;
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> version_;
  std::priority_queue<Candidate> queue_;
};

/// Makes the triangulation Delaunay where the surface is flat enough.
void FlipEdges(EditableSurface& surface) {
  for (std::uint32_t t = 0; t < surface.TriangleSlots(); ++t) {
    if (!surface.IsAlive(t)) continue;
    for (int i = 0; i < 3; ++i) {
      const EdgeNeighbours edge = surface.FindAcross(t, i);
      const auto angle = [&](std::uint32_t at) {
        const Vec3 p = surface.Position(edge.a) - surface.Position(at),
                   q = surface.Position(edge.b) - surface.Position(at);
        return math::Atan2(Norm(Cross(p, q)), Dot(p, q));
      };
      if (angle(edge.c) + angle(edge.d) <= M_PI + 1e-9) continue;  // Delaunay already
      // no vertex of three triangles: it would be a spike that later steps cannot relax
      if (surface.Around(edge.a).size() <= 4 || surface.Around(edge.b).size() <= 4 || !surface.CanFlip(edge))
        continue;
      const Vec3 n0 = math::Normalized(surface.AreaNormal(surface.TriangleAt(edge.t))),
                 n1 = math::Normalized(surface.AreaNormal(surface.TriangleAt(edge.other)));
      if (Dot(n0, n1) < kFlipCosine) continue;
      const Vec3 mean = math::Normalized(n0 + n1);
      const Vec3 m0 = surface.AreaNormal(edge.FlippedFirst()), m1 = surface.AreaNormal(edge.FlippedSecond());
      if (Dot(mean, m0) < kFlipCosine * Norm(m0) || Dot(mean, m1) < kFlipCosine * Norm(m1)) continue;
      surface.Flip(edge);
      break;
    }
  }
}

/// Moves every vertex towards the middle of its triangles, along the original surface.
void Relax(EditableSurface& surface, const NearestSurface& original) {
  const auto count = static_cast<std::uint32_t>(surface.VertexSlots());
  std::vector<Vec3> targets(count);
  oneapi::tbb::parallel_for(std::uint32_t{0}, count, [&](std::uint32_t v) {
    // area-weighted centre of the triangles around, in the tangent plane
    Vec3 normal, centre;
    double total = 0.0;
    for (const auto t : surface.Around(v)) {
      const Triangle& triangle = surface.TriangleAt(t);
      const Vec3 n = surface.AreaNormal(triangle);
      const double area = Norm(n);
      Vec3 middle;
      for (const auto w : triangle) middle += surface.Position(w) / 3.0;
      normal += n, centre += area * middle, total += area;
    }
    targets[v] = surface.Position(v);
    if (total == 0) return;
    normal = math::Normalized(normal);
    const Vec3 away = centre / total - surface.Position(v);
    targets[v] = original.Find(surface.Position(v) + 0.7 * (away - Dot(away, normal) * normal)).at.point;
  });
  for (std::uint32_t v = 0; v < count; ++v) {
    if (!surface.Around(v).empty() && KeepsShape(surface, v, kNoVertex, targets[v]))
      surface.Move(v, targets[v]);
  }
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
  TriangleMesh simplified = DropUnusedVertices(all);
  const auto report = geometry::InspectMesh(simplified);
  if (!report.closed || !report.manifold || !report.outward || report.genus != genus) return std::nullopt;
  return simplified;
}

}  // namespace

base::Result<TriangleMesh> DecimateMesh(const TriangleMesh& mesh, const DecimationSettings& settings) {
  const auto before = geometry::InspectMesh(mesh);
  if (!before.closed || !before.manifold || !before.outward) {
    return base::Error{base::ErrorCode::kMeshNotClosed,
                       "the mesh to decimate is not closed, manifold and outward; repair it first"};
  }
  const auto budget = static_cast<std::size_t>(settings.triangle_budget);
  // meshoptimizer does not check the link condition: where it breaks the surface, ask for less, then do
  // without
  std::optional<TriangleMesh> bulk;
  for (double factor = settings.bulk_factor; !bulk; factor *= 2) {
    const auto wanted = base::TruncateTo<std::size_t>(factor * static_cast<double>(budget));
    if (wanted >= mesh.triangles.size()) break;
    bulk = SimplifyInBulk(mesh, wanted, before.genus);
  }
  EditableSurface surface(bulk ? *bulk : mesh);
  Decimator(surface).CollapseTo(budget);
  if (surface.TriangleCount() > budget) {
    return base::Error{base::ErrorCode::kMeshNotClosed,
                       "the mesh cannot be reduced to " + std::to_string(budget) +
                           " triangles without breaking it (" + std::to_string(surface.TriangleCount()) +
                           " left); raise triangle_budget"};
  }
  const NearestSurface original(mesh);
  for (int round = 0; round < settings.relaxation_rounds; ++round) {
    FlipEdges(surface);
    Relax(surface, original);
  }
  FlipEdges(surface);
  TriangleMesh decimated = surface.Take();
  SetVolume(decimated, before.volume);
  const auto after = geometry::InspectMesh(decimated);
  if (!after.closed || !after.manifold || !after.outward) {
    return base::Error{base::ErrorCode::kMeshNotClosed,
                       "decimation left a mesh that is not closed and manifold"};
  }
  return decimated;
}

}  // namespace trocar::meshing
