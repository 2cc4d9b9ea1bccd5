// SPDX-License-Identifier: Apache-2.0
#include "trocar/collision/capsule_tree.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/collision/triangle_tree.h"
#include "wide_search.h"

namespace trocar::collision {

using math::Vec3;

namespace {

SegmentSegmentPoints FindAxes(std::span<const Vec3> positions, const TubePiece& piece,
                              const Segment& segment) noexcept {
  return FindNearestSegmentSegment(segment, {positions[piece.a], positions[piece.b]});
}

void Consider(std::span<const Vec3> positions, const TubePiece& piece, std::uint32_t index,
              const Segment& segment, NearestPiece& best) noexcept {
  const SegmentSegmentPoints axes = FindAxes(positions, piece, segment);
  const double distance = std::sqrt(axes.squared_distance) - piece.radius;
  if (distance < best.distance || (distance == best.distance && index < best.piece)) {
    best = {index, axes, distance};
  }
}

NearestPiece StartPieceSearch(double max_distance) noexcept {
  NearestPiece start;
  start.distance = max_distance;
  return start;
}

NearestPiece EndPieceSearch(const NearestPiece& best) noexcept {
  return best.Found() ? best : NearestPiece{};
}

bool IsFinite(const Segment& segment) noexcept {
  return math::IsFinite(segment.start) && math::IsFinite(segment.end);
}

}  // namespace

base::Result<CapsuleTree> CapsuleTree::Make(std::span<const Vec3> positions,
                                            std::span<const TubePiece> pieces, base::SimdLevel simd) {
  TROCAR_ASSERT(base::HasSimdLevel(simd));
  const auto fail = [](std::size_t piece, const char* what) {
    return base::Error{base::ErrorCode::kMeshInvalid, "piece " + std::to_string(piece) + " of a tube has " +
                                                          what + ": check the centre lines"};
  };
  const auto is_good = [](double value) { return std::fabs(value) <= kLargestCoordinate; };
  CapsuleTree made;
  std::vector<geometry::Triangle> corners;
  std::vector<double> radii;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const TubePiece& piece = pieces[i];
    if (piece.a >= positions.size() || piece.b >= positions.size())
      return fail(i, "an end that does not exist");
    for (const std::uint32_t end : {piece.a, piece.b}) {
      const Vec3& p = positions[end];
      if (!is_good(p.x) || !is_good(p.y) || !is_good(p.z)) return fail(i, "a coordinate that is not finite");
    }
    if (!(piece.radius >= 0.0) || !is_good(piece.radius)) return fail(i, "a radius that is not a length");
    corners.push_back({piece.a, piece.b, piece.b});
    radii.push_back(piece.radius);
  }
  made.pieces_.assign(pieces.begin(), pieces.end());
  made.tree_.simd = simd;
  BuildWideTree(positions, corners, radii, made.tree_);
  return made;
}

void CapsuleTree::Update(std::span<const Vec3> positions) noexcept {
  RefitWideTree(positions, tree_);
}

NearestPiece CapsuleTree::FindNearest(std::span<const Vec3> positions, const Segment& segment,
                                      double max_distance) const noexcept {
  if (!IsFinite(segment) || !(max_distance >= 0.0)) return {};
  NearestPiece best = StartPieceSearch(max_distance);
  const auto limit = [&best] { return best.distance > 0.0 ? best.distance * best.distance : 0.0; };
  SearchWideTree(tree_, segment, limit(), [&](std::uint32_t piece) {
    Consider(positions, pieces_[piece], piece, segment, best);
    return limit();
  });
  return EndPieceSearch(best);
}

std::size_t CapsuleTree::FindWithin(std::span<const Vec3> positions, const Capsule& capsule,
                                    std::span<std::uint32_t> found) const noexcept {
  if (!IsFinite(capsule.axis) || !(capsule.radius >= 0.0)) return 0;
  const double limit = capsule.radius * capsule.radius;
  std::size_t count = 0;
  SearchWideTree(tree_, capsule.axis, limit, [&](std::uint32_t piece) {
    const double axes = std::sqrt(FindAxes(positions, pieces_[piece], capsule.axis).squared_distance);
    if (axes - pieces_[piece].radius <= capsule.radius) {
      if (count < found.size()) found[count] = piece;
      ++count;
    }
    return limit;
  });
  std::sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(std::min(count, found.size())));
  return count;
}

NearestPiece FindNearestPieceBruteForce(std::span<const Vec3> positions, std::span<const TubePiece> pieces,
                                        const Segment& segment, double max_distance) noexcept {
  if (!IsFinite(segment) || !(max_distance >= 0.0)) return {};
  NearestPiece best = StartPieceSearch(max_distance);
  for (std::uint32_t i = 0; i < pieces.size(); ++i) Consider(positions, pieces[i], i, segment, best);
  return EndPieceSearch(best);
}

}  // namespace trocar::collision
