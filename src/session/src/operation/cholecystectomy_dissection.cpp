// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "cholecystectomy_surgeon.h"

namespace trocar::session {
namespace {

constexpr double kNear = 0.0025;   // the tip has come to where the hand wants it [m]
constexpr double kPatience = 1.2;  // for one fibre [s]
constexpr std::uint8_t kMostAttempts = 3;
constexpr double kOpenShare = 6.0;    // how much sooner a fibre is taken that is stretched, by its stretch
constexpr double kPeelRate = 0.0012;  // of the hand that draws the gallbladder off its bed [m/s]
constexpr double kMostForce = 2.0;    // that the hook may feel [N]
constexpr double kBackWay = 0.015;    // from what is in its way [m]
constexpr double kBackSeconds = 0.4;
/// A fibre that the shaft cannot come to freely is taken by so much later [m]; the way is looked at from the first to
/// the second distance from the tip.
constexpr double kHiddenCost = 0.06, kWayFrom = 0.009, kWayTo = 0.07, kShaftClear = 0.0045;
constexpr double kBlocked = 0.7;  // after which a hook that does not get there turns back [s]
/// No current flows this near to a main duct, and to an artery that must stay or a small duct of the bed [m].
constexpr double kMainClear = 0.0060, kCarefulClear = 0.0035, kTipClear = 0.0055;
/// Pull of the other hand: it draws on below the one, and gives way above the other [N], by so much at a time [m].
constexpr double kEnoughPull = 5.0, kMostPull = 8.0, kEase = 0.003, kMostEase = 0.015;
constexpr double kMostHeat = 1.0;  // of one fibre at a time [s]
constexpr double kSlipped = 0.5;   // after which the other hand takes hold anew [s]

}  // namespace

/// Where the tip stands when the middle of the hook's toe is at a point.
Vec3 CholecystectomySurgeon::HookTip(const Vec3& at) const {
  const HandMotion& hand = hands_[kRight];
  const Pose X =
      instrument::CalcToolPose(hand.Port(), instrument::FindJoints(hand.Port(), at, hand.Spin(), 0.0));
  return at - math::Rotate(X.rotation, {0, 0.00225, 0});
}

void CholecystectomySurgeon::Dissect(const std::string& what, std::vector<std::uint32_t> strands,
                                     std::vector<double> order, double enough, double traction,
                                     std::function<bool(const Snapshot&)> is_enough) {
  auto work = std::make_shared<Dissection>();
  work->attempts.assign(strands.size(), 0);
  work->strands = std::move(strands);
  work->order = std::move(order);
  work->enough = enough;
  work->traction = traction;
  work->what = what;
  work->is_enough = std::move(is_enough);
  GoOn(std::move(work));
}

void CholecystectomySurgeon::GoOn(std::shared_ptr<Dissection> work) {
  Add(
      "dissect " + work->what,
      [this, work](const Snapshot&) {
        work->p_hold = HandOf(kLeft).Tip();
        work->drawn = 0;
        unheld_seconds_ = 0;
      },
      [this, work](const Snapshot& seen) {
        unheld_seconds_ = seen.instruments[kLeft].is_grasping ? 0.0 : unheld_seconds_ + scene_->tick_seconds;
        if (unheld_seconds_ > kSlipped && work->holds_left > 0) {
          --work->holds_left;
          controls_[kRight].coagulate = false;
          work->target = -1;
          std::swap(acts_, inserted_);
          HoldOn([this](const Snapshot& now) { return HookPoint(now); });
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

bool CholecystectomySurgeon::GoOnDissecting(Dissection& work, const Snapshot& seen) {
  HandControls& pedals = controls_[kRight];
  const auto middle = [&](std::uint32_t strand) {
    return 0.5 * (seen.positions[strands_[strand].a] + seen.positions[strands_[strand].b]);
  };
  const auto is_intact = [&](std::uint32_t strand) { return seen.operation.strand_is_intact[strand] != 0; };
  const auto next = [&] {
    pedals.coagulate = false;
    work.target = -1;
    work.seconds = work.blocked = work.heated = 0;
  };
  // nobody presses a pedal for what is out of the picture
  const bool is_seen = IsInView(seen.X_world_laparoscope, scene_->laparoscope.field_of_view, HookPoint(seen));
  if (!is_seen) pedals.coagulate = false;
  if (work.backing_off > 0.0) {
    work.backing_off -= scene_->tick_seconds;
    return false;
  }
  if (work.target >= 0 && math::Norm(seen.instruments[kRight].force) > kMostForce) {
    // something is in the way: out again, and another time
    ++work.attempts[static_cast<std::size_t>(work.target)];
    next();
    work.backing_off = kBackSeconds;
    const Vec3 tip = HandOf(kRight).Tip();
    HandOf(kRight).MoveTo(tip + kBackWay * math::Normalized(HandOf(kRight).Port() - tip));
    return false;
  }
  if (work.target >= 0) {
    const std::uint32_t strand = work.strands[static_cast<std::size_t>(work.target)];
    work.seconds += scene_->tick_seconds;
    if (!is_intact(strand)) {
      next();
    } else if (work.seconds > kPatience + 2.0) {
      ++work.attempts[static_cast<std::size_t>(work.target)];
      next();
    } else {
      const Vec3 tip = HookTip(middle(strand));
      if (!HandOf(kRight).IsMoving()) {
        const bool is_there =
            math::Distance(seen.instruments[kRight].X_world_tool.translation, HandOf(kRight).Tip()) < kNear;
        // the fibre has moved on while the hand went there
        if (math::Distance(HandOf(kRight).Tip(), tip) > 0.0008) HandOf(kRight).MoveTo(tip);
        const bool is_clear = std::none_of(main_ducts_.begin(), main_ducts_.end(), [&](std::uint32_t node) {
          return math::Distance(seen.positions[node], HookPoint(seen)) < kTipClear;
        });
        pedals.coagulate = is_there && is_seen && is_clear;
        // what does not give way soon is not in the current: the wall behind it would burn
        work.heated += pedals.coagulate ? scene_->tick_seconds : 0.0;
        if (work.heated > kMostHeat) {
          ++work.attempts[static_cast<std::size_t>(work.target)];
          next();
          return false;
        }
        work.blocked = is_there ? 0.0 : work.blocked + scene_->tick_seconds;
        if (work.blocked > kBlocked || (is_there && !is_clear) || (!is_there && work.seconds > kPatience)) {
          ++work.attempts[static_cast<std::size_t>(work.target)];
          next();
        }
      }
    }
  }
  if (work.target >= 0) return false;
  std::size_t left = 0;
  const auto choose = [&] {
    left = 0;
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < work.strands.size(); ++i) {
      if (!is_intact(work.strands[i])) continue;
      ++left;
      if (work.attempts[i] >= kMostAttempts) continue;
      const auto is_near = [&](const std::vector<std::uint32_t>& nodes, double clear) {
        const Vec3 p = middle(work.strands[i]);
        return std::any_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) {
          return math::SquaredDistance(seen.positions[node], p) < clear * clear;
        });
      };
      if (is_near(main_ducts_, kMainClear) || is_near(careful_nodes_, kCarefulClear)) continue;
      // what is stretched lies open
      const StrandInfo& strand = strands_[work.strands[i]];
      const double stretch = math::Distance(seen.positions[strand.a], seen.positions[strand.b]) -
                             math::Distance(rest_[strand.a], rest_[strand.b]);
      const Vec3 at = middle(work.strands[i]), out = math::Normalized(HandOf(kRight).Port() - at);
      const double way = std::min(kShaftClear, Clearance(seen, {at + kWayFrom * out, at + kWayTo * out}));
      const double cost = kHiddenCost * (1.0 - way / kShaftClear) + work.order[i] +
                          math::Distance(middle(work.strands[i]), HandOf(kRight).Tip()) +
                          0.02 * work.attempts[i] - kOpenShare * stretch;
      if (cost >= best) continue;
      best = cost;
      work.target = static_cast<std::int32_t>(i);
    }
    return 1.0 -
           static_cast<double>(left) / static_cast<double>(std::max<std::size_t>(1, work.strands.size()));
  };
  double parted = choose();
  // what could not be reached may be, now that more has given way
  if (parted > work.parted_at_reset + (work.target < 0 ? 0.004 : 0.03)) {
    std::fill(work.attempts.begin(), work.attempts.end(), std::uint8_t{0});
    work.parted_at_reset = parted;
    parted = choose();
  }
  // the other hand takes up the slack, as far as it feels no strong pull
  const double pull = math::Norm(seen.instruments[kLeft].force);
  if (work.traction > 0.0 && !HandOf(kLeft).IsMoving() && seen.instruments[kLeft].is_grasping) {
    const double wish = std::min(work.traction, std::max(work.traction * parted, kPeelRate * act_seconds_));
    if (pull > kMostPull) {
      work.drawn = std::max(-kMostEase, work.drawn - kEase);
    } else if (pull < kEnoughPull) {
      work.drawn = std::min(wish, work.drawn + kEase);
    }
    const Vec3 wanted = work.p_hold + work.drawn * bed_normal_;
    if (math::Distance(wanted, HandOf(kLeft).Tip()) > 0.001) HandOf(kLeft).MoveTo(wanted, 0.2);
  }
  if (work.target < 0 || parted >= work.enough || (work.is_enough && work.is_enough(seen))) {
    next();
    return true;
  }
  // another try comes from another side
  constexpr double kSpins[] = {0.0, 1.3, -1.3};
  HandOf(kRight).Turn(kSpins[work.attempts[static_cast<std::size_t>(work.target)] % std::size(kSpins)]);
  HandOf(kRight).MoveTo(HookTip(middle(work.strands[static_cast<std::size_t>(work.target)])));
  return false;
}

}  // namespace trocar::session
