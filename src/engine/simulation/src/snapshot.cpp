// SPDX-License-Identifier: Apache-2.0
#include "trocar/simulation/snapshot.h"

namespace trocar::simulation {

std::string_view StageName(Stage stage) noexcept {
  static constexpr std::string_view kNames[kStageCount] = {
      "read_inputs", "move_tools",   "find_contacts", "use_tools", "heat",        "witness",
      "assistant",   "topology",     "tissue",        "guard",     "place_tools", "rigid_bodies",
      "flow",        "loose_bodies", "camera",        "judgement", "publish",     "task_rules"};
  return kNames[static_cast<int>(stage)];
}

}  // namespace trocar::simulation
