// SPDX-License-Identifier: Apache-2.0
#include "traction_planner.h"

#include <algorithm>

#include "state_fields.h"

namespace trocar::agent {

using math::Vec3;

namespace {

constexpr double kPeelRate = 0.0012;  // of the hand that draws an organ off its bed [m/s]
/// Pull above which it gives way, while ducts are whole and after [N]; it draws on below a share of that, so that the
/// last fibres of a free organ peel off by the pull alone [-].
constexpr double kMostTiedPull = 10.0, kMostFreePull = 11.0, kEnoughTied = 0.6, kEnoughFree = 0.95;
constexpr double kEase = 0.003,
                 kMostEase = 0.015;     // by which it draws or gives way at a time, and in all [m]
constexpr double kMostSwingPull = 1.3;  // at which a swing ends, of the most pull [-]
constexpr double kSwingShare = 0.7;     // of what was drawn [-]
constexpr double kLeastSwing = 0.012;   // [m]
constexpr double kSwing = 0.6;          // of the way to a side, beside the way asked for [-]
constexpr double kSwingHurry = 0.15, kDrawHurry = 0.2;
constexpr double kSettled = 0.001;  // what the hand is not moved for [m]

Vec3 FindDrawn(const Traction& traction) {
  return traction.p_hold + traction.drawn * traction.ways[traction.way % traction.ways.size()];
}

}  // namespace

void Traction::VisitState(base::StateArchive& archive) {
  archive.Field("most", most);
  archive.Field("most_pull", most_pull);
  archive.Field("enough_pull", enough_pull);
  archive.Field("ways", ways);
  archive.Field("way", way);
  archive.Field("p_hold", p_hold);
  archive.Field("drawn", drawn);
  archive.Field("is_swinging", is_swinging);
  archive.Field("swings_left", swings_left);
  archive.Field("seconds", seconds);
  archive.Field("fibres_before", fibres_before);
}

Traction PlanTraction(const TractionGoal& goal) {
  Traction traction;
  traction.most = goal.most;
  traction.most_pull = goal.is_flap_held ? kMostFreePull : kMostTiedPull;
  traction.enough_pull = traction.most_pull * (goal.is_flap_held ? kEnoughFree : kEnoughTied);
  traction.fibres_before = goal.fibres;
  if (goal.most <= 0.0) return traction;
  const Vec3& aside = goal.aside;
  std::vector<Vec3> sides = {Vec3{}, aside, -1.0 * aside, goal.axis};
  // what is free goes to the sides first: off the bed it would stay before the hook
  if (goal.is_flap_held) sides = {2.0 * aside, -2.0 * aside, Vec3{}, aside, -1.0 * aside};
  for (const Vec3& side : sides) traction.ways.push_back(math::Normalized(goal.way + kSwing * side));
  traction.swings_left = static_cast<int>(traction.ways.size());
  return traction;
}

bool TakeUpSlack(Traction& traction, HandMotion& hand, const HeldTissue& held, double parted,
                 double seconds) {
  if (traction.ways.empty() || !held.is_grasping) return false;
  if (hand.IsMoving()) return true;
  const double pull = math::Norm(held.force);
  const double drawn_before = traction.drawn;
  const double wanted_way = std::min(traction.most, std::max(traction.most * parted, kPeelRate * seconds));
  if (pull > traction.most_pull) {
    traction.drawn = std::max(-kMostEase, traction.drawn - kEase);
  } else if (pull < traction.enough_pull) {
    traction.drawn = std::min(wanted_way, traction.drawn + kEase);
  }
  const Vec3 wanted = FindDrawn(traction);
  if (math::Distance(wanted, hand.Tip()) > kSettled) hand.MoveTo(wanted, kDrawHurry);
  return traction.drawn > drawn_before;
}

void BeginSwing(Traction& traction, HandMotion& hand, std::size_t left) {
  --traction.swings_left;
  ++traction.way;
  traction.drawn = std::max(kSwingShare * traction.drawn, kLeastSwing);
  traction.seconds = 0;
  traction.fibres_before = left;
  traction.is_swinging = true;
  hand.MoveTo(FindDrawn(traction), kSwingHurry);
}

void GoOnSwinging(Traction& traction, HandMotion& hand, const HeldTissue& held) {
  const bool pulls = math::Norm(held.force) > kMostSwingPull * traction.most_pull;
  if (pulls) hand.MoveTo(hand.Tip());
  traction.is_swinging = hand.IsMoving() && !pulls;
}

}  // namespace trocar::agent
