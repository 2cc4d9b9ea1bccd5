// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "operation/tools/tool_use.h"

namespace trocar::simulation {

using math::Vec3;
using surgery::ClipResult;
using surgery::FactKind;

namespace {

/// Rows of staples, by their distance from the knife's line along what is divided [m]: two on each side.
constexpr std::array kRows = {-0.0030, -0.0015, 0.0015, 0.0030};
constexpr double kKnifeStops = 0.0015;  // before the last staple [m]
constexpr std::size_t kMostTubes = 4;   // between the jaws at a time

void StapleTubes(ToolUse& use) noexcept {
  surgery::Vessels& vessels = *use.parts.vessels;
  std::array<surgery::Vessels::Caught, kMostTubes> caught;
  const std::size_t count = vessels.CatchBetween(use.tool, use.X_proxy, use.tissue.state.position, caught);
  for (const surgery::Vessels::Caught& tube : std::span(caught).first(count)) {
    for (const double row : kRows) {
      const ClipResult staples = vessels.Staple(use.tool, use.X_proxy, tube, row);
      if (staples.kind == ClipResult::Kind::kLost) continue;
      surgery::Fact fact = use.MakeFact(FactKind::kClipClosed);
      fact.is_partial = staples.kind == ClipResult::Kind::kPartial;
      fact.surface = static_cast<std::int32_t>(use.parts.organs.size() + staples.place.tube);
      fact.along = staples.place.arc;
      fact.p_rest = vessels.RestPoint(staples.place);
      use.facts.Add(fact);
    }
  }
}

/// The knife runs through the middle plane of the jaws, as wide as they are thick.
surgery::BladeMove KnifeOf(const ToolUse& use) noexcept {
  const auto edge = [&use](double y) {
    return geometry::BladeEdge{use.X_proxy * Vec3{0, y, use.tool.jaw_length},
                               use.X_proxy * Vec3{0, y, kKnifeStops}};
  };
  return {edge(use.tool.jaw_thickness), edge(-use.tool.jaw_thickness)};
}

}  // namespace

void UseStapler(ToolUse& use, ClipUse& state, std::span<geometry::CutFront> fronts) noexcept {
  if (use.jaw > kOpenAgain * use.tool.max_jaw) state.has_clip_open = state.clips > 0;
  if (!state.has_clip_open || use.jaw > kBitten * use.tool.max_jaw || !use.controls.cut) return;
  state.has_clip_open = false;
  --state.clips;
  StapleTubes(use);
  Divide(KnifeOf(use), use, fronts, true, true);
  for (geometry::CutFront& front : fronts) front = {};
}

}  // namespace trocar::simulation
