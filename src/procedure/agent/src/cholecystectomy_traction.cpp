// SPDX-License-Identifier: Apache-2.0
// The other hand while the hook dissects: it draws what it holds off, gives way where the pull grows, and swings it
// elsewhere when no fibre lies open any more.
#include <algorithm>
#include <cmath>

#include "cholecystectomy_surgeon.h"

namespace trocar::agent {

using instrument::kLeft;
using math::Vec3;

namespace {

constexpr double kPeelRate = 0.0012;  // of the hand that draws the gallbladder off its bed [m/s]
/// Pull above which it gives way, while ducts are whole and after [N]; it draws on below a share of that, so that the
/// last fibres of a free gallbladder peel off by the pull alone [-].
constexpr double kMostTiedPull = 10.0, kMostFreePull = 11.0, kEnoughTied = 0.6, kEnoughFree = 0.95;
constexpr double kEase = 0.003,
                 kMostEase = 0.015;     // by which it draws or gives way at a time, and in all [m]
constexpr double kMostSwingPull = 1.3;  // at which a swing ends, of the most pull [-]
constexpr double kSwingShare = 0.7;     // of what was drawn [-]
constexpr double kLeastSwing = 0.012;   // [m]
constexpr double kSwing = 0.6;          // of the way to a side, beside the way asked for [-]
constexpr double kSwingHurry = 0.15, kDrawHurry = 0.2;
constexpr double kSettled = 0.001;  // what the hand is not moved for [m]

}  // namespace

Traction CholecystectomySurgeon::PlanTraction(const DissectionGoal& goal) const {
  Traction traction;
  traction.most = goal.traction;
  traction.most_pull = goal.IsFlapHeld() ? kMostFreePull : kMostTiedPull;
  traction.enough_pull = traction.most_pull * (goal.IsFlapHeld() ? kEnoughFree : kEnoughTied);
  traction.fibres_before = goal.strands.size();
  if (goal.traction <= 0.0) return traction;
  const Vec3 axis = math::Normalized(known_.rest[known_.fundus] - known_.rest[known_.neck]);
  const Vec3 aside = math::Normalized(math::Cross(known_.bed_normal, axis));
  std::vector<Vec3> sides = {Vec3{}, aside, -1.0 * aside, axis};
  // what is free goes to the sides first: off the bed it would stay before the hook
  if (goal.IsFlapHeld()) sides = {2.0 * aside, -2.0 * aside, Vec3{}, aside, -1.0 * aside};
  for (const Vec3& side : sides) traction.ways.push_back(math::Normalized(goal.way + kSwing * side));
  traction.swings_left = static_cast<int>(traction.ways.size());
  return traction;
}

/// Draws on as the fibres part, as far as no strong pull is felt.
/// \param parted  share of the fibres [-]
/// \return whether the hand is on its way, or sets out to draw farther
bool CholecystectomySurgeon::TakeUpSlack(Traction& traction, const simulation::Snapshot& seen,
                                         double parted) {
  HandMotion& hand = HandOf(kLeft);
  if (traction.ways.empty() || !seen.instruments[kLeft].is_grasping) return false;
  if (hand.IsMoving()) return true;
  const double pull = math::Norm(seen.instruments[kLeft].force);
  const double drawn_before = traction.drawn;
  const double wanted_way =
      std::min(traction.most, std::max(traction.most * parted, kPeelRate * act_seconds_));
  if (pull > traction.most_pull) {
    traction.drawn = std::max(-kMostEase, traction.drawn - kEase);
  } else if (pull < traction.enough_pull) {
    traction.drawn = std::min(wanted_way, traction.drawn + kEase);
  }
  const Vec3 wanted = traction.p_hold + traction.drawn * traction.ways[traction.way % traction.ways.size()];
  if (math::Distance(wanted, hand.Tip()) > kSettled) hand.MoveTo(wanted, kDrawHurry);
  return traction.drawn > drawn_before;
}

/// Takes what is held elsewhere, which opens other fibres; the hook is out of the way meanwhile.
void CholecystectomySurgeon::Swing(Dissection& work) {
  Traction& traction = work.traction;
  LeaveFibre(work);
  --traction.swings_left;
  ++traction.way;
  traction.drawn = std::max(kSwingShare * traction.drawn, kLeastSwing);
  traction.seconds = 0;
  traction.fibres_before = work.left;
  traction.is_swinging = true;
  std::fill(work.attempts.begin(), work.attempts.end(), std::uint8_t{0});
  HandOf(kLeft).MoveTo(traction.p_hold + traction.drawn * traction.ways[traction.way % traction.ways.size()],
                       kSwingHurry);
  BackOff();
}

void CholecystectomySurgeon::GoOnSwinging(Traction& traction, const simulation::Snapshot& seen) {
  const bool pulls = math::Norm(seen.instruments[kLeft].force) > kMostSwingPull * traction.most_pull;
  if (pulls) HandOf(kLeft).MoveTo(HandOf(kLeft).Tip());
  traction.is_swinging = HandOf(kLeft).IsMoving() && !pulls;
}

}  // namespace trocar::agent
