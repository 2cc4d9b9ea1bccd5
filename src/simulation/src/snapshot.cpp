// SPDX-License-Identifier: Apache-2.0
#include "trocar/simulation/snapshot.h"

#include <cmath>

#include "trocar/math/state_fields.h"

namespace trocar::simulation {

std::string_view StageName(Stage stage) noexcept {
  static constexpr std::string_view kNames[kStageCount] = {
      "read_inputs",  "move_tools", "find_contacts", "use_tools",   "heat",         "assistant",
      "topology",     "tissue",     "guard",         "place_tools", "rigid_bodies", "flow",
      "loose_bodies", "camera",     "judgement",     "publish",     "task_rules"};
  return kNames[static_cast<int>(stage)];
}

bool IsInView(const Pose& X_world_laparoscope, double field_of_view, const Vec3& p_world) noexcept {
  const Vec3 p = math::Inverse(X_world_laparoscope) * p_world;
  return -p.z > 0 && -p.z >= std::cos(0.5 * field_of_view) * math::Norm(p);
}

}  // namespace trocar::simulation
