// SPDX-License-Identifier: Apache-2.0
// Parts of an input that are written field by field where they change.
#pragma once

#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/scene/input.h"

namespace trocar::tissue {

inline void VisitState(base::StateArchive& archive, RelaxationSettings& settings) {
  archive.Field("alpha", settings.alpha);
}

inline void VisitState(base::StateArchive& archive, NewtonSettings& settings) {
  archive.Field("max_steps", settings.max_steps);
  archive.Field("max_linear_iterations", settings.max_linear_iterations);
  archive.Field("max_linear_total", settings.max_linear_total);
  archive.Field("follows_snap_through", settings.follows_snap_through);
}

inline void VisitState(base::StateArchive& archive, OuterIterationSettings& settings) {
  archive.Field("law_error", settings.law_error);
  archive.Field("max_count", settings.max_count);
}

inline void VisitState(base::StateArchive& archive, SolverSettings& settings) {
  archive.Field("kind", settings.kind);
  archive.Field("max_iterations", settings.max_iterations);
  archive.Field("tolerance", settings.tolerance);
  archive.Field("relaxation", settings.relaxation);
  archive.Field("max_error", settings.max_error);
  archive.Field("newton", settings.newton);
  archive.Field("outer", settings.outer);
}

}  // namespace trocar::tissue

namespace trocar::scene {

inline void VisitState(base::StateArchive& archive, HandControls& controls) {
  archive.Field("tool", controls.tool);
  archive.Field("cut", controls.cut);
  archive.Field("coagulate", controls.coagulate);
  archive.Field("rinse", controls.rinse);
  archive.Field("aspirate", controls.aspirate);
}

inline void VisitState(base::StateArchive& archive, LiveSettings& settings) {
  archive.Field("stiffness_scale", settings.stiffness_scale);
  archive.Field("shape_scale", settings.shape_scale);
  archive.Field("gravity", settings.gravity);
  archive.Field("head_up", settings.head_up);
  archive.Field("right_up", settings.right_up);
  archive.Field("holds_camera", settings.holds_camera);
  archive.Field("solver", settings.solver);
}

}  // namespace trocar::scene

namespace trocar::record {

/// Bit for bit, so that what is not a number is the same as itself.
inline bool HaveSameFields(const scene::LiveSettings& a, const scene::LiveSettings& b) {
  std::vector<std::byte> of_a, of_b;
  base::SaveState(a, of_a);
  base::SaveState(b, of_b);
  return of_a == of_b;
}

}  // namespace trocar::record
