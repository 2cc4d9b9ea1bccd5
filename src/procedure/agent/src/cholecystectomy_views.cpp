// SPDX-License-Identifier: Apache-2.0
// Where the laparoscope is held, so that what is judged or worked on is seen.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "cholecystectomy_surgeon.h"
#include "trocar/math/rotation_angle.h"

namespace trocar::agent {

using instrument::IsInView;
using instrument::kLeft;
using instrument::TrocarJoints;
using math::Pose;
using math::Vec3;
using roles::TubeRole;
using scene::CalcLaparoscopePose;
using scene::FindView;
using scene::LaparoscopeSetup;
using scene::ViewRequest;
using simulation::Snapshot;

namespace {

constexpr double kTurnStep = 0.2;  // of the lens about the duct, to either side in turn [rad]
constexpr int kTurnSteps = 26;
constexpr double kTilts[] = {0.0, 0.25, -0.25, 0.5, -0.5, 0.75, -0.75};  // of the lens along the duct [rad]
constexpr double kDistances[] = {0.060, 0.072, 0.050};                   // of the lens from the duct [m]
constexpr double kWorkDistances[] = {0.085, 0.072};                      // likewise while a tool is at it [m]
constexpr double kAside = 0.4;          // of a view from the front of the neck [rad]
constexpr double kJustAside = 0.28;     // likewise where no better is found; the judge asks for 0.25 [rad]
constexpr double kSightClear = 0.0002;  // of a line of sight from organs [m]
constexpr double kFolded = 0.7;       // a duct whose ends are nearer than that, in their distance at rest [-]
constexpr double kTurnForView = 0.5;  // of a free gallbladder about the duct [rad]
constexpr double kRollForView = 0.3;  // of the neck that is held, likewise [rad]
constexpr double kNeckStep = 0.008;   // of the hold about the duct, to show the other side of the neck [m]
/// Between the line of sight and a shaft: more is not better, and less than the second is worth another look [rad].
constexpr double kWellPastShaft = 0.9, kPastShaft = 0.6;

/// Poses that show `middle` from around an axis through it, those nearest to the trocar's own side first.
/// \param take  called with each and the lens's pose, until it returns true
template <class Take>
void TryViews(const LaparoscopeSetup& setup, const Vec3& middle, const Vec3& axis,
              std::span<const double> distances, const Take& take) {
  const Vec3 to_eye = math::Normalized(setup.p_world_port - middle);
  const Vec3 across = math::Normalized(math::Cross(axis, to_eye), {1, 0, 0});
  for (int step = 0; step < kTurnSteps; ++step) {
    const double turn = (step % 2 == 0 ? 1 : -1) * kTurnStep * (1 + step / 2);
    for (const double tilt : kTilts) {
      const math::Quaternion turned = math::RotationAbout(axis, turn) * math::RotationAbout(across, tilt);
      for (const double distance : distances) {
        ViewRequest request;
        request.p_world = middle;
        request.distance = distance;
        request.facing = math::Rotate(turned, to_eye);
        const auto found = FindView(setup, request);
        if (found && take(*found, CalcLaparoscopePose(setup, *found))) return;
      }
    }
  }
}

}  // namespace

void CholecystectomySurgeon::UpdateSight(const Snapshot& seen) {
  sight_.Update(seen.operation.strand_is_intact, [&](std::uint32_t tube) { return IsDivided(seen, tube); });
}

/// Whether all points lie in the picture with no organ, and no fat that was left at the last UpdateSight, before them.
bool CholecystectomySurgeon::Shows(const Snapshot& seen, const Pose& X_world_lens,
                                   std::span<const Vec3> points) {
  const Vec3& eye = X_world_lens.translation;
  return std::all_of(points.begin(), points.end(), [&](const Vec3& p) {
    return IsInView(X_world_lens, scene_->laparoscope.field_of_view, p) &&
           Clearance(seen, cholecystectomy::TriangleSight::LineTo(p, eye)) > kSightClear &&
           !sight_.DoesFatHide(seen.positions, p, eye);
  });
}

/// A pose of the laparoscope that shows the triangle from one side of its front, with nothing before it.
/// \param aside  from the front of the neck at least [rad]
std::optional<TrocarJoints> CholecystectomySurgeon::FindSideView(const Snapshot& seen, int side,
                                                                 double aside) {
  const std::size_t duct = FindTube(TubeRole::kCysticDuct);
  UpdateSight(seen);
  const std::span<const Vec3> points = sight_.FindPoints(seen.positions);
  const Vec3 middle =
      std::accumulate(points.begin(), points.end(), Vec3{}) / static_cast<double>(points.size());
  std::optional<TrocarJoints> view;
  TryViews(scene_->laparoscope, middle, TubeDirection(seen, duct, 0.5), kDistances,
           [&](const TrocarJoints& joints, const Pose& X_world_lens) {
             if (side * CalcAzimuth(seen.positions, X_world_lens.translation) < aside ||
                 !Shows(seen, X_world_lens, points))
               return false;
             view = joints;
             return true;
           });
  return view;
}

/// Looks at the triangle from one side of its front; where the picture does not get there, the left hand turns the
/// neck towards it, farther with each try, and at last by another hold.
/// \param is_last_hold  the left hand holds the neck itself
void CholecystectomySurgeon::LookFromSide(int side, int tries, bool is_last_hold) {
  SurgeonAct& act = Decide(SurgeonAct::Kind::kLookFromSide, "look from aside");
  act.side = side;
  act.count = tries;
  act.is_on = is_last_hold;
}

void CholecystectomySurgeon::PlanLookFromSide(const SurgeonAct& act, const Snapshot& seen) {
  const auto& score = seen.operation.critical_view;
  if (score.IsAchieved() || score.Sum() < 6) return;
  const bool may_turn = act.count > 0 && seen.instruments[kLeft].is_grasping;
  auto view = FindSideView(seen, act.side, kAside);
  if (!view && !may_turn) view = FindSideView(seen, act.side, kJustAside);
  if (view) {
    Add(SurgeonAct::Kind::kLookFrom, "look from aside", 8.0).camera = *view;
    Wait(1.3);
    return;
  }
  if (may_turn) {
    // what hangs free does not always turn with the hand: by the last hold it goes the other way round
    HangsFree(seen) ? GoRoundDuct(seen, (act.is_on ? act.side : -act.side) * kTurnForView)
                    : TurnNeck(seen, act.side, kNeckStep, kRollForView);
    LookFromSide(act.side, act.count - 1, act.is_on);
  } else if (!act.is_on) {
    HoldOn(Place::AtNode(known_.neck));
    LookFromSide(act.side, kNeckTurns, true);
  }
}

/// Takes a gallbladder that hangs free round the duct by the hold, which comes no farther from it and rolls along. A duct
/// that has folded is drawn out as it lay. The assistant, who would hold it back, lets go.
void CholecystectomySurgeon::GoRoundDuct(const Snapshot& seen, double angle) {
  const std::size_t duct = FindTube(TubeRole::kCysticDuct);
  const auto& nodes = known_.tube_nodes[duct];
  const Vec3 at_rest = known_.rest[nodes.front()] - known_.rest[nodes.back()];
  const Vec3 neck = TubePoint(seen, duct, 0.0), root = TubePoint(seen, duct, 1.0);
  const bool is_folded = math::Distance(neck, root) < kFolded * math::Norm(at_rest);
  const Vec3 out = is_folded ? root + at_rest - neck : Vec3{};
  const Vec3 axis = math::Normalized(neck + out - root);
  const HandMotion& hand = HandOf(kLeft);
  const Vec3 arm = hand.Tip() - neck;
  if (seen.operation.assistant.is_holding)
    Add(SurgeonAct::Kind::kAssist, "assistant: release", 4.0).command = scene::AssistantCommand::kRelease;
  Ease(kLeft);
  DrawGently(kLeft, out + math::Rotate(math::RotationAbout(axis, angle), arm) - arm,
             FindRoll(hand.Port(), hand.Tip(), axis, angle));
}

/// Turns the picture so that the right hand's shaft does not hide the vessel that it works on.
/// \param which  of the tubes that are being divided
/// \param arc    of it [m]
void CholecystectomySurgeon::LookPastShaft(std::size_t which, double arc) {
  SurgeonAct& act = Decide(SurgeonAct::Kind::kLookPastShaft, "look past the shaft");
  act.tube = which;
  act.share = arc;
}

void CholecystectomySurgeon::PlanLookPastShaft(const SurgeonAct& act, const Snapshot& seen) {
  const Vec3 p = LineOf(seen, division_.tubes[act.tube]).At(act.share);
  const Vec3 shaft = HandOf(instrument::kRight).Port() - p;
  const auto angle_past_shaft = [&](const Pose& X_world_lens) {
    return math::AngleBetween(X_world_lens.translation - p, shaft);
  };
  const std::array<Vec3, 1> points = {p};
  UpdateSight(seen);
  const Pose& now = seen.X_world_laparoscope;
  double best = Shows(seen, now, points) ? angle_past_shaft(now) : 0.0;
  if (best > kPastShaft) return;
  std::optional<TrocarJoints> view;
  TryViews(scene_->laparoscope, p, TubeDirection(seen, FindTube(TubeRole::kCysticDuct), 0.5), kWorkDistances,
           [&](const TrocarJoints& joints, const Pose& X_world_lens) {
             const double angle = angle_past_shaft(X_world_lens);
             if (angle <= best || !Shows(seen, X_world_lens, points)) return false;
             best = angle;
             view = joints;
             return best > kWellPastShaft;
           });
  if (view) Add(SurgeonAct::Kind::kLookFrom, "look past the shaft", 8.0).camera = *view;
}

}  // namespace trocar::agent
