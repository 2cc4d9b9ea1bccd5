// SPDX-License-Identifier: Apache-2.0
#include "hook_planner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "fibre_choice.h"
#include "state_fields.h"
#include "trocar/instrument/camera.h"

namespace trocar::agent {

using instrument::IsInView;
using math::Vec3;

namespace {

constexpr double kPatience = 4.0;   // for one fibre [s]
constexpr double kMostForce = 2.0;  // that the hook may feel [N]
constexpr double kBackWay = 0.015;  // from what is in its way [m]
constexpr double kBackSeconds = 0.4;
/// A fibre is gone to directly from so near, else from so far above [m].
constexpr double kNextTo = 0.010, kAbove = 0.022;
constexpr double kApart = 0.6;  // beside a fibre, after which the hook turns back [s]
/// A hook that is pushed aside is led by so much of the gap in each tick, up to so far [m].
constexpr double kFollow = 0.2, kMostAside = 0.004;
constexpr double kTipClear = 0.0055;  // of the hook's tip from a main duct, for current [m]
constexpr double kSeen = 0.95;  // of the picture's width: no pedal is pressed for what lies outside of it
/// Current is for the fibre on the hook: what it does not part soon goes into the wall behind. Of one fibre at a time,
/// and of one place until it is left alone [s].
constexpr double kMostHeat = 0.25, kHot = 0.40;
/// With fewer fibres parted in so long, the other hand swings elsewhere [s].
constexpr std::size_t kHardly = 4;
constexpr double kSlowSeconds = 12.0;
/// So few fibres, where the hook does not come to them, are parted by the other hand's pull.
constexpr std::size_t kLastFibres = 10;
/// Share parted after which all is tried again, while there is something to do and when there is not [-].
constexpr double kMoreParted = 0.03, kLittleParted = 0.004;

/// Draws the hook back along its shaft.
void BackOff(HandMotion& hook) {
  hook.MoveTo(hook.BehindTip(kBackWay));
}

/// Takes the hook to a fibre: what is far is gone to from above, not through what lies between.
void Approach(HookTarget& target, HandMotion& hook, const Vec3& tip) {
  if (math::Distance(hook.Tip(), tip) > kNextTo) {
    const auto above = [&](const Vec3& p) { return p + kAbove * math::Normalized(hook.Port() - p); };
    target.path = {above(hook.Tip()), above(tip)};
  }
  target.path.push_back(tip);
  hook.Turn(target.spin);
  hook.MoveTo(target.path.front());
  target.path.pop_front();
}

/// Whether current may flow where the hook is.
bool MayBurn(const HookField& field) {
  const Vec3& tip = field.X_world_hook.translation;
  return field.EntryDistance(field.Wire()) > kEntryClear &&
         std::none_of(field.main_ducts.begin(), field.main_ducts.end(), [&](std::uint32_t node) {
           return math::Distance(field.positions[node], tip) < kTipClear;
         });
}

/// Goes to the fibre, and presses the pedal while it lies on the hook.
void WorkOnFibre(const HookField& field, Dissection& work, HeatMemory& heat, HandMotion& hook,
                 bool& coagulate) {
  HookTarget& target = work.target;
  const auto fibre = static_cast<std::size_t>(target.fibre);
  const std::uint32_t strand = work.goal.strands[fibre];
  const auto give_up = [&] {
    ++work.attempts[fibre];
    LeaveFibre(work, coagulate);
  };
  target.seconds += field.dt;
  if (!field.IsIntact(strand)) return LeaveFibre(work, coagulate);
  if (target.seconds > kPatience) return give_up();
  if (math::Norm(field.hook_force) > kMostForce) {
    // something is in the way: out again, and another time
    give_up();
    work.backing_off = kBackSeconds;
    BackOff(hook);
    return;
  }
  if (hook.IsMoving() && !coagulate) return;
  if (!target.path.empty()) {
    hook.MoveTo(target.path.front());
    target.path.pop_front();
    target.seconds = 0;
    return;
  }
  const collision::SegmentSegmentPoints gap = field.Gap(strand);
  const double distance = std::sqrt(gap.squared_distance);
  const bool is_seen =
      IsInView(field.X_world_lens, kSeen * field.field_of_view, field.X_world_hook.translation);
  const bool is_clear = MayBurn(field);
  coagulate = distance < kOnHook && is_seen && is_clear;
  if (coagulate) {
    heat.Add(gap.on_a, field.dt);
    target.heated += field.dt;
  } else {
    target.apart += field.dt;
  }
  if (target.heated > kMostHeat || heat.At(gap.on_a) > kHot || !is_clear || target.apart > kApart)
    return give_up();
  if (distance < 0.5 * kOnHook) return;
  // the fibre has moved on, or the hand is pushed aside
  target.aside += kFollow * (gap.on_b - gap.on_a);
  const double aside = math::Norm(target.aside);
  if (aside > kMostAside) target.aside *= kMostAside / aside;
  hook.MoveTo(field.Stand(hook, strand, target.spin) + target.aside);
}

/// Takes what is held elsewhere; the hook is out of the way meanwhile.
void Swing(Dissection& work, const DissectingHands& hands) {
  LeaveFibre(work, hands.coagulate);
  std::fill(work.attempts.begin(), work.attempts.end(), std::uint8_t{0});
  BeginSwing(work.traction, hands.hold, work.left);
  BackOff(hands.hook);
}

}  // namespace

void HookTarget::VisitState(base::StateArchive& archive) {
  archive.Field("fibre", fibre);
  archive.Field("spin", spin);
  VisitQueue(archive, "path", path);
  archive.Field("aside", aside);
  archive.Field("seconds", seconds);
  archive.Field("apart", apart);
  archive.Field("heated", heated);
}

void Dissection::VisitState(base::StateArchive& archive) {
  archive.Field("goal", goal);
  archive.Field("attempts", attempts);
  archive.Field("left", left);
  archive.Field("parted_at_reset", parted_at_reset);
  archive.Field("target", target);
  archive.Field("traction", traction);
  archive.Field("waits", waits);
  archive.Field("is_bold", is_bold);
  archive.Field("backing_off", backing_off);
  archive.Field("holds_left", holds_left);
}

void LeaveFibre(Dissection& work, bool& coagulate) {
  coagulate = false;
  work.target = {};
}

Dissection PlanDissection(DissectionGoal goal, const Vec3& axis, const Vec3& aside) {
  Dissection work;
  work.attempts.assign(goal.strands.size(), 0);
  work.traction =
      PlanTraction({goal.traction, goal.way, goal.IsFlapHeld(), goal.strands.size(), axis, aside});
  work.goal = std::move(goal);
  return work;
}

bool StepDissection(const HookField& field, Dissection& work, HeatMemory& heat, double seconds,
                    const DissectingHands& hands) {
  Traction& traction = work.traction;
  heat.Cool(field.dt);
  traction.seconds += field.dt;
  if (work.backing_off > 0.0) {
    work.backing_off -= field.dt;
    return false;
  }
  if (traction.is_swinging) {
    GoOnSwinging(traction, hands.hold, field.held);
    return false;
  }
  if (work.target.fibre >= 0) WorkOnFibre(field, work, heat, hands.hook, hands.coagulate);
  if (work.target.fibre >= 0 || work.backing_off > 0.0) return false;
  double parted = ChooseFibre(field, work, heat, hands.hook);
  // what could not be reached may be, now that more has given way
  if (parted > work.parted_at_reset + (work.target.fibre < 0 ? kLittleParted : kMoreParted)) {
    std::fill(work.attempts.begin(), work.attempts.end(), std::uint8_t{0});
    work.parted_at_reset = parted;
    parted = ChooseFibre(field, work, heat, hands.hook);
  }
  const bool is_drawing = TakeUpSlack(traction, hands.hold, field.held, parted, seconds);
  const bool is_over = traction.seconds > kSlowSeconds;
  const bool is_slow = is_over && traction.fibres_before - work.left < kHardly;
  const bool is_stuck = (work.target.fibre < 0 && !work.waits) || is_slow;
  const bool has_tried = is_stuck && traction.swings_left == 0;
  const bool is_enough = parted >= work.goal.enough || field.is_reached(work.goal);
  if (!is_enough && is_stuck && is_drawing && work.goal.IsFlapHeld() && work.left <= kLastFibres) {
    LeaveFibre(work, hands.coagulate);
    return false;
  }
  if (is_enough || (has_tried && (work.is_bold || traction.ways.empty()))) {
    LeaveFibre(work, hands.coagulate);
    return true;
  }
  if (has_tried || (is_over && !is_stuck)) {
    work.is_bold = work.is_bold || has_tried;
    traction.swings_left = static_cast<int>(traction.ways.size());
  }
  if (is_stuck) {
    Swing(work, hands);
    return false;
  }
  if (is_over) {
    traction.seconds = 0;
    traction.fibres_before = work.left;
  }
  // else until a place has cooled
  if (work.target.fibre >= 0) {
    const std::uint32_t strand = work.goal.strands[static_cast<std::size_t>(work.target.fibre)];
    Approach(work.target, hands.hook, field.Stand(hands.hook, strand, work.target.spin));
  }
  return false;
}

}  // namespace trocar::agent
