// SPDX-License-Identifier: Apache-2.0
/// \file wide_kernel_bodies.h  The loops of wide_kernels.h. Included by wide_kernels_*.cpp only.
///
/// A bound is a distance along one direction that separates two convex sets, less what rounding may have added:
/// right for any direction, and tight for the direction between their nearest points.
#pragma once

#include "wide_lanes.h"

namespace trocar::collision {
namespace {

/// A box grown by this share of its largest coordinate holds its corners, which single precision moves by 2^-24
/// of themselves, and whatever double precision computes between them [-].
constexpr float kBoxMargin = 4e-7f;
/// Bound on the rounding error of a direction's dot product with a position, as a share of the largest coordinate [-].
constexpr float kDotMargin = 4e-6f;
/// Of a squared length [-].
constexpr float kSquareMargin = 4e-6f;
/// Below this, floats lose their relative precision [m], [m^2].
constexpr float kTiny = 1e-37f;

void ConvertPoints(const double* xyz, std::size_t count, WidePoint* points) {
  std::size_t i = 0;
#if defined(__AVX__)
  // reads one double too many, so the last point is left to the other loop
  for (; i + 1 < count; ++i) _mm_store_ps(&points[i].x, _mm256_cvtpd_ps(_mm256_loadu_pd(xyz + 3 * i)));
#endif
  for (; i < count; ++i) {
    points[i] = {static_cast<float>(xyz[3 * i]), static_cast<float>(xyz[3 * i + 1]),
                 static_cast<float>(xyz[3 * i + 2]), 0.0f};
  }
}

inline Quad AbsoluteOf(Quad v) {
  return Larger(v, -v);
}

inline float SmallestLane(Lanes v) {
  Quad low, high;
  __builtin_memcpy(&low, &v, sizeof low);
  __builtin_memcpy(&high, reinterpret_cast<const char*>(&v) + sizeof low, sizeof high);
  const Quad four = Smaller(low, high);
  const float a = four[0] < four[1] ? four[0] : four[1], b = four[2] < four[3] ? four[2] : four[3];
  return a < b ? a : b;
}

/// Box of a leaf's items into one lane of its node.
inline void FitLeaf(const WideLeaf& leaf, const std::uint32_t* leaf_points, const WidePoint* points,
                    std::uint32_t lane, WideNode& node) {
  const std::uint32_t* at = leaf_points + leaf.first_point;
  Quad low = LoadQuad(points[at[0]]), high = low;
  for (std::uint32_t k = 1; k < leaf.point_count; ++k) {
    const Quad p = LoadQuad(points[at[k]]);
    low = Smaller(low, p);
    high = Larger(high, p);
  }
  const Quad radius = leaf.largest_radius - Quad{};
  const Quad margin =
      kBoxMargin * Larger(Larger(AbsoluteOf(low), AbsoluteOf(high)), radius) + radius + (kTiny - Quad{});
  low -= margin;
  high += margin;
  for (int axis = 0; axis < 3; ++axis) {
    node.low[axis][lane] = low[axis];
    node.high[axis][lane] = high[axis];
  }
}

void RefitNodes(WideNode* nodes, std::size_t node_count, const WideLeaf* leaves,
                const std::uint32_t* leaf_points, const WidePoint* points) {
  for (std::size_t i = node_count; i-- > 0;) {
    WideNode& node = nodes[i];
    for (std::uint32_t lane = 0; lane < node.count; ++lane) {
      const std::uint32_t child = node.child[lane];
      if (child & WideNode::kLeaf) {
        FitLeaf(leaves[child & ~WideNode::kLeaf], leaf_points, points, lane, node);
        continue;
      }
      const WideNode& inner = nodes[child];
      for (int axis = 0; axis < 3; ++axis) {
        node.low[axis][lane] = SmallestLane(Load(inner.low[axis]));
        node.high[axis][lane] = -SmallestLane(-Load(inner.high[axis]));
      }
    }
  }
}

/// Nearest points of eight triangles to a point each, roughly: slivers may get any point.
inline Vector FindRoughlyNearest(const Vector& p, const Vector& a, const Vector& b, const Vector& c) {
  const Vector ab = b - a, ac = c - a, bc = c - b, ap = p - a, bp = p - b;
  const Lanes d00 = Dot(ab, ab), d01 = Dot(ab, ac), d11 = Dot(ac, ac), d20 = Dot(ap, ab), d21 = Dot(ap, ac);
  const Vector on_ab = a + Clamp01(d20 / d00) * ab, on_ac = a + Clamp01(d21 / d11) * ac,
               on_bc = b + Clamp01(Dot(bp, bc) / Dot(bc, bc)) * bc;
  const auto squared = [&](const Vector& q) { return Dot(p - q, p - q); };
  Vector nearest = on_ab;
  Lanes nearest2 = squared(on_ab);
  for (const Vector* other : {&on_ac, &on_bc}) {
    const Lanes other2 = squared(*other);
    nearest = Pick(other2 < nearest2, *other, nearest);
    nearest2 = Smaller(other2, nearest2);
  }
  const Lanes scale = 1.0f / (d00 * d11 - d01 * d01);
  const Lanes v = (d11 * d20 - d01 * d21) * scale, w = (d00 * d21 - d01 * d20) * scale;
  const LaneBits is_inside = (v >= 0.0f) & (w >= 0.0f) & (v + w <= 1.0f);
  return Pick(is_inside, a + v * ab + w * ac, nearest);
}

/// Point of the segment that is nearest to each of eight points.
inline Vector FindOnSegment(const Vector& from, const Vector& along, Lanes length2, const Vector& p) {
  return from + Clamp01(Dot(p - from, along) / length2) * along;
}

/// Unit vector, or a shorter one where squares lose their precision: a bound along it is then too small, never
/// too large.
inline Vector Direction(const Vector& v) {
  constexpr float kShort2 = 1e-30f;  // [m^2]
  return (1.0f / Sqrt(Larger(All(kShort2), Dot(v, v)))) * v;
}

inline Lanes SquareOfBound(Lanes distance) {
  const Lanes positive = Larger(distance, Lanes{});
  return positive * positive * (1.0f - kSquareMargin) - kTiny;
}

struct PointQuery {
  Vector p;
  Lanes scale;

