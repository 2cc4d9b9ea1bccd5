// SPDX-License-Identifier: Apache-2.0
#include "operation/tools/tool_use.h"

namespace trocar::simulation {

// a hand heats and spreads, or heats and cuts; the rest is for organs, stones, clips and what jaws hold
static_assert(surgery::FactList::kCapacity >= instrument::kHandCount * (kMostHeated + 2 * kMostStrandsSpread +
                                                                        surgery::CuttableTubes::kMostCuts) +
                                                  48);

surgery::Fact ToolUse::MakeFact(surgery::FactKind kind) const noexcept {
  surgery::Fact fact;
  fact.kind = kind;
  fact.hand = static_cast<std::int8_t>(hand);
  fact.tool = tool.kind;
  fact.position = X_proxy.translation;
  return fact;
}

void ToolUse::AddOfTube(surgery::FactKind kind, const surgery::TubePlace& place) noexcept {
  surgery::Fact fact = MakeFact(kind);
  fact.surface = static_cast<std::int32_t>(parts.organs.size() + place.tube);
  fact.along = place.arc;
  fact.amount = static_cast<double>(parts.vessels->CountCuts(place.tube));
  fact.p_rest = parts.vessels->RestPoint(place);
  facts.Add(fact);
}

void ToolUse::AddOfStrand(surgery::FactKind kind, std::uint32_t strand) noexcept {
  surgery::Fact fact = MakeFact(kind);
  fact.strand = static_cast<std::int32_t>(strand);
  facts.Add(fact);
}

void AddRetrieved(ToolUse& use, int count) noexcept {
  for (int i = 0; i < count; ++i) use.facts.Add(use.MakeFact(surgery::FactKind::kStoneRetrieved));
}

}  // namespace trocar::simulation
