// SPDX-License-Identifier: Apache-2.0
#include "spread_planner.h"

#include <algorithm>

#include "state_fields.h"

namespace trocar::agent {

namespace {

constexpr double kBack = 0.008;       // of the tip before the next spread [m]
constexpr double kOpenSeconds = 1.0;  // that it waits for opening jaws [s]
constexpr std::size_t kFew = 2;       // fibres: a spread that parts fewer was hardly worth it
constexpr int kMostFruitless = 8;     // such spreads in a row
constexpr double kPoor = 0.3;         // of what was hoped for

/// Whether the blades, as they stand now, would take the fibre that is meant and nothing that must stay.
bool MayClose(const SpreadSight& sight, const Spreading& work) {
  const SeenSpread seen = sight.look(work);
  const auto aim = std::find(seen.index.begin(), seen.index.end(), work.aim);
  return aim != seen.index.end() &&
         FindSnipRoom(seen.field, static_cast<std::size_t>(aim - seen.index.begin()), sight.X_world_tool,
                      work.pose.opening);
}

/// The next pose. \return whether there is one
bool Choose(const SpreadSight& sight, Spreading& work, std::size_t left, HandMotion& hand) {
  if (left == 0 || sight.is_clear() || work.fruitless >= kMostFruitless) return false;
  const SeenSpread seen = sight.look(work);
  std::vector<std::uint8_t> tries;
  for (const std::uint32_t i : seen.index) tries.push_back(work.tries[i]);
  const auto pose = work.is_sharp ? FindSnip(seen.field, tries) : FindSpread(seen.field, tries);
  if (!pose) return false;
  work.pose = *pose;
  work.aim = seen.index[pose->aim];
  work.left_before = left;
  hand.Turn(pose->spin);
  hand.SetJaw((work.is_sharp ? pose->opening : kNarrow) * FindSpreadTool(work).max_jaw);
  hand.MoveTo(pose->tip + kBack * math::Normalized(hand.Port() - pose->tip));
  work.stage = Spreading::Stage::kApproach;
  return true;
}

}  // namespace

void Spreading::VisitState(base::StateArchive& archive) {
  archive.Field("strands", strands);
  archive.Field("weights", weights);
  archive.Field("is_sharp", is_sharp);
  archive.Field("tries", tries);
  archive.Field("stage", stage);
  archive.Field("pose_tip", pose.tip);
  archive.Field("pose_opening", pose.opening);
  archive.Field("pose_worth", pose.worth);
  archive.Field("left_before", left_before);
  archive.Field("aim", aim);
  archive.Field("fruitless", fruitless);
}

const instrument::Tool& FindSpreadTool(const Spreading& work) {
  return *instrument::FindTool(work.is_sharp ? "scissors" : "maryland");
}

bool StepSpreading(const SpreadSight& sight, Spreading& work, double& seconds, HandMotion& hand) {
  const double max_jaw = FindSpreadTool(work).max_jaw;
  const auto is_intact = [&](std::uint32_t strand) { return sight.is_intact[strand] != 0; };
  const auto left =
      static_cast<std::size_t>(std::count_if(work.strands.begin(), work.strands.end(), is_intact));
  switch (work.stage) {
    case Spreading::Stage::kChoose:
      if (Choose(sight, work, left, hand)) return false;
      break;
    case Spreading::Stage::kApproach:
      if (hand.IsMoving() || hand.IsTurning()) return false;
      hand.MoveTo(work.pose.tip, 0.6);
      work.stage = Spreading::Stage::kEnter;
      return false;
    case Spreading::Stage::kEnter:
      if (hand.IsMoving()) return false;
      if (work.is_sharp && !MayClose(sight, work)) {
        ++work.tries[work.aim];
        ++work.fruitless;
        work.stage = Spreading::Stage::kChoose;
        return false;
      }
      hand.SetJaw(work.is_sharp ? 0.0 : work.pose.opening * max_jaw);
      work.stage = Spreading::Stage::kOpen;
      seconds = 0;
      return false;
    case Spreading::Stage::kOpen:
      if (hand.IsTurning() && seconds < kOpenSeconds) return false;
      // the jaws may have been kept off by what they met
      if (work.is_sharp ? is_intact(work.strands[work.aim])
                        : static_cast<double>(work.left_before - left) < kPoor * work.pose.worth)
        ++work.tries[work.aim];
      work.fruitless = work.left_before - left < (work.is_sharp ? 1 : kFew) ? work.fruitless + 1 : 0;
      work.stage = Spreading::Stage::kChoose;
      return false;
  }
  hand.SetJaw(kNarrow * max_jaw);
  return true;
}

}  // namespace trocar::agent
