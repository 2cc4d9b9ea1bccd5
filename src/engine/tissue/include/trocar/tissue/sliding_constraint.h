// SPDX-License-Identifier: Apache-2.0
/// \file sliding_constraint.h  Sliding constraint: a thread or needle that runs through a puncture of a surface.
///
/// The puncture is a point of a triangle, p = sum w_i x_i. A spring draws it to the nearest point of the segment of the rod that is
/// in it, E = min over s of k/2 |p - (1 - s) a - s b|^2, 0 <= s <= 1. Nothing acts along the segment: the rod slides. Where the
/// nearest point is an end, the rod goes on with its next segment (FollowSlide), or slips out.
#pragma once

#include <span>

#include "trocar/tissue/element.h"

namespace trocar::tissue {

struct SlidingConstraint {
  static constexpr std::string_view kName = "sliding_constraints";
  static constexpr std::size_t kNodes = 5, kCapacity = 64;
  static constexpr ElementInvariance kInvariance = ElementInvariance::kMotions;
  /// A cut through the triangle opens the puncture, one through the segment ends the rod there.
  static constexpr std::array<ElementBond, 4> kBonds = {{{0, 1}, {1, 2}, {2, 0}, {3, 4}}};

  std::array<std::uint32_t, kNodes> nodes{};  ///< the triangle's corners, then the segment's two ends
  std::array<double, 3> weights{};            ///< w, barycentric, sum 1 [-]
  double stiffness = 0;                       ///< k [N/m], >= 0
};

/// Place of the puncture on its segment.
struct SlidePlace {
  double share = 0;   ///< s, of the way from the first end to the second [-]
  math::Vec3 offset;  ///< from there to the puncture [m]
};
/// \note Real-time safe.
SlidePlace CalcSlidePlace(const SlidingConstraint& element, const ElementVectors<5>& position) noexcept;

/// Outcome of FollowSlide.
enum class Slide : std::uint8_t {
  kHolds,      ///< the segment is that of before
  kMoved,      ///< another segment of the rod is in the puncture
  kSlippedOut  ///< an end of the rod has come to the puncture: the element has nothing to hold any more
};

/// After a solve: puts the segment into the puncture to which the rod has slid. One segment a call: a rod that is drawn farther in
/// a tick follows in the next ones.
///
/// \param rod       nodes of the rod in their order, >= 2, the element's segment among them
/// \param position  (n) of the system [m]
/// \note Real-time safe.
Slide FollowSlide(std::span<const std::uint32_t> rod, std::span<const math::Vec3> position,
                  SlidingConstraint& element) noexcept;

double CalcElementEnergy(const SlidingConstraint& element, const ElementVectors<5>& position) noexcept;
ElementVectors<5> CalcElementForce(const SlidingConstraint& element,
                                   const ElementVectors<5>& position) noexcept;
void AddElementStiffness(const SlidingConstraint& element, const ElementVectors<5>& position,
                         StiffnessPart part, ElementStiffness<5>& stiffness) noexcept;
bool IsElementUsable(const SlidingConstraint& element) noexcept;
void VisitState(base::StateArchive& archive, SlidingConstraint& element);

}  // namespace trocar::tissue
