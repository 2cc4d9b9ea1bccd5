// SPDX-License-Identifier: Apache-2.0
/// \file hold_planner.h  Where a grasper takes hold of an organ: wall that it can reach and take without what lies behind.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "trocar/base/state_archive.h"
#include "trocar/collision/queries.h"
#include "trocar/math/vector.h"
#include "trocar/scene/tissue_layout.h"

namespace trocar::agent {

/// Which part of a hollow organ may be held, by places along it from its neck to its fundus.
struct HoldFilter {
  enum class Kind : std::uint8_t {
    kAny,
    kNeck,
    kFree,   ///< the flap that has been freed, before `peels`
    kFundus  ///< the fundus, or the flap that has been freed beyond `peels`
  } kind = Kind::kAny;
  double peels = 0;  ///< where the organ peels off its bed, from the neck on [m]

  /// \param along   place along the organ, from the neck on [m]
  /// \param length  from the neck to the fundus [m]
  bool Allows(double along, double length) const noexcept;
  void VisitState(base::StateArchive& archive);
};

/// An organ that is to be held, and what lies around it.
struct HoldField {
  const scene::SurfaceInfo* organ = nullptr;  ///< with triangles
  std::span<const math::Vec3> positions;      ///< (nodes of the scene) [m]
  math::Vec3 port;                            ///< of the grasper [m]
  double jaw_length = 0;                      ///< of the grasper [m]
  /// Distance from a segment to the organ that must not come between the jaws, at most the second argument [m].
  std::function<double(const collision::Segment&, double most)> spared_clearance;
  /// Distance from a segment to the nearest organ [m].
  std::function<double(const collision::Segment&)> clearance;
  std::function<bool(std::uint32_t node)> may;  ///< whether a node may be held
};

/// Node of the organ that a grasper takes best, 10 to 60 mm from where the work is: wall that faces the trocar, clear of the
/// organ that is spared, and with room for the shaft.
/// \param near   where the work is [m]
/// \param avoid  nodes where a hold has been missed
/// \return nothing where no node can be taken
std::optional<std::uint32_t> FindHold(const HoldField& field, const math::Vec3& near,
                                      std::span<const std::uint32_t> avoid);

}  // namespace trocar::agent
