// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/blade.h"

#include <algorithm>

#include "trocar/math/state_fields.h"

namespace trocar::surgery {
namespace {

/// The piece between the blades, at the place up to which they are closed.
geometry::BladeEdge CalcScissorsEdge(const instrument::Tool& tool, const math::Pose& X_world_tool,
                                     double jaw) {
  const double closed = std::clamp(1.0 - jaw / tool.max_jaw, 0.0, 1.0);
  const math::Vec3 hinge = instrument::JawHinge(tool);
  const auto at = [&](int side) {
    return X_world_tool * math::Lerp(hinge, instrument::JawTip(tool, jaw, side), closed);
  };
  return {at(+1), at(-1)};
}

}  // namespace

std::optional<BladeMove> MoveBlade(const instrument::Tool& tool, const math::Pose& X_world_tool, double jaw,
                                   bool has_power, const BladeSettings& settings,
                                   BladeState& state) noexcept {
  const bool is_scissors = settings.kind == BladeKind::kScissors;
  const bool cuts = is_scissors ? jaw < state.jaw : has_power;
  const double jaw_before = state.jaw;
  state.jaw = jaw;
  if (!cuts) {
    state.edge.reset();
    return std::nullopt;
  }
  const geometry::BladeEdge now = is_scissors ? CalcScissorsEdge(tool, X_world_tool, jaw)
                                              : geometry::BladeEdge{X_world_tool * settings.p_tool_hook.a,
                                                                    X_world_tool * settings.p_tool_hook.b};
  // the first tick of a bite starts from where the jaws were; that of a hook from where power came on
  if (!state.edge) state.edge = is_scissors ? CalcScissorsEdge(tool, X_world_tool, jaw_before) : now;
  const BladeMove move{*state.edge, now};
  state.edge = now;
  return move;
}

std::size_t FindCutStrands(const BladeMove& move, std::span<const tissue::Strand> strands,
                           const tissue::TissueState& state, std::span<std::uint32_t> cut) noexcept {
  const geometry::BladeMoves moves = geometry::MakeFlatMoves(move.before, move.now);
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < strands.size() && count < cut.size(); ++i) {
    if (!state.strand_is_intact[i]) continue;
    const math::Vec3 &a = state.position[strands[i].a], &b = state.position[strands[i].b];
    const auto parts = moves.Moves();
    if (std::any_of(parts.begin(), parts.end(), [&](const geometry::FlatMove& part) {
          return geometry::FindCrossing(part.sweep, a, b).has_value();
        }))
      cut[count++] = i;
  }
  return count;
}

void VisitState(base::StateArchive& archive, BladeState& blade) {
  std::uint8_t has_edge = blade.edge ? 1 : 0;
  archive.Field("has_edge", has_edge);
  if (archive.IsRestoring()) {
    blade.edge.reset();
    if (has_edge != 0) blade.edge.emplace();
  }
  if (blade.edge) {
    archive.Field("a", blade.edge->a);
    archive.Field("b", blade.edge->b);
  }
  archive.Field("jaw", blade.jaw);
}

}  // namespace trocar::surgery
