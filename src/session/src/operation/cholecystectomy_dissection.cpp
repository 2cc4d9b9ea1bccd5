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
constexpr double kBlocked = 0.7;      // after which a hook that does not get there turns back [s]

}  // namespace

/// Where the tip stands when the middle of the hook's toe is at a point.
Vec3 CholecystectomySurgeon::HookTip(const Vec3& at) const {
  const HandMotion& hand = hands_[kRight];
  const Pose X =
      instrument::CalcToolPose(hand.Port(), instrument::FindJoints(hand.Port(), at, hand.Spin(), 0.0));
  return at - math::Rotate(X.rotation, {0, 0.00225, 0});
}

void CholecystectomySurgeon::Dissect(const std::string& what, std::vector<std::uint32_t> strands,
                                     std::vector<double> order, double enough, double traction) {
  auto work = std::make_shared<Dissection>();
  work->attempts.assign(strands.size(), 0);
  work->strands = std::move(strands);
  work->order = std::move(order);
  work->enough = enough;
  work->traction = traction;
  Add(
      "dissect " + what, [this, work](const Snapshot&) { work->p_hold = HandOf(kLeft).Tip(); },
      [this, work](const Snapshot& seen) { return GoOnDissecting(*work, seen); }, 1200.0);
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
    work.seconds = work.blocked = 0;
  };
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
        pedals.coagulate = is_there;
        work.blocked = is_there ? 0.0 : work.blocked + scene_->tick_seconds;
        if (work.blocked > kBlocked || (!is_there && work.seconds > kPatience)) {
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
      // what is stretched lies open
      const StrandInfo& strand = strands_[work.strands[i]];
      const double stretch = math::Distance(seen.positions[strand.a], seen.positions[strand.b]) -
                             math::Distance(rest_[strand.a], rest_[strand.b]);
      const double cost = work.order[i] + math::Distance(middle(work.strands[i]), HandOf(kRight).Tip()) +
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
  // the other hand takes up the slack
  if (work.traction > 0.0 && !HandOf(kLeft).IsMoving() && seen.instruments[kLeft].is_grasping) {
    const double drawn = std::min(work.traction, std::max(work.traction * parted, kPeelRate * act_seconds_));
    const Vec3 wanted = work.p_hold + drawn * bed_normal_;
    if (math::Distance(wanted, HandOf(kLeft).Tip()) > 0.002) HandOf(kLeft).MoveTo(wanted, 0.2);
  }
  if (work.target < 0 || parted >= work.enough) {
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
