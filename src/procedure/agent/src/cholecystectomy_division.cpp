// SPDX-License-Identifier: Apache-2.0
// Clips and cuts: each is planned from what lies there now, looked at before it is closed, and done anew where it failed.
#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "cholecystectomy_steps.h"
#include "planner_fields.h"
#include "seen_fibres.h"

namespace trocar::agent {

using instrument::kLeft;
using instrument::kRight;
using instrument::ToolKind;
using math::Vec3;
using surgery::LeakSnapshot;

namespace {

constexpr int kMostActs = 16;                           // clips, cuts and vain tries at one time
constexpr int kTries = 4;                               // to bring a vessel between the legs
constexpr double kTurnForClips = 1.0;                   // of a free gallbladder about the duct [rad]
constexpr double kDrawOff = 0.008, kDrawAside = 0.012;  // of a gallbladder on its bed, for another round [m]
constexpr double kLeaveClip =
    0.4;  // of the jaws: open enough to leave the clip, not so far that the next one comes
constexpr double kBurnClear = 0.008;  // of an electrode from what must stay [m]
constexpr double kBurnSeconds = 1.2;  // that shut a small vessel [s]

/// How far off all else has to be, less with each round: see DivisionField [-].
constexpr double kCares[] = {1.0, 0.7, 0.4};

double JawLength(const char* tool) {
  return instrument::FindTool(tool)->jaw_length;
}

std::vector<std::size_t> FindWhole(const SurgeonView& view, const std::vector<std::size_t>& tubes) {
  std::vector<std::size_t> whole;
  std::copy_if(tubes.begin(), tubes.end(), std::back_inserter(whole),
               [&](std::size_t tube) { return !view.IsDivided(tube); });
  return whole;
}

/// A decision or motion about one of the division's tubes.
SurgeonAct& About(SurgeonAct& act, std::size_t which, double arc) {
  act.tube = which;
  act.share = arc;
  return act;
}

/// Brings the vessel between the legs, looks, and closes the clip or aims anew.
void AddCloseWhenBetween(Planning& on, std::size_t which, double arc, int tries) {
  on.plan.Reach(kRight, Place::BetweenJaws(on.memory.division.tubes[which], arc, JawLength("clip_applier")),
                0.4);
  on.plan.Wait(0.2);
  About(on.plan.Decide(SurgeonAct::Kind::kCheckClip, "look at the clip's tips"), which, arc).count = tries;
}

void AddClip(Planning& on, std::size_t which, double arc) {
  on.plan.Take(ToolKind::kClipApplier);
  About(on.plan.Decide(SurgeonAct::Kind::kLookPastShaft, "look past the shaft"), which, arc);
  About(on.plan.Add(SurgeonAct::Kind::kLineUpClip, "line up the clip", 5.0), which, arc);
  AddCloseWhenBetween(on, which, arc, kTries);
}

void AddCut(Planning& on, std::size_t which, double arc) {
  on.plan.Take(ToolKind::kScissors);
  About(on.plan.Add(SurgeonAct::Kind::kLineUpScissors, "line up the scissors", 5.0), which, arc);
  const Place between = Place::BetweenJaws(on.memory.division.tubes[which], arc, JawLength("scissors"));
  for (int round = 0; round < 2; ++round) {
    on.plan.Reach(kRight, between, 0.4);
    on.plan.Wait(0.15);
    // the tool may have been pushed aside
    About(on.plan.Decide(SurgeonAct::Kind::kCheckBlades, "look at the blades"), which, arc);
  }
  About(on.plan.Decide(SurgeonAct::Kind::kCheckBeforeCut, "look before the cut"), which, arc);
}

/// Where more than two structures enter, an artery that can be divided.
std::optional<std::size_t> FindExtraArtery(const SurgeonView& view) {
  std::vector<std::size_t> arteries;
  for (const std::size_t tube : FindWhole(view, view.known.entering))
    if (view.known.is_artery[tube] != 0) arteries.push_back(tube);
  if (arteries.size() < 2) return std::nullopt;
  const SeenVessels vessels = SeeVessels(view);
  for (const double care : kCares) {
    for (const std::size_t tube : arteries) {
      const auto step = FindNextStep(vessels.FieldOf(tube, care), vessels.clips[tube], {});
      if (step.kind != DivisionStep::Kind::kNone) return tube;
    }
  }
  return arteries.back();
}

/// Of those that must not be left to themselves: away from what must stay.
const LeakSnapshot* FindLeak(const SurgeonView& view) {
  const auto& leaks = view.seen.operation.flow.leaks;
  const auto end = leaks.begin() + static_cast<std::ptrdiff_t>(view.seen.operation.flow.leak_count);
  const auto leak = std::find_if(leaks.begin(), end, [&](const LeakSnapshot& found) {
    const auto& main = view.known.main_nodes;
    const bool is_near_main = std::any_of(main.begin(), main.end(), [&](std::uint32_t node) {
      return math::Distance(view.seen.positions[node], found.position) < kBurnClear;
    });
    return found.fluid == surgery::Fluid::kBlood && !is_near_main;
  });
  return leak == end ? nullptr : &*leak;
}

}  // namespace

bool AreAllDivided(const Planning& on, const SurgeonAct& act) {
  return FindWhole(on.view, act.tubes).empty();
}

bool AreStumpsThere(const Planning& on, const SurgeonAct&) {
  return FindWhole(on.view, on.view.known.entering).empty();
}

void ClipAndCut(Planning& on, const SurgeonAct& act, SurgeonAct&) {
  const PatientKnowledge& known = on.view.known;
  const int rounds = act.count;
  const bool is_even = rounds % 2 == 0;
  if (rounds < kDivisionRounds) {
    const Vec3 aside =
        math::Normalized(math::Cross(known.bed_normal, known.rest[known.fundus] - known.rest[known.neck]));
    on.plan.HoldOn(Place::AtNode(known.neck));
    if (HangsFree(on.view)) {
      // from the hold that it gets
      on.plan.Decide(SurgeonAct::Kind::kGoRoundDuct, "turn the neck").amount =
          is_even ? kTurnForClips : -kTurnForClips;
    } else {
      on.plan.DrawGently(kLeft, kDrawOff * known.bed_normal + (is_even ? kDrawAside : -kDrawAside) * aside);
    }
  }
  Division work;
  work.tubes = FindWhole(on.view, act.tubes);
  work.avoid.resize(work.tubes.size());
  work.acts_left = kMostActs;
  work.care = rounds == kDivisionRounds ? kCares[0] : rounds == kDivisionRounds - 1 ? kCares[1] : kCares[2];
  on.memory.division = std::move(work);
  on.plan.Decide(SurgeonAct::Kind::kGoOnDividing, "plan the clips");
}

void GoOnDividing(Planning& on, const SurgeonAct&) {
  Division& work = on.memory.division;
  if (work.acts_left-- <= 0) return;
  const auto next = FindNext(SeeVessels(on.view), work);
  if (!next) return;
  next->step.kind == DivisionStep::Kind::kClip ? AddClip(on, next->which, next->step.arc)
                                               : AddCut(on, next->which, next->step.arc);
  on.plan.Decide(SurgeonAct::Kind::kGoOnDividing, "plan the clips");
}

void DivideExtraArtery(Planning& on, const SurgeonAct&) {
  const auto extra = FindExtraArtery(on.view);
  if (!extra) return;
  SurgeonAct& divide = on.plan.Decide(SurgeonAct::Kind::kDivide, "plan the clips");
  divide.tubes = {*extra};
  divide.count = kDivisionRounds;
}

void CheckClip(Planning& on, const SurgeonAct& act) {
  Division& work = on.memory.division;
  const std::size_t which = act.tube, tube = work.tubes[which];
  const SeenVessels vessels = SeeVessels(on.view);
  const math::Pose& X_world_tool = on.view.Tool(kRight).X_world_tool;
  if (IsBetweenLegs(vessels, tube, X_world_tool, work.care)) {
    on.plan.SetJaw("close the clip", 0.0);
    on.plan.Jaw(kRight, kLeaveClip);
    on.plan.Withdraw();
    About(on.plan.Decide(SurgeonAct::Kind::kCheckClosedClip, "look at the clip"), which, act.share).count =
        static_cast<int>(vessels.clips[tube].size());
    return;
  }
  if (act.count == 0) {
    work.avoid[which].push_back(act.share);
    return on.plan.Withdraw();
  }
  on.memory.aim.Correct(X_world_tool, vessels.lines[tube].At(act.share), JawLength("clip_applier"));
  AddCloseWhenBetween(on, which, act.share, act.count - 1);
}

/// It may have gone round another, such as the stump of what is divided already.
void CheckClosedClip(Planning& on, const SurgeonAct& act) {
  Division& work = on.memory.division;
  const auto clips = on.view.FindClips(on.view.Lines());
  if (clips[work.tubes[act.tube]].size() <= static_cast<std::size_t>(act.count))
    AvoidAround(work, act.tube, act.share);
}

void CheckBlades(Planning& on, const SurgeonAct& act) {
  on.memory.aim.Correct(on.view.Tool(kRight).X_world_tool,
                        on.view.LineOf(on.memory.division.tubes[act.tube]).At(act.share),
                        JawLength("scissors"));
}

/// Cuts between the clips, and with no other vessel between the blades.
void CheckBeforeCut(Planning& on, const SurgeonAct& act) {
  const std::size_t tube = on.memory.division.tubes[act.tube];
  if (IsCutSafe(SeeVessels(on.view), tube, on.view.Tool(kRight).X_world_tool)) on.plan.SetJaw("cut", 0.0);
  on.plan.Withdraw();
  About(on.plan.Decide(SurgeonAct::Kind::kCheckDivision, "look at the cut"), act.tube, act.share);
}

void CheckDivision(Planning& on, const SurgeonAct& act) {
  Division& work = on.memory.division;
  if (!on.view.IsDivided(work.tubes[act.tube])) work.avoid[act.tube].push_back(act.share);
}

bool IsDry(const Planning& on, const SurgeonAct&) {
  return FindLeak(on.view) == nullptr;
}

void CoagulateLeak(Planning& on, const SurgeonAct&, SurgeonAct&) {
  on.plan.Take(ToolKind::kHook);
  SurgeonAct& burn = on.plan.Decide(SurgeonAct::Kind::kCoagulate, "coagulate");
  burn.place = Place::At(FindLeak(on.view)->position).ForHook();
  burn.seconds = kBurnSeconds;
}

void Coagulate(Planning& on, const SurgeonAct& act) {
  on.plan.Burn(kRight, act.place, act.seconds);
  on.plan.Withdraw();
}

}  // namespace trocar::agent
