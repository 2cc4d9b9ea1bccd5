// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "operation/tools/tool_use.h"

namespace trocar::simulation {

using math::Vec3;
using surgery::FactKind;

namespace {

/// Index of the surface of a node, or -1: of one that a cut has made.
std::int32_t SurfaceOf(std::span<const scene::SurfaceInfo> surfaces, std::uint32_t node) noexcept {
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const scene::SurfaceInfo& surface = surfaces[i];
    if (node >= surface.first_node && node < surface.first_node + surface.node_count)
      return static_cast<std::int32_t>(i);
  }
  return -1;
}

}  // namespace

void UseElectrode(ToolUse& use, ElectrodeUse& state) noexcept {
  const scene::HandControls& controls = use.controls;
  if (!controls.cut && !controls.coagulate) {
    state.idle_seconds = 0;
    return;
  }
  const math::Pose& X = use.X_proxy;
  const scene::ElectrodeParameters& parameters = use.parameters.electrode;
  surgery::Electrosurgery::Electrode electrode;
  if (instrument::AbilitiesOf(use.tool.kind).electrode == instrument::Electrode::kToe) {
    const surgery::BladeSettings blade;
    electrode.bare = {X * blade.p_tool_hook.a, X * blade.p_tool_hook.b};
  } else {
    electrode.bare = {X.translation, X * Vec3{0, 0, 0.25 * use.tool.jaw_length}};
  }
  const scene::CurrentParameters& current = controls.cut ? parameters.cut : parameters.coagulate;
  electrode.power = current.power;
  electrode.reach = current.reach;
  surgery::Electrosurgery& heat = use.parts.heat;
  std::array<surgery::Electrosurgery::Target, kMostHeated> targets;
  const std::size_t count =
      heat.FindTargets(electrode, use.tissue.organs, use.tissue.tubes, use.tissue.state, targets);
  state.idle_seconds = count == 0 ? state.idle_seconds + use.seconds : 0.0;
  surgery::Fact fact = use.MakeFact(FactKind::kCurrentOn);
  fact.is_coagulating = !controls.cut;
  fact.amount = state.idle_seconds;
  use.facts.Add(fact);
  if (count == 0) return;
  state.has_current = true;
  heat.AddPower(electrode, std::span(targets).first(count));
  if (controls.coagulate)
    use.parts.vessels->Seal(X.translation, parameters.seal_reach,
                            electrode.power * use.seconds / parameters.seal_heat, use.tissue.state.position);
  fact.kind = FactKind::kCurrentInto;
  fact.amount = 0;
  const std::size_t nodes = use.tissue.definition.rest.size();
  for (const surgery::Electrosurgery::Target& target : std::span(targets).first(count)) {
    const bool is_strand = target.part >= nodes;
    fact.strand = is_strand ? static_cast<std::int32_t>(target.part - nodes) : -1;
    fact.surface = is_strand ? -1 : SurfaceOf(use.made.surfaces, target.part);
    use.facts.Add(fact);
  }
}

}  // namespace trocar::simulation
