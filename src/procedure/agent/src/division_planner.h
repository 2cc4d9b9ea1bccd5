// SPDX-License-Identifier: Apache-2.0
/// \file division_planner.h  Clips and cuts of ducts and arteries: which is next, how the tool is brought round the vessel, and
/// whether it may close there.
///
/// Where a clip or a cut fits on one vessel is division_plan.h.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "division_plan.h"
#include "tool_alignment.h"
#include "trocar/base/state_archive.h"
#include "trocar/math/pose.h"

namespace trocar::agent {

/// Clips and cuts of tubes, until each is divided.
struct Division {
  std::vector<std::size_t> tubes;
  std::vector<std::vector<double>> avoid;  ///< (tubes) arcs at which it has failed [m]
  int acts_left = 0;                       ///< clips, cuts and vain tries
  double care = 1.0;                       ///< see DivisionField

  void VisitState(base::StateArchive& archive);
};

/// How the right hand brings a vessel between its jaws.
struct JawAim {
  double beyond = 0.5;  ///< share of the jaws that goes past the vessel [-]
  math::Vec3 offset;    ///< by which the hand aims beside the vessel, because it was pushed aside [m]

  /// Where the tip has to be, for a vessel at `p` [m].
  math::Vec3 FindTip(const math::Vec3& p_world_port, const math::Vec3& p, double jaw_length) const noexcept;
  /// Aims again, from where the vessel lies between jaws that stand so; at most 4 mm beside it.
  void Correct(const math::Pose& X_world_tool, const math::Vec3& p, double jaw_length) noexcept;
};

/// Ducts and arteries as they lie now.
struct SeenVessels {
  std::vector<TubeLine> lines;             ///< (tubes of the patient)
  std::vector<std::vector<double>> clips;  ///< (tubes) arcs of the clips on each, ascending [m]
  std::vector<std::uint8_t> is_divided;    ///< (tubes)
  math::Vec3 port;                         ///< of the hand that does it [m]
  std::function<double(const collision::Segment&)> clearance;  ///< from a segment to the nearest organ [m]

  /// \param care  see DivisionField
  DivisionField FieldOf(std::size_t tube, double care) const;
};

/// A clip or a cut that is next, on one of the division's tubes.
struct NextDivision {
  std::size_t which = 0;  ///< of Division::tubes
  DivisionStep step;
};
/// Every clip first, then the cuts: each tool is taken once.
/// \return nothing where nothing more fits, or all is divided
std::optional<NextDivision> FindNext(const SeenVessels& vessels, const Division& work);

/// Stand of the clip applier before a vessel. \param[out] aim  how far its legs go past the vessel
HandGoal LineUpClip(const SeenVessels& vessels, std::size_t tube, double arc, double care, JawAim& aim);
/// Likewise of the scissors; nothing where they cannot cut there.
std::optional<HandGoal> LineUpScissors(const SeenVessels& vessels, std::size_t tube, double arc, double care,
                                       JawAim& aim);

/// Whether a clip that closes now goes round this vessel alone, over no other clip.
bool IsBetweenLegs(const SeenVessels& vessels, std::size_t tube, const math::Pose& X_world_tool, double care);
/// Whether blades that close now cut between one clip on the organ's side and two that stay.
bool IsCutSafe(const SeenVessels& vessels, std::size_t tube, const math::Pose& X_world_tool);

/// Notes that a clip was closed and is not seen: no other is tried nearby, where it would lie over the first.
void AvoidAround(Division& work, std::size_t which, double arc);

}  // namespace trocar::agent
