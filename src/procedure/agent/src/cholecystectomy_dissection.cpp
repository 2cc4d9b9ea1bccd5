// SPDX-License-Identifier: Apache-2.0
// Sharp dissection: the hook goes from fibre to fibre, with current only while one lies on it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cholecystectomy_surgeon.h"

namespace trocar::agent {

using instrument::IsInView;
using instrument::kRight;
using math::Pose;
using math::Vec3;
using simulation::Snapshot;

namespace {

constexpr double kPatience = 4.0;  // for one fibre [s]
constexpr std::uint8_t kMostAttempts = 3, kBoldAttempts = 1;
constexpr double kMostForce = 2.0;  // that the hook may feel [N]
constexpr double kBackWay = 0.015;  // from what is in its way [m]
constexpr double kBackSeconds = 0.4;
/// What a fibre costs before others [m]: by its stretch, the way to it, each attempt that failed, and where the shaft
/// cannot come to it freely.
constexpr double kOpenShare = 6.0, kFarCost = 1.5, kAttemptCost = 0.02, kHiddenCost = 0.06;
/// The shaft's way is looked at from the first to the second distance from the tip; so far from organs it is free [m].
constexpr double kWayFrom = 0.009, kWayTo = 0.07, kShaftClear = 0.0045;
constexpr double kHidden = 0.0015;      // what the shaft cannot pass by so far is not tried [m]
constexpr double kOnToe = 0.0030;       // of the hook's toe, from the tip to where a fibre lies on it [m]
constexpr int kSpins = 8;               // ways to turn the hook about its shaft
constexpr double kEndWorth = 3.0;       // of what the wire is off duct and artery, likewise [-]
constexpr double kTurnCost = 0.0004;    // of such a turn, against what the shaft passes by [m/rad]
constexpr std::size_t kShortList = 32;  // fibres whose way is looked at
/// A fibre is gone to directly from so near, else from so far above [m].
constexpr double kNextTo = 0.010, kAbove = 0.022;
/// A fibre this near to the wire is on the hook [m]; after so long beside it the hook turns back [s].
constexpr double kOnHook = 0.0009, kApart = 0.6;
/// A hook that is pushed aside is led by so much of the gap in each tick, up to so far [m].
constexpr double kFollow = 0.2, kMostAside = 0.004;
/// No current flows this near to a main duct, and to an artery that must stay or a small duct of the bed [m].
constexpr double kMainClear = 0.0060, kCarefulClear = 0.0035, kTipClear = 0.0055;
/// Nor to where duct and artery enter the gallbladder while they are whole: there the current is weak already [m].
constexpr double kEndClear = 0.0008, kEndFar = 0.0020;
/// Shares of a fibre at which it is taken, the best first.
constexpr double kFibreShares[] = {0.5, 0.7, 0.3, 0.85, 0.15};
constexpr double kSeen = 0.95;  // of the picture's width: no pedal is pressed for what lies outside of it
/// Current is for the fibre on the hook: what it does not part soon goes into the wall behind. Of one fibre at a time,
/// of one place until it is left alone, and what is left of it when it may be gone on with [s].
constexpr double kMostHeat = 0.25, kHot = 0.40, kWarm = 0.20;
constexpr double kSlipped = 0.5;  // after which the other hand takes hold anew [s]
/// With fewer fibres parted in so long, the other hand swings elsewhere [s].
constexpr std::size_t kHardly = 4;
constexpr double kSlowSeconds = 12.0;
constexpr double kBedStep = 0.2;  // of the bed's fibres, after which the hold is chosen anew [-]
/// So few fibres, where the hook does not come to them, are parted by the other hand's pull.
constexpr std::size_t kLastFibres = 10;
/// Share parted after which all is tried again, while there is something to do and when there is not [-].
constexpr double kMoreParted = 0.03, kLittleParted = 0.004;

}  // namespace

/// Where the tip stands when the middle of the hook's toe is at a point.
Vec3 CholecystectomySurgeon::HookTip(const Vec3& at) const {
  const geometry::BladeEdge& toe = instrument::kHookToe;
  return at - 0.5 * math::Distance(toe.a, toe.b) * HookToe(at, hands_[kRight].Spin());
}

/// Unit vector along the hook's toe.
Vec3 CholecystectomySurgeon::HookToe(const Vec3& at, double spin) const {
  const Vec3& port = hands_[kRight].Port();
  return math::Rotate(instrument::CalcToolPose(port, instrument::FindJoints(port, at, spin, 0.0)).rotation,
                      {0, 1, 0});
}

/// How the hook is turned so that its toe reaches under what hides a point, and its shaft passes by.
CholecystectomySurgeon::HookWay CholecystectomySurgeon::FindHookWay(const Snapshot& seen, const Vec3& at) {
  const HandMotion& hand = hands_[kRight];
  const Vec3 out = math::Normalized(hand.Port() - at);
  const geometry::BladeEdge& toe = instrument::kHookToe;
  const double toe_length = math::Distance(toe.a, toe.b);
  HookWay best;
  double best_worth = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < kSpins; ++k) {
    const double spin = k * 2.0 * M_PI / kSpins;
    const Vec3 tip = at - kOnToe * HookToe(at, spin);
    const double clear = std::min(kShaftClear, Clearance(seen, {tip + kWayFrom * out, tip + kWayTo * out}));
    // the wire lies away from where duct and artery enter the gallbladder
    const double off = std::min(kEndFar, EndDistance(seen, {tip, tip + toe_length * HookToe(at, spin)}));
    const double worth =
        clear + kEndWorth * off - kTurnCost * std::fabs(std::remainder(spin - hand.Spin(), 2.0 * M_PI));
    if (worth <= best_worth) continue;
    best_worth = worth;
    best = {spin, clear};
  }
  return best;
}

