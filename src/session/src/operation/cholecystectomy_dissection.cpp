// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "cholecystectomy_surgeon.h"
#include "trocar/surgery/blade.h"

namespace trocar::session {
namespace {

constexpr double kPatience = 4.0;  // for one fibre [s]
constexpr std::uint8_t kMostAttempts = 3;
constexpr double kOpenShare = 6.0;    // how much sooner a fibre is taken that is stretched, by its stretch
constexpr double kPeelRate = 0.0012;  // of the hand that draws the gallbladder off its bed [m/s]
constexpr double kMostForce = 2.0;    // that the hook may feel [N]
constexpr double kBackWay = 0.015;    // from what is in its way [m]
constexpr double kBackSeconds = 0.4;
/// A fibre that the shaft cannot come to freely is taken by so much later [m]; the way is looked at from the first to
/// the second distance from the tip.
constexpr double kHiddenCost = 0.06, kWayFrom = 0.009, kWayTo = 0.07, kShaftClear = 0.0045;
constexpr double kFarCost = 1.5;        // of the way of the tip to a fibre [-]
constexpr double kHidden = 0.0015;      // what the shaft cannot pass by so far is not tried [m]
constexpr double kOnToe = 0.0030;       // of the hook's toe, from the tip to where a fibre lies on it [m]
constexpr int kSpins = 8;               // ways to turn the hook about its shaft
constexpr double kTurnCost = 0.0004;    // of such a turn, against what the shaft passes by [m/rad]
constexpr std::size_t kShortList = 32;  // fibres whose way is looked at
constexpr double kSwungSeconds = 12.0;  // with hardly a fibre parted: the other hand swings elsewhere [s]
constexpr std::size_t kHardly = 4;      // fibres
constexpr double kSwingShare = 0.7;     // of what was drawn [-]
constexpr double kLeastSwing = 0.012;   // [m]
constexpr double kSwing = 0.6;          // of the way to a side, beside the way off the bed [-]
/// A fibre this near to the wire is on the hook [m]; after so long beside it the hook turns back [s].
constexpr double kOnHook = 0.0009, kApart = 0.6;
/// A hook that is pushed aside is led by so much of the gap in each tick, up to so far [m].
constexpr double kFollow = 0.2, kMostAside = 0.004;
/// No current flows this near to a main duct, and to an artery that must stay or a small duct of the bed [m].
constexpr double kMainClear = 0.0060, kCarefulClear = 0.0035, kTipClear = 0.0055;
constexpr double kSeen = 0.95;  // of the picture's width: nobody presses a pedal for what is out of it
/// Pull of the other hand, above which it gives way, while ducts are whole and after: it draws on below a share of that
/// [N], by so much at a time [m].
constexpr double kMostTiedPull = 7.0, kMostFreePull = 11.0, kEnoughShare = 0.6, kEase = 0.003,
                 kMostEase = 0.015;
/// Current is for the fibre on the hook: what it does not part soon goes into the wall behind. Of one fibre at a time,
/// of one place until it is left alone, and what is left of it when it may be gone on with [s].
constexpr double kMostHeat = 0.25, kHot = 0.40, kWarm = 0.20;
constexpr double kCools = 6.0,
                 kWarmReach = 0.0025;  // a place forgets its heat [s], and how far it reaches [m]
constexpr double kNextTo = 0.010,
                 kAbove = 0.022;  // a fibre that is gone to directly, else from so far above [m]
constexpr double kSlipped = 0.5;  // after which the other hand takes hold anew [s]

}  // namespace

/// Where the tip stands when the middle of the hook's toe is at a point.
Vec3 CholecystectomySurgeon::HookTip(const Vec3& at) const {
  return at - 0.00225 * HookToe(at, hands_[kRight].Spin());
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
  HookWay best;
  double best_worth = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < kSpins; ++k) {
    const double spin = k * 2.0 * M_PI / kSpins;
    const Vec3 tip = at - kOnToe * HookToe(at, spin);
    const double clear = std::min(kShaftClear, Clearance(seen, {tip + kWayFrom * out, tip + kWayTo * out}));
    const double worth = clear - kTurnCost * std::fabs(std::remainder(spin - hand.Spin(), 2.0 * M_PI));
    if (worth <= best_worth) continue;
    best_worth = worth;
    best = {spin, clear};
  }
  return best;
}