  explicit PointQuery(const WideSearch& search) : p(AllOf(search.from)), scale(LargestCoordinate(p)) {}

  /// Squared distances below which no box of the node reaches.
  Lanes BoundBoxes(const WideNode& node) const {
    const auto gap = [&](int axis, Lanes at) {
      return Larger(Larger(Load(node.low[axis]) - at, at - Load(node.high[axis])), Lanes{});
    };
    const Lanes dx = gap(0, p.x), dy = gap(1, p.y), dz = gap(2, p.z);
    return (dx * dx + dy * dy + dz * dz) * (1.0f - kSquareMargin) - kTiny;
  }
  Lanes BoundItems(const Vector& a, const Vector& b, const Vector& c, Lanes item_scale, Lanes radius) const {
    const Vector away = p - FindRoughlyNearest(p, a, b, c);
    const Vector n = Direction(away);
    const Lanes reach = Smaller(Smaller(Dot(n, p - a), Dot(n, p - b)), Dot(n, p - c));
    return SquareOfBound(reach - kDotMargin * Larger(scale, item_scale) - radius);
  }
};

struct SegmentQuery {
  Vector from, to, along, low, high;
  Lanes length2, scale;

  explicit SegmentQuery(const WideSearch& search)
      : from(AllOf(search.from)),
        to(AllOf(search.to)),
        along(to - from),
        low{Smaller(from.x, to.x), Smaller(from.y, to.y), Smaller(from.z, to.z)},
        high{Larger(from.x, to.x), Larger(from.y, to.y), Larger(from.z, to.z)},
        length2(Dot(along, along)),
        scale(Larger(LargestCoordinate(from), LargestCoordinate(to))) {}

