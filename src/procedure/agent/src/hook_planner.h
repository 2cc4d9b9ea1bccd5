// SPDX-License-Identifier: Apache-2.0
/// \file hook_planner.h  Sharp dissection: the hook goes from fibre to fibre, with current only while one lies on it.
///
/// The other hand keeps the fibres stretched (traction_planner.h). No current flows beside what must stay, where the tissue is
/// warm already, or out of the picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "heat_memory.h"
#include "hook_field.h"
#include "traction_planner.h"
#include "trocar/agent/hand_motion.h"
#include "trocar/base/state_archive.h"

namespace trocar::agent {

/// The fibre that the hook goes to, or has on its toe.
struct HookTarget {
  std::int32_t fibre = -1;                    ///< among the dissection's; -1: none
  double spin = 0;                            ///< of the hook [rad]
  std::deque<math::Vec3> path;                ///< of the tip, after where it goes now [m]
  math::Vec3 aside;                           ///< by which the tip is led to the fibre [m]
  double seconds = 0, apart = 0, heated = 0;  ///< in all, beside it, with current [s]

  void VisitState(base::StateArchive& archive);
};

/// Dissection of fibres with the hook, until none is left that can be reached.
struct Dissection {
  DissectionGoal goal;
  std::vector<std::uint8_t> attempts;  ///< (strands)
  std::size_t left = 0;                ///< fibres
  double parted_at_reset = 0;
  HookTarget target;
  Traction traction;
  bool waits = false;      ///< for a place to cool
  bool is_bold = false;    ///< pushes on to fibres that do not lie open
  double backing_off = 0;  ///< [s]
  int holds_left = 4;      ///< new holds of a slipped left hand

  void VisitState(base::StateArchive& archive);
};

/// What dissects.
struct DissectingHands {
  HandMotion& hook;
  HandMotion& hold;
  bool& coagulate;  ///< the hook's pedal
};

/// A dissection that begins, without a fibre yet.
/// \param axis, aside  see TractionGoal
Dissection PlanDissection(DissectionGoal goal, const math::Vec3& axis, const math::Vec3& aside);

/// One tick of it: chooses the fibre that lies open and near, goes there, burns it, and draws with the other hand.
/// \param[in,out] heat  where current has flowed
/// \param seconds       since the hands began with it [s]
/// \return whether it is over: enough is parted, or nothing more can be reached
bool StepDissection(const HookField& field, Dissection& work, HeatMemory& heat, double seconds,
                    const DissectingHands& hands);

/// Turns away from the fibre, with the foot off the pedal.
void LeaveFibre(Dissection& work, bool& coagulate);

}  // namespace trocar::agent
