// SPDX-License-Identifier: Apache-2.0
/// \file event.h  Events of a tick, by their names: tasks ask for them, snapshots carry them.
#pragma once

#include <cstdint>
#include <string_view>

#include "trocar/base/state_archive.h"
#include "trocar/math/vector.h"

namespace trocar::scene {

enum class EventKind {
  kGrasp,
  kRelease,
  kSlip,
  kGraspMissed,
  kStateRestored,
  kOrganFrozen,
  kTear,
  kPinchDamage,      ///< jaws pinched a bite harder than it bears; force is the pinch
  kToolsTouch,       ///< the instruments met
  kExchangeRefused,  ///< another tool was asked for while this one holds tissue
  kClipClosed,       ///< a clip was closed around a duct or vessel, or a part of it
  kTubeCut,          ///< a duct or vessel was cut through
  kNoClipsLeft,      ///< a clip applier was closed that is empty
  kUsedOutside,      ///< a pedal was pressed, or blades or clips closed, while the tool is out of its trocar
  kClipSlipped,      ///< a clip slipped off the end of a duct or vessel
  kStoneSpilled,     ///< a stone left the gallbladder through a hole
  kStoneTaken,       ///< a spilled stone was grasped
  kStoneRetrieved,   ///< it was sucked up, put into the bag, or taken out
  kOperationError    ///< `error` says which
};
inline constexpr EventKind kLastEventKind = EventKind::kStoneRetrieved;  // the last that a rule may name
/// "grasp", "release", "slip", "grasp_missed", "state_restored", "organ_frozen", "tear",
/// "pinch_damage", "tools_touch", "exchange_refused", "clip_closed", "tube_cut",
/// "no_clips_left", "used_outside", "clip_slipped", "stone_spilled", "stone_taken", "stone_retrieved", "operation_error"
std::string_view EventName(EventKind kind) noexcept;

struct Event {
  EventKind kind;
  std::uint64_t tick;
  std::int32_t hand;         ///< Hand, or -1
  std::int32_t organ;        ///< index into Simulation::Surfaces(), or -1
  double force;              ///< [N], 0 where it means nothing
  std::int32_t object = -1;  ///< Scene::objects that is meant, or -1
  std::int32_t error = -1;   ///< cholecystectomy::OperationError, or -1
  math::Vec3 p_rest;         ///< of a clip or a cut: where on its vessel at rest, world frame [m]
};

void VisitState(base::StateArchive& archive, Event& event);

}  // namespace trocar::scene
