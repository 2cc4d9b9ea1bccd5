// SPDX-License-Identifier: Apache-2.0
// What hands and feet do to ducts and bands.
#include <algorithm>
#include <cmath>
#include <limits>

#include "task_surgeon.h"
#include "tool_alignment.h"
#include "trocar/math/elementary.h"

namespace trocar::agent {

using instrument::kRight;
using math::Pose;
using math::Vec3;
using scene::ConditionKind;
using scene::ModelBand;
using scene::ModelSheet;
using simulation::Snapshot;

namespace {

constexpr double kStandOff = 0.014;    // of a tip from what is lined up [m]
constexpr double kReady = 0.4;         // opening of jaws that have let go, as a share: no new clip comes
constexpr double kCloseSeconds = 0.7;  // for jaws to close over tissue [s]
constexpr double kScissorDepth = 0.4;  // of a duct between blades, as a share of them from the tips
constexpr double kRunIn = 0.003;       // of a cut that leads to a line, from outside [m]
constexpr double kDrift = 0.0004;      // outwards in one turn, so that its end meets the run-in [m]
constexpr int kWaypoints = 60;         // of a circle
constexpr double kMostBurning = 6.0;   // [s]
constexpr double kWide = 0.8;          // opening of jaws that are to take tissue, as a share
constexpr double kIntoTissue = 0.014;  // from before the tissue to where jaws close on it [m]
constexpr double kFarther = 0.004;     // each time that they closed on nothing [m]
constexpr double kJawMargin = 0.2;     // beyond the time that jaws need [s]
constexpr double kCareful = 0.5;       // speed into tissue, as a share of a hand's own
constexpr double kBetter = 0.0005;     // of one place on a band over another, for more clearance [m]

}  // namespace

TissueSpot TaskSurgeon::FindOnTube(const Vec3& p_rest) const {
  TissueSpot best;
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [row_a, row_b] : start_pieces_) {
    const Vec3 &a = start_[row_a], &b = start_[row_b];
    const double t = std::clamp(math::Dot(p_rest - a, b - a) / math::SquaredNorm(b - a), 0.0, 1.0);
    const double distance = math::Distance(p_rest, math::Lerp(a, b, t));
    if (!(distance < nearest)) continue;
    nearest = distance;
    best = {row_a, row_b, t};
  }
  return best;
}

void TaskSurgeon::PlanTissue(const Snapshot& seen, const scene::Condition& wanted) {
  if (AddTissueErrorScenario(seen, wanted)) return;
  const auto place = [&] {
    return scene_->task->regions[static_cast<std::size_t>(wanted.regions.front())].centre;
  };
  switch (wanted.kind) {
    case ConditionKind::kClipped:
      CloseClip(seen, place(), 0.5);
      break;
    case ConditionKind::kDivided:
      CutTube(seen, place());
      break;
    case ConditionKind::kCutFree:
      CutCircle(seen, wanted.sheet, 0.0, 1.0);
      break;
    default:
      BurnBand(seen, wanted.band);
      break;
  }
  Wait(wanted.seconds + 0.1);
}

/// Takes the tissue that lies along the shaft behind a place: farther in each time that the jaws closed on nothing.
void TaskSurgeon::GraspTissue(const Snapshot& seen, int hand, const Vec3& p_before) {
  const auto h = static_cast<std::size_t>(hand);
  const double max_jaw = scene_->instruments[h].tray[seen.operation.tools[h]].max_jaw;
  const bool misses = random_.Uniform() < skill_.miss_share;
  // what they closed on was nothing: they open away from it
  if (fruitless_plans_ > 0) ReachPoint(hand, p_before);
  const double seconds = kJawMargin + kWide * max_jaw / skill_.hand.jaw_rate;
  SetJaw("open the jaws", hand, kWide * max_jaw, seconds);
  const double way = misses ? 0.0 : kIntoTissue + kFarther * fruitless_plans_ + skill_.press;
  ReachPoint(hand, PointBeyond(HandOf(hand).Port(), p_before, way), kCareful);
  SetJaw("close on the tissue", hand, 0.0, seconds);
}

