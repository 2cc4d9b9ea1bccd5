// SPDX-License-Identifier: Apache-2.0
/// \file fact.h  Facts of a tick: what hands and forces did to tissue, tools and loose things, without a judgement.
///
/// One list a tick. Whoever judges, coaches, labels, sounds or sends reads it; what a fact means to a surgeon, an error or a phase for
/// instance, is for a procedure to say.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "trocar/instrument/tool.h"
#include "trocar/math/vector.h"

namespace trocar::surgery {

/// Kinds of facts. States and recordings hold their numbers: a new kind stands at the end.
enum class FactKind : std::int32_t {
  // about what jaws hold; amount: force on the tool [N]
  kGrasp,
  kRelease,
  kSlip,
  kGraspMissed,      ///< jaws closed around nothing; no amount
  kStateRestored,    ///< a bad tick: tissue was taken back to the last good one
  kOrganFrozen,      ///< after too many of them
  kTear,             ///< a strand or a wall gave way to the load
  kPinchDamage,      ///< jaws pinched a bite harder than it bears; amount: the pinch [N]
  kToolsTouch,       ///< the instruments met
  kExchangeRefused,  ///< another tool was asked for while this one holds tissue
  kClipClosed,       ///< a clip was closed around a duct or vessel, or a part of it
  kTubeCut,          ///< a duct or vessel was cut through; amount: cuts through it so far
  kNoClipsLeft,      ///< a clip applier was closed that is empty
  kUsedOutside,      ///< a pedal was pressed, or blades or clips closed, while the tool is out of its trocar
  kClipSlipped,      ///< a clip slipped off the end of a duct or vessel
  kStoneSpilled,     ///< a stone left its organ through a hole
  kStoneTaken,       ///< a spilled stone was grasped
  kStoneRetrieved,   ///< it was sucked up, put into the bag, or taken out
  kVerdict,          ///< in the ring of events alone: a judge's, no fact
  // at the tissue, tick by tick
  kStrandCut,     ///< by a blade
  kStrandSpread,  ///< parted by a jaw that opened
  kOrganCut,      ///< a blade cut the surface of an organ or a sheet
  kOrganOpened,   ///< a blade opened a hollow organ; amount: area of all its openings by blades [m^2]
  kOrganBurnt,    ///< heat parted the tissue of an organ
  kTubeBurnt,     ///< heat made a hole in a duct or vessel; amount: cuts through it so far
  kTubeTornOff,   ///< the end of a duct or vessel came off its organ; amount: cuts through it so far
  kClipLost,      ///< a clip closed around nothing
  kCurrentOn,     ///< the pedal of an electrode is down; amount: for how long it has touched nothing [s]
  kCurrentInto,   ///< current flows into a part
  kRinse,         ///< amount: volume of this tick [m^3]
  kAspirate,      ///< from the pool; amount: volume of this tick [m^3]
  kBagOpen,       ///< a specimen bag is in use
  kToolExchanged  ///< another tool was put into the trocar
};
inline constexpr int kFactKindCount = static_cast<int>(FactKind::kToolExchanged) + 1;
/// Kinds that a task's rule may name, that the ring of events holds and that recordings list; all but the verdict.
inline constexpr bool IsEvent(FactKind kind) noexcept {
  return kind < FactKind::kVerdict;
}
/// "grasp", "release", "slip", "grasp_missed", "state_restored", "organ_frozen", "tear", "pinch_damage", "tools_touch",
/// "exchange_refused", "clip_closed", "tube_cut", "no_clips_left", "used_outside", "clip_slipped", "stone_spilled",
/// "stone_taken", "stone_retrieved", "operation_error" (of a verdict), "strand_cut", "strand_spread", "organ_cut", "organ_opened",
/// "organ_burnt", "tube_burnt", "tube_torn_off", "clip_lost", "current_on", "current_into", "rinse", "aspirate", "bag_open",
/// "tool_exchanged"
std::string_view FactName(FactKind kind) noexcept;

struct Fact {
  FactKind kind = FactKind::kGrasp;
  std::int8_t hand = -1;        ///< instrument::Hand, or -1
  bool is_coagulating = false;  ///< of current
  bool is_partial = false;      ///< of a clip: does not reach around the whole tube
  bool is_crossed = false;      ///< of a clip: lies across another
  instrument::ToolKind tool = instrument::ToolKind::kGrasper;  ///< of the hand; without one nothing
  std::int32_t surface = -1;  ///< organ, duct or vessel: index into Simulation::Surfaces(), or -1
  std::int32_t strand = -1;   ///< index into Simulation::Strands(), or -1
  std::int32_t object = -1;   ///< Scene::objects, or -1
  double along = 0;     ///< place on a duct or vessel, along its middle line at rest from its first node [m]
  double amount = 0;    ///< see FactKind; 0 where nothing is said
  math::Vec3 position;  ///< world frame [m]: of the tool's tip, or of the tissue that heat or load parted
  math::Vec3 p_rest;    ///< of a clip or a cut: where on its vessel at rest, world frame [m]
};

/// Facts of one tick in the order in which they came about. Fixed capacity: a tick allocates nothing.
class FactList {
 public:
  /// More than both hands can bring about in a tick (operation_acts.cpp asserts it).
  static constexpr std::size_t kCapacity = 320;

  FactList() { facts_.reserve(kCapacity); }
  void Clear() noexcept {
    facts_.clear();
    dropped_ = 0;
  }
  /// \note Real-time safe. Beyond the capacity a fact is counted, not kept.
  void Add(const Fact& fact) noexcept {
    if (facts_.size() < kCapacity) {
      facts_.push_back(fact);
    } else {
      ++dropped_;
    }
  }
  std::span<const Fact> All() const { return facts_; }
  std::size_t Dropped() const { return dropped_; }

 private:
  std::vector<Fact> facts_;
  std::size_t dropped_ = 0;
};

}  // namespace trocar::surgery