void CholecystectomySurgeon::Dissect(const std::string& what, std::vector<std::uint32_t> strands,
                                     std::vector<double> order, double enough, double traction,
                                     std::function<bool(const Snapshot&)> is_enough, const Vec3& way,
                                     const Nodes& may_hold) {
  auto work = std::make_shared<Dissection>();
  work->attempts.assign(strands.size(), 0);
  work->strands = std::move(strands);
  work->order = std::move(order);
  work->enough = enough;
  work->traction = traction;
  work->left_at_swing = work->strands.size();
  if (traction > 0.0) {
    const Vec3 axis = math::Normalized(rest_[fundus_] - rest_[neck_]);
    const Vec3 aside = math::Normalized(math::Cross(bed_normal_, axis));
    // what is free is drawn to the sides first: off the bed it would stay before the hook
    std::vector<Vec3> sides = {Vec3{}, aside, -1.0 * aside, axis};
    if (may_hold) sides = {2.0 * aside, -2.0 * aside, Vec3{}, aside, -1.0 * aside};
    for (const Vec3& side : sides) work->ways.push_back(math::Normalized(way + kSwing * side));
    work->swings_left = static_cast<int>(work->ways.size());
  }
  work->what = what;
  work->may_hold = may_hold;
  work->most_pull = may_hold ? kMostFreePull : kMostTiedPull;
  work->is_enough = std::move(is_enough);
  GoOn(std::move(work));
}

void CholecystectomySurgeon::GoOn(std::shared_ptr<Dissection> work) {
  Add(
      "dissect " + work->what,
      [this, work](const Snapshot&) {
        work->p_hold = HandOf(kLeft).Tip();
        work->drawn = 0;
        work->looked_at = 0;
        unheld_seconds_ = 0;
      },
      [this, work](const Snapshot& seen) {
        unheld_seconds_ = seen.instruments[kLeft].is_grasping ? 0.0 : unheld_seconds_ + scene_->tick_seconds;
        if (unheld_seconds_ > kSlipped && work->holds_left > 0) {
          --work->holds_left;
          controls_[kRight].coagulate = false;
          work->target = -1;
          std::swap(acts_, inserted_);
          HoldOn([this](const Snapshot& now) { return HookPoint(now); }, kHoldTries, work->may_hold);
          GoOn(work);
          std::swap(acts_, inserted_);
          return true;
        }
        return GoOnDissecting(*work, seen);
      },
      1200.0);
}

/// Where the right hand's tip is.
Vec3 CholecystectomySurgeon::HookPoint(const Snapshot& seen) const {
  return seen.instruments[kRight].X_world_tool.translation;
}

collision::SegmentSegmentPoints CholecystectomySurgeon::HookGap(const Snapshot& seen,
                                                                std::uint32_t strand) const {
  const Pose& X = seen.instruments[kRight].X_world_tool;
  const surgery::BladeSettings blade;
  return collision::FindNearestSegmentSegment(
      {X * blade.p_tool_hook.a, X * blade.p_tool_hook.b},
      {seen.positions[strands_[strand].a], seen.positions[strands_[strand].b]});
}

/// Current that has flowed about a place and is not forgotten yet [s].
double CholecystectomySurgeon::WarmthAt(const Vec3& p) const {
  double sum = 0;
  for (const Warmth& warmth : warmths_) {
    if (math::Distance(warmth.place, p) < kWarmReach) sum += warmth.seconds;
  }
  return sum;
}

void CholecystectomySurgeon::Warm(const Vec3& p) {
  const auto near = std::find_if(warmths_.begin(), warmths_.end(), [&](const Warmth& warmth) {
    return math::Distance(warmth.place, p) < 0.3 * kWarmReach;
  });
  if (near == warmths_.end()) {
    warmths_.push_back({p, scene_->tick_seconds});
  } else {
    near->seconds += scene_->tick_seconds;
  }
}

void CholecystectomySurgeon::Cool() {
  const double share = std::exp(-scene_->tick_seconds / kCools);
  for (Warmth& warmth : warmths_) warmth.seconds *= share;
  std::erase_if(warmths_, [](const Warmth& warmth) { return warmth.seconds < 0.002; });
}

Vec3 CholecystectomySurgeon::MiddleOf(const Snapshot& seen, std::uint32_t strand) const {
  return 0.5 * (seen.positions[strands_[strand].a] + seen.positions[strands_[strand].b]);
}

void CholecystectomySurgeon::LeaveFibre(Dissection& work) {
  controls_[kRight].coagulate = false;
  work.target = -1;
  work.seconds = work.apart = work.heated = 0;
  work.aside = {};
  work.path.clear();
}

