// SPDX-License-Identifier: Apache-2.0
/// \file organ_clearance.h  How far tools and lines of sight are from the organs as they lie in a snapshot.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/collision/triangle_tree.h"
#include "trocar/scene/scene.h"
#include "trocar/scene/tissue_layout.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::agent {

/// Search trees over the organs, refitted when another tick is asked about. No state: made anew from any snapshot.
class OrganClearance {
 public:
  /// Has no organ: everything is far.
  OrganClearance() = default;
  /// \param organs  of the patient, whose rows are those of the first surfaces
  OrganClearance(std::span<const patient::Organ> organs, std::span<const scene::SurfaceInfo> surfaces,
                 std::span<const math::Vec3> rest);

  /// Distance from a segment to the nearest organ, at most 30 mm [m].
  double Find(const simulation::Snapshot& seen, const collision::Segment& segment);
  /// Distance from a segment to one organ, at most `most` [m].
  double FindTo(std::size_t organ, const simulation::Snapshot& seen, const collision::Segment& segment,
                double most);
  /// The next question is about another time, whatever its tick.
  void Forget() { tick_ = kNever; }

 private:
  static constexpr std::uint64_t kNever = ~std::uint64_t{0};
  struct Organ {
    collision::TriangleTree tree;
    std::uint32_t first_node = 0, node_count = 0;

    std::span<const math::Vec3> PositionsIn(const simulation::Snapshot& seen) const {
      return std::span(seen.positions).subspan(first_node, node_count);
    }
  };
  void Follow(const simulation::Snapshot& seen);

  std::vector<Organ> organs_;
  std::uint64_t tick_ = kNever;  // of the snapshot that the trees follow
};

}  // namespace trocar::agent
