// SPDX-License-Identifier: Apache-2.0
#include "operation/tools/tool_use.h"

namespace trocar::simulation {

using surgery::ClipResult;
using surgery::FactKind;

void UseClips(ToolUse& use, ClipUse& state) noexcept {
  const instrument::Tool& tool = use.tool;
  surgery::Vessels& vessels = *use.parts.vessels;
  if (use.jaw > kOpenAgain * tool.max_jaw) {
    state.has_clip_open = state.clips > 0;
    // as long as they open, or rest; what lies there when they close is caught
    if (use.jaw >= state.opened || !state.caught) {
      state.opened = use.jaw;
      state.caught = vessels.Catch(tool, use.X_proxy, use.jaw, use.tissue.state.position);
    }
  }
  if (!state.has_clip_open || use.jaw > kBitten * tool.max_jaw) return;
  state.has_clip_open = false;
  --state.clips;
  const ClipResult clip = vessels.Clip(tool, use.X_proxy, state.caught, use.tissue.state.position);
  state.caught.reset();
  state.opened = 0;
  surgery::Fact fact = use.MakeFact(FactKind::kClipClosed);
  fact.is_crossed = clip.is_crossed;
  fact.is_partial = clip.kind == ClipResult::Kind::kPartial;
  if (clip.kind == ClipResult::Kind::kLost) {
    fact.kind = FactKind::kClipLost;
  } else {
    fact.surface = static_cast<std::int32_t>(use.parts.organs.size() + clip.place.tube);
    fact.along = clip.place.arc;
    fact.p_rest = vessels.RestPoint(clip.place);
  }
  use.facts.Add(fact);
}

}  // namespace trocar::simulation
