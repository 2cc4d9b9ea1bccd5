// SPDX-License-Identifier: Apache-2.0
#include "fibre_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tool_alignment.h"
#include "trocar/instrument/tool.h"

namespace trocar::agent {

using math::Vec3;

namespace {

constexpr std::uint8_t kMostAttempts = 3, kBoldAttempts = 1;
/// What a fibre costs before others [m]: by its stretch, the way to it, each attempt that failed, and where the shaft
/// cannot come to it freely.
constexpr double kOpenShare = 6.0, kFarCost = 1.5, kAttemptCost = 0.02, kHiddenCost = 0.06;
/// The shaft's way is looked at from the first to the second distance from the tip; so far from organs it is free [m].
constexpr double kWayFrom = 0.009, kWayTo = 0.07, kShaftClear = 0.0045;
constexpr double kHidden = 0.0015;      // what the shaft cannot pass by so far is not tried [m]
constexpr int kSpins = 8;               // ways to turn the hook about its shaft
constexpr double kEndWorth = 3.0;       // of what the wire is off duct and artery, likewise [-]
constexpr double kTurnCost = 0.0004;    // of such a turn, against what the shaft passes by [m/rad]
constexpr std::size_t kShortList = 32;  // fibres whose way is looked at
/// No current flows this near to a main duct, and to an artery that must stay or a small duct of the bed [m].
constexpr double kMainClear = 0.0060, kCarefulClear = 0.0035;
constexpr double kWarm = 0.20;  // of current that has flowed at a place, when it may be gone on with [s]

/// How the hook comes to a fibre.
struct HookWay {
  double spin = 0;   // of the hook [rad]
  double clear = 0;  // that the shaft passes by organs [m]
};

/// How the hook is turned so that its toe reaches under what hides a point, and its shaft passes by.
HookWay FindWay(const HookField& field, const HandMotion& hook, const Vec3& at) {
  const Vec3 out = math::Normalized(hook.Port() - at);
  const double toe_length = math::Distance(instrument::kHookToe.a, instrument::kHookToe.b);
  HookWay best;
  double best_worth = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < kSpins; ++k) {
    const double spin = k * 2.0 * M_PI / kSpins;
    const Vec3 toe = HookToe(hook.Port(), at, spin);
    const Vec3 tip = at - kOnToe * toe;
    const double clear = std::min(kShaftClear, field.clearance({tip + kWayFrom * out, tip + kWayTo * out}));
    // the wire lies away from where duct and artery enter
    const double off = std::min(kEntryFar, field.EntryDistance({tip, tip + toe_length * toe}));
    const double worth =
        clear + kEndWorth * off - kTurnCost * std::fabs(std::remainder(spin - hook.Spin(), 2.0 * M_PI));
    if (worth <= best_worth) continue;
    best_worth = worth;
    best = {spin, clear};
  }
  return best;
}

/// What taking a fibre costs: fibres that are stretched and near come first [m].
double CalcCost(const HookField& field, const Dissection& work, const HandMotion& hook, std::size_t fibre,
                const Vec3& at) {
  const scene::StrandInfo& strand = field.strands[work.goal.strands[fibre]];
  const double stretch = math::Distance(field.positions[strand.a], field.positions[strand.b]) -
                         math::Distance(field.rest[strand.a], field.rest[strand.b]);
  const Vec3 out = math::Normalized(hook.Port() - at);
  const double way = std::min(kShaftClear, field.clearance({at + kWayFrom * out, at + kWayTo * out}));
  return work.goal.order[fibre] + kFarCost * math::Distance(at, hook.Tip()) +
         kAttemptCost * work.attempts[fibre] + kHiddenCost * (1.0 - way / kShaftClear) - kOpenShare * stretch;
}

}  // namespace

double ChooseFibre(const HookField& field, Dissection& work, const HeatMemory& heat, const HandMotion& hook) {
  const std::vector<std::uint32_t>& strands = work.goal.strands;
  std::vector<std::pair<double, std::size_t>> list;  // by what they cost, without the turns of the hook
  work.target = {};
  work.left = 0;
  work.waits = false;
  for (std::size_t i = 0; i < strands.size(); ++i) {
    if (!field.IsIntact(strands[i])) continue;
    ++work.left;
    if (work.attempts[i] >= (work.is_bold ? kBoldAttempts : kMostAttempts)) continue;
    const Vec3 at = field.HookedPoint(strands[i]);
    const auto is_near = [&](std::span<const std::uint32_t> nodes, double clear) {
      return std::any_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) {
        return math::SquaredDistance(field.positions[node], at) < clear * clear;
      });
    };
    if (is_near(field.main_ducts, kMainClear) || is_near(field.careful_nodes, kCarefulClear)) continue;
    if (field.EntryDistance({at, at}) < kEntryClear) continue;
    if (heat.At(at) > kWarm) {
      work.waits = true;
      continue;
    }
    if (field.Gap(strands[i]).squared_distance < kOnHook * kOnHook) {
      // what lies on the hook already is next
      work.target.fibre = static_cast<std::int32_t>(i);
      work.target.spin = hook.Spin();
      continue;
    }
    list.emplace_back(CalcCost(field, work, hook, i, at), i);
  }
  std::sort(list.begin(), list.end());
  for (std::size_t k = 0; k < std::min(list.size(), kShortList) && work.target.fibre < 0; ++k) {
    const std::size_t i = list[k].second;
    const HookWay way = FindWay(field, hook, field.HookedPoint(strands[i]));
    // a swing of the other hand may open it
    if (way.clear < kHidden && !work.traction.ways.empty() && !work.is_bold) continue;
    work.target.fibre = static_cast<std::int32_t>(i);
    work.target.spin = way.spin;
  }
  return 1.0 - static_cast<double>(work.left) / static_cast<double>(std::max<std::size_t>(1, strands.size()));
}

}  // namespace trocar::agent
