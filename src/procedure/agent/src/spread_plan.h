// SPDX-License-Identifier: Apache-2.0
/// \file spread_plan.h  Where a dissector's jaws open so that they part as many fibres as can be, and push nothing else; and
/// where the tips of scissors take a single fibre beside what must stay whole.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "trocar/collision/queries.h"
#include "trocar/instrument/tool.h"

namespace trocar::agent {

/// Field before the jaws: fibres to be parted, and the tubes and organs beside them.
struct SpreadField {
  std::vector<collision::Segment> fibres;  ///< that are to be parted [m]
  std::vector<double> weights;             ///< (fibres) what parting one is worth
  struct Round {
    math::Vec3 p;       ///< [m]
    double radius = 0;  ///< [m]
  };
  std::vector<Round> tubes;  ///< points of ducts and arteries that the jaws go beside
  math::Vec3 port;           ///< [m]
  math::Vec3 tip;            ///< where the hand is now [m]
  double spin = 0;           ///< of the hand now [rad]
  const instrument::Tool* tool = nullptr;
  /// Distance from a segment to the nearest organ [m].
  std::function<double(const collision::Segment&)> clearance;
};

struct SpreadPose {
  math::Vec3 tip;       ///< [m]
  double spin = 0;      ///< [rad]
  double opening = 1;   ///< of the jaws, as a share: less where a duct is near [-]
  double worth = 0;     ///< of what parts
  std::size_t aim = 0;  ///< the fibre that it was found for
};

/// Jaws stay this far open between two spreads, as a share: closed they would grasp.
inline constexpr double kNarrow = 0.25;

/// The best of poses at some of the fibres.
/// \param tries  (fibres) how often a spread at each came to nothing; tried ones come later
/// \return nothing where no spread is worth it
std::optional<SpreadPose> FindSpread(const SpreadField& field, std::span<const std::uint8_t> tries);

/// Where blades that close part a fibre and come near nothing else: the fibre that can be taken with the most room.
/// \param tries  (fibres) how often a cut at each came to nothing
/// \return nothing where none can be; the worth is the room about the blades [m]
std::optional<SpreadPose> FindSnip(const SpreadField& field, std::span<const std::uint8_t> tries);

/// Room between blades that stand so and what must stay whole, no less than they want [m].
/// \param fibre  of the field
/// \return nothing where they would not cut the fibre, or would come too near
std::optional<double> FindSnipRoom(const SpreadField& field, std::size_t fibre,
                                   const math::Pose& X_world_tool, double opening);

}  // namespace trocar::agent
