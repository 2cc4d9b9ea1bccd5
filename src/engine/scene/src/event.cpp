// SPDX-License-Identifier: Apache-2.0
#include "trocar/scene/event.h"

#include "trocar/math/state_fields.h"

namespace trocar::scene {

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
