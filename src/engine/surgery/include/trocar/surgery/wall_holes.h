// SPDX-License-Identifier: Apache-2.0
/// \file wall_holes.h  Where a hollow organ's wall is open, and how wide.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "trocar/base/state_archive.h"
#include "trocar/geometry/editable_mesh.h"
#include "trocar/surgery/organ_surface.h"

namespace trocar::surgery {

/// A way out.
struct WallHole {
  math::Vec3 position;  ///< of its middle, world frame [m]
  math::Vec3 outwards;  ///< unit
  double rim = 0;       ///< its length [m]; 0: there is no hole
};

/// Holes of one organ: what was burnt or torn through, node by node, and what was cut open. Nodes side by side make one
/// hole, as wide as they lie apart.
class WallHoles {
 public:
  static constexpr std::size_t kMost = 64;  ///< nodes; more make no larger hole

  /// \param node  of the system
  /// \param rim  of the hole that it leaves alone [m]
  void Add(std::uint32_t node, double rim) noexcept;
  bool IsEmpty() const { return count_ == 0; }
  void VisitState(base::StateArchive& archive);

  /// The hole with the longest rim.
  /// \param organ, positions  of the whole system
  /// \param mesh  of the organ, with its cuts
  /// \note Real-time safe.
  WallHole FindLargest(const surgery::OrganSurface& organ, std::span<const math::Vec3> positions,
                       const geometry::EditableMesh& mesh) const noexcept;

 private:
  struct Place {
    std::uint32_t node = 0;
    double rim = 0;
  };
  std::array<Place, kMost> places_;
  std::size_t count_ = 0;
};

}  // namespace trocar::surgery
