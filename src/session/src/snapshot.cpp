// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/snapshot.h"

#include <cmath>

#include "trocar/math/state_fields.h"

namespace trocar::session {

std::string_view StageName(Stage stage) noexcept {
  static constexpr std::string_view kNames[kStageCount] = {
      "read_inputs",  "move_tools",   "find_contacts", "use_tools", "heat",      "assistant", "topology",
      "tissue",       "guard",        "place_tools",   "rigid_bodies", "flow",   "loose_bodies", "camera",
      "judgement",    "publish",      "task_rules"};
  return kNames[static_cast<int>(stage)];
}

std::string_view EventName(EventKind kind) noexcept {
  switch (kind) {
    case EventKind::kGrasp:
      return "grasp";
    case EventKind::kRelease:
      return "release";
    case EventKind::kSlip:
      return "slip";
    case EventKind::kGraspMissed:
      return "grasp_missed";
    case EventKind::kStateRestored:
      return "state_restored";
    case EventKind::kOrganFrozen:
      return "organ_frozen";
    case EventKind::kTear:
      return "tear";
    case EventKind::kPinchDamage:
      return "pinch_damage";
    case EventKind::kToolsTouch:
      return "tools_touch";
    case EventKind::kExchangeRefused:
      return "exchange_refused";
    case EventKind::kClipClosed:
      return "clip_closed";
    case EventKind::kTubeCut:
      return "tube_cut";
    case EventKind::kNoClipsLeft:
      return "no_clips_left";
    case EventKind::kUsedOutside:
      return "used_outside";
    case EventKind::kClipSlipped:
      return "clip_slipped";
    case EventKind::kStoneSpilled:
      return "stone_spilled";
    case EventKind::kStoneTaken:
      return "stone_taken";
    case EventKind::kStoneRetrieved:
      return "stone_retrieved";
    case EventKind::kOperationError:
      break;
  }
  return "operation_error";
}

void VisitState(core::StateArchive& archive, Event& event) {
  archive.Field("kind", event.kind);
  archive.Field("tick", event.tick);
  archive.Field("hand", event.hand);
  archive.Field("organ", event.organ);
  archive.Field("force", event.force);
  archive.Field("object", event.object);
  archive.Field("error", event.error);
  archive.Field("p_rest", event.p_rest);
}

bool IsInView(const Pose& X_world_laparoscope, double field_of_view, const Vec3& p_world) noexcept {
  const Vec3 p = math::Inverse(X_world_laparoscope) * p_world;
  return -p.z > 0 && -p.z >= std::cos(0.5 * field_of_view) * math::Norm(p);
}

}  // namespace trocar::session