/// Where the tip stands when a fibre lies on the toe.
Vec3 CholecystectomySurgeon::HookStand(const Snapshot& seen, std::uint32_t strand, double spin) const {
  const Vec3 at = HookedPoint(seen, strand);
  return at - kOnToe * HookToe(at, spin);
}

void CholecystectomySurgeon::Dissect(DissectionGoal goal) {
  dissection_ = {};
  dissection_.attempts.assign(goal.strands.size(), 0);
  dissection_.traction = PlanTraction(goal);
  dissection_.goal = std::move(goal);
  GoOn();
}

void CholecystectomySurgeon::GoOn() {
  Add(SurgeonAct::Kind::kDissect, "dissect " + dissection_.goal.what, 1200.0);
}

/// Goes on; when the left hand has slipped, it takes hold anew first.
bool CholecystectomySurgeon::GoOnOrHoldAnew(const Snapshot& seen) {
  unheld_seconds_ =
      seen.instruments[instrument::kLeft].is_grasping ? 0.0 : unheld_seconds_ + scene_->tick_seconds;
  if (unheld_seconds_ <= kSlipped || dissection_.holds_left <= 0) return GoOnDissecting(dissection_, seen);
  --dissection_.holds_left;
  LeaveFibre(dissection_);
  std::swap(acts_, inserted_);
  HoldOn(Place::Of(Place::Kind::kRightTip), kHoldTries, dissection_.goal.may);
  GoOn();
  std::swap(acts_, inserted_);
  return true;
}

bool CholecystectomySurgeon::IsEnough(const DissectionGoal& goal, const Snapshot& seen) const {
  switch (goal.until) {
    case DissectionGoal::Until::kParted:
      return false;
    case DissectionGoal::Until::kTriangleClear:
      return IsTriangleClear(seen);
    case DissectionGoal::Until::kLowerThirdFree:
      return seen.operation.critical_view.criteria[1] == 2;
    case DissectionGoal::Until::kBedStep:
      return ShareLeft(seen, goal.strands) < goal.left_before - kBedStep;
  }
  return false;
}

/// Where the right hand's tip is.
Vec3 CholecystectomySurgeon::HookPoint(const Snapshot& seen) const {
  return seen.instruments[kRight].X_world_tool.translation;
}

collision::Segment CholecystectomySurgeon::HookWire(const Snapshot& seen) const {
  const Pose& X = seen.instruments[kRight].X_world_tool;
  return {X * instrument::kHookToe.a, X * instrument::kHookToe.b};
}

collision::SegmentSegmentPoints CholecystectomySurgeon::HookGap(const Snapshot& seen,
                                                                std::uint32_t strand) const {
  return collision::FindNearestSegmentSegment(
      HookWire(seen), {seen.positions[known_.strands[strand].a], seen.positions[known_.strands[strand].b]});
}

/// Where the hook takes a fibre: in its middle, or farther from where duct and artery enter the gallbladder.
Vec3 CholecystectomySurgeon::HookedPoint(const Snapshot& seen, std::uint32_t strand) const {
  const Vec3 &a = seen.positions[known_.strands[strand].a], &b = seen.positions[known_.strands[strand].b];
  for (const double share : kFibreShares) {
    const Vec3 p = math::Lerp(a, b, share);
    if (EndDistance(seen, {p, p}) > kEndFar) return p;
  }
  return math::Lerp(a, b, kFibreShares[0]);
}

