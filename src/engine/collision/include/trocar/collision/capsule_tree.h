// SPDX-License-Identifier: Apache-2.0
/// \file capsule_tree.h  Which piece of a duct or vessel is nearest: tubes as chains of capsules.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/collision/segment_distance.h"
#include "trocar/collision/wide_tree.h"

namespace trocar::collision {

/// Straight piece of a tube between two centre-line points.
struct TubePiece {
  std::uint32_t a = 0, b = 0;  ///< indices into positions
  double radius = 0;           ///< [m], >= 0
};

/// Nearest piece to a segment.
struct NearestPiece {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  std::uint32_t piece = kNone;
  SegmentSegmentPoints axes;  ///< a: the query, b: the piece's axis
  double distance =
      std::numeric_limits<double>::infinity();  ///< from the query to the surface, negative inside [m]

  bool Found() const { return piece != kNone; }
};

/// Exact searches over the pieces of all tubes; the same tree and the same promises as TriangleTree.
class CapsuleTree {
 public:
  /// Holds no piece; every search finds none.
  CapsuleTree() = default;

  /// \param positions  (nv) [m]
  /// \param pieces     (n), copied; may be empty
  /// \return kMeshInvalid for an index out of range, or a coordinate or radius that is not finite or too large
  /// \note Not real-time safe: allocates.
  static base::Result<CapsuleTree> Make(std::span<const math::Vec3> positions,
                                        std::span<const TubePiece> pieces,
                                        base::SimdLevel simd = base::FindSimdLevel());

  /// \note Real-time safe: no allocation, lock or throw.
  void Update(std::span<const math::Vec3> positions) noexcept;

  /// The piece whose surface is nearest to a segment (or a point), deepest where it lies inside of some; of
  /// equally near ones that of lowest index.
  ///
  /// \param max_distance  pieces with a farther surface are not found [m], >= 0
  /// \return not Found() when there is none or the segment is not finite
  /// \note Real-time safe: no allocation, lock or throw.
  NearestPiece FindNearest(std::span<const math::Vec3> positions, const Segment& segment,
                           double max_distance = std::numeric_limits<double>::infinity()) const noexcept;

  /// Every piece that overlaps or touches `capsule`.
  ///
  /// \param[out] found  as many indices as fit, ascending; which ones when they do not all fit is not said
  /// \return how many there are
  /// \note Real-time safe: no allocation, lock or throw.
  std::size_t FindWithin(std::span<const math::Vec3> positions, const Capsule& capsule,
                         std::span<std::uint32_t> found) const noexcept;

  std::span<const TubePiece> Pieces() const noexcept { return pieces_; }

 private:
  std::vector<TubePiece> pieces_;
  WideTree tree_;
};

/// Nearest piece of tube to a segment by testing every piece: bit for bit the result of CapsuleTree::FindNearest.
NearestPiece FindNearestPieceBruteForce(
    std::span<const math::Vec3> positions, std::span<const TubePiece> pieces, const Segment& segment,
    double max_distance = std::numeric_limits<double>::infinity()) noexcept;

}  // namespace trocar::collision
