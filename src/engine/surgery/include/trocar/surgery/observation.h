// SPDX-License-Identifier: Apache-2.0
/// \file observation.h  Observation of an operation in a tick: facts, hands, tissue and fluids, for whoever judges it.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "trocar/instrument/camera.h"
#include "trocar/instrument/hand.h"
#include "trocar/instrument/tool.h"
#include "trocar/surgery/fact.h"
#include "trocar/surgery/grasp.h"
#include "trocar/surgery/organ_surface.h"
#include "trocar/surgery/vessels.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::surgery {

/// Observation of a hand.
struct HandObservation {
  instrument::ToolKind tool = instrument::ToolKind::kGrasper;  ///< in its trocar
  math::Vec3 p_world_tip;                                      ///< of the tool that is seen [m]
  double depth = 0;                                            ///< of the tool in its trocar [m]
  bool is_holding = false;                                     ///< jaws hold tissue; of a bag never
  std::int32_t held_surface = -1;  ///< that jaws or the bag hold, index into Simulation::Surfaces(), or -1
  GraspChange change = GraspChange::kNone;  ///< in this tick
};

/// How far the organ that is taken out is on its way.
struct RetrievalObservation {
  bool is_free = false;  ///< nothing holds it any more
  bool is_in_bag = false;
  bool is_leaving = false;  ///< the bag is drawn into a port
};

/// It refers to the state of the tick, which has to outlive it.
struct OperationObservation {
  double time = 0;     ///< [s]
  double seconds = 0;  ///< of the tick, > 0
  std::span<const Fact> facts;
  std::array<HandObservation, instrument::kHandCount> hands;
  const tissue::TissueState& tissue;
  const Vessels& vessels;
  std::span<const OrganSurface> organs;
  instrument::Camera camera;  ///< through which the trainee looks
  RetrievalObservation retrieval;
  double blood_lost = 0;   ///< since the start [m^3]
  int spilled_stones = 0;  ///< that lie in the abdomen
  math::Vec3 p_pool;       ///< where fluids gather, world frame [m]
};

}  // namespace trocar::surgery