void CholecystectomySurgeon::LeaveFibre(Dissection& work) {
  controls_[kRight].coagulate = false;
  work.target = {};
}

/// Draws the hook back along its shaft.
void CholecystectomySurgeon::BackOff() {
  HandOf(kRight).MoveTo(HandOf(kRight).BehindTip(kBackWay));
}

/// Takes the hook to a fibre: what is far is gone to from above, not through what lies between.
void CholecystectomySurgeon::Approach(HookTarget& target, const Vec3& tip) {
  HandMotion& hand = HandOf(kRight);
  if (math::Distance(hand.Tip(), tip) > kNextTo) {
    const auto above = [&](const Vec3& p) { return p + kAbove * math::Normalized(hand.Port() - p); };
    target.path = {above(hand.Tip()), above(tip)};
  }
  target.path.push_back(tip);
  hand.Turn(target.spin);
  hand.MoveTo(target.path.front());
  target.path.pop_front();
}

/// Goes to the fibre, and presses the pedal while it lies on the hook.
void CholecystectomySurgeon::WorkOnFibre(Dissection& work, const Snapshot& seen) {
  HookTarget& target = work.target;
  const auto fibre = static_cast<std::size_t>(target.fibre);
  const std::uint32_t strand = work.goal.strands[fibre];
  HandMotion& hand = HandOf(kRight);
  bool& coagulate = controls_[kRight].coagulate;
  const auto give_up = [&] {
    ++work.attempts[fibre];
    LeaveFibre(work);
  };
  target.seconds += scene_->tick_seconds;
  if (seen.operation.strand_is_intact[strand] == 0) return LeaveFibre(work);
  if (target.seconds > kPatience) return give_up();
  if (math::Norm(seen.instruments[kRight].force) > kMostForce) {
    // something is in the way: out again, and another time
    give_up();
    work.backing_off = kBackSeconds;
    BackOff();
    return;
  }
  if (hand.IsMoving() && !coagulate) return;
  if (!target.path.empty()) {
    hand.MoveTo(target.path.front());
    target.path.pop_front();
    target.seconds = 0;
    return;
  }
  const collision::SegmentSegmentPoints gap = HookGap(seen, strand);
  const double distance = std::sqrt(gap.squared_distance);
  const double field_of_view = kSeen * scene_->laparoscope.field_of_view;
  const bool is_seen = IsInView(seen.X_world_laparoscope, field_of_view, HookPoint(seen));
  const bool is_clear =
      EndDistance(seen, HookWire(seen)) > kEndClear &&
      std::none_of(known_.main_ducts.begin(), known_.main_ducts.end(), [&](std::uint32_t node) {
        return math::Distance(seen.positions[node], HookPoint(seen)) < kTipClear;
      });
  coagulate = distance < kOnHook && is_seen && is_clear;
  if (coagulate) {
    heat_.Add(gap.on_a, scene_->tick_seconds);
    target.heated += scene_->tick_seconds;
  } else {
    target.apart += scene_->tick_seconds;
  }
  if (target.heated > kMostHeat || heat_.At(gap.on_a) > kHot || !is_clear || target.apart > kApart)
    return give_up();
  if (distance < 0.5 * kOnHook) return;
  // the fibre has moved on, or the hand is pushed aside
  target.aside += kFollow * (gap.on_b - gap.on_a);
  const double aside = math::Norm(target.aside);
  if (aside > kMostAside) target.aside *= kMostAside / aside;
  hand.MoveTo(HookStand(seen, strand, target.spin) + target.aside);
}

