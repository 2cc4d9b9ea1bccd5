// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "operation/tools/tool_use.h"

namespace trocar::simulation {
namespace {

/// A jaw as an edge, hinge to tip.
geometry::BladeEdge JawEdge(const ToolUse& use, int side) {
  return {use.X_proxy * instrument::JawHinge(use.tool),
          use.X_proxy * instrument::JawTip(use.tool, use.jaw, side)};
}

}  // namespace

void Spread(ToolUse& use, SpreadUse& state) noexcept {
  const bool opens = use.jaw > state.upper.jaw;
  state.upper.jaw = use.jaw;
  const auto edges = std::array{JawEdge(use, +1), JawEdge(use, -1)};
  auto& upper = state.upper.edge;
  auto& lower = state.lower.edge;
  if (opens && upper && lower) {
    // what a jaw pushes before it as it opens gives way, fibre by fibre
    for (const auto& move : {surgery::BladeMove{*upper, edges[0]}, surgery::BladeMove{*lower, edges[1]}}) {
      std::array<std::uint32_t, kMostStrandsSpread> torn;
      const std::size_t count =
          surgery::FindCutStrands(move, use.tissue.definition.strands, use.tissue.state, torn);
      for (const std::uint32_t strand : std::span(torn).first(count)) {
        // a duct's end does not give way to a jaw
        if (use.made.strands[strand].kind == roles::StrandRole::kEnd) continue;
        use.tissue.state.strand_is_intact[strand] = 0;
        use.AddOfStrand(surgery::FactKind::kStrandSpread, strand);
      }
    }
  }
  upper = edges[0];
  lower = edges[1];
}

}  // namespace trocar::simulation
