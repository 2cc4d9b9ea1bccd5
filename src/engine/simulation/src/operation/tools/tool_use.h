// SPDX-License-Identifier: Apache-2.0
/// \file tool_use.h  Mechanisms of the tools: each is a function of one use of a tool, with a small state of its own, in a file of
/// its own. Which tool has which stands in instrument/tool.cpp.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "operation/operated.h"
#include "trocar/scene/operation_parameters.h"
#include "trocar/surgery/blade.h"
#include "trocar/surgery/fact.h"

namespace trocar::simulation {

/// The use of the tool in one hand in a tick: where it is, what the hand and the foot want, and all that it may change.
struct ToolUse {
  int hand;
  const instrument::Tool& tool;
  const math::Pose& X_proxy;   ///< of the tool that is seen
  const math::Pose& X_device;  ///< of the hand
  double jaw;                  ///< opening [rad]
  double depth;                ///< in the trocar [m]
  double seconds;              ///< of the tick
  const scene::HandControls& controls;
  const scene::OperationParameters& parameters;
  const scene::PatientTissue& made;
  const OperatedAnatomy& anatomy;
  OperatedTissue& tissue;
  OperatedParts& parts;
  surgery::FactList& facts;

  /// A fact of this hand and tool, at the tool's tip.
  surgery::Fact MakeFact(surgery::FactKind kind) const noexcept;
  void AddOfTube(surgery::FactKind kind, const surgery::TubePlace& place) noexcept;
  void AddOfStrand(surgery::FactKind kind, std::uint32_t strand) noexcept;
};

/// Most of each in a tick; FactList::kCapacity holds them all for both hands (tool_use.cpp).
inline constexpr std::size_t kMostStrandsCut = 64, kMostStrandsSpread = 16, kMostHeated = 96;
/// Jaws that close a clip or cut: closed, and open again, as shares of their opening.
inline constexpr double kBitten = 0.12, kOpenAgain = 0.6;

/// Divides what a blade passes over: strands, ducts and vessels, organs.
/// \param fronts    (organs) of the cuts that go on
/// \param is_sealed  what it opens is closed at once: a hollow organ does not leak there
void Divide(const surgery::BladeMove& move, ToolUse& use, std::span<geometry::CutFront> fronts,
            bool cuts_strands, bool is_sealed) noexcept;

/// Scissors, and the heel of the hook.
struct BladeUse {
  surgery::BladeState blade;
  std::vector<geometry::CutFront> fronts;  ///< (organs)
};
void UseBlade(ToolUse& use, BladeUse& state) noexcept;

/// Jaws that part strands as they open.
struct SpreadUse {
  surgery::BladeState upper, lower;
};
void Spread(ToolUse& use, SpreadUse& state) noexcept;

struct ElectrodeUse {
  bool has_current = false;
  double idle_seconds = 0;  ///< pedal down, nothing touched
};
void UseElectrode(ToolUse& use, ElectrodeUse& state) noexcept;

struct ClipUse {
  bool has_clip_open = false;                      ///< the applier has been opened since its last clip
  double opened = 0;                               ///< its jaws, at the most [rad]
  std::optional<surgery::Vessels::Caught> caught;  ///< between them then
  int clips = 0;                                   ///< in stock
};
void UseClips(ToolUse& use, ClipUse& state) noexcept;
/// \param state   its stock are the loads
/// \param fronts  (organs) of no cut
void UseStapler(ToolUse& use, ClipUse& state, std::span<geometry::CutFront> fronts) noexcept;

/// Of this tick; decides nothing, so that no state has it.
struct SuctionUse {
  bool is_rinsing = false, is_aspirating = false;
};
void UseSuction(ToolUse& use, SuctionUse& state) noexcept;

/// \param assistant  grasp of the third hand, which lets go, or nullptr
void UseBag(ToolUse& use, surgery::Grasp* assistant) noexcept;

/// As many facts as stones that were taken out of the abdomen.
void AddRetrieved(ToolUse& use, int count) noexcept;

}  // namespace trocar::simulation
