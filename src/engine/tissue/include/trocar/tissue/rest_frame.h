// SPDX-License-Identifier: Apache-2.0
/// \file rest_frame.h  Where the rest shape of a freed piece of tissue is now: its best-fit rigid motion.
///
/// The virtual springs of the paper (section 3.2.3) pull each node to a point fixed in space. A piece that
/// nothing holds in place any more keeps its shape, not its place: its rest shape is carried along by the
/// rigid motion that fits the present positions best, and then the springs exert no net force and no net
/// torque.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "trocar/math/pose.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::tissue {

/// Weighted sums over pairs (rest point, present point), from which the rigid motion follows. Sums are taken
/// about the first pair, so that organs far from the origin lose no digits.
struct MotionMoments {
  double weight = 0;
  math::Vec3 rest_origin, origin;  ///< the first pair [m]
  math::Vec3 rest_sum, sum;        ///< weighted, about the origins
  std::array<double, 9> outer{};   ///< sum w x r^T, row by row, about the origins

  /// Counts |x - (R r + t)|^2 with `w`.
  ///
  /// \param w  [N/m], >= 0
  void AddPoint(double w, const math::Vec3& rest, const math::Vec3& position) noexcept;
  /// Counts |d - R o|^2 with `w`: an offset that turns with the piece but does not place it.
  void AddOffset(double w, const math::Vec3& rest_offset, const math::Vec3& offset) noexcept;
};

/// Rigid motion X with the smallest sum of w |x - X r|^2, by the largest eigenvector of Horn's symmetric 4 x
/// 4 matrix.
///
/// Points on one line, or fewer, leave the rotation open; there, and wherever two rotations fit almost
/// equally well, the one nearest to `previous` is taken: the sum is completed by a trace of |R - previous|^2.
/// The completion vanishes when the rotation repeats, so a rotation that has settled is the exact best fit.
///
/// \param previous  rotation of the last fit: the result is continuous from there, sign of the quaternion
/// included
/// \return `previous` and no shift when nothing has weight
///
/// \note Real-time safe.
/// Source: Horn, "Closed-form solution of absolute orientation using unit quaternions", JOSA A 4(4), 1987.
math::Pose FitRigidMotion(const MotionMoments& moments, const math::Quaternion& previous) noexcept;

/// Region of nodes that anatomy holds in place.
inline constexpr std::uint32_t kPinnedRegion = std::numeric_limits<std::uint32_t>::max();
/// Most free regions that are told apart; of a patient one organ comes free, and few pieces of it.
inline constexpr std::uint32_t kMaxFreeRegions = 16;

/// Pieces of tissue that no anatomy holds: connected components through springs and binding strands without
/// any fixed node.
struct FreeRegions {
  std::vector<std::uint32_t> of_node;  ///< (n) region, or kPinnedRegion
  std::uint32_t count = 0;         ///< <= kMaxFreeRegions; pieces beyond stay pinned and are counted below
  std::uint32_t beyond_count = 0;  ///< pieces that found no place
};
/// The region of each node; the count follows, and how many found no place is not kept.
void VisitState(base::StateArchive& archive, FreeRegions& regions);

/// Finds the free regions. Regions are numbered by their lowest node.
///
/// \param strand_binds  (strands) 1 when a strand shares its place (the bed of an organ), 0 when it is a
/// joint
///                      that lets what hangs on it turn (the end of a duct); empty: all bind
/// \param spring_factor  TissueState::spring_factor, 0 for a spring that does not hold; empty: all hold
/// \param[out] regions  of_node must have the model's size
/// \note Real-time safe: no allocation.
void FindFreeRegions(const TissueModel& model, std::span<const std::uint8_t> strand_is_intact,
                     std::span<const std::uint8_t> strand_binds, std::span<const double> spring_factor,
                     FreeRegions& regions) noexcept;

}  // namespace trocar::tissue
