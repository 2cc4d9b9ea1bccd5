// SPDX-License-Identifier: Apache-2.0
#include "trench.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "trocar/geometry/mesh_measures.h"

namespace trocar::geometry {

using math::Vec3;

namespace {

/// Deepest trench, in mean lengths of the edges cut, and shallowest, in lengths of the shortest [-]: beyond, walls have
/// small angles.
constexpr double kDeepest = 8.0;
constexpr double kShallowest = 0.1;
/// Of the tissue below, at most this share is cut [-].
constexpr double kShareOfThickness = 0.45;
/// Surface met within this share of a ray's length is where it starts [-].
constexpr double kAtStart = 1e-6;
/// How far a bottom is moved along the cut where straight down is no good, in lengths of the edges cut [-].
constexpr double kShift = 0.4;

/// Sum of the area normals around a vertex, of unit length.
Vec3 CalcNormal(const EditableMesh& mesh, std::span<const Vec3> x, std::uint32_t v) {
  Vec3 sum;
  mesh.ForEachAround(
      v, [&](std::uint32_t h) { sum += CalcAreaNormal(x, mesh.Triangles()[EditableMesh::TriangleOf(h)]); });
  return math::Normalized(sum);
}

/// How far tissue reaches below a vertex, until the surface is met again [m]. Walls do not count: those of the
/// same cut lie in the same plane.
double CalcThickness(const EditableMesh& mesh, std::span<const Vec3> x, std::uint32_t v, const Vec3& down,
                     double reach) {
  double nearest = std::numeric_limits<double>::infinity();
  const BladeEdge ray{x[v], x[v] + reach * down};
  const Box box{math::Min(ray.a, ray.b), math::Max(ray.a, ray.b)};
  for (std::size_t t = 0; t < mesh.TriangleCount(); ++t) {
    if (mesh.Kinds()[t] == TriangleKind::kWall) continue;
    const Triangle& corners = mesh.Triangles()[t];
    const Vec3 &a = x[corners[0]], &b = x[corners[1]], &c = x[corners[2]];
    if (!BoxesOverlap(box, {math::Min(math::Min(a, b), c), math::Max(math::Max(a, b), c)})) continue;
    const auto hit = FindPiercing(ray, a, b, c);
    if (!hit) continue;
    // the triangles around the vertex, and around its copies on the other side of a cut, start the ray
    const double distance = math::Distance(ray.a, *hit);
    if (distance > kAtStart * reach) nearest = std::min(nearest, distance);
  }
  return nearest;
}

/// Two triangles of quadrilateral a, b, c, d: over a-c, or over b-d.
struct QuadSplit {
  Triangle first{}, second{};  // corners 0 to 3 of the quadrilateral
};
constexpr QuadSplit kOverAC = {{0, 1, 2}, {0, 2, 3}};
constexpr QuadSplit kOverBD = {{0, 1, 3}, {1, 2, 3}};

double CalcSmallestAngle(const std::array<Vec3, 4>& quad, const QuadSplit& split) {
  const auto angle = [&](const Triangle& t) {
    return geometry::CalcSmallestAngle(quad[t[0]], quad[t[1]], quad[t[2]]);
  };
  return std::min(angle(split.first), angle(split.second));
}

}  // namespace

TrenchBuilder::TrenchBuilder(std::size_t vertex_capacity, std::size_t triangle_capacity) {
  state_.assign(vertex_capacity, Bottom::kUnseen);
  place_.resize(vertex_capacity);
  bottom_of_.assign(vertex_capacity, kNone);
  vertices_.reserve(vertex_capacity);
  scored_.reserve(3 * triangle_capacity);
  open_sides_.reserve(12 * triangle_capacity);
}

/// A cut that goes on from the end of a trench, or starts at its rim, parts the trench's walls there: the edge that
/// leads down to the bottom is cut as well.
void TrenchBuilder::AddValleys(std::span<const std::uint32_t> path, EditableMesh& mesh) noexcept {
  for (const auto v : path) {
    if (mesh.CountCopies(v) > 0 || mesh.CountScored(v) != 1) continue;
    const VertexSource& source = mesh.Sources()[v];
    const std::uint32_t root = source.origin == VertexOrigin::kCopy ? source.from[0] : v;
    std::uint32_t valley = kNone;
    bool is_own = false;
    mesh.ForEachAround(v, [&](std::uint32_t h) {
      const std::uint32_t twin = mesh.Twin(h), bottom = mesh.To(h);
      if (twin == kNone || mesh.IsScored(h)) return;
      if (mesh.Sources()[bottom].origin != VertexOrigin::kTrench || mesh.CountScored(bottom) > 0) return;
      if (mesh.Kinds()[EditableMesh::TriangleOf(h)] != TriangleKind::kWall ||
          mesh.Kinds()[EditableMesh::TriangleOf(twin)] != TriangleKind::kWall)
        return;
      const std::uint32_t above = mesh.Sources()[bottom].from[0];
      const bool own = above == root || above == v;
      if (valley == kNone || (own && !is_own)) valley = h, is_own = own;
    });
    if (valley != kNone) mesh.SetScored(valley, true);
  }
}

bool TrenchBuilder::WallsAreGood(std::uint32_t v, const Place& bottom, double min_angle,
                                 const EditableMesh& mesh) const noexcept {
  bool is_good = true;
  mesh.ForEachAround(v, [&](std::uint32_t h) {
    const std::uint32_t w = mesh.To(h);
    if (!is_good || !mesh.IsScored(h) || state_[w] == Bottom::kNotLooked) return;
    const auto rest = mesh.Rest(), now = mesh.Positions();
    if (state_[w] == Bottom::kIsEnd) {
      is_good = geometry::CalcSmallestAngle(rest[w], rest[v], bottom.rest) >= min_angle &&
                geometry::CalcSmallestAngle(now[w], now[v], bottom.now) >= min_angle;
      return;
    }
    // one way of dividing the wall must be good both at rest and now
    const auto is_good_over = [&](const QuadSplit& split) {
      return CalcSmallestAngle({rest[w], rest[v], bottom.rest, place_[w].rest}, split) >= min_angle &&
             CalcSmallestAngle({now[w], now[v], bottom.now, place_[w].now}, split) >= min_angle;
    };
    is_good = is_good_over(kOverAC) || is_good_over(kOverBD);
  });
  return is_good;
}

/// The deepest bottom below a vertex whose walls are good.
bool TrenchBuilder::FindBottom(std::uint32_t v, const FlatSweep& sweep, const CutSettings& settings,
                               const EditableMesh& mesh) noexcept {
  const auto now = mesh.Positions(), rest = mesh.Rest();
  double length = 0, shortest = std::numeric_limits<double>::infinity();
  Vec3 along, first_now, first_rest;
  int count = 0;
  mesh.ForEachAround(v, [&](std::uint32_t h) {
    if (!mesh.IsScored(h)) return;
    const Vec3 edge = now[mesh.To(h)] - now[v];
    if (count == 0) first_now = edge, first_rest = rest[mesh.To(h)] - rest[v];
    length += math::Norm(edge);
    shortest = std::min(shortest, math::Norm(edge));
    along += math::Normalized(edge);
    ++count;
  });
  length /= count;
  // down, in the plane of the cut where that is not along the surface
  const Vec3 normal = CalcNormal(mesh, now, v);
  const Vec3 in_plane = normal - math::Dot(normal, sweep.normal) * sweep.normal;
  const Vec3 down = -1.0 * (math::Norm(in_plane) > 0.3 ? math::Normalized(in_plane) : normal);
  // the same direction at rest: by its components along the normal, the first edge, and across both
  struct Frame {
    Vec3 n, e, f;
  };
  const auto make_frame = [](const Vec3& n, const Vec3& edge) {
    const Vec3 e = math::Normalized(edge - math::Dot(edge, n) * n, math::AnyPerpendicular(n));
    return Frame{n, e, math::Cross(n, e)};
  };
  const Frame frame = make_frame(normal, first_now);
  const Frame rest_frame = make_frame(CalcNormal(mesh, rest, v), first_rest);
  const auto to_rest = [&](const Vec3& u) {
    return math::Dot(u, frame.n) * rest_frame.n + math::Dot(u, frame.e) * rest_frame.e +
           math::Dot(u, frame.f) * rest_frame.f;
  };
  const double wanted = std::min(settings.depth, kDeepest * length);
  const double reach = wanted / kShareOfThickness;
  const double thickness =
      std::min(CalcThickness(mesh, now, v, down, reach), CalcThickness(mesh, rest, v, to_rest(down), reach));
  const double deepest = std::min(wanted, kShareOfThickness * thickness);
  for (const double shift : {0.0, kShift}) {
    for (double depth = deepest; depth >= kShallowest * shortest; depth *= 0.6) {
      const Vec3 offset = depth * down + shift * length * along;
      const Place bottom{rest[v] + to_rest(offset), now[v] + offset};
      if (!WallsAreGood(v, bottom, settings.min_angle, mesh)) continue;
      place_[v] = bottom;
      return true;
    }
  }
  return false;
}

/// Decides where bottoms lie. False where a vertex had no good one: then its edges are no longer scored, and all
/// is to be planned anew.
bool TrenchBuilder::PlanBottoms(std::span<const std::uint32_t> path, const FlatSweep& sweep,
                                const CutSettings& settings, EditableMesh& mesh, CutReport& report) noexcept {
  for (const auto v : vertices_) state_[v] = Bottom::kUnseen;
  vertices_.clear();
  scored_.clear();
  const auto see = [&](std::uint32_t v) {
    if (state_[v] != Bottom::kUnseen) return;
    state_[v] = mesh.CountCopies(v) > 0 ? Bottom::kNotLooked : Bottom::kIsEnd;
    vertices_.push_back(v);
  };
  for (const auto v : path) see(v);
  // a vertex that is parted opens all of its scored edges
  for (std::size_t next = 0; next < vertices_.size(); ++next) {
    const std::uint32_t v = vertices_[next];
    mesh.ForEachAround(v, [&](std::uint32_t h) {
      if (!mesh.IsScored(h)) return;
      if (state_[v] == Bottom::kIsEnd && next >= path.size()) return;
      scored_.push_back(std::min(h, mesh.Twin(h)));
      see(mesh.To(h));
    });
  }
  std::sort(scored_.begin(), scored_.end());
  scored_.erase(std::unique(scored_.begin(), scored_.end()), scored_.end());
  for (const auto v : vertices_) {
    if (state_[v] == Bottom::kIsEnd) continue;
    if (FindBottom(v, sweep, settings, mesh)) {
      state_[v] = Bottom::kPlanned;
      continue;
    }
    mesh.ForEachAround(v, [&](std::uint32_t h) {
      if (!mesh.IsScored(h)) return;
      mesh.SetScored(h, false);
      ++report.refused;
    });
    return false;
  }
  return true;
}

void TrenchBuilder::AddWall(const Triangle& corners, EditableMesh& mesh) noexcept {
  const std::uint32_t t = mesh.AddTriangle(corners, TriangleKind::kWall);
  for (std::uint32_t i = 0; i < 3; ++i) open_sides_.push_back(3 * t + i);
}

/// The wall at the opened half-edge h, which runs along the rim.
void TrenchBuilder::BuildWalls(std::uint32_t h, EditableMesh& mesh) noexcept {
  const auto below = [&](std::uint32_t v) {
    const std::uint32_t original = v < first_copy_ ? v : mesh.Sources()[v].from[0];
    return bottom_of_[original] != kNone ? bottom_of_[original] : v;
  };
  const std::uint32_t u = mesh.From(h), v = mesh.To(h);
  const std::uint32_t below_u = below(u), below_v = below(v);
  open_sides_.push_back(h);
  if (below_u == u) {
    AddWall({v, u, below_v}, mesh);
  } else if (below_v == v) {
    AddWall({v, u, below_u}, mesh);
  } else {
    const std::array<std::uint32_t, 4> corners = {v, u, below_u, below_v};
    const auto smallest = [&](std::span<const Vec3> x, const QuadSplit& split) {
      return CalcSmallestAngle({x[corners[0]], x[corners[1]], x[corners[2]], x[corners[3]]}, split);
    };
    const auto both = [&](const QuadSplit& split) {
      return std::min(smallest(mesh.Rest(), split), smallest(mesh.Positions(), split));
    };
    const QuadSplit& split = both(kOverAC) >= both(kOverBD) ? kOverAC : kOverBD;
    for (const Triangle& t : {split.first, split.second})
      AddWall({corners[t[0]], corners[t[1]], corners[t[2]]}, mesh);
  }
}

/// Joins the sides of walls that run between the same vertices.
void TrenchBuilder::JoinWalls(EditableMesh& mesh) noexcept {
  const auto key = [&](std::uint32_t h) {
    const std::uint32_t a = mesh.From(h), b = mesh.To(h);
    return std::pair(std::pair(std::min(a, b), std::max(a, b)), h);
  };
  std::sort(open_sides_.begin(), open_sides_.end(),
            [&](std::uint32_t h, std::uint32_t g) { return key(h) < key(g); });
  for (std::size_t i = 0; i + 1 < open_sides_.size(); ++i) {
    if (key(open_sides_[i]).first != key(open_sides_[i + 1]).first) continue;
    mesh.Join(open_sides_[i], open_sides_[i + 1]);
    ++i;
  }
}

void TrenchBuilder::Open(std::span<const std::uint32_t> path, const FlatSweep& sweep,
                         const CutSettings& settings, EditableMesh& mesh, CutReport& report) noexcept {
  AddValleys(path, mesh);
  while (!PlanBottoms(path, sweep, settings, mesh, report)) {
  }
  std::size_t copies = 0, bottoms = 0;
  for (const auto v : vertices_) {
    copies += static_cast<std::size_t>(mesh.CountCopies(v));
    bottoms += state_[v] == Bottom::kPlanned ? 1 : 0;
  }
  if (copies > 0 && !mesh.HasCapacity(copies + bottoms, 4 * scored_.size())) {
    report.is_full = true;
    return;
  }
  const std::size_t triangles_before = mesh.TriangleCount();
  for (const auto v : vertices_) {
    if (state_[v] != Bottom::kPlanned) continue;
    bottom_of_[v] = mesh.AddVertex({VertexOrigin::kTrench, {v, kNone, kNone}, {1.0, 0.0, 0.0}},
                                   place_[v].rest, place_[v].now);
  }
  first_copy_ = static_cast<std::uint32_t>(mesh.VertexCount());
  for (const auto v : vertices_) mesh.SeparateParts(v);
  open_sides_.clear();
  for (const auto h : scored_) {
    const std::uint32_t g = mesh.Twin(h);
    if (!mesh.Open(h)) continue;
    ++report.opened;
    BuildWalls(h, mesh);
    BuildWalls(g, mesh);
  }
  JoinWalls(mesh);
  for (const auto v : vertices_) bottom_of_[v] = kNone;
  report.wall_triangles += mesh.TriangleCount() - triangles_before;
}

}  // namespace trocar::geometry