  /// Squared distances below which no box of the node reaches: from box to box, or along the direction from the
  /// segment to the box's centre.
  Lanes BoundBoxes(const WideNode& node) const {
    const Vector box_low{Load(node.low[0]), Load(node.low[1]), Load(node.low[2])};
    const Vector box_high{Load(node.high[0]), Load(node.high[1]), Load(node.high[2])};
    const Lanes margin =
        kDotMargin * Larger(scale, Larger(LargestCoordinate(box_low), LargestCoordinate(box_high)));
    const auto gap = [&](Lanes a_low, Lanes a_high, Lanes b_low, Lanes b_high) {
      return Larger(Larger(a_low - b_high, b_low - a_high) - margin, Lanes{});
    };
    const Lanes dx = gap(box_low.x, box_high.x, low.x, high.x),
                dy = gap(box_low.y, box_high.y, low.y, high.y),
                dz = gap(box_low.z, box_high.z, low.z, high.z);
    const Vector centre = All(0.5f) * (box_low + box_high), half = All(0.5f) * (box_high - box_low);
    const Vector away = centre - FindOnSegment(from, along, length2, centre);
    const Vector n = Direction(away);
    const Lanes box_reach = Absolute(n.x) * half.x + Absolute(n.y) * half.y + Absolute(n.z) * half.z;
    const Lanes apart = Smaller(Dot(n, centre - from), Dot(n, centre - to)) - box_reach - margin;
    // a direction that is not a number says nothing
    return Larger(SquareOfBound(apart), (dx * dx + dy * dy + dz * dz) * (1.0f - kSquareMargin) - kTiny);
  }
  Lanes BoundItems(const Vector& a, const Vector& b, const Vector& c, Lanes item_scale, Lanes radius) const {
    // from the middle of the triangle to the segment, back to the triangle, and to the segment again
    const Vector middle = All(1.0f / 3) * (a + b + c);
    const Vector near = FindRoughlyNearest(FindOnSegment(from, along, length2, middle), a, b, c);
    const Vector away = FindOnSegment(from, along, length2, near) - near;
    const Vector n = Direction(away);
    const auto to_corner = [&](const Vector& corner) {
      return Smaller(Dot(n, from - corner), Dot(n, to - corner));
    };
    const Lanes reach = Smaller(Smaller(to_corner(a), to_corner(b)), to_corner(c));
    return SquareOfBound(reach - kDotMargin * Larger(scale, item_scale) - radius);
  }
};

/// Shows the search every item of a leaf that may be near enough, the nearest by its bound first.
template <typename Query>
inline void VisitLeaf(const Query& query, const WideLeaf& leaf, const WidePoint* points, WideSearch& search) {
  const Vector a = LoadPoints(points, leaf.corner[0]), b = LoadPoints(points, leaf.corner[1]),
               c = LoadPoints(points, leaf.corner[2]);
  const Lanes scale = Larger(Larger(LargestCoordinate(a), LargestCoordinate(b)), LargestCoordinate(c));
  alignas(32) float bounds[kTreeWidth];
  const Lanes bound = query.BoundItems(a, b, c, scale, Load(leaf.radius));
  Store(bounds, bound);
  unsigned left = ~SignBits(bound > All(search.limit)) & ((1u << leaf.count) - 1u);
  while (left != 0) {
    // a bound that is not a number comes first
    unsigned best = static_cast<unsigned>(__builtin_ctz(left));
    for (unsigned rest = left & (left - 1); rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<unsigned>(__builtin_ctz(rest));
      if (!(bounds[lane] >= bounds[best])) best = lane;
    }
    left &= ~(1u << best);
    if (bounds[best] > search.limit) continue;
    search.visit(search.self, leaf.item[best]);
  }
}

template <typename Query>
inline void SearchTree(const Query& query, const WideNode* nodes, const WideLeaf* leaves,
                       const WidePoint* points, WideSearch& search) {
  struct Waiting {
    float bound;
    std::uint32_t child;
  };
  // each of at most 14 levels (2^32 items in parts that differ by no more than twice) leaves seven behind
  Waiting stack[128];
  int waiting = 0;
  std::uint32_t at = 0;
  for (;;) {
    const WideNode& node = nodes[at];
    alignas(32) float bounds[kTreeWidth];
    const Lanes bound = query.BoundBoxes(node);
    Store(bounds, bound);
    unsigned left = ~SignBits(bound > All(search.limit)) & ((1u << node.count) - 1u);
    // the nearest on top
    const int first = waiting;
    for (; left != 0; left &= left - 1) {
      const auto lane = static_cast<unsigned>(__builtin_ctz(left));
      int place = waiting++;
      for (; place > first && stack[place - 1].bound < bounds[lane]; --place) stack[place] = stack[place - 1];
      stack[place] = {bounds[lane], node.child[lane]};
    }
    for (;;) {
      if (waiting == 0) return;
      const Waiting next = stack[--waiting];
      if (next.bound > search.limit) continue;
      if (!(next.child & WideNode::kLeaf)) {
        at = next.child;
        break;
      }
      VisitLeaf(query, leaves[next.child & ~WideNode::kLeaf], points, search);
    }
  }
}

void SearchPoint(const WideNode* nodes, const WideLeaf* leaves, const WidePoint* points, WideSearch& search) {
  SearchTree(PointQuery(search), nodes, leaves, points, search);
}

void SearchSegment(const WideNode* nodes, const WideLeaf* leaves, const WidePoint* points,
                   WideSearch& search) {
  SearchTree(SegmentQuery(search), nodes, leaves, points, search);
}

}  // namespace
}  // namespace trocar::collision
