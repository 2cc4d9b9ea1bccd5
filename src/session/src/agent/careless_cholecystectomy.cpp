// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <span>

#include "cholecystectomy_surgeon.h"

namespace trocar::session {
namespace {

constexpr double kStandOff = -0.012;  // of a tool's tip from the vessel while it is lined up [m]
constexpr double kFromTips = 0.0018;  // of a vessel's axis, so that the clip reaches around it [m]
constexpr double kAnother = 0.05;     // of a vessel's length, to another place for a clip
constexpr double kBesideHold = 0.015, kBesideWeight = 4.0;  // of a place in the wall from the hold [m], [-]
constexpr double kSpillSeconds = 8.0;                       // in which stones leave through a hole
constexpr double kBetweenLegs = 0.003;  // of a clip applier's middle line, where a vessel is to be [m]

Vec3 MeanPort(const Scene& scene) {
  return 0.5 * (scene.instruments[kLeft].p_world_port + scene.instruments[kRight].p_world_port);
}

}  // namespace

Vec3 CholecystectomySurgeon::Aim(const Snapshot& seen, std::size_t tube, double share, double ahead) const {
  const Vec3 p = TubePoint(seen, tube, share);
  return p + ahead * math::Normalized(p - hands_[kRight].Port());
}

void CholecystectomySurgeon::LineUp(const std::string& what, std::size_t tube, double share, double jaw) {
  Add(
      "line up the " + what,
      [this, tube, share, jaw](const Snapshot& seen) {
        const Vec3 p = TubePoint(seen, tube, share);
        const Vec3 shaft = math::Normalized(p - HandOf(kRight).Port());
        HandOf(kRight).Turn(
            FindSpin(HandOf(kRight).Port(), p, math::Cross(shaft, TubeDirection(seen, tube, share))));
        HandOf(kRight).SetJaw(jaw);
        HandOf(kRight).MoveTo(Aim(seen, tube, share, kStandOff));
      },
      [this](const Snapshot&) { return !HandOf(kRight).IsMoving() && !HandOf(kRight).IsTurning(); }, 5.0);
}

/// \param beyond  how far from the tips, as a share of the jaws, the vessel lies in them
/// \param tries   how often it is lined up anew when the vessel is not between the legs
void CholecystectomySurgeon::PlaceClip(std::size_t tube, double share, double beyond, int tries) {
  const instrument::Tool& applier = *instrument::FindTool("clip_applier");
  LineUp("clip", tube, share, applier.max_jaw);
  Reach(
      kRight,
      [this, tube, share, ahead = beyond * applier.jaw_length](const Snapshot& seen) {
        return Aim(seen, tube, share, ahead);
      },
      0.4);
  Wait(0.2);
  Decide("look at the clip's tips", [this, tube, share, beyond, tries, &applier](const Snapshot& seen) {
    const Pose& X = seen.instruments[kRight].X_world_tool;
    const Vec3 in = math::Inverse(X) * TubePoint(seen, tube, share);
    const bool is_between =
        std::hypot(in.x, in.y) < kBetweenLegs && in.z > kFromTips && in.z < applier.jaw_length - kFromTips;
    if (is_between || tries == 0) return CloseClip(tube, share);
    Reach(kRight, [this, tube, share](const Snapshot& now) { return Aim(now, tube, share, kStandOff); });
    // a little farther along, then a little nearer
    PlaceClip(tube, share + (tries % 2 == 0 ? kAnother : -2 * kAnother), beyond, tries - 1);
  });
}

void CholecystectomySurgeon::CloseClip(std::size_t tube, double share) {
  Add(
      "close the clip", [this](const Snapshot&) { HandOf(kRight).SetJaw(0.0); },
      [this](const Snapshot&) { return act_seconds_ > 0.7; }, 2.0);
  // open enough to leave the clip, not so far that the next one comes
  Jaw(kRight, 0.4);
  Reach(
      kRight, [this, tube, share](const Snapshot& seen) { return Aim(seen, tube, share, -0.020); }, 0.6);
}

void CholecystectomySurgeon::CutTube(std::size_t tube, double share) {
  const instrument::Tool& scissors = *instrument::FindTool("scissors");
  LineUp("scissors", tube, share, scissors.max_jaw);
  Reach(
      kRight,
      [this, tube, share, ahead = 0.4 * scissors.jaw_length](const Snapshot& seen) {
        return Aim(seen, tube, share, ahead);
      },
      0.4);
  Add(
      "cut", [this](const Snapshot&) { HandOf(kRight).SetJaw(0.0); },
      [this](const Snapshot&) { return act_seconds_ > 0.7; }, 2.0);
  Reach(
      kRight, [this, tube, share](const Snapshot& seen) { return Aim(seen, tube, share, -0.020); }, 0.6);
}

/// Of the gallbladder, near what the left hand holds, so that it does not give way; towards the right hand's trocar.
Vec3 CholecystectomySurgeon::WallBesideHold(const Snapshot& seen) const {
  const SurfaceInfo& wall = surfaces_[static_cast<std::size_t>(scene_->patient.FindOrgan("gallbladder"))];
  const auto positions = std::span(seen.positions).subspan(wall.first_node, wall.node_count);
  const auto cost = [&](const Vec3& p) {
    const double away = math::Distance(p, hands_[kLeft].Tip());
    return math::Distance(p, hands_[kRight].Port()) + kBesideWeight * std::fabs(away - kBesideHold);
  };
  return *std::min_element(positions.begin(), positions.end(),
                           [&](const Vec3& a, const Vec3& b) { return cost(a) < cost(b); });
}

void CholecystectomySurgeon::PlanFlaw(OperationFlaw flaw) {
  using instrument::ToolKind;
  const std::size_t duct = FindTube("cystic_duct"), artery = FindTube("cystic_artery"),
                    main = FindTube("common_hepatic_duct");
  const Place liver = [this](const Snapshot& seen) { return seen.positions[liver_node_]; };
  const auto clip = [this] { Exchange(kRight, ToolKind::kClipApplier); };
  const auto scissors = [this] { Exchange(kRight, ToolKind::kScissors); };
  const auto tube_at = [this](std::size_t tube, double share) -> Place {
    return [this, tube, share](const Snapshot& seen) { return HookTip(TubePoint(seen, tube, share)); };
  };
  switch (flaw) {
    case OperationFlaw::kNone:
      break;
    case OperationFlaw::kClipsMainDuct:
      clip();
      PlaceClip(main, 0.5);
      break;
    case OperationFlaw::kCutsMainDuct:
      scissors();
      CutTube(main, 0.75);
      break;
    case OperationFlaw::kBurnsMainDuct:
      Burn(kRight, tube_at(main, 0.6), 20.0);
      break;
    case OperationFlaw::kCutsUnclipped:
      scissors();
      CutTube(duct, 0.4);
      break;
    case OperationFlaw::kClipsEarly:
      clip();
      PlaceClip(duct, 0.5);
      break;
    case OperationFlaw::kTooFewClips:
      clip();
      PlaceClip(duct, 0.6);
      scissors();
      CutTube(duct, 0.36);
      break;
    case OperationFlaw::kCrossesClips:
      clip();
      PlaceClip(duct, 0.5);
      PlaceClip(duct, 0.5);
      break;
    case OperationFlaw::kClipsPartly:
      clip();
      PlaceClip(duct, 0.5, 0.1);
      break;
    case OperationFlaw::kBleeds:
      scissors();
      CutTube(artery, 0.65);
      Wait(60.0);
      break;
    case OperationFlaw::kSlipsClip:
      clip();
      PlaceClip(artery, 0.75, 0.0);
      scissors();
      CutTube(artery, 0.5);
      Wait(10.0);
      break;
    case OperationFlaw::kPerforates:
      Burn(
          kRight, [this](const Snapshot& seen) { return HookTip(seen.positions[neck_]); }, 10.0);
      break;
    case OperationFlaw::kLeavesStones:
      FreeGallbladder();
      Burn(
          kRight, [this](const Snapshot& seen) { return HookTip(WallBesideHold(seen)); }, 6.0);
      Wait(kSpillSeconds);
      Remove();
      break;
    case OperationFlaw::kBurnsLiver:
      Burn(
          kRight, [this](const Snapshot& seen) { return HookTip(seen.positions[liver_node_]); }, 15.0);
      break;
    case OperationFlaw::kBurnsNearDuct:
      Burn(kRight, tube_at(main, 0.6), 0.5);
      break;
    case OperationFlaw::kBurnsUnseen:
      Burn(
          kRight,
          [this](const Snapshot&) {
            return HandOf(kRight).Port() + 0.035 * Vec3{0.2, 0.1, -1.0};
          },
          0.5);
      break;
    case OperationFlaw::kBurnsAir:
      Burn(
          kRight,
          [this](const Snapshot& seen) {
            const Vec3 field = seen.positions[neck_];
            return field + 0.05 * math::Normalized(MeanPort(*scene_) - field);
          },
          0.5);
      break;
    case OperationFlaw::kDropsClip:
      clip();
      Jaw(kRight, 1.0);
      Jaw(kRight, 0.0);
      break;
    case OperationFlaw::kGraspsLiver:
      Grasp(kLeft, liver);
      break;
    case OperationFlaw::kPullsHard:
      // a light grip, and a strong pull
      Grasp(
          kLeft, [this](const Snapshot& seen) { return seen.positions[hold_]; }, 0.17);
      Draw(kLeft, {0.0, -0.09, 0.06});
      Wait(1.0);
      break;
    case OperationFlaw::kCutsLiver: {
      const auto in_liver = [this](double along) -> Place {
        return [this, along](const Snapshot& seen) {
          const Vec3 p = seen.positions[liver_node_];
          const Vec3 in = math::Normalized(p - HandOf(kRight).Port());
          return p + 0.006 * in + along * math::Normalized(math::Cross(in, {0, 1, 0}));
        };
      };
      Reach(kRight, in_liver(-0.006), 0.5);
      Add(
          "press the pedal", [this](const Snapshot&) { controls_[kRight].cut = true; },
          [](const Snapshot&) { return true; }, 1.0);
      Reach(kRight, in_liver(0.010), 0.1);
      Add(
          "let go of the pedal", [this](const Snapshot&) { controls_[kRight].cut = false; },
          [](const Snapshot&) { return true; }, 1.0);
      break;
    }
    case OperationFlaw::kInsertsBlind:
      Exchange(kRight, ToolKind::kScissors);
      Reach(kRight, [this](const Snapshot&) { return HandOf(kRight).Port() + 0.10 * Vec3{0.6, -0.3, -0.7}; });
      Exchange(kRight, ToolKind::kHook, false);
      Wait(3.0);
      break;
  }
  Wait(0.5);
}

}  // namespace trocar::session