/// Has a hand take up a tool, out of the way of the tissue.
int TaskSurgeon::TakeTool(const Snapshot& seen, instrument::ToolKind kind) {
  for (int hand = kRight; hand >= instrument::kLeft; --hand) {
    const auto h = static_cast<std::size_t>(hand);
    const auto& tray = scene_->instruments[h].tray;
    const auto found =
        std::find_if(tray.begin(), tray.end(), [&](const auto& tool) { return tool.kind == kind; });
    if (found == tray.end()) continue;
    const auto index = static_cast<std::uint8_t>(found - tray.begin());
    if (seen.operation.tools[h] == index) return hand;
    HandOf(hand).SetJaw(0);
    ReachPoint(hand,
               instrument::CalcToolPose(scene_->instruments[h].p_world_port, scene_->instruments[h].home)
                   .translation);
    TaskAct act{TaskAct::Kind::kExchangeTool, "exchange for the " + found->name};
    act.hand = hand;
    act.tool = index;
    Add(std::move(act));
    return hand;
  }
  return kRight;
}

/// Before a place on a duct, jaws across it.
void TaskSurgeon::LineUp(int hand, const TissueSpot& spot, double jaw) {
  TaskAct& act = Reach(TaskAct::Kind::kLineUp, hand);
  act.doing = "line up";
  act.time_limit = 8.0;
  act.spot = spot;
  act.amount = jaw;
}

void TaskSurgeon::BeginLineUp(const TaskAct& act, const Snapshot& seen) {
  HandMotion& motion = HandOf(act.hand);
  BeginMotion(motion,
              LineUpAcross(motion.Port(), act.spot.At(seen), act.spot.Along(seen), kStandOff, act.amount));
}

/// The tip goes to a place on tissue, or beyond it along the shaft.
void TaskSurgeon::Advance(int hand, const TissueSpot& spot, double ahead) {
  TaskAct& act = Reach(TaskAct::Kind::kReachSpot, hand, 0.4);
  act.spot = spot;
  act.amount = ahead + (ahead > 0 ? skill_.press : 0.0);
}

/// \param depth_share  of the jaws beyond the duct
void TaskSurgeon::CloseClip(const Snapshot& seen, const Vec3& p_rest, double depth_share) {
  const instrument::Tool& applier = *instrument::FindTool("clip_applier");
  const int hand = TakeTool(seen, instrument::ToolKind::kClipApplier);
  const TissueSpot spot = FindOnTube(p_rest);
  LineUp(hand, spot, applier.max_jaw);
  Advance(hand, spot, depth_share * applier.jaw_length);
  SetJaw("close the clip", hand, 0.0, kCloseSeconds);
  SetJaw("leave it", hand, kReady * applier.max_jaw, 0.3);
  Advance(hand, spot, -kStandOff);
}

void TaskSurgeon::CutTube(const Snapshot& seen, const Vec3& p_rest) {
  const instrument::Tool& scissors = *instrument::FindTool("scissors");
  const int hand = TakeTool(seen, instrument::ToolKind::kScissors);
  const TissueSpot spot = FindOnTube(p_rest);
  LineUp(hand, spot, scissors.max_jaw);
  Advance(hand, spot, kScissorDepth * scissors.jaw_length);
  SetJaw("cut", hand, 0.0, kCloseSeconds);
  Advance(hand, spot, -kStandOff);
}

void TaskSurgeon::PressPedal(int hand, double seconds) {
  TaskAct act{TaskAct::Kind::kPressPedal, "press the pedal", seconds + 1.0};
  act.hand = hand;
  act.seconds = seconds;
  Add(std::move(act));
}

/// The tip goes where the middle of the hook's toe, which points down, lies in the sheet.
void TaskSurgeon::FollowSheet(int hand, const Vec3& p_sheet, double hurry) {
  TaskAct& act = Reach(TaskAct::Kind::kFollowSheet, hand, hurry);
  act.doing = "follow the line";
  act.time_limit = 8.0;
  act.p = p_sheet;
}

void TaskSurgeon::BeginFollowSheet(const TaskAct& act) {
  HandMotion& motion = HandOf(act.hand);
  const double spin = FindUpperSpin(motion.Port(), act.p, {0, 0, -1});
  const Pose X =
      instrument::CalcToolPose(motion.Port(), instrument::FindJoints(motion.Port(), act.p, spin, 0.0));
  const Vec3 p_tool_middle = 0.5 * (instrument::kHookToe.a + instrument::kHookToe.b);
  motion.Turn(spin);
  motion.MoveTo(act.p - math::Rotate(X.rotation, p_tool_middle) - Vec3{0, 0, skill_.press}, act.hurry);
}

