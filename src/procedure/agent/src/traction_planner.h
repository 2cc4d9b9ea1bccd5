// SPDX-License-Identifier: Apache-2.0
/// \file traction_planner.h  Counter-traction: the hand that holds keeps the fibres stretched while the other one dissects.
///
/// It draws on as fibres part, gives way where the pull grows, and swings to another side where no fibre lies open any more.
#pragma once

#include <cstddef>
#include <vector>

#include "trocar/agent/hand_motion.h"
#include "trocar/base/state_archive.h"
#include "trocar/math/vector.h"

namespace trocar::agent {

/// What is asked of the hand that holds.
struct TractionGoal {
  double most = 0;            ///< way in all [m]; 0: the hand rests
  math::Vec3 way;             ///< unit vector
  bool is_flap_held = false;  ///< what is free already: it bears a stronger pull
  std::size_t fibres = 0;     ///< that are to be parted
  math::Vec3 axis;            ///< unit vector along the organ, towards what is not free yet
  math::Vec3 aside;           ///< unit vector across it, along the bed
};

struct Traction {
  double most = 0;               ///< way in all; 0: it rests [m]
  double most_pull = 0;          ///< above which it gives way [N]
  double enough_pull = 0;        ///< below which it draws on [N]
  std::vector<math::Vec3> ways;  ///< unit vectors, in turn when no fibre lies open any more
  std::size_t way = 0;
  math::Vec3 p_hold;  ///< of the tip, when it began [m]
  double drawn = 0;   ///< [m]
  bool is_swinging = false;
  int swings_left = 0;
  double seconds = 0;             ///< since the last swing, or since it was worth its while [s]
  std::size_t fibres_before = 0;  ///< that were left then

  void VisitState(base::StateArchive& archive);
};

/// Ways in which the hand draws, in turn, and the pull that it keeps to.
Traction PlanTraction(const TractionGoal& goal);

/// What the hand feels.
struct HeldTissue {
  bool is_grasping = false;
  math::Vec3 force;  ///< of the tissue on the tool [N]
};

/// Draws on as the fibres part, as far as no strong pull is felt.
/// \param parted   share of the fibres [-]
/// \param seconds  since the dissection began [s]
/// \return whether the hand is on its way, or sets out to draw farther
bool TakeUpSlack(Traction& traction, HandMotion& hand, const HeldTissue& held, double parted, double seconds);

/// Takes what is held to the next side, which opens other fibres.
/// \param left  fibres that are left
void BeginSwing(Traction& traction, HandMotion& hand, std::size_t left);
/// Goes on with the swing, and ends it where the pull grows strong.
void GoOnSwinging(Traction& traction, HandMotion& hand, const HeldTissue& held);

}  // namespace trocar::agent
