// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/snapshot.h"

#include <cmath>

namespace trocar::session {

std::string_view StageName(Stage stage) noexcept {
  static constexpr std::string_view kNames[kStageCount] = {
      "read_inputs", "move_instruments", "find_contacts", "act_on_tissue", "solve",
      "check_state", "update_hierarchy", "detect_events", "publish"};
  return kNames[static_cast<int>(stage)];
}

bool IsInView(const Pose& X_world_laparoscope, double field_of_view, const Vec3& p_world) noexcept {
  const Vec3 p = math::Inverse(X_world_laparoscope) * p_world;
  return -p.z > 0 && -p.z >= std::cos(0.5 * field_of_view) * math::Norm(p);
}

}  // namespace trocar::session
