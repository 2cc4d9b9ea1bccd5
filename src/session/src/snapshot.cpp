// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/snapshot.h"

namespace trocar::session {

std::string_view StageName(Stage stage) noexcept {
  static constexpr std::string_view kNames[kStageCount] = {
      "read_inputs", "move_instruments", "find_contacts", "act_on_tissue", "solve",
      "check_state", "update_hierarchy", "detect_events", "publish"};
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
      break;
  }
  return "exchange_refused";
}

}  // namespace trocar::session
