// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "operation/tools/tool_use.h"
#include "trocar/geometry/openings.h"

namespace trocar::simulation {

using surgery::FactKind;

namespace {

void CutStrands(const surgery::BladeMove& move, ToolUse& use) noexcept {
  std::array<std::uint32_t, kMostStrandsCut> cut;
  const std::size_t count =
      surgery::FindCutStrands(move, use.tissue.definition.strands, use.tissue.state, cut);
  for (const std::uint32_t strand : std::span(cut).first(count)) {
    use.tissue.state.strand_is_intact[strand] = 0;
    use.AddOfStrand(FactKind::kStrandCut, strand);
  }
}

void CutTubes(const surgery::BladeMove& move, ToolUse& use) noexcept {
  std::array<surgery::TubePlace, surgery::CuttableTubes::kMostCuts> places;
  const std::size_t count = use.parts.vessels->Cut(move, use.tissue.definition, use.tissue.state.position,
                                                   use.parts.change, places);
  for (const surgery::TubePlace& place : std::span(places).first(count))
    use.AddOfTube(FactKind::kTubeCut, place);
}

/// A blade that went through the wall of a hollow organ leaves it open as far as the wall gapes.
void OpenHollow(std::size_t organ, ToolUse& use, bool is_sealed) noexcept {
  std::array<geometry::Opening, 8> openings;
  const std::size_t found =
      std::min(openings.size(), geometry::FindOpenings(use.parts.organs[organ].Mesh(), openings));
  double area = 0;
  for (std::size_t k = 0; k < found; ++k) area += openings[k].area;
  WallDamage& wall = use.parts.wall;
  if (found == 0) return;
  if (is_sealed) {
    wall.open_area = std::max(area, wall.open_area);  // a later cut leaks by what it adds
    return;
  }
  surgery::Fact fact = use.MakeFact(FactKind::kOrganOpened);
  fact.surface = static_cast<std::int32_t>(organ);
  fact.amount = area;
  use.facts.Add(fact);
  use.tissue.conservation.Perforate(
      organ, std::max(use.parameters.electrode.burnt_hole, area - wall.open_area), use.tissue.conserved);
  wall.open_area = std::max(area, wall.open_area);
}

void CutOrgans(const surgery::BladeMove& move, ToolUse& use, std::span<geometry::CutFront> fronts,
               bool is_sealed) noexcept {
  for (std::size_t i = 0; i < use.parts.organs.size(); ++i) {
    const geometry::CutReport report = use.parts.organs[i].Cut(
        move.before, move.now, use.tissue.state.position, fronts[i], use.parts.change);
    if (!report.HasChanged()) continue;
    surgery::Fact fact = use.MakeFact(FactKind::kOrganCut);
    fact.surface = static_cast<std::int32_t>(i);
    use.facts.Add(fact);
    if (fact.surface == use.anatomy.organ) OpenHollow(i, use, is_sealed);
  }
}

}  // namespace

void Divide(const surgery::BladeMove& move, ToolUse& use, std::span<geometry::CutFront> fronts,
            bool cuts_strands, bool is_sealed) noexcept {
  if (cuts_strands) CutStrands(move, use);
  CutTubes(move, use);
  CutOrgans(move, use, fronts, is_sealed);
}

void UseBlade(ToolUse& use, BladeUse& state) noexcept {
  const bool is_hook = instrument::AbilitiesOf(use.tool.kind).blade == instrument::Blade::kHeel;
  surgery::BladeSettings settings;
  settings.kind = is_hook ? surgery::BladeKind::kHook : surgery::BladeKind::kScissors;
  // the hook that is seen never enters tissue: it cuts where the hand presses it
  const auto move = surgery::MoveBlade(use.tool, is_hook ? use.X_device : use.X_proxy, use.jaw,
                                       use.controls.cut, settings, state.blade);
  if (!move) {
    for (geometry::CutFront& front : state.fronts) front = {};
    return;
  }
  Divide(*move, use, state.fronts, !is_hook, false);  // the hook's current parts strands
}

}  // namespace trocar::simulation
