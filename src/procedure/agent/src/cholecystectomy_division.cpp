// SPDX-License-Identifier: Apache-2.0
// Clips and cuts: each is planned from what lies there now, looked at before it is closed, and done anew where it failed.
#include <algorithm>
#include <cmath>
#include <utility>

#include "cholecystectomy_surgeon.h"
#include "trocar/collision/segment_distance.h"

namespace trocar::agent {

using instrument::kRight;
using math::Pose;
using math::Vec3;
using simulation::Snapshot;
using surgery::LeakSnapshot;

namespace {

using instrument::ToolKind;

constexpr int kRounds = 3;               // with another hold each
constexpr int kMostActs = 16;            // clips, cuts and vain tries at one time
constexpr int kTries = 4;                // to bring a vessel between the legs
constexpr double kTurnForClips = 1.0;    // of a free gallbladder about the duct [rad]
constexpr double kStandOff = 0.012;      // of a tool's tip from the vessel while it is lined up [m]
constexpr double kWithdrawn = 0.020;     // [m]
constexpr double kFromTips = 0.0004;     // of a flattened vessel's edge from the ends of the legs [m]
constexpr double kBetweenLegs = 0.0012;  // of a vessel's axis from the legs' middle line [m]
constexpr double kBurnClear = 0.008;     // of an electrode from what must stay [m]
constexpr double kBurnSeconds = 1.2;     // that shut a small vessel [s]
constexpr double kMostOff = 0.004;       // by which a hand aims beside what it wants to meet [m]

}  // namespace

/// Divides tubes; where nothing more fits, the gallbladder is held and drawn otherwise, and tools may come nearer to the rest.
void CholecystectomySurgeon::Divide(std::vector<std::size_t> tubes, int rounds) {
  SurgeonAct& act = Decide(SurgeonAct::Kind::kDivide, "plan the clips");
  act.tubes = std::move(tubes);
  act.count = rounds;
}

void CholecystectomySurgeon::PlanDivision(const SurgeonAct& act, const Snapshot& seen) {
  const int rounds = act.count;
  Division work;
  for (const std::size_t tube : act.tubes) {
    if (!IsDivided(seen, tube)) work.tubes.push_back(tube);
  }
  if (work.tubes.empty() || rounds <= 0) return;
  if (rounds < kRounds) {
    const Vec3 aside = math::Normalized(
        math::Cross(known_.bed_normal, known_.rest[known_.fundus] - known_.rest[known_.neck]));
    HoldOn(Place::AtNode(known_.neck));
    if (HangsFree(seen)) {
      // from the hold that it gets
      Decide(SurgeonAct::Kind::kGoRoundDuct, "turn the neck").amount =
          rounds % 2 == 0 ? kTurnForClips : -kTurnForClips;
    } else {
      DrawGently(instrument::kLeft, 0.008 * known_.bed_normal + (rounds % 2 == 0 ? 0.012 : -0.012) * aside);
    }
  }
  work.avoid.resize(work.tubes.size());
  work.acts_left = kMostActs;
  work.care = rounds == kRounds ? 1.0 : rounds == kRounds - 1 ? 0.7 : 0.4;
  division_ = std::move(work);
  Decide(SurgeonAct::Kind::kGoOnDividing, "plan the clips");
  Divide(act.tubes, rounds - 1);
}

/// Every clip first, then the cuts: each tool is taken once.
void CholecystectomySurgeon::GoOnDividing(const Snapshot& seen) {
  if (division_.acts_left-- <= 0) return;
  const std::vector<TubeLine> lines = LinesOf(seen);
  const auto next = [&](std::size_t which) {
    const std::size_t tube = division_.tubes[which];
    if (IsDivided(seen, tube)) return DivisionStep{};
    return FindNextStep(FieldOf(seen, tube, lines, division_.care), ClipsOn(seen, tube),
                        division_.avoid[which]);
  };
  std::vector<DivisionStep> steps;
  for (std::size_t which = 0; which < division_.tubes.size(); ++which) steps.push_back(next(which));
  for (const auto kind : {DivisionStep::Kind::kClip, DivisionStep::Kind::kCut}) {
    for (std::size_t which = 0; which < steps.size(); ++which) {
      if (steps[which].kind != kind) continue;
      if (kind == DivisionStep::Kind::kClip) {
        ClipAt(which, steps[which].arc);
      } else {
        CutAt(which, steps[which].arc);
      }
      Decide(SurgeonAct::Kind::kGoOnDividing, "plan the clips");
      return;
    }
  }
}

void CholecystectomySurgeon::ClipAt(std::size_t which, double arc) {
  Take(ToolKind::kClipApplier);
  LookPastShaft(which, arc);
  SurgeonAct& act = Add(SurgeonAct::Kind::kLineUpClip, "line up the clip", 5.0);
  act.tube = which;
  act.share = arc;
  CloseWhenBetween(which, arc, kTries);
}

void CholecystectomySurgeon::LineUpClip(const SurgeonAct& act, const Snapshot& seen) {
  const std::size_t tube = division_.tubes[act.tube];
  const double arc = act.share;
  offset_ = {};
  const std::vector<TubeLine> lines = LinesOf(seen);
  const TubeLine& line = lines[tube];
  beyond_ = FindClip(FieldOf(seen, tube, lines, division_.care), arc).value_or(0.5);
  HandMotion& hand = HandOf(kRight);
  const Vec3 p = line.At(arc), in = math::Normalized(p - hand.Port());
  hand.Turn(FindSpin(hand.Port(), p, math::Cross(in, line.DirectionAt(arc))));
  hand.SetJaw(instrument::FindTool("clip_applier")->max_jaw);
  hand.MoveTo(p - kStandOff * in);
}

/// Brings the vessel between the legs, looks, and closes the clip or aims anew.
void CholecystectomySurgeon::CloseWhenBetween(std::size_t which, double arc, int tries) {
  Place between = Place::OnTube(division_.tubes[which], arc);
  between.kind = Place::Kind::kBetweenJaws;
  between.back = instrument::FindTool("clip_applier")->jaw_length;
  Reach(kRight, between, 0.4);
  Wait(0.2);
  SurgeonAct& act = Decide(SurgeonAct::Kind::kCheckClip, "look at the clip's tips");
  act.tube = which;
  act.share = arc;
  act.count = tries;
}

void CholecystectomySurgeon::CheckClip(const SurgeonAct& act, const Snapshot& seen) {
  const std::size_t which = act.tube, tube = division_.tubes[which];
  const double arc = act.share, length = instrument::FindTool("clip_applier")->jaw_length;
  const Pose& X = seen.instruments[kRight].X_world_tool;
  const collision::Segment legs{X.translation, X * Vec3{0, 0, length}};
  const std::vector<TubeLine> lines = LinesOf(seen);
  const TubeLine::Near near = lines[tube].FindNearest(legs);
  const Vec3 in = math::Inverse(X) * lines[tube].At(near.arc);
  // closed, it is half its girth wide
  const double half = 0.5 * M_PI * lines[tube].RadiusAt(near.arc) + kFromTips;
  bool is_good = near.distance < kBetweenLegs && in.z > half && in.z < length - half;
  for (std::size_t other = 0; other < lines.size(); ++other) {
    // a stump may come between, but not in the place of the vessel
    const double room = division_.care < 1.0 && IsDivided(seen, other) ? 0.0 : division_.care * kBetweenLegs;
    if (other != tube && lines[other].FindNearest(legs).distance < near.distance + room) is_good = false;
  }
  for (const double clip : ClipsOn(seen, tube))
    if (std::fabs(clip - near.arc) < kLeastGap) is_good = false;
  if (is_good) {
    SetJaw("close the clip", 0.0);
    // open enough to leave the clip, not so far that the next one comes
    Jaw(kRight, 0.4);
    Withdraw();
    SurgeonAct& look = Decide(SurgeonAct::Kind::kCheckClosedClip, "look at the clip");
    look.tube = which;
    look.share = arc;
    look.count = static_cast<int>(ClipsOn(seen, tube).size());
    return;
  }
  if (act.count == 0) {
    division_.avoid[which].push_back(arc);
    return Withdraw();
  }
  const Vec3 middle = X * Vec3{0, 0, beyond_ * length};
  const Vec3 off = offset_ + lines[tube].At(arc) - middle;
  offset_ = math::Norm(off) > kMostOff ? kMostOff * math::Normalized(off) : off;
  CloseWhenBetween(which, arc, act.count - 1);
}

void CholecystectomySurgeon::CutAt(std::size_t which, double arc) {
  Take(ToolKind::kScissors);
  SurgeonAct& line_up = Add(SurgeonAct::Kind::kLineUpScissors, "line up the scissors", 5.0);
  line_up.tube = which;
  line_up.share = arc;
  Place between = Place::OnTube(division_.tubes[which], arc);
  between.kind = Place::Kind::kBetweenJaws;
  between.back = instrument::FindTool("scissors")->jaw_length;
  for (int round = 0; round < 2; ++round) {
    Reach(kRight, between, 0.4);
    Wait(0.15);
    // the tool may have been pushed aside
    SurgeonAct& look = Decide(SurgeonAct::Kind::kCheckBlades, "look at the blades");
    look.tube = which;
    look.share = arc;
  }
  SurgeonAct& cut = Decide(SurgeonAct::Kind::kCheckBeforeCut, "look before the cut");
  cut.tube = which;
  cut.share = arc;
}

void CholecystectomySurgeon::LineUpScissors(const SurgeonAct& act, const Snapshot& seen) {
  const std::size_t tube = division_.tubes[act.tube];
  offset_ = {};
  const std::vector<TubeLine> lines = LinesOf(seen);
  const auto pose = FindCut(FieldOf(seen, tube, lines, division_.care), act.share);
  if (!pose) return;
  beyond_ = pose->beyond;
  const Vec3 p = lines[tube].At(act.share);
  HandMotion& hand = HandOf(kRight);
  hand.Turn(pose->spin);
  hand.SetJaw(pose->jaw);
  hand.MoveTo(p - kStandOff * math::Normalized(p - hand.Port()));
}

void CholecystectomySurgeon::CheckBlades(const SurgeonAct& act, const Snapshot& seen) {
  const double length = instrument::FindTool("scissors")->jaw_length;
  const Pose& X = seen.instruments[kRight].X_world_tool;
  const Vec3 off =
      offset_ + LineOf(seen, division_.tubes[act.tube]).At(act.share) - X * Vec3{0, 0, beyond_ * length};
  offset_ = math::Norm(off) > kMostOff ? kMostOff * math::Normalized(off) : off;
}

/// Cuts between the clips, and with no other vessel between the blades.
void CholecystectomySurgeon::CheckBeforeCut(const SurgeonAct& act, const Snapshot& seen) {
  const std::size_t tube = division_.tubes[act.tube];
  const std::vector<TubeLine> lines = LinesOf(seen);
  const auto clips = ClipsOn(seen, tube);
  const Pose& X = seen.instruments[kRight].X_world_tool;
  const double length = instrument::FindTool("scissors")->jaw_length;
  const double here = lines[tube].FindNearest(collision::Segment{X.translation, X * Vec3{0, 0, length}}).arc;
  const auto distal = std::count_if(clips.begin(), clips.end(), [&](double clip) { return clip < here; });
  const bool is_safe = distal >= 1 && static_cast<std::ptrdiff_t>(clips.size()) - distal >= 2;
  if (is_safe) SetJaw("cut", 0.0);
  Withdraw();
  SurgeonAct& look = Decide(SurgeonAct::Kind::kCheckDivision, "look at the cut");
  look.tube = act.tube;
  look.share = act.share;
}

/// A small vessel that still bleeds is shut by heat, where nothing that must stay is near.
void CholecystectomySurgeon::StopBleeding(int rounds) {
  Decide(SurgeonAct::Kind::kStopBleeding, "look for blood").count = rounds;
}

void CholecystectomySurgeon::PlanCoagulation(const SurgeonAct& act, const Snapshot& seen) {
  if (act.count <= 0) return;
  const auto& leaks = seen.operation.flow.leaks;
  const auto end = leaks.begin() + static_cast<std::ptrdiff_t>(seen.operation.flow.leak_count);
  const auto leak = std::find_if(leaks.begin(), end, [&](const LeakSnapshot& found) {
    const bool is_near_main =
        std::any_of(known_.main_nodes.begin(), known_.main_nodes.end(), [&](std::uint32_t node) {
          return math::Distance(seen.positions[node], found.position) < kBurnClear;
        });
    return found.fluid == surgery::Fluid::kBlood && !is_near_main;
  });
  if (leak == end) return;
  Take(ToolKind::kHook);
  SurgeonAct& burn = Decide(SurgeonAct::Kind::kCoagulate, "coagulate");
  burn.place = Place::At(leak->position).ForHook();
  burn.seconds = kBurnSeconds;
  StopBleeding(act.count - 1);
}

void CholecystectomySurgeon::Withdraw() {
  Reach(kRight, Place::BehindTip(kRight, kWithdrawn), 0.6);
}

void CholecystectomySurgeon::Take(instrument::ToolKind kind) {
  Decide(SurgeonAct::Kind::kTake, "take a tool").tool_kind = kind;
}

}  // namespace trocar::agent