/// Chooses the fibre that lies open and near; none where none can be worked on.
/// \return share of the fibres that are parted [-]
double CholecystectomySurgeon::ChooseFibre(Dissection& work, const Snapshot& seen) {
  const std::vector<std::uint32_t>& strands = work.goal.strands;
  const Vec3 tip = HandOf(kRight).Tip();
  std::vector<std::pair<double, std::size_t>> list;  // by what they cost, without the turns of the hook
  work.target = {};
  work.left = 0;
  work.waits = false;
  for (std::size_t i = 0; i < strands.size(); ++i) {
    if (seen.operation.strand_is_intact[strands[i]] == 0) continue;
    ++work.left;
    if (work.attempts[i] >= (work.is_bold ? kBoldAttempts : kMostAttempts)) continue;
    const Vec3 at = HookedPoint(seen, strands[i]);
    const auto is_near = [&](const std::vector<std::uint32_t>& nodes, double clear) {
      return std::any_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) {
        return math::SquaredDistance(seen.positions[node], at) < clear * clear;
      });
    };
    if (is_near(known_.main_ducts, kMainClear) || is_near(known_.careful_nodes, kCarefulClear)) continue;
    if (EndDistance(seen, {at, at}) < kEndClear) continue;
    if (heat_.At(at) > kWarm) {
      work.waits = true;
      continue;
    }
    if (HookGap(seen, strands[i]).squared_distance < kOnHook * kOnHook) {
      // what lies on the hook already is next
      work.target.fibre = static_cast<std::int32_t>(i);
      work.target.spin = HandOf(kRight).Spin();
      continue;
    }
    // what is stretched lies open
    const scene::StrandInfo& strand = known_.strands[strands[i]];
    const double stretch = math::Distance(seen.positions[strand.a], seen.positions[strand.b]) -
                           math::Distance(known_.rest[strand.a], known_.rest[strand.b]);
    const Vec3 out = math::Normalized(HandOf(kRight).Port() - at);
    const double way = std::min(kShaftClear, Clearance(seen, {at + kWayFrom * out, at + kWayTo * out}));
    list.emplace_back(work.goal.order[i] + kFarCost * math::Distance(at, tip) +
                          kAttemptCost * work.attempts[i] + kHiddenCost * (1.0 - way / kShaftClear) -
                          kOpenShare * stretch,
                      i);
  }
  std::sort(list.begin(), list.end());
  for (std::size_t k = 0; k < std::min(list.size(), kShortList) && work.target.fibre < 0; ++k) {
    const std::size_t i = list[k].second;
    const HookWay way = FindHookWay(seen, HookedPoint(seen, strands[i]));
    // a swing of the other hand may open it
    if (way.clear < kHidden && !work.traction.ways.empty() && !work.is_bold) continue;
    work.target.fibre = static_cast<std::int32_t>(i);
    work.target.spin = way.spin;
  }
  return 1.0 - static_cast<double>(work.left) / static_cast<double>(std::max<std::size_t>(1, strands.size()));
}

bool CholecystectomySurgeon::GoOnDissecting(Dissection& work, const Snapshot& seen) {
  Traction& traction = work.traction;
  heat_.Cool(scene_->tick_seconds);
  traction.seconds += scene_->tick_seconds;
  if (work.backing_off > 0.0) {
    work.backing_off -= scene_->tick_seconds;
    return false;
  }
  if (traction.is_swinging) {
    GoOnSwinging(traction, seen);
    return false;
  }
  if (work.target.fibre >= 0) WorkOnFibre(work, seen);
  if (work.target.fibre >= 0 || work.backing_off > 0.0) return false;
  double parted = ChooseFibre(work, seen);
  // what could not be reached may be, now that more has given way
  if (parted > work.parted_at_reset + (work.target.fibre < 0 ? kLittleParted : kMoreParted)) {
    std::fill(work.attempts.begin(), work.attempts.end(), std::uint8_t{0});
    work.parted_at_reset = parted;
    parted = ChooseFibre(work, seen);
  }
  const bool is_drawing = TakeUpSlack(traction, seen, parted);
  const bool is_over = traction.seconds > kSlowSeconds;
  const bool is_slow = is_over && traction.fibres_before - work.left < kHardly;
  const bool is_stuck = (work.target.fibre < 0 && !work.waits) || is_slow;
  const bool has_tried = is_stuck && traction.swings_left == 0;
  const bool is_enough = parted >= work.goal.enough || IsEnough(work.goal, seen);
  if (!is_enough && is_stuck && is_drawing && work.goal.IsFlapHeld() && work.left <= kLastFibres) {
    LeaveFibre(work);
    return false;
  }
  if (is_enough || (has_tried && (work.is_bold || traction.ways.empty()))) {
    LeaveFibre(work);
    return true;
  }
  if (has_tried || (is_over && !is_stuck)) {
    work.is_bold = work.is_bold || has_tried;
    traction.swings_left = static_cast<int>(traction.ways.size());
  }
  if (is_stuck) {
    Swing(work);
    return false;
  }
  if (is_over) {
    traction.seconds = 0;
    traction.fibres_before = work.left;
  }
  // else until a place has cooled
  if (work.target.fibre >= 0) {
    const std::uint32_t strand = work.goal.strands[static_cast<std::size_t>(work.target.fibre)];
    Approach(work.target, HookStand(seen, strand, work.target.spin));
  }
  return false;
}

}  // namespace trocar::agent
