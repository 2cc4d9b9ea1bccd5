// SPDX-License-Identifier: Apache-2.0
#include "cholecystectomy_surgeon.h"

namespace trocar::session {
namespace {

Vec3 MeanPort(const Scene& scene) {
  return 0.5 * (scene.instruments[kLeft].p_world_port + scene.instruments[kRight].p_world_port);
}

}  // namespace

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
    case OperationFlaw::kPerforates:
      Burn(
          kRight, [this](const Snapshot& seen) { return HookTip(seen.positions[neck_]); }, 10.0);
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
