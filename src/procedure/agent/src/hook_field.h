// SPDX-License-Identifier: Apache-2.0
/// \file hook_field.h  What a hook dissects: fibres, what must stay beside them, and where the hook is in this tick.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "hold_planner.h"
#include "traction_planner.h"
#include "trocar/agent/hand_motion.h"
#include "trocar/base/state_archive.h"
#include "trocar/collision/queries.h"
#include "trocar/collision/segment_distance.h"
#include "trocar/math/pose.h"
#include "trocar/scene/tissue_layout.h"

namespace trocar::agent {

/// Fibres that are to be parted with the hook, and how the other hand draws meanwhile.
struct DissectionGoal {
  std::string what;
  std::vector<std::uint32_t> strands;
  std::vector<double> order;  ///< (strands) what comes first [m]
  double enough = 1.0;        ///< share that is to be parted [-]
  std::uint8_t until = 0;     ///< what ends it before: a number for HookField::is_reached; 0: the share alone
  double traction = 0;        ///< see TractionGoal::most
  math::Vec3 way = {};        ///< of it, unit vector
  HoldFilter may = {};        ///< where the other hand holds
  double left_before = 0;     ///< share of the strands, when it was planned [-]

  bool IsFlapHeld() const { return may.kind != HoldFilter::Kind::kAny; }
  void VisitState(base::StateArchive& archive);
};

/// Fibres, what must stay beside them, and what is seen and felt in this tick.
struct HookField {
  std::span<const scene::StrandInfo> strands;   ///< of the scene
  std::span<const math::Vec3> rest, positions;  ///< (nodes) at rest and now [m]
  std::span<const std::uint8_t> is_intact;      ///< (strands)
  std::span<const std::uint32_t> main_ducts;    ///< nodes of ducts that must stay
  /// Of arteries that must stay, and of small ducts of the bed.
  std::span<const std::uint32_t> careful_nodes;
  std::vector<collision::Segment> entries;  ///< where a duct or artery that is whole enters the organ [m]
  /// Distance from a segment to the nearest organ [m].
  std::function<double(const collision::Segment&)> clearance;
  std::function<bool(const DissectionGoal&)> is_reached;  ///< DissectionGoal::until, as it is seen
  math::Pose X_world_hook;                                ///< of the tool that is seen
  math::Vec3 hook_force;                                  ///< of the tissue on it [N]
  HeldTissue held;                                        ///< by the other hand
  math::Pose X_world_lens;
  double field_of_view = 0;  ///< [rad]
  double dt = 0;             ///< of a tick [s]

  /// From a segment to the nearest entry; infinite where none is left [m].
  double EntryDistance(const collision::Segment& segment) const;
  bool IsIntact(std::uint32_t strand) const { return is_intact[strand] != 0; }
  /// The hook's wire, from the tip to the end of the toe.
  collision::Segment Wire() const;
  /// Nearest points of the hook's wire and of a fibre.
  collision::SegmentSegmentPoints Gap(std::uint32_t strand) const;
  /// Where the hook takes a fibre: in its middle, or farther from the entries [m].
  math::Vec3 HookedPoint(std::uint32_t strand) const;
  /// Where the tip stands when the fibre lies on the toe of a hook that is turned so [m].
  math::Vec3 Stand(const HandMotion& hook, std::uint32_t strand, double spin) const;
};

/// How near to where a duct or artery enters no current flows while it is whole: there it is weak already; and how far is ample [m].
inline constexpr double kEntryClear = 0.0008, kEntryFar = 0.0020;
/// Of the hook's toe, from the tip to where a fibre lies on it [m].
inline constexpr double kOnToe = 0.0030;
/// A fibre this near to the wire is on the hook [m].
inline constexpr double kOnHook = 0.0009;

}  // namespace trocar::agent
