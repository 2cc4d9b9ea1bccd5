// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "operation/tools/tool_use.h"
#include "trocar/math/elementary.h"

namespace trocar::simulation {

using surgery::FactKind;

void UseSuction(ToolUse& use, SuctionUse& state) noexcept {
  const scene::SuctionParameters& suction = use.parameters.suction;
  const math::Vec3& tip = use.X_proxy.translation;
  OperatedParts& parts = use.parts;
  state.is_rinsing = use.controls.rinse;
  state.is_aspirating = use.controls.aspirate;
  surgery::Fact fact = use.MakeFact(FactKind::kRinse);
  if (state.is_rinsing) {
    fact.amount = suction.rinse_rate * use.seconds;
    parts.fluids.Rinse(fact.amount);
    use.facts.Add(fact);
  }
  if (!state.is_aspirating) return;
  parts.smoke *= std::max(0.0, 1.0 - suction.smoke_rate * use.seconds);
  AddRetrieved(use, parts.stones.Aspirate(tip, 2.0 * instrument::kSuctionBore * use.tool.shaft_radius));
  // the pool as a half sphere
  const double radius = math::Cbrt(parts.fluids.Pooled() * 3.0 / (2.0 * M_PI));
  if (math::Distance(tip, use.anatomy.p_pool) > radius + suction.pool_reach) return;
  fact.kind = FactKind::kAspirate;
  fact.amount = parts.fluids.Aspirate(suction.aspirate_rate * use.seconds);
  if (fact.amount > 0.0) use.facts.Add(fact);
}

}  // namespace trocar::simulation