void TaskSurgeon::BeginReachBand(const TaskAct& act) {
  HandMotion& motion = HandOf(act.hand);
  motion.Turn(FindUpperSpin(motion.Port(), act.p, act.q));
  motion.MoveTo(PointBeyond(motion.Port(), act.p, -kStandOff));
}

/// With hook and current: to the circle from outside, round it, and out over the cut with which it began.
/// \param aside  of the line, outwards [m]
void TaskSurgeon::CutCircle(const Snapshot& seen, int sheet, double aside, double turns) {
  const int hand = TakeTool(seen, instrument::ToolKind::kHook);
  const ModelSheet& cloth = scene_->model->sheets[static_cast<std::size_t>(sheet)];
  const auto at = [&](double turn, double out) {
    const double angle = 2 * M_PI * turn - 0.5 * M_PI;
    return cloth.centre + (cloth.circle + aside + out) * Vec3{math::Cos(angle), math::Sin(angle), 0};
  };
  const auto pedal = [this, hand](bool is_down) {
    TaskAct act;
    act.kind = is_down ? TaskAct::Kind::kPressCutPedal : TaskAct::Kind::kLiftFoot;
    act.doing = is_down ? "press the pedal" : "lift the foot";
    act.hand = hand;
    Add(std::move(act));
  };
  const Vec3 begin = at(0, kRunIn);
  FollowSheet(hand, begin + Vec3{0, 0, kStandOff}, 1.0);
  if (skill_.early_pedal > 0) {
    pedal(true);
    Wait(skill_.early_pedal);
  }
  FollowSheet(hand, begin, 0.5);
  pedal(true);
  FollowSheet(hand, at(0, 0), 0.3);
  for (int i = 1; i <= kWaypoints * turns; ++i) {
    const double turn = static_cast<double>(i) / kWaypoints;
    FollowSheet(hand, at(turn, kDrift * turn), 0.3);
  }
  FollowSheet(hand, at(turns + 1.0 / kWaypoints, 2 * kDrift), 0.3);
  pedal(false);
  FollowSheet(hand, begin + Vec3{0, 0, kStandOff}, 1.0);
}

/// Where along a band there is most clearance between it and the others that hold.
double TaskSurgeon::FindClearPlace(const Snapshot& seen, int band) const {
  const auto& bands = scene_->model->bands;
  const ModelBand& cord = bands[static_cast<std::size_t>(band)];
  double best = 0.5, most_clearance = -1;
  for (const double t : {0.5, 0.4, 0.6, 0.3, 0.7}) {
    const Vec3 p = math::Lerp(cord.from, cord.to, t);
    double clearance = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < bands.size(); ++i) {
      if (static_cast<int>(i) == band || seen.operation.band_is_whole[i] == 0) continue;
      const Vec3 &a = bands[i].from, along = bands[i].to - a;
      const double s = std::clamp(math::Dot(p - a, along) / math::SquaredNorm(along), 0.0, 1.0);
      clearance = std::min(clearance, math::Distance(p, a + s * along));
    }
    if (clearance > most_clearance + kBetter) most_clearance = clearance, best = t;
  }
  return best;
}

/// The hook's toe along a band, and current until it parts.
void TaskSurgeon::BurnBand(const Snapshot& seen, int band) {
  const int hand = TakeTool(seen, instrument::ToolKind::kHook);
  const ModelBand& cord = scene_->model->bands[static_cast<std::size_t>(band)];
  const Vec3 along = math::Normalized(cord.to - cord.from);
  const Vec3 tip = HookTip(math::Lerp(cord.from, cord.to, FindClearPlace(seen, band)), along);
  const Vec3 before = PointBeyond(HandOf(hand).Port(), tip, -kStandOff);
  TaskAct& reach = Reach(TaskAct::Kind::kReachBand, hand);
  reach.doing = "reach for " + cord.name;
  reach.time_limit = 8.0;
  reach.p = tip;
  reach.q = along;
  if (skill_.early_pedal > 0) PressPedal(hand, skill_.early_pedal);
  ReachPoint(hand, tip, 0.3);
  TaskAct burn{TaskAct::Kind::kBurnBand, "burn " + cord.name, kMostBurning};
  burn.hand = hand;
  burn.object = band;
  Add(std::move(burn));
  ReachPoint(hand, before, 0.5);
}

}  // namespace trocar::agent
