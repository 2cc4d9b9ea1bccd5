// SPDX-License-Identifier: Apache-2.0
#include "trocar/scene/event.h"

#include "trocar/math/state_fields.h"

namespace trocar::scene {

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

void VisitState(base::StateArchive& archive, Event& event) {
  archive.Field("kind", event.kind);
  archive.Field("tick", event.tick);
  archive.Field("hand", event.hand);
  archive.Field("organ", event.organ);
  archive.Field("force", event.force);
  archive.Field("object", event.object);
  archive.Field("error", event.error);
  archive.Field("p_rest", event.p_rest);
}

}  // namespace trocar::scene