/// The fibre on the hook, or before it: lifts it onto the wire, and presses the pedal while it lies there.
void CholecystectomySurgeon::WorkOnFibre(Dissection& work, const Snapshot& seen) {
  const auto target = static_cast<std::size_t>(work.target);
  const std::uint32_t strand = work.strands[target];
  bool& coagulate = controls_[kRight].coagulate;
  const auto give_up = [&] {
    ++work.attempts[target];
    LeaveFibre(work);
  };
  work.seconds += scene_->tick_seconds;
  if (seen.operation.strand_is_intact[strand] == 0) return LeaveFibre(work);
  if (work.seconds > kPatience) return give_up();
  if (math::Norm(seen.instruments[kRight].force) > kMostForce) {
    // something is in the way: out again, and another time
    give_up();
    work.backing_off = kBackSeconds;
    const Vec3 tip = HandOf(kRight).Tip();
    HandOf(kRight).MoveTo(tip + kBackWay * math::Normalized(HandOf(kRight).Port() - tip));
    return;
  }
  if (HandOf(kRight).IsMoving() && !coagulate) return;
  if (!work.path.empty()) {
    HandOf(kRight).MoveTo(work.path.front());
    work.path.pop_front();
    work.seconds = 0;
    return;
  }
  const collision::SegmentSegmentPoints gap = HookGap(seen, strand);
  const double distance = std::sqrt(gap.squared_distance);
  const bool is_seen =
      IsInView(seen.X_world_laparoscope, kSeen * scene_->laparoscope.field_of_view, HookPoint(seen));
  const bool is_clear = std::none_of(main_ducts_.begin(), main_ducts_.end(), [&](std::uint32_t node) {
    return math::Distance(seen.positions[node], HookPoint(seen)) < kTipClear;
  });
  coagulate = distance < kOnHook && is_seen && is_clear;
  if (coagulate) {
    Warm(gap.on_a);
    work.heated += scene_->tick_seconds;
  } else {
    work.apart += scene_->tick_seconds;
  }
  if (work.heated > kMostHeat || WarmthAt(gap.on_a) > kHot || !is_clear || work.apart > kApart)
    return give_up();
  if (distance < 0.5 * kOnHook) return;
  // the fibre has moved on, or the hand is pushed aside
  work.aside += kFollow * (gap.on_b - gap.on_a);
  if (math::Norm(work.aside) > kMostAside) work.aside *= kMostAside / math::Norm(work.aside);
  const Vec3 at = MiddleOf(seen, strand);
  HandOf(kRight).MoveTo(at - kOnToe * HookToe(at, work.spin) + work.aside);
}

/// Chooses the fibre that lies open and near; work.target < 0 where none can be worked on.
/// \return share of the fibres that are parted [-]
double CholecystectomySurgeon::ChooseFibre(Dissection& work, const Snapshot& seen) {
  std::vector<std::pair<double, std::size_t>> list;  // by what they cost, without their way
  work.target = -1;
  work.left = 0;
  work.waits = false;
  for (std::size_t i = 0; i < work.strands.size(); ++i) {
    if (seen.operation.strand_is_intact[work.strands[i]] == 0) continue;
    ++work.left;
    if (work.attempts[i] >= (work.is_bold ? 1 : kMostAttempts)) continue;
    const Vec3 at = MiddleOf(seen, work.strands[i]);
    const auto is_near = [&](const std::vector<std::uint32_t>& nodes, double clear) {
      return std::any_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) {
        return math::SquaredDistance(seen.positions[node], at) < clear * clear;
      });
    };
    if (is_near(main_ducts_, kMainClear) || is_near(careful_nodes_, kCarefulClear)) continue;
    if (WarmthAt(at) > kWarm) {
      work.waits = true;
      continue;
    }
    // what lies on the hook already is next
    if (HookGap(seen, work.strands[i]).squared_distance < kOnHook * kOnHook) {
      work.target = static_cast<std::int32_t>(i);
      work.spin = HandOf(kRight).Spin();
      continue;
    }
    // what is stretched lies open
    const StrandInfo& strand = strands_[work.strands[i]];
    const double stretch = math::Distance(seen.positions[strand.a], seen.positions[strand.b]) -
                           math::Distance(rest_[strand.a], rest_[strand.b]);
    const Vec3 out = math::Normalized(HandOf(kRight).Port() - at);
    const double way = std::min(kShaftClear, Clearance(seen, {at + kWayFrom * out, at + kWayTo * out}));
    list.emplace_back(kHiddenCost * (1.0 - way / kShaftClear) + work.order[i] +
                          kFarCost * math::Distance(at, HandOf(kRight).Tip()) + 0.02 * work.attempts[i] -
                          kOpenShare * stretch,
                      i);
  }
  std::sort(list.begin(), list.end());
  for (std::size_t k = 0; k < list.size() && k < kShortList && work.target < 0; ++k) {
    const std::size_t i = list[k].second;
    const HookWay way = FindHookWay(seen, MiddleOf(seen, work.strands[i]));
    // a swing of the other hand may open it
    if (way.clear < kHidden && !work.ways.empty() && !work.is_bold) continue;
    work.target = static_cast<std::int32_t>(i);
    work.spin = way.spin;
  }
  return 1.0 -
         static_cast<double>(work.left) / static_cast<double>(std::max<std::size_t>(1, work.strands.size()));
}

