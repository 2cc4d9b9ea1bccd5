// SPDX-License-Identifier: Apache-2.0
// What careless surgeons do to tissue, each one thing and once.
#include <algorithm>

#include "task_surgeon.h"

namespace trocar::agent {

using math::Vec3;
using scene::Condition;
using scene::ConditionKind;
using scene::Task;

namespace {

constexpr double kStep = 0.001, kFarthest = 0.05;  // along a duct, in search of a wrong place [m]
constexpr double kInTheAir = 0.020;                // of an applier that closes on nothing, from the duct [m]
constexpr double kBesideLine = 0.005;              // of a cut, inwards [m]
constexpr double kShortCut = 0.12;                 // of a turn
constexpr double kAside = 0.005;                   // of a hook that burns in the air [m]
constexpr double kOutOfPicture = 0.16;             // sideways [m]
constexpr double kAtTheTips = 0.05;                // share of the jaws beyond a duct that is caught in part

}  // namespace

/// The nearest place on the duct that no goal asks for.
Vec3 TaskSurgeon::FindAstray(const Vec3& p_rest) const {
  const TissueSpot spot = FindOnTube(p_rest);
  const Vec3 along = math::Normalized(start_[spot.b] - start_[spot.a]);
  for (double way = kStep; way < kFarthest; way += kStep) {
    for (const double side : {+1.0, -1.0}) {
      const Vec3 p = p_rest + side * way * along;
      const auto& regions = scene_->task->regions;
      // clear of the next mark's edge, too
      const bool is_meant = std::any_of(regions.begin(), regions.end(), [&](const scene::Region& region) {
        return region.Contains(p) || region.Contains(p + kStep * along) || region.Contains(p - kStep * along);
      });
      if (!is_meant) return p;
    }
  }
  return p_rest;
}

/// Before a step. \return whether the plan now is to err
bool TaskSurgeon::AddTissueErrorScenario(const simulation::Snapshot& seen, const Condition& wanted) {
  const Task& task = *scene_->task;
  const auto centre_of = [&](const Condition& c) {
    return task.regions[static_cast<std::size_t>(c.regions.front())].centre;
  };
  const auto cut = [&](bool is_astray) {
    for (const scene::Goal& goal : task.goals) {
      for (const Condition& step : goal.steps) {
        if (step.kind != ConditionKind::kDivided) continue;
        return CutTube(seen, is_astray ? FindAstray(centre_of(step)) : centre_of(step));
      }
    }
  };
  switch (error_scenario_) {
    case ErrorScenario::kClipsAstray:
      CloseClip(seen, FindAstray(centre_of(wanted)), 0.5);
      break;
    case ErrorScenario::kCrossesClips:
      CloseClip(seen, centre_of(wanted), 0.5);
      CloseClip(seen, centre_of(wanted), 0.5);
      break;
    case ErrorScenario::kClipsPartly:
      CloseClip(seen, centre_of(wanted), kAtTheTips);
      break;
    case ErrorScenario::kDropsClip: {
      const int hand = TakeTool(seen, instrument::ToolKind::kClipApplier);
      const TissueSpot spot = FindOnTube(centre_of(wanted));
      LineUp(hand, spot, instrument::FindTool("clip_applier")->max_jaw);
      Advance(hand, spot, -kInTheAir);
      SetJaw("close the clip", hand, 0.0, 0.7);
      break;
    }
    case ErrorScenario::kCutsAstray:
      cut(true);
      break;
    case ErrorScenario::kCutsUnclipped:
      cut(false);
      break;
    case ErrorScenario::kBurnsSpared: {
      const auto& bands = scene_->model->bands;
      const auto is_wanted = [&](std::size_t band) {
        return std::any_of(task.goals.begin(), task.goals.end(), [&](const scene::Goal& goal) {
          return std::any_of(goal.steps.begin(), goal.steps.end(),
                             [&](const Condition& step) { return step.band == static_cast<int>(band); });
        });
      };
      for (std::size_t band = 0; band < bands.size(); ++band) {
        if (is_wanted(band)) continue;
        BurnBand(seen, static_cast<int>(band));
        break;
      }
      break;
    }
    case ErrorScenario::kCutsAside:
      CutCircle(seen, wanted.sheet, -kBesideLine, kShortCut);
      break;
    case ErrorScenario::kBurnsAir: {
      const int hand = TakeTool(seen, instrument::ToolKind::kHook);
      ReachPoint(hand, HandOf(hand).Tip() + Vec3{0, 0, kAside});
      PressPedal(hand, 1.0);
      break;
    }
    case ErrorScenario::kBurnsUnseen: {
      const int hand = TakeTool(seen, instrument::ToolKind::kHook);
      const Vec3 tip = HandOf(hand).Tip();
      ReachPoint(hand, tip + Vec3{hand == instrument::kLeft ? -kOutOfPicture : kOutOfPicture, 0, 0});
      PressPedal(hand, 0.5);
      ReachPoint(hand, tip);
      break;
    }
    default:
      return false;
  }
  error_scenario_ = ErrorScenario::kNone;
  return true;
}

}  // namespace trocar::agent
