// SPDX-License-Identifier: Apache-2.0
#include "surgeon_act.h"

#include "state_fields.h"

namespace trocar::agent {

void SurgeonAct::VisitState(base::StateArchive& archive) {
  archive.Field("kind", kind);
  archive.Field("doing", doing);
  archive.Field("time_limit", time_limit);
  archive.Field("hand", hand);
  archive.Field("place", place);
  archive.Field("hurry", hurry);
  archive.Field("seconds", seconds);
  archive.Field("share", share);
  archive.Field("amount", amount);
  archive.Field("distance", distance);
  archive.Field("by", by);
  archive.Field("count", count);
  archive.Field("side", side);
  archive.Field("node", node);
  archive.Field("tube", tube);
  archive.Field("tubes", tubes);
  archive.Field("strands", strands);
  archive.Field("may", may);
  archive.Field("is_on", is_on);
  archive.Field("tool", tool);
  archive.Field("tool_kind", tool_kind);
  archive.Field("command", command);
  archive.Field("camera", camera);
}

}  // namespace trocar::agent