/// The other hand draws on as the fibres part, as far as it feels no strong pull.
void CholecystectomySurgeon::TakeUpSlack(Dissection& work, const Snapshot& seen, double parted) {
  if (work.ways.empty() || HandOf(kLeft).IsMoving() || !seen.instruments[kLeft].is_grasping) return;
  const double pull = math::Norm(seen.instruments[kLeft].force);
  const double wish = std::min(work.traction, std::max(work.traction * parted, kPeelRate * act_seconds_));
  if (pull > work.most_pull) {
    work.drawn = std::max(-kMostEase, work.drawn - kEase);
  } else if (pull < kEnoughShare * work.most_pull) {
    work.drawn = std::min(wish, work.drawn + kEase);
  }
  const Vec3 wanted = work.p_hold + work.drawn * work.ways[work.way % work.ways.size()];
  if (math::Distance(wanted, HandOf(kLeft).Tip()) > 0.001) HandOf(kLeft).MoveTo(wanted, 0.2);
}

bool CholecystectomySurgeon::GoOnDissecting(Dissection& work, const Snapshot& seen) {
  Cool();
  if (work.backing_off > 0.0) {
    work.backing_off -= scene_->tick_seconds;
    return false;
  }
  if (work.is_swinging) {
    const bool pulls = math::Norm(seen.instruments[kLeft].force) > 1.3 * work.most_pull;
    if (pulls) HandOf(kLeft).MoveTo(HandOf(kLeft).Tip());
    work.is_swinging = HandOf(kLeft).IsMoving() && !pulls;
    return false;
  }
  if (work.target >= 0) WorkOnFibre(work, seen);
  if (work.target >= 0 || work.backing_off > 0.0) return false;
  double parted = ChooseFibre(work, seen);
  // what could not be reached may be, now that more has given way
  if (parted > work.parted_at_reset + (work.target < 0 ? 0.004 : 0.03)) {
    std::fill(work.attempts.begin(), work.attempts.end(), std::uint8_t{0});
    work.parted_at_reset = parted;
    parted = ChooseFibre(work, seen);
  }
  TakeUpSlack(work, seen, parted);
  const bool is_enough = parted >= work.enough || (work.is_enough && work.is_enough(seen));
  work.swung_seconds += act_seconds_ - work.looked_at;
  work.looked_at = act_seconds_;
  const bool is_stuck = work.target < 0 && !work.waits;
  const bool is_slow = work.swung_seconds > kSwungSeconds && work.left_at_swing - work.left < kHardly;
  const bool has_tried = (is_stuck || is_slow) && work.swings_left == 0;
  if (is_enough || (has_tried && (work.is_bold || work.ways.empty()))) {
    LeaveFibre(work);
    return true;
  }
  if (has_tried) {
    work.is_bold = true;
    work.swings_left = static_cast<int>(work.ways.size());
  }
  if (is_stuck || is_slow) {
    Swing(work);
    return false;
  }
  if (work.swung_seconds > kSwungSeconds) {
    work.swung_seconds = 0;
    work.left_at_swing = work.left;
    work.is_bold = false;
    work.swings_left = static_cast<int>(work.ways.size());
  }
  if (work.target < 0) return false;  // until a place has cooled
  const Vec3 at = MiddleOf(seen, work.strands[static_cast<std::size_t>(work.target)]);
  Approach(work, at - kOnToe * HookToe(at, work.spin));
  return false;
}

/// Takes the hook to a fibre: what is far is gone to from above, not through what lies between.
void CholecystectomySurgeon::Approach(Dissection& work, const Vec3& tip) {
  const HandMotion& hand = HandOf(kRight);
  work.path.clear();
  if (math::Distance(hand.Tip(), tip) > kNextTo) {
    const auto above = [&](const Vec3& p) { return p + kAbove * math::Normalized(hand.Port() - p); };
    work.path = {above(hand.Tip()), above(tip)};
  }
  work.path.push_back(tip);
  HandOf(kRight).Turn(work.spin);
  HandOf(kRight).MoveTo(work.path.front());
  work.path.pop_front();
}

/// The other hand swings what it holds elsewhere, which opens other fibres.
void CholecystectomySurgeon::Swing(Dissection& work) {
  LeaveFibre(work);
  --work.swings_left;
  ++work.way;
  work.drawn = std::max(kSwingShare * work.drawn, kLeastSwing);
  std::fill(work.attempts.begin(), work.attempts.end(), std::uint8_t{0});
  work.swung_seconds = 0;
  work.left_at_swing = work.left;
  HandOf(kLeft).MoveTo(work.p_hold + work.drawn * work.ways[work.way % work.ways.size()], 0.15);
  const Vec3 tip = HandOf(kRight).Tip();
  HandOf(kRight).MoveTo(tip + kBackWay * math::Normalized(HandOf(kRight).Port() - tip));
  work.is_swinging = true;
}

}  // namespace trocar::session
